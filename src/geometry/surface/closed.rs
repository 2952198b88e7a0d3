//! Surfaces that close on themselves.

use super::{Direction, NurbsSurface};

/// The tolerance of the control points of a seam, in units of the rounding error of a point.
const SEAM: f64 = 4.0;

impl NurbsSurface {
    /// Whether the surface closes on itself in a direction: the curves at both ends of the
    /// domain have the same control points and, up to one common factor, the same weights, to
    /// within `16 (p + q + 4) u` of the largest coordinate, and are not single points.
    pub fn closes(&self, direction: Direction) -> bool {
        let clamped = self.clamped();
        let (nu, nv) = clamped.size();
        let pairs: Vec<[(usize, usize); 2]> = match direction {
            Direction::U => (0..nv).map(|j| [(0, j), (nu - 1, j)]).collect(),
            Direction::V => (0..nu).map(|i| [(i, 0), (i, nv - 1)]).collect(),
        };
        let [p, q] = [clamped.knots_u().degree(), clamped.knots_v().degree()];
        let factor = SEAM * crate::math::rounding::residual_factor(p, q);
        let point = |(i, j)| clamped.point(i, j);
        let magnitude =
            pairs.iter().flatten().map(|&at| point(at).abs().max_element()).fold(0.0, f64::max);
        let tolerance = factor * magnitude;
        let ratio =
            |[a, b]: [(usize, usize); 2]| clamped.weight(b.0, b.1) / clamped.weight(a.0, a.1);
        let same = |pair: &[(usize, usize); 2]| {
            (point(pair[0]) - point(pair[1])).abs().max_element() <= tolerance
                && (ratio(*pair) / ratio(pairs[0]) - 1.0).abs() <= factor
        };
        let first = point(pairs[0][0]);
        let extended =
            pairs.iter().any(|pair| (point(pair[0]) - first).abs().max_element() > tolerance);
        extended && pairs.iter().all(same)
    }
}
