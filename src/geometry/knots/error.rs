//! The error of knot vectors: numbers that cannot be the knots of a spline.

use std::fmt;

use thiserror::Error;

use crate::geometry::{MAX_CONTROL_POINTS, MAX_DEGREE};
use crate::math::{Counted, Shown};

/// The reason why numbers cannot be the knots of a spline: what was found and what is needed.
///
/// A file reader adds the file, the line, the surface's name and the direction.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum KnotError {
    /// The degree is 0 or above [`MAX_DEGREE`].
    #[error("degree {degree}: degrees from 1 to {MAX_DEGREE} are supported")]
    Degree {
        /// The degree as given.
        degree: usize,
    },
    /// The degree of basis functions is above [`MAX_DEGREE`].
    #[error("degree {degree}: degrees from 0 to {MAX_DEGREE} are supported")]
    BasisDegree {
        /// The degree as given.
        degree: usize,
    },
    /// Too few knots for even one basis function.
    #[error(
        "{} of degree {degree}: at least {} are needed for one function",
        Counted(*.knots, "knot"), degree + 2
    )]
    NoFunction {
        /// The number of knots given.
        knots: usize,
        /// The degree.
        degree: usize,
    },
    /// All knots are equal.
    #[error("all knots are {}: two must differ", Shown(*knot))]
    AllEqual {
        /// Their value.
        knot: f64,
    },
    /// No control points, where one is enough.
    #[error("no control points: at least 1 is needed")]
    NoPoints,
    /// Fewer control points than a single span of a spline of this degree needs.
    #[error(
        "{} of degree {degree}: at least {} are needed",
        Counted(*.points, "point"), degree + 1
    )]
    TooFewPoints {
        /// The number of control points given, or implied by the number of knots.
        points: usize,
        /// The degree.
        degree: usize,
    },
    /// Too few knots for even one span.
    #[error("{} of degree {degree}: at least {} are needed", Counted(*.knots, "knot"), 2 * degree + 2)]
    TooFewKnots {
        /// The number of knots given.
        knots: usize,
        /// The degree.
        degree: usize,
    },
    /// Too few control points for a closed spline.
    #[error("a closed spline of {}: at least {needed} are needed", Counted(*.points, "point"))]
    ShortPeriod {
        /// The number of different control points: one less than the knots of a period.
        points: usize,
        /// The smallest number that makes a closed spline.
        needed: usize,
    },
    /// The control points of a closed spline end with those that closed splines repeat by
    /// themselves.
    #[error(
        "the last {repeated} control points are the first {repeated} again: a periodic spline \
         repeats them by itself, leave them out"
    )]
    Wrapped {
        /// How many are repeated.
        repeated: usize,
    },
    /// The number of a period's knots does not match the control points.
    #[error("{} for one period, but {} need {}", Counted(*.knots, "knot"), Counted(*.points, "point"), points.saturating_add(1))]
    PeriodCount {
        /// The number of knots given.
        knots: usize,
        /// The number of different control points.
        points: usize,
    },
    /// More control points in one direction than [`MAX_CONTROL_POINTS`]; nothing was allocated.
    #[error("{points} points: at most {MAX_CONTROL_POINTS} in one direction are supported")]
    TooManyPoints {
        /// The number of control points asked for.
        points: usize,
    },
    /// The number of knots does not match the degree and the control points.
    #[error(
        "{}, but {points} points of degree {degree} need {}{}",
        Counted(*.knots, "knot"), points + degree + 1,
        Miscounted { knots: *.knots, points: *.points, degree: *.degree }
    )]
    Count {
        /// The number of knots given.
        knots: usize,
        /// The number of control points.
        points: usize,
        /// The degree.
        degree: usize,
    },
    /// A knot is NaN or infinite.
    #[error("knot {index} is {}: knots must be finite numbers", Shown(*knot))]
    NotFinite {
        /// Which knot, counted from 0.
        index: usize,
        /// Its value.
        knot: f64,
    },
    /// A knot is smaller than the one before it.
    #[error("knot {index} is {} after {}: knots must not decrease", Shown(*knot), Shown(*before))]
    Order {
        /// Which knot, counted from 0.
        index: usize,
        /// The knot before it.
        before: f64,
        /// Its value.
        knot: f64,
    },
    /// A knot is repeated so often that a control point would have no influence at all.
    #[error("knot {} is repeated {times} times: degree {degree} allows up to {}", Shown(*knot), degree + 1)]
    Multiplicity {
        /// The repeated value.
        knot: f64,
        /// How often it occurs.
        times: usize,
        /// The degree.
        degree: usize,
    },
    /// A knot is listed with multiplicity 0.
    #[error("knot {} is listed with multiplicity 0: leave it out or give at least 1", Shown(*knot))]
    NoMultiplicity {
        /// The value.
        knot: f64,
    },
    /// The domain has no length.
    #[error(
        "the domain [{}, {}] is empty: knots {degree} and {last} (counted from 0) must differ",
        Shown(*start),
        Shown(*end)
    )]
    EmptyDomain {
        /// The knot at index `degree`.
        start: f64,
        /// The knot at index `last`.
        end: f64,
        /// The degree.
        degree: usize,
        /// The number of control points, the index of the domain's last knot.
        last: usize,
    },
    /// The knots lie so far apart that their differences overflow.
    #[error("the knots run from {} to {}: their difference is not a finite number", Shown(*first), Shown(*last))]
    TooWide {
        /// The first knot.
        first: f64,
        /// The last knot.
        last: f64,
    },
    /// There is no such domain to map knots to.
    #[error("the domain goes from {} to {}: its length must be positive and finite", Shown(*start), Shown(*end))]
    OtherDomain {
        /// Where it would begin.
        start: f64,
        /// Where it would end.
        end: f64,
    },
    /// Two different knots would become equal on another domain.
    #[error(
        "the knots {first} and {second} would become one on the domain from {start} to {end}: \
         it must be longer"
    )]
    Merged {
        /// A knot.
        first: f64,
        /// The next one.
        second: f64,
        /// Where the other domain begins.
        start: f64,
        /// Where it ends.
        end: f64,
    },
}

/// The end of the message about a wrong number of knots: the convention that they may follow.
struct Miscounted {
    knots: usize,
    points: usize,
    degree: usize,
}

impl fmt::Display for Miscounted {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { knots, points, degree } = *self;
        match (points + degree + 1).checked_sub(knots) {
            // Rogers' order k is the degree + 1, and his knots are points + k.
            Some(1) if degree > 1 => {
                write!(f, " ({knots} fit degree {}: the degree is the order less 1)", degree - 1)
            }
            // openNURBS leaves out two, on which no point of the domain depends.
            Some(2) => f.write_str(" (Rhino leaves out the first and the last: add them)"),
            _ => Ok(()),
        }
    }
}
