//! What tests of the fast kernels trace.

use glam::DVec4;

use crate::geometry::{KnotVector, NurbsSurface};

/// A bicubic sheet of hills whose weights differ from point to point.
pub(crate) fn weighted_hills() -> NurbsSurface {
    let knots = KnotVector::clamped_uniform(3, 12).unwrap();
    let number = |k: usize| (k as f64 * 0.618_033_988_75).fract();
    let control = (0..144).map(|k| {
        let (x, y) = ((k / 12) as f64, (k % 12) as f64);
        let weight = 0.5 + 1.5 * number(k);
        weight * DVec4::new(x, y, (1.3 * x).sin() * y.cos(), 1.0)
    });
    NurbsSurface::from_homogeneous(knots.clone(), knots, control.collect()).unwrap()
}
