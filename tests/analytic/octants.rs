//! Eight quartic triangles make a sphere: against the closed form and against the bicubic one.

use glam::DVec3;
use nurbray::geometry::shapes;
use nurbray::intersect::{BuildOptions, Hit, HitFlags, Query, SurfaceBvh};
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
    let octants = SurfaceBvh::build(&patches::octants(), &BuildOptions::default()).unwrap();
    let bicubic = [shapes::sphere(1.0).unwrap()];
    let bicubic = SurfaceBvh::build(&bicubic, &BuildOptions::default()).unwrap();
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
                hits.clear();
                others.clear();
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
