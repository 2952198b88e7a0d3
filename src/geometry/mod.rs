//! Curves and surfaces as authored: knot vectors, control nets, weights.
//!
//! A surface is made from two knot vectors and a net of control points, which are checked once.
//! Every surface derived from it (refined, split, elevated, reversed, moved) is valid again. Shapes
//! known by name are in [`shapes`], surfaces made from curves in [`construct`].
//!
//! The modules, each of which uses only those before it:
//!
//! | module | what it holds |
//! |---|---|
//! | `direction`, `rect_side` | [`Direction`], `u` or `v`; [`RectSide`], a side of a domain |
//! | `magnitude`, `affine` | the range of numbers; what affine maps do to points and lengths |
//! | `knots` | [`KnotVector`], and the [basis functions](BasisFunctions) over it |
//! | `polygon` | control polygons, whether of curves or in nets: [`de_casteljau`], insertion, elevation, extraction |
//! | `curve` | [`NurbsCurve`], the forms in which curves are written, curvature, [`CornerCutting`] |
//! | `surface` | [`NurbsSurface`]: evaluation, curvature, refinement, iso-curves |
//! | [`trim`] | loops in a domain: [`Trims`](trim::Trims) |
//! | `chart` | [`Charts`]: surfaces of any kind as NURBS surfaces |
//! | `triangle`, `trimmed` | [`TrianglePatch`]; [`TrimmedSurface`] and the curves along its edges |
//! | [`shapes`], [`construct`] | quadrics and circles; surfaces from curves, and curves made visible |
//! | `cage` | [`Cage`] and its [`LimitSurface`] |
//! | `any_surface` | [`Surface`], one of any kind |
//! | [`errata`] | misprints in documents that the code follows; text only |
//!
//! ```
//! use glam::{DVec2, DVec3};
//! use nurbray::geometry::{KnotVector, NurbsSurface};
//!
//! // A saddle: degree 2 along u, where the knots are unclamped, and degree 1 along v.
//! let points = (0..4)
//!     .flat_map(|i| [0.0, 1.0].map(|v| (f64::from(i), v)))
//!     .map(|(u, v)| DVec3::new(u, v, u * v));
//! let (u, v) = (KnotVector::uniform(2, 4)?, KnotVector::bezier(1)?);
//! let saddle = NurbsSurface::new(u, v, points.collect(), None)?;
//!
//! assert_eq!(saddle.domain(), [[2.0, 4.0], [0.0, 1.0]]);
//! assert_eq!(saddle.point_at(DVec2::new(3.0, 0.5)), DVec3::new(1.5, 0.5, 0.75));
//! let (below, above) = saddle.split_u(3.0)?;
//! assert_eq!(below.point_at(DVec2::new(3.0, 0.5)), above.point_at(DVec2::new(3.0, 0.5)));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod affine;
mod any_surface;
mod cage;
mod chart;
pub mod construct;
mod curve;
mod direction;
pub mod errata;
mod knots;
mod magnitude;
mod polygon;
mod rect_side;
pub mod shapes;
mod surface;
mod triangle;
pub mod trim;
mod trimmed;

pub(crate) use affine::stretch;
pub use any_surface::{MoveError, Surface};
pub use cage::{
    BoundaryRule, Cage, CageError, CageParts, Corner, Crease, FaceRect, Feature, LimitError,
    LimitPatch, LimitPoint, LimitSurface,
};
pub use chart::{Chart, ChartMap, Charts};
pub use curve::{
    CornerCutting, CurveDerivatives, CurveError, MAX_REPEATED, MatrixForm, NurbsCurve, PolygonEnds,
    RationalBasis, with_repeated_ends,
};
pub use direction::Direction;
pub use knots::{
    BasisDerivatives, BasisFunctions, BasisValues, KnotError, KnotVector, MAX_CONTROL_POINTS,
    MAX_DEGREE, Span,
};
pub(crate) use knots::{LEAST_AROUND, periodic_values};
pub use magnitude::{MAX_MAGNITUDE, MIN_MAGNITUDE, is_usable_weight};
pub(crate) use polygon::{Extraction, Extractions};
pub use polygon::{bernstein, de_casteljau, split_bezier};
pub use rect_side::RectSide;
pub(crate) use surface::BezierForm;
pub use surface::{
    NurbsSurface, SurfaceCurvature, SurfaceDerivatives, SurfaceError, matrix_patch, matrix_surface,
};
pub use triangle::{TriangleError, TrianglePatch, TriangleQuarter, TriangleSide};
pub use trimmed::{TrimEdge, TrimmedSurface};
