//! Trim edges that are known less well than points: parameters far from zero, and curves with far
//! control points.

use glam::{DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimCurve, TrimLoop};
use nurbray::geometry::{KnotVector, NurbsSurface, Surface, shapes};
use nurbray::intersect::{HitFlags, Query};
use nurbray::math::Ray;

use crate::ask::{asked, build, polygon, trimmed};
use crate::random::Random;

/// The square from −1 to 3, with knots from `first` on, as spanned by two axes at a distance along
/// the third one.
fn square(axis: usize, at: f64, first: f64) -> NurbsSurface {
    let knots = || KnotVector::new(1, vec![first, first, first + 4.0, first + 4.0]).unwrap();
    let corner = |u: f64, v: f64| {
        let mut corner = [0.0; 3];
        (corner[axis], corner[(axis + 1) % 3], corner[(axis + 2) % 3]) = (at, u, v);
        DVec3::from_array(corner)
    };
    let net = [(-1.0, -1.0), (-1.0, 3.0), (3.0, -1.0), (3.0, 3.0)].map(|(u, v)| corner(u, v));
    NurbsSurface::new(knots(), knots(), net.to_vec(), None).unwrap()
}

/// The faces of a cube between 0 and 1, each cut out of a larger square; outwards.
fn cube(first: f64) -> Vec<Surface> {
    let corners = [(1.0, 1.0), (2.0, 1.0), (2.0, 2.0), (1.0, 2.0)];
    let outline = polygon(&corners.map(|(u, v)| (first + u, first + v)));
    let face = |axis: usize, at: f64| {
        let face = trimmed(square(axis, at, first), Kept::Odd, std::slice::from_ref(&outline));
        Surface::from(if at > 0.0 { face } else { face.reversed_u() })
    };
    (0..3).flat_map(|axis| [face(axis, 0.0), face(axis, 1.0)]).collect()
}

/// Beside a corner, a ray may come so near to the edges of some faces that they seem to be met,
/// while the last one, which it crosses at a small angle, is surely not.
#[test]
fn rays_beside_corners_enter_as_often_as_they_leave() {
    for first in [0.0, 256.0, 1024.0, 16384.0, 1048576.0] {
        let bvh = build(&cube(first));
        let mut tracer = bvh.tracer();
        let mut random = Random::new(91);
        let (mut hits, mut doubtful, rays) = (Vec::new(), 0, 20_000);
        for k in 0..rays {
            let mut target = DVec3::from_array([(); 3].map(|()| random.below(2) as f64));
            if k % 2 == 0 {
                target[k / 2 % 3] = random.unit();
            }
            let off = if k % 4 == 0 { 0.0 } else { random.power_of_ten(-16.5, -8.0) };
            let (aside, way) = (off * random.direction(), random.direction());
            let ray = Ray::new(target - 3.0 * way + aside, way).unwrap();
            if tracer.all_hits(&ray, &mut hits) {
                doubtful += 1;
                continue;
            }
            let senses = hits.iter().map(|hit| hit.normal.dot(way).signum());
            assert_eq!(senses.sum::<f64>(), 0.0, "{first}: {ray:?}: {hits:?}");
        }
        println!("knots from {first}: {doubtful} of {rays} in doubt");
        assert!(doubtful < rays / 16, "{doubtful}");
    }
}

/// Two bodies that touch along an edge: below z = 0 for x < 0, above it for x > 0. A ray through one
/// of them, beside the edge, does not seem to leave the other.
#[test]
fn bodies_that_touch_along_an_edge_are_told_apart() {
    for first in [0.0, 10.0, 1e3, 1e4] {
        // The squares from −1 to 3, cut down to a half with the y axis for an edge.
        let half = |axis: usize, [low, high]: [f64; 2]| {
            let corners = match axis {
                // By x and y, and by y and z.
                2 => [(low, -1.0), (high, -1.0), (high, 3.0), (low, 3.0)],
                _ => [(-1.0, low), (3.0, low), (3.0, high), (-1.0, high)],
            };
            let outline = polygon(&corners.map(|(u, v)| (first + 1.0 + u, first + 1.0 + v)));
            trimmed(square(axis, 0.0, first), Kept::Odd, &[outline])
        };
        let faces = [
            half(2, [-1.0, 0.0]),
            half(2, [0.0, 3.0]).reversed_u(),
            half(0, [-1.0, 0.0]),
            half(0, [0.0, 3.0]).reversed_u(),
        ];
        let bvh = build(&faces.map(Surface::from));
        let is_inside = |at: DVec3| (at.z < 0.0) == (at.x < 0.0);
        let mut tracer = bvh.tracer();
        let (mut hits, mut told, mut rays) = (Vec::new(), 0, 0);
        for slope in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5] {
            for k in 0..240 {
                let off = 10f64.powf(-16.0 + 0.1 * f64::from(k % 60));
                let off = if k % 120 < 60 { off } else { -off };
                let way = DVec3::new(slope, 0.01, -1.0) * if k < 120 { 1.0 } else { -1.0 };
                let origin = DVec3::new(off, 0.2, 0.0) - 0.5 * way;
                let ray = Ray::with_range(origin, way, 0.0, 1.0).unwrap();
                rays += 1;
                if tracer.all_hits(&ray, &mut hits) {
                    continue;
                }
                told += 1;
                let entered = hits.iter().map(|hit| -hit.normal.dot(way).signum()).sum::<f64>();
                let [from, to] = [0.0, 1.0].map(|t| f64::from(u8::from(is_inside(ray.at(t)))));
                assert_eq!(entered, to - from, "{first}, {slope:e}, {off:e}: {hits:?}");
            }
        }
        println!("knots from {first}: {told} of {rays} told");
        assert!(told > rays / 5, "{told} of {rays}");
    }
}

/// Two sheets, cut off along one line, one above the other: however little is known of that line,
/// they are not one.
#[test]
fn sheets_that_end_at_one_line_are_not_one() {
    for first in [0.0, 1e3, 1e6] {
        for gap in [1e-14, 1e-12, 1e-10, 1e-8, 1e-6] {
            let half = polygon(
                &[(0.0, 0.0), (2.0, 0.0), (2.0, 4.0), (0.0, 4.0)]
                    .map(|(u, v)| (first + u, first + v)),
            );
            let sheet = |z: f64| {
                trimmed(square(2, z, first), Kept::Odd, std::slice::from_ref(&half)).into()
            };
            let bvh = build(&[sheet(0.0), sheet(gap)]);
            let mut tracer = bvh.tracer();
            let mut hits = Vec::new();
            for off in [0.0, 1e-13, 1e-11, 1e-9, 1e-3] {
                let ray = Ray::new(DVec3::new(1.0 - off, 0.4, 0.5), DVec3::NEG_Z).unwrap();
                let is_doubtful = tracer.all_hits(&ray, &mut hits);
                assert!(is_doubtful || hits.len() == 2, "{first}, {gap:e}, {off:e}: {hits:?}");
                assert!(!is_doubtful || gap < 1e-13 || off < 1e-3, "{first}, {gap:e}, {off:e}");
            }
        }
    }
}

/// The tip of a loop that reaches over a seam by next to nothing is there, too.
#[test]
fn the_tip_of_a_loop_beyond_a_seam_is_cut_off() {
    for beyond in [9e-13, 3e-12, 1e-9] {
        let tip = polygon(&[(1.0 + beyond, 0.5), (0.8, 0.7), (0.8, 0.3)]);
        for (kept, is_met) in [(Kept::Even, false), (Kept::Odd, true)] {
            let pipe = shapes::cylinder(1.0, 2.0).unwrap();
            let at = pipe.point_at(DVec2::new(0.25 * beyond, 0.5));
            let bvh = build(&[trimmed(pipe, kept, std::slice::from_ref(&tip)).into()]);
            let outwards = at.with_z(0.0);
            let ray = Ray::with_range(at + outwards, -outwards, 0.0, 1.5).unwrap();
            for (who, hits) in asked(&bvh, &[Query::primary(ray)]) {
                let found = hits[0].map(|hit| hit.is_some());
                assert_eq!(found, Some(is_met), "{beyond:e}, {kept:?}, {who}");
            }
        }
    }
}

/// A curve with far control points is known too little to say that it cuts nothing.
#[test]
fn what_a_far_curve_may_cut_off_says_so() {
    let plane = shapes::plane(1.0, 1.0).unwrap();
    for (far, deep) in [(1e6, 1e-9), (1e8, 1e-7)] {
        let curve = [[deep - far, -0.5], [deep + far, 0.5], [deep - far, 1.5]].map(DVec2::from);
        let hole = TrimLoop::new(&[
            TrimCurve::bezier(&curve, None).unwrap(),
            TrimCurve::line(curve[2], curve[0]).unwrap(),
        ]);
        let bvh = build(&[trimmed(plane.clone(), Kept::Even, &[hole.unwrap()]).into()]);
        let at = plane.point_at(DVec2::new(0.5 * deep, 0.5));
        let query = Query::primary(Ray::new(at + DVec3::Z, DVec3::NEG_Z).unwrap());
        for (who, hits) in asked(&bvh, &[query]) {
            let Some(Some(hit)) = hits[0] else { continue };
            assert!(hit.flags.contains(HitFlags::TRIM_EDGE), "{far:e}, {who}: {hit:?}");
        }
    }
}
