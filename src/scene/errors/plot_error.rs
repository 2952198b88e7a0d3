//! Why a plot cannot be drawn.

use thiserror::Error;

use crate::geometry::CurveError;
use crate::math::Counted;
use crate::scene::written::{
    MAX_FUNCTIONS, MAX_LINES, MAX_ROUNDS, MAX_TEETH, TransformError, UnknownName,
};

/// Why a plot cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PlotError {
    /// Numbers that do not make a curve.
    #[error("{which}: {error}")]
    Curve {
        /// Which of its curves.
        which: String,
        /// What is wrong with it.
        error: CurveError,
    },
    /// A curve's transform that is not a transform of space.
    #[error("{which}: {error}")]
    Transform {
        /// Which of its curves.
        which: String,
        /// What is wrong with its transform.
        error: TransformError,
    },
    /// Numbers that are not knots or weights of a basis.
    #[error("basis: {0}")]
    Basis(CurveError),
    /// A parameter that the curve does not have.
    #[error("{0}")]
    At(CurveError),
    /// Numbers that do not make a polygon.
    #[error("polygon: {0}")]
    Polygon(CurveError),
    /// Neither knots nor weights nor a count give the number of control points.
    #[error("basis: it is not known of how many points: give knots, weights, or count = …")]
    NoCount,
    /// A count and weights that give two different numbers of control points.
    #[error("basis: {} for count = {count}: each point needs one", Counted(*.weights, "weight"))]
    Count {
        /// The number that is given.
        count: usize,
        /// The number of weights.
        weights: usize,
    },
    /// Knots and weights that go with two different numbers of control points.
    #[error(
        "basis: {}, but the knots of degree {degree} go with {}: each needs one",
        Counted(*.weights, "weight"), Counted(*.points, "control point")
    )]
    Weights {
        /// The number of weights.
        weights: usize,
        /// The number of control points that the knots go with.
        points: usize,
        /// The degree.
        degree: usize,
    },
    /// More functions than can be drawn.
    #[error("basis: {count} functions: at most {MAX_FUNCTIONS} can be drawn")]
    Functions {
        /// How many there are.
        count: usize,
    },
    /// Knots that have no domain, such as those of one function alone.
    #[error(
        "basis: {} of degree {degree}: at least {} are needed, or {} with support = true",
        Counted(*.knots, "knot"), 2 * degree + 2, degree + 2
    )]
    NoDomain {
        /// The number of knots.
        knots: usize,
        /// The degree.
        degree: usize,
    },
    /// A derivative of so high an order that nothing is left of the polynomials.
    #[error("basis: derivative = {found}: at most {degree} is possible, the degree")]
    Derivative {
        /// The order that was asked for.
        found: usize,
        /// The degree.
        degree: usize,
    },
    /// A derivative of a curve that does not exist, or of which nothing is known to be left.
    #[error("order = {found}: needed is 1 to {degree}, the degree of the curve")]
    Order {
        /// The order that was asked for.
        found: usize,
        /// The degree.
        degree: usize,
    },
    /// Rational functions off the domain.
    #[error("basis: rational functions end with the domain: support = true goes without weights")]
    WeightedSupport,
    /// There is no curve.
    #[error("there are no curves to draw: give at least one")]
    NoCurves,
    /// There is no knot to insert.
    #[error("insertion: there are no knots to insert: give at least one")]
    NoKnots,
    /// A degree that is not raised.
    #[error("elevation: times = 0: the degree is to be raised once at least")]
    NotElevated,
    /// Too many teeth, or none.
    #[error("comb: {found} teeth a span: needed are 1 to {MAX_TEETH}")]
    Teeth {
        /// How many were asked for.
        found: usize,
    },
    /// An object that the scene does not have.
    #[error("{0}")]
    Object(UnknownName),
    /// A surface that an object does not have.
    #[error("surface = {wanted}: \"{of}\" has {}", surfaces(*.count))]
    NoSurface {
        /// The object.
        of: String,
        /// How many surfaces it has.
        count: usize,
        /// Which was asked for, counted from 0.
        wanted: usize,
    },
    /// An object without trims.
    #[error("trims: \"{of}\" has none")]
    NoTrims {
        /// The object.
        of: String,
    },
    /// An object with several trimmed surfaces.
    #[error(
        "trims: {} surfaces of \"{of}\" are trimmed: choose one with surface = {}",
        .numbers.len(), choice(.numbers)
    )]
    SeveralTrimmed {
        /// The object.
        of: String,
        /// The numbers of its trimmed surfaces, counted from 0.
        numbers: Vec<usize>,
    },
    /// Too many lines.
    #[error("surfaces: {found} lines each way: at most {MAX_LINES} can be told apart")]
    Lines {
        /// How many were asked for.
        found: usize,
    },
    /// Too many rounds.
    #[error("corner_cutting: {found} rounds: at most {MAX_ROUNDS} can be told apart")]
    Rounds {
        /// How many were asked for.
        found: usize,
    },
}

/// `3 surfaces, 0 to 2`.
fn surfaces(count: usize) -> String {
    match count {
        0 => "no surface".to_owned(),
        1 => "one surface only, 0".to_owned(),
        count => format!("{count} surfaces, 0 to {}", count - 1),
    }
}

/// `0, 1 or 4`; of many, the first few.
fn choice(numbers: &[usize]) -> String {
    const SHOWN: usize = 6;
    let mut words: Vec<String> = numbers.iter().take(SHOWN).map(usize::to_string).collect();
    if numbers.len() > SHOWN {
        return format!("{}, …", words.join(", "));
    }
    let last = words.pop().unwrap_or_default();
    format!("{} or {last}", words.join(", "))
}
