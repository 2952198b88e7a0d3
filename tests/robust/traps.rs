//! Traps of the hierarchy's builder, obvhs 0.4.0: each was measured to lose hits or to end the
//! program in some use of that crate. These tests hold each of them shut.

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
use nurbray::intersect::{Answer, Coherence, HitFlags, Kernel, Query, SurfaceBvh};
use nurbray::math::Ray;
use nurbray::math::rounding::residual_factor;

use crate::random::Random;

/// Judges the first hits of rays by every kernel, with and without packets, and says by which.
fn by_every_kernel(bvh: &SurfaceBvh, rays: &[Ray], mut judge: impl FnMut(&Answer, &Ray, &str)) {
    for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
        for coherence in [Coherence::Coherent, Coherence::Incoherent] {
            let mut answers = Vec::new();
            bvh.tracer_with(kernel).first_hits(rays, coherence, &mut answers);
            let who = format!("{kernel} {coherence:?}");
            answers.iter().zip(rays).for_each(|(answer, ray)| judge(answer, ray, &who));
        }
    }
}

fn build(surfaces: &[NurbsSurface]) -> SurfaceBvh {
    SurfaceBvh::build(surfaces).unwrap()
}

fn placed(surface: &NurbsSurface, scale: f64, at: DVec3) -> NurbsSurface {
    let map = DAffine3::from_translation(at) * DAffine3::from_scale(DVec3::splat(scale));
    surface.transformed(&map).unwrap()
}

/// A cloud of small spheres: radius 0.1, on a grid of 4 × 4 × 4 in `[−1.5, 1.5]³`.
fn cloud(scale: f64) -> Vec<NurbsSurface> {
    let sphere = shapes::sphere_biquadratic(0.1).unwrap();
    let at = |k: i32| DVec3::new(f64::from(k % 4), f64::from(k / 4 % 4), f64::from(k / 16)) - 1.5;
    (0..64).map(|k| placed(&sphere, scale, scale * at(k))).collect()
}

/// The traversals of obvhs drop boxes that end before `t = 1e-4`.
#[test]
fn tiny_scenes_do_not_vanish() {
    for scale in [1e-5, 1e-8, 1e-30] {
        let bvh = build(&cloud(scale));
        let mut tracer = bvh.tracer();
        let mut random = Random::new(41);
        for k in 0..64 {
            let middle = sphere_middle(k, scale);
            let ray = Ray::new(middle + 1e-2 * scale * random.direction(), random.direction());
            let answer = tracer.first_hit(&Query::primary(ray.unwrap()));
            let hit = answer.hit.unwrap_or_else(|| panic!("scale {scale:e}: sphere {k} is lost"));
            assert_eq!(hit.surface, k, "scale {scale:e}");
            assert!(!answer.doubtful && hit.t < 0.2 * scale, "scale {scale:e}: {hit:?}");
        }
    }
}

fn sphere_middle(k: u32, scale: f64) -> DVec3 {
    let (x, y, z) = (k % 4, k / 4 % 4, k / 16);
    scale * (DVec3::new(f64::from(x), f64::from(y), f64::from(z)) - 1.5)
}

/// `safe_inverse` clamps direction components below 1.2e-7.
#[test]
fn directions_need_not_be_normalised() {
    let bvh = build(&cloud(1.0));
    let mut tracer = bvh.tracer();
    let mut random = Random::new(42);
    for k in (-140..=140).step_by(10) {
        let length = 10f64.powi(k);
        for _ in 0..20 {
            let target = sphere_middle(random.below(64) as u32, 1.0);
            let from = target + 5.0 * random.direction();
            let unit = (target - from).normalize();
            let first = |d: DVec3| tracer_first(&mut bvh.tracer(), from, d);
            let (a, b) = (first(unit), first(unit * length));
            assert_eq!(a.0, b.0, "length 1e{k}");
            assert!((a.1 - b.1 * length).abs() < 1e-13, "length 1e{k}: {} {}", a.1, b.1);
        }
        // One component much smaller than the others: along x, past a row of spheres.
        let low = DVec3::new(-3.0, -1.5, -1.5 + 0.05);
        let ray = Ray::new(low, DVec3::new(length, 0.0, 1e-9 * length)).unwrap();
        let hit = tracer.first_hit(&Query::primary(ray)).hit.unwrap();
        assert_eq!(hit.surface, 0, "length 1e{k}");
    }
}

fn tracer_first(
    tracer: &mut nurbray::intersect::Tracer<'_>,
    from: DVec3,
    direction: DVec3,
) -> (u32, f64) {
    let hit = tracer.first_hit(&Query::primary(Ray::new(from, direction).unwrap())).hit.unwrap();
    (hit.surface, hit.t)
}

/// The slab test is not conservative: rays in a face of a flat box miss in one of ten cases.
#[test]
fn rays_in_the_faces_of_flat_boxes_are_not_lost() {
    let mut random = Random::new(43);
    for _ in 0..300 {
        // Flat boxes with faces at numbers that f32 does not have.
        let at = DVec3::new(random.between(-1.0, 1.0), random.unit(), random.between(-9.0, 9.0));
        let square = placed(&shapes::plane(1.0, 1.0).unwrap(), random.between(0.1, 3.0), at);
        let bvh = build(std::slice::from_ref(&square));
        let mut tracer = bvh.tracer();
        let corner = |u: f64, v: f64| square.point_at(DVec2::new(u, v));
        let mid = corner(0.5, 0.5);

        // Within the plane, along both axes: through the middle, and along the border.
        for (from, to) in [
            (corner(0.0, 0.5), corner(1.0, 0.5)),
            (corner(0.5, 1.0), corner(0.5, 0.0)),
            (corner(0.0, 0.0), corner(1.0, 0.0)),
            (corner(0.0, 1.0), corner(0.0, 0.0)),
        ] {
            let ray = Ray::new(from - (to - from), to - from).unwrap();
            let answer = tracer.first_hit(&Query::primary(ray));
            assert!(answer.doubtful && answer.hit.is_some(), "{ray:?}: {answer:?}");
        }
        // Across it, along the third axis, in the planes of the box's side faces.
        for (u, v) in [(0.0, 0.5), (1.0, 0.3), (0.7, 0.0), (0.2, 1.0), (0.0, 0.0), (1.0, 1.0)] {
            let target = corner(u, v);
            let ray = Ray::new(DVec3::new(target.x, target.y, mid.z + 4.0), DVec3::NEG_Z).unwrap();
            let answer = tracer.first_hit(&Query::primary(ray));
            let hit = answer.hit.unwrap_or_else(|| panic!("lost: {ray:?}"));
            assert!(hit.flags.contains(HitFlags::BORDER) && !answer.doubtful, "{hit:?}");
        }
    }
}

/// A leaf too thin for f32 beside its length: proofs in f32 must take that into account.
#[test]
fn slivers_are_not_lost() {
    let mut random = Random::new(47);
    for width in [1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-4] {
        let sliver = shapes::plane(1.0, width).unwrap();
        let bvh = build(std::slice::from_ref(&sliver));
        let rays: Vec<Ray> = (0..500)
            .map(|_| {
                let (u, v) = (random.between(0.02, 0.98), random.between(0.3, 0.7));
                let mut from = random.direction();
                from.z = if from.z.abs() < 0.2 { 0.5 } else { from.z };
                Ray::new(from, sliver.point_at(DVec2::new(u, v)) - from).unwrap()
            })
            .collect();
        by_every_kernel(&bvh, &rays, |answer, ray, who| {
            let met = answer.hit.is_some_and(|hit| (hit.t - 1.0).abs() < 1e-12);
            assert!(met || answer.doubtful, "{width:e} {who}: {ray:?}");
        });
    }
}

/// Proofs in f32 must take the limits of f32 into account.
#[test]
fn no_size_is_too_small_or_too_large() {
    let mut random = Random::new(48);
    for exponent in (-66..=66).step_by(3).chain([-22, -20, -19, 19, 20]) {
        let size = 10f64.powi(exponent);
        let torus = placed(&shapes::torus(1.0, 0.3).unwrap(), size, DVec3::ZERO);
        let bvh = build(std::slice::from_ref(&torus));
        let rays: Vec<Ray> = (0..1000)
            .map(|_| {
                let d = random.direction();
                let p = torus.point_at(DVec2::new(random.unit(), random.unit()));
                Ray::new(p - 2.0 * size * d, size * d).unwrap()
            })
            .collect();
        by_every_kernel(&bvh, &rays, |answer, ray, who| {
            // The place aimed at, unless another is nearer.
            let met = answer.hit.is_some_and(|hit| hit.t < 2.0 + 1e-6);
            assert!(met || answer.doubtful, "{size:e} {who}: {ray:?}");
        });
    }
}

/// Equal boxes chain in the tree: one level for each.
#[test]
fn a_hundred_thousand_equal_boxes_do_not_overflow_the_stack() {
    let square = shapes::plane(1.0, 1.0).unwrap();
    for shift in [0.0, 1e-13, 1e-7] {
        let copies: Vec<NurbsSurface> = (0..100_000)
            .map(|k| placed(&square, 1.0, DVec3::Z * shift * f64::from(k % 1000)))
            .collect();
        let bvh = build(&copies);
        assert_eq!(bvh.surface_count(), 100_000);
        let ray = Ray::new(DVec3::new(0.1, 0.2, 3.0), DVec3::new(0.0, 0.1, -1.0)).unwrap();
        let hit = bvh.tracer().first_hit(&Query::primary(ray)).hit.unwrap();
        let highest = if shift == 0.0 { 0 } else { 999 };
        assert_eq!(hit.surface, highest, "shift {shift:e}");
    }
}

/// What a leaf of the tree holds is a slot, not the index of a box.
#[test]
fn surfaces_are_not_taken_for_one_another() {
    let mut random = Random::new(44);
    let mut surfaces = cloud(1.0);
    // In no order of space.
    let mut places: Vec<u32> = (0..64).collect();
    for k in (1..64).rev() {
        let other = random.below(k + 1);
        surfaces.swap(k, other);
        places.swap(k, other);
    }
    let bvh = build(&surfaces);
    let mut tracer = bvh.tracer();
    for (surface, &place) in (0u32..).zip(&places) {
        let middle = sphere_middle(place, 1.0);
        let ray = Ray::new(middle, random.direction()).unwrap();
        assert_eq!(tracer.first_hit(&Query::primary(ray)).hit.unwrap().surface, surface);
    }
}

/// `t` is an f32 there, which does not tell apart hits that differ by less than its last digit.
#[test]
fn the_nearest_of_two_is_told_in_f64() {
    let square = shapes::plane(10.0, 10.0).unwrap();
    for (gap, nearest) in [(1e-6, 1), (-1e-6, 0)] {
        let bvh = build(&[square.clone(), placed(&square, 1.0, DVec3::Z * gap)]);
        let ray = Ray::new(DVec3::new(1.0, 2.0, 1e6), DVec3::NEG_Z).unwrap();
        let answer = bvh.tracer().first_hit(&Query::primary(ray));
        assert_eq!(answer.hit.unwrap().surface, nearest, "gap {gap:e}");
        assert!(!answer.doubtful);
    }
}

/// Weights of very different sizes make a surface run through most of its extent within a few
/// roundings of its parameters: an answer that cannot keep the promise there must be flagged.
#[test]
fn weights_of_many_magnitudes_are_answered_for() {
    let mut random = Random::new(49);
    // With each kernel a ray is asked twice, and most answers are certain up to 1e±6.
    for (exponent, rays, least) in
        [(1.0, 100, 2390), (3.0, 100, 2380), (6.0, 100, 2200), (30.0, 10, 1)]
    {
        let mut certain = 0;
        for model in 0..12 {
            let (p, q) = [(3, 3), (2, 2), (1, 4), (5, 2)][model % 4];
            let mut points = Vec::new();
            let mut weights = Vec::new();
            for i in 0..=p {
                for j in 0..=q {
                    let z = 0.3 * random.between(-1.0, 1.0);
                    points.push(DVec3::new(i as f64, j as f64, z));
                    weights.push(10f64.powf(exponent * random.between(-1.0, 1.0)));
                }
            }
            let [u, v] = [p, q].map(|degree| KnotVector::bezier(degree).unwrap());
            let surface = NurbsSurface::new(u, v, points, Some(weights)).unwrap();
            let bvh = build(std::slice::from_ref(&surface));
            let rays: Vec<Ray> = (0..rays)
                .map(|_| {
                    // Evenly over the surface, not over its parameters: most of it is in a corner.
                    let [u, v] = [(); 2].map(|()| {
                        let near = 10f64.powf(-exponent * random.unit());
                        if random.unit() < 0.5 { near } else { 1.0 - near }
                    });
                    let d = random.direction();
                    Ray::new(surface.point_at(DVec2::new(u, v)) - 9.0 * d, d).unwrap()
                })
                .collect();
            by_every_kernel(&bvh, &rays, |answer, ray, who| {
                let context = || format!("1e±{exponent} {who}: {ray:?}");
                if answer.doubtful {
                    return;
                }
                let Some(hit) = answer.hit.filter(|hit| hit.t < 9.0 + 1e-3) else {
                    panic!("lost: {}", context());
                };
                let magnitude = ray.origin().abs().max_element().max(p.max(q) as f64);
                let promise = residual_factor(p, q) * magnitude;
                let residual = hit.point.distance(ray.at(hit.t));
                // The rounding of this sum comes on top.
                assert!(residual <= 1.05 * promise, "{residual:e}: {}", context());
                certain += 1;
            });
        }
        assert!(certain >= least, "1e±{exponent}: {certain} answers are certain");
    }
}

/// At the apex of a cone there is no normal; at the pole of a sphere there is.
#[test]
fn an_apex_has_no_normal_and_a_pole_has() {
    let mut random = Random::new(50);
    for scale in [1e-8, 1.0, 1e8] {
        let at = scale * DVec3::new(0.3, -0.2, 0.1);
        let cone = placed(&shapes::cone(1.0, 2.0).unwrap(), scale, at);
        let sphere = placed(&shapes::sphere(2.0).unwrap(), scale, at);
        for (surface, is_apex) in [(cone, true), (sphere, false)] {
            let bvh = build(std::slice::from_ref(&surface));
            let mut apexes = 0;
            let rays: Vec<Ray> = (0..40)
                .map(|_| {
                    let mut d = random.direction();
                    d.z = -1.0 - d.z.abs();
                    Ray::new(at + scale * (DVec3::new(0.0, 0.0, 2.0) - d), scale * d).unwrap()
                })
                .collect();
            by_every_kernel(&bvh, &rays, |answer, ray, who| {
                let hit = answer.hit.unwrap_or_else(|| panic!("{who}: {ray:?}"));
                let nowhere = hit.flags.contains(HitFlags::NO_NORMAL);
                // Rounding may have led the ray past the apex, to where there is a normal.
                let near = hit.point.distance(at + scale * 2.0 * DVec3::Z) < 1e-15 * scale;
                assert_eq!(nowhere, hit.normal.is_nan());
                assert!(nowhere == (is_apex && near) || is_apex && !near, "{hit:?}");
                assert!(is_apex || hit.normal.z > 0.99, "{hit:?}");
                apexes += usize::from(nowhere);
            });
            assert!(apexes > 0 || !is_apex, "no ray met the apex at {scale:e}");
        }
    }
}
