//! The range of a ray is open at both ends, in units of its direction, whatever its length.

use glam::DVec3;
use nurbray::geometry::shapes;
use nurbray::intersect::{Coherence, Hit, Kernel, Query, SurfaceBvh};
use nurbray::math::{Ray, RayError};

use crate::model::Model;
use crate::models;
use crate::random::Random;
use crate::rays::{Class, Rays};

fn crossings(bvh: &SurfaceBvh, ray: &Ray) -> Option<Vec<Hit>> {
    let mut hits = Vec::new();
    let doubtful = bvh.tracer().all_hits(&Query::primary(*ray), &mut hits);
    (!doubtful).then_some(hits)
}

fn cut(ray: &Ray, t_min: f64, t_max: f64) -> Option<Ray> {
    Ray::with_range(ray.origin(), ray.direction(), t_min, t_max).ok()
}

/// What queries say of a hit inside a range, outside it, or exactly at its end.
#[test]
fn hits_at_the_ends_of_the_range_are_left_out_or_flagged() {
    let mut random = Random::new(31);
    let mut ends = 0;
    for model in [models::sphere(), models::torus(), models::wavy_sheet(), models::teapot()] {
        let bvh = model.bvh();
        let rays = Rays::new(&model);
        for _ in 0..300 {
            let ray = rays.shot(Class::Aimed, &mut random).ray;
            let Some(hits) = crossings(&bvh, &ray) else { continue };
            let mut tracer = bvh.tracer();
            for (k, hit) in hits.iter().enumerate() {
                // From or to exactly this hit.
                for range in [cut(&ray, hit.t, f64::INFINITY), cut(&ray, 0.0, hit.t)] {
                    let query = Query::primary(range.unwrap());
                    let answer = tracer.first_hit(&query);
                    let within = |t: f64| range.unwrap().t_min() < t && t < range.unwrap().t_max();
                    assert!(answer.hit.is_none_or(|hit| within(hit.t)), "{query:?}");
                    let at_end = answer.hit.is_some_and(|other| other.t == hit.t);
                    assert!(!at_end, "an end is reported: {query:?}");
                    ends += 1;
                }
                // A little apart from it, the answer is certain and the same.
                let apart = 1e-9;
                let next = hits.get(k + 1).map_or(f64::INFINITY, |next| next.t - hit.t);
                let alone = next > 1e-6 && (k == 0 || hit.t - hits[k - 1].t > 1e-6);
                let steep = hit.normal.dot(ray.direction()).abs() > 1e-2 * ray.direction().length();
                if !(alone && steep) {
                    continue;
                }
                let before = Query::primary(cut(&ray, hit.t - apart, hit.t + apart).unwrap());
                let answer = tracer.first_hit(&before);
                assert!(!answer.doubtful && answer.hit.is_some(), "{before:?}");
                assert!((answer.hit.unwrap().t - hit.t).abs() < 1e-11, "{before:?}");
                let beside = [
                    cut(&ray, hit.t + apart, hit.t + 2.0 * apart),
                    cut(&ray, hit.t - 2.0 * apart, hit.t - apart),
                ];
                for query in beside.map(|ray| Query::primary(ray.unwrap())) {
                    assert!(tracer.first_hit(&query).hit.is_none(), "{query:?}");
                    let occlusion = tracer.occluded(&query);
                    assert!(!occlusion.occluded && !occlusion.doubtful, "{query:?}");
                }
            }
        }
    }
    assert!(ends > 3000, "only {ends} ends were tried");
}

#[test]
fn t_is_in_units_of_the_direction() {
    let model = Model::new("sphere", shapes::sphere(1.0).unwrap());
    let bvh = model.bvh();
    let mut tracer = bvh.tracer();
    let direction = DVec3::new(-0.6, -0.48, -0.64);
    for k in (-140..=140).step_by(10) {
        let length = 10f64.powi(k);
        let (o, d) = (-3.0 * direction, length * direction);
        let hit = |range: Result<Ray, RayError>| tracer_hit(&bvh, &range.unwrap());
        let t = hit(Ray::new(o, d)).unwrap();
        assert!((t * length - 2.0).abs() < 1e-14, "length 1e{k}: {t}");
        // The range is in the same units.
        assert_eq!(hit(Ray::with_range(o, d, 0.0, 1.9 / length)), None, "1e{k}");
        assert_eq!(hit(Ray::with_range(o, d, 1.9 / length, 2.1 / length)), Some(t), "1e{k}");
        let far = hit(Ray::with_range(o, d, 2.1 / length, f64::INFINITY)).unwrap();
        assert!((far * length - 4.0).abs() < 1e-14, "length 1e{k}: {far}");
        let all = Query::primary(Ray::with_range(o, d, 3.9 / length, 4.1 / length).unwrap());
        assert!(tracer.occluded(&all).occluded, "1e{k}");
    }
}

/// However far away a hit is and however short the direction, all queries find it, on every
/// kernel, for every direction that a ray accepts.
#[test]
fn all_queries_agree_for_the_shortest_directions() {
    let size = 1e69;
    let model = Model::new("sphere", shapes::sphere(size).unwrap());
    let bvh = model.bvh();
    for length in [1e-160, 1e-150, 1e-149, 1.0, 1e149] {
        let d = DVec3::new(0.0, 0.0, -length);
        let ray = Ray::new(size * DVec3::new(0.1, 0.2, 5.0), d);
        let Ok(ray) = ray else {
            assert_eq!(length, 1e-160, "refused");
            continue;
        };
        let query = Query::primary(ray);
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let expected = (5.0 - 0.95f64.sqrt()) * size / length;
            let (mut answers, mut occlusions, mut hits) = (Vec::new(), Vec::new(), Vec::new());
            for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                tracer.first_hits(&[query], coherence, &mut answers);
                let t = answers[0].hit.map(|hit| hit.t);
                let near = t.is_some_and(|t| (t / expected - 1.0).abs() < 1e-13);
                assert!(near, "{kernel}, {length:e}: {t:?}, not {expected:e}");
                tracer.occlusions(&[query], coherence, &mut occlusions);
                assert!(occlusions[0].occluded, "{kernel}, {length:e}");
            }
            let _ = tracer.all_hits(&query, &mut hits);
            assert_eq!(hits.len(), 2, "{kernel}, {length:e}");
        }
    }
}

fn tracer_hit(bvh: &SurfaceBvh, ray: &Ray) -> Option<f64> {
    let answer = bvh.tracer().first_hit(&Query::primary(*ray));
    assert!(!answer.doubtful, "{ray:?}");
    answer.hit.map(|hit| hit.t)
}

#[test]
fn negative_ranges_look_behind() {
    let surfaces = [shapes::sphere(1.0).unwrap()];
    let bvh = SurfaceBvh::build(&surfaces).unwrap();
    let ray = Ray::with_range(DVec3::new(0.1, 0.2, 0.3), DVec3::Y, -5.0, 0.0).unwrap();
    let t = tracer_hit(&bvh, &ray).unwrap();
    let expected = -0.2 - (1.0 - 0.01 - 0.09f64).sqrt();
    assert!((t - expected).abs() < 1e-15, "{t}, not {expected}");
}

#[test]
fn what_is_no_ray_is_refused() {
    let (o, d) = (DVec3::ONE, DVec3::X);
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for k in 0..3 {
            let (mut origin, mut direction) = (o, d);
            origin[k] = bad;
            direction[k] = bad;
            assert!(matches!(Ray::new(origin, d), Err(RayError::Origin(_))));
            assert!(matches!(Ray::new(o, direction), Err(RayError::Direction(_))));
        }
    }
    assert_eq!(Ray::new(o, DVec3::ZERO), Err(RayError::NoDirection));
    for (t_min, t_max) in [(1.0, 1.0), (2.0, 1.0), (f64::NAN, 1.0), (0.0, f64::NAN)] {
        assert!(matches!(Ray::with_range(o, d, t_min, t_max), Err(RayError::Range { .. })));
    }
}
