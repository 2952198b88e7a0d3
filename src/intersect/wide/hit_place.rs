//! Where a hit is.

use glam::DVec2;

/// Where a hit is: enough to tell which of two is the nearer.
#[derive(Clone, Copy, Debug)]
pub(crate) struct HitPlace {
    pub leaf: u32,
    pub z: f64,
    pub z_error: f64,
    pub st: DVec2,
}
