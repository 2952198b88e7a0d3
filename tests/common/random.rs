//! Random numbers that are the same on every machine.

use glam::DVec3;
use nurbray::math::SplitMix;

/// Any seed will do, streams of different seeds are unrelated.
#[derive(Clone, Debug)]
pub(crate) struct Random(SplitMix);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(SplitMix::new(seed))
    }

    /// Uniform in `[0, 1)`.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0.unit()
    }

    /// Uniform in `[from, to)`.
    pub(crate) fn between(&mut self, from: f64, to: f64) -> f64 {
        from + self.unit() * (to - from)
    }

    /// `10^x` with `x` uniform in `[from, to)`.
    pub(crate) fn power_of_ten(&mut self, from: f64, to: f64) -> f64 {
        10f64.powf(self.between(from, to))
    }

    /// One of `0 … count − 1`.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// 1 or −1.
    pub(crate) fn sign(&mut self) -> f64 {
        if self.unit() < 0.5 { 1.0 } else { -1.0 }
    }

    /// One of these.
    pub(crate) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.below(from.len())]
    }

    /// Uniform in the cube `[−1, 1)³`.
    pub(crate) fn cube(&mut self) -> DVec3 {
        DVec3::new(self.between(-1.0, 1.0), self.between(-1.0, 1.0), self.between(-1.0, 1.0))
    }

    /// Uniform on the unit sphere.
    pub(crate) fn direction(&mut self) -> DVec3 {
        loop {
            let point = self.cube();
            let length = point.length();
            if length > 0.1 && length <= 1.0 {
                return point / length;
            }
        }
    }

    /// A unit vector perpendicular to a vector.
    pub(crate) fn perpendicular(&mut self, to: DVec3) -> DVec3 {
        loop {
            let across = self.direction().cross(to.normalize());
            if across.length() > 0.1 {
                return across.normalize();
            }
        }
    }
}
