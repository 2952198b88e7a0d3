//! The curves that make up trim loops.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3, Vec3Swizzles};

use super::MAX_PARAMETER;
use super::TrimCurveError;
use crate::geometry::{KnotVector, NurbsCurve};

/// The most points of a polyline, or Bézier pieces of a spline times its degree; more are taken for
/// a mistake. An outline of a million points is far beyond what a map holds.
pub const MAX_TRIM_POINTS: usize = 1 << 20;

/// The smallest weight, relative to the largest of its piece. With a smaller one, a step from one
/// floating-point parameter to the next moves the point by more than 10⁻⁷ of the piece.
const SMALLEST_WEIGHT: f64 = 1e-9;

/// A curve in the (u, v) plane: a chain of rational Bézier pieces.
///
/// Polylines, circular arcs, Bézier curves and NURBS of any degree up to
/// [`MAX_DEGREE`](crate::geometry::MAX_DEGREE) are all held in this one form, with homogeneous
/// control points `(w u, w v, w)`.
///
/// # Invariants, checked once on construction
/// - there is at least one piece, and each has between 2 and `MAX_DEGREE + 1` points;
/// - parameters are at most 10¹⁰⁰, the weights of a piece lie in (0, 1], the largest is 1,
///   and none is below 10⁻⁹.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimCurve {
    pieces: Vec<Vec<DVec3>>,
}

/// The point that a homogeneous control point stands for.
pub(super) fn euclidean(control: DVec3) -> DVec2 {
    control.xy() / control.z
}

fn homogeneous(point: DVec2, weight: f64) -> DVec3 {
    (weight * point).extend(weight)
}

impl TrimCurve {
    /// The straight line between two points.
    ///
    /// # Errors
    /// When a point is not finite.
    pub fn line(from: DVec2, to: DVec2) -> Result<Self, TrimCurveError> {
        Self::polyline(&[from, to])
    }

    /// The straight lines from each point to the next. To close a polygon, repeat its first
    /// point at the end, or add a [`TrimCurve::line`].
    ///
    /// # Errors
    /// When there are fewer than two points or more than [`MAX_TRIM_POINTS`], or one of them
    /// is not finite.
    pub fn polyline(points: &[DVec2]) -> Result<Self, TrimCurveError> {
        if points.len() > MAX_TRIM_POINTS {
            let (points, limit) = (points.len(), MAX_TRIM_POINTS);
            return Err(TrimCurveError::TooManyPoints { points, limit });
        }
        check_points(points)?;
        let pieces = points.windows(2).map(|ends| ends.iter().map(|&p| p.extend(1.0)).collect());
        Ok(Self { pieces: pieces.collect() })
    }

    /// The Bézier curve of these control points; without weights it is polynomial.
    ///
    /// # Errors
    /// When there are fewer than 2 points, more than [`MAX_DEGREE`](crate::geometry::MAX_DEGREE) +
    /// 1, one is not finite, or a weight is not usable.
    pub fn bezier(points: &[DVec2], weights: Option<&[f64]>) -> Result<Self, TrimCurveError> {
        check_points(points)?;
        KnotVector::bezier(points.len() - 1)?;
        let weights = match weights {
            Some(weights) if weights.len() != points.len() => {
                let (weights, points) = (weights.len(), points.len());
                return Err(TrimCurveError::WeightCount { weights, points });
            }
            Some(weights) => weights.to_vec(),
            None => vec![1.0; points.len()],
        };
        // Weights are scaled before they multiply the points, so that no product overflows.
        let weights = normalized_weights(&weights, 0)?;
        let control = points.iter().zip(weights).map(|(&point, w)| homogeneous(point, w));
        Ok(Self { pieces: vec![control.collect()] })
    }

    /// A NURBS curve in the plane `z = 0`, whose x and y are u and v.
    ///
    /// # Errors
    /// When the curve leaves the plane, has more than [`MAX_TRIM_POINTS`] pieces times its degree,
    /// or a weight is too small relative to the largest of its piece.
    pub fn nurbs(curve: &NurbsCurve) -> Result<Self, TrimCurveError> {
        if let Some(index) = curve.control().iter().position(|point| point.z != 0.0) {
            return Err(TrimCurveError::NotFlat { index, z: curve.vertex(index).z });
        }
        let degree = curve.knots().degree();
        let pieces = curve.knots().spans().count();
        if pieces.saturating_mul(degree) > MAX_TRIM_POINTS {
            let points = pieces.saturating_mul(degree);
            return Err(TrimCurveError::TooManyPoints { points, limit: MAX_TRIM_POINTS });
        }
        let bezier = curve.bezier_form();
        let mut pieces = Vec::with_capacity(pieces);
        for span in bezier.knots().spans() {
            let first = span.index - degree;
            let control = &bezier.control()[first..=span.index];
            let points: Vec<DVec2> = control.iter().map(|c| DVec2::new(c.x, c.y) / c.w).collect();
            check_points(&points).map_err(|error| error.counted_from(first))?;
            let largest = control.iter().map(|c| c.w).fold(0.0, f64::max);
            let given: Vec<f64> = control.iter().map(|c| c.w).collect();
            let weights = normalized_weights(&given, first)?;
            // Dividing by the largest weight costs one rounding; equal weights become 1 and
            // cost nothing more than the division the points need anyway.
            let scaled = control.iter().zip(weights);
            pieces.push(scaled.map(|(c, w)| DVec3::new(c.x / largest, c.y / largest, w)).collect());
        }
        Ok(Self { pieces })
    }

    /// The circular arc about `center` from one angle to another, in radians from the u axis
    /// towards the v axis; from a larger angle to a smaller one it runs clockwise.
    ///
    /// [`shapes::circle_arc`](crate::geometry::shapes::circle_arc) is different: it takes degrees,
    /// and the turn instead of the angle at which the arc ends.
    ///
    /// It is a circle in the (u, v) plane, made of rational quadratic pieces of at most a quarter
    /// turn; its ends are accurate to a few rounding errors of `|center| + radius`.
    ///
    /// # Errors
    /// When the center is not finite, the radius not positive, or the angles agree or lie more
    /// than one turn apart.
    pub fn arc(center: DVec2, radius: f64, from: f64, to: f64) -> Result<Self, TrimCurveError> {
        check_arc(center, radius)?;
        let sweep = to - from;
        let usable = sweep != 0.0 && sweep.abs() <= TAU * (1.0 + 4.0 * f64::EPSILON); // not NaN
        if !usable {
            return Err(TrimCurveError::Angles { from, to });
        }
        // A whole turn takes four pieces, even if rounding has made it slightly larger.
        let count = (sweep.abs() / FRAC_PI_2 * (1.0 - 4.0 * f64::EPSILON)).ceil().clamp(1.0, 4.0);
        let step = sweep / count;
        let weight = (0.5 * step).cos();
        let on_circle = |angle: f64| center + radius * DVec2::from_angle(angle);
        let piece = |k: usize| {
            let start = from + step * k as f64;
            let end = if k + 1 == count as usize { to } else { from + step * (k + 1) as f64 };
            let corner = center + radius / weight * DVec2::from_angle(0.5 * (start + end));
            vec![
                on_circle(start).extend(1.0),
                homogeneous(corner, weight),
                on_circle(end).extend(1.0),
            ]
        };
        Ok(Self { pieces: (0..count as usize).map(piece).collect() })
    }

    /// The circle about `center`, counter-clockwise from `(center.u + radius, center.v)`, in
    /// four quarters that end at its extremes.
    ///
    /// # Errors
    /// When the center is not finite or the radius not positive.
    pub fn circle(center: DVec2, radius: f64) -> Result<Self, TrimCurveError> {
        check_arc(center, radius)?;
        let axes = [DVec2::X, DVec2::Y, DVec2::NEG_X, DVec2::NEG_Y];
        let piece = |k: usize| {
            let (start, end) = (axes[k], axes[(k + 1) % 4]);
            let corner = center + radius * (start + end);
            vec![
                (center + radius * start).extend(1.0),
                homogeneous(corner, std::f64::consts::FRAC_1_SQRT_2),
                (center + radius * end).extend(1.0),
            ]
        };
        Ok(Self { pieces: (0..4).map(piece).collect() })
    }

    /// Where the curve begins.
    pub fn start(&self) -> DVec2 {
        euclidean(self.pieces[0][0])
    }

    /// Where the curve ends.
    pub fn end(&self) -> DVec2 {
        let last = &self.pieces[self.pieces.len() - 1];
        euclidean(last[last.len() - 1])
    }

    /// The curve run backwards.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let backwards = |piece: &Vec<DVec3>| piece.iter().rev().copied().collect();
        Self { pieces: self.pieces.iter().rev().map(backwards).collect() }
    }

    /// The homogeneous control points of the Bézier pieces.
    pub(super) fn pieces(&self) -> &[Vec<DVec3>] {
        &self.pieces
    }
}

impl TrimCurveError {
    /// The same error with `first` added to the index of its point.
    fn counted_from(self, first: usize) -> Self {
        match self {
            Self::Point { index, point } => Self::Point { index: index + first, point },
            other => other,
        }
    }
}

fn check_points(points: &[DVec2]) -> Result<(), TrimCurveError> {
    if points.len() < 2 {
        return Err(TrimCurveError::TooFewPoints { points: points.len() });
    }
    let usable = |point: &DVec2| point.abs().cmple(DVec2::splat(MAX_PARAMETER)).all(); // not NaN
    match points.iter().position(|point| !usable(point)) {
        Some(index) => Err(TrimCurveError::Point { index, point: points[index] }),
        None => Ok(()),
    }
}

fn check_arc(center: DVec2, radius: f64) -> Result<(), TrimCurveError> {
    check_points(&[center, center])?;
    let usable = 0.0 < radius && radius <= MAX_PARAMETER; // false for NaN
    if usable { Ok(()) } else { Err(TrimCurveError::Radius { radius }) }
}

/// The weights of a piece divided by their largest; `first` is the index of the first weight in
/// errors.
fn normalized_weights(weights: &[f64], first: usize) -> Result<Vec<f64>, TrimCurveError> {
    let largest = weights.iter().copied().fold(0.0, f64::max); // passes over NaN
    let scaled: Vec<f64> = weights.iter().map(|w| w / largest).collect();
    match scaled.iter().position(|w| !(SMALLEST_WEIGHT..=1.0).contains(w)) {
        Some(index) => {
            let weight = weights[index];
            Err(TrimCurveError::Weight { index: index + first, weight, largest })
        }
        None => Ok(scaled),
    }
}
