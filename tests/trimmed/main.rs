//! Trimmed surfaces against closed forms, by every kernel: what is cut off is not met, what is
//! kept is, and edges do not leak.

#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::unwrap_used,
    reason = "a failing test is a panic, also in its helpers"
)]

mod ask;
mod corners;
mod edges;
mod far_knots;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/random.rs"]
mod random;

use std::f64::consts::TAU;

use glam::{DAffine3, DQuat, DVec2, DVec3};
use nurbray::geometry::trim::{Kept, Side, TrimDomain, TrimLoop, Trims};
use nurbray::geometry::{NurbsSurface, Surface, TrimmedSurface, shapes};
use nurbray::intersect::{Hit, HitFlags, Kernel, Query};
use nurbray::math::Ray;

use ask::{asked, build, circle, holed, polygon, through, trimmed};
use random::Random;

#[test]
fn a_plane_with_a_hole_is_met_beyond_its_radius() {
    let up = DAffine3::from_rotation_translation(
        DQuat::from_rotation_x(0.7),
        DVec3::new(3.0, -2.0, 40.0),
    );
    let stretch = DAffine3::from_scale(DVec3::new(1e-8, 1e-8, -1e-8));
    for map in [DAffine3::IDENTITY, up, stretch] {
        for turned in [false, true] {
            let surface = holed().transformed(&map).unwrap();
            let surface = if turned { surface.reversed_u() } else { surface };
            let size = map.matrix3.x_axis.length();
            let rounding = 1e-13 * (1.0 + map.translation.length() / size);
            let bvh = build(&[surface.into()]);
            let mut random = Random::new(5);
            let points: Vec<DVec2> = (0..3000)
                .map(|k| match k % 3 {
                    0 => DVec2::new(random.between(-1.2, 1.2), random.between(-1.2, 1.2)),
                    _ => {
                        // Near the edge, as near as can be told from rounding.
                        let off = random.power_of_ten(rounding.log10() + 1.0, -1.0) * random.sign();
                        (0.6 + off) * DVec2::from_angle(random.between(0.0, TAU))
                    }
                })
                .collect();
            let queries: Vec<Query> = points
                .iter()
                .map(|point| {
                    let flat = *through(point.extend(0.0), &mut random).ray();
                    let origin = map.transform_point3(flat.origin());
                    Query::primary(
                        Ray::new(origin, map.transform_vector3(flat.direction())).unwrap(),
                    )
                })
                .collect();
            for (who, hits) in asked(&bvh, &queries) {
                for (point, hit) in points.iter().zip(&hits) {
                    let context = || format!("{who}, {turned}: {point} {} {hit:?}", point.length());
                    let on_plane = point.abs().max_element() <= 1.0;
                    let kept = on_plane && point.length() > 0.6;
                    let hit = hit.expect("no doubt");
                    assert_eq!(hit.is_some(), kept, "{}", context());
                    let flagged = hit.is_some_and(|hit| hit.flags.contains(HitFlags::TRIM_EDGE));
                    assert!(!flagged, "{}", context());
                    if let Some(hit) = hit {
                        let mut normal = map.matrix3.inverse().transpose() * DVec3::Z;
                        normal *= map.matrix3.determinant().signum();
                        let normal = if turned { -normal } else { normal }.normalize();
                        assert!(hit.normal.distance(normal) < 1e-9, "{}", context());
                    }
                }
            }
        }
    }
}

#[test]
fn a_ray_goes_on_behind_what_is_cut_off() {
    // Through the hole of one sheet to the next, and so on; from a hit likewise.
    let at = |z: f64| DAffine3::from_translation(DVec3::new(0.0, 0.0, z));
    let mut surfaces: Vec<Surface> =
        (0..4).map(|k| holed().transformed(&at(f64::from(k))).unwrap().into()).collect();
    surfaces.push(shapes::plane(2.0, 2.0).unwrap().transformed(&at(-1.0)).unwrap().into());
    let bvh = build(&surfaces);
    let mut random = Random::new(7);
    let queries: Vec<Query> = (0..1000)
        .map(|_| {
            let target = DVec2::new(random.between(-0.9, 0.9), random.between(-0.9, 0.9));
            let from = DVec2::new(random.between(-0.9, 0.9), random.between(-0.9, 0.9));
            let origin = from.extend(5.0);
            Query::primary(Ray::new(origin, target.extend(-1.0) - origin).unwrap())
        })
        .collect();
    let first_met = |ray: &Ray, below: f64| {
        let heights = (0..4).rev().map(|k| (k, f64::from(k))).chain([(4, -1.0)]);
        heights.filter(|(_, z)| *z < below).find_map(|(k, z)| {
            let t = (z - ray.origin().z) / ray.direction().z;
            let at = ray.at(t).truncate();
            (k == 4 || at.length() > 0.6).then_some((k as u32, t))
        })
    };
    for (who, hits) in asked(&bvh, &queries) {
        let mut tracer = bvh.tracer();
        for (query, hit) in queries.iter().zip(&hits) {
            let (surface, t) = first_met(query.ray(), 6.0).unwrap();
            let hit = hit.expect("no doubt").unwrap();
            assert_eq!(hit.surface, surface, "{who}: {query:?}");
            assert!((hit.t - t).abs() < 1e-13);
            if surface == 4 {
                continue;
            }
            let onwards = Ray::new(hit.point, query.ray().direction()).unwrap();
            let next = tracer.first_hit(&Query::leaving(onwards, &hit)).hit.unwrap();
            let (surface, _) = first_met(query.ray(), hit.point.z - 0.5).unwrap();
            assert_eq!(next.surface, surface, "{who}: leaving {query:?}");
        }
    }
}

#[test]
fn faces_of_one_plane_do_not_see_each_other() {
    // A sheet, a disk that fills its hole, and a ceiling. Of the disk's whole plane, the part that
    // is cut off lies in the sheet, and the other way round.
    let map = DAffine3::from_rotation_translation(
        DQuat::from_rotation_x(0.4) * DQuat::from_rotation_z(1.1),
        DVec3::new(3.0, -1.0, 2.0),
    );
    let disk = trimmed(shapes::plane(2.0, 2.0).unwrap(), Kept::Odd, &[circle(0.5, 0.5, 0.3)]);
    let ceiling = shapes::plane(40.0, 40.0).unwrap();
    let above = map * DAffine3::from_translation(DVec3::Z);
    let bvh = build(&[
        holed().transformed(&map).unwrap().into(),
        disk.transformed(&map).unwrap().into(),
        ceiling.transformed(&above).unwrap().into(),
    ]);
    let mut random = Random::new(11);
    let mut tracer = bvh.tracer();
    let mut seen = [0; 2];
    let mut upwards = Vec::new();
    let queries: Vec<Query> = (0..3000)
        .map(|_| {
            let place = DVec3::new(random.between(-0.99, 0.99), random.between(-0.99, 0.99), 0.0);
            let down = Ray::new(map.transform_point3(place + 0.5 * DVec3::Z), -map.matrix3.z_axis);
            let hit = tracer.first_hit(&down.unwrap()).hit.unwrap();
            seen[hit.surface as usize] += 1;
            let direction = random.direction();
            upwards.push(direction.z);
            let direction = map.transform_vector3(direction);
            Query::leaving(Ray::new(hit.point, direction).unwrap(), &hit)
        })
        .collect();
    assert!(seen.iter().all(|&count| count > 500));
    for (who, hits) in asked(&bvh, &queries) {
        for (up, hit) in upwards.iter().zip(&hits) {
            let hit = hit.unwrap_or_else(|| panic!("{who}: a doubt"));
            // The ceiling ends somewhere.
            assert!(hit.is_some() || *up < 0.06, "{who}: {up}");
            assert!(hit.is_none_or(|hit| hit.surface == 2 && *up > 0.0), "{who}: {up} {hit:?}");
        }
    }
}

/// Loops for the parameters of a sphere, in parts of its domain: one across the seam, one
/// through the middle, one around a pole.
fn sphere_loops(sphere: &NurbsSurface) -> Vec<TrimLoop> {
    let [u, v] = sphere.domain();
    let at = |a: f64, b: f64| (u[0] + a * (u[1] - u[0]), v[0] + b * (v[1] - v[0]));
    let closes_in_u = sphere.closes(nurbray::geometry::Direction::U);
    assert_ne!(closes_in_u, sphere.closes(nurbray::geometry::Direction::V));
    let turned = |along: f64, across: f64| match closes_in_u {
        true => at(along, across),
        false => at(across, along),
    };
    let about = |along: f64, across: f64, size: f64| {
        let corners: Vec<(f64, f64)> = (0..7)
            .map(|k| {
                let d = size * DVec2::from_angle(TAU * f64::from(k) / 7.0);
                turned(along + d.x, across + d.y)
            })
            .collect();
        polygon(&corners)
    };
    vec![
        about(0.0, 0.4, 0.11), // across the seam
        about(0.55, 0.5, 0.2),
        about(0.55, 0.5, 0.1), // an island in it
        polygon(&[turned(0.2, 0.0), turned(0.2, 0.2), turned(0.4, 0.2), turned(0.4, 0.0)]),
    ]
}

#[test]
fn complementary_trims_make_a_closed_body() {
    for sphere in [shapes::sphere(1.0).unwrap(), shapes::sphere_biquadratic(1.0).unwrap()] {
        let loops = sphere_loops(&sphere);
        let [inside, outside] =
            [Kept::Odd, Kept::Even].map(|kept| trimmed(sphere.clone(), kept, &loops));
        let outlines = inside.trims().outlines(1e-3).unwrap();
        let bvh = build(&[inside.into(), outside.into()]);
        let mut random = Random::new(8);

        // Points of edges, corners among them, and any points.
        let [u, v] = sphere.domain();
        let mut queries = Vec::new();
        for _ in 0..1500 {
            let outline = &outlines[random.below(outlines.len())];
            let k = random.below(outline.len() - 1);
            let share = if random.below(3) == 0 { 0.0 } else { random.unit() };
            let mut uv = outline[k].lerp(outline[k + 1], share);
            // Loops across the seam run beyond the domain.
            let wrap = |x: f64, [from, to]: [f64; 2]| from + (x - from).rem_euclid(to - from);
            uv = DVec2::new(wrap(uv.x, u), wrap(uv.y, v));
            let point = sphere.point_at(uv);
            let direction = random.direction();
            let steep = direction.dot(point).abs() > 0.02;
            if steep {
                let ray = Ray::new(point - 3.0 * direction, direction).unwrap();
                queries.push(Query::primary(ray));
            }
            let any = Ray::new(3.0 * random.direction(), random.direction()).unwrap();
            let towards = Ray::new(any.origin(), 0.9 * random.direction() - any.origin());
            queries.push(Query::primary(towards.unwrap()));
        }
        let mut tracer = bvh.tracer();
        let (mut hits, mut edges) = (Vec::new(), 0);
        for query in &queries {
            let doubtful = tracer.all_hits(query, &mut hits);
            assert!(!doubtful, "{query:?}");
            assert_eq!(hits.len(), 2, "{query:?}: {hits:#?}");
            edges += hits.iter().filter(|hit| hit.flags.contains(HitFlags::TRIM_EDGE)).count();
            assert!(hits[0].normal.dot(query.ray().direction()) < 0.0);
            assert!(hits[1].normal.dot(query.ray().direction()) > 0.0);
        }
        assert!(edges > 1000, "{edges} of the rays at edges met them");
        // No ray gets out of the body, however it is traced: from inside all rays hit.
        let out: Vec<Query> = queries
            .iter()
            .map(|query| {
                let end = query.ray().at(tracer.first_hit(query).hit.unwrap().t);
                Query::primary(Ray::new(0.3 * random.direction(), end).unwrap())
            })
            .collect();
        for (who, hits) in asked(&bvh, &out) {
            for (query, hit) in out.iter().zip(&hits) {
                assert!(hit.expect("no doubt").is_some(), "{who}: {query:?}");
            }
        }
    }
}

#[test]
fn a_can_with_cut_out_lids_is_closed() {
    // The circle touches the border of its square in four points.
    let lid = trimmed(shapes::plane(2.0, 2.0).unwrap(), Kept::Odd, &[circle(0.5, 0.5, 0.5)]);
    let top = lid.transformed(&DAffine3::from_translation(DVec3::Z)).unwrap();
    let side = shapes::cylinder(1.0, 1.0).unwrap();
    let bvh = build(&[lid.reversed_u().into(), top.into(), side.into()]);
    let mut random = Random::new(9);
    let middle = DVec3::new(0.0, 0.0, 0.5);
    let rim = |random: &mut Random, k: i32| {
        let angle =
            if k % 3 == 0 { TAU / 8.0 * f64::from(k % 8) } else { random.between(0.0, TAU) };
        DVec2::from_angle(angle).extend(if random.below(2) == 0 { 0.0 } else { 1.0 })
    };
    let queries: Vec<Query> = (0..2000)
        .map(|k| {
            let from = middle + 0.4 * random.cube() * DVec3::new(1.0, 1.0, 1.0);
            let to = if k % 2 == 0 { rim(&mut random, k) } else { from + random.direction() };
            Query::primary(Ray::new(from, to - from).unwrap())
        })
        .collect();
    for (who, hits) in asked(&bvh, &queries) {
        for (query, hit) in queries.iter().zip(&hits) {
            assert!(hit.expect("no doubt").is_some(), "{who}: {query:?} leaves");
        }
    }
    let mut tracer = bvh.tracer();
    for _ in 0..2000 {
        let origin = middle + 3.0 * random.direction();
        let target = middle + random.cube() * DVec3::new(0.7, 0.7, 0.5);
        let mut hits = Vec::new();
        let query = Query::primary(Ray::new(origin, target - origin).unwrap());
        assert!(!tracer.all_hits(&query, &mut hits));
        assert_eq!(hits.len(), 2, "{query:?}: {hits:#?}");
    }
}

#[test]
fn a_hole_across_the_seam_is_as_one_away_from_it() {
    let cylinder = || shapes::cylinder(1.0, 1.0).unwrap();
    let [[u0, u1], [v0, v1]] = cylinder().domain();
    let at = |a: f64, b: f64| (u0 + a * (u1 - u0), v0 + b * (v1 - v0));
    let hole =
        |a: f64| polygon(&[at(a - 0.1, 0.3), at(a + 0.1, 0.2), at(a + 0.07, 0.8), at(a, 0.6)]);
    let bvhs = [0.0, 0.5, 1.0].map(|a| {
        let surface = trimmed(cylinder(), Kept::Even, &[hole(a)]);
        let edges = surface.trims().outlines(1e-3).unwrap();
        (build(&[surface.into()]), edges)
    });
    // Half a turn takes the one to the other, and is exact.
    let turned = |p: DVec3| DVec3::new(-p.x, -p.y, p.z);
    let mut random = Random::new(10);
    let edges = &bvhs[1].1;
    let queries: Vec<Query> = (0..2000)
        .map(|k| {
            let target = if k % 2 == 0 {
                let outline = &edges[random.below(edges.len())];
                let uv = outline[random.below(outline.len())];
                cylinder().point_at(uv)
            } else {
                let (u, v) = at(random.between(0.35, 0.65), random.unit());
                cylinder().point_at(DVec2::new(u, v))
            };
            let origin = target + random.between(0.5, 3.0) * random.direction();
            Query::primary(Ray::new(origin, target - origin).unwrap())
        })
        .collect();
    let half_turn: Vec<Query> = queries
        .iter()
        .map(|query| {
            let (o, d) = (turned(query.ray().origin()), turned(query.ray().direction()));
            Query::primary(Ray::new(o, d).unwrap())
        })
        .collect();
    let away = asked(&bvhs[1].0, &queries);
    for seam in [&bvhs[0].0, &bvhs[2].0] {
        let across = asked(seam, &half_turn);
        for ((who, one), (_, other)) in away.iter().zip(&across) {
            for ((query, a), b) in queries.iter().zip(one).zip(other) {
                let (Some(a), Some(b)) = (a, b) else { continue }; // past the silhouette
                let t = |hit: &Option<Hit>| hit.map(|hit| hit.t);
                let edge = |hit: &Option<Hit>| {
                    hit.is_some_and(|hit| hit.flags.contains(HitFlags::TRIM_EDGE))
                };
                assert_eq!(edge(a), edge(b), "{who}: {query:?}\n{a:?}\n{b:?}");
                match (t(a), t(b)) {
                    (None, None) => {}
                    (Some(x), Some(y)) => assert!((x - y).abs() < 1e-9, "{who}: {query:?}"),
                    _ => panic!("{who}: {query:?}\n{a:?}\n{b:?}"),
                }
            }
        }
    }
}

#[test]
fn what_is_cut_off_takes_no_leaves() {
    let sphere = shapes::sphere(1.0).unwrap();
    let [u, v] = sphere.domain();
    let corner = (u[0] + 0.25 * (u[1] - u[0]), v[0] + 0.25 * (v[1] - v[0]));
    let part = trimmed(
        sphere.clone(),
        Kept::Odd,
        &[polygon(&[(u[0], v[0]), (corner.0, v[0]), corner, (u[0], corner.1)])],
    );
    let (low, high) = build(&[part.clone().into()]).bounds().unwrap();
    let (whole_low, whole_high) = build(&[sphere.clone().into()]).bounds().unwrap();
    let volume = |low: DVec3, high: DVec3| (high - low).element_product();
    assert!(volume(low, high) < 0.3 * volume(whole_low, whole_high), "{low} {high}");
    let bvh = build(&[part.into(), sphere.into()]);
    assert!(bvh.leaf_count(0) < bvh.leaf_count(1));
    assert!(bvh.leaves().iter().any(|leaf| leaf.is_trimmed()));
}

#[test]
fn trims_of_another_domain_are_refused() {
    let domain = TrimDomain::new([0.0, 2.0], [0.0, 1.0]).unwrap();
    let trims = Trims::new(domain, Kept::Odd, &[circle(0.5, 0.5, 0.2)]).unwrap();
    let error = TrimmedSurface::new(shapes::plane(1.0, 1.0).unwrap(), trims).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the trims are made for the domain (0, 0) to (2, 1), but the surface's is (0, 0) to (1, 1)"
    );
}

#[test]
fn a_ray_within_the_surface_is_in_doubt_about_its_holes() {
    let bvh = build(&[holed().into()]);
    let mut random = Random::new(11);
    for k in 0..300 {
        let from = 3.0 * DVec2::from_angle(random.between(0.0, TAU));
        let to = DVec2::new(random.between(-0.9, 0.9), random.between(-0.9, 0.9));
        let origin = if k % 2 == 0 { from } else { 0.1 * from }; // from within the hole, too
        let ray = Ray::new(origin.extend(0.0), (to - origin).extend(0.0)).unwrap();
        let query = Query::primary(ray);
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            assert!(tracer.first_hit(&query).doubtful, "{kernel}: {ray:?}");
            assert!(tracer.occluded(&query).doubtful, "{kernel}: {ray:?}");
        }
        assert!(bvh.tracer().exact_first_hit(&query).doubtful, "{ray:?}");
    }
}

#[test]
fn nothing_is_met_where_nothing_is_left() {
    let domain = [(-1.0, -1.0), (2.0, -1.0), (2.0, 2.0), (-1.0, 2.0)];
    let nothing = trimmed(shapes::plane(2.0, 2.0).unwrap(), Kept::Even, &[polygon(&domain)]);
    let bvh = build(&[nothing.into()]);
    assert_eq!((bvh.leaf_count(0), bvh.bounds()), (0, None));
    let down = Query::primary(Ray::new(DVec3::new(0.1, 0.2, 1.0), DVec3::NEG_Z).unwrap());
    for (who, hits) in asked(&bvh, &[down; 3]) {
        assert!(hits.iter().all(|hit| hit.expect("no doubt").is_none()), "{who}");
    }
}

#[test]
fn trims_are_mirrored_with_their_surface() {
    let part = trimmed(
        shapes::cylinder(1.0, 1.0).unwrap(),
        Kept::Odd,
        &[polygon(&[(-0.1, 0.1), (0.3, 0.2), (0.2, 0.9)]), circle(0.6, 0.5, 0.1)],
    );
    let [[u0, u1], _] = part.surface().domain();
    let mirrored = part.reversed_u();
    let mut random = Random::new(12);
    for _ in 0..5000 {
        let uv = DVec2::new(random.between(u0, u1), random.unit());
        let there = DVec2::new(u0 + (u1 - uv.x), uv.y);
        assert_eq!(part.keeps(uv), mirrored.keeps(there), "{uv}");
    }
    assert_eq!(mirrored.reversed_u().trims().segment_count(), part.trims().segment_count());
    assert_eq!(mirrored.trims().loop_count(), part.trims().loop_count());
}

#[test]
fn trims_are_exchanged_with_u_and_v_of_their_surface() {
    // The base of a cone's side is no pole, its tip is one; and it has a seam.
    for surface in [shapes::cylinder(1.0, 1.0).unwrap(), shapes::cone(1.0, 1.0).unwrap()] {
        let part = trimmed(
            surface,
            Kept::Odd,
            &[polygon(&[(-0.1, 0.1), (0.3, 0.2), (0.2, 0.9)]), circle(0.6, 0.5, 0.1)],
        );
        let swapped = part.swapped();
        assert_eq!(swapped.surface(), &part.surface().swapped());
        let [domain, there] = [&part, &swapped].map(|one| one.trims().domain());
        let expected = TrimDomain::with_seams_of(&part.surface().swapped()).unwrap();
        assert_eq!((there, there.range()[0]), (expected, domain.range()[1]));
        let [[u0, u1], _] = part.surface().domain();
        let mut random = Random::new(12);
        for _ in 0..5000 {
            let uv = DVec2::new(random.between(u0, u1), random.unit());
            let vu = DVec2::new(uv.y, uv.x);
            assert_eq!(part.trims().side_of(uv), swapped_side(swapped.trims().side_of(vu)), "{uv}");
        }
        let back = swapped.swapped();
        assert_eq!(back.surface(), part.surface());
        assert_eq!(back.trims().segment_count(), part.trims().segment_count());
        assert_eq!(swapped.trims().loop_count(), part.trims().loop_count());
    }
}

/// The same side, its distance in u and in v exchanged.
fn swapped_side(side: Side) -> Side {
    match side {
        Side::Edge { inside, distance } => {
            Side::Edge { inside, distance: DVec2::new(distance.y, distance.x) }
        }
        other => other,
    }
}

/// At a pole all parameters of a side are one point. The point is there if any of them is kept,
/// and is met at a kept one.
#[test]
fn a_pole_partly_cut_off_is_met_at_kept_parameters() {
    let notch = circle(0.0, 0.3, 0.1);
    // All that piece 0 has of the pole, and more.
    let most = polygon(&[(-0.1, -0.05), (0.3, -0.05), (0.3, 0.7), (-0.1, 0.7)]);
    for (name, cut, kept) in [("notch", notch, 0.0), ("most", most, 0.7)] {
        for size in [1e-8, 1.0, 1e8] {
            let sphere = shapes::sphere(size).unwrap();
            let pole = sphere.point_at(DVec2::new(0.0, 0.5));
            let domain = TrimDomain::of(&sphere).unwrap();
            let trims = Trims::new(domain, Kept::Even, std::slice::from_ref(&cut)).unwrap();
            let part = TrimmedSurface::new(sphere, trims).unwrap();
            let bvh = build(&[part.clone().into()]);
            let mut random = Random::new(17);
            let queries: Vec<Query> = (0..400)
                .map(|_| {
                    let off = 1e-16 * random.power_of_ten(-2.0, 0.5) * size;
                    let at = pole + off * random.direction();
                    let direction = random.direction() - DVec3::Z * pole.z.signum();
                    let direction = direction.normalize();
                    let origin = at - random.between(0.5, 3.0) * size * direction;
                    Query::primary(Ray::new(origin, direction).unwrap())
                })
                .collect();
            let mut met = 0;
            for (who, hits) in asked(&bvh, &queries) {
                for (hit, query) in hits.iter().zip(&queries) {
                    let Some(Some(hit)) = hit else { continue };
                    if hit.point.distance(pole) > 1e-15 * size {
                        continue;
                    }
                    met += 1;
                    assert!(part.keeps(hit.uv), "{name}, {size:e}, {who}: {hit:?} {query:?}");
                    assert!(hit.uv.y >= kept, "{name}, {size:e}, {who}: {hit:?}");
                }
            }
            assert!(met > 1000, "{name}, {size:e}: {met} of {} hits", queries.len());
        }
    }
}
