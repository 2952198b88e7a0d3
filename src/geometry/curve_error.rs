//! Why numbers cannot be a curve, or an operation not be done on one.

use glam::DVec3;
use thiserror::Error;

use super::{KnotError, MAX_MAGNITUDE, MIN_MAGNITUDE};
use crate::math::{Counted, Measured, Shown, ShownVector};

/// Why numbers cannot be a curve, or an operation not be done on one.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CurveError {
    /// The knots would not be valid.
    #[error(transparent)]
    Knots(#[from] KnotError),
    /// The number of control points does not match the knots.
    #[error("{}, but the knots need {needed}", Counted(*.points, "control point"))]
    PointCount {
        /// The number of control points given.
        points: usize,
        /// The number the knots ask for.
        needed: usize,
    },
    /// The number of weights does not match the control points.
    #[error(
        "{} for {}: each needs one, or none has any",
        Counted(*.weights, "weight"), Counted(*.points, "control point")
    )]
    WeightCount {
        /// The number of weights given.
        weights: usize,
        /// The number of control points.
        points: usize,
    },
    /// A control point, or its product with its weight, is NaN or infinite.
    #[error("control point {index} is {}: it must be finite", ShownVector(*.point))]
    Point {
        /// Which control point, counted from 0.
        index: usize,
        /// Its coordinates.
        point: DVec3,
    },
    /// A weight is not a positive, finite number.
    #[error("the weight of control point {index} is {}: it must be positive and finite", Shown(*weight))]
    Weight {
        /// Which control point, counted from 0.
        index: usize,
        /// Its weight.
        weight: f64,
    },
    /// A parameter does not lie where the operation needs it.
    #[error("the parameter {} does not lie inside the domain from {} to {}", Shown(*t), Shown(*start), Shown(*end))]
    Parameter {
        /// The parameter.
        t: f64,
        /// Where the domain begins.
        start: f64,
        /// Where the domain ends.
        end: f64,
    },
    /// Two points that must differ coincide.
    #[error("points {first} and {second} coincide: neighbours must differ")]
    Coincide {
        /// Which point, counted from 0.
        first: usize,
        /// Which other one.
        second: usize,
    },
    /// A radius is not a usable length.
    #[error("radius {}: it must be positive and finite", Shown(*.radius))]
    Radius {
        /// The radius.
        radius: f64,
    },
    /// A radius is so small or so large that points of the circle would be lost to rounding.
    #[error(
        "radius {}: radii from {MIN_MAGNITUDE:e} to {MAX_MAGNITUDE:e} are supported",
        Shown(*.radius)
    )]
    RadiusRange {
        /// The radius.
        radius: f64,
    },
    /// An arc of a circle begins nowhere.
    #[error("an arc from {}°: it must begin at a finite angle", Shown(*.from))]
    ArcStart {
        /// Where it begins.
        from: f64,
    },
    /// An arc of a circle turns by nothing, or by more than the circle has.
    #[error("an arc from {from}° by {degrees}°: it must turn by -360° to 360°, and not by 0°")]
    Arc {
        /// Where it begins.
        from: f64,
        /// How far it turns.
        degrees: f64,
    },
    /// A weight of a basis function is negative or not finite.
    #[error("the weight of control point {index} is {}: it must be finite, and not negative", Shown(*.weight))]
    BasisWeight {
        /// Which control point, counted from 0.
        index: usize,
        /// Its weight.
        weight: f64,
    },
    /// Basis functions whose weights are all zero somewhere.
    #[error("the weights of all control points that matter at t = {t} are 0: one must be positive")]
    NoWeight {
        /// The parameter.
        t: f64,
    },
    /// Too few points for what is to be made of them.
    #[error(
        "{}: at least {needed} {} needed",
        Counted(*.found, "point"), if *.needed == 1 { "is" } else { "are" }
    )]
    TooFewPoints {
        /// How many there are.
        found: usize,
        /// How many are needed.
        needed: usize,
    },
    /// The number of derivatives does not match the points.
    #[error(
        "{} for {}: each needs one",
        Counted(*.derivatives, "derivative"), Counted(*.points, "point")
    )]
    DerivativeCount {
        /// The number of derivatives given.
        derivatives: usize,
        /// The number of points.
        points: usize,
    },
    /// A control point is repeated more often than is of use, or not there at all.
    #[error("an end point {times} times: from 1 to {most} times are possible")]
    Repeated {
        /// How often it was to be there.
        times: usize,
        /// How often it may be.
        most: usize,
    },
    /// A curve is not a single cubic polynomial.
    #[error(
        "needed is one cubic, polynomial piece; this has degree {degree} and {}{}",
        Counted(*.pieces, "piece"), if *.rational { ", and weights" } else { "" }
    )]
    NotOneCubic {
        /// Its degree.
        degree: usize,
        /// The number of its pieces.
        pieces: usize,
        /// Whether its weights differ.
        rational: bool,
    },
    /// A control point of a quarter circle lies outside the first quadrant.
    #[error(
        "control point {index} is ({}, {}): both coordinates must be positive for a quarter circle",
        Shown(.point.x), Shown(.point.y)
    )]
    OffQuadrant {
        /// Which control point, counted from 0.
        index: usize,
        /// Its coordinates.
        point: DVec3,
    },
    /// The weight that a quarter circle of degree 4 is to have is none it can have.
    #[error(
        "w1 is {}: solution {solution} needs a weight above {}{}, up to {MAX_MAGNITUDE:e}",
        Shown(*.w1), Measured(*.above),
        if *.above > 0.0 { " (√2/8, below which the arc leaves its quadrant)" } else { "" }
    )]
    QuarticWeight {
        /// Which solution of the constraint: 1 or 2.
        solution: u8,
        /// The weight.
        w1: f64,
        /// What it must be greater than.
        above: f64,
    },
    /// Weights or constants do not make a circle.
    #[error("{what} is {}: a circle needs {needed}", Measured(*.found))]
    NotRound {
        /// What is wrong.
        what: &'static str,
        /// Its value.
        found: f64,
        /// The value it must have.
        needed: f64,
    },
}
