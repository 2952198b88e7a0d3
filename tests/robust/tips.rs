//! Sides that are one point, and along which the tangents across them vanish, too.

use glam::{DVec2, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface};
use nurbray::intersect::{Coherence, Kernel, SurfaceBvh};
use nurbray::math::Ray;
use nurbray::math::rounding::residual_factor;

use crate::random::Random;

/// A double cone over the curve `r(v) = (1, v', v'²)` with `v' = 3 v / 2 − 3 / 4`: its rows of
/// control points are these multiples of `r`, away from the tip.
///
/// So `S = g(u) r(v)`. Where g is a cubic and m of its first coefficients are zero, it is as small
/// as `uᵐ`, and the tangents as `uᵐ` and `uᵐ⁻¹`.
fn cone(sizes: &[f64]) -> NurbsSurface {
    // The blossom of r, as a cubic, at (0, 0, 0), (0, 0, 1), (0, 1, 1) and (1, 1, 1).
    let across = |j: usize| {
        let [a, b, c] = [0, 1, 2].map(|k| if k + j >= 3 { 0.75 } else { -0.75 });
        DVec3::new(1.0, (a + b + c) / 3.0, (a * b + b * c + c * a) / 3.0)
    };
    let points = sizes.iter().flat_map(|&size| (0..4).map(move |j| size * across(j)));
    let along = KnotVector::clamped_uniform(3, sizes.len()).unwrap();
    NurbsSurface::new(along, KnotVector::bezier(3).unwrap(), points.collect(), None).unwrap()
}

/// The normal of a cone does not change along its rulings: it is `r × r'`, whatever `u`, or the
/// opposite beyond the tip.
#[test]
fn normals_of_cones_are_right_down_to_the_tip() {
    let mut random = Random::new(77);
    let cones: [&[f64]; 4] = [
        &[0.0, 1.0, 2.0, 3.0],
        &[0.0, 0.0, 1.0, 2.0],
        &[0.0, 0.0, 0.0, 1.0],
        &[-2.0, -1.0, 0.0, 0.0, 0.0, 1.0, 2.0],
    ];
    for sizes in cones {
        let surface = cone(sizes);
        let [from, to] = surface.domain()[0];
        let tip = if sizes[0] < 0.0 { 0.5 * (from + to) } else { from };
        let order = sizes.iter().filter(|&&size| size == 0.0).count() as f64;
        let bvh = SurfaceBvh::build(std::slice::from_ref(&surface)).unwrap();
        let rays = (0..4000).map(|_| {
            // From 1e-5 to 1 times the cone's size away from the tip.
            let away = random.power_of_ten(-5.0, 0.0).powf(1.0 / order);
            let side = if tip > from { random.sign() } else { 1.0 };
            let u = tip + side * away * (to - tip);
            let target = surface.point_at(DVec2::new(u, random.between(0.01, 0.99)));
            let direction = random.direction();
            Ray::new(target - 5.0 * direction, direction).unwrap()
        });
        let rays: Vec<Ray> = rays.collect();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            for coherence in [None, Some(Coherence::Coherent), Some(Coherence::Incoherent)] {
                let mut tracer = bvh.tracer_with(kernel);
                let mut answers = Vec::new();
                match coherence {
                    None => answers.extend(rays.iter().map(|ray| tracer.first_hit(ray))),
                    Some(coherence) => tracer.first_hits(&rays, coherence, &mut answers),
                }
                let (mut seen, mut worst) = (0, 0.0f64);
                let certain = answers.iter().filter(|answer| !answer.doubtful);
                for hit in certain.filter_map(|answer| answer.hit) {
                    let y = 1.5 * hit.uv.y - 0.75;
                    let (r, along) = (DVec3::new(1.0, y, y * y), DVec3::new(0.0, 1.0, 2.0 * y));
                    let normal = hit.point.x.signum() * r.cross(along).normalize();
                    worst = worst.max(hit.normal.distance(normal));
                    seen += 1;
                }
                let who = format!("{sizes:?}, {kernel} {coherence:?}");
                assert!(seen > 3000, "{who}: {seen} hits");
                assert!(worst < 5e-12, "{who}: normals off by {worst:e}");
            }
        }
    }
}

/// Rows that are the tip to within rounding, and may be meant to be, leave their mark: normals turn
/// by no more than that.
#[test]
fn nearly_collapsed_rows_do_not_turn_normals_farther_than_rounding() {
    // S = u³ r(v) + 3 δ u (1 − u)² q(v), with r as above and q = (0, 1, y).
    let mut random = Random::new(78);
    for shift in [0.0, 1e-16, 1e-15, 1e-14] {
        let beside = |j: usize| DVec3::new(0.0, 1.0, 0.5 * j as f64 - 0.75);
        let tip = cone(&[0.0, 0.0, 0.0, 1.0]);
        let points = tip.points().enumerate();
        let points = points.map(|(k, point)| match k / 4 {
            1 => shift * beside(k % 4),
            _ => point,
        });
        let knots = || KnotVector::bezier(3).unwrap();
        let surface = NurbsSurface::new(knots(), knots(), points.collect(), None).unwrap();
        let bvh = SurfaceBvh::build(std::slice::from_ref(&surface)).unwrap();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let mut seen = 0;
            for _ in 0..2000 {
                let size = random.power_of_ten(-8.0, 0.0);
                let at = DVec2::new(size.cbrt(), random.between(0.01, 0.99));
                let (target, direction) = (surface.point_at(at), random.direction());
                let ray = Ray::new(target - 2.0 * direction, direction).unwrap();
                let answer = tracer.first_hit(&ray);
                let Some(hit) = answer.hit.filter(|_| !answer.doubtful) else { continue };
                let (u, y) = (hit.uv.x, 1.5 * hit.uv.y - 0.75);
                let (r, by_v) = (DVec3::new(1.0, y, y * y), DVec3::new(0.0, 1.0, 2.0 * y));
                let (q, q_by_v) = (DVec3::new(0.0, 1.0, y), DVec3::Z);
                let (bend, slope) =
                    (3.0 * u * (1.0 - u).powi(2), 3.0 * (1.0 - u) * (1.0 - 3.0 * u));
                let along_u = 3.0 * u * u * r + shift * slope * q;
                let along_v = u.powi(3) * by_v + shift * bend * q_by_v;
                let normal = along_u.cross(along_v).normalize();
                let turned = hit.normal.distance(normal);
                // Twice what the error bound of points turns a row of this size by.
                let most = 1e-12 + 2.0 * residual_factor(3, 3) / u.powi(2);
                assert!(turned <= most, "{shift:e}, {kernel}, u = {u:e}: {turned:e}");
                seen += 1;
            }
            assert!(seen > 1000, "{shift:e}, {kernel}: {seen}");
        }
    }
}
