//! Tensor-product NURBS surfaces.

mod arrange;
mod bezier_form;
mod closed;
mod curvature;
mod derivatives;
mod error;
mod evaluate;
mod iso;
mod matrix_patch;
#[cfg(test)]
mod normal_tests;
mod nurbs_surface;
mod power_patch;
mod refine;
#[cfg(test)]
mod refine_tests;
#[cfg(test)]
mod tests;

pub(crate) use arrange::check_invertible;
pub(crate) use bezier_form::BezierForm;
pub use curvature::SurfaceCurvature;
pub use derivatives::SurfaceDerivatives;
pub use error::SurfaceError;
pub use matrix_patch::{matrix_patch, matrix_surface};
pub use nurbs_surface::NurbsSurface;
