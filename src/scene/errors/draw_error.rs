//! Why an object's nets, edges and lines cannot be drawn.

use thiserror::Error;

use crate::geometry::construct::ConstructError;
use crate::geometry::{CurveError, Direction, SurfaceError, TriangleSide};
use crate::math::Shown;

/// Why control nets, trim edges, or lines of constant parameter of another object cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum DrawError {
    /// No tubes or balls can be made around the lines and points.
    #[error(transparent)]
    Construct(#[from] ConstructError),
    /// The surface does not have the line of constant parameter.
    #[error("{0}")]
    Iso(SurfaceError),
    /// A line of constant parameter lies off a surface.
    #[error(
        "the line {parameter} = {} is not on the surface, whose {parameter} is from 0 to {end}",
        Shown(*.t)
    )]
    IsoOff {
        /// Which parameter is constant.
        parameter: TriangleSide,
        /// Its value.
        t: f64,
        /// The largest value of the parameter.
        end: usize,
    },
    /// There is no line of constant parameter to draw.
    #[error("no lines are named: give u, v or, of triangular patches, w a list of parameters")]
    NoIsoLines,
    /// A surface that has no third parameter.
    #[error("{kind} has no lines of constant w: triangular patches have")]
    NoW {
        /// Its kind.
        kind: &'static str,
    },
    /// An object without trim edges.
    #[error("there are no trim edges to draw: no surface of that object is trimmed")]
    NoTrims,
    /// An object whose trim loops run along the border only, where they cut nothing.
    #[error("there are no trim edges to draw: the loops run along the border, or outside")]
    NoTrimEdges,
    /// A trim edge is not a curve that can be drawn.
    #[error("a trim edge in space: {0}")]
    TrimEdge(CurveError),
    /// A line of constant parameter lies where trims keep nothing.
    #[error("the line {parameter} = {} lies where trims keep nothing, or where the surface has ended", Shown(*.t))]
    IsoCut {
        /// Which parameter is constant.
        parameter: TriangleSide,
        /// Its value.
        t: f64,
    },
    /// A line of constant parameter is only a point, as at a pole.
    #[error("the line {parameter} = {} is a single point, where there is nothing to draw", Shown(*.t))]
    IsoPoint {
        /// Which parameter is constant.
        parameter: TriangleSide,
        /// Its value.
        t: f64,
    },
    /// There are more steps of subdivision than are useful.
    #[error("{steps} steps: a cage is drawn after up to {most}")]
    Steps {
        /// How many are requested.
        steps: usize,
        /// How many there can be.
        most: usize,
    },
    /// A cage has more vertices than can be drawn before all steps are done.
    #[error("{count} vertices after {after} of {steps} steps: nets of up to {limit} can be drawn")]
    LargeCage {
        /// The number of steps done.
        after: usize,
        /// The number of steps requested.
        steps: usize,
        /// How many vertices it has by then.
        count: usize,
        /// How many it may have.
        limit: usize,
    },
    /// Steps of subdivision are requested for an object that is not subdivided.
    #[error("steps are those of subdivision, and the object is not only subdivision surfaces")]
    NoSteps,
    /// What is drawn of an object has more control points than are sensible.
    #[error("a drawing of more than {limit} control points: at most that many are supported")]
    LargeDrawing {
        /// How many there may be.
        limit: usize,
    },
}

impl DrawError {
    /// The key of the number that is at fault, if that has a key; none for
    /// [`DrawError::Construct`].
    pub(in crate::scene) fn key(&self) -> Option<&'static str> {
        let parameter = match self {
            Self::IsoOff { parameter, .. }
            | Self::IsoCut { parameter, .. }
            | Self::IsoPoint { parameter, .. } => *parameter,
            Self::Iso(SurfaceError::Parameter { direction: Direction::U, .. }) => TriangleSide::U,
            Self::Iso(SurfaceError::Parameter { direction: Direction::V, .. }) => TriangleSide::V,
            Self::NoW { .. } => TriangleSide::W,
            Self::NoSteps | Self::Steps { .. } | Self::LargeCage { .. } => return Some("steps"),
            _ => return None,
        };
        Some(match parameter {
            TriangleSide::U => "u",
            TriangleSide::V => "v",
            TriangleSide::W => "w",
        })
    }
}
