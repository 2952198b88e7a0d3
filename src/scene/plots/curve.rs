//! Curves to plot.

use glam::DVec3;

use crate::geometry::{KnotVector, MatrixForm, NurbsCurve, RationalBasis};
use crate::scene::errors::{PlotError, SceneError, SceneFault};
use crate::scene::written::{CurveFault, CurveKind, CurveSpec};

/// What a Catmull–Rom or Hermite spline is made from.
#[derive(Clone, Debug, PartialEq)]
pub struct SplineData {
    /// Its points, in the order in which they were given.
    pub points: Vec<DVec3>,
    /// The derivatives at the points of a Hermite spline; none otherwise.
    pub derivatives: Vec<DVec3>,
    /// Whether it closes.
    pub closed: bool,
}

/// A curve to plot, whose weights may be zero.
#[derive(Clone, Debug, PartialEq)]
pub enum PlottedCurve {
    /// A NURBS curve.
    Nurbs(NurbsCurve),
    /// A Catmull–Rom or Hermite spline.
    Spline {
        /// The curve.
        curve: NurbsCurve,
        /// What it is made from.
        data: SplineData,
    },
    /// A curve that some control points have no influence on.
    Weighted {
        /// The basis with its weights.
        basis: RationalBasis,
        /// The control points.
        points: Vec<DVec3>,
    },
}

impl From<NurbsCurve> for PlottedCurve {
    fn from(curve: NurbsCurve) -> Self {
        Self::Nurbs(curve)
    }
}

impl PlottedCurve {
    /// The knots.
    pub fn knots(&self) -> &KnotVector {
        match self {
            Self::Nurbs(curve) | Self::Spline { curve, .. } => curve.knots(),
            Self::Weighted { basis, .. } => basis.knots(),
        }
    }

    /// The control points in space.
    pub fn points(&self) -> Vec<DVec3> {
        match self {
            Self::Nurbs(curve) | Self::Spline { curve, .. } => curve.points().collect(),
            Self::Weighted { points, .. } => points.clone(),
        }
    }

    /// The weights of the control points.
    pub fn weights(&self) -> Vec<f64> {
        match self {
            Self::Nurbs(curve) | Self::Spline { curve, .. } => {
                curve.control().iter().map(|point| point.w).collect()
            }
            Self::Weighted { basis, .. } => basis.weights().to_vec(),
        }
    }

    /// The point at a parameter of the domain.
    pub fn point_at(&self, t: f64) -> DVec3 {
        match self {
            Self::Nurbs(curve) | Self::Spline { curve, .. } => curve.point_at(t),
            // There are as many points as weights: `None` does not occur.
            Self::Weighted { basis, points } => basis.point(points, t).unwrap_or(DVec3::NAN),
        }
    }

    /// The curve, if all its weights are positive.
    pub fn nurbs(&self) -> Option<&NurbsCurve> {
        match self {
            Self::Nurbs(curve) | Self::Spline { curve, .. } => Some(curve),
            Self::Weighted { .. } => None,
        }
    }
}

impl CurveSpec {
    /// Returns the curve for a plot, which errors call `plot`.
    ///
    /// # Errors
    /// When its numbers do not make a curve.
    pub fn plotted(&self, plot: &str) -> Result<PlottedCurve, SceneError> {
        self.plotted_curve().map_err(|fault| blame(plot, "curve", fault))
    }

    /// The curve, with its data if it has no control points of its own.
    pub(super) fn plotted_curve(&self) -> Result<PlottedCurve, CurveFault> {
        let curve = self.curve()?;
        Ok(match self.data()? {
            Some(data) => PlottedCurve::Spline { curve, data },
            None => PlottedCurve::Nurbs(curve),
        })
    }

    /// What a Catmull–Rom or Hermite spline, or a segment in matrix form, is made from, in its
    /// place.
    fn data(&self) -> Result<Option<SplineData>, CurveFault> {
        let (points, derivatives, closed) = match &self.kind {
            CurveKind::CatmullRom { points, closed } => (&points[..], &[][..], *closed),
            CurveKind::Hermite { points, derivatives } => (&points[..], &derivatives[..], false),
            CurveKind::MatrixForm { form: MatrixForm::Hermite, geometry } => {
                let (points, derivatives) = geometry.value.split_at(geometry.value.len() / 2);
                (points, derivatives, false)
            }
            CurveKind::MatrixForm {
                form: MatrixForm::BSpline | MatrixForm::CatmullRom,
                geometry,
            } => (&geometry.value[..], &[][..], false),
            _ => return Ok(None),
        };
        let placed = self.placed()?;
        let points = points.iter().map(|&at| placed.transform_point3(at));
        let derivatives = derivatives.iter().map(|&along| placed.transform_vector3(along));
        let (points, derivatives) = (points.collect(), derivatives.collect());
        Ok(Some(SplineData { points, derivatives, closed }))
    }
}

/// The error about a curve of a plot.
pub(super) fn blame(plot: &str, which: &str, fault: CurveFault) -> SceneError {
    let (plot, which) = (plot.to_owned(), which.to_owned());
    let (place, error) = match fault {
        CurveFault::Curve(place, error) => (place, PlotError::Curve { which, error }),
        CurveFault::Transform(place, error) => (place, PlotError::Transform { which, error }),
    };
    SceneError::new(place, SceneFault::Plot { plot, error })
}
