//! The error of triangular patches: numbers that make no such patch.

use glam::DVec3;
use thiserror::Error;

use crate::geometry::{MAX_DEGREE, MAX_MAGNITUDE, MIN_MAGNITUDE};
use crate::math::{Counted, Shown, ShownVector};

/// The reason why numbers cannot be a triangular patch: what was found and what is needed.
///
/// Control points are named by their exponents `(i, j, k)`, which add up to the degree.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TriangleError {
    /// The degree is 0 or above [`MAX_DEGREE`].
    #[error("degree {degree}: degrees from 1 to {MAX_DEGREE} are supported")]
    Degree {
        /// The degree as given.
        degree: usize,
    },
    /// The number of control points does not match the degree.
    #[error(
        "{}, but a triangle of degree {degree} needs {needed}",
        Counted(*.points, "control point")
    )]
    PointCount {
        /// The number of control points given.
        points: usize,
        /// The degree.
        degree: usize,
        /// The number that the degree needs.
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
        "control point {} is {}: coordinates must be finite (up to {MAX_MAGNITUDE:e})",
        named(.exponents), ShownVector(*.point)
    )]
    Point {
        /// Its exponents.
        exponents: [usize; 3],
        /// Its coordinates; where weights were given, possibly multiplied by its weight.
        point: DVec3,
    },
    /// A weight is not a number from [`MIN_MAGNITUDE`] to [`MAX_MAGNITUDE`].
    #[error(
        "the weight of control point {} is {}: \
         it must be positive and finite (from {MIN_MAGNITUDE:e} to {MAX_MAGNITUDE:e})",
        named(.exponents), Shown(*.weight)
    )]
    Weight {
        /// The control point's exponents.
        exponents: [usize; 3],
        /// Its weight.
        weight: f64,
    },
    /// All control points coincide.
    #[error("all control points are {}: the patch has no extent", ShownVector(*.point))]
    NoExtent {
        /// Where they are.
        point: DVec3,
    },
    /// All control points lie on one line, to within rounding.
    #[error(
        "all control points lie on the line from {} to {}, to within rounding: the patch has \
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

/// Exponents as messages write them.
fn named([i, j, k]: &[usize; 3]) -> String {
    format!("({i}, {j}, {k})")
}
