//! Corners in which more than one side ends in a point.

use glam::{DVec2, DVec3, DVec4};
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
        let (point, direction) = (surface.point_at(DVec2::new(u, v)), random.direction());
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

/// How many of these rays past a corner of a closed body, from its outside, have an odd number of
/// hits without doubt, and how many are in doubt. A ray misses the corner by up to ten `off` along
/// each axis.
fn counted_at(corner: DVec3, faces: &[NurbsSurface], off: f64, rays: u32) -> [u32; 2] {
    let bvh = SurfaceBvh::build(faces).unwrap();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(5);
    let (mut odd, mut doubted, mut hits) = (0, 0, Vec::new());
    for _ in 0..rays {
        let direction = random.direction();
        let missed = off * 10f64.powf(2.0 * random.unit() - 1.0) * random.direction();
        let origin = corner - 8.0 * direction + missed;
        let ray = Ray::new(origin, corner + missed - origin).unwrap();
        let doubtful = tracer.all_hits(&Query::primary(ray), &mut hits);
        doubted += u32::from(doubtful);
        odd += u32::from(!doubtful && hits.len() % 2 == 1);
    }
    [odd, doubted]
}

fn face(degree: [usize; 2], points: Vec<DVec3>) -> NurbsSurface {
    let [u, v] = degree.map(|degree| KnotVector::bezier(degree).unwrap());
    NurbsSurface::new(u, v, points, None).unwrap()
}

/// Flat triangles as bilinear patches, each with its pole at its first corner: rays beside a vertex
/// where three or four of them end in poles. A pole is met from farther away than a side.
#[test]
fn bodies_whose_faces_end_in_poles_at_a_vertex() {
    let [o, x, y, z] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z];
    let triangle = |a, b, c| face([1, 1], vec![a, a, b, c]);
    let tetrahedron = [triangle(o, y, x), triangle(o, z, y), triangle(o, x, z), triangle(z, x, y)];
    let ring = [x, y, -x, -y, x];
    let octahedron: Vec<NurbsSurface> = ring
        .windows(2)
        .flat_map(|side| [triangle(z, side[0], side[1]), triangle(-z, side[1], side[0])])
        .collect();
    for off in [3e-15, 1e-14] {
        for (corner, faces) in [(o, &tetrahedron[..]), (z, &octahedron)] {
            let [odd, doubted] = counted_at(corner, faces, off, 20_000);
            assert_eq!(odd, 0, "{corner}: {doubted} in doubt");
        }
    }
}

/// Triangles over and under a star whose rim goes up and down. Beside a corner of the rim, faces
/// are met from a little outside of two edges, and of one of these only one is near enough to be
/// taken for what the ray goes through.
#[test]
fn rays_past_the_rim_of_a_star_enter_as_often_as_they_leave() {
    let rim = |k: usize| {
        let (radius, z) = [(1.0, 0.0), (0.4, 0.3)][k % 2];
        let (y, x) = (std::f64::consts::PI * k as f64 / 5.0).sin_cos();
        DVec3::new(radius * x, radius * y, z)
    };
    let triangle = |a, b, c| face([1, 1], vec![a, a, b, c]);
    let pair = |k: usize| {
        let [from, to] = [rim(k), rim((k + 1) % 10)];
        [triangle(DVec3::Z, from, to), triangle(DVec3::NEG_Z, to, from)]
    };
    let faces: Vec<NurbsSurface> = (0..10).flat_map(pair).collect();
    for k in 0..4 {
        let [odd, doubted] = counted_at(rim(k), &faces, 6e-14, 40_000);
        assert!(odd == 0 && doubted < 10_000, "{k}: {odd} odd, {doubted} in doubt");
    }
    let [odd, doubted] = counted_at(rim(0), &faces, 1e-9, 40_000);
    assert!(odd == 0 && doubted < 1000, "{odd} odd, {doubted} in doubt");
}

/// A cube, of whose faces some start from a corner with tangents that vanish, as with parameters
/// `s²`: there the tangents do not tell what directions the face covers.
#[test]
fn cubes_with_sides_that_stand_still_at_a_corner() {
    let (straight, still) = (&[0.0, 1.0][..], &[0.0, 0.0, 1.0][..]);
    let side = |axis: usize, end: f64, [along_u, along_v]: [&[f64]; 2]| {
        let at = |&u: &f64, &v: &f64| {
            let mut point = DVec3::ZERO;
            (point[axis], point[(axis + 1) % 3], point[(axis + 2) % 3]) = (end, u, v);
            point
        };
        let degrees = [along_u.len() - 1, along_v.len() - 1];
        let points = along_u.iter().flat_map(|u| along_v.iter().map(move |v| at(u, v)));
        let outward = face(degrees, points.collect());
        if end == 0.0 { outward.swapped() } else { outward }
    };
    for stopping in [&[0][..], &[0, 1], &[0, 1, 2]] {
        let faces = (0..3).flat_map(|axis| {
            let ways = if stopping.contains(&axis) { still } else { straight };
            [side(axis, 0.0, [ways, ways]), side(axis, 1.0, [straight, straight])]
        });
        let faces: Vec<NurbsSurface> = faces.collect();
        for off in [0.0, 3e-16, 3e-15, 1e-14] {
            let [odd, doubted] = counted_at(DVec3::ZERO, &faces, off, 20_000);
            assert_eq!(odd, 0, "{stopping:?}, {off}: {doubted} in doubt");
        }
    }
}

/// The normal where two collapsed sides meet, not at the corner but a little beside it, is known
/// from the poles: the limit at the corner itself is not near enough.
#[test]
fn normals_beside_a_corner_of_two_collapsed_sides() {
    let (a, b) = (DVec3::new(0.3, 0.1, 1.0), DVec3::new(1.0, 0.2, 0.1));
    let (c, d) = (DVec3::new(0.1, 1.0, 0.2), DVec3::new(1.0, 1.0, 0.4));
    let mut points = vec![DVec3::ZERO; 9];
    (points[4], points[5], points[7], points[8]) = (a, b, c, d);
    let surface = face([2, 2], points);
    let bvh = SurfaceBvh::build(std::slice::from_ref(&surface)).unwrap();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(7);
    let (mut seen, mut worst) = (0, 0.0f64);
    for _ in 0..4000 {
        let [u, v] = [0, 1].map(|_| 10f64.powf(-7.0 + 5.0 * random.unit()));
        let (point, direction) = (surface.point_at(DVec2::new(u, v)), random.direction());
        let ray = Ray::new(point - direction, direction).unwrap();
        let answer = tracer.first_hit(&Query::primary(ray));
        let Some(hit) = answer.hit.filter(|hit| !answer.doubtful && hit.normal.is_finite()) else {
            continue;
        };
        // With B₁ = 2 t (1 − t) = t b and B₂ = t² the surface is u v times a polynomial T, and its
        // tangents are v (T + u T_u) and u (T + v T_v): the normal has the direction of
        // (T + u T_u) × (T + v T_v) / (u v) = T_u × T_v + (T × T_v) / u + (T_u × T) / v.
        let (u, v) = (hit.uv.x, hit.uv.y);
        let (bu, bv) = (2.0 * (1.0 - u), 2.0 * (1.0 - v));
        let t = bu * bv * a + bu * v * b + u * bv * c + u * v * d;
        let tu = -2.0 * (bv * a + v * b) + bv * c + v * d;
        let tv = -2.0 * (bu * a + u * c) + bu * b + u * d;
        let cross = u * v * tu.cross(tv) + v * t.cross(tv) + u * tu.cross(t);
        worst = worst.max(hit.normal.distance(cross.normalize()));
        seen += 1;
    }
    assert!(seen > 1000 && worst < 1e-6, "{seen}: {worst:e}");
}
