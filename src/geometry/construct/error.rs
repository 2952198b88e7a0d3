//! Why a surface cannot be made from curves.

use glam::DVec3;
use thiserror::Error;

use super::Corner;
use crate::geometry::{CurveError, Direction, SurfaceError};

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
    /// A line of constant parameter is none of the surface's.
    #[error("{0}")]
    Iso(SurfaceError),
    /// A surface of a kind whose lines of constant parameter are no curves that can be drawn.
    #[error("{kind} has no iso-curves: NURBS surfaces have")]
    NoIsoCurves {
        /// Its kind.
        kind: &'static str,
    },
    /// An object without trim edges.
    #[error("there are no trim edges to draw: no surface of that object is trimmed")]
    NoTrims,
    /// A trim edge is no curve that can be drawn.
    #[error("a trim edge in space: {0}")]
    TrimEdge(CurveError),
    /// A line of constant parameter lies where trims keep nothing.
    #[error("the line {direction} = {t} lies where the trims keep nothing")]
    IsoCut {
        /// Which parameter is constant.
        direction: Direction,
        /// Its value.
        t: f64,
    },
    /// A line of constant parameter is but a point, as at a pole.
    #[error("the line {direction} = {t} is a single point, where there is nothing to draw")]
    IsoPoint {
        /// Which parameter is constant.
        direction: Direction,
        /// Its value.
        t: f64,
    },
    /// The surface would have more control points than are sensible; nothing was allocated.
    #[error("{nu} × {nv} control points: at most {limit} in all are supported")]
    TooLarge {
        /// Control points along u.
        nu: usize,
        /// Control points along v.
        nv: usize,
        /// How many there may be in all.
        limit: usize,
    },
    /// A net has more control points than can be drawn.
    #[error("{count} control points: nets of up to {limit} can be drawn")]
    LargeNet {
        /// How many it has.
        count: usize,
        /// How many it may have.
        limit: usize,
    },
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
    /// A path has no direction at a parameter.
    #[error("the path stands still at t = {t}: it has no direction there")]
    StandsStill {
        /// The parameter.
        t: f64,
    },
    /// A path is not connected.
    #[error("the path has a gap at t = {t}, {gap} wide: it must be connected")]
    Gap {
        /// The parameter.
        t: f64,
        /// How wide it is.
        gap: f64,
    },
    /// A path turns all at once.
    #[error("the path has a kink of {degrees}° at t = {t}: it must be smooth; split it there")]
    Kink {
        /// The parameter.
        t: f64,
        /// By how much it turns.
        degrees: f64,
    },
    /// A sweep would run backwards where its path bends.
    #[error(
        "the sweep folds at t = {t} of the path: the path bends with radius {radius} there, \
         and the profile reaches {reach} towards the centre"
    )]
    Fold {
        /// The path's parameter.
        t: f64,
        /// The path's radius of curvature.
        radius: f64,
        /// How far the profile reaches towards its centre.
        reach: f64,
    },
    /// An upward direction is the path's own.
    #[error(
        "up ({}, {}, {}) runs along the path, whose direction there is ({}, {}, {}): \
         choose another one",
        .up.x, .up.y, .up.z, .tangent.x, .tangent.y, .tangent.z
    )]
    Up {
        /// The upward direction.
        up: DVec3,
        /// The path's direction.
        tangent: DVec3,
    },
    /// A scale is negative or not finite.
    #[error("scale {index} is {factor}: it must be finite, and not negative")]
    Scale {
        /// Which of the scales, counted from 0.
        index: usize,
        /// Its value.
        factor: f64,
    },
    /// There is no scale, or all are zero.
    #[error("the scale is 0 all along the path: one at least must be positive")]
    NoScale,
    /// A radius is not a usable length.
    #[error("{what} radius {radius}: it must be positive and finite")]
    Radius {
        /// Which one.
        what: &'static str,
        /// The radius.
        radius: f64,
    },
    /// A width is not a usable length.
    #[error("width {width}: it must be positive and finite")]
    Width {
        /// The width.
        width: f64,
    },
    /// A twist is not finite.
    #[error("twist {degrees}°: it must be finite")]
    Twist {
        /// The twist.
        degrees: f64,
    },
    /// A tolerance is not a usable length.
    #[error("tolerance {tolerance}: it must be positive and finite")]
    Tolerance {
        /// The tolerance.
        tolerance: f64,
    },
    /// A tolerance is finer than rounding, or than a sensible number of pieces.
    #[error(
        "the tolerance {tolerance} cannot be held: at t = {t} of the path, {deviation} is \
         left after as many halvings as there may be"
    )]
    NotHeld {
        /// The tolerance.
        tolerance: f64,
        /// What is left.
        deviation: f64,
        /// Where.
        t: f64,
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

/// The most control points of one surface made: 2²⁴, half a gigabyte. Curves of thousands of
/// points multiply.
const MAX_NET: usize = 1 << 24;

/// The number of control points of a net, if it is sensible.
pub(crate) fn net_size(nu: usize, nv: usize) -> Result<usize, ConstructError> {
    check_net(nu, nv, MAX_NET)
}

/// The product of two counts, if it is no more than a limit.
pub(crate) fn check_net(nu: usize, nv: usize, limit: usize) -> Result<usize, ConstructError> {
    let size = nu.checked_mul(nv).filter(|&points| points <= limit);
    size.ok_or(ConstructError::TooLarge { nu, nv, limit })
}
