//! Why numbers cannot be a surface, or an operation not be done on one.

use std::fmt;

use glam::DVec3;
use thiserror::Error;

use super::KnotError;

/// One of the two parameters of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Direction {
    /// The first parameter; it runs along the columns of the control net.
    U,
    /// The second parameter; it runs along the rows of the control net.
    V,
}

impl fmt::Display for Direction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::U => "u",
            Self::V => "v",
        })
    }
}

/// Why numbers cannot be a surface, or an operation not be done on one.
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
    #[error("{points} control points, but the knots need {nu} × {nv} of them")]
    PointCount {
        /// The number of control points given.
        points: usize,
        /// Control points along u, by the knots.
        nu: usize,
        /// Control points along v, by the knots.
        nv: usize,
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
    #[error("control point ({i}, {j}) is ({}, {}, {}): it must be finite", .point.x, .point.y, .point.z)]
    Point {
        /// Its index along u.
        i: usize,
        /// Its index along v.
        j: usize,
        /// Its coordinates; where weights were given, possibly multiplied by its weight.
        point: DVec3,
    },
    /// A weight is not a positive, finite number.
    #[error("the weight of control point ({i}, {j}) is {weight}: it must be positive and finite")]
    Weight {
        /// The control point's index along u.
        i: usize,
        /// The control point's index along v.
        j: usize,
        /// Its weight.
        weight: f64,
    },
    /// All control points coincide.
    #[error("all control points are ({}, {}, {}): the surface has no extent", .point.x, .point.y, .point.z)]
    NoExtent {
        /// Where they are.
        point: DVec3,
    },
    /// A parameter does not lie where the operation needs it.
    #[error(
        "direction {direction}: the parameter {t} does not lie inside the domain from {start} to {end}"
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
    /// A transform that is not finite, or flattens space.
    #[error("the transform is not invertible: its determinant is {determinant}")]
    Transform {
        /// The determinant of its linear part.
        determinant: f64,
    },
}
