//! Why a surface cannot be made from curves.

use std::fmt;

use glam::DVec3;
use thiserror::Error;

use super::CoonsCorner;
use crate::geometry::{CurveError, MAX_DEGREE, MAX_MAGNITUDE, SurfaceError};
use crate::math::{AtLeast, Counted, Measured, MeasuredPoint, Shown, ShownVector};

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
    /// The resulting net is not a valid surface.
    #[error("the surface made: {0}")]
    Surface(#[from] SurfaceError),
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
    /// A line of a net ends at a vertex that the net does not have.
    #[error(
        "line {line} ends at vertex {vertex}, but the net has {}; lines and vertices count from 0",
        Counted(*.count, "control point")
    )]
    NetLine {
        /// Which line, counted from 0.
        line: usize,
        /// The vertex, as given.
        vertex: usize,
        /// How many the net has.
        count: usize,
    },
    /// A point of a net is NaN, or too large for surfaces.
    #[error(
        "control point {index} of the net is {}: coordinates must be finite (up to {MAX_MAGNITUDE:e})",
        ShownVector(*.point)
    )]
    NetPoint {
        /// Which point, counted from 0.
        index: usize,
        /// The point, as given.
        point: DVec3,
    },
    /// A direction has no length, or is not finite.
    #[error("{what} {}: it must be finite and not zero", ShownVector(*.vector))]
    Direction {
        /// What it is the direction of.
        what: DirectionOf,
        /// The vector.
        vector: DVec3,
    },
    /// A point is not finite.
    #[error("{what} {}: it must be finite", ShownVector(*.point))]
    Point {
        /// Which point.
        what: &'static str,
        /// Its coordinates.
        point: DVec3,
    },
    /// An axis is given by a point so far away that nothing near the origin can be told apart.
    #[error(
        "the axis goes through {}: that is too far away; give a point of it with coordinates of up \
         to {MAX_MAGNITUDE:e}",
        ShownVector(*.point)
    )]
    FarAxis {
        /// The point it is given by.
        point: DVec3,
    },
    /// An angle of revolution is zero, or more than a full turn.
    #[error("angle {}°: it must be from -360° to 360°, and not 0°", Shown(*.degrees))]
    Angle {
        /// The angle.
        degrees: f64,
    },
    /// A profile lies on the axis it is turned about.
    #[error("the profile lies on the axis: turned about it, it remains a line")]
    OnAxis,
    /// The degree across sections is 0 or above [`MAX_DEGREE`].
    #[error("degree {degree} across: degrees from 1 to {MAX_DEGREE} are supported")]
    DegreeAcross {
        /// The degree as given.
        degree: usize,
    },
    /// Too few sections for the degree across them.
    #[error("{}: degree {degree} across needs at least {needed}", Counted(*.found, "section"))]
    Sections {
        /// How many there are.
        found: usize,
        /// The degree across.
        degree: usize,
        /// How many it needs.
        needed: usize,
    },
    /// The weights of sections differ so much that those between them would not be positive.
    #[error(
        "section {section}: its weights and its neighbours' differ too much: interpolated, that of \
         control point {point} comes to {}, and it must be positive; give all sections similar \
         weights, or a lower degree across",
        Measured(*.weight)
    )]
    SectionWeights {
        /// The section nearest to the control point, counted from 0.
        section: usize,
        /// Which control point along the sections, once they have common knots.
        point: usize,
        /// Its weight.
        weight: f64,
    },
    /// The weights inside the borders of a Coons patch are so small that those between them would
    /// not be positive.
    #[error(
        "the borders' weights are too small inside, compared with those at the corners: between \
         them, that of control point ({}, {}) comes to {}, and it must be positive; give the \
         borders weights that differ less",
        point[0], point[1], Measured(*.weight)
    )]
    BorderWeights {
        /// Which control point, along `u` and along `v`, once opposite borders have common knots.
        point: [usize; 2],
        /// Its weight.
        weight: f64,
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
    #[error(
        "the {path} stands still at t = {}, {}: it has no direction there",
        Measured(*.t), MeasuredPoint(*.point)
    )]
    StandsStill {
        /// What it is called: `path`, or `curve` where a tube or ribbon is made around it.
        path: &'static str,
        /// The parameter.
        t: f64,
        /// The place.
        point: DVec3,
    },
    /// A path is not connected.
    #[error(
        "the {path} has a gap at t = {}, {}, {} wide: it must be connected",
        Measured(*.t), MeasuredPoint(*.point), Measured(*.gap)
    )]
    Gap {
        /// What it is called.
        path: &'static str,
        /// The parameter.
        t: f64,
        /// The place at which it ends there.
        point: DVec3,
        /// How wide it is.
        gap: f64,
    },
    /// The direction of a path jumps.
    #[error(
        "the {path} has a kink of {}° at t = {}, {}: it must be smooth; split it there",
        Measured(*.degrees), Measured(*.t), MeasuredPoint(*.point)
    )]
    Kink {
        /// What it is called.
        path: &'static str,
        /// The parameter.
        t: f64,
        /// The place.
        point: DVec3,
        /// By how much it turns.
        degrees: f64,
    },
    /// A curve runs back over itself.
    #[error(
        "{which}: it folds at {}{}: there it turns round and runs back over itself, for a length \
         of {}; the surface would be covered twice",
        corner_or_parameter(*.corner, *.t), MeasuredPoint(*.point), Measured(*.length)
    )]
    RunsBack {
        /// Which curve, as `profile` or `section 2`.
        which: String,
        /// The parameter where it turns round.
        t: f64,
        /// For a polyline, the control point where it turns round.
        corner: Option<usize>,
        /// The place.
        point: DVec3,
        /// The distance from there to the end of the stretch that it runs through twice.
        length: f64,
    },
    /// A profile is turned to where another part of it has been.
    #[error(
        "profile: turned by {}° about the axis it covers itself: its two parts at t = {}, \
         {}, are {}° apart and each other's image, as at t = {} and {}; turn it by no more than \
         that, or leave out one of the two",
        Shown(*.degrees), Measured(*.t), MeasuredPoint(*.point), Measured(*.between), Measured(.twice[0]),
        Measured(.twice[1])
    )]
    CoversItself {
        /// The parameter where the two parts meet.
        t: f64,
        /// The place.
        point: DVec3,
        /// A parameter of each part, taken to the same place.
        twice: [f64; 2],
        /// The angle of the revolution.
        degrees: f64,
        /// The angle about the axis between the two parts.
        between: f64,
    },
    /// A profile is everywhere at the same distance from the axis and at the same height.
    #[error(
        "profile: all of it is {} from the axis, at the same height: turned about it, it remains \
         a circle", Measured(*.distance)
    )]
    OneCircle {
        /// The distance from the axis.
        distance: f64,
    },
    /// A profile that is turned passes over what it has just passed over.
    #[error(
        "profile: turned about the axis it covers itself: at t = {}, {}, it turns round as seen \
         from the axis, and its two sides, as at t = {} and {}, are at the same distance and the \
         same height; leave out one of the two",
        Measured(*.t), MeasuredPoint(*.point), Measured(.twice[0]), Measured(.twice[1])
    )]
    TurnsRound {
        /// The parameter where it turns round.
        t: f64,
        /// The place.
        point: DVec3,
        /// A parameter of each side, taken through the same places.
        twice: [f64; 2],
    },
    /// A profile that is moved along a line passes over what it has just passed over.
    #[error(
        "{which}: moved along {} it covers itself: at t = {}, {}, it turns round as seen in \
         that direction, and its two sides, as at t = {} and {}, pass over the same places; move it in \
         another direction, or leave out one of the two",
        ShownVector(*.by), Measured(*.t), MeasuredPoint(*.point), Measured(.twice[0]),
        Measured(.twice[1])
    )]
    FoldsFlat {
        /// What it is called: `profile`, or the curve that is moved in a ruled surface.
        which: String,
        /// Along which vector it is moved.
        by: DVec3,
        /// The parameter where it turns round.
        t: f64,
        /// The place.
        point: DVec3,
        /// A parameter of each side, moved over the same places.
        twice: [f64; 2],
    },
    /// A profile is moved along itself.
    #[error(
        "{which}: moved along {} it remains a line: it runs straight in that direction",
        ShownVector(*.by)
    )]
    MovedAlongItself {
        /// What it is called.
        which: String,
        /// Along which vector it is moved.
        by: DVec3,
    },
    /// Two curves that a surface is to connect are the same.
    #[error("{which} are the same to within rounding: nothing lies between them")]
    NothingBetween {
        /// Which curves.
        which: String,
    },
    /// A surface through sections comes back the way it went.
    #[error(
        "sections {first} and {last} coincide: the surface would turn round at section {turn} \
         and cover itself on the way back"
    )]
    ComesBack {
        /// A section, counted from 0.
        first: usize,
        /// The section between the two.
        turn: usize,
        /// The later section that is the same as the first.
        last: usize,
    },
    /// One of several lines that are drawn is at fault.
    #[error("{line}: {error}")]
    Line {
        /// Which line, as `surface 3, u = 0.5`.
        line: String,
        /// What is wrong with it.
        error: Box<ConstructError>,
    },
    /// A sweep would run backwards where its path bends; the fields give the place where it would
    /// most.
    #[error(
        "the {what} folds, most of all at t = {} of the {path}, {}: the {path} bends with radius {} \
         there, and the {} reaches {} towards the centre",
        Measured(*.t), MeasuredPoint(*.point), AtLeast(*.radius), if *.what == "sweep" { "profile" } else { .what },
        Measured(*.reach)
    )]
    Fold {
        /// What folds: a `sweep`, `tube` or `ribbon`.
        what: &'static str,
        /// What its path is called.
        path: &'static str,
        /// The path's parameter.
        t: f64,
        /// The place on the path.
        point: DVec3,
        /// The path's radius of curvature. A thinner tube does not fold, so messages round the
        /// radius down.
        radius: f64,
        /// How far the profile reaches towards the centre of curvature.
        reach: f64,
    },
    /// An upward direction is parallel to the path.
    #[error(
        "up {} runs along the {path}, whose direction there is {}: choose another one",
        ShownVector(*.up), MeasuredPoint(*.tangent)
    )]
    Up {
        /// What the path is called.
        path: &'static str,
        /// The upward direction.
        up: DVec3,
        /// The path's direction.
        tangent: DVec3,
    },
    /// A scale is negative or not finite.
    #[error("scale {index} is {}: it must be finite, and not negative", Shown(*.factor))]
    Scale {
        /// Which of the scales, counted from 0.
        index: usize,
        /// Its value.
        factor: f64,
    },
    /// All scales are zero.
    #[error("the scale is 0 all along the path: one at least must be positive")]
    NoScale,
    /// There are no scales, or too many.
    #[error(
        "{found} scales: there can be 1 to {most}, as many as a curve of the largest degree has points"
    )]
    ScaleCount {
        /// How many there are.
        found: usize,
        /// How many there can be.
        most: usize,
    },
    /// The radius of the balls at joints is not a usable length.
    #[error("joint radius {}: it must be positive and finite", Shown(*.radius))]
    JointRadius {
        /// The radius.
        radius: f64,
    },
    /// A width is not a usable length.
    #[error("width {}: it must be positive and finite", Shown(*.width))]
    Width {
        /// The width.
        width: f64,
    },
    /// A twist is not finite.
    #[error("twist {}°: it must be finite", Shown(*.degrees))]
    Twist {
        /// The twist.
        degrees: f64,
    },
    /// A tolerance is not a usable length.
    #[error("tolerance {}: it must be positive and finite", Shown(*.tolerance))]
    Tolerance {
        /// The tolerance.
        tolerance: f64,
    },
    /// A tolerance is finer than rounding, or than a sensible number of pieces.
    #[error(
        "the tolerance {} cannot be held: at t = {} of the {path}, {}, the cubic pieces are as many \
         or as short as they may be, and the next one is off by {}; a larger tolerance needs fewer",
        Measured(*.tolerance), Measured(*.t), MeasuredPoint(*.point), Measured(*.deviation)
    )]
    NotHeld {
        /// What the path is called.
        path: &'static str,
        /// The tolerance.
        tolerance: f64,
        /// The deviation of the piece that begins there.
        deviation: f64,
        /// The path's parameter where it is.
        t: f64,
        /// The place on the path.
        point: DVec3,
    },
    /// Two borders of a Coons patch do not meet.
    #[error(
        "{corner}: they end at {} and {}, {} apart; they must meet",
        MeasuredPoint(*.u), MeasuredPoint(*.v), Measured(*.distance)
    )]
    Corner {
        /// The corner at which they should meet.
        corner: CoonsCorner,
        /// Where the border of constant u ends.
        u: DVec3,
        /// Where the border of constant v ends.
        v: DVec3,
        /// The distance between the two.
        distance: f64,
    },
}

/// What a vector is the direction of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DirectionOf {
    /// An extrusion.
    Extrusion,
    /// The axis of a revolution.
    Axis,
    /// The upward side of a profile or a ribbon.
    Up,
}

impl fmt::Display for DirectionOf {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Extrusion => "extrusion by",
            Self::Axis => "direction of the axis",
            Self::Up => "up",
        })
    }
}

impl ConstructError {
    /// Whether the curve of this name in a construction is at fault: `profile`, `section 2`, …
    pub fn blames(&self, curve: &str) -> bool {
        match self {
            Self::Line { error, .. } => error.blames(curve),
            Self::Curve { which, .. }
            | Self::RunsBack { which, .. }
            | Self::FoldsFlat { which, .. }
            | Self::MovedAlongItself { which, .. } => {
                which == curve
                    || which
                        .strip_suffix('`')
                        .is_some_and(|name| name.strip_prefix("curve `") == Some(curve))
            }
            Self::CoversItself { .. }
            | Self::OneCircle { .. }
            | Self::TurnsRound { .. }
            | Self::OnAxis => curve == "profile",
            Self::SectionWeights { section, .. } | Self::SameSections { second: section, .. } => {
                curve == format!("section {section}")
            }
            Self::StandsStill { .. } | Self::Gap { .. } | Self::Kink { .. } | Self::Fold { .. } => {
                ["path", "curve"].contains(&curve)
            }
            _ => false,
        }
    }

    /// The same error about a `tube` or `ribbon`, made by sweeping something along what its author
    /// calls a curve.
    #[must_use]
    pub(crate) fn around_a_curve(mut self, made: &'static str) -> Self {
        match &mut self {
            Self::Fold { what, path, .. } => (*what, *path) = (made, "curve"),
            Self::StandsStill { path, .. }
            | Self::Gap { path, .. }
            | Self::Kink { path, .. }
            | Self::Up { path, .. }
            | Self::NotHeld { path, .. } => *path = "curve",
            Self::Curve { which, .. } if which == "path" => "curve".clone_into(which),
            _ => {}
        }
        self
    }

    /// Attributes an error to a curve.
    pub(crate) fn of(which: impl Into<String>) -> impl FnOnce(CurveError) -> Self {
        let which = which.into();
        move |error| Self::Curve { which, error }
    }
}

/// `control point 2, ` or `t = 0.5, `, before the point.
fn corner_or_parameter(corner: Option<usize>, t: f64) -> String {
    corner.map_or_else(|| format!("t = {}, ", Measured(t)), |k| format!("control point {k}, "))
}
