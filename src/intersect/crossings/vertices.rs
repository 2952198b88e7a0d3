//! Which way a ray goes through a vertex at which it meets several faces from both sides.
//!
//! Around a vertex of a closed surface the faces are wedges of their tangent planes, one after
//! another, or parts of cones about the vertex. Seen along the ray, each face covers an angle: one
//! way round if the ray enters through it, the other way if it leaves. Together they go around the
//! ray as often as it goes through the surface: once, in one of the two senses, or not at all where
//! it only touches the vertex. So the sum of their angles, over a full turn, is 1 where the ray
//! leaves, −1 where it enters, and 0 where it does neither, or both.
//!
//! Where the sum is anything else, not all faces of the vertex are met, as at the border of an open
//! surface, or by a ray that passes within rounding: then the meetings are doubtful.

use std::f64::consts::TAU;

use super::faces::{EdgeReach, Face};
use super::same_place::{Sight, at_one_place, reach_along};
use super::sense::{has_no_normal, may_touch};
use crate::intersect::HitFlags;
use crate::intersect::roots::meeting::Meeting;

/// How far a sum of angles may be from a whole number of turns, in turns: far more than the
/// rounding error if no face is met at a cosine below 1e-8, and less than a missing face would
/// cover, unless that is next to nothing.
pub(super) const MOST_TURNED: f64 = 1e-6;

/// Drops meetings at vertices that are on the wrong side where the ray only enters, or only leaves;
/// where this cannot be decided, they become doubtful. An apex has all sides: it takes that of the
/// ray or, where it is touched, both. `meetings` are sorted by increasing `t`.
pub(super) fn settle(meetings: &mut Vec<Meeting>, sight: Sight<'_>) {
    // Meetings are flagged and dropped at the end: what is at one place depends on flags.
    let mut fates = vec![Fate::default(); meetings.len()];
    let mut others = Vec::new();
    let reach = reach_along(meetings);
    for k in 0..meetings.len() {
        if fates[k].is_seen {
            continue;
        }
        let group = Group::at_place_of(k, meetings, reach, &fates, sight);
        for &j in &group.members {
            fates[j].is_seen = true;
        }
        match group.way(meetings, sight) {
            Way::Any => {}
            Way::Through { sign, apex } => {
                if let Some(apex) = apex {
                    meetings[apex].cosine = meetings[apex].cosine.abs().copysign(sign);
                }
                let is_wrong = |j: usize| meetings[j].cosine * sign < 0.0;
                let members = group.members.iter();
                // Dropped meetings leave their doubt to the others.
                let in_doubt = members.clone().any(|&j| is_wrong(j) && !meetings[j].is_certain());
                for &j in members {
                    fates[j].is_wrong = is_wrong(j);
                    fates[j].is_doubtful |= in_doubt;
                }
                // The angles have told on which side of all edges the ray passes.
                for &j in &group.members {
                    if let Some(curve) = &mut meetings[j].trim_curve {
                        curve.on_either_side = false;
                    }
                }
            }
            Way::Touching { apex } => {
                others.push(Meeting { cosine: -meetings[apex].cosine, ..meetings[apex] });
            }
            Way::Unknown => group.members.iter().for_each(|&j| fates[j].is_doubtful = true),
        }
    }
    for (meeting, _) in meetings.iter_mut().zip(&fates).filter(|(_, fate)| fate.is_doubtful) {
        meeting.flags.insert(HitFlags::DOUBTFUL);
    }
    let mut fates = fates.iter();
    meetings.retain(|_| fates.next().is_some_and(|fate| !fate.is_wrong));
    meetings.extend(others);
    meetings.sort_by(|a, b| a.t.total_cmp(&b.t));
}

/// What becomes of a meeting.
#[derive(Clone, Copy, Default)]
struct Fate {
    /// Whether it belongs to a group that has been looked at.
    is_seen: bool,
    /// Whether it is on the wrong side of its vertex.
    is_wrong: bool,
    is_doubtful: bool,
}

/// Meetings at the place of one of them.
struct Group {
    members: Vec<usize>,
    /// Whether one of them is also at the place of a meeting of another group: which belong
    /// together is then not known.
    overlaps: bool,
}

/// How a ray goes through the surfaces at the place of a group.
enum Way {
    /// As each of its meetings says.
    Any,
    /// Once, with this sign of `N · d`; through an apex, if there is one.
    Through {
        sign: f64,
        apex: Option<usize>,
    },
    /// Not at all: it touches an apex, which is met from one side only.
    Touching {
        apex: usize,
    },
    Unknown,
}

impl Group {
    /// The meetings from `k` on that are at its place; none is farther than `reach` along the ray.
    fn at_place_of(
        k: usize,
        meetings: &[Meeting],
        reach: f64,
        fates: &[Fate],
        sight: Sight<'_>,
    ) -> Self {
        let together = |a: usize, b: usize| at_one_place(&meetings[a], &meetings[b], sight);
        let near = |&j: &usize| meetings[j].t - meetings[k].t <= reach;
        let here = |&j: &usize| j == k || together(k, j);
        let members: Vec<usize> = (k..meetings.len()).take_while(near).filter(here).collect();
        let before = (0..k).rev().take_while(|&j| meetings[k].t - meetings[j].t <= reach);
        let mut before = before.filter(|&j| fates[j].is_seen);
        let overlaps = members.iter().any(|&j| fates[j].is_seen) || before.any(|j| together(j, k));
        Self { members, overlaps }
    }

    fn way(&self, meetings: &[Meeting], sight: Sight<'_>) -> Way {
        let all = || self.members.iter().map(|&j| &meetings[j]);
        if all().any(|m| may_touch(m) || has_no_normal(m)) {
            return Way::Any;
        }
        let both = all().any(|m| m.cosine > 0.0) && all().any(|m| m.cosine < 0.0);
        let at_apex = |m: &Meeting| sight.pieces[m.piece as usize].is_apex(m.jet.point);
        let apex = self.members.iter().copied().find(|&j| at_apex(&meetings[j]));
        if !both && apex.is_none() {
            // Where a surface overlaps itself, a ray may go through it twice at one place.
            let twice = || matches!(AtVertex::of(all(), sight), AtVertex::ThroughMore);
            return if self.members.len() > 2 && twice() { Way::Unknown } else { Way::Any };
        }
        if self.overlaps {
            return Way::Unknown;
        }
        match (AtVertex::of(all(), sight), apex) {
            (AtVertex::Through(sign), apex) => Way::Through { sign, apex },
            (AtVertex::Touching, Some(apex)) if !both => Way::Touching { apex },
            (AtVertex::Touching, _) => Way::Any,
            (AtVertex::ThroughMore | AtVertex::Unknown, _) => Way::Unknown,
        }
    }
}

/// How a ray passes a vertex.
pub(super) enum AtVertex {
    /// The ray enters if the number is negative, and leaves if it is positive.
    Through(f64),
    /// It enters, or leaves, more than once.
    ThroughMore,
    Touching,
    /// Not all faces are met there, or the angle that one of them covers is not known.
    Unknown,
}

impl AtVertex {
    /// How a ray passes the faces that it meets at one place.
    pub(super) fn of<'m>(meetings: impl Iterator<Item = &'m Meeting>, sight: Sight<'_>) -> Self {
        let mut faces: Vec<(&Meeting, [bool; 4])> = Vec::new();
        let mut sum = 0.0;
        for meeting in meetings {
            let face = Face::new(meeting, EdgeReach::Met, sight);
            // Leaves of one piece may see the same corner; and a piece may meet itself.
            let sides = face.sides();
            let is_known = faces.iter().any(|&(known, its)| {
                known.piece == meeting.piece && its == sides && face.holds(known.st)
            });
            if is_known {
                continue;
            }
            faces.push((meeting, sides));
            let Some(angle) = face.angle() else { return Self::Unknown };
            sum += angle / TAU;
        }
        let whole = sum.round();
        let is_whole = (sum - whole).abs() <= MOST_TURNED;
        match whole.abs() {
            0.0 if is_whole => Self::Touching,
            1.0 if is_whole => Self::Through(whole),
            _ if is_whole => Self::ThroughMore,
            _ => Self::Unknown,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
    use crate::geometry::{KnotVector, NurbsSurface, TrimmedSurface, shapes};
    use crate::intersect::{Query, SurfaceBvh};
    use crate::math::{Ray, SplitMix};

    /// A square ring as one bilinear spline: its hole 2 wide, 4 wide in all, 1 high.
    fn ring() -> SurfaceBvh {
        ring_over(1.0)
    }

    /// The same with parameters that are as much longer in u as they are shorter in v.
    fn ring_over(length: f64) -> SurfaceBvh {
        let corners = [(1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0), (1.0, -1.0), (1.0, 1.0)];
        let profile = [(2.0, 0.0), (2.0, 1.0), (1.0, 1.0), (1.0, 0.0), (2.0, 0.0)];
        let at = |(x, y): (f64, f64)| profile.map(|(r, z)| DVec3::new(r * x, r * y, z));
        let points = corners.map(at).concat();
        let knots = |length: f64| {
            let knots = [0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0].map(|knot| length * knot);
            KnotVector::new(1, knots.to_vec()).unwrap()
        };
        let (knots_u, knots_v) = (knots(length), knots(1.0 / length));
        let surface = NurbsSurface::new(knots_u, knots_v, points, None).unwrap();
        SurfaceBvh::build(&[surface]).unwrap()
    }

    fn signs(from: [f64; 3], direction: [f64; 3]) -> Vec<f64> {
        let (signs, doubtful) = crossings(&ring(), from, direction);
        assert!(!doubtful, "{signs:?}");
        signs
    }

    /// The signs of the crossings, NaN where there is no normal, and whether there is doubt.
    fn crossings(bvh: &SurfaceBvh, from: [f64; 3], direction: [f64; 3]) -> (Vec<f64>, bool) {
        let ray = Ray::new(from.into(), direction.into()).unwrap();
        let mut hits = Vec::new();
        let doubtful = bvh.tracer().all_hits(&Query::primary(ray), &mut hits);
        (hits.iter().map(|hit| hit.normal.dot(ray.direction()).signum()).collect(), doubtful)
    }

    /// A bilinear cone over a star of this many spikes, or a square, with its base; the apex is at
    /// (0, 0, 1).
    fn spiked(radii: &[f64]) -> SurfaceBvh {
        let corner = |k: usize| {
            let (y, x) = (TAU * (k % radii.len()) as f64 / radii.len() as f64).sin_cos();
            radii[k % radii.len()] * DVec3::new(x, y, 0.0)
        };
        let knots = |n| KnotVector::clamped_uniform(1, n).unwrap();
        let made = |net: Vec<DVec3>| {
            NurbsSurface::new(knots(radii.len() + 1), knots(2), net, None).unwrap()
        };
        let around = || (0..=radii.len()).map(corner);
        let side = made(around().flat_map(|p| [p, DVec3::Z]).collect());
        let base = made(around().flat_map(|p| [DVec3::ZERO, p]).collect());
        SurfaceBvh::build(&[side, base]).unwrap()
    }

    #[test]
    fn a_ray_enters_through_a_vertex_that_it_meets_from_both_sides() {
        // Through (1, 1, 1), an inner corner: past the wall of the hole, into the solid.
        assert_eq!(signs([0.0, 1.25, 2.0], [1.0, -0.25, -1.0]), [-1.0, 1.0]);
        assert_eq!(signs([3.0, 0.5, -1.0], [-1.0, 0.25, 1.0]), [-1.0, 1.0]);
    }

    #[test]
    fn how_long_parameters_are_does_not_matter_at_a_vertex() {
        for length in [1.0, 2f64.powi(-17), 2f64.powi(20), 2f64.powi(60)] {
            let ring = ring_over(length);
            let mut doubted = 0;
            for n in 0..343 {
                let whole = |n: i32| f64::from(n % 7 - 3);
                let direction = DVec3::new(whole(n), whole(n / 7), whole(n / 49));
                if !direction.to_array().contains(&0.0) {
                    let what = format!("parameters of {length}");
                    doubted += u32::from(check_parity(&ring, DVec3::ONE, direction, &what));
                }
            }
            assert_eq!(doubted, 0, "parameters of {length}");
        }
    }

    #[test]
    fn a_ray_that_touches_a_vertex_does_both_or_neither() {
        // Over (2, 2, 1), an outer corner.
        let touch = signs([1.0, 3.0, 1.5], [1.0, -1.0, -0.5]);
        assert_eq!(touch.iter().sum::<f64>(), 0.0, "{touch:?}");
        let plain = signs([1.5, 0.1, 3.0], [0.0, 0.0, -1.0]);
        assert_eq!(plain, [-1.0, 1.0]);
    }

    /// Two patches over and under a plane that share two of their sides; the others are apexes.
    fn lens() -> SurfaceBvh {
        let side = [[-1.0, 0.0, 0.0], [-0.4, -0.5, 0.0], [0.3, -0.6, 0.1], [1.0, 0.0, 0.0]];
        let side = side.map(DVec3::from_array);
        let other = side.map(|p| p * DVec3::new(1.0, -1.0, 1.0));
        let knots = |degree| KnotVector::bezier(degree).unwrap();
        let half = |up: f64| {
            let middle = [(-0.3, 0.8), (0.3, 0.9)].map(|(x, z)| DVec3::new(x, 0.0, up * z));
            let middle = [side[0], middle[0], middle[1], side[3]];
            let rows = if up < 0.0 { [side, middle, other] } else { [other, middle, side] };
            NurbsSurface::new(knots(2), knots(3), rows.concat(), None).unwrap()
        };
        SurfaceBvh::build(&[half(1.0), half(-1.0)]).unwrap()
    }

    #[test]
    fn rays_that_nearly_touch_the_surface_around_an_apex_leave_it_or_are_in_doubt() {
        let lens = lens();
        let mut random = SplitMix::new(5);
        let mut unit = |size: f64| size * (2.0 * random.unit() - 1.0);
        let patch = lens.patches().pieces()[0].patch.clone();
        let [mut doubted, mut odd] = [0; 2];
        for k in 0..6000 {
            let near = patch.point(DVec2::new(0.5 + 0.5 * unit(1.0), 1.0 - 1e-9));
            let along = (near - DVec3::X).normalize() * if k % 2 == 0 { 1.0 } else { -1.0 };
            let off = [0.0, 1e-12, 1e-9, 1e-6, 1e-4, 1e-3][k / 1000];
            let direction = along + DVec3::new(unit(off), unit(off), unit(off));
            let origin = DVec3::X - (2.0 + unit(1.0)) * direction;
            let (signs, doubtful) = crossings(&lens, origin.into(), direction.into());
            doubted += usize::from(doubtful);
            odd += usize::from(!doubtful && signs.len() % 2 != 0);
        }
        assert_eq!(odd, 0, "{doubted} in doubt");
        assert!(doubted < 5000, "{doubted}");
    }

    #[test]
    fn an_apex_is_one_crossing_of_what_goes_through_it_and_two_of_what_touches_it() {
        let star = spiked(&[1.0, 0.3, 1.0, 0.3, 1.0, 0.3, 1.0, 0.3]);
        let pyramid = spiked(&[1.0; 4]);
        // A ray that goes half round the axis with a quarter of a cone.
        let tall = {
            let side = shapes::cone(1.0, 2.0).unwrap();
            SurfaceBvh::build(&[side, shapes::disk(1.0).unwrap().reversed_u()]).unwrap()
        };
        for direction in [DVec3::new(1.0, 1.0, -4.0), DVec3::new(-1.0, 1.0, -4.0)] {
            let (signs, doubtful) =
                crossings(&tall, (2.0 * DVec3::Z - direction).into(), direction.into());
            assert!(!doubtful && signs.len() == 2, "{direction}: {signs:?}");
        }
        let cone = {
            let side = shapes::cone(1.0, 1.0).unwrap();
            let base = shapes::disk(1.0).unwrap().reversed_u();
            SurfaceBvh::build(&[side, base]).unwrap()
        };
        for (name, bvh) in [("star", &star), ("pyramid", &pyramid), ("cone", &cone)] {
            let (mut touched, mut doubted) = (0, 0);
            for k in 0..500 {
                // Through the apex, at all angles; base and apex are met at places that are known
                // exactly.
                let (turn, tilt) = (0.37 * k as f64, 0.003 * k as f64);
                let direction =
                    DVec3::new(tilt.sin() * turn.cos(), tilt.sin() * turn.sin(), -tilt.cos());
                let (signs, doubtful) =
                    crossings(bvh, (DVec3::Z - 2.0 * direction).into(), direction.into());
                assert!(doubtful || signs.len() == 2, "{name} {k}: {signs:?}");
                doubted += usize::from(doubtful);
                touched += usize::from(signs.iter().all(|sign| sign.is_nan()));
            }
            assert!(touched > 50 && doubted < 20, "{name}: {touched} {doubted}");
        }
    }

    /// A cube of six planes, each trimmed to a square.
    fn trimmed_cube() -> SurfaceBvh {
        let knots = || KnotVector::new(1, vec![-1.0, -1.0, 2.0, 2.0]).unwrap();
        let side = |origin: DVec3, u: DVec3, v: DVec3| {
            let point = |(s, t): (f64, f64)| origin + s * u + t * v;
            let net = [(-1.0, -1.0), (-1.0, 2.0), (2.0, -1.0), (2.0, 2.0)].map(point).to_vec();
            let plane = NurbsSurface::new(knots(), knots(), net, None).unwrap();
            let square = TrimLoop::rectangle(UvBox::new([0.0, 1.0], [0.0, 1.0])).unwrap();
            let domain = TrimDomain::of(&plane).unwrap();
            let trims = Trims::new(domain, Kept::Odd, &[square]).unwrap();
            TrimmedSurface::new(plane, trims).unwrap()
        };
        let (o, x, y, z) = (DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z);
        let sides = [(o, y, x), (z, x, y), (o, x, z), (y, z, x), (o, z, y), (x, y, z)];
        SurfaceBvh::build(&sides.map(|(origin, u, v)| side(origin, u, v))).unwrap()
    }

    #[test]
    fn corners_of_trims_are_gone_through_or_touched() {
        let cube = trimmed_cube();
        let mut touched = 0;
        for k in 0..8 {
            let corner = DVec3::new((k & 1) as f64, (k >> 1 & 1) as f64, (k >> 2) as f64);
            for n in 0..343 {
                let whole = |n: i32| f64::from(n % 7 - 3);
                let direction = DVec3::new(whole(n), whole(n / 7), whole(n / 49));
                // Rays in the plane of a face are left out: they may run inside the surface.
                if direction.to_array().contains(&0.0) {
                    continue;
                }
                let (signs, doubtful) =
                    crossings(&cube, (corner - 8.0 * direction).into(), direction.into());
                assert!(!doubtful && signs.len() == 2, "{corner} {direction}: {signs:?}");
                assert_eq!(signs.iter().sum::<f64>(), 0.0, "{corner} {direction}");
                let outwards = direction * (corner - 0.5);
                touched += usize::from(outwards.min_element() * outwards.max_element() < 0.0);
            }
        }
        assert_eq!(touched, 8 * 216 * 6 / 8);
    }

    /// Checks that the signs cancel or there is doubt; returns whether there is.
    #[must_use]
    fn check_parity(bvh: &SurfaceBvh, through: DVec3, direction: DVec3, what: &str) -> bool {
        let ray = Ray::with_range(through, direction, f64::NEG_INFINITY, f64::INFINITY).unwrap();
        let mut hits = Vec::new();
        let doubtful = bvh.tracer().all_hits(&Query::primary(ray), &mut hits);
        // An apex stands for the sign that the others lack.
        let apexes = hits.iter().filter(|hit| hit.normal.is_nan()).count();
        let steep = hits.iter().filter(|hit| !hit.normal.is_nan());
        let sum: f64 = steep.map(|hit| hit.normal.dot(ray.direction()).signum()).sum();
        let even = hits.len() % 2 == 0 && sum.abs() <= apexes as f64;
        assert!(doubtful || even, "{what}: through {through} along {direction}: {hits:?}");
        doubtful
    }

    #[test]
    fn rays_beside_the_side_of_a_cone_are_through_its_apex_or_touch_it() {
        let cone = |side: NurbsSurface| {
            SurfaceBvh::build(&[side, shapes::disk(1.0).unwrap().reversed_u()]).unwrap()
        };
        let exact = cone(shapes::cone(1.0, 1.0).unwrap());
        let mut doubted = 0;
        for k in 2..=12 {
            for turn in 0..60 {
                for side in [-1.0, 1.0] {
                    let base = DVec3::from((DVec2::from_angle(0.11 * f64::from(turn)), 0.0));
                    let base = (1.0 + side * 10f64.powi(-k)) * base;
                    let what = format!("10^-{k}, turn {turn}");
                    let is_doubtful = check_parity(&exact, DVec3::Z, base - DVec3::Z, &what);
                    doubted += u32::from(is_doubtful && k < 6);
                }
            }
        }
        assert!(doubted < 120, "{doubted} of 480");
    }

    #[test]
    fn corners_with_one_tangent_are_no_more_than_half_a_turn() {
        // A disk of nine points, at four of which its border is smooth.
        let half = std::f64::consts::FRAC_1_SQRT_2;
        let disk = |z: f64| {
            let knots = || KnotVector::bezier(2).unwrap();
            let steps = [-1.0, 0.0, 1.0];
            // The middles of the sides are where tangents of the corners meet.
            let out = |x: f64, y: f64| if x * y == 0.0 { 2.0 * half } else { half };
            let at = |x: f64| steps.map(|y| DVec3::new(x * out(x, y), y * out(x, y), z));
            let points = steps.map(at).concat();
            let weights = vec![1.0, half, 1.0, half, 1.0, half, 1.0, half, 1.0];
            NurbsSurface::new(knots(), knots(), points, Some(weights)).unwrap()
        };
        let side = shapes::cylinder(1.0, 1.0).unwrap();
        let can = SurfaceBvh::build(&[side, disk(1.0), disk(0.0).reversed_u()]).unwrap();
        let mut doubted = 0;
        for k in 0..500 {
            let corner = DVec3::new([half, -half][k % 2], [half, -half][k / 2 % 2], 1.0);
            let angle = 0.37 * k as f64;
            let direction = DVec3::new(angle.cos(), angle.sin(), -0.01 - 0.004 * k as f64);
            let is_doubtful = check_parity(&can, corner, direction, "a corner of the can");
            doubted += u32::from(is_doubtful);
        }
        // There is no normal at the corner, and no certificate beside it.
        assert!(doubted < 300, "{doubted} of 500");
    }

    /// Points spread over a unit sphere by the plastic ratio.
    fn spread(k: usize) -> DVec3 {
        let (z, turn) = ((0.754_877_666 * k as f64).fract(), 0.569_840_29 * k as f64);
        let (y, x) = (TAU * turn).sin_cos();
        let flat = (1.0 - (2.0 * z - 1.0).powi(2)).sqrt();
        DVec3::new(flat * x, flat * y, 2.0 * z - 1.0)
    }

    #[test]
    fn rays_within_rounding_of_a_corner_are_even_or_doubtful() {
        let (cube, star) = (trimmed_cube(), spiked(&[1.0, 0.3, 1.0, 0.3, 1.0, 0.3]));
        for (bvh, corner) in [(&cube, DVec3::ONE), (&cube, DVec3::X), (&star, DVec3::Z)] {
            let mut doubted = [0; 3];
            for k in 0..1500 {
                let far = 10f64.powf(-15.0 + 3.0 * (k % 50) as f64 / 50.0);
                let (aside, direction) = (far * spread(k), spread(7 * k + 3));
                let is_doubtful = check_parity(bvh, corner + aside, direction, "near a corner");
                // Below 1e-14, to 1e-13, to 1e-12.
                doubted[k % 50 * 3 / 50] += u32::from(is_doubtful);
            }
            // As often as not, only some of the faces are met there.
            assert!(doubted.iter().all(|&doubted| doubted < 250), "{doubted:?} of 500 each");
        }
    }
}
