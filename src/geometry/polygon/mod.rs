//! Control polygons in homogeneous coordinates, those of curves and the rows and columns of control
//! nets alike: de Casteljau's algorithm, knot insertion, degree elevation, Bézier extraction.

mod bezier;
mod elevation;
mod extraction;
mod insertion;

pub use bezier::{bernstein, de_casteljau, split_bezier};
pub(crate) use elevation::elevate;
pub(crate) use extraction::{Extraction, Extractions};
pub(crate) use insertion::{Insertions, merged, mix, mix_by, refine, restrict, shares};
