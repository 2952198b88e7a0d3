//! Closed bodies of triangles and of limit surfaces' patches: no ray leaks through their seams.

use glam::DVec3;
use nurbray::geometry::{Cage, Surface};
use nurbray::intersect::{Hit, Query};
use nurbray::math::Ray;
use rayon::prelude::*;

use crate::judge::Judge;
use crate::model::Model;
use crate::random::Random;
use crate::rays::{Class, Rays};
use crate::{models, patches};

/// Rays through a body, in blocks, that do not enter and leave it in turn; and the share of
/// doubtful ones.
fn leaks(model: &Model, count: u64) -> (Vec<String>, f64) {
    let classes =
        [Class::Random, Class::Aimed, Class::Lines, Class::Corners, Class::Borders, Class::Far];
    let (bvh, judge, rays) = (model.bvh(), Judge::new(model), Rays::new(model));
    let block = |seed: u64| {
        let mut tracer = bvh.tracer();
        let mut random = Random::new(0x5eed ^ seed << 20);
        let (mut faults, mut doubtful, mut at_edges, mut hits) = (Vec::new(), 0, 0, Vec::new());
        for k in 0..500 {
            let ray = rays.shot(classes[k % classes.len()], &mut random).ray;
            let (from, to) = (f64::NEG_INFINITY, f64::INFINITY);
            let line = Ray::with_range(ray.origin(), ray.direction(), from, to).unwrap();
            hits.clear();
            if tracer.all_hits(&Query::primary(line), &mut hits) {
                doubtful += 1;
            } else if hits.iter().any(|hit| at_edge(model, hit, judge.measure(&line, hit).promise))
            {
                at_edges += 1;
            } else if let Some(fault) = judge.parity_broken(&hits, &line) {
                faults.push(format!("{}: {fault}\n      {line:?}", model.name));
            }
        }
        (faults, doubtful, at_edges)
    };
    let blocks: Vec<_> = (0..count / 500).into_par_iter().map(block).collect();
    let at_edges: u64 = blocks.iter().map(|block| block.2).sum();
    assert!(at_edges < count / 4, "{at_edges} rays meet edges");
    let doubtful: u32 = blocks.iter().map(|block| block.1).sum();
    let faults = blocks.into_iter().flat_map(|block| block.0).collect();
    (faults, f64::from(doubtful) / count as f64)
}

/// Whether a hit of a creased body is within rounding of where unit squares meet: past a sharp
/// edge a ray may touch one side of it only.
fn at_edge(model: &Model, hit: &Hit, promise: f64) -> bool {
    if !model.name.contains("creased") {
        return false;
    }
    let at = model.surfaces[0].derivatives(hit.uv);
    let across = |t: f64| (t - t.round()).abs();
    let distance = (across(hit.uv.x) * at.du.length()).min(across(hit.uv.y) * at.dv.length());
    distance <= 8.0 * promise
}

fn bodies() -> Vec<Model> {
    let mut bodies = vec![models::octants()];
    bodies.extend(models::limits().into_iter().filter(|model| model.closed));
    bodies
}

fn none_leaks(count: u64) {
    for model in bodies() {
        let (faults, doubt) = leaks(&model, count);
        println!("{:20} {count} rays, {} leak, {doubt:.5} doubtful", model.name, faults.len());
        assert!(faults.is_empty(), "{} faults, first:\n{}", faults.len(), faults[0]);
        assert!(doubt < 0.001, "{}: {doubt} doubtful", model.name);
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
            // Steep, so that what the surface is off shows by less than twice that.
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
