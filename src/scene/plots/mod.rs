//! From plots as written to plots whose numbers are checked: of curves, of basis functions, and of
//! surfaces, which `making` puts in their places. A plot is drawn, never traced: the world is not
//! known here, nor are plots known to it.

mod basis;
mod curve;
mod plot;
mod surface;

pub use basis::{PlottedBasis, PlottedFunctions};
pub use curve::{PlottedCurve, SplineData};
pub use plot::Plot;
pub use surface::{LoopCurve, LoopCurveKind, PlottedSurface};
