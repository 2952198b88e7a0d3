//! The errors of trim curves, loops and trims.

use glam::DVec2;
use thiserror::Error;

use super::MAX_PARAMETER;
use crate::geometry::{Direction, KnotError};
use crate::math::{Counted, Measured, Shown};

/// A point of (u, v) as it was given.
fn shown(point: DVec2) -> String {
    format!("({}, {})", Shown(point.x), Shown(point.y))
}

/// A point of (u, v) that was computed.
fn measured(point: DVec2) -> String {
    format!("({}, {})", Measured(point.x), Measured(point.y))
}

/// How to bring a loop nearer to its domain.
fn nearer(periodic: bool) -> &'static str {
    if periodic { "move the loop by whole periods" } else { "cut the loop off nearer to it" }
}

/// Two points of (u, v) that were computed, with as many digits as it takes to tell them apart.
fn told_apart(points: [DVec2; 2]) -> [String; 2] {
    let with = |digits: usize| {
        let rounded = |x: f64| format!("{x:.digits$e}").parse().unwrap_or(x);
        points.map(|point| shown(DVec2::new(rounded(point.x), rounded(point.y))))
    };
    let differ = |texts: &[String; 2]| texts[0] != texts[1];
    (5..17).map(with).find(differ).unwrap_or_else(|| with(17))
}

/// Why numbers cannot be a curve of a trim loop.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrimCurveError {
    /// Too few points.
    #[error("{}: a curve needs at least 2", Counted(*.points, "point"))]
    TooFewPoints {
        /// The number given.
        points: usize,
    },
    /// More points than are taken for an honest outline.
    #[error("{points} points: at most {limit} are supported")]
    TooManyPoints {
        /// The number given.
        points: usize,
        /// The number supported.
        limit: usize,
    },
    /// The degree is not supported.
    #[error(transparent)]
    Degree(#[from] KnotError),
    /// A point is NaN, infinite, or absurdly large.
    #[error("point {index} is {}: it must be finite and at most {MAX_PARAMETER:e}", shown(*.point))]
    Point {
        /// Which point, counted from 0.
        index: usize,
        /// The point.
        point: DVec2,
    },
    /// A curve in space that leaves the plane of (u, v).
    #[error("control point {index} has z = {}: a trim curve lies in the plane z = 0", Shown(*.z))]
    NotFlat {
        /// Which control point, counted from 0.
        index: usize,
        /// Its third coordinate.
        z: f64,
    },
    /// The number of weights does not match the points.
    #[error(
        "{} for {}: each needs one, or none has any",
        Counted(*.weights, "weight"), Counted(*.points, "point")
    )]
    WeightCount {
        /// The number of weights.
        weights: usize,
        /// The number of points.
        points: usize,
    },
    /// A weight is not positive and finite, or too small beside the largest of its piece.
    #[error(
        "the weight of point {index} is {}: it must be positive and finite, and at least 1e-9 of the largest, {}",
        Shown(*.weight), Shown(*.largest)
    )]
    Weight {
        /// Which point, counted from 0; in a spline, counted in its Bézier form.
        index: usize,
        /// Its weight.
        weight: f64,
        /// The largest weight beside it.
        largest: f64,
    },
    /// An arc has no usable radius.
    #[error("the radius is {}: it must be positive and at most {MAX_PARAMETER:e}", Shown(*.radius))]
    Radius {
        /// The radius.
        radius: f64,
    },
    /// An arc has no usable angles.
    #[error(
        "the arc goes from {} to {} radians: they must be finite, differ, and lie at most one turn apart",
        Shown(*.from), Shown(*.to)
    )]
    Angles {
        /// Where it begins.
        from: f64,
        /// Where it ends.
        to: f64,
    },
}

/// Why curves cannot be a loop.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrimLoopError {
    /// A curve of the loop is invalid.
    #[error(transparent)]
    Curve(#[from] TrimCurveError),
    /// There is no curve.
    #[error("a loop needs at least one curve")]
    Empty,
    /// A curve does not begin where the one before it ends.
    #[error(
        "the loop is open: curve {curve} ends at {}, but curve {next} begins at {}, {} away; \
         gaps up to {} are closed",
        told_apart([*.end, *.end + *.gap])[0], told_apart([*.end, *.end + *.gap])[1],
        measured(*.gap), measured(*.tolerance)
    )]
    Open {
        /// The curve that ends, counted from 0.
        curve: usize,
        /// The curve that follows; the same for a spline that jumps at a knot.
        next: usize,
        /// Where it ends.
        end: DVec2,
        /// From there to where the next one begins.
        gap: DVec2,
        /// How large a gap may be, in u and in v.
        tolerance: DVec2,
    },
    /// A loop runs from one end of the domain to the other and does not come back.
    #[error(
        "the loop is open: it runs once across the domain in {direction}, from {} to {}, and which \
         side of it is meant is not known; lead it back through {} and {} for the one side, through \
         {} and {} for the other, or along a second such line for the band between the two",
        measured(.ends[0]), measured(.ends[1]), measured(.back[0][0]), measured(.back[0][1]),
        measured(.back[1][0]), measured(.back[1][1])
    )]
    Across {
        /// The direction in which it runs the whole length of the domain.
        direction: Direction,
        /// Where it begins and ends.
        ends: [DVec2; 2],
        /// Ways back: two points beside the loop's end and its beginning on one border of the
        /// domain, then two on the other border.
        back: [[DVec2; 2]; 2],
    },
    /// The loop is a point, or runs back over itself.
    #[error("the loop encloses nothing: it lies on {} to {}", measured(*.min), measured(*.max))]
    Degenerate {
        /// The smallest parameters of the loop.
        min: DVec2,
        /// The largest.
        max: DVec2,
    },
    /// The whole loop is run through more than once.
    #[error(
        "the loop on {} to {} is run through more than once: what is passed twice cuts nothing; \
         give it once",
        measured(*.min), measured(*.max)
    )]
    Repeated {
        /// The smallest parameters of the loop.
        min: DVec2,
        /// The largest.
        max: DVec2,
    },
    /// The loop turns round and runs back over itself for a while.
    #[error(
        "the loop has a dangling edge: at {} it turns round and runs back over itself, to {} at \
         least; leave that edge out, in which nothing is enclosed",
        told_apart([*.at, *.until])[0], told_apart([*.at, *.until])[1]
    )]
    Dangling {
        /// Where it turns round.
        at: DVec2,
        /// Where the shorter of the two curves that meet there has its other end.
        until: DVec2,
    },
}

/// Why loops cannot trim a surface.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TrimError {
    /// The domain is not a valid range.
    #[error(
        "the domain in {direction} goes from {} to {}: it must be finite, at most {MAX_PARAMETER:e}, and not empty",
        Shown(*.start), Shown(*.end)
    )]
    Domain {
        /// The direction.
        direction: Direction,
        /// Where it begins.
        start: f64,
        /// Where it ends.
        end: f64,
    },
    /// The trims are made for another domain than the surface's.
    #[error(
        "the trims are made for the domain {} to {}, but the surface's is {} to {}",
        shown(.trims[0]), shown(.trims[1]), shown(.surface[0]), shown(.surface[1])
    )]
    OtherDomain {
        /// The smallest and largest parameters of the trims' domain.
        trims: [DVec2; 2],
        /// Those of the surface's.
        surface: [DVec2; 2],
    },
    /// There is no loop.
    #[error("there are no loops: a surface that is not trimmed needs no trims")]
    NoLoops,
    /// A loop is invalid by itself.
    #[error("loop {index}: {error}")]
    Loop {
        /// Which loop, counted from 0.
        index: usize,
        /// What is wrong with it.
        error: TrimLoopError,
    },
    /// A loop lies outside the domain, or on its border, and cuts nothing.
    #[error(
        "loop {index} lies on {} to {}: no part of it is inside the domain {} to {}",
        measured(.loop_box[0]), measured(.loop_box[1]), shown(.domain[0]), shown(.domain[1])
    )]
    OutsideDomain {
        /// Which loop, counted from 0.
        index: usize,
        /// Its smallest and largest parameters.
        loop_box: [DVec2; 2],
        /// Those of the domain.
        domain: [DVec2; 2],
    },
    /// A loop reaches so far beyond the domain that digits are lost there.
    #[error(
        "loop {index} reaches {direction} = {}, too far from the domain, {} to {}: at most {limit:e} times its \
         length is supported; {}",
        Measured(*.at), Shown(.domain[0]), Shown(.domain[1]), nearer(*.periodic)
    )]
    TooFar {
        /// Which loop, counted from 0.
        index: usize,
        /// In which direction.
        direction: Direction,
        /// How far it reaches.
        at: f64,
        /// Where the domain begins and ends.
        domain: [f64; 2],
        /// Whether it closes on itself in that direction.
        periodic: bool,
        /// How many times the domain's length a loop may be away from it.
        limit: f64,
    },
    /// A loop goes around a periodic domain too often.
    #[error(
        "loop {index} is {} periods long in {direction}: at most {limit} are supported",
        Measured(*.periods)
    )]
    TooManyPeriods {
        /// Which loop, counted from 0.
        index: usize,
        /// In which direction.
        direction: Direction,
        /// How many periods it spans.
        periods: f64,
        /// How many are supported.
        limit: usize,
    },
    /// A loop crosses itself.
    #[error("loop {index} crosses itself at (u, v) = {}", measured(*.at))]
    SelfCrossing {
        /// Which loop, counted from 0.
        index: usize,
        /// Where.
        at: DVec2,
    },
    /// A loop on a periodic domain crosses a copy of itself.
    #[error(
        "loop {index} overlaps itself where the surface closes: it crosses its copy a period away, \
         at (u, v) = {}",
        measured(*.at)
    )]
    CopyCrossing {
        /// Which loop, counted from 0.
        index: usize,
        /// Where.
        at: DVec2,
    },
    /// Two loops cross.
    #[error("loops {} and {} cross at (u, v) = {}", .loops[0], .loops[1], measured(*.at))]
    Crossing {
        /// Which loops, counted from 0.
        loops: [usize; 2],
        /// Where.
        at: DVec2,
    },
    /// Two loops are one and the same curve, and would undo each other.
    #[error("loops {} and {} are the same curve", .loops[0], .loops[1])]
    Coincident {
        /// Which loops, counted from 0.
        loops: [usize; 2],
    },
    /// More segments than are taken for honest outlines.
    #[error("the loops have more than {limit} monotone segments")]
    TooManySegments {
        /// The number supported.
        limit: usize,
    },
    /// The loops are so entangled that checking them for crossings is refused.
    #[error(
        "the loops are so close together, or so entangled, that comparing {limit} pairs of their \
         parts did not tell whether they cross"
    )]
    Entangled {
        /// The number of pairs that are compared for loops of this length.
        limit: usize,
    },
    /// No outline can be drawn to this tolerance.
    #[error(
        "the tolerance is {}: it must be positive, and not so small that more than {limit} points are needed",
        Shown(*.tolerance)
    )]
    Tolerance {
        /// The tolerance.
        tolerance: f64,
        /// The most points an outline may have.
        limit: usize,
    },
}
