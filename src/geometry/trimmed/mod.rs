//! Trimmed NURBS surfaces.

mod edge_curves;
mod trimmed_surface;

pub use trimmed_surface::TrimmedSurface;
