//! The same curve in another place or with another parameter, and curves of straight pieces.

use glam::{DAffine3, DVec3, DVec4, Vec4Swizzles};

use super::{CurveError, NurbsCurve};
use crate::geometry::KnotVector;
use crate::geometry::affine::moved;
use crate::geometry::magnitude::is_usable;

/// Positions that differ by no more than this fraction of the largest coordinate are the same:
/// several rounding errors of each.
pub(crate) const SAME_PLACE: f64 = 16.0 * f64::EPSILON;

impl NurbsCurve {
    /// The curve moved by an affine map, which may flatten it.
    ///
    /// # Errors
    /// When the map is not finite or takes a control point to infinity.
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, CurveError> {
        if *map == DAffine3::IDENTITY {
            return Ok(self.clone()); // bit for bit
        }
        let control = self.control().iter().map(|point| moved(map, point)).collect();
        Self::from_homogeneous(self.knots().clone(), control)
    }

    /// The same curve on another domain, its parameter mapped linearly.
    ///
    /// # Errors
    /// When the domain is empty or not finite, or too short for the knots to stay apart.
    pub fn on_domain(&self, start: f64, end: f64) -> Result<Self, CurveError> {
        let knots = self.knots().on_domain(start, end)?;
        Ok(Self::assembled(knots, self.control().to_vec()))
    }

    /// The polygon through these points, of degree 1; its parameter is the arc length.
    ///
    /// # Errors
    /// When there are fewer than two points, one is not finite or too large, or two in a row
    /// coincide or are so close together that the arc length is the same to within rounding.
    pub fn polyline(points: &[DVec3]) -> Result<Self, CurveError> {
        if let Some(index) = points.iter().position(|&point| !is_usable(point)) {
            return Err(CurveError::Point { index, point: points[index] });
        }
        let mut knots = vec![0.0];
        let mut length = 0.0;
        for (index, pair) in points.windows(2).enumerate() {
            let before = length;
            length += pair[0].distance(pair[1]);
            if length == before {
                let [first, second] = [index, index + 1];
                if pair[0] == pair[1] {
                    return Err(CurveError::Coincide { first, second });
                }
                // The length of a very short vector is 0, as its square underflows.
                let distance = (pair[1] - pair[0]).abs().max_element();
                return Err(CurveError::TooClose { first, second, distance, length });
            }
            knots.push(length);
        }
        knots.insert(0, 0.0);
        knots.push(length);
        let knots = KnotVector::for_points(1, knots, points.len())?;
        Self::new(knots, points.to_vec(), None)
    }

    /// The Bézier curve of these control points, on `[0, 1]`.
    ///
    /// # Errors
    /// When there are fewer than two points or too many, or one is not finite.
    pub fn bezier(points: &[DVec3]) -> Result<Self, CurveError> {
        if points.len() < 2 {
            return Err(CurveError::TooFewPoints { found: points.len(), needed: 2 });
        }
        let knots = KnotVector::bezier(points.len() - 1)?;
        Self::new(knots, points.to_vec(), None)
    }

    /// The first and the last point of the curve.
    pub fn ends(&self) -> [DVec3; 2] {
        let [start, end] = self.domain();
        [self.point_at(start), self.point_at(end)]
    }

    /// Whether all control points coincide, to within a few roundings of their coordinates.
    pub fn is_point(&self) -> bool {
        let close = SAME_PLACE * self.magnitude();
        (1..self.control().len()).all(|index| self.vertex(index).distance(self.vertex(0)) <= close)
    }

    /// Whether the curve ends where it begins, up to [`SAME_PLACE`].
    pub(crate) fn is_closed(&self) -> bool {
        let [a, b] = self.clamped().ends();
        a.distance(b) <= SAME_PLACE * self.magnitude()
    }

    /// The Bézier pieces of the curve, each on its own part of the domain.
    pub(crate) fn bezier_pieces(&self) -> Vec<Self> {
        let form = self.bezier_form();
        let spans = form.knots().spans().map(|span| [span.start, span.end]);
        spans.collect::<Vec<_>>().into_iter().map(|range| form.restricted(range)).collect()
    }

    /// The largest coordinate magnitude of the control points, to which rounding errors are
    /// relative.
    pub(crate) fn magnitude(&self) -> f64 {
        let largest = |point: &DVec4| (point.xyz() / point.w).abs().max_element();
        self.control().iter().map(largest).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_domain_is_the_same_curve() {
        let knots = KnotVector::with_multiplicities(2, &[(-1.0, 3), (0.5, 2), (3.0, 3)]).unwrap();
        let points = (0..5).map(|k| DVec3::new(f64::from(k), f64::from(k * k), 1.0)).collect();
        let curve = NurbsCurve::new(knots, points, Some(vec![1.0, 2.0, 1.0, 0.5, 1.0])).unwrap();
        let moved = curve.on_domain(10.0, 11.0).unwrap();
        assert_eq!(moved.domain(), [10.0, 11.0]);
        assert_eq!(moved.knots().multiplicity(10.375), 2);
        for k in 0..=16 {
            let s = f64::from(k) / 16.0;
            let off = curve.point_at(-1.0 + 4.0 * s) - moved.point_at(10.0 + s);
            assert!(off.length() < 1e-13, "{s}: {off}");
        }
        assert_eq!(
            curve.on_domain(1.0, 1.0).unwrap_err().to_string(),
            "the knots -1 and 0.5 would become one on the domain from 1 to 1: it must be longer"
        );
        assert!(curve.on_domain(2.0, 1.0).is_err() && curve.on_domain(0.0, f64::NAN).is_err());
    }

    #[test]
    fn polygons_run_at_unit_speed() {
        let corners = [[0.0, 0.0, 0.0], [3.0, 4.0, 0.0], [3.0, 4.0, 2.0]].map(DVec3::from);
        let line = NurbsCurve::polyline(&corners).unwrap();
        assert_eq!(line.domain(), [0.0, 7.0]);
        assert_eq!(line.point_at(5.0), corners[1]);
        assert_eq!(line.point_at(6.0), DVec3::new(3.0, 4.0, 1.0));
        assert_eq!(
            NurbsCurve::polyline(&[corners[0], corners[0]]).unwrap_err().to_string(),
            "points 0 and 1 coincide: neighbours must differ"
        );
        assert!(NurbsCurve::polyline(&corners[..1]).is_err());
        assert!(NurbsCurve::polyline(&[DVec3::NAN, corners[0]]).is_err());
    }

    #[test]
    fn polygons_whose_points_are_too_far_away_or_too_close_together() {
        let message = |points: &[[f64; 3]]| {
            let points: Vec<DVec3> = points.iter().copied().map(DVec3::from).collect();
            NurbsCurve::polyline(&points).map(|_| ()).unwrap_err().to_string()
        };
        assert_eq!(
            message(&[[0.0; 3], [1e17, 0.0, 0.0], [1e17, 1.0, 0.0]]),
            "points 1 and 2 are too close together: they are 1 apart, less than the rounding error \
             of the length up to there, 1e17"
        );
        assert_eq!(
            message(&[[0.0; 3], [1e200, 0.0, 0.0]]),
            "control point 1 is (1e200, 0, 0): coordinates must be finite (up to 1e70)"
        );
        assert_eq!(
            message(&[[0.0; 3], [0.0, 1e-200, 0.0]]),
            "points 0 and 1 are too close together: they are 1e-200 apart, less than the rounding \
             error of the length up to there, 0"
        );
        let far = [[0.0; 3], [1e70, 0.0, 0.0]].map(DVec3::from);
        assert_eq!(NurbsCurve::polyline(&far).unwrap().ends(), far);
        let points = vec![DVec3::ZERO, DVec3::new(0.0, -1e71, 0.0)];
        for weights in [None, Some(vec![1.0, 1e-3])] {
            let knots = KnotVector::bezier(1).unwrap();
            let error = NurbsCurve::new(knots, points.clone(), weights).unwrap_err();
            assert_eq!(error, CurveError::Point { index: 1, point: points[1] });
        }
    }
}
