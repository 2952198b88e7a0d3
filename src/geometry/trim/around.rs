//! What trims keep in the directions around a point.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::DVec2;

use super::curve::euclidean;
use super::segment::Segment;
use super::{Kept, Trims, UvBox};
use crate::geometry::Direction;

/// Angles that differ by no more than this are equal to within rounding.
const LEAST_ANGLE: f64 = 1e-13;

/// The sectors into which trim curves cut the directions around a point.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Sectors {
    /// The angles at which curves leave the point, from the direction of growing `u` towards that
    /// of growing `v`: from 0 to a full turn, in order. The answers on the two sides of each angle
    /// differ.
    edges: Vec<f64>,
    /// Whether the sector just after the angle 0 is kept.
    first: bool,
}

impl Sectors {
    /// The angles of the edges, in radians, in order.
    pub(crate) fn edges(&self) -> &[f64] {
        &self.edges
    }

    /// Whether directions are kept that do not lead beyond the sides marked: of smaller u, of
    /// larger u, of smaller v, of larger v. A cusp between two curves counts, though it has no
    /// width.
    fn keeps_some(&self, [u0, u1, v0, v1]: [bool; 4]) -> bool {
        let Some(&start) = self.edges.first() else { return self.first };
        let next = self.edges.iter().copied().skip(1).chain([start + TAU]);
        let sectors = self.edges.iter().copied().zip(next).enumerate();
        let mut kept = sectors.filter(|(index, _)| self.first != index.is_multiple_of(2));
        kept.any(|(_, (from, to))| {
            // Two turns of quadrants: a sector may go on beyond the first turn.
            (0..8).any(|quadrant| {
                let [falls_u, falls_v] = [(1..3).contains(&(quadrant % 4)), quadrant % 4 > 1];
                let beyond = [u0 && falls_u, u1 && !falls_u, v0 && falls_v, v1 && !falls_v];
                let start = f64::from(quadrant) * FRAC_PI_2;
                let common = to.min(start + FRAC_PI_2) - from.max(start);
                let cusp = to - from <= LEAST_ANGLE && common >= 0.0;
                !beyond.contains(&true) && (common > LEAST_ANGLE || cusp)
            })
        })
    }

    /// Whether the direction at an angle, which must not be that of an edge, leads into the kept
    /// part.
    pub(crate) fn keeps(&self, angle: f64) -> bool {
        let passed = self.edges.iter().filter(|&&edge| edge < angle).count();
        self.first == passed.is_multiple_of(2)
    }
}

impl Trims {
    /// Whether nothing is kept around a point known only to within `reach`, though trim curves pass
    /// through it: it lies on a side that two holes share, or on the side of a hole along the
    /// domain's border. `false` where this is not known.
    pub(super) fn is_bare(&self, uv: DVec2, reach: DVec2) -> bool {
        let UvBox { min, max } = self.domain().bounds();
        let [low, high] = [(uv - min).cmple(reach), (max - uv).cmple(reach)];
        let [[u0, u1], [v0, v1]] = [Direction::U, Direction::V].map(|direction| {
            let axis = direction as usize;
            let ends = !self.domain().is_periodic(direction);
            [ends && low.test(axis), ends && high.test(axis)]
        });
        self.around(uv, reach).is_some_and(|sectors| !sectors.keeps_some([u0, u1, v0, v1]))
    }

    /// The sectors that are kept around a point known only to within `reach`: curves within `reach`
    /// count as passing through the point.
    ///
    /// Returns `None` where this does not determine the sectors: both ends of a curve lie within
    /// `reach`, or different ends of several curves do.
    ///
    /// The direction of a curve is that of its tangent; at its end, the direction to the first
    /// control point away from it.
    pub(crate) fn around(&self, uv: DVec2, reach: DVec2) -> Option<Sectors> {
        let mut met = Vec::new();
        let target = UvBox::about(uv, reach);
        self.tree.any(&target, |index| {
            let segment = &self.segments[index];
            if segment.seen_from(uv, segment.reach() + reach).0 {
                met.push(index);
            }
            false
        });

        // Curves that end near the point must all end at the same vertex.
        let mut vertex = None;
        let mut edges = Vec::new();
        for &index in &met {
            let segment = &self.segments[index];
            let near = target.grown(segment.reach());
            match segment.ends().map(|end| near.holds(end)) {
                [true, true] => return None,
                [false, false] => {
                    let along = segment.direction_near(uv);
                    edges.push((angle(along, segment.rises()), index));
                    edges.push((angle(-along, false), index));
                }
                [at_start, _] => {
                    let end = usize::from(!at_start);
                    let place = segment.ends()[end];
                    if *vertex.get_or_insert(place) != place {
                        return None;
                    }
                    let rises = end == 0 && segment.rises();
                    edges.push((angle(segment.direction_from(end), rises), index));
                }
            }
        }
        let edges = self.without_pairs(edges);

        // The half-open rule counts the crossings of a ray towards larger `u` that starts just
        // above the point. If it starts in the sector just after the angle 0, it crosses none of
        // the curves through the point.
        let point = vertex.unwrap_or(uv);
        let crossings = self.tree.crossings(point, &target, |index| {
            if met.contains(&index) {
                0
            } else {
                self.segments[index].seen_from(point, DVec2::ZERO).1
            }
        });
        let odd = crossings % 2 != 0;
        Some(Sectors { edges, first: odd == (self.kept == Kept::Odd) })
    }

    /// The angles at which segments leave a point, in order, without pairs of segments that run
    /// along each other: between these there is nothing. (Between two curves that touch there may
    /// be a cusp.)
    fn without_pairs(&self, mut edges: Vec<(f64, usize)>) -> Vec<f64> {
        edges.sort_by(|a, b| a.0.total_cmp(&b.0));
        let coincide = |a: &(f64, usize), b: &(f64, usize)| {
            let [one, other] = [a, b].map(|edge| &self.segments[edge.1]);
            let lines = one.is_straight() && other.is_straight();
            b.0 - a.0 <= LEAST_ANGLE && (lines || one.is_same_curve(other))
        };
        let mut left: Vec<(f64, usize)> = Vec::new();
        for edge in edges {
            match left.last() {
                Some(last) if coincide(last, &edge) => {
                    left.pop();
                }
                _ => left.push(edge),
            }
        }
        left.into_iter().map(|(angle, _)| angle).collect()
    }
}

/// The angle of a direction, from 0 to a full turn. A direction towards larger `u` along which the
/// curve does not rise counts as a full turn, not as 0.
fn angle(direction: DVec2, rises: bool) -> f64 {
    let angle = direction.to_angle();
    if angle < 0.0 || angle == 0.0 && !rises { angle + TAU } else { angle }
}

impl Segment {
    /// Whether `v` grows along the segment as stored.
    fn rises(&self) -> bool {
        let [from, to] = self.ends();
        from.y < to.y
    }

    /// The direction in which it leaves one of its ends, 0 or 1: towards the first control point
    /// that is away from it by more than rounding.
    fn direction_from(&self, end: usize) -> DVec2 {
        let from = self.ends()[end];
        let control: Vec<DVec2> = self.homogeneous().into_iter().map(euclidean).collect();
        let away = |point: &&DVec2| (**point - from).abs().cmpgt(2.0 * self.reach()).any();
        let first =
            if end == 0 { control.iter().find(away) } else { control.iter().rev().find(away) };
        first.map_or(self.ends()[1 - end] - from, |point| *point - from)
    }

    /// The tangent direction where the segment is level with a point, in the coordinate in which
    /// the segment is longer.
    fn direction_near(&self, uv: DVec2) -> DVec2 {
        let [from, to] = self.ends();
        let size = (to - from).abs();
        let axis = usize::from(size.y > size.x);
        self.tangent(self.reaching(axis, uv[axis]))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::geometry::trim::{TrimCurve, TrimDomain, TrimLoop};

    fn trims(kept: Kept, loops: &[TrimLoop]) -> Trims {
        Trims::new(TrimDomain::new([-4.0, 4.0], [-4.0, 4.0]).unwrap(), kept, loops).unwrap()
    }

    fn corners(points: &[(f64, f64)]) -> TrimLoop {
        let points: Vec<DVec2> = points.iter().map(|&(u, v)| DVec2::new(u, v)).collect();
        TrimLoop::polygon(&points).unwrap()
    }

    const REACH: DVec2 = DVec2::splat(1e-14);

    /// At each corner of polygons run in both directions, the sectors give the same answer for a
    /// direction as [`Trims::contains`] for a point a little way off in that direction.
    #[test]
    fn sectors_say_what_points_nearby_do() {
        let star: Vec<(f64, f64)> = (0..14)
            .map(|k| {
                let radius = [3.0, 1.0, 2.0][k % 3];
                let (v, u) = (0.3 + TAU * k as f64 / 14.0).sin_cos();
                (radius * u, radius * v)
            })
            .collect();
        let square = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
        let l_shape = [(0.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 2.0), (0.0, 2.0)];
        let mut asked = 0;
        for points in [&star[..], &square, &l_shape] {
            let there = corners(points);
            for (kept, one) in [
                (Kept::Odd, there.clone()),
                (Kept::Even, there.clone()),
                (Kept::Odd, there.reversed()),
            ] {
                let trims = trims(kept, &[one]);
                for &(u, v) in points {
                    let corner = DVec2::new(u, v);
                    let sectors = trims.around(corner, REACH).unwrap();
                    assert_eq!(sectors.edges().len(), 2, "{corner}");
                    for k in 0..64 {
                        let angle = TAU * (k as f64 + 0.5) / 64.0;
                        let nearby = trims.contains(corner + 1e-6 * DVec2::from_angle(angle));
                        let kept = nearby == super::super::Side::Inside;
                        assert_eq!(sectors.keeps(angle), kept, "{corner} {angle}");
                        asked += 1;
                    }
                }
            }
        }
        assert_eq!(asked, 3 * (14 + 4 + 6) * 64);
    }

    #[test]
    fn a_side_between_what_is_cut_off_is_no_edge() {
        use super::super::Side;
        let edge = |side| matches!(side, Side::Edge { .. });
        // Two holes with a common side, which one of them has only a part of.
        let left = corners(&[(-1.0, -1.0), (0.0, -1.0), (0.0, 1.0), (-1.0, 1.0)]);
        let right = corners(&[(0.0, -0.5), (1.0, -0.5), (1.0, 0.5), (0.0, 0.5)]);
        // A common side that is not along an axis, and one that is a curve.
        let slanted = corners(&[(-3.0, 0.0), (-2.0, 1.0), (-3.0, 1.0)]);
        let below = corners(&[(-3.0, 0.0), (-2.0, 0.0), (-2.0, 1.0)]);
        let arc = || TrimCurve::arc(DVec2::new(3.0, 0.0), 0.5, 0.0, PI).unwrap();
        let closed = |v: f64| {
            let back = [(2.5, 0.0), (2.5, v), (3.5, v), (3.5, 0.0)].map(DVec2::from);
            TrimLoop::new(&[arc(), TrimCurve::polyline(&back).unwrap()]).unwrap()
        };
        let loops = [left, right, slanted, below, closed(1.0), closed(-1.0)];
        let holes = trims(Kept::Even, &loops);
        let on_arc = DVec2::new(3.0, 0.0) + 0.5 * DVec2::from_angle(1.0);
        for at in [DVec2::ZERO, DVec2::new(0.0, 0.3), DVec2::new(-2.3, 0.7), on_arc] {
            assert_eq!(holes.contains_within(at, REACH), Side::Outside, "{at}");
            assert!(edge(trims(Kept::Even, &loops[..1]).contains(DVec2::ZERO)));
        }
        for at in [(0.0, 0.7), (0.0, 0.5), (0.0, 1.0), (1.0, 0.2), (-2.0, 1.0), (3.5, 0.0)] {
            assert!(edge(holes.contains_within(at.into(), REACH)), "{at:?}");
        }

        // Along the border, between the hole and nothing.
        let flush = corners(&[(-4.0, -4.0), (0.0, -4.0), (0.0, 4.0), (-4.0, 4.0)]);
        let half = trims(Kept::Even, std::slice::from_ref(&flush));
        for at in [(-4.0, 1.0), (-2.0, 4.0), (-2.0, -4.0), (-4.0, -4.0)] {
            assert_eq!(half.contains_within(at.into(), REACH), Side::Outside, "{at:?}");
        }
        assert!(edge(half.contains(DVec2::new(0.0, 4.0))) && edge(half.contains(DVec2::ZERO)));
        let other = trims(Kept::Odd, &[flush]);
        assert!(edge(other.contains(DVec2::new(-4.0, 1.0))));

        // Two circles that touch from within leave a cusp, which is not nothing.
        let circle = |u, radius| TrimLoop::circle(DVec2::new(u, 0.0), radius).unwrap();
        let crescent = trims(Kept::Odd, &[circle(0.0, 1.0), circle(0.5, 0.5)]);
        assert!(edge(crescent.contains(DVec2::X)));
    }

    #[test]
    fn an_edge_has_two_sides_and_two_loops_that_touch_have_four() {
        let circle = |u, radius| TrimLoop::circle(DVec2::new(u, 0.0), radius).unwrap();
        let one = trims(Kept::Odd, &[circle(0.0, 1.0)]);
        let at = DVec2::from_angle(0.7);
        let sectors = one.around(at, REACH).unwrap();
        let tangent = 0.7 + FRAC_PI_2;
        let expected = [tangent, tangent + PI];
        for (edge, expected) in sectors.edges().iter().zip(expected) {
            assert!((edge - expected).abs() < 1e-13, "{edge} {expected}");
        }
        assert!(sectors.keeps(0.7 + PI) && !sectors.keeps(0.7));

        // Where monotone segments of a circle end, and where two circles touch with a vertical
        // tangent.
        let sectors = one.around(DVec2::Y, REACH).unwrap();
        assert!(sectors.keeps(1.5 * PI) && !sectors.keeps(0.5 * PI), "{sectors:?}");
        let two = trims(Kept::Odd, &[circle(-1.0, 1.0), circle(1.0, 1.0)]);
        let sectors = two.around(DVec2::ZERO, REACH).unwrap();
        assert_eq!(sectors.edges().len(), 4, "{sectors:?}");
        assert!(sectors.keeps(0.1) && sectors.keeps(PI), "{sectors:?}");

        // Away from all curves.
        let inside = one.around(DVec2::ZERO, REACH).unwrap();
        assert!(inside.edges().is_empty() && inside.keeps(1.0));
    }

    #[test]
    fn what_is_too_small_to_be_seen_is_not_told() {
        let one = trims(Kept::Odd, &[TrimLoop::circle(DVec2::ZERO, 1e-9).unwrap()]);
        assert_eq!(one.around(DVec2::ZERO, DVec2::splat(1e-8)), None);
    }
}
