//! Rays that leave a hit beside a crease or a border: what is met right behind it is not the start.

use glam::{DAffine3, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
use nurbray::intersect::{Coherence, Kernel, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::random::Random;

/// A closed room between −1 and 1 whose four walls are one surface, which turns at right angles.
fn room() -> SurfaceBvh {
    let corners = [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]];
    let walls = corners.iter().flat_map(|&[x, y]| [-1.0, 1.0].map(|z| DVec3::new(x, y, z)));
    let [around, up] = [5, 2].map(|count| KnotVector::clamped_uniform(1, count).unwrap());
    let walls = NurbsSurface::new(around, up, walls.collect(), None).unwrap();
    let floor = shapes::plane(2.0, 2.0).unwrap();
    let [floor, ceiling] =
        [-1.0, 1.0].map(|z| floor.transformed(&DAffine3::from_translation(z * DVec3::Z)).unwrap());
    SurfaceBvh::build(&[walls, floor, ceiling]).unwrap()
}

/// Beside a crease, nearer than rounding moved the hit along a grazing ray that found it, a ray may
/// leave one face and meet the other at once. It does not get out of the room for all that.
#[test]
fn no_ray_gets_out_through_a_crease_that_it_starts_beside() {
    let bvh = room();
    for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
        let mut tracer = bvh.tracer_with(kernel);
        let mut random = Random::new(71);
        let (mut left, mut doubtful, mut onward) = (0, 0, Vec::new());
        for _ in 0..6000 {
            // To a point of the wall x = −1 beside the wall y = −1.
            let beside = random.power_of_ten(-15.0, -5.0);
            let target = DVec3::new(-1.0, beside - 1.0, random.between(-0.8, 0.8));
            let flat = random.power_of_ten(-10.0, 0.0);
            let way = DVec3::new(-flat, random.between(-0.3, 0.0), random.sign());
            let first = tracer.first_hit(&Ray::new(target - 0.1 * way, way).unwrap());
            let Some(hit) = first.hit.filter(|_| !first.doubtful) else { continue };
            if !(hit.point.x >= -1.0 && hit.point.y > -1.0) {
                continue;
            }
            // Back into the room, and into the wall y = −1.
            let [x, y] = [(); 2].map(|()| random.between(0.2, 1.2));
            let way = DVec3::new(x, -y, random.between(-1.0, 1.0));
            let query = Query::leaving(Ray::new(hit.point, way).unwrap(), &hit);
            let answer = tracer.first_hit(&query);
            let shadow = tracer.occluded(&query);
            let exact = tracer.exact_first_hit(&query);
            for (is_met, is_doubtful) in [
                (answer.hit.is_some(), answer.doubtful),
                (shadow.occluded, shadow.doubtful),
                (exact.hit.is_some(), exact.doubtful),
            ] {
                assert!(is_met || is_doubtful, "{kernel}: {query:?}");
            }
            // The wall is clear of rounding along this ray.
            let clear = hit.point.y + 1.0 > 1e-13;
            assert!(!clear || !answer.doubtful || flat < 1e-4, "{kernel}: {query:?}");
            left += 1;
            doubtful += u64::from(answer.doubtful);
            onward.push(query);
        }
        println!("{kernel}: {left} left a hit, {doubtful} of them in doubt");
        assert!(left > 3000 && doubtful < left / 4, "{left}, {doubtful}");
        for coherence in [Coherence::Coherent, Coherence::Incoherent] {
            let (mut answers, mut shadows) = (Vec::new(), Vec::new());
            tracer.first_hits(&onward, coherence, &mut answers);
            tracer.occlusions(&onward, coherence, &mut shadows);
            assert!(answers.iter().all(|answer| answer.hit.is_some() || answer.doubtful));
            assert!(shadows.iter().all(|shadow| shadow.occluded || shadow.doubtful));
        }
    }
}

/// A plate that ends a little before a wall: a ray that leaves the plate at its border meets the
/// wall behind the gap, however flat it leaves, unless the gap is as small as rounding.
#[test]
fn a_ray_that_leaves_a_border_meets_what_is_behind_a_gap() {
    let mut certain = 0;
    for gap in [1e-14, 1e-13, 1e-12, 4e-12, 1e-11, 4e-11, 1e-9, 1e-6] {
        let corner = |x: f64, z: f64| [0.0, 1.0].map(|y| DVec3::new(x, y, z));
        let flat = |from: [DVec3; 2], to: [DVec3; 2]| {
            let knots = || KnotVector::bezier(1).unwrap();
            NurbsSurface::new(knots(), knots(), [from, to].concat(), None).unwrap()
        };
        let plate = flat(corner(-1.0, 0.0), corner(0.0, 0.0));
        let wall = flat(corner(gap, -1.0), corner(gap, 0.0));
        // As if the wall were the edge's other face: met from the plate's other side.
        for wall in [wall.reversed_u(), wall] {
            let bvh = SurfaceBvh::build(&[plate.clone(), wall]).unwrap();
            for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
                let mut tracer = bvh.tracer_with(kernel);
                for flat in [1e-1, 1e-3, 1e-6] {
                    let target = DVec3::new(-1e-16, 0.4, 0.0);
                    let way = DVec3::new(0.0, 1.0, -flat);
                    let first = tracer.first_hit(&Ray::new(target - 0.3 * way, way).unwrap());
                    let Some(hit) = first.hit.filter(|_| !first.doubtful) else { continue };
                    for down in [1e-2, 1e-3, 3e-4, 1.5e-4] {
                        let way = DVec3::new(1.0, 0.0, -down);
                        let query = Query::leaving(Ray::new(hit.point, way).unwrap(), &hit);
                        let answer = tracer.first_hit(&query);
                        let is_met = answer.hit.is_some_and(|met| met.surface == 1);
                        assert!(is_met || answer.doubtful, "{kernel}, {gap:e}, {flat}: {query:?}");
                        certain += u32::from(!answer.doubtful);
                    }
                }
            }
        }
    }
    println!("{certain} of {} certain", 8 * 2 * 3 * 4 * Kernel::ALL.len());
    assert!(certain > 100, "{certain}");
}
