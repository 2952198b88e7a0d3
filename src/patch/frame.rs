//! Coordinates for work in f32.

use glam::{DVec3, Vec3};

use crate::math::{Aabb, rounding};

/// Boxes are grown by this fraction of the half size of what is scaled: a few roundings of f32, and
/// far more than any rounding of f64.
pub(crate) const PADDING: f64 = 4.0 * f32::EPSILON as f64;

/// Coordinates moved and scaled, by a power of two, so that a scene, or a small part of it that is
/// searched by itself, lies within `[−1, 1]³`: f32 is then as fine at 1e6 as at the origin.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ScaledFrame {
    /// The middle of the scene, or of the part.
    pub center: DVec3,
    /// Scene units to scaled coordinates.
    pub scale: f64,
}

/// An axis-parallel box in scaled coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ScaledBox {
    /// The smallest coordinates.
    pub min: Vec3,
    /// The largest coordinates.
    pub max: Vec3,
}

impl ScaledBox {
    /// The smallest box that holds all the given boxes; for none, from +∞ to −∞.
    pub(crate) fn around(boxes: &[Self]) -> Self {
        let (mut min, mut max) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
        for each in boxes {
            (min, max) = (min.min(each.min), max.max(each.max));
        }
        Self { min, max }
    }
}

impl ScaledFrame {
    /// The frame of a scene inside a box; that of an empty scene does not matter.
    pub(crate) fn around(bounds: &Aabb) -> Self {
        if bounds.is_empty() {
            return Self { center: DVec3::ZERO, scale: 1.0 };
        }
        let half = (0.5 * bounds.size()).max_element().max(f64::MIN_POSITIVE);
        Self { center: bounds.center(), scale: rounding::power_of_two_below(1.0 / half) }
    }

    /// A point in scaled coordinates.
    #[inline(always)]
    pub(crate) fn scaled(&self, point: DVec3) -> DVec3 {
        (point - self.center) * self.scale
    }

    /// A box in scaled coordinates, rounded outwards and padded.
    pub(crate) fn scaled_box(&self, bounds: &Aabb) -> ScaledBox {
        let (min, max) = (self.scaled(bounds.min) - PADDING, self.scaled(bounds.max) + PADDING);
        let below = |v: DVec3| Vec3::from_array(v.to_array().map(rounding::f32_below));
        let above = |v: DVec3| Vec3::from_array(v.to_array().map(rounding::f32_above));
        ScaledBox { min: below(min), max: above(max) }
    }
}
