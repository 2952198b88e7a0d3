//! Which way a ray goes through a vertex, where several faces meet that it meets from both sides.
//!
//! Around a vertex of a closed surface the faces are wedges of their tangent planes, one after another. Seen along
//! the ray each covers an angle, one way round if the ray enters through it and the other way if it leaves. All of them
//! together go around the ray as often as it goes through the surface: once, or not at all where it only touches
//! the vertex, in one of the two senses. So the sum of their angles, over a full turn, is 1 where the ray leaves, −1
//! where it enters, and 0 where it does neither, or both.
//!
//! Where the sum is anything else, not all faces of the vertex are there, as at the border of an open surface: then
//! nothing is said.

use std::f64::consts::{PI, TAU};

use glam::DVec3;

use super::crossings::{APART, LEAST_COSINE, at_one_place, is_tip, reach_along, touches};
use super::meeting::Meeting;
use crate::patch::Piece;

/// How far a sum of angles may be from a whole number of turns, in turns.
const MOST_TURNED: f64 = 1e-6;

/// Of meetings at vertices, by increasing `t`, drops those on the wrong side where a ray only enters, or only
/// leaves. `axis` is its direction.
pub(super) fn settle(meetings: &mut Vec<Meeting>, pieces: &[Piece], axis: DVec3) {
    let mut wrong = vec![false; meetings.len()];
    let mut seen = vec![false; meetings.len()];
    let reach = reach_along(meetings);
    for k in 0..meetings.len() {
        if seen[k] {
            continue;
        }
        let near = |&j: &usize| meetings[j].t - meetings[k].t <= reach;
        let here = |&j: &usize| j == k || at_one_place(&meetings[k], &meetings[j], pieces);
        let group: Vec<usize> = (k..meetings.len()).take_while(near).filter(here).collect();
        group.iter().for_each(|&j| seen[j] = true);
        let all = || group.iter().map(|&j| &meetings[j]);
        let both = all().any(|m| m.cosine > 0.0) && all().any(|m| m.cosine < 0.0);
        if both && all().all(|m| m.is_certain() && !touches(m) && !is_tip(m)) {
            let turns = turns(all(), pieces, axis);
            for &j in group.iter().filter(|_| (turns.abs() - 1.0).abs() <= MOST_TURNED) {
                wrong[j] = meetings[j].cosine * turns < 0.0;
            }
        }
    }
    let mut wrong = wrong.into_iter();
    meetings.retain(|_| !wrong.next().unwrap_or(false));
}

/// The sum of the angles that faces cover as seen along the ray, in turns.
fn turns<'m>(meetings: impl Iterator<Item = &'m Meeting>, pieces: &[Piece], axis: DVec3) -> f64 {
    let mut faces: Vec<(u32, [bool; 4])> = Vec::new();
    let mut sum = 0.0;
    for meeting in meetings {
        let piece = &pieces[meeting.piece as usize];
        // As far as two of such an error may be apart.
        let reach = 2.0 * APART * meeting.error / meeting.cosine.abs().max(LEAST_COSINE);
        let sides = piece.side_distances(meeting.st, &meeting.jet).map(|off| off <= reach);
        // Leaves of one piece may see the same corner.
        let face = (meeting.piece, sides);
        if !faces.contains(&face) {
            faces.push(face);
            sum += angle(sides, meeting, axis).copysign(meeting.cosine);
        }
    }
    sum / TAU
}

/// The angle that a face covers around a place of its piece, at some of its sides, as seen along the ray.
fn angle([s0, s1, t0, t1]: [bool; 4], meeting: &Meeting, axis: DVec3) -> f64 {
    match (s0 || s1, t0 || t1) {
        (false, false) => TAU,
        (true, true) => {
            let inwards = |end: bool, along: DVec3| if end { -along } else { along };
            let across = |v: DVec3| v.reject_from_normalized(axis);
            let [a, b] = [inwards(s1, meeting.jet.ds), inwards(t1, meeting.jet.dt)].map(across);
            a.angle_between(b)
        }
        _ => PI,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::intersect::{Query, SurfaceBvh};
    use crate::math::Ray;

    /// A square ring as one bilinear spline: its hole 2 wide, 4 wide in all, 1 high.
    fn ring() -> SurfaceBvh {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)];
        let profile = [(2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 0.0), (2.0, 0.0)];
        let at = |(x, y): (f64, f64)| profile.map(|(r, z)| DVec3::new(r * x, r * y, z));
        let points = corners.map(at).concat();
        let knots = || KnotVector::clamped_uniform(1, 5).unwrap();
        let surface = NurbsSurface::new(knots(), knots(), points, None).unwrap();
        SurfaceBvh::build(&[surface]).unwrap()
    }

    fn signs(from: [f64; 3], direction: [f64; 3]) -> Vec<f64> {
        let ray = Ray::new(from.into(), direction.into()).unwrap();
        let mut hits = Vec::new();
        let doubtful = ring().tracer().all_hits(&Query::primary(ray), &mut hits);
        assert!(!doubtful, "{hits:?}");
        hits.iter().map(|hit| hit.normal.dot(ray.direction()).signum()).collect()
    }

    #[test]
    fn a_ray_enters_through_a_vertex_that_it_meets_from_both_sides() {
        // Through (1, 1, 1), an inner corner: past the wall of the hole, into the solid.
        assert_eq!(signs([0.0, 1.25, 2.0], [1.0, -0.25, -1.0]), [-1.0, 1.0]);
        assert_eq!(signs([3.0, 0.5, -1.0], [-1.0, 0.25, 1.0]), [-1.0, 1.0]);
    }

    #[test]
    fn a_ray_that_touches_a_vertex_does_both_or_neither() {
        // Over (2, 2, 1), an outer corner.
        let touch = signs([1.0, 3.0, 1.5], [1.0, -1.0, -0.5]);
        assert_eq!(touch.iter().sum::<f64>(), 0.0, "{touch:?}");
        let plain = signs([1.5, 0.1, 3.0], [0.0, 0.0, -1.0]);
        assert_eq!(plain, [-1.0, 1.0]);
    }
}
