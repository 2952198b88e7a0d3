//! What trims keep in the directions around a point.

use std::f64::consts::TAU;

use glam::DVec2;

use super::curve::euclidean;
use super::segment::Segment;
use super::{Kept, Trims, UvBox};
use crate::geometry::Direction;

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

    /// Whether the direction at an angle, which must not be that of an edge, leads into the kept
    /// part.
    pub(crate) fn keeps(&self, angle: f64) -> bool {
        let passed = self.edges.iter().filter(|&&edge| edge < angle).count();
        self.first == passed.is_multiple_of(2)
    }
}

impl Trims {
    /// The sectors that are kept around a point known only to within `reach`: curves within `reach`
    /// count as passing through the point.
    ///
    /// Returns `None` where this does not determine the sectors: both ends of a curve lie within
    /// `reach`, or different ends of several curves do, or several curves pass side by side.
    ///
    /// The direction of a curve is that of its tangent; at its end, the direction to the first
    /// control point away from it.
    pub(crate) fn around(&self, uv: DVec2, reach: DVec2) -> Option<Sectors> {
        self.around_within(uv, reach, 1.0)
    }

    /// [`Trims::around`], but of the curves' rounding errors only this part counts.
    pub(crate) fn around_within(&self, uv: DVec2, reach: DVec2, part: f64) -> Option<Sectors> {
        let mut met = Vec::new();
        let target = UvBox::about(uv, reach);
        self.tree.any(&target, |index| {
            let segment = &self.segments[index];
            if segment.seen_from(uv, part * segment.reach() + reach).0 {
                met.push(index);
            }
            false
        });

        // Curves that end near the point must all end at the same vertex, others pass it at the same
        // foot.
        let mut vertex = None;
        let mut foot: Option<(DVec2, DVec2)> = None;
        let mut edges = Vec::new();
        for &index in &met {
            let segment = &self.segments[index];
            let near = target.grown(part * segment.reach());
            match segment.ends().map(|end| near.holds(end)) {
                [true, true] => return None,
                [false, false] => {
                    let t = segment.level_with(uv);
                    let (along, here, rounding) =
                        (segment.tangent(t), segment.at(t), segment.reach());
                    let (there, other) = *foot.get_or_insert((here, rounding));
                    if (here - there).abs().cmpgt(rounding + other).any() {
                        return None;
                    }
                    edges.extend([angle(along, segment.rises()), angle(-along, false)]);
                }
                [at_start, _] => {
                    let end = usize::from(!at_start);
                    let place = segment.ends()[end];
                    if *vertex.get_or_insert(place) != place {
                        return None;
                    }
                    edges.push(angle(segment.direction_from(end), end == 0 && segment.rises()));
                }
            }
        }
        edges.sort_by(f64::total_cmp);

        // The half-open rule counts the crossings of a ray towards larger `u` that starts just
        // above the point. If it starts in the sector just after the angle 0, it crosses none of
        // the curves through the point. The point itself may lie on either side of them.
        let point = vertex.or(foot.map(|(foot, _)| foot)).unwrap_or(uv);
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

    /// The parameter at which the segment is level with a point, in the coordinate in which the
    /// segment is longer.
    fn level_with(&self, uv: DVec2) -> f64 {
        let [from, to] = self.ends();
        let size = (to - from).abs();
        let axis = if size.y > size.x { Direction::V } else { Direction::U };
        self.reaching(axis, uv[axis])
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{FRAC_PI_2, PI};

    use super::*;
    use crate::geometry::trim::{TrimDomain, TrimLoop};

    fn trims(kept: Kept, loops: &[TrimLoop]) -> Trims {
        Trims::new(TrimDomain::new([-4.0, 4.0], [-4.0, 4.0]).unwrap(), kept, loops).unwrap()
    }

    fn corners(points: &[(f64, f64)]) -> TrimLoop {
        let points: Vec<DVec2> = points.iter().map(|&(u, v)| DVec2::new(u, v)).collect();
        TrimLoop::polygon(&points).unwrap()
    }

    const REACH: DVec2 = DVec2::splat(1e-14);

    /// At each corner of polygons run in both directions, the sectors give the same answer for a
    /// direction as [`Trims::side_of`] for a point a little way off in that direction.
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
                        let nearby = trims.side_of(corner + 1e-6 * DVec2::from_angle(angle));
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
    fn beside_an_edge_the_sectors_are_those_of_the_edge() {
        let square = corners(&[(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)]);
        let trims = trims(Kept::Odd, &[square]);
        for out in [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y] {
            for beside in [-6e-15, 0.0, 6e-15] {
                let at = (1.0 + beside) * out + 0.3 * out.perp();
                let sectors = trims.around(at, REACH).unwrap();
                let towards = |direction: DVec2| (direction.to_angle() + TAU) % TAU;
                let [outwards, inwards] = [out, -out].map(|way| sectors.keeps(towards(way) + 0.1));
                assert!(inwards && !outwards, "{beside:e} beyond {out}: {sectors:?}");
            }
        }
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
