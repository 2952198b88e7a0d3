//! Eight quartic triangles make a sphere: against the closed form and against the bicubic one.

use glam::DVec3;
use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
use nurbray::intersect::{Hit, HitFlags, Query, SurfaceBvh};
use nurbray::math::Ray;
use nurbray::math::rounding::residual_factor;
use rayon::prelude::*;

use crate::patches;
use crate::random::Random;

/// Lines in all directions past the middle by less than a radius, and lines aimed at where
/// triangles and their charts meet: corners, sides, middles.
fn line(random: &mut Random, k: u64) -> Ray {
    let octant = DVec3::new(random.sign(), random.sign(), random.sign());
    let target = match k % 5 {
        0 => octant * [DVec3::X, DVec3::Y, DVec3::Z][random.below(3)],
        1 => {
            let mut at = random.direction();
            at[random.below(3)] = 0.0;
            at.normalize()
        }
        2 => (octant * DVec3::ONE).normalize(),
        3 => {
            // On the way from the middle of a side to the middle of the octant.
            let mut side = DVec3::ONE;
            side[random.below(3)] = random.between(0.0, 1.0);
            octant * side.normalize()
        }
        _ => random.direction() * random.between(0.0, 0.99),
    };
    let direction = random.direction() * random.power_of_ten(-3.0, 3.0);
    let origin = target - random.between(-3.0, 3.0) * direction.normalize();
    Ray::with_range(origin, direction, f64::NEG_INFINITY, f64::INFINITY).unwrap()
}

/// The roots of `|o + t d| = 1` by the stable quadratic formula, and the cosine there.
fn sphere_roots(ray: &Ray) -> Option<([f64; 2], f64)> {
    let length = ray.direction().length();
    let d = ray.direction() / length;
    let middle = -ray.origin().dot(d);
    let past = ray.origin() + middle * d;
    let half = 1.0 - past.length_squared();
    (half > 0.0).then(|| {
        let half = half.sqrt();
        ([(middle - half) / length, (middle + half) / length], half)
    })
}

fn compare(count: u64) {
    let octants = SurfaceBvh::build(&patches::octants()).unwrap();
    let bicubic = [shapes::sphere(1.0).unwrap()];
    let bicubic = SurfaceBvh::build(&bicubic).unwrap();
    let block = 1000;
    let blocks: Vec<(u64, u64)> = (0..count / block)
        .into_par_iter()
        .map(|seed| {
            let mut random = Random::new(seed << 24 ^ 0xc7);
            let (mut a, mut b) = (octants.tracer(), bicubic.tracer());
            let (mut hits, mut others): (Vec<Hit>, Vec<Hit>) = Default::default();
            let (mut doubtful, mut compared) = (0, 0);
            for k in 0..block {
                let ray = line(&mut random, k);
                let query = Query::primary(ray);
                if a.all_hits(&query, &mut hits) || b.all_hits(&query, &mut others) {
                    doubtful += 1;
                    continue;
                }
                assert_eq!(hits.len() % 2, 0, "{ray:?}: {hits:?}");
                let Some((roots, cosine)) = sphere_roots(&ray) else { continue };
                // Near tangency roots move by more than their error.
                if cosine < 1e-4 {
                    continue;
                }
                compared += 1;
                assert_eq!((hits.len(), others.len()), (2, 2), "{ray:?}");
                // The largest coordinate of the nets' points is 1 for the triangles.
                let length = ray.direction().length();
                let magnitude = ray.origin().abs().max_element().max(2.0);
                let bound = residual_factor(4, 4) * magnitude / cosine;
                for ((hit, other), root) in hits.iter().zip(&others).zip(roots) {
                    let [off, apart] = [root, other.t].map(|t| (hit.t - t).abs() * length);
                    assert!(off <= 2.0 * bound, "{ray:?}: off by {off:e} of {bound:e}");
                    assert!(apart <= 2.0 * bound, "{ray:?}: apart by {apart:e} of {bound:e}");
                    let turned = hit.normal.distance(hit.point.normalize());
                    assert!(turned < 1e-12, "{ray:?}: {turned:e} at {}", hit.uv);
                    let [u, v] = hit.uv.to_array();
                    assert!(u >= 0.0 && v >= 0.0 && u + v <= 1.0 + f64::EPSILON, "{}", hit.uv);
                    let side = u.min(v).min(1.0 - u - v) < 1e-15;
                    assert!(!side || hit.flags.contains(HitFlags::BORDER), "{}", hit.uv);
                }
            }
            (doubtful, compared)
        })
        .collect();
    let [doubtful, compared] =
        [0, 1].map(|k| blocks.iter().map(|block| [block.0, block.1][k]).sum::<u64>());
    println!("{compared} of {count} compared, {doubtful} doubtful");
    assert!(doubtful < count / 1000 && compared > count / 2, "{doubtful}, {compared}");
}

#[test]
fn eight_octants_are_met_as_the_bicubic_sphere() {
    compare(100_000);
}

/// The same with a million lines.
#[test]
#[ignore = "takes a minute"]
fn eight_octants_are_met_as_the_bicubic_sphere_a_million_times() {
    compare(1_000_000);
}

/// A ray that leaves the sphere where triangles meet leaves all of them: outwards it meets nothing,
/// inwards the far side at twice the cosine.
#[test]
fn rays_leave_shared_edges_as_they_leave_one_surface() {
    let octants = SurfaceBvh::build(&patches::octants()).unwrap();
    let mut random = Random::new(0x51);
    let mut tracer = octants.tracer();
    let (mut left, mut doubtful) = (0, 0);
    for k in 0..20_000 {
        let mut at = random.direction();
        at[random.below(3)] = 0.0;
        let at = if k % 4 == 0 { [DVec3::X, -DVec3::Y, DVec3::Z][random.below(3)] } else { at };
        let Ok(inward) = Ray::new(3.0 * at.normalize(), -at) else { continue };
        let Some(start) = tracer.first_hit(&Query::primary(inward)).hit else {
            panic!("no hit from {at}")
        };
        assert!(start.flags.contains(HitFlags::BORDER), "{at}");
        let ray = Ray::new(start.point, random.direction()).unwrap();
        let cosine = ray.direction().dot(start.point);
        if cosine.abs() < 1e-3 {
            continue;
        }
        left += 1;
        let answer = tracer.first_hit(&Query::leaving(ray, &start));
        let occlusion = tracer.occluded(&Query::leaving(ray, &start));
        doubtful += u32::from(answer.doubtful || occlusion.doubtful);
        if answer.doubtful || occlusion.doubtful {
            continue;
        }
        assert_eq!(answer.hit.is_some(), cosine < 0.0, "{ray:?}");
        assert_eq!(occlusion.occluded, cosine < 0.0, "{ray:?}");
        let Some(hit) = answer.hit else { continue };
        assert!((hit.t + 2.0 * cosine).abs() < 1e-11, "{ray:?}: {}", hit.t);
    }
    println!("{doubtful} of {left} doubtful");
    assert!(left > 19_000 && doubtful < left / 100, "{doubtful} of {left}");
}

/// At the ridge of a roof the sides part: rays that go up leave both, rays that go down meet the
/// floor, and for rays in between the answer is doubtful, not a miss.
#[test]
fn rays_leave_a_ridge_on_the_side_they_go_to() {
    let corner = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let side = |x: f64, sign: f64| {
        // Both normals point up.
        let (near, far) = (corner(x, 0.0, 0.0), corner(x, 1.0, 0.0));
        let (low, high) = (corner(0.0, 0.0, 1.0), corner(0.0, 1.0, 1.0));
        let net = if sign < 0.0 { [near, far, low, high] } else { [low, high, near, far] };
        let knots = || KnotVector::clamped_uniform(1, 2).unwrap();
        NurbsSurface::new(knots(), knots(), net.to_vec(), None).unwrap()
    };
    let floor = {
        let points = [[-9.0, -9.0], [-9.0, 9.0], [9.0, -9.0], [9.0, 9.0]];
        let net = points.map(|[x, y]| corner(x, y, -1.0)).to_vec();
        let knots = || KnotVector::clamped_uniform(1, 2).unwrap();
        NurbsSurface::new(knots(), knots(), net, None).unwrap()
    };
    let roof = [side(-1.0, -1.0), side(1.0, 1.0), floor];
    let bvh = SurfaceBvh::build(&roof).unwrap();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(0x52);
    let mut flagged = 0;
    for _ in 0..2_000 {
        let top = corner(0.0, random.between(0.05, 0.95), 1.0);
        let down = Ray::new(top + DVec3::Z, -DVec3::Z).unwrap();
        let start = tracer.first_hit(&Query::primary(down)).hit.unwrap();
        assert!(start.point.distance(top) < 1e-14);
        let direction = random.direction();
        let [left, right] = [corner(-1.0, 0.0, 1.0), corner(1.0, 0.0, 1.0)];
        let [a, b] = [left, right].map(|normal| normal.normalize().dot(direction));
        if a.abs().min(b.abs()) < 1e-2 {
            continue;
        }
        let ray = Ray::new(start.point, direction).unwrap();
        let answer = tracer.first_hit(&Query::leaving(ray, &start));
        if a * b > 0.0 {
            assert!(!answer.doubtful, "{ray:?}");
            let floor = answer.hit.map(|hit| hit.point.z);
            // Towards the floor, which is large, but not endless.
            let [x, y] = [direction.x, direction.y].map(|d| -2.0 * d / direction.z);
            let meets = direction.z < 0.0 && x.abs() < 8.9 && (y + top.y).abs() < 8.9;
            assert_eq!(meets, floor == Some(-1.0), "{ray:?}: {floor:?}");
        } else {
            flagged += u32::from(answer.doubtful);
            assert!(answer.doubtful, "{ray:?}: {answer:?}");
        }
    }
    assert!(flagged > 200, "{flagged}");
}
