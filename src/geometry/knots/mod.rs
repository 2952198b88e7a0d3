//! Knot vectors, and the B-spline basis functions over them.

mod basis;
mod basis_functions;
mod error;
mod knot_vector;
#[cfg(test)]
mod tests;

pub use basis::{BasisDerivatives, BasisValues};
pub use basis_functions::BasisFunctions;
pub(crate) use basis_functions::on_span;
pub use error::KnotError;
pub use knot_vector::{KnotVector, Span};
pub(crate) use knot_vector::{LEAST_AROUND, periodic_values, unit_knots};

use crate::math::bernstein;

/// The highest degree supported.
///
/// Basis functions are evaluated in arrays of this size plus one on the stack, so that
/// nothing allocates per point. See [`bernstein::MAX_DEGREE`].
pub const MAX_DEGREE: usize = bernstein::MAX_DEGREE;

/// The largest number of control points in one direction. More is taken for a mistake and
/// refused before memory is allocated. 2²⁴ points of 32 bytes are half a gigabyte.
pub const MAX_CONTROL_POINTS: usize = 1 << 24;
