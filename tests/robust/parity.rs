//! All hits of rays through closed bodies: as many in as out, or in doubt.

use glam::{DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
use nurbray::geometry::{
    Cage, CageParts, Crease, KnotVector, NurbsSurface, Surface, TrimmedSurface, shapes,
};
use nurbray::intersect::{Kernel, Query, SurfaceBvh, Tracer};
use nurbray::math::Ray;
use nurbray::math::rounding::residual_factor;

use crate::random::Random;

/// The number of hits, and whether there is doubt.
fn crossings(tracer: &mut Tracer<'_>, ray: Ray) -> (usize, bool) {
    let mut hits = Vec::new();
    let doubtful = tracer.all_hits(&Query::primary(ray), &mut hits);
    (hits.len(), doubtful)
}

/// Borders that are farther apart along the ray than both roots may be off are two crossings, or in
/// doubt; those of one edge are one, without doubt.
#[test]
fn borders_apart_are_not_one_crossing_for_certain() {
    let sheet = |height: f64| {
        let lifted = glam::DAffine3::from_translation(DVec3::new(0.5, 0.5, height));
        shapes::plane(1.0, 1.0).unwrap().transformed(&lifted).unwrap()
    };
    for gap in [0.0, 1e-12] {
        let bvh = SurfaceBvh::build(&[sheet(0.0), sheet(gap)]).unwrap();
        let mut tracer = bvh.tracer();
        for distance in 20..400 {
            let height = f64::from(distance);
            let error = residual_factor(1, 1) * height;
            for x in [0.0, 0.5] {
                let ray = Ray::new(DVec3::new(x, 0.25, height), DVec3::NEG_Z).unwrap();
                let (count, doubtful) = crossings(&mut tracer, ray);
                let who = format!("{gap:e} at {x} from {height}: {count}, {doubtful}");
                if gap == 0.0 && x == 0.0 {
                    assert!(count == 1 && !doubtful, "{who}");
                } else if gap > 2.5 * error {
                    assert!(count == 2 || doubtful, "{who}");
                }
            }
        }
    }
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

/// A crease runs on smoothly past the only face on one side of it: the tangents at that corner of
/// the face have one line, and its normals differ from way to way to the corner.
#[test]
fn a_ray_past_a_crease_with_one_face_beside_it_goes_in_and_out() {
    let positions = [
        [-0.80, -1.26, -0.96],
        [0.94, -1.05, -1.02],
        [0.80, 0.98, -1.09],
        [-0.67, 1.02, -1.04],
        [-1.03, -1.07, 0.89],
        [0.96, -0.95, 0.98],
        [1.10, 0.98, 1.00],
        [-0.85, 1.05, 0.95],
    ];
    let sides =
        [[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]];
    let crease = |k: usize| Crease { vertices: [4 + k, 4 + (k + 1) % 4], sharpness: f64::INFINITY };
    let mut random = Random::new(4);
    for (away, count) in [(0.0, 12_000), (1e4, 4_000), (1e6, 4_000)] {
        let positions = positions.map(|at| DVec3::from_array(at) + DVec3::X * away);
        let cube = Cage::new(CageParts {
            positions: positions.to_vec(),
            faces: sides.map(Vec::from).to_vec(),
            creases: (0..4).map(crease).collect(),
            ..CageParts::default()
        });
        let surface = cube.unwrap().catmull_clark(1e-3).unwrap();
        let bvh = SurfaceBvh::build(&[surface]).unwrap();
        let mut tracer = bvh.tracer();
        let (mut doubted, mut odd) = (0, 0);
        for k in 0..count {
            // The limit of a vertex of a crease, as of a uniform cubic spline.
            let [before, at, after] = [3, 0, 1].map(|step| positions[4 + (k + step) % 4]);
            let vertex = (before + 4.0 * at + after) / 6.0;
            // Nearly in the plane of the face, and some roundings off the vertex.
            let around = DVec2::from_angle(random.between(0.0, 7.0));
            let along = DVec3::new(around.x, around.y, random.between(-0.1, 0.1)).normalize();
            let off = (1.0 + away) * random.power_of_ten(-14.5, -12.5) * random.direction();
            let ray = Ray::new(vertex + off - 5.0 * along, along).unwrap();
            let (count, doubtful) = crossings(&mut tracer, ray);
            odd += u32::from(!doubtful && count % 2 != 0);
            doubted += usize::from(doubtful);
        }
        assert_eq!(odd, 0, "{away}: {doubted} of {count} in doubt");
        assert!(doubted < 2 * count / 3, "{away}: {doubted}");
    }
}

/// Half a cylinder, cut off by trims, and the plane that closes it. In space, parameters and trims
/// may be off by more than the plane allows at its border.
#[test]
fn a_ray_beside_a_trim_edge_and_a_border_passes_both_or_neither() {
    let round = shapes::cylinder(1.0, 2.0).unwrap();
    let edge = |u: f64, v: f64| round.point_at(DVec2::new(u, v));
    let knots = || KnotVector::bezier(1).unwrap();
    let corners = vec![edge(0.6, 0.0), edge(0.6, 1.0), edge(0.1, 0.0), edge(0.1, 1.0)];
    let flat = NurbsSurface::new(knots(), knots(), corners, None).unwrap();
    let half = TrimLoop::rectangle(UvBox::new([0.1, 0.6], [0.0, 1.0])).unwrap();
    let trims = Trims::new(TrimDomain::of(&round).unwrap(), Kept::Odd, &[half]).unwrap();
    let side = TrimmedSurface::new(round.clone(), trims).unwrap();
    let bvh = SurfaceBvh::build(&[Surface::from(side), Surface::from(flat)]).unwrap();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(7);
    for u in [0.1, 0.6] {
        let (mut odd, mut doubted) = (0, 0);
        for _ in 0..4000 {
            let off = random.power_of_ten(-15.0, -13.0) * random.direction();
            let target = edge(u, random.between(0.45, 0.55)) + off;
            // From outside the body, through neither of its open ends.
            let across = DVec2::from_angle(random.between(0.0, 7.0));
            let along = DVec3::new(across.x, across.y, random.between(-0.2, 0.2));
            let ray = Ray::new(target - 2.5 * along, along).unwrap();
            let (count, doubtful) = crossings(&mut tracer, ray);
            odd += u32::from(!doubtful && count % 2 != 0);
            doubted += u32::from(doubtful);
        }
        assert_eq!(odd, 0, "{u}: {doubted} in doubt");
        assert!(doubted < 1000, "{u}: {doubted}");
    }
}

/// Two triangles that meet in a point, as one surface: its middle line is collapsed there.
#[test]
fn rays_beside_a_bow_tie_miss_it() {
    let knots = || KnotVector::bezier(1).unwrap();
    let corners = [[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]];
    let points = corners.map(|[x, z]| DVec3::new(x, 0.0, z)).to_vec();
    let bow_tie = NurbsSurface::new(knots(), knots(), points, None).unwrap();
    let bvh = SurfaceBvh::build(&[bow_tie]).unwrap();
    let mut random = Random::new(6);
    for kernel in [Kernel::Scalar, Kernel::default()] {
        let mut tracer = bvh.tracer_with(kernel);
        for _ in 0..2000 {
            let [x, z] = [0, 1].map(|_| random.between(0.01, 0.99));
            // The sides are z = 0 and z = 1, from x = 0 to 1.
            let [low, high] = [x.min(1.0 - x), x.max(1.0 - x)];
            let height = if z < 0.5 { z } else { 1.0 - z };
            let is_met = (height..1.0 - height).contains(&x);
            let edge = (x - height).abs().min((x - (1.0 - height)).abs());
            if edge < 1e-3 || high - low < 1e-3 {
                continue;
            }
            let along = DVec3::new(random.between(-0.5, 0.5), 1.0, random.between(-0.5, 0.5));
            let ray = Ray::new(DVec3::new(x, 0.0, z) - 2.0 * along, along).unwrap();
            let (count, doubtful) = crossings(&mut tracer, ray);
            assert!(!doubtful, "{kernel} {x} {z}");
            assert_eq!(count, usize::from(is_met), "{kernel} {x} {z}");
        }
    }
}
