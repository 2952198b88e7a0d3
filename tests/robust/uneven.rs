//! Knots and weights that differ by many powers of ten: a point with next to no share may count
//! more than all others, if it is far heavier.

use glam::{DVec2, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface};
use nurbray::intersect::Query;
use nurbray::math::Ray;
use nurbray::math::rounding::residual_factor;

use crate::model::Model;
use crate::random::Random;
use crate::ways::{all_ways, assert_met_or_doubted, kernels};

/// A clamped knot vector whose spans have these lengths.
fn clamped(degree: usize, lengths: &[f64]) -> KnotVector {
    let mut values = vec![0.0; degree + 1];
    let mut at = 0.0;
    for length in lengths {
        at += length;
        values.push(at);
    }
    values.extend(std::iter::repeat_n(at, degree));
    KnotVector::new(degree, values).unwrap()
}

/// A gently curved sheet over `[−1, 1]²` with these weights.
fn sheet(
    name: String,
    [u, v]: [KnotVector; 2],
    weight: &mut impl FnMut([usize; 2]) -> f64,
) -> Model {
    let counts = [u.point_count(), v.point_count()];
    let place = |k: usize, count: usize| 2.0 * k as f64 / (count - 1) as f64 - 1.0;
    let (mut points, mut weights) = (Vec::new(), Vec::new());
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let (x, y) = (place(i, counts[0]), place(j, counts[1]));
            points.push(DVec3::new(x, y, 0.3 * (2.0 * x).sin() * (1.5 * y).cos()));
            weights.push(weight([i, j]));
        }
    }
    Model::new(name, NurbsSurface::new(u, v, points, Some(weights)).unwrap())
}

/// Rays from above through points of the sheet.
fn aimed(model: &Model, random: &mut Random, places: &[[f64; 2]]) -> Vec<Query> {
    let surface = model.surfaces[0].nurbs().unwrap();
    let through = |&[u, v]: &[f64; 2]| {
        let point = surface.point_at(DVec2::new(u, v));
        let side = DVec3::new(random.between(-0.7, 0.7), random.between(-0.7, 0.7), 1.0);
        Query::primary(Ray::new(point + 2.0 * side, -side).unwrap())
    };
    places.iter().map(through).collect()
}

/// Asserts that all rays meet the sheet, at the points they are aimed at or before, and not where
/// the sheet is not.
fn assert_met(model: &Model, queries: &[Query]) {
    let bvh = model.bvh();
    assert_met_or_doubted(&model.name, &bvh, queries);
    let surface = model.surfaces[0].nurbs().unwrap();
    let [p, q] = [surface.knots_u().degree(), surface.knots_v().degree()];
    for kernel in kernels() {
        let (answers, _) = all_ways(&bvh, kernel, queries);
        for (query, answer) in answers.iter().flat_map(|way| queries.iter().zip(way)) {
            let Some(hit) = answer.hit.filter(|_| !answer.doubtful) else { continue };
            let ray = query.ray();
            let magnitude = ray.origin().abs().max_element().max(1.0);
            // The error bound of both along the ray.
            let off =
                2.0 * residual_factor(p, q) * magnitude / hit.normal.dot(ray.direction()).abs();
            assert!(hit.t <= 2.0 + off, "{}, {kernel}: {ray:?} {hit:?}", model.name);
            let nearby = hit.t > 2.0 - 1e-6;
            assert!(!nearby || hit.t >= 2.0 - off, "{}, {kernel}: {ray:?} {hit:?}", model.name);
        }
    }
}

/// One of two spans is next to nothing, and the points that govern the other are heavy.
#[test]
fn short_spans_beside_heavy_points() {
    let mut random = Random::new(91);
    for degree in [2, 3, 5, 8] {
        for short in [1e-6, 1e-4, 1e-2] {
            for heavy in [1e2, 1e4, 1e6] {
                let knots = [clamped(degree, &[1.0, short]), KnotVector::bezier(1).unwrap()];
                let rows = knots[0].point_count();
                let name = format!("degree {degree}, a span of {short:e}, weights of {heavy:e}");
                let model = sheet(name, knots, &mut |[i, _]| {
                    if i < rows / 2 { heavy } else { 1.0 }
                });
                let places: Vec<[f64; 2]> = (0..60)
                    .map(|k| {
                        let u = if k % 4 == 3 { 1.0 } else { 1.0 + short * random.unit() };
                        [u, [0.0, 1.0, random.unit()][k % 3]]
                    })
                    .collect();
                let queries = aimed(&model, &mut random, &places);
                assert_met(&model, &queries);
            }
        }
    }
}

/// Dense sheets, whose pieces compute their nets from the control points that govern them.
#[test]
fn dense_sheets_of_long_and_short_spans() {
    let mut random = Random::new(92);
    for (degrees, short, reach) in [
        ([3, 3], 1e-3, 2.0),
        ([3, 3], 1e-6, 0.0),
        ([2, 3], 1e-4, 1.0),
        ([3, 3], 0.1, 3.0),
        ([5, 4], 1e-3, 1.0),
        ([7, 5], 1e-2, 0.5),
        ([6, 2], 1e-5, 0.0),
    ] {
        let knots = degrees.map(|degree| {
            let lengths: Vec<f64> =
                (0..36).map(|_| if random.below(3) == 0 { short } else { 1.0 }).collect();
            clamped(degree, &lengths)
        });
        let name = format!("{degrees:?}, spans of {short:e}, weights to 1e±{reach}");
        let ends = knots.each_ref().map(|knots| knots.domain()[1]);
        let inner = knots.each_ref().map(|knots| knots.values().to_vec());
        let mut weights = Random::new(93);
        let model = sheet(name, knots, &mut |_| weights.power_of_ten(-reach, reach));
        let places: Vec<[f64; 2]> = (0..400)
            .map(|k| {
                let mut place = [0, 1].map(|d| ends[d] * random.unit());
                if k % 2 == 0 {
                    // In a short span, or at a knot.
                    let (d, at) = (k / 2 % 2, random.below(inner[k / 2 % 2].len() - 1));
                    let [from, to] = [inner[d][at], inner[d][at + 1]];
                    place[d] = from + (to - from) * [0.0, random.unit()][k / 4 % 2];
                }
                place
            })
            .collect();
        let queries = aimed(&model, &mut random, &places);
        assert_met(&model, &queries);
    }
}

/// Between a long span and two short ones, a middle control point has next to no share in a piece.
/// A heavy one counts all the same, but differences from it have lost their digits.
#[test]
fn heavy_points_of_small_shares_in_dense_sheets() {
    let mut random = Random::new(94);
    for (degrees, short, heavy) in [([3, 3], 1e-4, 1e4), ([3, 2], 1e-3, 1e3), ([5, 4], 1e-2, 1e3)] {
        let lengths: Vec<f64> = (0..48).map(|k| if k % 3 == 0 { 1.0 } else { short }).collect();
        let knots = degrees.map(|degree| clamped(degree, &lengths));
        let values = knots[0].values().to_vec();
        let end = knots[1].domain()[1];
        let name = format!("{degrees:?}, spans of {short:e}, rows of {heavy:e}");
        let model = sheet(name, knots, &mut |[i, _]| if i % 11 == 5 { heavy } else { 1.0 });
        let places: Vec<[f64; 2]> = (0..600)
            .map(|_| {
                let at = degrees[0] + random.below(48);
                let u = values[at] + (values[at + 1] - values[at]) * random.unit();
                [u, end * random.unit()]
            })
            .collect();
        let queries = aimed(&model, &mut random, &places);
        assert_met(&model, &queries);
    }
}
