//! Curves as written: what surfaces are made from.

use glam::{DAffine3, DVec3};

use super::net::knot_vector;
use super::{Knots, Place, Transform, TransformError, Written};
use crate::geometry::shapes::circle_arc;
use crate::geometry::{CurveError, NurbsCurve};

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
        degree: usize,
        /// Its knots.
        knots: Written<Knots>,
        /// Its control points, not multiplied by their weights.
        points: Vec<DVec3>,
        /// A weight for each control point; none for a polynomial curve.
        weights: Option<Vec<f64>>,
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
    /// An arc of a circle around the origin in the plane `z = 0`.
    Arc {
        /// Its radius.
        radius: f64,
        /// Where it begins, in degrees from the x axis.
        from: f64,
        /// How far it turns, in degrees, counterclockwise.
        degrees: f64,
    },
}

/// Why a curve as written is none.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum CurveFault {
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
            | CurveKind::Through { points, .. } => points.len(),
            CurveKind::Arc { .. } => 0,
        }
    }

    /// The curve these numbers are, if they are one, in its place.
    pub(super) fn curve(&self) -> Result<NurbsCurve, CurveFault> {
        let blame = |error| CurveFault::Curve(self.place.clone(), error);
        let curve = match &self.kind {
            CurveKind::Nurbs { degree, knots, points, weights } => {
                let vector = knot_vector(*degree, &knots.value, points.len())
                    .map_err(|error| CurveFault::Curve(knots.place.clone(), error.into()))?;
                NurbsCurve::new(vector, points.clone(), weights.clone())
            }
            CurveKind::Polyline(points) => NurbsCurve::polyline(points),
            CurveKind::Bezier(points) => NurbsCurve::bezier(points),
            CurveKind::Through { points, degree } => NurbsCurve::through(points, *degree),
            CurveKind::Arc { radius, from, degrees } => circle_arc(*radius, *from, *degrees),
        }
        .map_err(blame)?;
        let mut placed = DAffine3::IDENTITY;
        for step in &self.transform {
            let affine = step.value.affine();
            placed = affine.map_err(|e| CurveFault::Transform(step.place.clone(), e))? * placed;
        }
        let curve = curve.transformed(&placed).map_err(blame)?;
        Ok(if self.reverse { curve.reversed() } else { curve })
    }
}
