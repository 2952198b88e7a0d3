//! Why numbers cannot be a curve, or an operation not be done on one.

use glam::DVec3;
use thiserror::Error;

use super::KnotError;
use crate::math::{Shown, ShownVector};

/// Why numbers cannot be a curve, or an operation not be done on one.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CurveError {
    /// The knots would not be valid.
    #[error(transparent)]
    Knots(#[from] KnotError),
    /// The number of control points does not match the knots.
    #[error("{points} control points, but the knots need {needed}")]
    PointCount {
        /// The number of control points given.
        points: usize,
        /// The number the knots ask for.
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
}
