//! Named shapes: exact quadrics, arcs of circles, and the documents' patches.
//!
//! Closed shapes are oriented outward: `Sᵤ × Sᵥ` points away from the inside.

mod circles;
mod documents;
mod octant;
mod quadrics;
mod revolved;

pub use circles::{
    QuadraticArc, QuarticArc, QuarticConstants, circle_arc, circle_cubic, half_circle_cubic,
    quarter_circle_quadratic, quarter_circle_quartic, quarter_circle_weighted,
};
pub use documents::{deck_patch, lecture_patch_1, lecture_patch_2, lecture_patch_3};
pub use octant::octant_quartic;
pub(crate) use quadrics::unit_knots;
pub use quadrics::{
    hemisphere, hemisphere_of_the_note, octant_biquadratic, octant_of_the_note, plane, sphere,
};
pub use revolved::{cone, cylinder, disk, sphere_biquadratic, torus};

use thiserror::Error;

use super::{MAX_MAGNITUDE, MIN_MAGNITUDE};
use crate::math::Shown;

/// Why numbers cannot be the measures of a shape.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A radius, width or height is not a usable length.
    #[error(
        "{measure} {}: it must be positive and finite (from {MIN_MAGNITUDE:e} to {MAX_MAGNITUDE:e})",
        Shown(*value)
    )]
    Length {
        /// Which measure.
        measure: &'static str,
        /// Its value.
        value: f64,
    },
    /// The tube of a torus is as thick as its circle, or thicker.
    #[error(
        "minor radius {}: it must be smaller than the major radius {}, \
         else the torus meets itself",
        Shown(*minor),
        Shown(*major)
    )]
    Torus {
        /// The radius of the circle in the middle of the tube.
        major: f64,
        /// The radius of the tube.
        minor: f64,
    },
}

fn check_length(measure: &'static str, value: f64) -> Result<(), ShapeError> {
    if (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&value) {
        Ok(())
    } else {
        Err(ShapeError::Length { measure, value })
    }
}
