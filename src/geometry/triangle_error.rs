//! Why numbers cannot be a triangular patch.

use glam::DVec3;
use thiserror::Error;

use super::MAX_DEGREE;

/// Why numbers cannot be a triangular patch: what was found and what is needed.
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
    #[error("{points} control points, but a triangle of degree {degree} needs {needed}")]
    PointCount {
        /// The number of control points given.
        points: usize,
        /// The degree.
        degree: usize,
        /// The number it needs.
        needed: usize,
    },
    /// The number of weights does not match the control points.
    #[error("{weights} weights for {points} control points: each needs one, or none has any")]
    WeightCount {
        /// The number of weights given.
        weights: usize,
        /// The number of control points.
        points: usize,
    },
    /// A control point is NaN or infinite.
    #[error(
        "control point {exponents:?} is ({}, {}, {}): it must be finite",
        .point.x, .point.y, .point.z
    )]
    Point {
        /// Its exponents.
        exponents: [usize; 3],
        /// Its coordinates; where weights were given, possibly multiplied by its weight.
        point: DVec3,
    },
    /// A weight is not a positive, finite number.
    #[error(
        "the weight of control point {exponents:?} is {weight}: it must be positive and finite"
    )]
    Weight {
        /// The control point's exponents.
        exponents: [usize; 3],
        /// Its weight.
        weight: f64,
    },
    /// All control points coincide.
    #[error(
        "all control points are ({}, {}, {}): the patch has no extent",
        .point.x, .point.y, .point.z
    )]
    NoExtent {
        /// Where they are.
        point: DVec3,
    },
    /// A transform that is not finite, or flattens space.
    #[error("the transform is not invertible: its determinant is {determinant}")]
    Transform {
        /// The determinant of its linear part.
        determinant: f64,
    },
}
