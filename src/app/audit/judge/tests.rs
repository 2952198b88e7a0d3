//! What is a fault, and what is not.

use glam::DAffine3;
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
use nurbray::geometry::{KnotVector, NurbsSurface, TrimmedSurface, shapes};
use nurbray::intersect::{Query, SurfaceBvh};

use super::*;

/// A doubtful occlusion answer, which is not judged.
const OPEN: Occlusion = Occlusion { occluded: false, doubtful: true };

/// Calls `check` with what both solvers say of a unit sphere met head on at t = 2 and t = 4.
fn head_on(check: impl Fn(&dyn Fn(Answer, &[Hit]) -> Finding, Answer, &[Hit])) {
    let surfaces = [shapes::sphere(1.0).unwrap().into()];
    let bvh = SurfaceBvh::build(&surfaces).unwrap();
    let direction = DVec3::new(-0.6, -0.48, -0.64);
    let query = Query::primary(Ray::new(-3.0 * direction, direction).unwrap());
    let mut tracer = bvh.tracer();
    let answer = tracer.first_hit(&query);
    let mut hits = Vec::new();
    assert!(!tracer.exact_all_hits(&query, &mut hits));
    assert_eq!(hits.len(), 2);
    let judge = Judge::new(&surfaces);
    let shot = Shot::of(query);
    let ruling = |answer: Answer, hits: &[Hit]| {
        judge.judge(&shot, (&answer, OPEN), &Truth { hits, undecided: false })
    };
    check(&ruling, answer, &hits);
}

/// A sheet over `y` from 0 to 3, a third of which lies in a tiny knot span.
#[test]
fn parameters_are_rounded_before_a_knot_too() {
    let knot = 1.0 + 1e-6;
    let knots = KnotVector::new(1, vec![0.0, 0.0, 1.0, knot, 1.0 + knot, 1.0 + knot]).unwrap();
    let points = [0.0, 1.0].map(|x| [0.0, 1.0, 2.0, 3.0].map(|y| DVec3::new(x, y, 0.0)));
    let across = KnotVector::bezier(1).unwrap();
    let surface = NurbsSurface::new(across, knots, points.concat(), None).unwrap();
    let ray = Ray::new(DVec3::new(0.5, 2.0, 1.0), -DVec3::Z).unwrap();
    let surfaces = [surface.into()];
    let judge = Judge::new(&surfaces);
    let bound = |v: f64| judge.at(&ray, Site { surface: 0, uv: DVec2::new(0.5, v) }, 1.0).bound;
    assert!(bound(knot) > 1e6 * UNIT_ROUNDOFF, "{:e}", bound(knot));
    assert!(bound(knot + 0.1) < 1e3 * UNIT_ROUNDOFF, "{:e}", bound(knot + 0.1));
}

/// Whether a hit is owed that lies beyond a trim edge by `off` times the promise of a point.
#[test]
fn what_lies_beyond_a_trim_edge_by_more_than_the_promise_is_not_owed() {
    let knots = KnotVector::bezier(1).unwrap();
    let points = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)];
    let net = points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    let plane = NurbsSurface::new(knots.clone(), knots, net, None).unwrap();
    let domain = TrimDomain::of(&plane).unwrap();
    let half = TrimLoop::rectangle(UvBox::new([0.0, 0.5], [0.0, 1.0])).unwrap();
    let trims = Trims::new(domain, Kept::Odd, &[half]).unwrap();
    let surfaces = [TrimmedSurface::new(plane, trims).unwrap().into()];
    let bvh = SurfaceBvh::build(&surfaces).unwrap();
    let judge = Judge::new(&surfaces);
    let promise = residual_factor(1, 1);
    // Within twice the error bound of the curves themselves, and far beyond it.
    for (off, owed) in [(-10.0, true), (-1.0, true), (0.0, true), (0.5, true), (10.0, false)] {
        let x = 0.5 + off * promise;
        let ray = Ray::new(DVec3::new(x, 0.5, 1.0), -DVec3::Z).unwrap();
        let seen = Ray::new(DVec3::new(0.4, 0.5, 1.0), -DVec3::Z).unwrap();
        let seen = bvh.tracer().first_hit(&Query::primary(seen)).hit.unwrap();
        let uv = DVec2::new(x, 0.5);
        let point = DVec3::new(x, 0.5, 0.0);
        let root = Hit { uv, point, flags: HitFlags::TRIM_EDGE, ..seen };
        let shot = Shot::of(Query::primary(ray));
        let truth = Truth { hits: &[root], undecided: false };
        let fault = judge.judge(&shot, (&Answer::default(), OPEN), &truth).fault;
        assert_eq!(fault, owed.then_some(Fault::Miss), "{off}");
    }
}

#[test]
fn what_is_right_has_no_fault() {
    head_on(|ruling, answer, hits| {
        let finding = ruling(answer, hits);
        assert_eq!(finding.fault, None);
        assert!(finding.error.unwrap() < 1e-15);
        // One rounding of t is no other root.
        let hit = answer.hit.unwrap();
        let moved = Answer { hit: Some(Hit { t: hit.t.next_up(), ..hit }), ..answer };
        assert_eq!(ruling(moved, hits).fault, None);
        let finding = ruling(Answer::default(), &[]);
        assert_eq!((finding.fault, finding.error, finding.tangent), (None, None, false));
        assert_eq!((finding.doubtful, finding.doubtful_any), (false, true));
    });
}

#[test]
fn a_lost_hit_is_a_miss_unless_it_is_doubted() {
    head_on(|ruling, answer, hits| {
        let lost = Answer { hit: None, ..answer };
        assert_eq!(ruling(lost, hits).fault, Some(Fault::Miss));
        let finding = ruling(Answer { doubtful: true, ..lost }, hits);
        assert_eq!((finding.fault, finding.doubtful), (None, true));
        let mut doubted = hits.to_vec();
        doubted.iter_mut().for_each(|hit| hit.flags.insert(HitFlags::DOUBTFUL));
        assert_eq!(ruling(lost, &doubted).fault, None);
    });
}

#[test]
fn the_far_side_is_a_wrong_root() {
    head_on(|ruling, answer, hits| {
        let far = Answer { hit: Some(hits[1]), ..answer };
        assert_eq!(ruling(far, hits).fault, Some(Fault::WrongRoot));
        assert_eq!(ruling(Answer { doubtful: true, ..far }, hits).fault, None);
    });
}

#[test]
fn what_is_not_there_is_a_false_hit() {
    head_on(|ruling, answer, hits| {
        let hit = answer.hit.unwrap();
        let falsified = |hit: Hit| ruling(Answer { hit: Some(hit), ..answer }, hits).fault;
        assert_eq!(falsified(Hit { t: hit.t - 1e-12, ..hit }), Some(Fault::FalseHit));
        assert_eq!(falsified(Hit { t: f64::NAN, ..hit }), Some(Fault::FalseHit));
        assert_eq!(falsified(Hit { surface: 7, ..hit }), Some(Fault::FalseHit));
        assert_eq!(ruling(answer, &[]).fault, Some(Fault::FalseHit));
    });
}

#[test]
fn shadows_are_judged_by_whether_anything_is_there() {
    let surfaces = [shapes::sphere(1.0).unwrap().into()];
    let bvh = SurfaceBvh::build(&surfaces).unwrap();
    let judge = Judge::new(&surfaces);
    let direction = DVec3::new(-0.6, -0.48, -0.64);
    let beside = direction.any_orthonormal_vector();
    let mut tracer = bvh.tracer();
    for (aside, is_met) in [(0.0, true), (0.999, true), (1.001, false)] {
        let query = Query::primary(Ray::new(aside * beside - 3.0 * direction, direction).unwrap());
        let shot = Shot::of(query);
        let mut hits = Vec::new();
        let undecided = tracer.exact_all_hits(&query, &mut hits);
        let truth = Truth { hits: &hits, undecided };
        let first = tracer.first_hit(&query);
        let said = |occluded, doubtful| {
            let shadow = Occlusion { occluded, doubtful };
            let finding = judge.judge(&shot, (&first, shadow), &truth);
            (finding.fault, finding.doubtful_any)
        };
        assert_eq!(said(is_met, false), (None, false), "{aside}");
        let wrong = if is_met { Fault::Miss } else { Fault::FalseHit };
        assert_eq!(said(!is_met, false), (Some(wrong), false), "{aside}");
        assert_eq!(said(!is_met, true), (None, true), "{aside}");
    }
}

/// A ray that runs within a plane meets it all along: any of these points is the same root.
#[test]
fn roots_between_which_a_ray_stays_on_the_surface_are_one() {
    let knots = || KnotVector::bezier(1).unwrap();
    let points = [0.0, 1.0].map(|x| [0.0, 1.0].map(|y| DVec3::new(x, y, 0.0))).concat();
    let weights = vec![1.0, 1e3, 1.0, 1e3];
    let plane = NurbsSurface::new(knots(), knots(), points, Some(weights)).unwrap();
    let surfaces = [Surface::from(plane)];
    let judge = Judge::new(&surfaces);
    let seen = Ray::new(DVec3::new(0.5, 0.5, 1.0), -DVec3::Z).unwrap();
    let bvh = SurfaceBvh::build(&surfaces).unwrap();
    let seen = bvh.tracer().first_hit(&Query::primary(seen)).hit.unwrap();
    let along = Ray::new(DVec3::new(0.5, -1.0, 0.0), DVec3::Y).unwrap();
    let [near, far] = [0.3, 0.9].map(|v| {
        let uv = DVec2::new(0.5, v);
        let point = surfaces[0].point_at(uv);
        Hit { t: point.y + 1.0, uv, point, ..seen }
    });
    let shot = Shot::of(Query::primary(along));
    let truth = Truth { hits: &[near], undecided: false };
    let answer = Answer { hit: Some(far), doubtful: false };
    assert_eq!(judge.judge(&shot, (&answer, OPEN), &truth).fault, None);
}

#[test]
fn exactly_tangent_rays_are_told_from_grazing_ones() {
    let surfaces = [shapes::sphere(1.0).unwrap().into()];
    let bvh = SurfaceBvh::build(&surfaces).unwrap();
    let judge = Judge::new(&surfaces);
    let (normal, direction) = (DVec3::new(0.6, 0.48, 0.64), DVec3::new(0.8, -0.36, -0.48));
    let mut tracer = bvh.tracer();
    for (depth, tangent) in [(0.1, false), (1e-10, false), (0.0, true)] {
        let origin = (1.0 - depth) * normal - 2.0 * direction;
        let query = Query::primary(Ray::new(origin, direction).unwrap());
        let mut hits = Vec::new();
        let undecided = tracer.exact_all_hits(&query, &mut hits);
        let (answer, shot) = (tracer.first_hit(&query), Shot::of(query));
        let finding = judge.judge(&shot, (&answer, OPEN), &Truth { hits: &hits, undecided });
        assert_eq!(finding.tangent, tangent, "{depth}");
    }
}

#[test]
fn a_target_counts_though_the_exact_solver_has_missed_it() {
    let surfaces = [shapes::sphere(1.0).unwrap().into()];
    let judge = Judge::new(&surfaces);
    let site = Site { surface: 0, uv: DVec2::new(0.4, 0.3) };
    let point = surfaces[0].point_at(site.uv);
    let shot = |direction: DVec3| {
        let ray = Ray::new(point - 2.0 * direction, direction).unwrap();
        Shot { target: Some((site, 2.0)), ..Shot::of(Query::primary(ray)) }
    };
    let nothing = Truth { hits: &[], undecided: false };
    let head_on = judge.judge(&shot(-point), (&Answer::default(), OPEN), &nothing);
    assert_eq!(head_on.fault, Some(Fault::Miss));
    let tangent =
        judge.judge(&shot(point.any_orthonormal_vector()), (&Answer::default(), OPEN), &nothing);
    assert_eq!(tangent.fault, None);
}

/// A hit at a border, and a root at a trim edge of another face, so many promises farther along.
#[test]
fn either_of_two_faces_that_end_at_one_edge_may_be_named() {
    let promise = residual_factor(1, 1);
    for (apart, edge, fault) in [
        (8.0, HitFlags::TRIM_EDGE, None),
        (8.0, HitFlags::BORDER, Some(Fault::FalseHit)),
        (1e3, HitFlags::TRIM_EDGE, Some(Fault::FalseHit)),
    ] {
        let sheet = |z: f64| {
            let lifted = DAffine3::from_translation(z * DVec3::Z);
            Surface::from(shapes::plane(1.0, 1.0).unwrap().transformed(&lifted).unwrap())
        };
        let surfaces = [sheet(0.0), sheet(-apart * promise)];
        let judge = Judge::new(&surfaces);
        let ray = Ray::new(DVec3::Z, -DVec3::Z).unwrap();
        let named = |surface: usize, flags: HitFlags| {
            let bvh = SurfaceBvh::build(&surfaces[surface..=surface]).unwrap();
            let hit = bvh.tracer().first_hit(&ray).hit.unwrap();
            Hit { surface: surface as u32, flags, ..hit }
        };
        let (answer, root) = (named(0, HitFlags::BORDER), named(1, edge));
        let answer = Answer { hit: Some(answer), doubtful: false };
        let truth = Truth { hits: &[root], undecided: false };
        let found = judge.judge(&Shot::of(Query::primary(ray)), (&answer, OPEN), &truth);
        assert_eq!(found.fault, fault, "{apart}, {edge:?}");
    }
}
