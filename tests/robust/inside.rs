//! Rays that run inside a surface: in a plane, along a ruling. They have infinitely many roots, so
//! both ends of the stretch are reported and flagged, and the work is bounded.

use std::f64::consts::TAU;

use glam::{DAffine3, DMat3, DQuat, DVec2, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
use nurbray::intersect::{Answer, Coherence, Hit, HitFlags, Kernel, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::random::Random;

/// A stretch of a straight line that lies in a surface, from end to end.
type Stretch = [DVec3; 2];

/// The error of the ends of a stretch, as a part of the surface's size: the exact solver stops at
/// 1e-9 of a leaf, and a border met at a small angle adds to that.
const END_ERROR: f64 = 1e-7;

/// Boxes the exact solver may look at for one first hit.
const MOST_BOXES: u64 = 20_000;

/// Stretches of one surface, in its own coordinates.
struct Stretched {
    name: &'static str,
    surface: NurbsSurface,
    stretch: fn(&mut Random) -> Stretch,
}

fn stretched() -> Vec<Stretched> {
    let item = |name, surface, stretch| Stretched { name, surface, stretch };
    vec![
        item("plane", shapes::plane(1.0, 2.0).unwrap(), in_rectangle),
        item("cubic plane", cubic_plane(), in_rectangle),
        item("disk", shapes::disk(1.0).unwrap(), in_disk),
        item("cylinder", shapes::cylinder(1.0, 2.0).unwrap(), on_cylinder),
        item("cone", shapes::cone(1.0, 2.0).unwrap(), on_cone),
        item("saddle", saddle(), on_saddle),
    ]
}

/// Between two points on different sides of the rectangle `[−0.5, 0.5] × [−1, 1]`.
fn in_rectangle(random: &mut Random) -> Stretch {
    let half = DVec2::new(0.5, 1.0);
    let side = random.below(2);
    [-1.0, 1.0].map(|end| {
        let mut at = DVec2::splat(random.between(-1.0, 1.0));
        at[side] = end;
        (at * half).extend(0.0)
    })
}

fn in_disk(random: &mut Random) -> Stretch {
    let from = random.between(0.0, TAU);
    // Chords down to a twentieth of the radius.
    let to = from + random.between(0.05, TAU - 0.05);
    [from, to].map(|angle| DVec2::from_angle(angle).extend(0.0))
}

fn on_cylinder(random: &mut Random) -> Stretch {
    let foot = DVec2::from_angle(random.between(0.0, TAU));
    [foot.extend(0.0), foot.extend(2.0)]
}

fn on_cone(random: &mut Random) -> Stretch {
    let foot = DVec2::from_angle(random.between(0.0, TAU));
    [foot.extend(0.0), DVec3::new(0.0, 0.0, 2.0)]
}

fn on_saddle(random: &mut Random) -> Stretch {
    let at = |x: f64, y: f64| DVec3::new(x, y, x + y - 2.0 * x * y);
    let place = random.unit();
    match random.below(2) {
        0 => [at(place, 0.0), at(place, 1.0)],
        _ => [at(0.0, place), at(1.0, place)],
    }
}

fn saddle() -> NurbsSurface {
    let knots = || KnotVector::bezier(1).unwrap();
    let corners = [(0.0, 0.0, 0.0), (0.0, 1.0, 1.0), (1.0, 0.0, 1.0), (1.0, 1.0, 0.0)];
    let corners = corners.map(DVec3::from).to_vec();
    NurbsSurface::new(knots(), knots(), corners, None).unwrap()
}

/// The rectangle `[−0.5, 0.5] × [−1, 1]` as a rational bicubic of uneven speed, two spans
/// each way.
fn cubic_plane() -> NurbsSurface {
    let knots = || KnotVector::clamped_uniform(3, 5).unwrap();
    let places = [-1.0, -0.7, 0.1, 0.4, 1.0];
    let points = places.iter().flat_map(|&x| places.map(|y| DVec3::new(0.5 * x, y, 0.0)));
    let weights = (0..25).map(|k| 1.0 + 0.5 * f64::from(k).sin()).collect();
    NurbsSurface::new(knots(), knots(), points.collect(), Some(weights)).unwrap()
}

/// A placement in space: any rotation, scale and shift, or none.
fn placement(kind: usize, random: &mut Random) -> DAffine3 {
    let turned = DMat3::from_quat(DQuat::from_axis_angle(random.direction(), random.unit() * TAU));
    match kind {
        0 => DAffine3::IDENTITY,
        1 => DAffine3::from_mat3(turned),
        2 => DAffine3::from_mat3(1e-8 * turned),
        3 => DAffine3::from_mat3(1e8 * turned),
        _ => DAffine3::from_mat3_translation(turned, DVec3::new(1e3, -2e3, 1e3)),
    }
}

struct Outcome {
    /// Boxes looked at for the first hit, and for all of them.
    boxes: [u64; 2],
    fault: Option<String>,
}

/// Asks about a ray along a stretch of a surface of some size.
fn ask(bvh: &SurfaceBvh, [from, to]: Stretch, size: f64, random: &mut Random) -> Outcome {
    let length = from.distance(to);
    let before = random.between(0.1, 2.0);
    let origin = from - (to - from) / length * before * length;
    let ray = Ray::new(origin, to - from).unwrap();
    let ends = [before, before + 1.0];
    let near = |hit: &Hit, end: f64| (hit.t - end).abs() <= END_ERROR / (length / size).min(1.0);
    let mut tracer = bvh.tracer();
    let first = tracer.first_hit(&Query::primary(ray));
    let boxes = tracer.statistics().exact_boxes;
    let mut all = Vec::new();
    let doubtful = tracer.all_hits(&Query::primary(ray), &mut all);
    let boxes = [boxes, tracer.statistics().exact_boxes - boxes];

    let inside: Vec<&Hit> = all.iter().filter(|hit| hit.flags.contains(HitFlags::INSIDE)).collect();
    let both = inside.first().is_some_and(|hit| near(hit, ends[0]))
        && inside.last().is_some_and(|hit| near(hit, ends[1]));
    let begins = first.hit.is_some_and(|hit| near(&hit, ends[0]));
    let flagged = first.doubtful && doubtful;
    let fault = (!(both && begins && flagged)).then(|| {
        let seen: Vec<_> = all.iter().map(|hit| (hit.t, hit.flags.bits())).collect();
        let first = first.hit.map(|hit| (hit.t, hit.flags.bits()));
        format!("ends at {ends:?}, all {seen:?}, first {first:?}, flagged {flagged} {ray:?}")
    });
    Outcome { boxes, fault }
}

#[test]
fn a_stretch_inside_a_surface_is_reported_by_its_ends() {
    let mut random = Random::new(11);
    let mut faults = Vec::new();
    for Stretched { name, surface, stretch } in stretched() {
        for kind in 0..5 {
            let place = placement(kind, &mut random);
            let size = place.matrix3.x_axis.length();
            let surface = surface.transformed(&place).unwrap();
            let bvh = SurfaceBvh::build(&[surface]).unwrap();
            let (mut most, mut most_for_all, mut sum, mut wrong) = (0, 0, 0, 0);
            let count = 200;
            let started = std::time::Instant::now();
            for _ in 0..count {
                let ends = stretch(&mut random).map(|point| place.transform_point3(point));
                let outcome = ask(&bvh, ends, size, &mut random);
                let [first, all] = outcome.boxes;
                (most, most_for_all) = (most.max(first), most_for_all.max(all));
                sum += first;
                wrong += u64::from(outcome.fault.is_some());
                if faults.len() < 12 {
                    faults.extend(outcome.fault.map(|fault| format!("{name} {kind}: {fault}")));
                }
            }
            println!(
                "{name:12} placed {kind}: boxes {} at most {most}, for all hits {most_for_all}, wrong {wrong}, {:?}",
                sum / count,
                started.elapsed() / count as u32
            );
            if most > MOST_BOXES {
                faults.push(format!("{name} {kind}: {most} boxes"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The most boxes of the exact solver for one ray, and the few more of the last leaf.
const MOST_BOXES_OF_A_RAY: u64 = (1 << 17) + (1 << 13);

/// Both ends of the stretch lie outside the ray's range, and the range between them.
#[test]
fn a_range_within_a_stretch_is_in_doubt() {
    let mut random = Random::new(63);
    for Stretched { name, surface, stretch } in stretched() {
        let bvh = SurfaceBvh::build(&[surface]).unwrap();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let (mut tracer, mut hits) = (bvh.tracer_with(kernel), Vec::new());
            for _ in 0..40 {
                let [from, to] = stretch(&mut random);
                let share = random.between(0.2, 0.7);
                // From the middle of the stretch, and from before it.
                for (start, before) in
                    [(from + share * (to - from), 0.0), (2.0 * from - to, 1.0 + share)]
                {
                    let range = [before, before + random.between(0.05, 0.2)];
                    let ray = Ray::with_range(start, to - from, range[0], range[1]).unwrap();
                    let what = format!("{name}, {kernel}: {ray:?}");
                    assert!(tracer.first_hit(&ray).doubtful, "{what}");
                    assert!(tracer.occluded(&ray).doubtful, "{what}");
                    assert!(tracer.all_hits(&ray, &mut hits), "{what}");
                }
            }
        }
    }
}

/// Points `(x, y, 0)` that depend on the sum of two angles: not a surface, but a circle.
fn circle_twice() -> NurbsSurface {
    let circle = shapes::circle_arc(1.0, 0.0, 360.0).unwrap();
    let net = circle.control().iter().flat_map(|a| {
        let turned = |b: &glam::DVec4| {
            let (x, y) = (a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
            glam::DVec4::new(x, y, 0.0, a.w * b.w)
        };
        circle.control().iter().map(turned).collect::<Vec<_>>()
    });
    let knots = || circle.knots().clone();
    NurbsSurface::from_homogeneous(knots(), knots(), net.collect()).unwrap()
}

/// A ray in the plane of that circle, from outside to a point within.
fn in_its_plane(random: &mut Random) -> Ray {
    let [from, to] = [2.0, 0.5].map(|reach| {
        let angle = random.between(0.0, TAU);
        reach * DVec2::from_angle(angle).extend(0.0)
    });
    Ray::new(from, to - from).unwrap()
}

/// Surfaces that are nowhere steep to a ray, and nowhere clear of it, took seconds a ray.
#[test]
fn work_is_bounded_where_a_surface_is_but_a_curve() {
    let bvh = SurfaceBvh::build(&[circle_twice()]).unwrap();
    let mut random = Random::new(3);
    let mut tracer = bvh.tracer();
    let mut most = 0;
    for _ in 0..8 {
        let query = Query::primary(in_its_plane(&mut random));
        let before = tracer.statistics().exact_boxes;
        let first = tracer.first_hit(&query);
        let between = tracer.statistics().exact_boxes;
        let mut hits = Vec::new();
        let doubtful = tracer.all_hits(&query, &mut hits);
        assert!(first.doubtful && doubtful, "{query:?}");
        let after = tracer.statistics().exact_boxes;
        most = most.max(between - before).max(after - between);
    }
    assert!(most <= MOST_BOXES_OF_A_RAY, "{most} boxes for one ray");
    assert!(most > 1 << 17, "the bound is not met: {most} boxes");
}

/// Which leaves are left when the work is used up depends on the ray, not on those traced with it.
#[test]
fn what_is_left_where_work_is_bounded_depends_on_the_ray_alone() {
    let bvh = SurfaceBvh::build(&[circle_twice()]).unwrap();
    let mut random = Random::new(4);
    let rays: Vec<Ray> = (0..6).map(|_| in_its_plane(&mut random)).collect();
    let mut tracer = bvh.tracer();
    for told in [Coherence::Coherent, Coherence::Incoherent] {
        let mut said = |rays: &[Ray]| {
            let mut answers = Vec::new();
            tracer.first_hits(rays, told, &mut answers);
            let one = |answer: &Answer| (answer.hit.map(|hit| hit.t.to_bits()), answer.doubtful);
            answers.iter().map(one).collect::<Vec<_>>()
        };
        let together = said(&rays);
        let backwards: Vec<Ray> = rays.iter().rev().copied().collect();
        let mut reversed = said(&backwards);
        reversed.reverse();
        assert_eq!(reversed, together, "{told:?}");
        let alone: Vec<_> = rays.iter().flat_map(|ray| said(&[*ray])).collect();
        assert_eq!(alone, together, "{told:?}");
    }
}
