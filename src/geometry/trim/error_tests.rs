//! Which loops are refused and which are not, and the messages of the errors.

use glam::{DVec2, DVec3};
use proptest::prelude::*;

use super::tests::{Random, trims};
use super::{
    Coverage, Kept, Side, TrimCurve, TrimCurveError, TrimDomain, TrimError, TrimLoop,
    TrimLoopError, Trims, UvBox,
};
use crate::geometry::{Direction, KnotVector, NurbsCurve};

fn unit() -> TrimDomain {
    TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap()
}

fn polygon(list: &[(f64, f64)]) -> TrimLoop {
    let corners: Vec<DVec2> = list.iter().map(|&(u, v)| DVec2::new(u, v)).collect();
    TrimLoop::polygon(&corners).unwrap()
}

fn square(u: f64, v: f64, size: f64) -> TrimLoop {
    TrimLoop::rectangle(UvBox::new([u, u + size], [v, v + size])).unwrap()
}

fn circle(u: f64, v: f64, radius: f64) -> TrimLoop {
    TrimLoop::circle(DVec2::new(u, v), radius).unwrap()
}

fn refused(loops: &[TrimLoop]) -> TrimError {
    let wide = TrimDomain::new([-1e3, 1e3], [-1e3, 1e3]).unwrap();
    Trims::new(wide, Kept::Odd, loops).unwrap_err()
}

fn crossing(loops: &[TrimLoop]) -> ([usize; 2], DVec2) {
    match refused(loops) {
        TrimError::Crossing { loops, at } => (loops, at),
        TrimError::SelfCrossing { index, at } => ([index; 2], at),
        other => panic!("{other}"),
    }
}

#[test]
fn open_loops_say_by_how_much() {
    let line = |a: (f64, f64), b: (f64, f64)| TrimCurve::line(a.into(), b.into()).unwrap();
    let curves = [line((0., 0.), (1., 0.)), line((1., 0.25), (0., 1.)), line((0., 1.), (0., 0.))];
    let error = TrimLoop::new(&curves).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the loop is open: curve 0 ends at (1, 0), but curve 1 begins at (1, 0.25), \
         (0, 0.25) away; gaps up to (0.001, 0.001) are closed"
    );
    let open = TrimLoop::new(&curves[..1]).unwrap_err();
    assert!(matches!(open, TrimLoopError::Open { curve: 0, next: 0, gap, .. } if gap.x == -1.0));

    // A spline that jumps at a knot of multiplicity p + 1 is open there.
    let knots = KnotVector::with_multiplicities(1, &[(0.0, 2), (1.0, 2), (2.0, 2)]).unwrap();
    let jump = [(0., 0.), (1., 0.), (1., 0.5), (0., 0.)].map(|(u, v)| DVec3::new(u, v, 0.0));
    let jump = NurbsCurve::new(knots, jump.to_vec(), None).unwrap();
    let jump = TrimLoop::new(&[TrimCurve::nurbs(&jump).unwrap()]).unwrap_err();
    assert!(matches!(jump, TrimLoopError::Open { curve: 0, next: 0, gap, .. } if gap.y == 0.5));
}

#[test]
fn ends_within_rounding_are_made_one() {
    // A half disc whose arc ends a little off; the line's ends are kept, the corner is sharp.
    let arc = TrimCurve::arc(DVec2::new(0.0, 1e-8), 1.0, 0.0, std::f64::consts::PI).unwrap();
    let line = TrimCurve::line(DVec2::new(-1.0, 0.0), DVec2::new(1.0, 0.0)).unwrap();
    let half = trims(&[TrimLoop::new(&[arc, line]).unwrap()]);
    let outline = &half.outlines(1e-3).unwrap()[0];
    assert_eq!(outline[0], DVec2::new(1.0, 0.0));
    // Close to the joint the arc follows its end.
    assert_eq!(half.side_of(DVec2::new(1.0 - 1e-12, 1e-8)), Side::Inside);
    assert_eq!(half.side_of(DVec2::new(1.0 + 1e-12, 1e-8)), Side::Outside);
    // No ray slips through the closed gaps, not even level with them.
    for v in [0.0, 1e-9, 5e-9, 1e-8, 2e-8, -1e-9] {
        assert_eq!(half.side_of(DVec2::new(-3.0, v)), Side::Outside, "v = {v}");
    }
}

#[test]
fn crossings_are_found_where_they_are() {
    // A bow tie.
    let (loops, at) = crossing(&[polygon(&[(0., 0.), (2., 2.), (2., 0.), (0., 2.)])]);
    assert_eq!(loops, [0, 0]);
    assert!((at - DVec2::ONE).length() < 1e-12, "{at}");

    // Two circles of radius 1, 1 apart, meet at u = ½, v = ±√¾.
    let (loops, at) = crossing(&[circle(0., 0., 1.), circle(1., 0., 1.)]);
    assert_eq!(loops, [0, 1]);
    assert!((at.abs() - DVec2::new(0.5, 0.75f64.sqrt())).length() < 1e-12, "{at}");

    // Through corners only: a square and the same turned by 45° about a corner of it.
    let diamond = polygon(&[(1., 0.), (2., 1.), (1., 2.), (0., 1.)]);
    let (_, at) = crossing(&[diamond.clone(), polygon(&[(0., 1.), (2., 1.), (2., 3.), (0., 3.)])]);
    assert!((at.y - 1.0).abs() < 1e-12 && (at.x - 1.0).abs() - 1.0 < 1e-12, "{at}");
    // Along a common stretch: in at one end, out at the other.
    let _ = crossing(&[
        square(0., 0., 2.),
        polygon(&[(1., 1.), (2., 1.), (2., 1.5), (3., 1.5), (3., 3.), (1., 3.)]),
    ]);
    // A loop within a loop of one curve (a limaçon), and a bow tie knotted at a corner.
    let limacon: Vec<DVec2> = (0..200)
        .map(|k| {
            let angle = std::f64::consts::TAU * f64::from(k) / 200.0;
            (0.5 + angle.cos()) * DVec2::from_angle(angle)
        })
        .collect();
    let (_, at) = crossing(&[TrimLoop::polygon(&limacon).unwrap()]);
    assert!(at.length() < 0.05, "{at}");
    let _ = crossing(&[polygon(&[(0., 0.), (1., 1.), (2., 2.), (2., 0.), (1., 1.), (0., 2.)])]);

    // A curve that crosses itself, as its control polygon does.
    let looped = [(0., 0.), (3., 3.), (-2., 3.), (1., 0.)].map(|(u, v)| DVec2::new(u, v));
    let looped = TrimCurve::bezier(&looped, None).unwrap();
    let below = [(1., 0.), (1., -1.), (0., -1.), (0., 0.)].map(|(u, v)| DVec2::new(u, v));
    let below = TrimCurve::polyline(&below).unwrap();
    let (_, at) = crossing(&[TrimLoop::new(&[looped, below]).unwrap()]);
    assert!((at.x - 0.5).abs() < 1e-9, "{at}: it is symmetric");

    // With its own copy across the seam.
    let domain = unit().periodic_in(Direction::U);
    let error = Trims::new(domain, Kept::Odd, &[circle(0.5, 0.5, 0.6)]).unwrap_err();
    assert!(matches!(error, TrimError::CopyCrossing { index: 0, .. }), "{error}");
}

#[test]
fn touching_is_allowed() {
    let fine = |loops: &[TrimLoop]| {
        trims(loops);
    };
    fine(&[square(0., 0., 1.), square(1., 0., 1.)]); // along a side
    fine(&[square(0., 0., 1.), square(1., 1., 1.)]); // at a corner
    fine(&[square(0., 0., 4.), square(0., 1., 2.)]); // within, along a side
    fine(&[circle(0., 0., 1.), circle(2., 0., 1.)]); // outside, tangent
    fine(&[circle(0., 0., 2.), circle(1., 0., 1.)]); // within, tangent
    fine(&[circle(0., 0., 2.), square(-1., -1., 0.5), square(-0.75, -0.5, 0.5)]);
    // A corner on a side; a loop that touches itself in a corner; one with a slit.
    fine(&[square(0., 0., 1.), polygon(&[(0.5, 1.), (1., 2.), (0., 2.)])]);
    fine(&[polygon(&[(0., 0.), (1., 1.), (2., 0.), (2., 2.), (1., 1.), (0., 2.)])]);
    let slit = polygon(&[
        (0., 0.),
        (4., 0.),
        (4., 4.),
        (0., 4.),
        (0., 2.),
        (1., 2.),
        (1., 3.),
        (3., 3.),
        (3., 1.),
        (1., 1.),
        (1., 2.),
        (0., 2.),
    ]);
    let slit = trims(&[slit]);
    assert_eq!(slit.side_of(DVec2::new(2., 2.)), Side::Outside);
    assert_eq!(slit.side_of(DVec2::new(0.5, 1.9)), Side::Inside);
    assert!(matches!(slit.side_of(DVec2::new(0.5, 2.)), Side::Edge { .. }));
}

#[test]
fn loops_that_enclose_nothing_are_refused() {
    let nothing = |error: TrimError| match error {
        TrimError::Loop { index, error: TrimLoopError::Degenerate { .. } } => index,
        other => panic!("{other}"),
    };
    assert_eq!(nothing(refused(&[square(0., 0., 1.), polygon(&[(2., 2.), (3., 3.)])])), 1);
    assert_eq!(nothing(refused(&[polygon(&[(0., 0.), (1., 1.), (2., 0.), (1., 1.)])])), 0);
    let point = TrimLoop::polygon(&[DVec2::ONE; 3]).unwrap_err();
    assert_eq!(point.to_string(), "the loop encloses nothing: it lies on (1, 1) to (1, 1)");
    assert!(TrimLoop::circle(DVec2::splat(1e8), 1e-12).is_err());
    // Corners given twice are only corners.
    let twice = polygon(&[(0., 0.), (0., 0.), (1., 0.), (1., 1.), (1., 1.), (1., 1.)]);
    assert_eq!(trims(&[twice]).segment_count(), 3);
    assert_eq!(
        refused(&[circle(0., 0., 1.), circle(0., 0., 1.)]),
        TrimError::Coincident { loops: [0, 1] }
    );
}

#[test]
fn domains_cut_loops_and_refuse_those_beside_them() {
    let beyond = Trims::new(unit(), Kept::Odd, &[circle(0.5, 0.5, 0.6)]).unwrap();
    assert_eq!(beyond.classify(&UvBox::new([0.2, 0.8], [0.2, 0.8])), Coverage::Inside);
    let touching = Trims::new(unit(), Kept::Odd, &[circle(0.5, 0.5, 0.5)]).unwrap();
    assert!(matches!(touching.side_of(DVec2::new(0.5, 1.0)), Side::Edge { .. }));
    let error =
        Trims::new(unit(), Kept::Odd, &[square(0., 0., 1.), square(2., 0., 1.)]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "loop 1 lies on (2, 0) to (3, 1): no part of it is inside the domain (0, 0) to (1, 1)"
    );
    assert_eq!(Trims::new(unit(), Kept::Odd, &[]).unwrap_err(), TrimError::NoLoops);
    let error = TrimDomain::new([0.0, 1.0], [2.0, 2.0]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the domain in v goes from 2 to 2: it must be finite, at most 1e100, and not empty"
    );
    let long = Trims::new(unit().periodic_in(Direction::V), Kept::Odd, &[square(0., 0., 100.)]);
    assert_eq!(
        long.unwrap_err().to_string(),
        "loop 0 is 100 periods long in v: at most 64 are supported"
    );
}

#[test]
fn curves_name_what_is_wrong() {
    use TrimCurveError as E;
    let two = [DVec2::ZERO, DVec2::ONE];
    let say = |curve: Result<TrimCurve, E>| curve.unwrap_err().to_string();
    assert_eq!(say(TrimCurve::polyline(&two[..1])), "1 point: a curve needs at least 2");
    assert_eq!(
        say(TrimCurve::line(DVec2::ZERO, DVec2::new(0.0, f64::NAN))),
        "point 1 is (0, NaN): it must be finite and at most 1e100"
    );
    assert_eq!(
        say(TrimCurve::bezier(&two, Some(&[1.0]))),
        "1 weight for 2 points: each needs one, or none has any"
    );
    for (weight, shown) in [(0.0, "0"), (-1.0, "-1"), (f64::NAN, "NaN"), (1e-12, "1e-12")] {
        assert_eq!(
            say(TrimCurve::bezier(&two, Some(&[1.0, weight]))),
            format!(
                "the weight of point 1 is {shown}: it must be positive and finite, and at least 1e-9 of the largest, 1"
            )
        );
    }
    assert!(TrimCurve::bezier(&[DVec2::ONE; 40], None).is_err());
    assert_eq!(
        say(TrimCurve::circle(DVec2::ONE, -1.0)),
        "the radius is -1: it must be positive and at most 1e100"
    );
    assert_eq!(
        say(TrimCurve::circle(DVec2::ONE, 1e101)),
        "the radius is 1e101: it must be positive and at most 1e100"
    );
    assert_eq!(
        say(TrimCurve::arc(DVec2::ONE, 1.0, 0.5, 0.5)),
        "the arc goes from 0.5 to 0.5 radians: they must be finite, differ, and lie at most one turn apart"
    );
    let lifted = vec![DVec3::ZERO, DVec3::ONE];
    let lifted = NurbsCurve::new(KnotVector::bezier(1).unwrap(), lifted, None).unwrap();
    assert_eq!(
        say(TrimCurve::nurbs(&lifted)),
        "control point 1 has z = 1: a trim curve lies in the plane z = 0"
    );
    assert_eq!(TrimLoop::new(&[]).unwrap_err().to_string(), "a loop needs at least one curve");
}

#[test]
fn a_tangle_is_refused_in_time() {
    let mut random = Random::new(99);
    let corners: Vec<DVec2> =
        (0..10_000).map(|_| DVec2::new(random.next(), random.next())).collect();
    let tangle = TrimLoop::polygon(&corners).unwrap();
    assert!(matches!(refused(&[tangle]), TrimError::SelfCrossing { index: 0, .. }));

    // Nothing crosses here, but thousands of diamonds share a corner.
    let nested: Vec<TrimLoop> = (1..=1000)
        .map(|k| 0.1 * f64::from(k))
        .map(|k| polygon(&[(0., 0.), (k, k), (2. * k, 0.), (k, -k)]))
        .collect();
    assert!(matches!(refused(&nested), TrimError::Entangled { .. }));
}

#[test]
fn many_rings_are_an_honest_outline() {
    let rings: Vec<TrimLoop> = (1..=300).map(|k| circle(0.0, 0.0, f64::from(k))).collect();
    let rings = trims(&rings);
    for k in 0..300 {
        let side = rings.side_of((f64::from(k) + 0.5) * DVec2::from_angle(0.7));
        assert_eq!(side == Side::Inside, (300 - k) % 2 == 1, "ring {k}");
    }
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        8 => -2.0..2.0f64,
        4 => (-3i32..4).prop_map(f64::from),
        1 => prop::num::f64::NORMAL,
        1 => prop::num::f64::ANY,
        1 => -1e-300..1e-300f64,
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// Any numbers give an answer or an error, and the answers agree.
    #[test]
    fn no_numbers_panic(
        numbers in prop::collection::vec((any_number(), any_number()), 1..12),
        weights in prop::collection::vec(0.01..3.0f64, 12),
        degree in 1usize..6,
        query in (any_number(), any_number()),
        reach in (any_number(), any_number()),
    ) {
        let mut points: Vec<DVec2> = numbers.iter().map(|&(u, v)| DVec2::new(u, v)).collect();
        let polygon = TrimLoop::polygon(&points);
        points.push(points[0]);
        points.truncate(13);
        let mut weights = weights;
        weights.truncate(points.len());
        let bezier = TrimCurve::bezier(&points, Some(&weights))
            .map_err(TrimLoopError::from)
            .and_then(|curve| TrimLoop::new(&[curve]));
        let spline = KnotVector::clamped_uniform(degree, points.len())
            .ok()
            .and_then(|knots| {
                let points = points.iter().map(|p| p.extend(0.0)).collect();
                NurbsCurve::new(knots, points, None).ok()
            })
            .and_then(|curve| TrimCurve::nurbs(&curve).ok())
            .and_then(|curve| TrimLoop::new(&[curve]).ok());
        let domain = TrimDomain::new([-1.0, 1.0], [-1.0, 1.5]).unwrap();
        let query = DVec2::new(query.0, query.1);
        let reach = DVec2::new(reach.0, reach.1);
        for one in [polygon.ok(), bezier.ok(), spline].into_iter().flatten() {
            for domain in [domain, domain.periodic_in(Direction::V)] {
                let loops = std::slice::from_ref(&one);
                let Ok(trims) = Trims::new(domain, Kept::Odd, loops) else { continue };
                let side = trims.side_of(query);
                let edge = matches!(side, Side::Edge { .. });
                prop_assert!(!edge || trims.meets(&UvBox::about(query, DVec2::ZERO)));
                // A rectangle of the domain, and a point of it.
                let (UvBox { min, max }, bounds) = (UvBox::about(query, reach), domain.bounds());
                let rect = UvBox { min: min.max(bounds.min), max: max.min(bounds.max) };
                if rect.holds(query) {
                    match trims.classify(&rect) {
                        Coverage::Inside => prop_assert_eq!(side, Side::Inside),
                        Coverage::Outside => prop_assert_eq!(side, Side::Outside),
                        Coverage::Mixed => {}
                    }
                }
                let size = one.bounds().size().max_element();
                prop_assert!(trims.outlines(1e-3 * size).is_ok());
            }
        }
    }
}

#[test]
fn edges_that_run_out_and_back_are_refused() {
    let corners =
        |tip: f64| [(2., 2.), (8., 2.), (8., 5.), (tip, 5.), (8., 5.), (8., 8.), (2., 8.)];
    for tip in [9.0, 6.0] {
        let error = refused(&[square(20.0, 20.0, 1.0), polygon(&corners(tip))]);
        let message = format!(
            "loop 1: the loop has a dangling edge: at ({tip}, 5) it turns round and runs back over \
             itself, to (8, 5) at least; leave that edge out, in which nothing is enclosed"
        );
        assert_eq!(error.to_string(), message);
    }
    // A bridge to a hole is crossed there and back, but not immediately.
    let wide = TrimDomain::new([0.0, 10.0], [0.0, 10.0]).unwrap();
    let ring = [
        (2., 2.),
        (8., 2.),
        (8., 5.),
        (6., 5.),
        (6., 4.),
        (4., 4.),
        (4., 6.),
        (6., 6.),
        (6., 5.),
        (8., 5.),
        (8., 8.),
        (2., 8.),
    ];
    let ring = Trims::new(wide, Kept::Odd, &[polygon(&ring)]).unwrap();
    assert_eq!(ring.side_of(DVec2::new(5.0, 5.0)), Side::Outside);
    assert_eq!(ring.side_of(DVec2::new(3.0, 5.0)), Side::Inside);
}

#[test]
fn a_loop_run_through_twice_is_told_from_one_that_encloses_nothing() {
    let corners = [(2., 2.), (8., 2.), (8., 8.), (2., 8.)];
    let twice: Vec<_> = corners.into_iter().chain(corners).collect();
    assert_eq!(
        refused(&[polygon(&twice)]).to_string(),
        "loop 0: the loop on (2, 2) to (8, 8) is run through more than once: what is passed twice \
         cuts nothing; give it once"
    );
    // A point to within rounding.
    let least = refused(&[circle(0.5, 0.5, 1e-15)]);
    assert!(least.to_string().starts_with("loop 0: the loop encloses nothing"), "{least}");
    let round = TrimCurve::circle(DVec2::splat(5.0), 1.0).unwrap();
    let twice = TrimLoop::new(&[round.clone(), round]).unwrap();
    assert!(matches!(
        refused(&[twice]),
        TrimError::Loop { index: 0, error: TrimLoopError::Repeated { .. } }
    ));
}

/// Kept is what lies between two lines that meet far beyond the domain.
#[test]
fn loops_may_reach_far_but_not_where_digits_are_lost() {
    let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap();
    let wedge = |far: f64| {
        let corners = [(0.25, 0.25), (far, 0.5), (0.25, 0.75)];
        Trims::new(domain, Kept::Odd, &[polygon(&corners)])
    };
    for far in [3.0, 1e3, 1e6, 1e9] {
        let trims = wedge(far).unwrap();
        for k in 1..500 {
            let u = 0.25 + 1.5e-3 * f64::from(k);
            let edge = 0.25 + 0.25 * (u - 0.25) / (far - 0.25);
            for off in [-0.1, -1e-6, -1e-9, 1e-9, 1e-6, 0.1] {
                let kept = if off > 0.0 { Side::Inside } else { Side::Outside };
                for v in [edge + off, 1.0 - (edge + off)] {
                    assert_eq!(trims.side_of(DVec2::new(u, v)), kept, "{far:e}: {u}, {v}");
                }
            }
        }
    }
    assert_eq!(
        wedge(2e9).unwrap_err().to_string(),
        "loop 0 reaches u = 2000000000, too far from the domain, 0 to 1: at most 1e9 times its length is \
         supported; cut the loop off nearer to it"
    );
    let round = Trims::new(domain, Kept::Odd, &[circle(1e9 + 0.5, 0.5, 1e9)]);
    assert!(matches!(round, Err(TrimError::TooFar { direction: Direction::U, .. })), "{round:?}");
    let domain = domain.periodic_in(Direction::U);
    let away = Trims::new(domain, Kept::Odd, &[circle(2e9 + 0.5, 0.5, 0.25)]);
    let advice = "times its length is supported; move the loop by whole periods";
    assert!(away.as_ref().unwrap_err().to_string().ends_with(advice), "{away:?}");
}
