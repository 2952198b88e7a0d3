//! Surfaces that close on themselves.

use super::NurbsSurface;
use crate::geometry::Direction;
use crate::math::Aabb;

/// The tolerance of the control points of a seam, in units of the rounding error of a point.
const ROUNDED: f64 = 4.0;

/// The same in units of the surface's size, and of weights: text files may have no more than nine
/// digits. Sides of trim loops lie on a seam to within as much of the period:
/// [`SEAM_TOLERANCE`](crate::geometry::trim::SEAM_TOLERANCE).
const WRITTEN: f64 = 1e-8;

/// A surface that closes leaves its seam by more than this many such tolerances. A strip that is as
/// narrow as the tolerance has ends as near to each other, but goes nowhere.
const GOES_AROUND: f64 = 16.0;

impl NurbsSurface {
    /// Whether the surface closes on itself in a direction: the curves at both ends of the
    /// domain have the same control points and, up to one common factor, the same weights, and are
    /// not single points: to within `16 (p + q + 4) u` of the largest coordinate; or, if the
    /// surface leaves these curves by far more than that, to within 10⁻⁸ of the largest side of the
    /// control points' bounding box.
    pub fn closes(&self, direction: Direction) -> bool {
        let clamped = self.clamped();
        let last = clamped.knots(direction).point_count() - 1;
        let along = 0..clamped.knots(direction.other()).point_count();
        let pairs: Vec<[(usize, usize); 2]> =
            along.clone().map(|k| [0, last].map(|end| direction.pair(end, k).into())).collect();
        let [p, q] = [clamped.knots_u().degree(), clamped.knots_v().degree()];
        let rounded = ROUNDED * crate::math::rounding::residual_factor(p, q);
        let point = |(i, j)| clamped.vertex(i, j);
        let magnitude =
            pairs.iter().flatten().map(|&at| point(at).abs().max_element()).fold(0.0, f64::max);
        let [nu, nv] = clamped.size();
        let places = (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j)));
        let size = Aabb::around(places.map(point)).size();
        let ratio = |[a, b]: [(usize, usize); 2]| {
            clamped.homogeneous(b.0, b.1).w / clamped.homogeneous(a.0, a.1).w
        };
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
        let tolerance = WRITTEN * size.max_element();
        let is_far = |row: usize, k: usize| {
            let [start, here] = [0, row].map(|row| point(direction.pair(row, k).into()));
            (here - start).abs().max_element() > GOES_AROUND * tolerance
        };
        let goes_around = (1..last).any(|row| along.clone().any(|k| is_far(row, k)));
        closes_within(rounded * magnitude, rounded)
            || goes_around && closes_within(tolerance, WRITTEN)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec3, DVec4};

    use super::*;
    use crate::geometry::{KnotVector, shapes};

    /// The surface with coordinates rounded to multiples of `step`.
    fn written(surface: &NurbsSurface, step: f64) -> NurbsSurface {
        let rounded = |c: &DVec4| {
            let point: DVec3 = c.project();
            (c.w * (point / step).round() * step).extend(c.w)
        };
        let net = surface.control().iter().map(rounded).collect();
        let [knots_u, knots_v] = [surface.knots_u(), surface.knots_v()].map(Clone::clone);
        NurbsSurface::from_homogeneous(knots_u, knots_v, net).unwrap()
    }

    /// The surface with the points of its last row in u moved.
    fn opened(surface: &NurbsSurface, by: f64) -> NurbsSurface {
        let [nu, nv] = surface.size();
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
        for off in [1e-13, 1e-10, 1e-8, 9e-7] {
            assert!(opened(&cylinder, off).closes(Direction::U), "{off}");
            assert!(written(&opened(&cylinder, off), 1e-9).closes(Direction::U), "{off}");
        }
        for off in [1.1e-6, 1e-4, 1.0] {
            assert!(!opened(&cylinder, off).closes(Direction::U), "{off}");
        }
    }

    #[test]
    fn narrow_strips_and_single_points_do_not_close() {
        for width in [1.0, 1e-3] {
            let strip = shapes::plane(2e8 * width, width).unwrap();
            assert!(Direction::BOTH.iter().all(|&direction| !strip.closes(direction)), "{width}");
        }
        // Both ends of a spindle are one place, whose points differ by less than the tolerance.
        let knots = || KnotVector::bezier(2).unwrap();
        let ends = [0.0, 1e-9, 2e-9].map(|x| DVec3::new(x, 0.0, 0.0));
        let far = [-1.0, 0.0, 1.0].map(|x| DVec3::new(x, 5.0, 1.0));
        let net = [ends, far, ends].concat();
        let spindle = NurbsSurface::new(knots(), knots(), net, None).unwrap();
        let spindle = opened(&spindle, 1e-10);
        assert!(!spindle.closes(Direction::U));
    }
}
