//! Lines in space about which things are turned.

use glam::DVec3;

use super::{ConstructError, DirectionOf};
use crate::geometry::MAX_MAGNITUDE;
use crate::math::unit;

/// A line in space about which things are turned.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    origin: DVec3,
    /// A unit vector, exact along the coordinate axes.
    direction: DVec3,
}

impl Axis {
    /// The line through a point in a direction of any length.
    ///
    /// # Errors
    /// When a coordinate is not finite, the point is farther away than [`MAX_MAGNITUDE`], or the
    /// direction is zero.
    pub fn new(origin: DVec3, direction: DVec3) -> Result<Self, ConstructError> {
        if !origin.is_finite() {
            return Err(ConstructError::Point { what: "a point of the axis", point: origin });
        }
        if origin.abs().max_element() > MAX_MAGNITUDE {
            return Err(ConstructError::FarAxis { point: origin });
        }
        let unit = unit(direction)
            .ok_or(ConstructError::Direction { what: DirectionOf::Axis, vector: direction })?;
        Ok(Self { origin, direction: unit })
    }

    /// The height of a point along the axis, measured from the point by which the axis is given.
    pub(crate) fn height(&self, point: DVec3) -> f64 {
        self.direction.dot(point - self.origin)
    }

    /// The direction of the axis, of length 1.
    pub(crate) fn direction(&self) -> DVec3 {
        self.direction
    }

    /// The point of the axis that is nearest to another point.
    pub(crate) fn nearest(&self, point: DVec3) -> DVec3 {
        self.origin + self.direction * self.height(point)
    }

    /// The largest absolute coordinate of the point by which the axis is given.
    pub(crate) fn magnitude(&self) -> f64 {
        self.origin.abs().max_element()
    }

    /// The vector from the axis to a point, at right angles to it.
    pub(crate) fn across(&self, point: DVec3) -> DVec3 {
        point - self.origin - self.direction * self.height(point)
    }

    /// The z axis.
    pub const Z: Self = Self { origin: DVec3::ZERO, direction: DVec3::Z };
}
