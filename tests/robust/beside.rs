//! Rays that leave a hit beside a crease or a border: what is met right behind it is not the start.

use std::f64::consts::FRAC_PI_2;

use glam::{DAffine3, DMat3, DVec3};
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

/// The same body, each of its six faces a surface.
fn cube() -> SurfaceBvh {
    let face = |normal: DVec3| {
        let (u, v) = normal.any_orthonormal_pair();
        let turn = DMat3::from_cols(u, v, normal);
        let plane = shapes::plane(2.0, 2.0).unwrap();
        plane.transformed(&DAffine3::from_mat3_translation(turn, normal)).unwrap()
    };
    let normals = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| [axis, -axis]);
    let faces: Vec<NurbsSurface> = normals.concat().into_iter().map(face).collect();
    SurfaceBvh::build(&faces).unwrap()
}

/// Two faces of a body that meet in the edge x = y = 1 at an angle, with their normals outwards: one
/// in the plane x = 1, as wide as `narrow` at y = −1 and as 1 at the edge.
fn wedge(angle: f64, narrow: f64) -> SurfaceBvh {
    let face = |from: DVec3, by: DVec3, half_widths: [f64; 2]| {
        let knots = || KnotVector::bezier(1).unwrap();
        let rows = [(from, half_widths[0]), (from + by, half_widths[1])];
        let net = rows.map(|(at, half)| [-half, half].map(|z| at + z * DVec3::Z)).concat();
        NurbsSurface::new(knots(), knots(), net, None).unwrap()
    };
    let back = -2.0 * DVec3::new(angle.sin(), angle.cos(), 0.0);
    let first = face(DVec3::new(1.0, -1.0, 0.0), 2.0 * DVec3::Y, [narrow, 1.0]);
    let second = face(DVec3::new(1.0, 1.0, 0.0), back, [1.0, 1.0]);
    SurfaceBvh::build(&[first, second]).unwrap()
}

/// A rectangle over a line between two places in the plane y = 0, from there to y = 1.
fn flat(from: (f64, f64), to: (f64, f64)) -> NurbsSurface {
    let knots = || KnotVector::bezier(1).unwrap();
    let net = [from, to].map(|(x, z)| [0.0, 1.0].map(|y| DVec3::new(x, y, z))).concat();
    NurbsSurface::new(knots(), knots(), net, None).unwrap()
}

/// A ray that leaves a face outwards, so flatly that it passes the edge far away within rounding of
/// the next face, is not said to meet that, unless in doubt. If it passes by more than that, it is
/// not in doubt.
#[test]
fn flat_rays_out_of_a_convex_body_do_not_meet_the_next_face() {
    let wedges =
        [("wedge", wedge(0.5, 1.0)), ("edge", wedge(0.05, 1.0)), ("taper", wedge(1.2, 0.9))];
    for (name, bvh) in [("cube", cube()), ("room", room())].into_iter().chain(wedges) {
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let mut random = Random::new(72);
            let (mut near, mut in_doubt, mut clear) = (0, 0, 0);
            for k in 0..20_000 {
                // The distance from the edge y = 1, and by how much that is passed.
                let beside = random.power_of_ten(-14.0, -5.0);
                let passed = random.power_of_ten(-18.0, -11.0);
                let height = random.between(-0.8, 0.8);
                let way = DVec3::new(passed / beside, 1.0, random.between(-0.3, 0.3));
                let target = DVec3::new(1.0, 1.0 - beside, height);
                let finder = match k % 2 {
                    0 => Ray::new(target + 2.0 * DVec3::X, -DVec3::X),
                    _ => Ray::new(target - 0.5 * way, way),
                };
                let found = tracer.first_hit(&finder.unwrap());
                let Some(hit) = found.hit.filter(|hit| !found.doubtful && hit.point.x == 1.0)
                else {
                    continue;
                };
                let query = Query::leaving(Ray::new(hit.point, way).unwrap(), &hit);
                let first = tracer.first_hit(&query);
                let any = tracer.occluded(&query);
                let what = format!("{name}, {kernel}: {beside:e} and {passed:e} {query:?}");
                assert!(first.doubtful || first.hit.is_none(), "{what}: {first:?}");
                assert!(any.doubtful || !any.occluded, "{what}: {any:?}");
                let doubtful = u32::from(first.doubtful);
                if passed < 1e-15 {
                    (near, in_doubt) = (near + 1, in_doubt + doubtful);
                } else if passed > 1e-13 && beside > 1e-11 && k % 2 == 0 {
                    assert!(!first.doubtful, "{what}: {first:?}");
                    clear += 1;
                }
            }
            println!("{name}, {kernel}: {in_doubt} of {near} in doubt, {clear} clear");
            assert!(near > 4000 && clear > 1000, "{near} {clear}");
        }
    }
}

/// A steep ray that passes a knot line, or a seam, by a few errors meets the surface on one side of
/// it, and does not meet the piece on the other side: neither is in doubt, nor is a ray that goes on
/// from there.
#[test]
fn no_steep_ray_beside_a_knot_line_is_in_doubt() {
    let plane = shapes::plane(8.0, 8.0).unwrap().insert_knot_v(0.5, 1).unwrap();
    let lifted = DAffine3::from_translation(0.9 * DVec3::Z);
    // With the distance of the rays from the z axis.
    let surfaces = [
        ("sphere", shapes::sphere(1.0).unwrap(), 0.0),
        ("biquadratic sphere", shapes::sphere_biquadratic(1.0).unwrap(), 0.0),
        ("torus", shapes::torus(2.0, 0.5).unwrap(), 1.5),
        ("plane", plane.transformed(&lifted).unwrap(), 0.0),
    ];
    for (name, surface, aside) in surfaces {
        let bvh = SurfaceBvh::build(&[surface]).unwrap();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let (mut random, mut hits) = (Random::new(73), Vec::new());
            for _ in 0..4000 {
                let y = random.sign() * random.power_of_ten(-16.0, -12.5);
                let from = DVec3::new(aside + random.between(0.2, 0.8), y, 5.0);
                let ray = Ray::new(from, DVec3::NEG_Z).unwrap();
                let what = format!("{name}, {kernel}: {y:e} {ray:?}");
                let found = tracer.first_hit(&ray);
                assert!(!found.doubtful, "{what}: {found:?}");
                assert!(!tracer.all_hits(&ray, &mut hits), "{what}: {hits:?}");
                let hit = found.hit.unwrap();
                let way = DVec3::new(random.between(-0.5, 0.5), 0.0, -1.0);
                let onward = Query::leaving(Ray::new(hit.point, way).unwrap(), &hit);
                let first = tracer.first_hit(&onward);
                assert!(!first.doubtful, "{what}: {onward:?} {first:?}");
                assert!(!tracer.all_hits(&onward, &mut hits), "{what}: {onward:?} {hits:?}");
            }
        }
    }
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
        let plate = flat((-1.0, 0.0), (0.0, 0.0));
        let wall = flat((gap, -1.0), (gap, 0.0));
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

/// A floor and a wall that share an edge exactly, turned alike or not: a ray that leaves the floor
/// clear of the edge, however flat, meets the wall.
#[test]
fn a_ray_that_starts_before_a_shared_edge_meets_the_other_face() {
    let floor = flat((-1.0, 0.0), (0.0, 0.0));
    let wall = flat((0.0, 0.0), (0.0, 1.0));
    for wall in [wall.reversed_u(), wall] {
        let bvh = SurfaceBvh::build(&[floor.clone(), wall]).unwrap();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let mut random = Random::new(72);
            let mut left = 0;
            for _ in 0..2000 {
                let target = DVec3::new(-random.power_of_ten(-13.5, -6.0), 0.5, 0.0);
                let way = DVec3::new(0.2, 0.3, -random.power_of_ten(-3.0, 0.0));
                let first = tracer.first_hit(&Ray::new(target - 0.3 * way, way).unwrap());
                let Some(hit) = first.hit.filter(|_| !first.doubtful) else { continue };
                if hit.point.x > -2e-14 {
                    continue;
                }
                let way = DVec3::new(1.0, 0.05, random.power_of_ten(-4.0, 0.0));
                let query = Query::leaving(Ray::new(hit.point, way).unwrap(), &hit);
                let answer = tracer.first_hit(&query);
                assert!(answer.hit.is_some() || answer.doubtful, "{kernel}: {query:?}");
                left += 1;
            }
            assert!(left > 1000, "{left}");
        }
    }
}

/// A ray may start where `o + t d` comes to, beside the hit that it leaves. If it leaves at a flatter
/// angle than the first ray came, it is farther off along it: the hit is not met again for all that.
#[test]
fn a_start_beside_the_hit_is_not_met_again_by_a_flatter_ray() {
    let sphere = SurfaceBvh::build(&[shapes::sphere(1.0).unwrap()]).unwrap();
    let plane = SurfaceBvh::build(&[shapes::plane(2.0, 2.0).unwrap()]).unwrap();
    for (bvh, is_sphere) in [(&sphere, true), (&plane, false)] {
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let mut random = Random::new(73);
            let (mut onward, mut doubtful) = (Vec::new(), 0);
            for k in 0..3000 {
                let at = match is_sphere {
                    true => random.direction(),
                    false => DVec3::new(random.between(-0.9, 0.9), random.between(-0.9, 0.9), 0.0),
                };
                let normal = if is_sphere { at } else { DVec3::Z };
                let way = (random.perpendicular(normal) - 2.0 * normal).normalize();
                let far = [1.0, 100.0, 1e4][k % 3];
                let ray = Ray::new(at - far * way, way).unwrap();
                let first = tracer.first_hit(&ray);
                let Some(hit) = first.hit.filter(|_| !first.doubtful) else { continue };
                let normal = if is_sphere { hit.point.normalize() } else { DVec3::Z };
                let way = random.perpendicular(normal) + random.power_of_ten(-4.0, 0.0) * normal;
                let query = Query::leaving(Ray::new(ray.at(hit.t), way).unwrap(), &hit);
                assert!(query.start_root().is_some());
                let answer = tracer.first_hit(&query);
                assert!(answer.hit.is_none() || answer.doubtful, "{kernel}: {query:?}: {answer:?}");
                let shadow = tracer.occluded(&query);
                assert!(!shadow.occluded || shadow.doubtful, "{kernel}: {query:?}");
                doubtful += u32::from(answer.doubtful);
                onward.push(query);
            }
            println!("{kernel}: {} left beside their hit, {doubtful} in doubt", onward.len());
            assert!(onward.len() > 2500, "{}", onward.len());
            for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                let (mut answers, mut shadows) = (Vec::new(), Vec::new());
                tracer.first_hits(&onward, coherence, &mut answers);
                tracer.occlusions(&onward, coherence, &mut shadows);
                assert!(answers.iter().all(|answer| answer.hit.is_none() || answer.doubtful));
                assert!(shadows.iter().all(|shadow| !shadow.occluded || shadow.doubtful));
            }
        }
    }
}

/// A roof's ridge: a floor and a wall below it that share an edge exactly, each turned either way.
/// A ray that leaves the floor at the edge, down and across, comes out of the wall at once. A ray
/// that leaves both upwards meets neither again; where the faces are turned alike, surely so.
#[test]
fn a_ray_from_a_shared_edge_meets_the_other_face_however_it_is_turned() {
    let floor = flat((-1.0, 0.0), (0.0, 0.0));
    let wall = flat((0.0, 0.0), (0.0, -1.0));
    for (floor, wall, is_alike) in [
        (floor.clone(), wall.clone(), true),
        (floor.reversed_u(), wall.reversed_u(), true),
        (floor.clone(), wall.reversed_u(), false),
        (floor.reversed_u(), wall, false),
    ] {
        // The surface that is left is the first one given.
        let bvh = SurfaceBvh::build(&[floor, wall]).unwrap();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let mut random = Random::new(74);
            let (mut left, mut upwards, mut certain) = (0, 0, 0);
            for k in 0..3000 {
                let off = if k % 3 == 0 { 0.0 } else { random.power_of_ten(-17.0, -14.0) };
                let target = DVec3::new(-off, 0.5, 0.0);
                let way = DVec3::new(random.between(-0.3, 0.3), 0.3, -1.0);
                let first = tracer.first_hit(&Ray::new(target - way, way).unwrap());
                let Some(hit) = first.hit.filter(|_| !first.doubtful) else { continue };
                if hit.surface != 0 || hit.point.x > 0.0 {
                    continue;
                }
                left += 1;
                let [x, z] = [(); 2].map(|()| random.between(0.2, 1.0));
                let mut ask = |way: DVec3| {
                    let query = Query::leaving(Ray::new(hit.point, way).unwrap(), &hit);
                    assert!(query.start_root().is_some());
                    let answer = tracer.first_hit(&query);
                    let shadow = tracer.occluded(&query);
                    let exact = tracer.exact_first_hit(&query);
                    [
                        (answer.hit.is_some(), answer.doubtful),
                        (shadow.occluded, shadow.doubtful),
                        (exact.hit.is_some(), exact.doubtful),
                    ]
                };
                for (is_met, is_doubtful) in ask(DVec3::new(x, 0.2, -z)) {
                    assert!(is_met || is_doubtful, "{kernel}, {is_alike}: {hit:?}");
                }
                // From farther off, it may pass the wall's border within rounding.
                if hit.point.x < -5e-16 {
                    continue;
                }
                upwards += 1;
                for (is_met, is_doubtful) in ask(DVec3::new(x, 0.2, z)) {
                    assert!(!is_met || is_doubtful, "{kernel}, {is_alike}: {hit:?}");
                    certain += u32::from(!is_doubtful);
                }
            }
            println!("{kernel}, {is_alike}: {left}, upwards {upwards}: {certain} certain");
            assert!(left > 1000 && upwards > 500, "{upwards} of {left}");
            assert!(!is_alike || certain == 3 * upwards, "{certain} of {upwards}");
        }
    }
}

/// The corners and edges of a cube of six planes: rays that leave them outwards do so for certain.
#[test]
fn rays_leave_the_corners_of_a_cube() {
    let plane = shapes::plane(2.0, 2.0).unwrap().transformed(&DAffine3::from_translation(DVec3::Z));
    let plane = plane.unwrap();
    let turned = |axis: DVec3, angle: f64| {
        // Right angles, without rounding.
        let turn = DMat3::from_axis_angle(axis, angle);
        let turn = DMat3::from_cols(turn.x_axis.round(), turn.y_axis.round(), turn.z_axis.round());
        plane.transformed(&DAffine3::from_mat3(turn)).unwrap()
    };
    let quarter = |k: u32| turned(DVec3::X, f64::from(k) * FRAC_PI_2);
    let beside = |sign: f64| turned(DVec3::Y, sign * FRAC_PI_2);
    let faces = [quarter(0), quarter(1), quarter(2), quarter(3), beside(1.0), beside(-1.0)];
    let bvh = SurfaceBvh::build(&faces).unwrap();
    for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
        let mut tracer = bvh.tracer_with(kernel);
        let mut random = Random::new(75);
        let (mut left, mut certain) = (0, 0);
        for k in 0..3000 {
            let mut sign = || random.sign();
            let corner = DVec3::new(sign(), sign(), sign());
            let target = match k % 3 {
                0 => corner,
                1 => DVec3::new(random.between(-1.0, 1.0), corner.y, corner.z),
                _ => DVec3::new(corner.x, corner.y, random.between(-1.0, 1.0)),
            };
            let mut outwards = || {
                let [x, y, z] = [(); 3].map(|()| random.between(0.2, 1.0));
                corner * DVec3::new(x, y, z)
            };
            let [from, to] = [outwards(), outwards()];
            let first = tracer.first_hit(&Ray::new(target + from, -from).unwrap());
            let Some(hit) = first.hit.filter(|_| !first.doubtful) else { continue };
            let query = Query::leaving(Ray::new(hit.point, to).unwrap(), &hit);
            let answer = tracer.first_hit(&query);
            assert!(answer.hit.is_none() || answer.doubtful, "{kernel}: {query:?}: {answer:?}");
            left += 1;
            certain += u32::from(!answer.doubtful);
        }
        println!("{kernel}: {certain} of {left} certain");
        assert!(left > 2000 && certain == left, "{certain} of {left}");
    }
}

/// A strip whose end comes back to its beginning at a right angle, plainly or turned over: a ray
/// that leaves its beginning beside that joint, through the end, meets the end.
#[test]
fn a_strip_that_is_joined_to_itself_turned_over_is_met_beside_the_joint() {
    for (is_turned, is_reversed) in [(false, false), (true, false), (true, true)] {
        // A floor from x = 0 to −1, and far below it back to a wall under the joint.
        let (low, high) = if is_turned { (1.0, 0.0) } else { (0.0, 1.0) };
        let rows = [
            [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)],
            [(-1.0, 0.0, 0.0), (-1.0, 1.0, 0.0)],
            [(-5.0, 0.5, 1.0), (-5.0, 0.5, -1.0)],
            [(-5.0, low, -3.0), (-5.0, high, -4.0)],
            [(0.0, low, -4.0), (0.0, high, -4.0)],
            [(0.0, low, 0.0), (0.0, high, 0.0)],
        ];
        let net = rows.concat().into_iter().map(DVec3::from).collect();
        let knots = |count| KnotVector::clamped_uniform(1, count).unwrap();
        let strip = NurbsSurface::new(knots(rows.len()), knots(2), net, None).unwrap();
        let strip = if is_reversed { strip.reversed_u() } else { strip };
        let bvh = SurfaceBvh::build(&[strip]).unwrap();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let mut random = Random::new(76);
            let mut left = 0;
            for _ in 0..3000 {
                let off = random.power_of_ten(-17.0, -13.0);
                let target = DVec3::new(-off, random.between(0.1, 0.9), 0.0);
                let way = DVec3::new(random.between(-0.3, 0.3), 0.1, -1.0);
                let first = tracer.first_hit(&Ray::new(target - 0.3 * way, way).unwrap());
                let Some(hit) = first.hit.filter(|_| !first.doubtful) else { continue };
                if hit.point.x >= 0.0 || hit.normal.z.abs() < 0.9 {
                    continue;
                }
                let [x, z] = [(); 2].map(|()| random.between(0.2, 1.0));
                let query =
                    Query::leaving(Ray::new(hit.point, DVec3::new(x, 0.0, -z)).unwrap(), &hit);
                let (answer, exact) = (tracer.first_hit(&query), tracer.exact_first_hit(&query));
                let shadow = tracer.occluded(&query);
                assert!(answer.hit.is_some() || answer.doubtful, "{kernel}: {query:?}");
                assert!(exact.hit.is_some() || exact.doubtful, "{kernel}: {query:?}");
                assert!(shadow.occluded || shadow.doubtful, "{kernel}: {query:?}");
                left += 1;
            }
            assert!(left > 500, "{left}");
        }
    }
}
