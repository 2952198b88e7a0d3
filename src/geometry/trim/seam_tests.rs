//! Sides of loops along the seam of a periodic domain.

use glam::DVec2;

use super::{Kept, Side, TrimCurve, TrimDomain, TrimError, TrimLoop, Trims};
use crate::geometry::Direction;

/// A band around a cylinder whose two sides on the seam are off by up to this much.
fn band(wobble: f64) -> Result<Trims, TrimError> {
    let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap().periodic_in(Direction::U);
    let line = |points: &[(f64, f64)]| {
        TrimCurve::polyline(&points.iter().map(|&p| p.into()).collect::<Vec<DVec2>>()).unwrap()
    };
    let side = |points: [(f64, f64); 4]| TrimCurve::bezier(&points.map(DVec2::from), None).unwrap();
    let curves = [
        line(&[(0.0, 0.3), (1.0, 0.3)]),
        side([(1.0, 0.3), (1.0 - wobble, 0.4), (1.0 + wobble, 0.5), (1.0, 0.6)]),
        line(&[(1.0, 0.6), (0.0, 0.6)]),
        side([(0.0, 0.6), (-wobble, 0.5), (0.5 * wobble, 0.4), (0.0, 0.3)]),
    ];
    Trims::new(domain, Kept::Odd, &[TrimLoop::new(&curves).unwrap()])
}

#[test]
fn sides_along_a_seam_that_are_not_quite_straight_lie_on_it() {
    for wobble in [0.0, 1e-14, 1e-12, 1e-11, 1e-9, 9e-9] {
        let trims = band(wobble).unwrap();
        assert!((trims.widest_gap() - wobble).abs() <= wobble, "{wobble}");
        for v in [0.35, 0.41, 0.45, 0.5, 0.55] {
            for u in [0.0, 0.5 * wobble, 1e-9, 1e-3, 0.5, 1.0 - 1e-9, 1.0 - 0.5 * wobble, 1.0] {
                assert_ne!(trims.contains(DVec2::new(u, v)), Side::Outside, "{wobble}: {u}, {v}");
            }
            assert_eq!(trims.contains(DVec2::new(0.5, v)), Side::Inside);
        }
        assert_eq!(trims.contains(DVec2::new(0.0, 0.7)), Side::Outside);
    }
    let error = band(1e-3).err().map(|error| error.to_string()).unwrap_or_default();
    assert!(error.starts_with("loop 0 crosses itself at (u, v) = "), "{error}");
}

/// Circles whose copies, moved by a period, are less round than they were written.
#[test]
fn small_circles_on_a_seam_do_not_cross_themselves() {
    let unit = TrimDomain::new([0.0, 1.0], [0.0, 1.0]).unwrap();
    let domain = unit.periodic_in(Direction::U).periodic_in(Direction::V);
    let mut wrong = Vec::new();
    for k in 0..120 {
        let radius = if k == 0 { 1e-4 } else { 10f64.powf(-1.0 - 0.05 * f64::from(k)) };
        let u = [0.5, 0.0, 1.0, 0.01 * f64::from(k % 97)][k as usize % 4];
        let corner = DVec2::new(u, f64::from(u8::from(k / 4 % 2 == 0)));
        let circle = TrimLoop::circle(corner, radius).unwrap();
        if let Err(error) = Trims::new(domain, Kept::Odd, &[circle]) {
            wrong.push(format!("{corner} {radius}: {error}"));
        }
    }
    assert!(wrong.is_empty(), "{} wrong: {:#?}", wrong.len(), &wrong[..10.min(wrong.len())]);
}
