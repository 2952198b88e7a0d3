//! Curves against the documents' worked examples, and against themselves.

use std::f64::consts::PI;

use glam::{DVec3, DVec4};
use proptest::prelude::*;

use crate::geometry::*;

fn plane(points: &[(f64, f64)]) -> Vec<DVec3> {
    points.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect()
}

fn close(a: DVec3, x: f64, y: f64) {
    let off = (a - DVec3::new(x, y, 0.0)).length();
    assert!(off <= 4e-15 * a.length().max(1.0), "{a} is not ({x}, {y})");
}

/// Rogers 2001, example 4.1: a quadratic with one weight varied.
#[test]
fn rational_curves_have_rogers_values() {
    let points = plane(&[(0.0, 0.0), (1.0, 2.0), (2.5, 0.0), (4.0, 2.0), (5.0, 0.0)]);
    let knots = KnotVector::standard(2, 5).unwrap();
    let cases = [
        (0.25, 8. / 7., 24. / 7., (13. / 10., 8. / 5.), (107. / 62., 40. / 31.)),
        (1.0, 0.5, 1.5, (7. / 4., 1.), (17. / 8., 5. / 8.)),
        (5.0, 0.125, 0.375, (9. / 4., 1. / 3.), (12. / 5., 1. / 6.)),
    ];
    for (h3, y, slope, one, five_quarters) in cases {
        let weights = Some(vec![1.0, 1.0, h3, 1.0, 1.0]);
        let curve = NurbsCurve::new(knots.clone(), points.clone(), weights).unwrap();
        let middle = curve.derivatives(1.5);
        close(middle.point, 2.5, y);
        close(middle.first, slope, 0.0);
        close(curve.point_at(1.0), one.0, one.1);
        close(curve.point_at(1.25), five_quarters.0, five_quarters.1);
    }
}

#[test]
fn de_boor_finds_the_corrected_value_of_the_deck() {
    let values = vec![0., 0., 0., 0., 1., 2., 4., 7., 7., 7., 7.];
    let knots = KnotVector::new(3, values).unwrap();
    let heights = [3., -1., 4., 1., -5., 9., 2.];
    let points = heights.iter().map(|&y| DVec3::new(0.0, y, 0.0)).collect();
    let curve = NurbsCurve::new(knots, points, None).unwrap();
    close(curve.point_at(2.5), 0.0, 651.0 / 1600.0);
    close(curve.derivatives(2.5).point, 0.0, 651.0 / 1600.0);
}

/// The lecture's uniform cubic B-spline: each segment begins where the last one ends.
#[test]
fn a_uniform_spline_has_the_lecture_s_values() {
    let points = plane(&[(2., 1.), (5., 2.), (6., 5.), (8., 6.), (5., 9.), (4., 7.), (1., 5.)]);
    let curve = NurbsCurve::new(KnotVector::uniform(3, 7).unwrap(), points, None).unwrap();
    assert_eq!(curve.domain(), [3.0, 7.0]);
    let cases = [
        (3.0, 14. / 3., 7. / 3.),
        (3.5, 263. / 48., 3.5),
        (4.0, 37. / 6., 14. / 3.),
        (4.5, 83. / 12., 5.5),
        (5.0, 43. / 6., 19. / 3.),
        (5.5, 103. / 16., 119. / 16.),
        (6.0, 16. / 3., 49. / 6.),
        (6.5, 4.5, 379. / 48.),
        (7.0, 11. / 3., 7.),
    ];
    for (t, x, y) in cases {
        close(curve.point_at(t), x, y);
    }
    // x = t³/2 − t² + 2t + 14/3, y = −2t³/3 + t² + 2t + 7/3 on the first segment.
    let start = curve.derivatives(3.0);
    close(start.first, 2.0, 2.0);
    close(start.second, -2.0, 2.0);
}

#[test]
fn threefold_end_points_make_a_uniform_spline_reach_them() {
    let points = [
        (200., 100.),
        (200., 100.),
        (200., 100.),
        (500., 200.),
        (600., 500.),
        (800., 600.),
        (500., 900.),
        (400., 700.),
        (100., 500.),
        (100., 500.),
        (100., 500.),
    ];
    let knots = KnotVector::uniform(3, 11).unwrap();
    assert_eq!(knots.spans().count(), 8);
    let curve = NurbsCurve::new(knots, plane(&points), None).unwrap();
    close(curve.point_at(3.0), 200., 100.);
    close(curve.point_at(3.5), 825. / 4., 1225. / 12.);
    close(curve.point_at(4.0), 250., 350. / 3.);
    close(curve.point_at(6.5), 2075. / 3., 550.);
    close(curve.point_at(11.0), 100., 500.);
}

/// On `1/t` in homogeneous form, `C = (1/t, 0, 0)`, the quotient rule has a closed form.
#[test]
fn derivatives_follow_the_quotient_rule() {
    for scale in [1e-8, 1.0, 1e8] {
        let knots = KnotVector::with_multiplicities(2, &[(scale, 3), (3.0 * scale, 3)]).unwrap();
        // t from scale to 3 scale: w = t / scale raised to degree 2 has the points 1, 2, 3.
        let control = [1.0, 2.0, 3.0].map(|w| DVec4::new(1.0, 0.0, 0.0, w)).to_vec();
        let curve = NurbsCurve::from_homogeneous(knots, control).unwrap();
        for s in [1.0, 1.7, 2.0, 2.9, 3.0] {
            let c = curve.derivatives(s * scale);
            assert!((c.point.x - 1.0 / s).abs() < 1e-15);
            assert!((c.first.x * scale + 1.0 / (s * s)).abs() < 4e-15);
            assert!((c.second.x * scale * scale - 2.0 / (s * s * s)).abs() < 3e-14);
        }
    }
}

/// Knots outside the domain, repeated across its ends, or more often than the degree.
#[test]
fn odd_ends_are_clamped_without_moving_the_curve() {
    let vectors: [(usize, &[f64]); 6] = [
        (2, &[-2., -1., 0., 0., 0., 1., 2., 3.]),
        (2, &[-2., -1., 0., 0., 1., 1., 2., 3.]),
        (2, &[0., 0., 0., 1., 1., 1., 2., 2., 3.]),
        (2, &[-2., -1., 0., 0.5, 1., 1., 1., 2., 3.]),
        (3, &[-1., -1., -1., -1., 0., 0., 0., 0., 1., 1., 2., 2., 2., 2.]),
        (4, &[0., 1., 2., 3., 4., 5., 6., 7., 8., 9.]),
    ];
    for (degree, values) in vectors {
        let knots = KnotVector::new(degree, values.to_vec()).unwrap();
        let points: Vec<(f64, f64)> =
            (0..knots.point_count()).map(|i| (i as f64, (3 * i % 7) as f64)).collect();
        let weights = (0..points.len()).map(|i| 1.0 + (i % 3) as f64).collect();
        let curve = NurbsCurve::new(knots, plane(&points), Some(weights)).unwrap();
        let [start, end] = curve.domain();
        let others = [curve.clamped(), curve.bezier_form(), curve.elevated(1).unwrap()];
        for k in 0..=40 {
            let t = start + f64::from(k) * (end - start) / 40.0;
            let point = curve.point_at(t);
            for other in &others {
                assert!(other.knots().is_clamped());
                close(other.point_at(t), point.x, point.y);
            }
        }
    }
}

#[test]
fn a_jump_belongs_to_the_piece_that_begins_there() {
    let knots = KnotVector::with_multiplicities(1, &[(0.0, 2), (1.0, 2), (2.0, 2)]).unwrap();
    let points = plane(&[(0., 0.), (1., 0.), (1., 5.), (2., 5.)]);
    let curve = NurbsCurve::new(knots, points, None).unwrap();
    close(curve.point_at(1.0), 1.0, 5.0);
    close(curve.point_at(0.75), 0.75, 0.0);
    let (below, above) = curve.split(1.0).unwrap();
    close(below.point_at(1.0), 1.0, 0.0);
    close(above.point_at(1.0), 1.0, 5.0);
    let elevated = curve.elevated(2).unwrap();
    assert_eq!(elevated.knots().multiplicity(1.0), 4);
    close(elevated.point_at(0.75), 0.75, 0.0);
    close(elevated.point_at(1.25), 1.25, 5.0);
}

#[test]
fn errors_tell_what_is_needed() {
    let knots = KnotVector::bezier(2).unwrap();
    let points = plane(&[(0., 0.), (1., 2.), (2., 0.)]);
    let message = |points: &[DVec3], weights: Option<&[f64]>| {
        NurbsCurve::new(knots.clone(), points.to_vec(), weights.map(<[f64]>::to_vec))
            .unwrap_err()
            .to_string()
    };
    assert_eq!(message(&points[..2], None), "2 control points, but the knots need 3");
    assert_eq!(
        message(&points, Some(&[1.0])),
        "1 weight for 3 control points: each needs one, or none has any"
    );
    assert_eq!(
        message(&points, Some(&[1.0, 0.0, 1.0])),
        "the weight of control point 1 is 0: it must be positive and finite (from 1e-70 to 1e70)"
    );
    assert_eq!(
        message(&points, Some(&[1.0, 1.0, 1e300])),
        "the weight of control point 2 is 1e300: \
         it must be positive and finite (from 1e-70 to 1e70)"
    );
    assert_eq!(
        message(&[DVec3::ZERO, DVec3::X, DVec3::NAN], None),
        "control point 2 is (NaN, NaN, NaN): coordinates must be finite (up to 1e70)"
    );
    let curve = NurbsCurve::new(knots, points, None).unwrap();
    assert_eq!(
        curve.split(1.0).unwrap_err().to_string(),
        "the parameter 1 does not lie inside the domain from 0 to 1"
    );
    assert!(matches!(curve.insert_knot(f64::NAN, 1), Err(CurveError::Parameter { .. })));
    assert!(matches!(curve.insert_knot(0.5, 4), Err(CurveError::Knots(_))));
    assert_eq!(
        curve.elevated(31).unwrap_err().to_string(),
        "degree 33: degrees from 1 to 32 are supported"
    );
}

#[test]
fn a_bezier_curve_needs_points_for_its_degree() {
    let message = |points: &[DVec3]| NurbsCurve::bezier(points).unwrap_err().to_string();
    assert_eq!(message(&[]), "0 points: at least 2 are needed");
    assert_eq!(message(&[DVec3::ONE]), "1 point: at least 2 are needed");
    assert_eq!(message(&[DVec3::ONE; 34]), "degree 33: degrees from 1 to 32 are supported");
}

#[test]
fn points_and_weights_are_those_of_the_indices() {
    let points = plane(&[(0., 0.), (1., 2.), (2., 0.)]);
    let weights = vec![1.0, 0.5, 2.0];
    let knots = KnotVector::bezier(2).unwrap();
    let curve = NurbsCurve::new(knots, points.clone(), Some(weights.clone())).unwrap();
    assert_eq!(curve.degree(), 2);
    assert_eq!(curve.points().collect::<Vec<_>>(), points);
    assert_eq!(curve.weights().collect::<Vec<_>>(), weights);
}

#[test]
fn there_are_no_more_control_points_than_there_are() {
    let curve = NurbsCurve::bezier(&plane(&[(0., 0.), (1., 2.), (2., 0.)])).unwrap();
    assert_eq!((curve.point(2), curve.weight(2)), (Some(DVec3::new(2., 0., 0.)), Some(1.0)));
    assert_eq!((curve.point(3), curve.weight(usize::MAX)), (None, None));
}

#[test]
fn splits_and_bernstein_sums_agree_with_de_casteljau() {
    let points: Vec<DVec4> = (0..8)
        .map(|k| DVec4::new(f64::from(k), f64::from(k * k % 5), 1.0, 1.0 + f64::from(k % 3)))
        .collect();
    for t in [0.0, 0.1, 0.5, 0.77, 1.0] {
        let point = de_casteljau(&points, t).unwrap();
        let basis = bernstein(7, t).unwrap();
        let sum: DVec4 = points.iter().zip(basis).map(|(&point, b)| b * point).sum();
        assert!((sum - point).length() < 1e-14);
        let (below, above) = split_bezier(&points, t).unwrap();
        assert!((below[7] - point).length() < 1e-14);
        assert_eq!(below[7], above[0]);
        assert_eq!((below[0], above[7]), (points[0], points[7]));
        let quarter = de_casteljau(&below, 0.25).unwrap();
        assert!((quarter - de_casteljau(&points, 0.25 * t).unwrap()).length() < 1e-14);
    }
    assert!(de_casteljau(&[], 0.5).is_none());
    assert!(de_casteljau(&vec![DVec4::W; MAX_DEGREE + 2], 0.5).is_none());
    assert!(split_bezier(&[], 0.5).is_none());
    assert!(split_bezier(&vec![DVec4::W; MAX_DEGREE + 2], 0.5).is_none());
    assert!(bernstein(MAX_DEGREE + 1, 0.5).is_none());
    assert!(bernstein(3, 0.3).unwrap()[4..].iter().all(|&b| b == 0.0));
}

/// On a curve of polynomials, and on the quarter circle `x + i y = (1 + i t) / (1 − i t)`, whose
/// derivatives are `2 k! iᵏ / (1 − i t)ᵏ⁺¹`.
#[test]
fn derivatives_of_every_order_are_those_of_closed_forms() {
    // (t, t², t³) on [0, 2], in two pieces.
    let cube =
        [[0.0, 0.0, 0.0], [2.0 / 3.0, 0.0, 0.0], [4.0 / 3.0, 4.0 / 3.0, 0.0], [2.0, 4.0, 8.0]];
    let knots = KnotVector::new(3, vec![0.0, 0.0, 0.0, 0.0, 2.0, 2.0, 2.0, 2.0]).unwrap();
    let cube = NurbsCurve::new(knots, cube.map(DVec3::from).to_vec(), None).unwrap();
    let cube = cube.insert_knot(0.7, 1).unwrap();
    let quarter = KnotVector::bezier(2).unwrap();
    let corners = [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
    let quarter = NurbsCurve::new(quarter, corners.to_vec(), Some(vec![1.0, 1.0, 2.0])).unwrap();
    for k in 0..=20 {
        let s = 0.05 * f64::from(k);
        let t = 2.0 * s;
        let powers = [
            DVec3::new(t, t * t, t * t * t),
            DVec3::new(1.0, 2.0 * t, 3.0 * t * t),
            DVec3::new(0.0, 2.0, 6.0 * t),
            DVec3::new(0.0, 0.0, 6.0),
            DVec3::ZERO,
        ];
        for (order, expected) in powers.into_iter().enumerate() {
            let off = cube.derivative(order, t).distance(expected);
            assert!(off < 1e-13, "derivative {order} at {t}: off by {off:e}");
        }
        // As polar coordinates: |1 − i t|² = 1 + t², and the argument of 1 / (1 − i t) is atan t.
        let mut factorial = 1.0;
        for order in 1..=5_i32 {
            factorial *= f64::from(order);
            let turns = f64::from(order) * 0.5 * PI + f64::from(order + 1) * s.atan();
            let size = 2.0 * factorial / (1.0 + s * s).sqrt().powi(order + 1);
            let expected = size * DVec3::new(turns.cos(), turns.sin(), 0.0);
            let off = quarter.derivative(order as usize, s).distance(expected);
            assert!(off < 1e-12 * size, "derivative {order} at {s}: off by {off:e}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::with_cases(64) })]

    /// De Boor's algorithm, sums of basis functions, Bézier pieces and the refined curves
    /// all give one point.
    #[test]
    fn all_ways_lead_to_one_point(
        degree in 1..=24_usize,
        steps in prop::collection::vec((0.01..3.0_f64, 1..3_usize), 3..6),
        coordinates in prop::collection::vec((-1.0..1.0_f64, -1.0..1.0_f64, 0.1..3.0_f64), 200),
        power in -8..=8,
    ) {
        let scale = 10.0_f64.powi(power);
        let mut values: Vec<f64> = (0..=degree).map(|i| i as f64 * 0.2).collect();
        for &(step, times) in &steps {
            let at = values[values.len() - 1] + step;
            values.extend(std::iter::repeat_n(at, times.min(degree)));
        }
        let last = values[values.len() - 1];
        values.extend((1..=degree).map(|i| last + 0.3 * i as f64));
        let knots = KnotVector::new(degree, values).unwrap();
        let count = knots.point_count();
        let control: Vec<DVec4> = coordinates[..count]
            .iter()
            .map(|&(x, y, w)| (w * scale * DVec3::new(x, y, 1.0)).extend(w))
            .collect();
        let curve = NurbsCurve::from_homogeneous(knots, control).unwrap();
        let [start, end] = curve.domain();
        let bezier = curve.bezier_form();
        let elevated = curve.elevated(3).unwrap();
        let inserted = curve.insert_knot(0.5 * (start + end), 1).unwrap();
        let backwards = curve.reversed();
        for k in 0..=20 {
            let s = f64::from(k) / 20.0;
            let t = (start + s * (end - start)).clamp(start, end);
            let point = curve.point_at(t);
            let stays = |other: DVec3| (other - point).length() <= 1e-14 * scale;
            prop_assert!(stays(curve.derivatives(t).point));
            prop_assert!(stays(bezier.point_at(t)));
            prop_assert!(stays(elevated.point_at(t)));
            prop_assert!(stays(inserted.point_at(t)));
            // Backwards, the parameter is rounded: the point moves with it.
            let slip = 4.0 * f64::EPSILON * (start.abs() + end.abs());
            let moved = (backwards.point_at(start + (end - t)) - point).length();
            prop_assert!(moved <= 1e-14 * scale + slip * curve.derivatives(t).first.length());
        }
    }
}
