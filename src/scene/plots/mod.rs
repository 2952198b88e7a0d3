//! From plots as written to plots whose numbers are checked: curves, basis functions, and surfaces
//! in their places as `making` makes them. A plot is drawn as lines and never traced, so the world
//! is not known here, nor are plots known to it.

mod basis;
mod curve;
mod plot;
mod surface;

pub use basis::{PlottedBasis, PlottedFunctions};
pub use curve::{PlottedCurve, SplineData};
pub use plot::Plot;
pub use surface::{LoopCurve, LoopCurveKind, PlottedSurface};
