//! The error of surfaces: numbers that make no surface, or an operation that a surface does not
//! allow.

use glam::DVec3;
use thiserror::Error;

use crate::geometry::{Direction, KnotError};
use crate::geometry::{MAX_MAGNITUDE, MIN_MAGNITUDE};
use crate::math::{Counted, Shown, ShownVector};

/// The reason why numbers make no surface, or why an operation cannot be done on a surface.
///
/// Control points are named by `(i, j)`, counted from 0: `i` along u, `j` along v.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SurfaceError {
    /// The knots of one direction would not be valid.
    #[error("direction {direction}: {error}")]
    Knots {
        /// Which direction.
        direction: Direction,
        /// What is wrong with them.
        error: KnotError,
    },
    /// The number of control points does not match the two knot vectors.
    #[error(
        "{}, but the knots need {nu} × {nv} of them",
        Counted(*.points, "control point")
    )]
    PointCount {
        /// The number of control points given.
        points: usize,
        /// Control points along u, by the knots.
        nu: usize,
        /// Control points along v, by the knots.
        nv: usize,
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
        "control point ({i}, {j}) is {}: coordinates must be finite (up to {MAX_MAGNITUDE:e})",
        ShownVector(*.point)
    )]
    Point {
        /// Its index along u.
        i: usize,
        /// Its index along v.
        j: usize,
        /// Its coordinates; where weights were given, possibly multiplied by its weight.
        point: DVec3,
    },
    /// A weight is not a number from [`MIN_MAGNITUDE`] to [`MAX_MAGNITUDE`].
    #[error(
        "the weight of control point ({i}, {j}) is {}: \
         it must be positive and finite (from {MIN_MAGNITUDE:e} to {MAX_MAGNITUDE:e})",
        Shown(*weight)
    )]
    Weight {
        /// The control point's index along u.
        i: usize,
        /// The control point's index along v.
        j: usize,
        /// Its weight.
        weight: f64,
    },
    /// All control points coincide.
    #[error("all control points are {}: the surface has no extent", ShownVector(*.point))]
    NoExtent {
        /// Where they are.
        point: DVec3,
    },
    /// All control points lie on one line, to within rounding.
    #[error(
        "all control points lie on the line from {} to {}, to within rounding: the surface has \
         no area",
        ShownVector(*.from),
        ShownVector(*.to)
    )]
    NoArea {
        /// One of the control points.
        from: DVec3,
        /// The control point farthest from `from`.
        to: DVec3,
    },
    /// The control points span less than [`MIN_MAGNITUDE`].
    #[error("the control points span {}: at least {MIN_MAGNITUDE:e} is needed", Shown(*size))]
    TooSmall {
        /// Their extent along the longest axis.
        size: f64,
    },
    /// The domain of a parameter is shorter than [`MIN_MAGNITUDE`] or longer than
    /// [`MAX_MAGNITUDE`].
    #[error(
        "direction {direction}: the domain runs from {} to {}: \
         lengths from {MIN_MAGNITUDE:e} to {MAX_MAGNITUDE:e} are supported",
        Shown(*start),
        Shown(*end)
    )]
    Domain {
        /// Which direction.
        direction: Direction,
        /// Where the domain begins.
        start: f64,
        /// Where the domain ends.
        end: f64,
    },
    /// A parameter does not lie where the operation needs it.
    #[error(
        "direction {direction}: the parameter {} does not lie inside the domain from {} to {}",
        Shown(*t),
        Shown(*start),
        Shown(*end)
    )]
    Parameter {
        /// Which direction.
        direction: Direction,
        /// The parameter.
        t: f64,
        /// Where the domain begins.
        start: f64,
        /// Where the domain ends.
        end: f64,
    },
    /// A patch in matrix form has as many rows or columns as none of that form has.
    #[error("the geometry matrix has {} along {direction}: the form {form} takes {needed}",
        Counted(*.found, "vector"))]
    GeometryCount {
        /// The parameter that runs over these vectors.
        direction: Direction,
        /// The name of the form.
        form: &'static str,
        /// The number of vectors given.
        found: usize,
        /// How many the form takes.
        needed: &'static str,
    },
    /// A row of a geometry matrix is longer or shorter than the first one.
    #[error(
        "row {row} of the geometry matrix has {}, but row 0 has {first}", Counted(*.found, "vector")
    )]
    GeometryRow {
        /// Which row, counted from 0.
        row: usize,
        /// The number of vectors in it.
        found: usize,
        /// The number of vectors in row 0.
        first: usize,
    },
    /// A Bézier coefficient of a denominator is zero, or has another sign than the first.
    #[error(
        "the denominator's Bézier coefficient ({i}, {j}) is {}: all must be positive, or all \
         negative; they may be so on a smaller domain",
        Shown(*.coefficient)
    )]
    Denominator {
        /// Its index along u.
        i: usize,
        /// Its index along v.
        j: usize,
        /// The coefficient.
        coefficient: f64,
    },
    /// A transform has a number that is NaN or infinite.
    #[error("the transform is not finite: all of its numbers must be")]
    TransformNotFinite,
    /// A transform flattens space, or enlarges it beyond the range of f64.
    #[error("the transform's determinant is {}: it must be neither 0 nor infinite", Shown(*determinant))]
    Transform {
        /// The determinant of its linear part.
        determinant: f64,
    },
}
