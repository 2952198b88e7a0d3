//! Trim loops: closed curves in a surface's (u, v) domain that say which part of it is kept.
//!
//! A [`TrimLoop`] is made of [`TrimCurve`]s (lines, arcs, Bézier curves, NURBS) that join end to
//! end. [`Trims`] are the loops of one surface on its [`TrimDomain`], checked for crossings. They
//! answer queries about points ([`Trims::side_of`], [`Trims::side_within`]) and rectangles
//! ([`Trims::classify`]), and give polylines to plot ([`Trims::outlines`]).
//!
//! ```
//! use glam::DVec2;
//! use nurbray::geometry::trim::{Coverage, Kept, Side, TrimDomain, TrimLoop, Trims, UvBox};
//!
//! // A square sheet with a round hole.
//! let domain = TrimDomain::new([0.0, 1.0], [0.0, 1.0])?;
//! let loops = [
//!     TrimLoop::rectangle(domain.bounds())?,
//!     TrimLoop::circle(DVec2::new(0.5, 0.5), 0.25)?,
//! ];
//! let trims = Trims::new(domain, Kept::Odd, &loops)?;
//!
//! assert_eq!(trims.side_of(DVec2::new(0.1, 0.2)), Side::Inside);
//! assert_eq!(trims.side_of(DVec2::new(0.6, 0.6)), Side::Outside);
//! let on_the_rim = trims.side_of(DVec2::new(0.75, 0.5));
//! assert!(matches!(on_the_rim, Side::Edge { .. }));
//! assert_eq!(trims.classify(&UvBox::new([0.4, 0.6], [0.4, 0.6])), Coverage::Outside);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod around;
mod contacts;
mod crossings;
mod curve;
mod domain;
mod error;
#[cfg(test)]
mod joint_tests;
mod joints;
#[cfg(test)]
mod lobe_tests;
mod lobes;
mod loop_piece;
mod monotone;
mod outline;
#[cfg(test)]
mod overlap_tests;
mod seam_sides;
#[cfg(test)]
mod seam_tests;
mod segment;
#[cfg(test)]
mod sound_tests;
mod stretches;
mod tree;
mod trim_loop;
mod trims;
mod uv_box;
mod window;
mod window_curve;

pub(crate) use around::Sectors;
pub use crossings::OVERLAP_TOLERANCE;
pub(crate) use crossings::tolerated_overlap;
pub use curve::{MAX_TRIM_POINTS, TrimCurve};
pub use domain::TrimDomain;
pub use error::{TrimCurveError, TrimError, TrimLoopError};
pub use lobes::LOBE_TOLERANCE;
pub(crate) use stretches::EdgePiece;
pub use trim_loop::{SEAM_TOLERANCE, TrimLoop};
pub use trims::{Coverage, Kept, MAX_TRIM_SEGMENTS, Side, Trims};
pub use uv_box::UvBox;
pub(crate) use window::{WINDOW_REACH, WINDOW_SPARE, is_kept};
pub(crate) use window_curve::WindowCurve;

/// Ends of curves this close, relative to the loop's extent in u and in v, count as one point.
///
/// CAD files are only as accurate as their authors' tolerances in space, which are large beside
/// narrow faces: of 2299 trimmed faces of 75 models, 14 have gaps beyond 10⁻⁶ of the extent, and of
/// those in models since, three have gaps from 1.2·10⁻⁴ to 3.7·10⁻⁴. Gaps are closed without
/// changing more than what is about as far from them as they are wide. For a loop drawn a thousand
/// pixels wide, 10⁻³ is one pixel; a wider gap, which could be seen, is an error.
pub const JOINT_TOLERANCE: f64 = 1e-3;

/// The largest absolute value of a parameter; products of three parameters must not overflow.
const MAX_PARAMETER: f64 = 1e100;

#[cfg(test)]
mod error_tests;
#[cfg(test)]
mod tests;
