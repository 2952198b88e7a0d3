//! Curves and surfaces as authored: knot vectors, control nets, weights.

mod knots;
mod surface;

pub use knots::KnotVector;
pub use surface::NurbsSurface;
