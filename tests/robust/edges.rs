//! Rays that leave hits at edges that two surfaces share, or beside borders.

use glam::{DAffine3, DQuat, DVec2, DVec3, EulerRot};
use nurbray::geometry::construct::{self, Axis};
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
use nurbray::geometry::{KnotVector, NurbsCurve, Surface, TrimmedSurface, shapes};
use nurbray::intersect::{Coherence, Hit, HitFlags, Kernel, Query, SurfaceBvh, Tracer};
use nurbray::math::Ray;

use crate::random::Random;

/// Two sheets one above the other, far nearer to each other than a grazing ray to the lower one can
/// tell where it meets it, beside their borders: a ray upwards from there meets the upper one.
#[test]
fn a_sheet_close_above_a_grazing_hit_at_a_border_is_not_lost() {
    for (cosine, gap) in [(1e-2, 1e-13), (1e-4, 1e-11), (1e-6, 1e-9), (1e-8, 1e-7)] {
        let sheet = |z: f64| {
            let plane = shapes::plane(1.0, 1.0).unwrap();
            plane.transformed(&DAffine3::from_translation(z * DVec3::Z)).unwrap()
        };
        let bvh = SurfaceBvh::build(&[sheet(0.0), sheet(gap)]).unwrap();
        for inside in [0.0, 0.1 * gap, gap, 10.0 * gap, 1e3 * gap] {
            let target = DVec3::new(0.5 - inside, 0.1, 0.0);
            let along = DVec3::new(0.0, 1.0, cosine);
            let seen = Query::primary(Ray::new(target - along, along).unwrap());
            for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
                let mut tracer = bvh.tracer_with(kernel);
                let start = tracer.first_hit(&seen).hit.unwrap();
                assert_eq!(start.surface, 0);
                let up = Query::leaving(Ray::new(start.point, DVec3::Z).unwrap(), &start);
                let (mut answers, mut any) = (vec![tracer.first_hit(&up)], Vec::new());
                tracer.first_hits(&[up; 2], Coherence::Incoherent, &mut answers);
                tracer.first_hits(&[up; 2], Coherence::Coherent, &mut answers);
                tracer.occlusions(&[up; 2], Coherence::Coherent, &mut any);
                for answer in answers {
                    let met = answer.hit.is_some_and(|hit| hit.surface == 1);
                    assert!(met || answer.doubtful, "{kernel}, {cosine}, {inside}: {answer:?}");
                }
                assert!(any.iter().all(|any| any.occluded || any.doubtful), "{kernel}, {cosine}");
            }
        }
    }
}

/// A lens of three surfaces, whose normals point outward, and the points of its two edges.
fn lens(moved: &DAffine3) -> (SurfaceBvh, impl Fn(f64, bool) -> DVec3) {
    let turned = |profile: &NurbsCurve| construct::revolve(profile, &Axis::Z, 360.0).unwrap();
    let cap = |z: [f64; 2]| {
        let points = [(0.0, z[0]), (6.1, z[0]), (12.5, z[1])];
        let points = points.map(|(x, z)| DVec3::new(x, 0.0, z)).to_vec();
        turned(&NurbsCurve::new(KnotVector::bezier(2).unwrap(), points, None).unwrap())
    };
    let rim = [1.53, 4.47].map(|z| DVec3::new(12.5, 0.0, z));
    let rim = turned(&NurbsCurve::polyline(&rim).unwrap());
    let surfaces = [cap([0.0, 1.53]), cap([6.0, 4.47]).reversed_u(), rim];
    let surfaces = surfaces.map(|surface| surface.transformed(moved).unwrap());
    let moved = *moved;
    let edge = move |angle: f64, is_upper: bool| {
        let [x, y] = [12.5 * angle.cos(), 12.5 * angle.sin()];
        moved.transform_point3(DVec3::new(x, y, if is_upper { 4.47 } else { 1.53 }))
    };
    (SurfaceBvh::build(&surfaces).unwrap(), edge)
}

/// A ray through an edge of a closed body goes in or out there once, whichever of the two surfaces
/// it is found to cross beside the edge.
#[test]
fn edges_are_crossed_once() {
    let turned = DQuat::from_euler(EulerRot::XYZ, 0.3, 0.7, 1.1);
    let turned = DAffine3::from_rotation_translation(turned, DVec3::new(3.0, -7.0, 11.0));
    for moved in [DAffine3::IDENTITY, turned] {
        let (bvh, edge) = lens(&moved);
        let (mut tracer, mut random) = (bvh.tracer(), Random::new(76));
        let mut certain = 0;
        for k in 0..20_000 {
            let target = edge(6.3 * random.unit(), k % 2 == 0);
            let origin = moved.transform_point3(40.0 * random.direction());
            let ray = Ray::new(origin, target - origin).unwrap();
            let Some(hits) = chain(&mut tracer, &ray) else { continue };
            let is_out = |hit: &Hit| hit.normal.dot(ray.direction()) > 0.0;
            let alternate = hits.iter().enumerate().all(|(k, hit)| is_out(hit) == (k % 2 == 1));
            assert!(alternate && hits.len() % 2 == 0, "{ray:?}: {hits:?}");
            certain += 1;
        }
        assert!(certain > 8_000, "{certain}");
    }
}

/// The hits of a ray, each found by leaving the one before; `None` if any answer is doubtful.
fn chain(tracer: &mut Tracer<'_>, ray: &Ray) -> Option<Vec<Hit>> {
    let (mut query, mut hits) = (Query::primary(*ray), Vec::new());
    while hits.len() < 9 {
        let answer = tracer.first_hit(&query);
        if answer.doubtful {
            return None;
        }
        let Some(hit) = answer.hit else { break };
        hits.push(hit);
        query = Query::leaving(Ray::new(hit.point, ray.direction()).unwrap(), &hit);
    }
    Some(hits)
}

/// A prism of five planes, larger than its faces, which trims cut out of them; and its corners.
fn prism() -> (SurfaceBvh, [[DVec3; 3]; 2]) {
    let ends = [-3.0, 3.0]
        .map(|z| [(0.0, 0.0), (5.0, 4.0), (-2.0, 6.0)].map(|(x, y)| DVec3::new(x, y, z)));
    let [low, high] = ends;
    let face = |corners: &[DVec3]| {
        let size = 40.0;
        let along = (corners[1] - corners[0]).normalize();
        let normal = along.cross(corners[2] - corners[0]).normalize();
        let across = normal.cross(along);
        let place = DAffine3::from_cols(along, across, normal, corners[0]);
        let plane = shapes::plane(size, size).unwrap().transformed(&place).unwrap();
        let uv = |corner: &DVec3| {
            let at = *corner - corners[0];
            DVec2::new(at.dot(along), at.dot(across)) / size + 0.5
        };
        let outline: Vec<DVec2> = corners.iter().map(uv).collect();
        let outline = [TrimLoop::polygon(&outline).unwrap()];
        let trims = Trims::new(TrimDomain::of(&plane).unwrap(), Kept::Odd, &outline).unwrap();
        Surface::from(TrimmedSurface::new(plane, trims).unwrap())
    };
    let mut faces = vec![face(&[low[0], low[2], low[1]]), face(&high)];
    for k in 0..3 {
        let next = (k + 1) % 3;
        faces.push(face(&[low[k], low[next], high[next], high[k]]));
    }
    (SurfaceBvh::build(&faces).unwrap(), ends)
}

/// The same where the faces end in trims, for rays that pass up to 1e-10 beside an edge. There they
/// may cross one face only, which reaches farther by rounding than the other: then its hit is
/// flagged.
#[test]
fn edges_of_trimmed_faces_are_crossed_once() {
    let (bvh, [low, high]) = prism();
    let (mut tracer, mut random) = (bvh.tracer(), Random::new(77));
    let (mut certain, mut odd) = (0, 0);
    for _ in 0..20_000 {
        let on = low[0].lerp(high[0], random.between(0.1, 0.9));
        let beside = random.sign() * random.power_of_ten(-15.0, -10.0);
        let target = on + beside * random.direction();
        let origin = 40.0 * random.direction();
        let ray = Ray::new(origin, target - origin).unwrap();
        let Some(hits) = chain(&mut tracer, &ray) else { continue };
        certain += 1;
        if hits.len() % 2 == 1 {
            odd += 1;
            let at_edge = |hit: &Hit| hit.flags.contains(HitFlags::TRIM_EDGE);
            assert!(hits.iter().any(at_edge), "{ray:?}: {hits:?}");
        }
    }
    println!("{certain} certain, {odd} odd");
    assert!(certain > 8_000 && 20 * odd < certain, "{odd} of {certain}");
}
