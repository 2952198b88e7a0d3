//! Loops that cross themselves, or run back over themselves, close to a joint.

use glam::DVec2;

use super::tests::trims;
use super::{Side, TrimCurve, TrimDomain, TrimError, TrimLoop, Trims, UvBox};

/// How steep the parabola of a cusp is.
const STEEP: f64 = 1e-2;

/// Curves that meet at the origin at a tiny angle and cross again at u = `back`: from u = 1 along
/// v = 0 to the origin, and back to u = 1 along the parabola `v = STEEP u (u − back)`. Then further
/// corners.
fn cusp(back: f64, corners: &[(f64, f64)]) -> TrimLoop {
    let [tip, far] = [DVec2::ZERO, DVec2::new(1.0, STEEP * (1.0 - back))];
    let straight = [DVec2::X, DVec2::new(0.5, 0.0), tip];
    let bent = [tip, DVec2::new(0.5, -0.5 * STEEP * back), far];
    let mut rest = vec![far];
    rest.extend(corners.iter().map(|&corner| DVec2::from(corner)));
    rest.push(DVec2::X);
    TrimLoop::new(&[
        TrimCurve::bezier(&straight, None).unwrap(),
        TrimCurve::bezier(&bent, None).unwrap(),
        TrimCurve::polyline(&rest).unwrap(),
    ])
    .unwrap()
}

fn refusal(one: TrimLoop) -> Option<TrimError> {
    let wide = TrimDomain::new([-9.0, 9.0], [-9.0, 9.0]).unwrap();
    Trims::new(wide, super::Kept::Odd, &[one]).err()
}

/// The corners that close a cusp to a large square without what lies between the two curves.
const AROUND: [(f64, f64); 4] = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0)];

#[test]
fn curves_may_cross_again_beside_their_joint() {
    for (corners, within) in [(&[][..], Side::Inside), (&AROUND, Side::Outside)] {
        let beyond = if within == Side::Inside { Side::Outside } else { Side::Inside };
        for back in [0.0, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3] {
            let one = cusp(back, corners);
            for one in [one.reversed(), one] {
                let trims = trims(&[one]);
                let mut told = 0;
                for k in 1..4000 {
                    // Dense in the lobe and beside it.
                    let u = if k < 2000 { 1e-3 * f64::from(k) * back } else { f64::from(k) / 4e3 };
                    let v = STEEP * u * (u - back);
                    // Between the curves, and on either side of both.
                    let side = trims.side_of(DVec2::new(u, 0.5 * v));
                    let is_edge = matches!(side, Side::Edge { .. });
                    assert!(side == within || is_edge && v.abs() < 3e-14, "{back:e}: {u}, {v:e}");
                    told += usize::from(!is_edge);
                    for off in [-1e-12, 1e-12] {
                        let v = if (off > 0.0) == (v > 0.0) { v + off } else { off };
                        assert_eq!(trims.side_of(DVec2::new(u, v)), beyond, "{back:e}: {u}, {v}");
                    }
                    let on = trims.side_of(DVec2::new(u, 0.0));
                    assert!(matches!(on, Side::Edge { .. }), "{back:e}: {u}, {on:?}");
                    // No rectangle with points on both sides is all inside or all outside.
                    let rect = UvBox::new([0.9 * u, u], [-1e-9, 1e-9]);
                    assert_eq!(trims.classify(&rect), super::Coverage::Mixed);
                }
                assert!(told > 1900, "{back:e}: {told}");
            }
        }
        for back in [3e-2, 0.1] {
            let error = refusal(cusp(back, corners));
            let Some(TrimError::SelfCrossing { index: 0, at }) = error else {
                panic!("{back}: {error:?}")
            };
            assert!(
                at.x <= back * (1.0 + 1e-6) && at.y.abs() < STEEP * back * back,
                "{back}: {at}"
            );
        }
    }
}

/// In the directions around the crossing, the sides are those of points nearby.
#[test]
fn sectors_at_the_crossing_of_a_lobe() {
    for (corners, is_within) in [(&[][..], true), (&AROUND, false)] {
        let back = 2f64.powi(-15);
        let trims = trims(&[cusp(back, corners)]);
        let sectors = trims.around(DVec2::new(back, 0.0), DVec2::splat(1e-17)).unwrap();
        assert_eq!(sectors.edges().len(), 4, "{sectors:?}");
        let small = 0.5 * STEEP * back;
        for (angle, between) in
            [(small, true), (std::f64::consts::PI + small, true), (1.0, false), (4.0, false)]
        {
            assert_eq!(sectors.keeps(angle), between == is_within, "{angle}: {sectors:?}");
        }
    }
}

#[test]
fn lines_may_run_on_a_little_and_come_back() {
    let tip = |over: f64| {
        let corners = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0 + over), (1.0, 1.0), (0.0, 1.0)];
        TrimLoop::polygon(&corners.map(DVec2::from)).unwrap()
    };
    for over in [1e-9, 1e-6, 9e-5] {
        let square = trims(&[tip(over)]);
        for v in [0.5, 1.0 - 1e-9] {
            assert_eq!(square.side_of(DVec2::new(1.0 - 1e-9, v)), Side::Inside);
            assert_eq!(square.side_of(DVec2::new(1.0 + 1e-9, v)), Side::Outside);
        }
        assert_eq!(square.side_of(DVec2::new(0.5, 1.0 + 0.5 * over)), Side::Outside);
    }
    assert!(refusal(tip(2e-4)).is_some());

    // The two ends of the edge are told apart, however many digits this takes.
    let far = tip(2e-4).shifted(DVec2::new(0.0, 6.25));
    assert_eq!(
        refusal(far).unwrap().to_string(),
        "loop 0: the loop has a dangling edge: at (1, 7.2502) it turns round and runs back over \
         itself, to (1, 7.25) at least; leave that edge out, in which nothing is enclosed"
    );
    let far = tip(2e-4).shifted(DVec2::new(0.0, 7.99999e6));
    let wide = TrimDomain::new([0.0, 1.0], [0.0, 1e7]).unwrap();
    let error = Trims::new(wide, super::Kept::Odd, &[far]).unwrap_err().to_string();
    assert!(error.contains("at (1, 7999991.0002)"), "{error}");
}

/// A bow tie, however short its curves, is refused unless one half of it is tiny beside the other.
#[test]
fn bow_ties_are_refused_unless_one_half_is_tiny() {
    let tie = |size: f64, half: f64| {
        let corners = [(-1.0, -1.0), (half, half), (half, -half), (-1.0, 1.0)];
        TrimLoop::polygon(&corners.map(|corner| size * DVec2::from(corner))).unwrap()
    };
    for size in [1e-6, 1.0] {
        assert!(matches!(refusal(tie(size, 1.0)), Some(TrimError::SelfCrossing { .. })));
        assert!(matches!(refusal(tie(size, 1e-3)), Some(TrimError::SelfCrossing { .. })));
        assert!(refusal(tie(size, 4e-5)).is_none());
    }
}
