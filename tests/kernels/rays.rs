//! Rays for any model: plain and nasty ones, and those that leave hits.

use glam::{DVec2, DVec3};
use nurbray::geometry::{Charts, Surface};
use nurbray::intersect::{Answer, Query};
use nurbray::math::Ray;

use crate::random::Random;

/// Rays from one eye through a grid, rays from everywhere, and rays at corners, knot lines,
/// poles and along axes.
pub(crate) fn rays(
    surfaces: &[Surface],
    center: DVec3,
    radius: f64,
    random: &mut Random,
) -> Vec<Query> {
    let mut rays = Vec::new();
    let eye = center + 2.5 * radius * random.direction();
    let forward = (center - eye).normalize();
    let right = forward.any_orthonormal_vector();
    let up = forward.cross(right);
    for k in 0..32 * 32 {
        let (x, y) = ((k % 32) as f64 / 16.0 - 1.0, (k / 32) as f64 / 16.0 - 1.0);
        rays.push((eye, forward + 0.45 * (x * right + y * up)));
    }
    for _ in 0..600 {
        let origin = center + 1.5 * radius * random.direction();
        rays.push((origin, center + radius * random.unit() * random.direction() - origin));
    }
    let charts: Vec<_> = surfaces.iter().flat_map(Surface::charts).collect();
    for k in 0..600 * surfaces.len() {
        // The charts in turn, and neighbours not one after the other.
        let surface = &charts[k * 7919 % charts.len()].surface;
        let [[u0, u1], [v0, v1]] = surface.domain();
        let grid = |random: &mut Random| (random.unit() * 9.0).floor() / 8.0;
        let (a, b) = (grid(random), if random.unit() < 0.5 { grid(random) } else { random.unit() });
        let target = surface.point_at(DVec2::new(u0 + a * (u1 - u0), v0 + b * (v1 - v0)));
        let origin = target + 3.0 * radius * random.direction();
        rays.push((origin, target - origin));
    }
    for k in 0..150 {
        // From as far away as rays may start and still see small things in large scenes in f32.
        let surface = &charts[k * 7919 % charts.len()].surface;
        let [[u0, u1], [v0, v1]] = surface.domain();
        let (a, b) = (random.unit(), random.unit());
        let target = surface.point_at(DVec2::new(u0 + a * (u1 - u0), v0 + b * (v1 - v0)));
        let origin = target + random.unit() * 800.0 * radius * random.direction();
        rays.push((origin, target - origin));
    }
    for k in 0..150 {
        let axis = [DVec3::X, DVec3::Y, -DVec3::Z][k % 3];
        let at = (4.0 * random.direction()).round() / 4.0 * radius;
        rays.push((center + at - 3.0 * radius * axis, axis));
    }
    for _ in 0..150 {
        let origin = center + 1e6 * radius * random.direction();
        rays.push((origin, center + 0.9 * radius * random.direction() - origin));
    }
    let mut rays: Vec<Ray> = rays.into_iter().map(|(o, d)| Ray::new(o, d).unwrap()).collect();
    // One in eight with its origin elsewhere on its line, and another range.
    for ray in rays.iter_mut().step_by(8) {
        let t = 3.0 * random.unit();
        let from = if random.unit() < 0.5 { -3.0 * random.unit() } else { f64::NEG_INFINITY };
        let to = if random.unit() < 0.5 { 0.1 + random.unit() } else { f64::INFINITY };
        *ray = Ray::with_range(ray.at(t), ray.direction(), from, to).unwrap();
    }
    rays.into_iter().map(Query::primary).collect()
}

/// Rays that leave the hits of others: in any direction, and at small angles to the surface.
pub(crate) fn leaving(answers: &[Answer], radius: f64, random: &mut Random) -> Vec<Query> {
    let hits = answers.iter().filter_map(|answer| answer.hit);
    let regular = hits.filter(|hit| hit.normal.is_finite());
    regular
        .enumerate()
        .map(|(k, hit)| {
            let any = random.direction();
            let direction = match k % 3 {
                0 => any,
                _ => {
                    let along = (any - any.dot(hit.normal) * hit.normal).normalize();
                    let angle = 10f64.powf(-3.0 * random.unit());
                    along + if k % 3 == 1 { angle } else { -angle } * hit.normal
                }
            };
            let end = if k % 2 == 0 { f64::INFINITY } else { radius * random.unit() };
            Query::leaving(Ray::with_range(hit.point, direction, 0.0, end).unwrap(), &hit)
        })
        .collect()
}

/// Rays past a pole at distances from 1e-13 to 1e-2, steep ones and others, some of which end
/// near where they hit.
pub(crate) fn past_pole(pole: DVec3, random: &mut Random) -> Vec<Query> {
    let ray = |k: usize| {
        let aside = 10f64.powf(-2.0 - 11.0 * random.unit());
        // Every third in a plane of symmetry.
        let side = if k.is_multiple_of(3) { DVec3::X } else { random.direction() };
        let flat = 10f64.powf(-2.0 * random.unit());
        let from =
            random.direction() * DVec3::new(1.0, if k.is_multiple_of(3) { 0.0 } else { 1.0 }, flat);
        let direction = -from * (1.0 + random.unit());
        let origin = pole + aside * side - direction;
        let spare = [f64::INFINITY, 1e-15, -1e-15, 1e-13][k % 4] * random.unit();
        Query::primary(Ray::with_range(origin, direction, 0.0, 1.0 + spare).unwrap())
    };
    (0..2000).map(ray).collect()
}
