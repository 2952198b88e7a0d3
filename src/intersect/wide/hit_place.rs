//! Where a hit is.

use glam::DVec2;

/// Where a hit is: enough to tell which of two is the nearer.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct HitPlace {
    pub st: DVec2,
    /// The distance along the ray.
    pub z: f64,
    /// Error bound of `z`.
    pub z_error: f64,
    pub leaf: u32,
}
