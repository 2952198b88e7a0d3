//! Rays at and beside trim edges.

use std::f64::consts::TAU;

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::trim::Kept;
use nurbray::geometry::{KnotVector, NurbsSurface, TrimmedSurface, shapes};
use nurbray::intersect::{HitFlags, Kernel, Query};
use nurbray::math::Ray;

use crate::ask::{asked, build, circle, holed, polygon, through, trimmed};
use crate::random::Random;

#[test]
fn rays_at_the_edge_are_hits_and_say_so() {
    for turned in [false, true] {
        let surface = if turned { holed().reversed_u() } else { holed() };
        let bvh = build(&[surface.into()]);
        let mut random = Random::new(6);
        let nudged = |x: f64, ulps: f64| x + ulps * 0.5 * f64::EPSILON;
        let queries: Vec<Query> = (0..2000)
            .map(|k| {
                // Extremes and ends of segments, too.
                let angle = match k % 4 {
                    0 => TAU / 16.0 * (k % 16) as f64,
                    _ => random.between(0.0, TAU),
                };
                let edge = 0.6 * DVec2::from_angle(angle);
                let ulps = [0, 1].map(|_| random.below(9) as f64 - 4.0);
                let point = DVec3::new(nudged(edge.x, ulps[0]), nudged(edge.y, ulps[1]), 0.0);
                let direct = Ray::new(point + DVec3::Z, DVec3::NEG_Z).unwrap();
                if k % 2 == 0 { Query::primary(direct) } else { through(point, &mut random) }
            })
            .collect();
        for (who, hits) in asked(&bvh, &queries) {
            for (query, hit) in queries.iter().zip(&hits) {
                let flags = hit.expect("no doubt").map(|hit| hit.flags);
                assert_eq!(flags, Some(HitFlags::TRIM_EDGE), "{who}, {turned}: {query:?}");
            }
        }
    }
}

/// A parallelogram whose sides meet at a small angle, cut in two along a slanted line, from far away:
/// a place is off by more in each parameter than a step along one side would move it. Nothing leaks.
#[test]
fn nothing_leaks_between_the_halves_of_a_sheared_sheet() {
    for angle in [0.3, 1e-2, 1e-4] {
        let knots = || KnotVector::bezier(1).unwrap();
        let (a, b) = (DVec3::X, DVec3::new(1.0, angle, 0.0));
        let net = vec![DVec3::ZERO, b, a, a + b];
        let sheet = NurbsSurface::new(knots(), knots(), net, None).unwrap();
        let beside = polygon(&[(-1.0, -1.0), (0.2, -1.0), (0.7, 2.0), (-1.0, 2.0)]);
        let halves = [Kept::Odd, Kept::Even]
            .map(|kept| trimmed(sheet.clone(), kept, std::slice::from_ref(&beside)).into());
        let bvh = build(&halves);
        let mut random = Random::new(11);
        let mut queries = Vec::new();
        for k in 0..600 {
            let v = random.between(0.02, 0.98);
            let on_edge = sheet.point_at(DVec2::new(0.2 + (v + 1.0) / 6.0, v));
            let distance = [1.0, 1e3][k % 2];
            let tilt = DVec2::from_angle(random.between(0.0, TAU)) * random.between(0.0, 0.5);
            let way = tilt.extend(-1.0);
            queries.push(Query::primary(Ray::new(on_edge - distance * way, way).unwrap()));
        }
        for (who, hits) in asked(&bvh, &queries) {
            let lost = hits.iter().filter(|hit| **hit == Some(None)).count();
            assert_eq!(lost, 0, "{who}, {angle}");
            let met = hits.iter().filter_map(|hit| hit.as_ref()?.as_ref());
            assert!(
                met.clone().all(|hit| hit.flags.contains(HitFlags::TRIM_EDGE)),
                "{who}, {angle}"
            );
            assert!(met.count() > 100 || who == "all hits", "{who}, {angle}");
        }
    }
}

/// Of a square of side 2 about the origin, trims keep the left half, or a disk in the middle.
fn halves_and_disk() -> [TrimmedSurface; 2] {
    let plane = shapes::plane(2.0, 2.0).unwrap();
    let half = polygon(&[(-1.0, -1.0), (0.5, -1.0), (0.5, 2.0), (-1.0, 2.0)]);
    let disk = circle(0.5, 0.5, 0.2);
    [half, disk].map(|one| trimmed(plane.clone(), Kept::Odd, &[one]))
}

/// Just beyond the strip in which an edge is met, another search may have met it: all hits are in
/// doubt. Farther off, nothing is met, without doubt.
#[test]
fn all_hits_are_in_doubt_just_beyond_the_strip_beside_an_edge() {
    let [half, _] = halves_and_disk();
    let bvh = build(&[half.into()]);
    for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
        let (mut tracer, mut hits, mut random) =
            (bvh.tracer_with(kernel), Vec::new(), Random::new(9));
        let mut in_doubt = 0;
        for _ in 0..500 {
            let y = random.between(-0.9, 0.9);
            let mut at = |x: f64| {
                let ray = Ray::new(DVec3::new(x, y, 1.0), DVec3::NEG_Z).unwrap();
                let doubtful = tracer.all_hits(&ray, &mut hits);
                (hits.len(), doubtful)
            };
            // The error bound of a point is 2.7e-15 there; four times that is the strip.
            let (count, doubtful) = at(random.between(1.2e-14, 1.9e-14));
            assert!(count > 0 || doubtful, "{kernel}: {y}");
            in_doubt += u32::from(count == 0 && doubtful);
            assert_eq!(at(random.between(6e-14, 1e-12)), (0, false), "{kernel}: {y}");
            let (count, _) = at(random.between(-1e-14, 5e-15));
            assert_eq!(count, 1, "{kernel}: {y}");
        }
        assert!(in_doubt > 100, "{kernel}: {in_doubt}");
    }
}

/// Far from the origin for its size, a square is cut in two: a ray that passes the edge within half
/// of the error bound of a point meets it. All numbers are exact.
#[test]
fn edges_far_from_the_origin_are_met_as_far_off_as_points_may_be() {
    for exponent in [20, 24, 28, 32, 36, 40] {
        let far = 2f64.powi(exponent);
        // The error bound is 24 · 2⁻⁵³ of the largest coordinate, which is hardly more than `far`.
        let (unit, half_error) = (far * f64::EPSILON, 6);
        let knots = || KnotVector::bezier(1).unwrap();
        let net = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
        let net = net.map(|(x, y)| DVec3::new(far + x, y, 0.0)).to_vec();
        let square = NurbsSurface::new(knots(), knots(), net, None).unwrap();
        let half = polygon(&[(-1.0, -1.0), (0.5, -1.0), (0.5, 2.0), (-1.0, 2.0)]);
        let halves = [Kept::Odd, Kept::Even]
            .map(|kept| trimmed(square.clone(), kept, std::slice::from_ref(&half)));
        for half in halves {
            let bvh = build(&[half.into()]);
            let mut random = Random::new(12);
            let queries: Vec<Query> = (0..400)
                .map(|k| {
                    let aside = f64::from(k % (2 * half_error + 1) - half_error) * unit;
                    let origin = DVec3::new(far + aside, random.between(-0.9, 0.9), 1.0);
                    Query::primary(Ray::new(origin, DVec3::NEG_Z).unwrap())
                })
                .collect();
            for (who, hits) in asked(&bvh, &queries) {
                for (query, hit) in queries.iter().zip(&hits) {
                    let flags = hit.map(|hit| hit.map(|hit| hit.flags));
                    let is_told = flags.is_none_or(|flags| flags == Some(HitFlags::TRIM_EDGE));
                    assert!(is_told, "{who}, from 2^{exponent}: {query:?}, {flags:?}");
                }
            }
        }
    }
}

/// A ray in the plane of a sheet whose ends are cut off meets what is kept in between.
#[test]
fn a_ray_in_the_plane_of_what_is_kept_is_in_doubt_though_its_ends_are_cut_off() {
    let [_, disk] = halves_and_disk();
    let bvh = build(&[disk.into()]);
    for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
        let (mut tracer, mut hits, mut random) =
            (bvh.tracer_with(kernel), Vec::new(), Random::new(10));
        for _ in 0..50 {
            let through = 0.3 * DVec2::from_angle(random.between(0.0, TAU));
            let way = DVec2::from_angle(random.between(0.0, TAU));
            let ray = Ray::new((through - 4.0 * way).extend(0.0), way.extend(0.0)).unwrap();
            assert!(tracer.first_hit(&ray).doubtful, "{kernel}: {ray:?}");
            assert!(tracer.occluded(&ray).doubtful, "{kernel}: {ray:?}");
            assert!(tracer.all_hits(&ray, &mut hits), "{kernel}: {ray:?}");
        }
    }
}

/// Checks that rays across what is left of the plane z = 0, at all small angles, are met where
/// they cross it, or are doubtful. `way` gives the two ends of the way of a line in the plane over
/// what is left, grown by a length.
fn check_small_angles(
    name: &str,
    surface: TrimmedSurface,
    way: impl Fn(DVec2, DVec2, f64) -> Option<[f64; 2]>,
) {
    let bvh = build(&[surface.into()]);
    let mut random = Random::new(15);
    let rays = (0..8000).map(|_| {
        let along = DVec2::from_angle(random.between(0.0, TAU));
        let slope = random.power_of_ten(-14.0, -2.0) * random.sign();
        let at = DVec2::new(random.between(-1.0, 1.0), random.between(-1.0, 1.0));
        (at, along.extend(slope))
    });
    let rays: Vec<(DVec2, DVec3)> = rays.collect();
    let ray = |(at, along): &(DVec2, DVec3)| {
        Query::primary(Ray::new(at.extend(0.0) - 3.0 * along, *along).unwrap())
    };
    let queries: Vec<Query> = rays.iter().map(ray).collect();
    for (who, hits) in asked(&bvh, &queries) {
        let mut told = [0; 2];
        for (&(at, along), hit) in rays.iter().zip(&hits) {
            let context = || format!("{name}, {who}: {at} {along} {hit:?}");
            let Some(hit) = hit else {
                // Only at angles at which rounding moves the crossing by a few 1e-10 or more; the
                // exact solver, which has only boxes, may doubt some others.
                let by_boxes = who == "exact";
                assert!(by_boxes || along.z.abs() < 2e-5, "{}", context());
                continue;
            };
            told[usize::from(hit.is_some())] += 1;
            // The ray and the place where it crosses the plane are known to a few roundings.
            let rounding = 1e-14;
            let reach = rounding / along.z.abs();
            if hit.is_some() {
                let near = way(at, along.truncate(), rounding)
                    .is_some_and(|[from, to]| from <= reach && to >= -reach);
                assert!(near, "{}", context());
            } else {
                let inside = way(at, along.truncate(), -rounding)
                    .is_some_and(|[from, to]| from < -reach && to > reach);
                assert!(!inside, "{}", context());
            }
        }
        assert!(told.iter().all(|&count| count > 1000), "{name}, {who}: {told:?} told");
    }
}

#[test]
fn rays_at_small_angles_meet_no_edge_beside_their_way() {
    let disc = [circle(0.5, 0.5, 0.25)];
    let plane = shapes::plane(2.0, 2.0).unwrap();
    check_small_angles("disc", trimmed(plane, Kept::Odd, &disc), |at, along, grown| {
        let (middle, off) = (-at.dot(along), at.perp_dot(along));
        let square = (0.5 + grown).powi(2) - off * off;
        (square >= 0.0).then(|| [middle - square.sqrt(), middle + square.sqrt()])
    });

    // A rectangle in the parameters is one in space, however these run: evenly in one piece; in
    // several, with edges on knots; or as the square of something.
    let rectangle = [polygon(&[(0.25, 0.3), (0.75, 0.3), (0.75, 0.7), (0.25, 0.7)])];
    let flat = |degree: usize, x: &[f64]| {
        let knots = KnotVector::clamped_uniform(degree, x.len()).unwrap();
        let points = x.iter().flat_map(|&x| x_and_each(x)).collect();
        let linear = KnotVector::clamped_uniform(1, 2).unwrap();
        NurbsSurface::new(knots, linear, points, None).unwrap()
    };
    let pieces = flat(1, &[-1.0, -0.5, 0.0, 0.5, 1.0]);
    let smooth = flat(2, &[-1.0, -0.75, -0.25, 0.25, 0.75, 1.0]);
    let uneven = flat(2, &[-1.0, -0.9, 1.0]);
    let x_of_uneven = |u: f64| -(1.0 - u).powi(2) - 0.9 * 2.0 * u * (1.0 - u) + u * u;
    let even = [-0.5, 0.5];
    for (name, surface, [x0, x1]) in [
        ("pieces", pieces, even),
        ("smooth", smooth, even),
        ("uneven", uneven, [0.25, 0.75].map(x_of_uneven)),
    ] {
        let (low, high) = (DVec2::new(x0, -0.4), DVec2::new(x1, 0.4));
        let surface = trimmed(surface, Kept::Odd, &rectangle);
        check_small_angles(name, surface, |at, along, grown| {
            let (a, b) = ((low - grown - at) / along, (high + grown - at) / along);
            let (from, to) = (a.min(b).max_element(), a.max(b).min_element());
            (from <= to).then_some([from, to])
        });
    }
}

/// Points of the plane z = 0 at y = −1 and y = 1.
fn x_and_each(x: f64) -> [DVec3; 2] {
    [-1.0, 1.0].map(|y| DVec3::new(x, y, 0.0))
}

#[test]
fn a_ray_that_leaves_an_edge_at_a_small_angle_does_not_meet_it_again() {
    let disc = [circle(0.5, 0.5, 0.25)];
    let bvh = build(&[trimmed(shapes::plane(2.0, 2.0).unwrap(), Kept::Odd, &disc).into()]);
    let mut random = Random::new(16);
    for _ in 0..2000 {
        let out = DVec2::from_angle(random.between(0.0, TAU));
        let down = Ray::new((0.5 * out).extend(1.0), DVec3::NEG_Z).unwrap();
        let hit = bvh.tracer().first_hit(&Query::primary(down)).hit.expect("the edge");
        assert!(hit.flags.contains(HitFlags::TRIM_EDGE));
        // Outwards, so that the disc lies behind.
        let slope = random.power_of_ten(-12.0, -1.0) * random.sign();
        let turned = DVec2::from_angle(random.between(-1.0, 1.0)).rotate(out);
        let away = Ray::with_range(hit.point, turned.extend(slope), 0.0, f64::INFINITY).unwrap();
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(kernel);
            let answer = tracer.first_hit(&Query::leaving(away, &hit));
            assert!(answer.hit.is_none(), "{kernel}: {away:?} {answer:?}");
        }
    }
}

/// Where lids are cut out by trims and the side has none, their rim is met from a little farther
/// away as the edge of a lid than as the border of the side: a lid that is met alone is in doubt,
/// also by rays that nearly touch both faces.
#[test]
fn rays_past_the_rim_of_a_can_enter_as_often_as_they_leave() {
    let (middle, radius) = (DVec3::new(0.5, 0.5, 0.0), 0.25);
    let moved = |z: f64| DAffine3::from_translation(middle + z * DVec3::Z);
    let lid = trimmed(shapes::plane(1.0, 1.0).unwrap(), Kept::Odd, &[circle(0.5, 0.5, radius)]);
    let side = shapes::cylinder(radius, 1.0).unwrap();
    let bvh = build(&[
        lid.reversed_u().transformed(&moved(0.0)).unwrap().into(),
        lid.transformed(&moved(1.0)).unwrap().into(),
        side.transformed(&moved(0.0)).unwrap().into(),
    ]);
    let mut random = Random::new(31);
    let (mut tracer, mut hits) = (bvh.tracer(), Vec::new());
    for least in [0.0, -6.0] {
        let (rays, mut doubtful) = (10_000, 0);
        for _ in 0..rays {
            let outward = DVec2::from_angle(random.between(0.0, TAU));
            let target = middle + (radius * outward).extend(1.0);
            // From both faces, the ray is turned by up to a right angle, or by next to nothing.
            let mut turn = || random.sign() * random.power_of_ten(least, 0.0) * random.unit();
            let direction = (outward.perp() + turn() * outward).extend(turn()).normalize();
            let away = random.between(5.0, 20.0);
            // C ε M of bilinear surfaces.
            let unit = 12.0 * f64::EPSILON * away;
            let aside = random.between(0.0, 5.0) * unit * random.perpendicular(direction);
            let ray = Ray::new(target - away * direction + aside, direction).unwrap();
            let in_doubt = tracer.all_hits(&Query::primary(ray), &mut hits);
            doubtful += usize::from(in_doubt);
            let ways: f64 = hits.iter().map(|hit| hit.normal.dot(direction).signum()).sum();
            assert!(in_doubt || ways == 0.0, "{ray:?}: {hits:#?}");
        }
        println!("{doubtful} of {rays} in doubt");
        assert!(5 * doubtful < 3 * rays, "{doubtful} of {rays}");
    }
}
