//! Curves as written: what surfaces are made from.

use glam::{DAffine3, DVec3};

use super::net::{Grid, knot_vector, wrapped};
use super::transform::placed;
use super::{Knots, NamedArc, Place, Transform, TransformError, Written};
use crate::geometry::shapes::{QuarticArc, QuarticConstants, circle_arc, quarter_circle_weighted};
use crate::geometry::{
    CurveError, Direction, KnotError, KnotVector, MatrixForm, NurbsCurve, RationalBasis,
    with_repeated_ends,
};

/// A curve as written, not yet checked.
#[derive(Clone, Debug, PartialEq)]
pub struct CurveSpec {
    /// Where it was written.
    pub place: Place,
    /// What it is.
    pub kind: CurveKind,
    /// Where it goes: each step in turn, the first one first.
    pub transform: Vec<Written<Transform>>,
    /// Whether it is run backwards.
    pub reverse: bool,
}

/// The kinds of curves an author can write.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum CurveKind {
    /// A NURBS curve by its numbers.
    Nurbs {
        /// Its degree.
        degree: Written<usize>,
        /// Its knots.
        knots: Written<Knots>,
        /// Its control points, not multiplied by their weights.
        points: Vec<DVec3>,
        /// A weight for each control point; none for a polynomial curve. Errors about weights name
        /// their place.
        weights: Option<Written<Vec<f64>>>,
    },
    /// Straight lines from point to point.
    Polyline(Vec<DVec3>),
    /// One Bézier curve by its control points.
    Bezier(Vec<DVec3>),
    /// A spline through points in turn.
    Through {
        /// The points.
        points: Vec<DVec3>,
        /// The degree.
        degree: usize,
    },
    /// A uniform B-spline.
    BSpline {
        /// The control points.
        points: Vec<DVec3>,
        /// The degree.
        degree: usize,
        /// How it begins and ends.
        ends: BSplineEnds,
    },
    /// A Catmull–Rom spline: through points, from the second to the last but one.
    CatmullRom {
        /// The points.
        points: Vec<DVec3>,
        /// Whether it runs through all of them and closes.
        closed: bool,
    },
    /// A Hermite spline.
    Hermite {
        /// The points.
        points: Vec<DVec3>,
        /// The derivatives there.
        derivatives: Vec<DVec3>,
    },
    /// A segment in matrix form.
    MatrixForm {
        /// What its vectors mean.
        form: MatrixForm,
        /// Its vectors. Errors about their number name their place.
        geometry: Written<Vec<DVec3>>,
    },
    /// A curve by the coefficients of the powers of its parameter, from `t⁰` on.
    Power {
        /// Those of its numerator.
        coefficients: Written<Vec<DVec3>>,
        /// Those of its denominator; `[1.0]` for a polynomial.
        denominator: Written<Vec<f64>>,
        /// Where its parameter begins and ends.
        domain: Written<[f64; 2]>,
    },
    /// An arc of a circle around the origin in the plane `z = 0`.
    Arc {
        /// Its radius.
        radius: f64,
        /// Where it begins, in degrees from the x axis.
        from: f64,
        /// How far it turns, in degrees, counterclockwise.
        degrees: f64,
    },
    /// A part of the unit circle by name.
    NamedArc(NamedArc),
    /// A quarter of the unit circle of degree 2 with these weights.
    QuadraticArc([f64; 3]),
    /// A quarter of the unit circle of degree 4 by all its constants.
    QuarticConstants {
        /// The weights `w₁`, `w₂`.
        weights: [f64; 2],
        /// The second coordinate of control point 1.
        y1: f64,
        /// Both coordinates of control point 2.
        x2: f64,
    },
    /// A quarter of the unit circle of degree 4, by the weight next to its ends.
    QuarticArc {
        /// Which solution of the constraint.
        arc: QuarticArc,
        /// The weight.
        w1: f64,
    },
}

/// How a uniform B-spline begins and ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BSplineEnds {
    /// Open, with the first and the last control point occurring this many times.
    Repeated([usize; 2]),
    /// It closes.
    Closed,
}

/// Why a curve as written is not a curve.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::scene) enum CurveFault {
    Curve(Place, CurveError),
    Transform(Place, TransformError),
}

impl CurveSpec {
    /// The number of control points written.
    pub fn point_count(&self) -> usize {
        match &self.kind {
            CurveKind::Nurbs { points, .. }
            | CurveKind::Polyline(points)
            | CurveKind::Bezier(points)
            | CurveKind::Through { points, .. }
            | CurveKind::BSpline { points, .. }
            | CurveKind::CatmullRom { points, .. }
            | CurveKind::Hermite { points, .. } => points.len(),
            CurveKind::MatrixForm { geometry, .. } => geometry.value.len(),
            CurveKind::Power { coefficients, denominator, .. } => {
                coefficients.value.len().max(denominator.value.len())
            }
            CurveKind::Arc { .. }
            | CurveKind::NamedArc(_)
            | CurveKind::QuadraticArc(_)
            | CurveKind::QuarticConstants { .. }
            | CurveKind::QuarticArc { .. } => 0,
        }
    }

    /// Returns the curve that these numbers describe, if they describe one, in its place.
    pub(in crate::scene) fn curve(&self) -> Result<NurbsCurve, CurveFault> {
        let blame = |error| CurveFault::Curve(self.culprit(&error).clone(), error);
        let curve = match &self.kind {
            CurveKind::Nurbs { degree, knots, points, weights } => {
                let vector = vector(degree, knots, points.len())?;
                let weights = weights.as_ref().map(|weights| weights.value.as_slice());
                check_weights(points, weights).map_err(blame)?;
                check_period(&knots.value, degree.value, points, weights).map_err(blame)?;
                let [given, needed] = [points.len(), vector.point_count()].map(|count| [1, count]);
                let weights = weights.map(|weights| wrapped(weights, given, needed));
                NurbsCurve::new(vector, wrapped(points, given, needed), weights)
            }
            CurveKind::Polyline(points) => NurbsCurve::polyline(points),
            CurveKind::Bezier(points) => NurbsCurve::bezier(points),
            CurveKind::Through { points, degree } => NurbsCurve::through(points, *degree),
            CurveKind::BSpline { points, degree, ends: BSplineEnds::Repeated(times) } => {
                with_repeated_ends(points, *times)
                    .and_then(|points| NurbsCurve::uniform_bspline(*degree, &points))
            }
            CurveKind::BSpline { points, degree, ends: BSplineEnds::Closed } => {
                NurbsCurve::closed_bspline(*degree, points)
            }
            CurveKind::CatmullRom { points, closed: false } => NurbsCurve::catmull_rom(points),
            CurveKind::CatmullRom { points, closed: true } => {
                NurbsCurve::closed_catmull_rom(points)
            }
            CurveKind::Hermite { points, derivatives } => NurbsCurve::hermite(points, derivatives),
            CurveKind::MatrixForm { form, geometry } => form.segment_of(&geometry.value),
            CurveKind::Power { coefficients, denominator, domain } => {
                NurbsCurve::from_powers(&coefficients.value, &denominator.value, domain.value)
            }
            CurveKind::Arc { radius, from, degrees } => circle_arc(*radius, *from, *degrees),
            CurveKind::NamedArc(circle) => Ok(circle.curve()),
            CurveKind::QuadraticArc(weights) => quarter_circle_weighted(*weights),
            CurveKind::QuarticConstants { weights, y1, x2 } => {
                QuarticConstants::new(*weights, *y1, *x2).map(|constants| constants.curve())
            }
            CurveKind::QuarticArc { arc, w1 } => {
                QuarticConstants::solved(*arc, *w1).map(|constants| constants.curve())
            }
        }
        .map_err(blame)?;
        let curve = curve.transformed(&self.placed()?).map_err(blame)?;
        Ok(if self.reverse { curve.reversed() } else { curve })
    }

    /// Where the part of the curve that an error is about was written.
    fn culprit(&self, error: &CurveError) -> &Place {
        match (&self.kind, error) {
            (
                CurveKind::Nurbs { weights: Some(weights), .. },
                CurveError::Weight { .. }
                | CurveError::WeightCount { .. }
                | CurveError::BasisWeight { .. }
                | CurveError::NoWeight { .. },
            ) => &weights.place,
            (
                CurveKind::Power { denominator, .. },
                CurveError::Denominator { .. } | CurveError::Weight { .. },
            ) => &denominator.place,
            (
                CurveKind::Power { coefficients, denominator, .. },
                CurveError::Knots(KnotError::Degree { .. }),
            ) if denominator.value.len() > coefficients.value.len() => &denominator.place,
            (
                CurveKind::Power { coefficients, .. },
                CurveError::Knots(KnotError::Degree { .. }) | CurveError::Point { .. },
            ) => &coefficients.place,
            (CurveKind::Power { domain, .. }, CurveError::Knots(_)) => &domain.place,
            (
                CurveKind::MatrixForm { geometry, .. },
                CurveError::GeometryCount { .. } | CurveError::Point { .. },
            ) => &geometry.place,
            _ => &self.place,
        }
    }

    /// All steps of its transform.
    pub(in crate::scene) fn placed(&self) -> Result<DAffine3, CurveFault> {
        placed(&self.transform)
            .map_err(|(place, error)| CurveFault::Transform(place.clone(), error))
    }

    /// The basis and the control points, in their place, of a NURBS curve with zeros among its
    /// weights; other kinds of curves have none.
    pub(in crate::scene) fn weighted(&self) -> Result<(RationalBasis, Vec<DVec3>), CurveFault> {
        let blame = |error| CurveFault::Curve(self.culprit(&error).clone(), error);
        let CurveKind::Nurbs { degree, knots, points, weights: Some(weights) } = &self.kind else {
            return Err(blame(CurveError::WeightCount { weights: 0, points: self.point_count() }));
        };
        let weights = &weights.value;
        let mut vector = vector(degree, knots, points.len())?;
        if let Some(index) = points.iter().position(|point| !point.is_finite()) {
            return Err(blame(CurveError::Point { index, point: points[index] }));
        }
        check_weights(points, Some(weights)).map_err(blame)?;
        check_period(&knots.value, degree.value, points, Some(weights)).map_err(blame)?;
        let placed = self.placed()?;
        let [given, needed] = [points.len(), vector.point_count()].map(|count| [1, count]);
        let mut weights = wrapped(weights, given, needed);
        let mut points = wrapped(points, given, needed);
        points.iter_mut().for_each(|point| *point = placed.transform_point3(*point));
        if self.reverse {
            points.reverse();
            weights.reverse();
            vector = vector.reversed();
        }
        Ok((RationalBasis::new(vector, weights).map_err(blame)?, points))
    }
}

/// The knot vector of a curve of so many points.
fn vector(
    degree: &Written<usize>,
    knots: &Written<Knots>,
    points: usize,
) -> Result<KnotVector, CurveFault> {
    knot_vector(degree.value, &knots.value, points).map_err(|error| {
        let place = match error {
            KnotError::Degree { .. } => &degree.place,
            _ => &knots.place,
        };
        CurveFault::Curve(place.clone(), error.into())
    })
}

/// The first points of a closed curve must not be written again: see [`Knots::check_period`].
fn check_period(
    knots: &Knots,
    degree: usize,
    points: &[DVec3],
    weights: Option<&[f64]>,
) -> Result<(), CurveError> {
    let row = Grid { points, weights, size: [1, points.len()] };
    Ok(knots.check_period(&row, Direction::V, degree)?)
}

/// There must be a weight for each control point, before those of a closed curve are repeated.
fn check_weights(points: &[DVec3], weights: Option<&[f64]>) -> Result<(), CurveError> {
    match weights.map(<[f64]>::len) {
        Some(found) if found != points.len() => {
            Err(CurveError::WeightCount { weights: found, points: points.len() })
        }
        _ => Ok(()),
    }
}
