//! Named shapes: exact quadrics, arcs of circles, and some bicubic patches.
//!
//! Closed shapes are oriented outward: `Sᵤ × Sᵥ` points away from the inside. Measures that make no
//! valid surface together, as they reach too far out or are as thin as rounding errors, are an
//! error ([`ShapeError::Surface`]).

mod arc;
mod bicubic;
mod circles;
mod octant;
mod quadrics;
mod revolved;
mod turned;

pub(crate) use arc::UnitArc;
pub use bicubic::{bicubic_graph, bicubic_hood, bicubic_hood_pinched, red_book_patch};
pub use circles::{
    QuadraticArc, QuarticArc, QuarticConstants, circle_arc, circle_cubic, half_circle_cubic,
    quarter_circle_quadratic, quarter_circle_quartic, quarter_circle_weighted,
};
pub use octant::{OctantConstants, octant_quartic};
pub use quadrics::{
    hemisphere, hemisphere_inward, octant_biquadratic, octant_biquadratic_inward, plane, sphere,
};
pub use revolved::{cone, cylinder, disk, sphere_biquadratic, torus};
pub(crate) use turned::{Turned, turned_net};

use glam::DVec4;
use thiserror::Error;

use super::{KnotVector, MAX_MAGNITUDE, MIN_MAGNITUDE, NurbsSurface, SurfaceError};
use crate::math::{Measured, Shown};

/// The reason why numbers cannot be the measures of a shape.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ShapeError {
    /// A radius, width or height is not a usable length.
    #[error(
        "{measure} {}: it must be positive and finite (from {MIN_MAGNITUDE:e} to {MAX_MAGNITUDE:e})",
        Shown(*value)
    )]
    Length {
        /// The name of the measure.
        measure: &'static str,
        /// Its value.
        value: f64,
    },
    /// The measures are usable, but not together: the surface would reach too far out, or be as
    /// thin as rounding errors.
    #[error("{0}")]
    Surface(SurfaceError),
    /// Constants of a quartic triangle violate their constraint.
    #[error(
        "the constants a = {}, b = {} make no sphere: of x² + y² + z² - w², a polynomial of \
         degree 8 that must be 0, the coefficient at ({}, {}, {}) is {} of its terms, more than \
         {:.1e}; Farin's (1990) are a = {}, b = {}",
        list(.a), list(.b), .exponents[0], .exponents[1], .exponents[2], Measured(*.residual), .tolerance,
        list(&OctantConstants::farin().a()), list(&OctantConstants::farin().b())
    )]
    Octant {
        /// `a₀, a₁, a₂`.
        a: [f64; 3],
        /// `b₀, b₁, b₂, b₃`.
        b: [f64; 4],
        /// The exponents of the Bernstein coefficient that is farthest from zero.
        exponents: [usize; 3],
        /// That coefficient, as a share of the sum of its terms' magnitudes.
        residual: f64,
        /// How large that share may be.
        tolerance: f64,
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

/// Numbers with all their digits, to be found in a file or copied from a message.
fn list(numbers: &[f64]) -> String {
    let numbers: Vec<String> = numbers.iter().map(|&x| Shown(x).to_string()).collect();
    format!("[{}]", numbers.join(", "))
}

/// The surface of these knots and homogeneous control points, if it is one that rays can meet.
fn checked(knots: [KnotVector; 2], control: Vec<DVec4>) -> Result<NurbsSurface, ShapeError> {
    let [u, v] = knots;
    NurbsSurface::from_homogeneous(u, v, control).map_err(ShapeError::Surface)
}

fn check_length(measure: &'static str, value: f64) -> Result<(), ShapeError> {
    if (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&value) {
        Ok(())
    } else {
        Err(ShapeError::Length { measure, value })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shapes_are_valid_surfaces_or_errors() {
        for shape in [plane(1.0, 1e-20), cylinder(1e-30, 1.0)] {
            let error = shape.unwrap_err();
            assert!(matches!(error, ShapeError::Surface(SurfaceError::NoArea { .. })), "{error}");
        }
        // The net of the sphere reaches to four times its radius.
        let error = sphere(MAX_MAGNITUDE).unwrap_err();
        assert!(matches!(error, ShapeError::Surface(SurfaceError::Point { .. })), "{error}");
        assert!(sphere(0.25 * MAX_MAGNITUDE).is_ok() && sphere(MIN_MAGNITUDE).is_ok());
    }
}
