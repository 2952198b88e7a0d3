//! Curves and surfaces as authored: knot vectors, control nets, weights.

mod arrange;
mod basis;
mod bezier;
mod curve;
mod curve_error;
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
pub use bezier::{bernstein, de_casteljau, halves};
pub use curve::{CurveDerivatives, NurbsCurve};
pub use curve_error::CurveError;
pub use derivatives::SurfaceDerivatives;
pub use knot_error::KnotError;
pub use knots::{KnotVector, MAX_DEGREE, MAX_POINTS, Span};
pub use surface::NurbsSurface;
pub use surface_error::{Direction, SurfaceError};

#[cfg(test)]
mod refine_tests;

#[cfg(test)]
mod curve_tests;
#[cfg(test)]
mod knots_tests;
#[cfg(test)]
mod normal_tests;
#[cfg(test)]
mod surface_tests;
