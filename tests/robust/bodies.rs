//! Closed bodies of many surfaces, triangles or limit surfaces' patches: no ray leaks through
//! their seams, and none is said to enter without leaving, not even past a sharp edge. Sheets that
//! cross are each met.

use glam::{DVec2, DVec3, DVec4};
use nurbray::geometry::{Cage, KnotVector, NurbsSurface, Surface};
use nurbray::intersect::{Hit, Kernel, Query, SurfaceBvh, Tracer};
use nurbray::math::Ray;
use rayon::prelude::*;

use crate::judge::Judge;
use crate::model::Model;
use crate::random::Random;
use crate::rays::{Class, Rays, Shot};
use crate::{models, patches};

/// Returns the faults of lines through a body, which must enter and leave it in turn, and the
/// share of doubtful lines.
fn leaks(model: &Model, count: u64, aim: Aim) -> (Vec<String>, f64) {
    let classes =
        [Class::Random, Class::Aimed, Class::Lines, Class::Corners, Class::Borders, Class::Far];
    let (bvh, judge, rays) = (model.bvh(), Judge::new(model), Rays::new(model));
    let block = |seed: u64| {
        let mut tracer = bvh.tracer();
        let mut random = Random::new(0x5eed ^ seed << 20);
        let (mut faults, mut doubtful, mut hits) = (Vec::new(), 0, Vec::new());
        for k in 0..500 {
            let shot = rays.shot(classes[k % classes.len()], &mut random);
            let line = aim.line(&shot, &judge, &mut random);
            if tracer.all_hits(&Query::primary(line), &mut hits) {
                doubtful += 1;
            } else if let Some(fault) = judge.parity_broken(&hits, &line) {
                faults.push(format!("{}: {fault}\n      {line:?}", model.name));
            }
        }
        (faults, doubtful)
    };
    let blocks: Vec<_> = (0..count / 500).into_par_iter().map(block).collect();
    let doubtful: u32 = blocks.iter().map(|block| block.1).sum();
    let faults = blocks.into_iter().flat_map(|block| block.0).collect();
    (faults, f64::from(doubtful) / count as f64)
}

/// How well rays meet what they are aimed at.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Aim {
    /// To within rounding.
    True,
    /// Past it, by up to one and a half times the promise: at sharp edges, this is where a ray may
    /// be said to touch one of the two sides and not the other.
    Beside,
}

impl Aim {
    /// The whole line of a ray.
    fn line(self, shot: &Shot, judge: &Judge<'_>, random: &mut Random) -> Ray {
        let (ray, mut origin) = (shot.ray, shot.ray.origin());
        if let (Self::Beside, Some((site, t))) = (self, shot.target) {
            let promise = judge.measure_at(&ray, site, t).promise;
            origin += random.between(0.0, 1.5) * promise * random.perpendicular(ray.direction());
        }
        Ray::with_range(origin, ray.direction(), f64::NEG_INFINITY, f64::INFINITY).unwrap()
    }
}

fn bodies() -> Vec<Model> {
    let mut bodies = vec![models::octants(), models::cuboid(), models::can()];
    bodies.extend(models::limits().into_iter().filter(|model| model.closed));
    bodies
}

fn none_leaks(count: u64) {
    for model in bodies() {
        for (aim, most_doubtful) in [(Aim::True, 0.001), (Aim::Beside, 0.02)] {
            let (faults, doubt) = leaks(&model, count, aim);
            let (name, leaking) = (&model.name, faults.len());
            println!("{name:20} {aim:?}: {count} rays, {leaking} leak, {doubt:.5} doubtful");
            assert!(faults.is_empty(), "{leaking} faults, first:\n{}", faults[0]);
            assert!(doubt < most_doubtful, "{name} {aim:?}: {doubt} doubtful");
        }
    }
}

#[test]
fn no_ray_leaks_through_seams() {
    none_leaks(25_000);
}

/// The same with a million rays each.
#[test]
#[ignore = "takes minutes"]
fn no_ray_of_millions_leaks_through_seams() {
    none_leaks(1_000_000);
}

/// A ray through a pole that nearly touches the surface there meets it again soon: both crossings
/// are found, or the answer is doubtful.
#[test]
fn no_crossing_is_lost_beside_a_pole() {
    crossings_are_even(|end| DVec2::new(end, 0.3));
}

/// The same for rays through the seam.
#[test]
fn no_crossing_is_lost_beside_the_seam() {
    crossings_are_even(|end| DVec2::new(0.3, end));
}

/// Flat lines through the seam, which they cross at any angle.
#[test]
fn no_crossing_is_lost_through_the_seam() {
    let mut random = Random::new(60);
    for (scale, shift) in [(1.0, DVec3::ZERO), (1e-3, DVec3::ONE), (1.0, DVec3::splat(1e6))] {
        let model = models::sphere().placed(scale, shift);
        let (bvh, judge) = (model.bvh(), Judge::new(&model));
        let mut tracer = bvh.tracer();
        let mut certain = 0;
        for k in 0..12_000 {
            let seam = model.surfaces[0].point_at(DVec2::new(0.3, f64::from(k % 2)));
            let along = random.perpendicular(DVec3::Z);
            let direction = along + random.power_of_ten(-12.0, -1.0) * DVec3::Z;
            let origin = seam - scale * random.between(1.0, 15.0) * direction;
            let line = Ray::with_range(origin, direction, f64::NEG_INFINITY, f64::INFINITY);
            certain += u32::from(is_even(&mut tracer, &judge, line.unwrap()));
        }
        let least = if shift.x > 1e3 { 0.2 } else { 0.4 };
        assert!(f64::from(certain) > least * 12_000.0, "{}: {certain} certain", model.name);
    }
}

/// Whether the answer for a line is certain; the line must then enter and leave in turn.
fn is_even(tracer: &mut Tracer<'_>, judge: &Judge<'_>, line: Ray) -> bool {
    let mut hits = Vec::new();
    let doubtful = tracer.all_hits(&Query::primary(line), &mut hits);
    if !doubtful {
        assert_eq!(judge.parity_broken(&hits, &line), None, "{line:?}");
    }
    !doubtful
}

/// Checks lines that nearly touch a sphere at places at either end of a parameter.
fn crossings_are_even(place: impl Fn(f64) -> DVec2) {
    let mut random = Random::new(60);
    for (scale, shift) in [(1.0, DVec3::ZERO), (1e-3, DVec3::ONE), (1.0, DVec3::splat(1e6))] {
        let model = models::sphere().placed(scale, shift);
        let (bvh, judge) = (model.bvh(), Judge::new(&model));
        let mut tracer = bvh.tracer();
        let mut certain = 0;
        for k in 0..12_000 {
            let at = place(f64::from(k % 2));
            let point = model.surfaces[0].point_at(at);
            let normal = model.surfaces[0].normal(at).unwrap();
            let along = random.perpendicular(normal);
            let dip = random.power_of_ten(-12.0, -1.0);
            let direction = along + dip * normal;
            let origin = point - scale * random.between(1.0, 15.0) * direction;
            let line = Ray::with_range(origin, direction, f64::NEG_INFINITY, f64::INFINITY);
            certain += u32::from(is_even(&mut tracer, &judge, line.unwrap()));
        }
        // Between two crossings the ray is at most `dip² / 2` radii off the sphere. Doubt is due
        // where that is within the promise for points; it is granted up to twenty times that dip.
        let magnitude = 4.0 * scale + shift.x; // of the control points
        let promised = 40.0 * 0.5 * f64::EPSILON * magnitude / scale;
        let granted = 20.0 * (2.0 * promised).sqrt();
        let least = (-1.0 - granted.log10()) / 11.0;
        assert!(f64::from(certain) > least * 12_000.0, "{}: {certain} certain", model.name);
    }
}

/// A steep ray that passes a pole by more than its error bound, but by too little for a root to be
/// proved there, has a hit, if only a doubtful one: no ray gets out of a closed body beside a pole.
#[test]
fn a_steep_ray_beside_a_pole_has_a_hit() {
    let mut random = Random::new(61);
    for (scale, shift) in [(1.0, DVec3::ZERO), (1e-6, DVec3::ZERO), (1.0, DVec3::splat(1e3))] {
        let model = models::sphere().placed(scale, shift);
        let (bvh, judge) = (model.bvh(), Judge::new(&model));
        let pole = model.surfaces[0].point_at(DVec2::new(0.0, 0.3));
        for kernel in Kernel::ALL.iter().copied().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            for _ in 0..1_000 {
                let aside =
                    scale * random.power_of_ten(-15.0, -6.0) * random.perpendicular(DVec3::Z);
                let back = scale * (0.5 * random.direction() + DVec3::Z); // the pole is the upper one
                let origin = pole + aside - back;
                let ray = Ray::new(origin, pole + aside - origin).unwrap();
                let query = Query::primary(ray);
                let said = || format!("{kernel}, {}: {aside}, {ray:?}", model.name);
                let answer = tracer.first_hit(&query);
                let hit = answer.hit.unwrap_or_else(|| panic!("{}: no hit", said()));
                // At a pole twice the promise; a doubtful hit may be off by a few times that.
                let allowed = if answer.doubtful { 8.0 } else { 2.0 };
                let off_ray = hit.point.distance(ray.at(hit.t));
                assert!(off_ray <= allowed * judge.measure(&ray, &hit).promise, "{}", said());
                assert!(tracer.occluded(&query).occluded, "{}", said());
            }
        }
    }
}

/// Chords between two points near the apex of a cone at which two rows of control points lie:
/// `S = u² (v, v², 1)`, on `x² = y z`. Each point is met, or the answer is doubtful: a hit at the
/// apex must not take a root's place without a flag.
#[test]
fn chords_near_an_apex_of_two_rows_are_met_twice() {
    let row = |z: f64| {
        [(0.0, 0.0), (0.5, 0.0), (1.0, 1.0)].map(|(x, y)| DVec4::new(x * z, y * z, z, 1.0))
    };
    let control = [row(0.0), row(0.0), row(1.0)].concat();
    let knots = || KnotVector::bezier(2).unwrap();
    let surface = NurbsSurface::from_homogeneous(knots(), knots(), control).unwrap();
    let bvh = Model::new("cone", surface).bvh();
    let mut random = Random::new(17);
    let (mut certain, mut hits) = (0, Vec::new());
    let mut tracers: Vec<Tracer<'_>> = Kernel::ALL
        .iter()
        .filter(|kernel| kernel.is_available())
        .map(|&kernel| bvh.tracer_with(kernel))
        .collect();
    for _ in 0..3_000 {
        let height = random.power_of_ten(-5.0, -2.0);
        let mut point = |v: f64| {
            let u = height * random.between(0.3, 1.0);
            u * u * DVec3::new(v, v * v, 1.0)
        };
        let (from, to) = (point(0.3), point(0.7));
        let way = random.between(0.1, 3.0);
        let direction = (to - from).normalize();
        let ray = Ray::new(from - way * direction, direction).unwrap();
        let query = Query::primary(ray);
        // To within the ray's own rounding, for angles of at least 0.02.
        let places = [way, way + from.distance(to)];
        let normal = |p: DVec3| DVec3::new(2.0 * p.x, -p.z, -p.y).normalize();
        let steep = [from, to].iter().all(|&p| normal(p).dot(direction).abs() > 0.02);
        if !steep || from.distance(to) < 1e-10 {
            continue;
        }
        let is_there = |hit: &Hit, place: f64| (hit.t - place).abs() < 2e-12;
        let doubtful = tracers[0].all_hits(&query, &mut hits);
        for place in places {
            let met = doubtful || hits.iter().any(|hit| is_there(hit, place));
            assert!(met, "{place} of {ray:?}: {hits:?}");
        }
        certain += usize::from(!doubtful);
        for tracer in &mut tracers {
            let answer = tracer.first_hit(&query);
            let met = answer.doubtful || answer.hit.is_some_and(|hit| is_there(&hit, way));
            assert!(met, "{}: {way} of {ray:?}: {answer:?}", tracer.kernel());
        }
    }
    assert!(certain > 300, "{certain} without doubt");
}

/// Rays at the limit points of the cage's vertices, which the limit masks give.
#[test]
fn limit_surfaces_pass_through_the_limit_points_of_vertices() {
    let cage = Cage::new(patches::body()).unwrap();
    let limit = cage.catmull_clark(1e-4).unwrap();
    let deviation = limit.deviation();
    assert!(deviation > 0.0 && deviation <= 0.5e-4);
    let model = Model::closed("body", Surface::from(limit));
    let bvh = model.bvh();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(3);
    let mut seen = 0;
    for limit in cage.catmull_clark_limits().into_iter().flatten() {
        let normal = limit.normal.unwrap();
        for _ in 0..8 {
            // Steep, so that the surface's deviation shows by less than twice its amount.
            let direction = (random.direction() - 3.0 * normal).normalize();
            let ray = Ray::new(limit.point - 0.05 * direction, direction).unwrap();
            let hit = tracer.first_hit(&Query::primary(ray)).hit.unwrap();
            let off: DVec3 = hit.point - limit.point;
            assert!(off.length() <= 2.0 * deviation, "{} off by {:e}", hit.uv, off.length());
            assert!(hit.normal.distance(normal) < 0.02, "{} and {normal}", hit.normal);
            seen += 1;
        }
    }
    assert!(seen > 8 * 40, "{seen}");
}

/// Sheets that cross each other may do so on knot lines of both: those are not adjoining pieces of
/// one crossing.
#[test]
fn sheets_that_cross_on_knot_lines_are_both_met() {
    let knots = |points| KnotVector::clamped_uniform(1, points).unwrap();
    let strip = |path: &[(f64, f64)]| {
        let net = path.iter().flat_map(|&(x, z)| [0.0, 1.0].map(|y| DVec3::new(x, y, z)));
        NurbsSurface::new(knots(path.len()), knots(2), net.collect(), None).unwrap()
    };
    // Up through the origin, back far below, and once more through it.
    let loop_of = [(-1.0, -0.5), (0.0, 0.0), (1.0, 0.5), (3.0, -4.0), (-3.0, -4.0), (-1.0, -2.0)];
    let twice = strip(&[&loop_of[..], &[(0.0, 0.0), (1.0, 2.0)]].concat());
    let flat = strip(&[(-1.0, -0.5), (0.0, 0.0), (1.0, 0.5)]);
    let steep = strip(&[(-1.0, -2.0), (0.0, 0.0), (1.0, 2.0)]);
    let ray = Ray::new(DVec3::new(0.0, 0.3, 5.0), DVec3::NEG_Z).unwrap();
    for (surfaces, wanted) in
        [(vec![twice], vec![5.0, 5.0, 9.0]), (vec![flat, steep], vec![5.0; 2])]
    {
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let mut hits = Vec::new();
        let doubtful = bvh.tracer().all_hits(&Query::primary(ray), &mut hits);
        let found: Vec<f64> = hits.iter().map(|hit| hit.t).collect();
        assert_eq!((found, doubtful), (wanted, false));
    }
}
