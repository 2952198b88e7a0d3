//! All hits of rays through closed bodies: as many in as out, or in doubt.

use glam::{DVec2, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
use nurbray::intersect::{Query, SurfaceBvh, Tracer};
use nurbray::math::Ray;

use crate::random::Random;

/// The number of hits, and whether there is doubt.
fn crossings(tracer: &mut Tracer<'_>, ray: Ray) -> (usize, bool) {
    let mut hits = Vec::new();
    let doubtful = tracer.all_hits(&Query::primary(ray), &mut hits);
    (hits.len(), doubtful)
}

/// On a body that was stretched so far that its tangents are nearly parallel, parameters of one
/// root differ by more, from leaf to leaf, than rounding moves its point.
#[test]
fn a_root_of_a_needle_is_one_crossing() {
    for (k, stretch) in [1e3, 1e4, 1e5, 1e6].into_iter().enumerate() {
        let scale = DVec3::new(stretch, 1.0, 1.0);
        let sphere = shapes::sphere(1.0).unwrap();
        let needle = sphere.transformed(&glam::DAffine3::from_scale(scale)).unwrap();
        let bvh = SurfaceBvh::build(&[needle]).unwrap();
        let mut tracer = bvh.tracer();
        let mut random = Random::new(k as u64);
        let mut doubted = 0;
        for _ in 0..3000 {
            let target = 0.9 * random.unit() * random.direction() * scale;
            let origin = 3.0 * stretch * random.direction();
            let ray = Ray::new(origin, target - origin).unwrap();
            let (count, doubtful) = crossings(&mut tracer, ray);
            assert!(doubtful || count == 2, "stretched by {stretch}: {ray:?}: {count}");
            doubted += u32::from(doubtful);
        }
        assert!(doubted <= 3, "stretched by {stretch}: {doubted}");
    }
}

/// Two faces meet along a straight edge. A ray nearly along it is within rounding of both over a
/// long way: the place where it meets either is uncertain by that length.
#[test]
fn a_ray_nearly_along_an_edge_passes_it_once() {
    let knots = || KnotVector::bezier(1).unwrap();
    let face = |turn: fn(DVec3) -> DVec3| {
        let corners = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)];
        let points = corners.map(|(x, y)| turn(DVec3::new(x, y, 1.0))).to_vec();
        NurbsSurface::new(knots(), knots(), points, None).unwrap()
    };
    let cube = [
        face(|p| p),
        face(|p| DVec3::new(p.y, p.z, p.x)),
        face(|p| DVec3::new(p.z, p.x, p.y)),
        face(|p| DVec3::new(p.y, p.x, -p.z)),
        face(|p| DVec3::new(p.x, -p.z, p.y)),
        face(|p| DVec3::new(-p.z, p.y, p.x)),
    ];
    let bvh = SurfaceBvh::build(&cube).unwrap();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(8);
    for power in 6..14 {
        let mut doubted = 0;
        for _ in 0..1000 {
            let (turned, away) = (DVec2::from_angle(random.between(0.0, 7.0)), 10f64.powi(-power));
            let edge = DVec3::new(random.sign(), random.sign(), random.between(-1.0, 1.0));
            let along = DVec3::new(away * turned.x, away * turned.y, random.sign());
            let axis = random.below(3);
            let turn = |v: DVec3| [v, DVec3::new(v.y, v.z, v.x), DVec3::new(v.z, v.x, v.y)][axis];
            let (edge, along) = (turn(edge), turn(along));
            let ray = Ray::new(edge - random.between(3.0, 10.0) * along, along).unwrap();
            let (count, doubtful) = crossings(&mut tracer, ray);
            assert!(doubtful || count == 2, "10^-{power}: {ray:?}: {count}");
            doubted += u32::from(doubtful);
        }
        // At the smaller angles nearly all of them are in doubt, and rightly.
        assert!(doubted < [100, 900, 1001][(power > 10) as usize + (power > 11) as usize]);
    }
}
