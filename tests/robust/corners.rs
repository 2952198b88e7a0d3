//! Corners in which more than one side ends in a point.

use glam::{DVec3, DVec4};
use nurbray::geometry::{KnotVector, NurbsSurface};
use nurbray::intersect::{HitFlags, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::random::Random;

/// Near the corner where two collapsed sides meet, each with normals of its own: beside one of
/// them, every place is near the other one, too.
#[test]
fn normals_beside_a_side_that_is_collapsed_as_is_the_one_across() {
    let knots = || KnotVector::clamped_uniform(2, 3).unwrap();
    let mut control = vec![DVec4::W; 9];
    control[4] = DVec4::new(1.0, 0.0, 0.0, 1.0);
    control[5] = DVec4::new(1.0, 1.0, 0.0, 1.0);
    control[7] = DVec4::new(0.0, 0.0, 1.0, 1.0);
    control[8] = DVec4::new(1.0, 1.0, 1.0, 1.0);
    let surface = NurbsSurface::from_homogeneous(knots(), knots(), control).unwrap();
    let bvh = SurfaceBvh::build(std::slice::from_ref(&surface)).unwrap();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(3);
    let mut seen = 0;
    for k in 0..2000 {
        let u = 10f64.powf(-9.0 + 3.0 * f64::from(k) / 2000.0);
        let v = 0.05 + 0.95 * random.unit();
        let (point, direction) = (surface.point_at(u, v), random.direction());
        let ray = Ray::new(point - direction, direction).unwrap();
        let answer = tracer.first_hit(&Query::primary(ray));
        let Some(hit) = answer.hit.filter(|hit| !answer.doubtful && hit.uv.y > 0.05) else {
            continue;
        };
        // S = 2 u c(v) + u² …, c in the plane z = 0: so is c', and the normal along z.
        if !hit.flags.contains(HitFlags::NO_NORMAL) {
            assert!(hit.normal.distance(DVec3::Z) < 100.0 * hit.uv.x + 1e-7, "{ray:?}: {hit:?}");
            seen += 1;
        }
    }
    assert!(seen > 1000, "{seen}");
}

/// A ray along a straight side, as near as f64 allows: no end of the stretch may be searched for
/// along the side, every point of which is as near.
#[test]
fn a_ray_along_a_side_does_not_slip_off_it() {
    let knots = || KnotVector::clamped_uniform(1, 2).unwrap();
    let corner = |x, y, z| DVec4::new(x, y, z, 1.0);
    let twice = corner(-0.3255442106369106, 0.2533737952144184, -1.3664575916015147);
    let control = vec![
        twice,
        corner(0.7775528003888408, 0.013355002760814914, 0.49213734857573455),
        corner(-0.5414762580095427, 0.6657905325766917, 1.1603737476646139),
        twice,
    ];
    let surface = NurbsSurface::from_homogeneous(knots(), knots(), control).unwrap();
    let bvh = SurfaceBvh::build(&[surface]).unwrap();
    let origin = DVec3::new(-0.4978496441329934, 0.5824664221630071, 0.6498562190687206);
    let direction = DVec3::new(-0.08404130760430094, 0.1605136537515085, 0.9834492491102427);
    let ray = Ray::new(origin, direction).unwrap();
    let answer = bvh.tracer().first_hit(&Query::primary(ray));
    assert!(answer.doubtful, "{answer:?}"); // the ray starts on the side
    assert!(answer.hit.is_some_and(|hit| hit.t <= 0.5192), "{answer:?}");
}
