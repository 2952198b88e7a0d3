//! Curves and surfaces as authored: knot vectors, control nets, weights.

mod arrange;
mod basis;
mod derivatives;
mod elevate;
mod evaluate;
mod knot_error;
mod knots;
mod line;
mod refine;
pub mod shapes;
mod surface;
mod surface_error;

pub use basis::{BasisDerivatives, BasisValues};
pub use derivatives::SurfaceDerivatives;
pub use knot_error::KnotError;
pub use knots::{KnotVector, MAX_DEGREE, MAX_POINTS, Span};
pub use surface::NurbsSurface;
pub use surface_error::{Direction, SurfaceError};

#[cfg(test)]
mod refine_tests;
