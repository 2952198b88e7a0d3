//! NURBS curves.

mod arrange;
mod corner_cutting;
mod course;
mod curvature;
mod error;
mod extremes;
mod matrix_form;
mod nurbs_curve;
mod power_form;
mod quotient;
mod rational_basis;
#[cfg(test)]
mod tests;
mod uniform;

pub(crate) use arrange::SAME_PLACE;
pub use corner_cutting::{CornerCutting, PolygonEnds};
pub(crate) use course::{Course, Fold};
pub use error::CurveError;
pub(crate) use extremes::{FINEST_INTERVAL, add_extremes, add_sign_changes};
pub use matrix_form::MatrixForm;
pub use nurbs_curve::{CurveDerivatives, NurbsCurve};
pub(crate) use power_form::{PowerShares, power_coefficient, rounded_powers};
pub use rational_basis::RationalBasis;
pub use uniform::{MAX_REPEATED, with_repeated_ends};
