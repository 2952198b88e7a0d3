//! Curves and surfaces as authored: knot vectors, control nets, weights.
//!
//! A surface is made from two knot vectors and a net of control points, which are checked once.
//! Every surface derived from it (refined, split, elevated, reversed, moved) is valid again. Shapes
//! known by name are in [`shapes`], surfaces made from curves in [`construct`].
//!
//! ```
//! use glam::DVec3;
//! use nurbray::geometry::{KnotVector, NurbsSurface};
//!
//! // A saddle: degree 2 along u, where the knots are unclamped, and degree 1 along v.
//! let points = (0..4)
//!     .flat_map(|i| [0.0, 1.0].map(|v| (f64::from(i), v)))
//!     .map(|(u, v)| DVec3::new(u, v, u * v));
//! let (u, v) = (KnotVector::uniform(2, 4)?, KnotVector::bezier(1)?);
//! let saddle = NurbsSurface::new(u, v, points.collect(), None)?;
//!
//! assert_eq!(saddle.domain(), [(2.0, 4.0), (0.0, 1.0)]);
//! assert_eq!(saddle.point_at(3.0, 0.5), DVec3::new(1.5, 0.5, 0.75));
//! let (below, above) = saddle.split_u(3.0)?;
//! assert_eq!(below.point_at(3.0, 0.5), above.point_at(3.0, 0.5));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod any_surface;
mod arrange;
mod basis;
mod basis_functions;
mod bezier;
mod bezier_form;
mod cage;
mod chart;
pub mod construct;
mod corner_cutting;
mod curvature;
mod curve;
mod curve_arrange;
mod curve_error;
mod derivatives;
mod elevate;
mod evaluate;
mod extraction;
mod extremes;
mod iso;
mod knot_error;
mod knots;
mod line;
mod matrix_form;
mod rational_basis;
mod refine;
pub mod shapes;
mod surface;
mod surface_error;
mod triangle;
mod triangle_charts;
mod triangle_error;
pub mod trim;
mod trimmed;
mod trimmed_edges;
mod uniform;

pub use any_surface::Surface;
pub(crate) use arrange::stretch;
pub use basis::{BasisDerivatives, BasisValues};
pub use basis_functions::BasisFunctions;
pub use bezier::{bernstein, de_casteljau, halves};
pub(crate) use bezier_form::BezierForm;
pub use cage::{
    BoundaryRule, Cage, CageError, CageParts, Corner, Crease, FaceRect, Feature, LimitError,
    LimitPatch, LimitPoint, LimitSurface,
};
pub use chart::{Chart, ChartMap, Charts};
pub use corner_cutting::{CornerCutting, PolygonEnds};
pub use curve::{CurveDerivatives, NurbsCurve};
pub use curve_error::CurveError;
pub use derivatives::SurfaceDerivatives;
pub(crate) use extraction::{Extraction, Extractions};
pub use knot_error::KnotError;
pub(crate) use knots::periodic_values;
pub use knots::{KnotVector, MAX_CONTROL_POINTS, MAX_DEGREE, Span};
pub use matrix_form::{MatrixForm, matrix_patch};
pub use rational_basis::RationalBasis;
pub use surface::{MAX_MAGNITUDE, MIN_MAGNITUDE, NurbsSurface};
pub use surface_error::{Direction, SurfaceError};
pub use triangle::{TrianglePatch, TriangleQuarter, TriangleSide};
pub use triangle_error::TriangleError;
pub use trimmed::TrimmedSurface;
pub use uniform::{MAX_REPEATED, with_repeated_ends};

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
#[cfg(test)]
mod triangle_tests;
