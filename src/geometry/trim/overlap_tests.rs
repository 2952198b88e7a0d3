//! Loops that cross each other by next to nothing where they touch.

use glam::DVec2;

use super::{Coverage, Kept, Side, TrimDomain, TrimError, TrimLoop, Trims, UvBox};
use crate::geometry::Direction;

const SIZE: f64 = 4.0;

/// Overlaps that are tolerated for loops about a unit large, and ones that are not.
const LITTLE: [f64; 5] = [1e-15, 1e-13, 1e-10, 1e-7, 7e-6];
const MUCH: [f64; 4] = [2e-5, 1e-4, 1e-2, 0.3];

fn made(loops: &[TrimLoop]) -> Result<Trims, TrimError> {
    Trims::new(TrimDomain::new([-9.0, 9.0], [-9.0, 9.0]).unwrap(), Kept::Odd, loops)
}

fn square(corner: DVec2, size: f64) -> TrimLoop {
    let far = corner + DVec2::splat(size);
    TrimLoop::rectangle(UvBox::new([corner.x, far.x], [corner.y, far.y])).unwrap()
}

fn polygon(corners: &[(f64, f64)]) -> TrimLoop {
    let corners: Vec<DVec2> = corners.iter().map(|&corner| corner.into()).collect();
    TrimLoop::polygon(&corners).unwrap()
}

/// Holes of a square from the origin, about a unit large, that reach beyond its side `v = SIZE` by
/// this much: with a corner, with a round, with half of a side, and with all of it.
fn holes_over(over: f64) -> [TrimLoop; 4] {
    let v = SIZE + over;
    [
        polygon(&[(1.0, 3.0), (2.0, 3.0), (1.5, v)]),
        TrimLoop::circle(DVec2::new(1.5, v - 0.5), 0.5).unwrap(),
        polygon(&[(1.0, 3.0), (2.0, 3.0), (2.0, SIZE - over), (1.0, v)]),
        polygon(&[(1.0, 3.0), (2.0, 3.0), (2.0, v), (1.0, v)]),
    ]
}

#[test]
fn two_loops_may_cross_by_next_to_nothing() {
    let outline = square(DVec2::ZERO, SIZE);
    for over in LITTLE {
        for hole in holes_over(over) {
            for loops in [[outline.clone(), hole.clone()], [hole.clone(), outline.reversed()]] {
                let trims = made(&loops).unwrap_or_else(|error| panic!("{over:e}: {error}"));
                assert_eq!(trims.side_of(DVec2::new(1.5, 3.3)), Side::Outside);
                assert_eq!(trims.side_of(DVec2::new(0.5, 3.3)), Side::Inside);
                for v in [SIZE - 2e-5, SIZE + 2e-5] {
                    let beside = if v < SIZE { Side::Inside } else { Side::Outside };
                    assert_eq!(trims.side_of(DVec2::new(0.5, v)), beside, "{over:e}");
                    let around = UvBox::new([0.4, 1.7], [v - 3e-5, v + 3e-5]);
                    assert_eq!(trims.classify(&around), Coverage::Mixed, "{over:e}");
                }
            }
        }
    }
    // What lies beyond the outline counts by the even–odd rule.
    let trims = made(&[outline.clone(), holes_over(1e-7)[3].clone()]).unwrap();
    assert_eq!(trims.side_of(DVec2::new(1.5, SIZE + 0.5e-7)), Side::Inside);
    assert_eq!(trims.side_of(DVec2::new(1.5, SIZE - 0.5e-7)), Side::Outside);

    for over in MUCH {
        for hole in holes_over(over) {
            let error = made(&[outline.clone(), hole]).unwrap_err();
            let TrimError::Crossing { loops: [0, 1], at } = error else {
                panic!("{over:e}: {error:?}")
            };
            assert!((at.y - SIZE).abs() < 1e-12, "{over:e}: {at}");
        }
    }
}

/// The smaller loop is the measure.
#[test]
fn tiny_holes_overlap_as_little_as_they_are_tiny() {
    let outline = square(DVec2::ZERO, SIZE);
    for size in [1e-2, 1e-4] {
        let hole = |over: f64| square(DVec2::new(1.0, SIZE - size * (1.0 - over)), size);
        assert!(made(&[outline.clone(), hole(9e-6)]).is_ok(), "{size:e}");
        let error = made(&[outline.clone(), hole(2e-5)]).unwrap_err();
        assert!(matches!(error, TrimError::Crossing { .. }), "{size:e}: {error}");
    }
}

/// Half planes reach as far beyond the domain as they like; what counts is what overlaps in it.
#[test]
fn loops_that_reach_far_overlap_no_more_than_others() {
    let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap();
    for far in [1.0, 1e3, 1e5, 1e8] {
        let half_planes = |over: f64| {
            let sides = [[-far, 0.5], [0.5 - over, 1.0 + far]];
            let loops = sides.map(|u| TrimLoop::rectangle(UvBox::new(u, [-far, 1.0 + far])));
            Trims::new(domain, Kept::Even, &loops.map(Result::unwrap))
        };
        assert!(half_planes(9e-6).is_ok(), "{far:e}");
        for over in MUCH {
            let error = half_planes(over).unwrap_err();
            assert!(matches!(error, TrimError::Crossing { .. }), "{far:e}, {over:e}: {error}");
        }
    }
}

/// A tooth leaves the outline so near its corner that only its other sides are clear of it.
#[test]
fn large_overlaps_are_seen_wherever_they_begin() {
    let outline = square(DVec2::ZERO, SIZE);
    for over in LITTLE {
        let v = SIZE + over;
        let tooth = polygon(&[(1.0, 3.0), (2.0, 3.0), (2.0, v), (1.5, 5.0), (1.0, v)]);
        let error = made(&[outline.clone(), tooth]).unwrap_err();
        assert!(matches!(error, TrimError::Crossing { loops: [0, 1], .. }), "{over:e}: {error}");
    }
}

/// Loops that are the same but for next to nothing would leave slivers only.
#[test]
fn copies_by_rounding_are_told_as_such() {
    let tilted = |over: f64| {
        polygon(&[(0.0, -over), (SIZE, over), (SIZE - over, SIZE), (over, SIZE - over)])
    };
    for over in LITTLE {
        let error = made(&[square(DVec2::ZERO, SIZE), tilted(over)]).unwrap_err();
        assert!(matches!(error, TrimError::Coincident { loops: [0, 1] }), "{over:e}: {error}");
    }
}

/// A slot along a slanted side, narrower than the overlap that is tolerated, is no copy of what it
/// touches or overlaps.
#[test]
fn narrow_slots_may_overlap_what_they_run_along() {
    let outline = polygon(&[(0.1, 0.1), (0.9, 0.1), (0.9, 0.9)]);
    for wide in [1e-3, 2e-5, 3e-6, 3e-8] {
        for over in [0.0, 1e-12, 1e-9] {
            let [near, far] = [0.3, 0.7].map(|at| (at, at + over));
            let slot = polygon(&[near, far, (0.7 + wide, 0.7 - wide), (0.3 + wide, 0.3 - wide)]);
            for loops in [[outline.clone(), slot.clone()], [slot.clone(), outline.clone()]] {
                let trims = made(&loops).unwrap_or_else(|error| panic!("{wide}, {over}: {error}"));
                let within = DVec2::new(0.5 + 0.5 * wide, 0.5 - 0.5 * wide);
                assert_eq!(trims.side_of(within), Side::Outside, "{wide}, {over}");
                assert_eq!(trims.side_of(DVec2::new(0.6, 0.4)), Side::Inside, "{wide}, {over}");
            }
        }
    }
}

#[test]
fn a_loop_may_overlap_its_copy_a_period_away_by_next_to_nothing() {
    let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap().periodic_in(Direction::U);
    let around = |over: f64| {
        let corners = [(0.0, 0.5), (0.5, 0.2), (1.0 + over, 0.5), (0.5, 0.8)];
        Trims::new(domain, Kept::Odd, &[polygon(&corners)])
    };
    for over in LITTLE {
        let trims = around(over).unwrap_or_else(|error| panic!("{over:e}: {error}"));
        assert_eq!(trims.side_of(DVec2::new(0.99, 0.5)), Side::Inside);
        assert_eq!(trims.side_of(DVec2::new(0.01, 0.6)), Side::Outside);
    }
    for over in MUCH {
        let error = around(2.0 * over).unwrap_err();
        assert!(matches!(error, TrimError::CopyCrossing { index: 0, .. }), "{over:e}: {error}");
    }
}
