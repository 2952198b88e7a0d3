//! Hits that were found from far away: what they say of the surface does not depend on that.

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
use nurbray::intersect::{Coherence, Hit, Kernel, Query, SurfaceBvh};
use nurbray::math::Ray;
use nurbray::math::rounding::residual_factor;

use crate::random::Random;

/// A wild surface with uneven weights.
fn crumpled() -> NurbsSurface {
    let mut random = Random::new(76);
    let [us, vs] = [(2, 6), (4, 8)].map(|(p, n)| KnotVector::clamped_uniform(p, n).unwrap());
    let points = (0..48).map(|_| random.cube()).collect();
    let weights = (0..48).map(|_| random.power_of_ten(-1.0, 1.0)).collect();
    NurbsSurface::new(us, vs, points, Some(weights)).unwrap()
}

/// Hills with many knot lines.
fn hills() -> NurbsSurface {
    let knots = KnotVector::clamped_uniform(3, 14).unwrap();
    let points = (0..14 * 14).map(|k| {
        let [x, y] = [k / 14, k % 14].map(|i| f64::from(i) / 13.0);
        DVec3::new(2.0 * x - 1.0, 2.0 * y - 1.0, 0.25 * (9.0 * x).sin() * (8.0 * y).cos())
    });
    NurbsSurface::new(knots.clone(), knots, points.collect(), None).unwrap()
}

/// How far off a computed point of the surface may be, whatever the rays.
fn own_error(surface: &NurbsSurface) -> f64 {
    let [p, q] = surface.degree();
    let largest = surface.points().map(|point| point.abs().max_element()).fold(0.0, f64::max);
    residual_factor(p, q) * largest
}

/// Rays of that length that end on a surface, and pass it at all angles.
fn rays_from(surface: &NurbsSurface, distance: f64, count: usize, random: &mut Random) -> Vec<Ray> {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let rays = std::iter::repeat_with(|| {
        let uv = DVec2::new(random.between(u0, u1), random.between(v0, v1));
        let along = (surface.normal(uv)? + random.unit() * random.direction()).normalize();
        Ray::new(surface.point_at(uv) - distance * along, along).ok()
    });
    rays.flatten().take(count).collect()
}

/// Seen from a thousand sizes away, a hit may be off its ray by a thousand times the rounding of
/// the surface, but not off the surface; and a ray that leaves it does not meet it again.
#[test]
fn hits_lie_on_their_surface_from_however_far_they_are_seen() {
    for surface in [crumpled(), hills()] {
        let bvh = SurfaceBvh::build(&[&surface]).unwrap();
        let error = own_error(&surface);
        let mut random = Random::new(77);
        for distance in [10.0, 1e3, 1e5] {
            let rays = rays_from(&surface, distance, 10_000, &mut random);
            for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
                let mut tracer = bvh.tracer_with(kernel);
                let mut answers = Vec::new();
                tracer.first_hits(&rays, Coherence::Coherent, &mut answers);
                let sure = answers.iter().filter(|answer| !answer.doubtful);
                let hits: Vec<Hit> = sure.filter_map(|answer| answer.hit).collect();
                assert!(hits.len() > 9_000, "{kernel}, {distance:e}: {}", hits.len());
                for hit in hits {
                    // Along the normal, the rounding of u and v does not matter.
                    let off = (hit.point - surface.point_at(hit.uv)).dot(hit.normal);
                    assert!(off.abs() <= error, "{kernel}, {distance:e}: {off:e} of {error:e}");
                    let cosine = -off.signum() * random.power_of_ten(-6.0, -1.0);
                    let along = random.perpendicular(hit.normal) + cosine * hit.normal;
                    let end = 4.0 * error / cosine.abs();
                    let ray = Ray::with_range(hit.point, along.normalize(), 0.0, end).unwrap();
                    let again = tracer.first_hit(&Query::leaving(ray, &hit));
                    // Near a fold there may be another root so near.
                    let itself = again.hit.filter(|again| again.uv.distance(hit.uv) < 1e-6);
                    assert!(itself.is_none() || again.doubtful, "{kernel}: {hit:?}, {again:?}");
                }
            }
        }
    }
}

/// The root on the neighbouring piece, beyond its side, is the start: by rounding, it may look a
/// little farther off than its error bound.
#[test]
fn rays_that_leave_a_hit_beside_a_knot_line_do_not_meet_the_neighbouring_piece() {
    let bvh = SurfaceBvh::build(&[hills()]).unwrap();
    let origin = DVec3::new(1.1743836345859209, 0.3350872533018343, 0.13755752608735636);
    let along = DVec3::new(-0.4692554301841624, -0.8586230799923527, -0.20631468136592443);
    let leaving = DVec3::new(0.9985862052340451, -3.828668972276427e-6, -0.0531562856265461);
    let seen = Ray::with_range(origin, along, 0.5, f64::INFINITY).unwrap();
    for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
        let mut tracer = bvh.tracer_with(kernel);
        let hit = tracer.first_hit(&seen).hit.unwrap();
        let ray = Ray::with_range(hit.point, leaving, 0.0, 1e-6).unwrap();
        let query = Query::leaving(ray, &hit);
        for again in [tracer.first_hit(&query), tracer.exact_first_hit(&query)] {
            assert!(again.hit.is_none() || again.doubtful, "{kernel}: {again:?}");
        }
    }
}

/// A sheet rolled up, its turns as far apart as `gap`: a ray that leaves one outwards meets the
/// next or, if this is nearer than the ray that found the first can tell, is in doubt.
#[test]
fn the_next_turn_of_a_scroll_is_met_or_doubted_from_afar() {
    for gap in [1e-3, 1e-6, 1e-9] {
        let count = 16 * 3 + 3;
        let around = KnotVector::uniform(3, count).unwrap();
        let points = (0..count).flat_map(|i| {
            let (sin, cos) = (std::f64::consts::TAU * i as f64 / 16.0).sin_cos();
            let radius = 1.0 + gap * i as f64 / 16.0;
            [-1.0, 1.0].map(|z| DVec3::new(radius * cos, radius * sin, z))
        });
        let knots = around.values().to_vec();
        let across = KnotVector::bezier(1).unwrap();
        let scroll = NurbsSurface::new(around, across, points.collect(), None).unwrap();
        let bvh = SurfaceBvh::build(&[&scroll]).unwrap();
        let [[u0, u1], _] = scroll.domain();
        let inner = u0 + 0.6 * (u1 - u0);
        let knots: Vec<f64> = knots.into_iter().filter(|u| (u0..inner).contains(u)).collect();
        let mut random = Random::new(78);
        let (mut tracer, mut left, mut met) = (bvh.tracer(), 0, 0);
        for distance in [0.5, 1e3, 1e6, 1e9] {
            for _ in 0..400 {
                let beside = random.sign() * random.power_of_ten(-12.0, -6.0);
                let uv = DVec2::new(random.pick(&knots) + beside, random.between(0.1, 0.9));
                if uv.x < u0 {
                    continue;
                }
                let (point, normal) = (scroll.point_at(uv), scroll.normal(uv).unwrap());
                let outwards = normal * normal.dot(point.with_z(0.0)).signum();
                let [from, to] = [-0.4, 0.4].map(|way| distance + way);
                let from_inside = point - distance * outwards;
                let ray = Ray::with_range(from_inside, outwards, from, to).unwrap();
                let mut hits = Vec::new();
                let _ = tracer.all_hits(&ray, &mut hits);
                let Some(hit) = hits.iter().find(|hit| (hit.uv.x - uv.x).abs() < 1.0) else {
                    continue;
                };
                let along = outwards + 0.2 * random.direction();
                let ray = Ray::new(hit.point, along).unwrap();
                let next = tracer.first_hit(&Query::leaving(ray, hit));
                let is_next = next.hit.is_some_and(|next| (next.t - gap).abs() < 0.5 * gap);
                assert!(is_next || next.doubtful, "{gap:e}, {distance:e}: {uv}, {next:?}");
                left += 1;
                met += u32::from(!next.doubtful);
            }
        }
        assert!(left > 800 && met > 300, "{met} of {left} at {gap:e}");
    }
}

/// What lies before a ray's range is no reason for doubt.
#[test]
fn rays_that_begin_beyond_the_edge_they_leave_are_certain() {
    let half_turns = [DAffine3::IDENTITY, DAffine3::from_rotation_x(std::f64::consts::FRAC_PI_2)];
    let lifted = DAffine3::from_translation(DVec3::Z);
    let faces =
        half_turns.map(|turn| shapes::plane(2.0, 2.0).unwrap().transformed(&(turn * lifted)));
    // One face looks up, the other along −y: they share an edge.
    let faces = faces.map(Result::unwrap);
    let bvh = SurfaceBvh::build(&faces).unwrap();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(79);
    let mut left = 0;
    for _ in 0..1000 {
        let edge = DVec3::new(random.between(-0.9, 0.9), -1.0, 1.0);
        let along = DVec3::new(random.between(-0.5, 0.5), 1.0 + random.unit(), -1.0);
        let Some(hit) = tracer.first_hit(&Ray::new(edge - along, along).unwrap()).hit else {
            continue;
        };
        let ray = Ray::with_range(hit.point, random.direction(), 1e-6, 0.5).unwrap();
        let plain = tracer.first_hit(&ray);
        let leaving = tracer.first_hit(&Query::leaving(ray, &hit));
        assert!(plain.doubtful || !leaving.doubtful, "{ray:?}: {leaving:?}");
        left += 1;
    }
    assert!(left > 500, "{left}");
}
