//! Curves to plot.

use glam::DVec3;

use super::curve::CurveFault;
use super::{CurveSpec, PlotError, SceneError, SceneFault};
use crate::geometry::{KnotVector, NurbsCurve, RationalBasis};

/// A curve to plot, whose weights may be zero.
#[derive(Clone, Debug, PartialEq)]
pub enum PlottedCurve {
    /// A NURBS curve.
    Nurbs(NurbsCurve),
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
            Self::Nurbs(curve) => curve.knots(),
            Self::Weighted { basis, .. } => basis.knots(),
        }
    }

    /// The control points in space.
    pub fn points(&self) -> Vec<DVec3> {
        match self {
            Self::Nurbs(curve) => {
                (0..curve.control().len()).map(|index| curve.point(index)).collect()
            }
            Self::Weighted { points, .. } => points.clone(),
        }
    }

    /// The weights of the control points.
    pub fn weights(&self) -> Vec<f64> {
        match self {
            Self::Nurbs(curve) => curve.control().iter().map(|point| point.w).collect(),
            Self::Weighted { basis, .. } => basis.weights().to_vec(),
        }
    }

    /// The point at a parameter of the domain.
    pub fn point_at(&self, t: f64) -> DVec3 {
        match self {
            Self::Nurbs(curve) => curve.point_at(t),
            // There are as many points as weights: `None` does not occur.
            Self::Weighted { basis, points } => basis.point(points, t).unwrap_or(DVec3::NAN),
        }
    }

    /// The curve, if all its weights are positive.
    pub fn nurbs(&self) -> Option<&NurbsCurve> {
        match self {
            Self::Nurbs(curve) => Some(curve),
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
        self.curve().map(PlottedCurve::Nurbs).map_err(|fault| blame(plot, "curve", fault))
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
