//! A ray and the part of it that counts.

use glam::DVec3;
use thiserror::Error;

use super::{Shown, ShownVector};

/// The part of the line `o + t d` with `t_min < t < t_max`: by default a half line.
///
/// `t` is measured in units of `d`, whatever its length; the range is open, so the
/// default `(0, ∞)` leaves out the origin itself.
///
/// # Invariants, checked once in [`Ray::with_range`]
/// - coordinates of the origin and components of the direction are finite, and at most
///   [`Ray::MAX_MAGNITUDE`];
/// - the largest component of the direction is at least [`Ray::MIN_DIRECTION`];
/// - `t_min < t_max`, neither is NaN; either may be infinite.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)] // eight numbers in the order of `to_array`: one load for a wide register
pub struct Ray {
    origin: DVec3,
    direction: DVec3,
    t_min: f64,
    t_max: f64,
}

/// Why numbers cannot be a ray.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RayError {
    /// The origin is not finite, or too far away.
    #[error(
        "the origin is {}: coordinates must be finite (up to {:e})",
        ShownVector(*.0),
        Ray::MAX_MAGNITUDE
    )]
    Origin(DVec3),
    /// The direction is not finite, too long or too short.
    #[error(
        "the direction is {}: it must be finite, its largest component from {:e} to {:e}",
        ShownVector(*.0),
        Ray::MIN_DIRECTION,
        Ray::MAX_MAGNITUDE
    )]
    Direction(DVec3),
    /// The direction has no length.
    #[error("the direction is zero: a ray needs one that points somewhere")]
    NoDirection,
    /// The range of `t` is empty or not a number.
    #[error("t_min {} and t_max {}: a ray needs t_min < t_max", Shown(*t_min), Shown(*t_max))]
    Range {
        /// The lower end as given.
        t_min: f64,
        /// The upper end as given.
        t_max: f64,
    },
}

impl Ray {
    /// The largest coordinate of an origin, and the largest component of a direction.
    ///
    /// Surfaces end at 1e70, so `t` is at most a few times 1e300 for any of their points: with
    /// directions shorter than [`MIN_DIRECTION`](Self::MIN_DIRECTION) no f64 could hold it, and a
    /// surface could lie on a ray without a hit to report it.
    pub const MAX_MAGNITUDE: f64 = 1e150;

    /// The least that the largest component of a direction may be.
    pub const MIN_DIRECTION: f64 = 1e-150;

    /// The ray `o + t d` with `t` in `(0, ∞)`.
    ///
    /// # Errors
    /// When the origin or the direction is not finite or too large, or the direction is zero or
    /// too short.
    pub fn new(origin: DVec3, direction: DVec3) -> Result<Self, RayError> {
        Self::with_range(origin, direction, 0.0, f64::INFINITY)
    }

    /// The ray `o + t d` with `t` in `(t_min, t_max)`.
    ///
    /// # Errors
    /// As [`Ray::new`], and when not `t_min < t_max`.
    pub fn with_range(
        origin: DVec3,
        direction: DVec3,
        t_min: f64,
        t_max: f64,
    ) -> Result<Self, RayError> {
        let usable = |v: DVec3| v.abs().cmple(DVec3::splat(Self::MAX_MAGNITUDE)).all(); // NaN is not
        if !usable(origin) {
            return Err(RayError::Origin(origin));
        }
        if direction == DVec3::ZERO {
            return Err(RayError::NoDirection);
        }
        let long = direction.abs().cmpge(DVec3::splat(Self::MIN_DIRECTION)).any();
        if !(usable(direction) && long) {
            return Err(RayError::Direction(direction));
        }
        let ordered = t_min < t_max; // false for NaN
        if !ordered {
            return Err(RayError::Range { t_min, t_max });
        }
        Ok(Self { origin, direction, t_min, t_max })
    }

    /// Where `t = 0`.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// The direction as given; its length is the unit of `t`.
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The open lower end of the range.
    pub fn t_min(&self) -> f64 {
        self.t_min
    }

    /// The open upper end of the range.
    pub fn t_max(&self) -> f64 {
        self.t_max
    }

    /// Origin, direction and range.
    #[inline]
    pub(crate) fn to_array(self) -> [f64; 8] {
        let (o, d) = (self.origin, self.direction);
        [o.x, o.y, o.z, d.x, d.y, d.z, self.t_min, self.t_max]
    }

    /// The point `o + t d`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_is_not_a_ray() {
        let (o, d) = (DVec3::ZERO, DVec3::X);
        assert_eq!(Ray::new(o, DVec3::ZERO), Err(RayError::NoDirection));
        assert!(matches!(Ray::new(DVec3::NAN, d), Err(RayError::Origin(_))));
        assert!(matches!(Ray::new(o, DVec3::INFINITY), Err(RayError::Direction(_))));
        assert!(matches!(Ray::with_range(o, d, 1.0, 1.0), Err(RayError::Range { .. })));
        assert!(matches!(Ray::with_range(o, d, f64::NAN, 1.0), Err(RayError::Range { .. })));
        assert!(matches!(Ray::new(DVec3::splat(1e151), d), Err(RayError::Origin(_))));
        assert!(Ray::new(o, DVec3::splat(1e150)).is_ok());
        assert!(matches!(Ray::new(o, DVec3::splat(1e151)), Err(RayError::Direction(_))));
        assert!(Ray::new(o, DVec3::new(0.0, -1e-150, 1e-320)).is_ok());
        let short = Ray::new(o, DVec3::new(0.0, -1e-310, 0.0)).unwrap_err();
        assert_eq!(
            short.to_string(),
            "the direction is (0, -1e-310, 0): it must be finite, its largest component from \
             1e-150 to 1e150"
        );
    }
}
