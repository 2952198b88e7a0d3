//! Trimmed NURBS surfaces.

mod edge_curves;
mod trim_edge;
mod trimmed_surface;

pub use trim_edge::TrimEdge;
pub use trimmed_surface::TrimmedSurface;
