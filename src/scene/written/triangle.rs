//! Triangular patches as written, not yet checked.

use glam::DVec3;

use super::{Place, Written};
use crate::geometry::{TriangleError, TrianglePatch};

/// A triangular Bézier patch as written: numbers with their places, not yet known to be one.
#[derive(Clone, Debug, PartialEq)]
pub struct TriangleNet {
    /// The degree n.
    pub degree: Written<usize>,
    /// The `(n + 1)(n + 2)/2` control points in the order of [`TrianglePatch`], not multiplied
    /// by their weights.
    pub points: Written<Vec<Written<DVec3>>>,
    /// A weight for each control point; none for a polynomial patch.
    pub weights: Option<Written<Vec<Written<f64>>>>,
}

impl TriangleNet {
    /// Returns the patch that these numbers describe; if they describe none, why, and the place to
    /// blame.
    pub(in crate::scene) fn patch(&self) -> Result<TrianglePatch, (TriangleError, &Place)> {
        let points = self.points.value.iter().map(|point| point.value).collect();
        let weights = self.weights.as_ref();
        let weights = weights.map(|list| list.value.iter().map(|weight| weight.value).collect());
        TrianglePatch::new(self.degree.value, points, weights).map_err(|error| {
            let place = self.place(&error);
            (error, place)
        })
    }

    /// Where the number that an error names was written.
    fn place(&self, error: &TriangleError) -> &Place {
        let weights = self.weights.as_ref().map_or(&self.points.place, |list| &list.place);
        // Points are in the order i, then j: before those of i come i rows, one shorter each.
        let n = self.degree.value;
        let index = |[i, j, _]: [usize; 3]| i * (2 * n + 3 - i) / 2 + j;
        let nth = |exponents| self.points.value.get(index(exponents)).map(|point| &point.place);
        match error {
            TriangleError::Degree { .. } => &self.degree.place,
            TriangleError::WeightCount { .. } => weights,
            TriangleError::Weight { exponents, .. } => {
                let list = self.weights.as_ref();
                let weight = list.and_then(|list| list.value.get(index(*exponents)));
                weight.map_or(weights, |weight| &weight.place)
            }
            TriangleError::Point { exponents, .. } => nth(*exponents).unwrap_or(&self.points.place),
            _ => &self.points.place,
        }
    }
}
