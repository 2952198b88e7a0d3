//! Creases made by a row of control points repeated as often as the degree: across them the
//! surface stands still, though it goes on.

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface};
use nurbray::intersect::{Answer, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::random::Random;
use crate::ways::{all_ways, assert_met_or_doubted, kernels};

/// A roof along y whose ridge, at x = 0, is a parabola: `y = 3 v`, and there the height is
/// `1 + (y − 1.5)² / 5`. At x it is at most the `1 − |x| / 2`th part as high.
fn roof() -> NurbsSurface {
    // The parabola's control points as a cubic.
    let ridge = [1.45, 0.85, 0.85, 1.45];
    let rows =
        [(-2.0, 0.0), (-1.0, 0.2), (0.0, 1.0), (0.0, 1.0), (0.0, 1.0), (1.0, 0.2), (2.0, 0.0)];
    let row = |(x, part)| (0..4).map(move |j| DVec3::new(x, j as f64, part * ridge[j]));
    let points = rows.into_iter().flat_map(row).collect();
    let knots_u = KnotVector::clamped_uniform(3, 7).unwrap();
    NurbsSurface::new(knots_u, KnotVector::bezier(3).unwrap(), points, None).unwrap()
}

/// Rays over and under the ridge by any distance from 1e-12 on, about level.
fn beside_the_ridge(random: &mut Random, count: usize) -> Vec<(Query, f64)> {
    let mut ray = || {
        let y = random.between(0.2, 2.8);
        let above = random.power_of_ten(-12.0, -1.0) * random.sign();
        let on_ridge = DVec3::new(0.0, y, 1.0 + (y - 1.5).powi(2) / 5.0 + above);
        // Less steep than the roof, so that a ray over the ridge passes over all of it.
        let along = DVec3::new(1.0, random.between(-0.3, 0.3), random.between(-0.1, 0.1));
        (Query::primary(Ray::new(on_ridge - 4.0 * along, along).unwrap()), above)
    };
    (0..count).map(|_| ray()).collect()
}

/// Whether a ray so far above the ridge may be in doubt: rounding decides, or, under the ridge,
/// whether a root is proved where the surface all but stands still.
fn is_close(above: f64) -> bool {
    (-1e-5..1e-11).contains(&above)
}

/// Asserts that few of the rays are in doubt that pass under the ridge by more than rounding
/// (measured: less than 1 of 100).
fn assert_few_doubts(heights: &[f64], way: &[Answer]) {
    let under = heights.iter().zip(way).filter(|&(above, _)| (-1e-5..-1e-11).contains(above));
    let (doubtful, others): (Vec<_>, Vec<_>) = under.partition(|(_, answer)| answer.doubtful);
    assert!(30 * doubtful.len() < others.len(), "{} and {}", doubtful.len(), others.len());
}

#[test]
fn rays_over_a_ridge_miss_and_rays_under_it_hit() {
    let bvh = SurfaceBvh::build(&[roof()]).unwrap();
    let (queries, heights): (Vec<_>, Vec<_>) =
        beside_the_ridge(&mut Random::new(48), 1000).into_iter().unzip();
    for kernel in kernels() {
        let (answers, occlusions) = all_ways(&bvh, kernel, &queries);
        for way in answers {
            assert_few_doubts(&heights, &way);
            for (&above, answer) in heights.iter().zip(way) {
                let right = answer.hit.is_some() == (above < 0.0);
                assert!(answer.doubtful || right, "{kernel}: {above:e} {answer:?}");
                assert!(!answer.doubtful || is_close(above), "{kernel}: {above:e} {answer:?}");
            }
        }
        for way in occlusions {
            for (&above, answer) in heights.iter().zip(way) {
                assert!(answer.doubtful || answer.occluded == (above < 0.0), "{kernel}: {above:e}");
                assert!(!answer.doubtful || is_close(above), "{kernel}: {above:e}");
            }
        }
    }
}

/// Rays from near and far to places of the roof, many of them next to the ridge or on borders: none
/// is a certain miss. Rounding of the rays is far less than what a border may be off by.
#[test]
fn no_place_of_a_roof_is_missed() {
    let mut random = Random::new(49);
    for size in [1.0, 1e-9] {
        let size_map = DAffine3::from_scale(DVec3::splat(size));
        let roof = roof().transformed(&(DAffine3::from_translation(DVec3::ONE) * size_map));
        let roof = roof.unwrap();
        let mut aimed = |k: usize| {
            let beside = 0.5 * random.power_of_ten(-9.0, 0.0) * random.sign();
            let u = [0.5 + beside, random.unit(), 1.0][k % 3];
            let v = [random.unit(), 1.0][k % 2];
            let distance = size * random.power_of_ten(0.0, 3.0);
            let back = distance * random.direction();
            let point = roof.point_at(DVec2::new(u, v));
            Query::primary(Ray::new(point + back, -back).unwrap())
        };
        let queries: Vec<_> = (0..600).map(&mut aimed).collect();
        let bvh = SurfaceBvh::build(std::slice::from_ref(&roof)).unwrap();
        assert_met_or_doubted(&format!("a roof of size {size:e}"), &bvh, &queries);
    }
}
