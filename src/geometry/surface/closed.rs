//! Surfaces that close on themselves.

use super::NurbsSurface;
use crate::geometry::Direction;
use crate::math::Aabb;

/// The tolerance of the control points of a seam, in units of the rounding error of a point.
const ROUNDED: f64 = 4.0;

/// The same in units of the surface's size, and of weights. Text files have as few as eight digits,
/// models of single precision seven; in space, CAD systems take what is this close for one.
const WRITTEN: f64 = 1e-6;

impl NurbsSurface {
    /// Whether the surface closes on itself in a direction: the curves at both ends of the
    /// domain have the same control points and, up to one common factor, the same weights, and are
    /// not single points: to within 10⁻⁶ of the largest side of the control points' bounding box,
    /// or to within `16 (p + q + 4) u` of the largest coordinate.
    pub fn closes(&self, direction: Direction) -> bool {
        let clamped = self.clamped();
        let last = clamped.knots(direction).point_count() - 1;
        let along = 0..clamped.knots(direction.other()).point_count();
        let pairs: Vec<[(usize, usize); 2]> =
            along.map(|k| [0, last].map(|end| direction.pair(end, k).into())).collect();
        let [p, q] = [clamped.knots_u().degree(), clamped.knots_v().degree()];
        let rounded = ROUNDED * crate::math::rounding::residual_factor(p, q);
        let point = |(i, j)| clamped.point(i, j);
        let magnitude =
            pairs.iter().flatten().map(|&at| point(at).abs().max_element()).fold(0.0, f64::max);
        let (nu, nv) = clamped.size();
        let places = (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j)));
        let size = Aabb::around(places.map(point)).size();
        let ratio =
            |[a, b]: [(usize, usize); 2]| clamped.weight(b.0, b.1) / clamped.weight(a.0, a.1);
        let first = point(pairs[0][0]);
        let closes_within = |tolerance: f64, of_weights: f64| {
            let same = |pair: &[(usize, usize); 2]| {
                (point(pair[0]) - point(pair[1])).abs().max_element() <= tolerance
                    && (ratio(*pair) / ratio(pairs[0]) - 1.0).abs() <= of_weights
            };
            let is_away = |pair: &[(usize, usize); 2]| {
                (point(pair[0]) - first).abs().max_element() > tolerance
            };
            pairs.iter().any(is_away) && pairs.iter().all(same)
        };
        closes_within(rounded * magnitude, rounded)
            || closes_within(WRITTEN * size.max_element(), WRITTEN)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, DVec4};

    use super::*;
    use crate::geometry::shapes;

    /// The surface with coordinates rounded to multiples of `step`.
    fn written(surface: &NurbsSurface, step: f64) -> NurbsSurface {
        let rounded = |c: &DVec4| {
            let point: DVec3 = c.truncate() / c.w;
            (c.w * (point / step).round() * step).extend(c.w)
        };
        let net = surface.control().iter().map(rounded).collect();
        let [knots_u, knots_v] = [surface.knots_u(), surface.knots_v()].map(Clone::clone);
        NurbsSurface::from_homogeneous(knots_u, knots_v, net).unwrap()
    }

    /// The surface with the points of its last row in u moved.
    fn opened(surface: &NurbsSurface, by: f64) -> NurbsSurface {
        let (nu, nv) = surface.size();
        let moved = |(k, c): (usize, &DVec4)| {
            if k / nv + 1 == nu { *c + c.w * DVec3::splat(by).extend(0.0) } else { *c }
        };
        let net = surface.control().iter().enumerate().map(moved).collect();
        let [knots_u, knots_v] = [surface.knots_u(), surface.knots_v()].map(Clone::clone);
        NurbsSurface::from_homogeneous(knots_u, knots_v, net).unwrap()
    }

    #[test]
    fn seams_need_as_many_digits_as_files_have() {
        let cylinder = shapes::cylinder(40.0, 100.0).unwrap();
        assert!(cylinder.closes(Direction::U) && !cylinder.closes(Direction::V));
        for off in [1e-13, 1e-10, 1e-7, 9e-5] {
            assert!(opened(&cylinder, off).closes(Direction::U), "{off}");
            assert!(written(&opened(&cylinder, off), 1e-9).closes(Direction::U), "{off}");
        }
        for off in [1.1e-4, 1e-2] {
            assert!(!opened(&cylinder, off).closes(Direction::U), "{off}");
        }
        // Poles are no seams, whatever their size is.
        let sphere = shapes::sphere(1.0).unwrap();
        let closes = |sphere: &NurbsSurface| [Direction::U, Direction::V].map(|k| sphere.closes(k));
        assert_eq!(closes(&sphere), closes(&written(&sphere, 1e-9)));
    }
}
