//! Origins so far away that the error bound of a point exceeds the resolution of f32.

use glam::{DVec2, DVec3, DVec4};
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
use nurbray::geometry::{KnotVector, NurbsSurface, TrimmedSurface, shapes};
use nurbray::intersect::{Answer, Occlusion, Query};
use nurbray::math::Ray;

use crate::model::Model;
use crate::models;
use crate::random::Random;
use crate::ways::{all_ways, assert_met_or_doubted, kernels};

/// Rays through a border of a square, or past it by less than the error bound of a point; all
/// numbers are exact, and so is `o + t d`.
#[test]
fn borders_are_met_or_doubted_from_anywhere() {
    let model = Model::new("square", shapes::plane(2.0, 2.0).unwrap());
    let rays = [
        ([103079215105.0, 34359738367.648438, 154618822656.0], [-6.0, -2.0, -9.0]),
        ([137438953473.0, -412316860416.9375, 618475290624.0], [-2.0, 6.0, -9.0]),
        ([-4294967294.999983, 3221225472.9375, 12884901888.0], [4.0, -3.0, -12.0]),
        ([-536870913.0000105, -2147483648.1446114, 4294967296.0], [1.0, 4.0, -8.0]),
        // Through the middle.
        ([10133099161583616.0, -6755399441055744.0, -2251799813685248.0], [-9.0, 6.0, 2.0]),
    ];
    let far = rays.map(|(o, d)| Ray::new(o.into(), d.into()).unwrap());
    // Each is also traced in a batch with rays that come from nearby.
    let near = (0..20).map(|k| Ray::new(DVec3::new(0.1 * f64::from(k), 0.2, 3.0), DVec3::NEG_Z));
    let mut queries: Vec<Query> = near.map(|ray| Query::primary(ray.unwrap())).collect();
    for (k, ray) in far.into_iter().enumerate() {
        queries.insert(4 * k, Query::primary(ray));
    }
    // And with rays that f32 cannot represent; these pass far away.
    for (k, axis) in [DVec3::X, DVec3::NEG_Y, DVec3::Z].into_iter().enumerate() {
        let ray = Ray::new(1e150 * axis + DVec3::splat(1e100), axis).unwrap();
        queries.insert(9 * k, Query::primary(ray));
    }
    let meets = |query: &Query| {
        let (o, d) = (query.ray().origin(), query.ray().direction());
        o.abs().max_element() < 1e100 && (d != DVec3::NEG_Z || o.x <= 1.0)
    };
    let bvh = model.bvh();
    for kernel in kernels() {
        let (answers, occlusions) = all_ways(&bvh, kernel, &queries);
        for (way, answers) in answers.iter().enumerate() {
            for (query, answer) in queries.iter().zip(answers) {
                let hit_or_doubt = answer.hit.is_some() || answer.doubtful;
                assert_eq!(hit_or_doubt, meets(query), "{kernel}, way {way}: {:?}", query.ray());
            }
        }
        for (way, occlusions) in occlusions.iter().enumerate() {
            for (query, occlusion) in queries.iter().zip(occlusions) {
                let hit_or_doubt = occlusion.occluded || occlusion.doubtful;
                assert_eq!(hit_or_doubt, meets(query), "{kernel}, way {way}: {:?}", query.ray());
            }
        }
    }
}

/// Rays past a border along which they touch the surface, where its continuation would bend away:
/// they meet it at up to half of the error bound of a point.
#[test]
fn borders_that_are_silhouettes_are_met_or_doubted() {
    let (high, half) = (1.0, std::f64::consts::FRAC_1_SQRT_2);
    let arc = [(1.0, 0.0, 1.0), (half, half, half), (0.0, 1.0, 1.0)];
    let control = arc.iter().flat_map(|&(x, z, w)| [0.0, high].map(|y| DVec4::new(x, w * y, z, w)));
    let knots = |degree| KnotVector::bezier(degree).unwrap();
    let quarter = NurbsSurface::from_homogeneous(knots(2), knots(1), control.collect()).unwrap();
    for (name, surface) in [("quarter", quarter), ("hemisphere", shapes::hemisphere(1.0).unwrap())]
    {
        let [p, q] = [surface.knots_u().degree(), surface.knots_v().degree()];
        // Half of the promise, which is `4 (p + q + 4)` half units.
        let most = p + q + 4;
        let model = Model::new(name, surface);
        let beside = |k: usize| 1.0 + k as f64 * f64::EPSILON;
        let queries: Vec<Query> = (0..most)
            .flat_map(|k| [-1.0, 1.0].map(|z| (k, z)))
            .map(|(k, z)| {
                let along_y = if name == "quarter" { 0.375 } else { 0.0 };
                let from = DVec3::new(beside(k), along_y, 0.75 * z);
                Query::primary(Ray::new(from, -z * DVec3::Z).unwrap())
            })
            .collect();
        assert_met_or_doubted(name, &model.bvh(), &queries);
    }
}

/// Many small boxes side by side, met at steep angles: those of a sheet of 8 × 8 pieces, whose
/// border the rays pass by less than the error bound of a point.
#[test]
fn boxes_are_met_as_far_off_as_points_may_be() {
    let knots = || KnotVector::clamped_uniform(1, 9).unwrap();
    let at = |k: usize| k as f64 / 4.0 - 1.0;
    let net = (0..81).map(|k| DVec3::new(at(k / 9), at(k % 9), 0.0)).collect();
    let model = Model::new("sheet", NurbsSurface::new(knots(), knots(), net, None).unwrap());
    let bvh = model.bvh();
    let top = 2f64.powi(29);
    let direction = DVec3::new(2f64.powi(-10), 0.0, -1.0);
    let rays = [1e-7, 6e-7, 8e-7, 1e-6, 1.1e-6, 1.2e-6, 1.3e-6].map(|beyond| {
        let origin = DVec3::new(1.0 + beyond - top * direction.x, 0.1, top);
        Query::primary(Ray::new(origin, direction).unwrap())
    });
    for kernel in kernels() {
        for query in &rays {
            let (answers, occlusions) = all_ways(&bvh, kernel, &[*query]);
            let met = |answer: &Answer| answer.hit.is_some() || answer.doubtful;
            assert!(answers.iter().flatten().all(met), "{kernel}: {:?}", query.ray());
            let met = |occlusion: &Occlusion| occlusion.occluded || occlusion.doubtful;
            assert!(occlusions.iter().flatten().all(met), "{kernel}: {:?}", query.ray());
        }
    }
}

/// At a body from 1 to 1e14 of its sizes away: the kernels agree, or doubt.
#[test]
fn kernels_agree_from_anywhere() {
    for model in [models::sphere(), models::teapot()] {
        let bvh = model.bvh();
        let (low, high) = bvh.bounds().unwrap();
        let (middle, size) = (0.5 * (low + high), low.distance(high));
        let mut random = Random::new(71);
        let mut queries = Vec::new();
        for k in 0..300 {
            let origin = middle + size * 10f64.powf(f64::from(k) / 21.0) * random.direction();
            let target =
                low + (high - low) * DVec3::new(random.unit(), random.unit(), random.unit());
            queries.push(Query::primary(Ray::new(origin, target - origin).unwrap()));
        }
        let truth: Vec<Answer> =
            queries.iter().map(|query| bvh.tracer().exact_first_hit(query)).collect();
        let certain = truth.iter().filter(|answer| !answer.doubtful).count();
        assert!(certain > 200, "{certain}");
        for kernel in kernels() {
            for answers in all_ways(&bvh, kernel, &queries).0 {
                for ((query, answer), truth) in queries.iter().zip(&answers).zip(&truth) {
                    let decided = !answer.doubtful && !truth.doubtful;
                    let same = answer.hit.is_some() == truth.hit.is_some();
                    assert!(!decided || same, "{kernel}: {:?}", query.ray());
                }
            }
        }
    }
}

/// A sheet far from the origin, and rays from farther away that pass its border by less than the
/// error bound of points there, which exceeds the resolution of f32 for so small a sheet.
#[test]
fn small_things_far_from_the_origin_are_met_as_far_off_as_points_may_be() {
    for distance in [1e8, 1e9, 1e10, 1e11, 1e12] {
        let knots = || KnotVector::clamped_uniform(1, 2).unwrap();
        let at = |x: f64, y: f64| DVec3::new(distance + x, y, 0.0);
        let net = vec![at(-0.5, -0.5), at(-0.5, 0.5), at(0.5, -0.5), at(0.5, 0.5)];
        let model = Model::new("sheet", NurbsSurface::new(knots(), knots(), net, None).unwrap());
        for from in [0.9, 1.1, 1.9, 2.1, 9.0] {
            // Four times the sum of the degrees and four, in units of rounding.
            let off = 24.0 * 0.5 * f64::EPSILON * distance * f64::max(from, 1.0);
            let rays = [0.1, 0.5, 0.8, 0.95].map(|part| {
                let origin = DVec3::new(distance, 0.5 + part * off, from * distance);
                Query::primary(Ray::new(origin, -DVec3::Z).unwrap())
            });
            let bvh = model.bvh();
            for kernel in kernels() {
                let (answers, occlusions) = all_ways(&bvh, kernel, &rays);
                let met = |answer: &Answer| answer.hit.is_some() || answer.doubtful;
                assert!(answers.iter().flatten().all(met), "{kernel}: {distance:e}, {from}");
                let met = |occlusion: &Occlusion| occlusion.occluded || occlusion.doubtful;
                assert!(occlusions.iter().flatten().all(met), "{kernel}: {distance:e}, {from}");
            }
        }
    }
}

/// The same for a hilly sheet of many leaves, where a leaf goes on straight for less than the error
/// bound of points.
#[test]
fn borders_far_from_the_origin_are_met_or_doubted() {
    let knots = || KnotVector::clamped_uniform(3, 11).unwrap();
    let mut random = Random::new(83);
    let heights: Vec<f64> = (0..121).map(|_| 0.4 * random.unit()).collect();
    for distance in [1e9, 1e10, 1e11, 1e12, 1e13] {
        let far = DVec3::new(0.0, distance, 0.0);
        let at = |k: usize| 0.2 * k as f64 - 1.0;
        let net = (0..121).map(|k| far + DVec3::new(at(k / 11), at(k % 11), heights[k])).collect();
        let model = Model::new("hills", NurbsSurface::new(knots(), knots(), net, None).unwrap());
        // Four times the sum of the degrees and four, in units of rounding.
        let off = 40.0 * 0.5 * f64::EPSILON * distance;
        let rays: Vec<Query> = (0..400)
            .map(|k| {
                let (part, along) = (random.unit(), 2.0 * random.unit() - 1.0);
                let side = if k % 2 == 0 { 1.0 } else { -1.0 };
                let origin = far + DVec3::new(side * (1.0 + part * off), along, 5.0);
                Query::primary(Ray::new(origin, -DVec3::Z).unwrap())
            })
            .collect();
        assert_met_or_doubted(&format!("{distance:e}"), &model.bvh(), &rays);
    }
}

/// Rational surfaces so far away, with weights so different, that their boxes are soon within
/// rounding: a crossing within the range must not be taken for one outside it.
#[test]
fn crossings_far_from_the_origin_are_met_or_doubted_in_every_range() {
    let mut random = Random::new(97);
    let knots = || KnotVector::bezier(2).unwrap();
    for distance in [1e11, 3e11, 1e12, 2e12] {
        for _ in 0..60 {
            let far = distance * random.direction();
            let at = |k: usize, random: &mut Random| {
                let place = DVec3::new((k / 3) as f64, (k % 3) as f64, 0.0);
                far + place + 0.5 * random.direction()
            };
            let net = (0..9).map(|k| at(k, &mut random)).collect();
            let weights = (0..9).map(|_| 10f64.powf(6.0 * random.unit() - 3.0)).collect();
            let surface = NurbsSurface::new(knots(), knots(), net, Some(weights)).unwrap();
            // Four times the sum of the degrees and four, in units of rounding.
            let error = 32.0 * 0.5 * f64::EPSILON * distance;
            let rays: Vec<Query> = (0..40)
                .filter_map(|_| {
                    let (u, v) = (0.01 + 0.98 * random.unit(), 0.01 + 0.98 * random.unit());
                    let (point, direction) =
                        (surface.point_at(DVec2::new(u, v)), random.direction());
                    let cosine = surface.normal(DVec2::new(u, v))?.dot(direction).abs();
                    let reach = error / cosine;
                    let t = reach * (4.0 + 36.0 * random.unit());
                    let ends = [random.unit(), random.unit()].map(|x| reach * (4.0 + 16.0 * x));
                    let t_min = if random.unit() < 0.5 { 0.0 } else { (t - ends[0]).max(0.0) };
                    let origin = point - t * direction;
                    let ray = Ray::with_range(origin, direction, t_min, t + ends[1]).unwrap();
                    (cosine > 0.1).then_some(Query::primary(ray))
                })
                .collect();
            let model = Model::new("far", surface);
            assert_met_or_doubted(&format!("{distance:e}"), &model.bvh(), &rays);
        }
    }
}

/// Rays that start in a plane far from the origin, or within the error bound of points from it, and
/// pass its border on their way by less than half of that bound.
#[test]
fn rays_within_a_plane_far_from_the_origin_meet_its_border_or_are_doubted() {
    let mut random = Random::new(101);
    for distance in [1e8, 1e9, 1e10, 1e11] {
        let far = distance * DVec3::new(1.0, -2.0, 0.25);
        let corners = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.5], [1.0, 0.0, 0.25], [1.0, 1.0, 0.75]];
        let corners = corners.map(DVec3::from_array);
        let knots = || KnotVector::bezier(1).unwrap();
        // These sums are exact, and so are the differences that undo them.
        let net = corners.map(|corner| far + corner).to_vec();
        let plane = NurbsSurface::new(knots(), knots(), net, None).unwrap();
        let error = 24.0 * 0.5 * f64::EPSILON * 2.0 * distance;
        let normal = (corners[2] - corners[0]).cross(corners[1] - corners[0]).normalize();
        let borders = [[0, 1], [2, 3], [0, 2], [1, 3]].map(|side| side.map(|k| corners[k]));
        let rays: Vec<Query> = (0..1000)
            .filter_map(|_| {
                let inside = random.unit() * corners[1] + random.unit() * corners[2];
                let along = random.perpendicular(normal);
                let slope = random.sign() * (error * random.power_of_ten(-5.0, 1.0)).min(0.3);
                let direction = along + slope * normal;
                let origin = far + inside + error * random.between(-0.6, 0.6) * normal;
                let passed = |side: &[DVec3; 2]| {
                    let (t, off) = passes(origin - far, direction, *side);
                    t > 0.01 && off < 0.5 * error
                };
                let ray = Ray::new(origin, direction).unwrap();
                borders.iter().any(passed).then_some(Query::primary(ray))
            })
            .collect();
        assert!(rays.len() > 100, "{distance:e}: {} rays", rays.len());
        // Also with a hole that is far from all borders.
        let hole = TrimLoop::circle(DVec2::splat(0.5), 0.02).unwrap();
        let domain = TrimDomain::with_seams_of(&plane).unwrap();
        let trims = Trims::new(domain, Kept::Even, &[hole]).unwrap();
        let trimmed = TrimmedSurface::new(plane.clone(), trims).unwrap();
        for (name, model) in
            [("whole", Model::new("plane", plane)), ("with a hole", Model::new("plane", trimmed))]
        {
            assert_met_or_doubted(&format!("{distance:e}, {name}"), &model.bvh(), &rays);
        }
    }
}

/// Where along its direction a line comes nearest to a segment, and how near.
fn passes(origin: DVec3, direction: DVec3, [from, to]: [DVec3; 2]) -> (f64, f64) {
    let (unit, side, w) = (direction.normalize(), to - from, from - origin);
    let across = side - side.dot(unit) * unit;
    let off = w - w.dot(unit) * unit;
    let part = (-off.dot(across) / across.length_squared()).clamp(0.0, 1.0);
    let nearest = w + part * side;
    let t = nearest.dot(unit);
    (t, (nearest - t * unit).length())
}
