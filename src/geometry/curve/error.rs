//! The error of curves: numbers that make no curve, or an operation that a curve does not allow.

use glam::DVec3;
use thiserror::Error;

use crate::geometry::{KnotError, MAX_MAGNITUDE, MIN_MAGNITUDE};
use crate::math::{Counted, Measured, Shown, ShownVector};

/// The reason why numbers make no curve, or why an operation cannot be done on a curve.
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
    /// A coordinate of a control point is NaN, infinite, or beyond [`MAX_MAGNITUDE`].
    #[error(
        "control point {index} is {}: coordinates must be finite (up to {MAX_MAGNITUDE:e})",
        ShownVector(*.point)
    )]
    Point {
        /// Which control point, counted from 0.
        index: usize,
        /// Its coordinates.
        point: DVec3,
    },
    /// A weight is not a number from [`MIN_MAGNITUDE`] to [`MAX_MAGNITUDE`].
    #[error(
        "the weight of control point {index} is {}: \
         it must be positive and finite (from {MIN_MAGNITUDE:e} to {MAX_MAGNITUDE:e})",
        Shown(*weight)
    )]
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
        /// The first of the two points, counted from 0.
        first: usize,
        /// The second of the two points.
        second: usize,
    },
    /// Two points differ by less than the rounding error of the parameter there, the arc length.
    #[error(
        "points {first} and {second} are too close together: they are {} apart, less than the \
         rounding error of the length up to there, {}",
        Measured(*.distance), Measured(*.length)
    )]
    TooClose {
        /// The first of the two points, counted from 0.
        first: usize,
        /// The second of the two points.
        second: usize,
        /// How far apart they are.
        distance: f64,
        /// The length of the curve up to them.
        length: f64,
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
    /// The start angle of an arc of a circle is not finite.
    #[error("an arc from {}°: it must begin at a finite angle", Shown(*.from))]
    ArcStart {
        /// The start angle, in degrees.
        from: f64,
    },
    /// An arc of a circle turns by 0°, or by more than 360°.
    #[error("an arc from {from}° by {degrees}°: it must turn by -360° to 360°, and not by 0°")]
    Arc {
        /// The start angle, in degrees.
        from: f64,
        /// The turn, in degrees.
        degrees: f64,
    },
    /// A weight of a basis function is neither 0 nor a number from [`MIN_MAGNITUDE`] to
    /// [`MAX_MAGNITUDE`].
    #[error(
        "the weight of control point {index} is {}: it must be finite, and not negative \
         (0, or from {MIN_MAGNITUDE:e} to {MAX_MAGNITUDE:e})",
        Shown(*.weight)
    )]
    BasisWeight {
        /// Which control point, counted from 0.
        index: usize,
        /// Its weight.
        weight: f64,
    },
    /// At some parameter, all basis functions that matter there have the weight zero.
    #[error("the weights of all control points that matter at t = {t} are 0: one must be positive")]
    NoWeight {
        /// The parameter.
        t: f64,
    },
    /// There are too few points for the curve that is to be made of them.
    #[error(
        "{}: at least {needed} {} needed",
        Counted(*.found, "point"), if *.needed == 1 { "is" } else { "are" }
    )]
    TooFewPoints {
        /// The number of points given.
        found: usize,
        /// The number needed.
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
    /// A segment in matrix form has as many vectors as none of that form has.
    #[error(
        "{} in the geometry of a segment: the form {form} takes {needed}",
        Counted(*.found, "vector")
    )]
    GeometryCount {
        /// The name of the form.
        form: &'static str,
        /// The number of vectors given.
        found: usize,
        /// How many the form takes.
        needed: &'static str,
    },
    /// A Bézier coefficient of a denominator is zero, or has another sign than the first.
    #[error(
        "the denominator's Bézier coefficient {index} is {}: all must be positive, or all negative; \
         they may be so on a shorter domain",
        Shown(*.coefficient)
    )]
    Denominator {
        /// Which coefficient, counted from 0.
        index: usize,
        /// The coefficient.
        coefficient: f64,
    },
    /// An end point is to occur more often than makes a difference, or zero times.
    #[error("an end point {times} times: from 1 to {most} times are possible")]
    Repeated {
        /// How often it was to occur.
        times: usize,
        /// How often it may occur at most.
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
    /// No quarter circle of degree 4 has the weight `w₁` asked for.
    #[error(
        "w1 is {}: solution {solution} needs a weight above {}{}, up to {MAX_MAGNITUDE:e}",
        Shown(*.w1), Shown(*.above),
        if *.above > 0.0 { " (√2/8, below which the arc leaves its quadrant)" } else { "" }
    )]
    QuarticWeight {
        /// Which solution of the constraint: 1 or 2.
        solution: u8,
        /// The weight.
        w1: f64,
        /// The bound that the weight must exceed.
        above: f64,
    },
    /// Weights or constants do not make a circle.
    #[error(
        "{what} is {}: a circle needs {needed} to within {tolerance:.1e}",
        Shown(*.found)
    )]
    NotRound {
        /// The expression whose value is wrong.
        what: &'static str,
        /// Its value.
        found: f64,
        /// The value it must have.
        needed: f64,
        /// How far from that it may be.
        tolerance: f64,
    },
}
