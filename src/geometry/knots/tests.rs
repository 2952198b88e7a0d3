//! Knot vectors: refused input, the spans of parameters, and the sums of basis functions.

use glam::DVec2;
use proptest::prelude::*;

use crate::geometry::*;

fn message(result: Result<KnotVector, KnotError>) -> String {
    result.unwrap_err().to_string()
}

#[test]
fn errors_tell_what_was_found_and_what_is_needed() {
    let new = |degree, values: &[f64]| message(KnotVector::new(degree, values.to_vec()));
    assert_eq!(
        message(KnotVector::for_points(3, vec![0.0; 10], 7)),
        "10 knots, but 7 points of degree 3 need 11 (10 fit degree 2: the degree is the order less 1)"
    );
    // A clamped cubic as openNURBS keeps it.
    assert_eq!(
        message(KnotVector::for_points(3, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], 4)),
        "6 knots, but 4 points of degree 3 need 8 (Rhino leaves out the first and the last: add them)"
    );
    assert_eq!(
        message(KnotVector::for_points(3, vec![0.0; 7], 3)),
        "3 points of degree 3: at least 4 are needed"
    );
    assert_eq!(new(0, &[0.0, 1.0]), "degree 0: degrees from 1 to 32 are supported");
    assert_eq!(new(33, &[0.0; 100]), "degree 33: degrees from 1 to 32 are supported");
    assert_eq!(new(2, &[0.0, 0.0, 1.0]), "3 knots of degree 2: at least 6 are needed");
    assert_eq!(new(1, &[0.0, 1.0, 0.5, 2.0]), "knot 2 is 0.5 after 1: knots must not decrease");
    assert_eq!(new(1, &[0.0, f64::NAN, 1.0, 2.0]), "knot 1 is NaN: knots must be finite numbers");
    assert_eq!(
        new(1, &[0.0, 0.0, 1.0, f64::INFINITY]),
        "knot 3 is inf: knots must be finite numbers"
    );
    assert_eq!(
        new(1, &[0.0, 1.0, 1.0, 2.0]),
        "the domain [1, 1] is empty: knots 1 and 2 (counted from 0) must differ"
    );
    assert_eq!(
        new(1, &[0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0]),
        "knot 1 is repeated 3 times: degree 1 allows up to 2"
    );
    assert_eq!(
        new(1, &[-1e308, -1e308, 1e308, 1e308]),
        "the knots run from -1e308 to 1e308: their difference is not a finite number"
    );
}

#[test]
fn domains_to_map_to_are_refused_as_what_they_are() {
    let knots = KnotVector::bezier(2).unwrap();
    let refused = |start, end| message(knots.on_domain(start, end));
    assert_eq!(
        refused(2.0, 1.0),
        "the domain goes from 2 to 1: its length must be positive and finite"
    );
    assert_eq!(
        refused(0.0, f64::NAN),
        "the domain goes from 0 to NaN: its length must be positive and finite"
    );
    assert_eq!(
        refused(1.0, 1.0),
        "the knots 0 and 1 would become one on the domain from 1 to 1: it must be longer"
    );
    let longest = refused(-f64::MAX, f64::MAX);
    assert!(longest.ends_with("its length must be positive and finite"), "{longest}");
}

#[test]
fn absurd_counts_are_refused_before_memory_is_asked_for() {
    let most = format!("at most {MAX_CONTROL_POINTS} in one direction are supported");
    for make in [KnotVector::uniform, KnotVector::standard, KnotVector::clamped_uniform] {
        assert_eq!(message(make(3, usize::MAX)), format!("{} points: {most}", usize::MAX));
    }
    let listed = |times| message(KnotVector::with_multiplicities(2, &[(0.0, 3), (1.0, times)]));
    assert_eq!(
        listed(usize::MAX),
        format!("knot 1 is repeated {} times: degree 2 allows up to 3", usize::MAX)
    );
    assert_eq!(listed(0), "knot 1 is listed with multiplicity 0: leave it out or give at least 1");
}

#[test]
fn constructors_give_the_textbook_vectors() {
    let standard = KnotVector::standard(3, 5).unwrap();
    assert_eq!(standard.values(), [0., 0., 0., 0., 1., 2., 2., 2., 2.]);
    let printed = KnotVector::standard(3, 8).unwrap(); // the lecture says 5 points
    assert_eq!(printed.values(), [0., 0., 0., 0., 1., 2., 3., 4., 5., 5., 5., 5.]);
    let clamped = KnotVector::clamped_uniform(2, 6).unwrap();
    assert_eq!(clamped.values(), [0., 0., 0., 0.25, 0.5, 0.75, 1., 1., 1.]);
    let uniform = KnotVector::uniform(2, 4).unwrap();
    assert_eq!(uniform.values(), [0., 1., 2., 3., 4., 5., 6.]);
    assert_eq!((uniform.domain(), uniform.is_clamped()), ([2.0, 4.0], false));
    let circle = KnotVector::with_multiplicities(3, &[(0., 4), (0.5, 3), (1., 4)]).unwrap();
    assert_eq!(circle.values(), [0., 0., 0., 0., 0.5, 0.5, 0.5, 1., 1., 1., 1.]);
    assert_eq!((circle.multiplicity(0.5), circle.multiplicity(0.25)), (3, 0));
    assert_eq!(KnotVector::bezier(2).unwrap().values(), [0., 0., 0., 1., 1., 1.]);
}

/// Clamped, unclamped, periodic, with jumps, and with the domain's end inside a multiple knot.
fn examples() -> Vec<KnotVector> {
    let new = |p, values: &[f64]| KnotVector::new(p, values.to_vec()).unwrap();
    vec![
        new(1, &[0., 0., 1., 1.]),
        new(2, &[0., 0., 0., 1., 2., 2., 3., 3., 3.]),
        new(2, &[-2., -1., 0., 1., 2., 3., 4.]),
        new(2, &[0., 0., 0., 1., 1., 1., 2., 2., 2.]),
        new(2, &[-2., -1., 0., 0., 0., 1., 1., 1., 2.]),
        new(3, &[-0.5, -0.5, -0.5, 0., 0.5, 0.5, 0.5, 1., 1.5, 1.5, 1.5]),
        new(3, &[0., 1e-300, 2e-300, 1., 2., 2. + 1e-15, 5., 6., 1e9]),
    ]
}

#[test]
fn spans_are_never_empty_and_hold_their_parameter() {
    for knots in examples() {
        let [start, end] = knots.domain();
        let inside = (0..=50).map(|k| start + (end - start) * f64::from(k) / 50.0);
        let odd = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, start - 1.0, end + 1.0, -0.0];
        for t in inside.chain(odd).chain(knots.values().iter().copied()) {
            let i = knots.span_index(t);
            let (from, to) = (knots.values()[i], knots.values()[i + 1]);
            assert!(from < to, "{knots:?}: span {i} of {t} is empty");
            assert!(i >= knots.degree() && i < knots.point_count());
            if start <= t && t <= end {
                assert!(from <= t && (t < to || t == end), "{knots:?}: span {i} misses {t}");
            }
        }
        assert_eq!(knots.span_index(f64::NAN), knots.span_index(start));
        assert_eq!(knots.span_index(f64::INFINITY), knots.span_index(end));
        let spans: Vec<Span> = knots.spans().collect();
        assert_eq!((spans[0].start, spans[spans.len() - 1].end), (start, end));
        assert!(spans.windows(2).all(|pair| pair[0].end == pair[1].start));
    }
}

#[test]
fn basis_functions_add_up_to_one_and_their_derivatives_to_nothing() {
    for knots in examples() {
        let [start, end] = knots.domain();
        let p = knots.degree();
        for k in 0..=40 {
            let t = start + (end - start) * f64::from(k) / 40.0;
            let BasisDerivatives { span, orders } = knots.basis_derivatives(t);
            assert_eq!(span, knots.span_index(t));
            let mut values = [0.0; MAX_DEGREE + 1];
            assert_eq!(knots.basis(t, &mut values), span);
            assert_eq!(values[..=p], orders[0][..=p]);
            assert!(values.iter().all(|&value| value >= 0.0));
            assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-15 * (p + 1) as f64);
            for order in &orders[1..] {
                let size: f64 = order.iter().map(|value| value.abs()).sum();
                assert!(order.iter().sum::<f64>().abs() <= 1e-14 * size, "{knots:?} at {t}");
            }
        }
    }
}

#[test]
fn basis_has_the_documents_values() {
    let knots = KnotVector::new(3, vec![0., 0., 0., 0., 1., 2., 4., 7., 7., 7., 7.]).unwrap();
    let mut values = [0.0; MAX_DEGREE + 1];
    assert_eq!(knots.basis(2.5, &mut values), 5);
    let expected = [9. / 64., 219. / 320., 69. / 400., 1. / 400.];
    for (value, expected) in values.iter().zip(expected) {
        assert!((value - expected).abs() < 1e-16);
    }
    // Rogers's example 4.1 at t = 3/2, where with weight h₃ = 0 the rational functions are
    // 1/2, 0, 1/2.
    let knots = KnotVector::standard(2, 5).unwrap();
    assert_eq!(knots.basis(1.5, &mut values), 3);
    assert_eq!(values[..3], [0.125, 0.75, 0.125]);
    assert_eq!(values[0] / (values[0] + values[2]), 0.5);
}

/// The cubic functions on the knots 0, 1, 2, … are `−(t−1)³/6`, `(3t³−6t²+4)/6`,
/// `(−3t³+3t²+3t+1)/6`, `t³/6` on each span, with `t` from its start.
#[test]
fn uniform_cubics_have_their_closed_form_and_derivatives() {
    let knots = KnotVector::uniform(3, 6).unwrap();
    for k in 0..10 {
        let t = f64::from(k) / 10.0;
        let closed = [
            [
                (1. - t).powi(3),
                3. * t.powi(3) - 6. * t * t + 4.,
                -3. * t.powi(3) + 3. * t * t + 3. * t + 1.,
                t.powi(3),
            ],
            [-3. * (1. - t).powi(2), 9. * t * t - 12. * t, -9. * t * t + 6. * t + 3., 3. * t * t],
            [6. * (1. - t), 18. * t - 12., -18. * t + 6., 6. * t],
        ];
        let basis = knots.basis_derivatives(4.0 + t);
        assert_eq!(basis.span, 4);
        for order in 0..3 {
            for function in 0..4 {
                let off = basis.orders[order][function] - closed[order][function] / 6.0;
                assert!(off.abs() < 1e-14, "order {order}, function {function} at {t}: {off}");
            }
        }
    }
}

#[test]
fn reversing_keeps_the_domain_where_it_can() {
    let knots = KnotVector::new(2, vec![0.1, 0.1, 0.1, 0.15, 0.3, 0.3, 0.3]).unwrap();
    let reversed = knots.reversed();
    assert_eq!(reversed.domain(), knots.domain());
    assert_eq!(reversed.values().len(), 7);
    // Two knots that differ by less than the ulp of 1 can only be mirrored at 0.
    let tiny = KnotVector::new(1, vec![0., 0., 1e-20, 2e-20, 1., 1.]).unwrap();
    assert_eq!(tiny.reversed().domain(), [-1.0, 0.0]);
    assert_eq!(tiny.reversed().reversed(), tiny);
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(256) })]

    #[test]
    fn any_numbers_give_knots_or_an_error(
        degree in 0..40_usize,
        values in prop::collection::vec(any::<f64>(), 0..30),
        t in any::<f64>(),
    ) {
        let mut values = values;
        values.sort_by(f64::total_cmp);
        if let Ok(knots) = KnotVector::new(degree, values) {
            let span = knots.span_index(t);
            prop_assert!(knots.values()[span] < knots.values()[span + 1]);
            prop_assert!(knots.reversed().spans().count() == knots.spans().count());
        }
    }

    #[test]
    fn functions_of_every_degree_add_up_to_one(
        degree in 1..=MAX_DEGREE,
        steps in prop::collection::vec(0.0..1.0_f64, 80),
        power in -8..=8,
        s in 0.0..1.0_f64,
    ) {
        let mut at = 0.0;
        let values = steps[..2 * degree + 6].iter().map(|step| {
            at += step * 10.0_f64.powi(power);
            at
        });
        let knots = KnotVector::new(degree, values.collect()).unwrap();
        let [start, end] = knots.domain();
        let mut values = [0.0; MAX_DEGREE + 1];
        knots.basis((start + s * (end - start)).min(end), &mut values);
        prop_assert!(values.iter().all(|&value| value >= 0.0));
        prop_assert!((values.iter().sum::<f64>() - 1.0).abs() < 1e-14);
    }
}

/// A closed spline over uneven knots is as smooth at its seam as at its other knots: the same
/// curve, begun elsewhere, is the same.
#[test]
fn periodic_knots_close() {
    let period = [-1.0, 0.5, 1.0, 1.0, 4.0];
    let points = [[2.0, 0.0], [1.0, 3.0], [-2.0, 1.0], [0.0, -2.0]];
    let weights = [1.0, 0.5, 2.0, 1.5];
    for degree in [1, 2, 3, 7] {
        let curve = |period: &[f64], first: usize| {
            let knots = KnotVector::periodic(degree, period).unwrap();
            let around = (0..knots.point_count()).map(|k| (k + first) % 4);
            let (points, weights) =
                around.map(|k| (DVec2::from(points[k]).extend(0.0), weights[k])).unzip();
            NurbsCurve::new(knots, points, Some(weights)).unwrap()
        };
        let whole = curve(&period, 0);
        assert_eq!(whole.domain(), [-1.0, 4.0]);
        // Begun a knot later: its first span is the other's second.
        let later = curve(&[0.5, 1.0, 1.0, 4.0, 5.5], 1);
        for k in 0..=20 {
            let t = 0.5 + 3.5 * f64::from(k) / 20.0;
            assert!(whole.point_at(t).distance(later.point_at(t)) < 1e-14, "degree {degree}, {t}");
            let t = -1.0 + 1.4 * f64::from(k) / 20.0;
            assert!(whole.point_at(t).distance(later.point_at(t + 5.0)) < 1e-14);
        }
        let [start, end] = whole.ends();
        assert!(start.distance(end) < 1e-14);
    }
    assert_eq!(KnotVector::periodic(2, &[0.0, 1.0, 2.0, 3.0]).unwrap().values().len(), 8);
    // Several periods of rounded numbers: double knots stay double.
    let double = KnotVector::periodic(7, &[-1.34, -1.34, 2.56, 3.52]).unwrap();
    let runs = double.values().chunk_by(|a, b| a == b).map(<[f64]>::len);
    assert_eq!(runs.collect::<Vec<_>>(), [1, 2].repeat(6));
    let message = |period: &[f64]| KnotVector::periodic(2, period).unwrap_err().to_string();
    assert_eq!(message(&[0.0, 1.0, 2.0]), "a closed spline of 2 points: at least 3 are needed");
    assert_eq!(message(&[1.0; 4]), "all knots are 1: two must differ");
    assert_eq!(message(&[0.0, 2.0, 1.0, 3.0]), "knot 2 is 1 after 2: knots must not decrease");
    assert!(KnotVector::periodic(usize::MAX, &[0.0, 1.0, 2.0, 3.0]).is_err());
}

#[test]
fn spans_between_parameters() {
    let knots = KnotVector::with_multiplicities(2, &[(0.0, 3), (1.0, 2), (2.0, 1), (4.0, 3)]);
    let knots = knots.unwrap();
    let between = |from, to| -> Vec<[f64; 2]> {
        knots.spans_between(from, to).map(|span| [span.start, span.end]).collect()
    };
    assert_eq!(between(0.0, 4.0).len(), knots.spans().count());
    assert_eq!(between(0.5, 1.5), [[0.0, 1.0], [1.0, 2.0]]);
    assert_eq!(between(1.0, 2.0), [[1.0, 2.0]]);
    assert_eq!(between(3.0, 9.0), [[2.0, 4.0]]);
    assert!(between(1.0, 1.0).is_empty() && between(-2.0, -1.0).is_empty());
}
