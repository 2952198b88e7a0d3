//! Why a surface cannot be made from curves.

use glam::DVec3;
use thiserror::Error;

use super::Corner;
use crate::geometry::{CurveError, SurfaceError};

/// Why a surface cannot be made from curves: which element is at fault, what was found,
/// what is needed.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum ConstructError {
    /// One of the curves is at fault.
    #[error("{which}: {error}")]
    Curve {
        /// Which curve, as `profile` or `section 2`.
        which: String,
        /// What is wrong with it.
        error: CurveError,
    },
    /// The net that results is no surface.
    #[error("the surface made: {0}")]
    Surface(#[from] SurfaceError),
    /// A direction has no length, or is not finite.
    #[error("{what} ({}, {}, {}): it must be finite and not zero", .vector.x, .vector.y, .vector.z)]
    Direction {
        /// What it is the direction of.
        what: &'static str,
        /// The vector.
        vector: DVec3,
    },
    /// A point is not finite.
    #[error("{what} ({}, {}, {}): it must be finite", .point.x, .point.y, .point.z)]
    Point {
        /// Which point.
        what: &'static str,
        /// Its coordinates.
        point: DVec3,
    },
    /// An angle of revolution is zero, or more than a full turn.
    #[error("angle {degrees}°: it must be from -360° to 360°, and not 0°")]
    Angle {
        /// The angle.
        degrees: f64,
    },
    /// A profile has no distance from the axis it is turned about.
    #[error("the profile lies on the axis: turned about it, it remains a line")]
    OnAxis,
    /// Too few sections for the degree across them.
    #[error("{found} sections: degree {degree} across needs at least {needed}")]
    Sections {
        /// How many there are.
        found: usize,
        /// The degree across.
        degree: usize,
        /// How many it needs.
        needed: usize,
    },
    /// Two sections in a row are the same.
    #[error("sections {first} and {second} coincide: neighbours must differ")]
    SameSections {
        /// Which section, counted from 0.
        first: usize,
        /// The next one.
        second: usize,
    },
    /// Two borders of a Coons patch do not meet.
    #[error(
        "{corner}: they end at ({}, {}, {}) and ({}, {}, {}), {distance} apart; they must meet",
        .u.x, .u.y, .u.z, .v.x, .v.y, .v.z
    )]
    Corner {
        /// Where they should.
        corner: Corner,
        /// Where the border of constant u ends.
        u: DVec3,
        /// Where the border of constant v ends.
        v: DVec3,
        /// The distance between the two.
        distance: f64,
    },
}

impl ConstructError {
    /// Blames a curve.
    pub(crate) fn of(which: impl Into<String>) -> impl FnOnce(CurveError) -> Self {
        let which = which.into();
        move |error| Self::Curve { which, error }
    }
}
