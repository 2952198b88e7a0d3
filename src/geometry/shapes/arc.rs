//! Arcs of the unit circle of any angle, as chains of quadratic arcs.

use std::f64::consts::FRAC_1_SQRT_2;

use crate::geometry::KnotVector;
use crate::math::angle::sin_cos_degrees;

/// An arc of the unit circle as control points `(x, y, w)`, `x` and `y` not yet multiplied
/// by `w`, over knots of degree 2 on `[0, 1]`.
#[derive(Clone, Debug)]
pub(crate) struct UnitArc {
    pub(crate) knots: KnotVector,
    pub(crate) points: Vec<(f64, f64, f64)>,
}

/// The largest turn of a piece of an arc, in degrees: the weight of its middle point, the cosine of
/// half the angle, is then at least √½, and the arc stays near its control points.
const QUARTER: f64 = 90.0;

impl UnitArc {
    /// The arc from one angle by a turn, in degrees; clockwise if the turn is negative.
    ///
    /// Each of the `n` equal pieces has its ends on the circle, and in the middle the point where
    /// the tangents meet, weighted by the cosine of half the angle (Piegl & Tiller 1997, 7.3). Ends
    /// at multiples of 90° are exact, so that a full turn closes bit for bit.
    pub(crate) fn new(from: f64, turn: f64) -> Self {
        // A file may say 90.00000000000001, which must not add a piece.
        let pieces = (turn.abs() / QUARTER * (1.0 - f64::EPSILON)).ceil().max(1.0);
        let step = turn / pieces;
        let (tan, weight) = if step.abs() == QUARTER {
            (step.signum(), FRAC_1_SQRT_2)
        } else {
            let (sin, cos) = sin_cos_degrees(step / 2.0);
            (sin / cos, cos)
        };

        // Without its whole turns, which is exact: ends beyond them would be rounded as the large
        // numbers they are.
        let from = from % 360.0;
        let (sin, cos) = sin_cos_degrees(from);
        let (mut x, mut y) = (cos, sin);
        let mut points = vec![(x, y, 1.0)];
        let mut inner = Vec::new();
        for k in 1..=pieces as usize {
            points.push((x - tan * y, y + tan * x, weight));
            let share = k as f64 / pieces;
            (y, x) = sin_cos_degrees(from + turn * share);
            points.push((x, y, 1.0));
            inner.push(share);
        }
        inner.pop();
        Self { knots: arc_knots(&inner), points }
    }

    /// The full circle, counterclockwise from `(1, 0)`: four quarters, the corners of a
    /// square weighted by cos 45°.
    pub(crate) fn circle() -> Self {
        Self::new(0.0, 360.0)
    }
}

/// Knots of quadratic arcs that meet at these parameters of the unit interval.
pub(crate) fn arc_knots(inside: &[f64]) -> KnotVector {
    let mut values = vec![0.0; 3];
    values.extend(inside.iter().flat_map(|&t| [t, t]));
    values.extend([1.0; 3]);
    KnotVector::derived(2, values)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::NurbsCurve;
    use glam::DVec3;

    #[test]
    fn a_full_circle_is_a_square_with_its_middles() {
        let c = FRAC_1_SQRT_2;
        let points = UnitArc::circle().points;
        let expected = [(1.0, 0.0, 1.0), (1.0, 1.0, c), (0.0, 1.0, 1.0), (-1.0, 1.0, c)];
        assert_eq!(points[..4], expected);
        assert_eq!(points[8], points[0]);
    }

    #[test]
    fn arcs_of_any_angle_are_round_and_end_where_they_should() {
        for turn in [1e-6, 0.1, 45.0, 89.9, 90.0, 90.1, 123.4, 180.0, 270.0, 359.9, 360.0] {
            for (from, turn) in [(0.0, turn), (90.0, -turn), (-37.5, turn)] {
                let arc = UnitArc::new(from, turn);
                assert!(arc.points.iter().all(|point| point.2 >= FRAC_1_SQRT_2));
                let control = arc.points.iter().map(|&(x, y, w)| {
                    let point: DVec3 = w * DVec3::new(x, y, 0.0);
                    point.extend(w)
                });
                let curve = NurbsCurve::from_homogeneous(arc.knots, control.collect()).unwrap();
                let (sin, cos) = sin_cos_degrees(from + turn);
                assert_eq!(curve.point_at(1.0), DVec3::new(cos, sin, 0.0));
                for k in 0..=100 {
                    let point = curve.point_at(f64::from(k) / 100.0);
                    assert!((point.length() - 1.0).abs() < 1e-15, "{from}, {turn}: {k}: {point}");
                }
                // The middle of the parameters is the middle of the arc.
                let (sin, cos) = sin_cos_degrees(from + turn / 2.0);
                let off = curve.point_at(0.5).distance(DVec3::new(cos, sin, 0.0));
                assert!(off < 1e-15, "{from}, {turn}: {off:e}");
            }
        }
        assert_eq!(UnitArc::new(0.0, 180.0).points.len(), 5);
        // Whole turns do not count, as many as there may be: 1e16 is 280 more than some.
        let [far, near] = [1e16, 280.0].map(|from| UnitArc::new(from, 89.0).points);
        assert_eq!(far, near);
    }
}
