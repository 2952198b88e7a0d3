//! A second opinion that shares nothing with the solver: all roots by halving alone.
//!
//! Pieces are halved again and again in both directions. The boxes that remain when they are a
//! millionth of a piece wide are grouped by place. Each group is one root if Newton's iteration on
//! the surface as authored converges there and the ray is steep; else nothing is concluded.

use std::ops::Range;

use glam::{DVec2, DVec3, DVec4};
use nurbray::geometry::NurbsSurface;
use nurbray::intersect::{Hit, HitFlags, Query, Tracer};
use nurbray::math::Ray;
use rayon::prelude::*;

use crate::judge::Judge;
use crate::model::{Model, nurbs};
use crate::models;
use crate::random::Random;
use crate::rays::{Class, Rays};

/// Boxes are halved this often: to 1e-6 of a piece.
const DEPTH: u32 = 20;

/// More boxes than this at one depth do not mean roots, but a ray along the surface.
const MOST_BOXES: usize = 400;

/// What remains is one root if the ray is steeper than this there.
const STEEP: f64 = 1e-2;

/// Nearer to a border of the domain than this, a root may as well be outside.
const BORDER: f64 = 1e-9;

/// A root, and whether it may lie outside of the domain.
#[derive(Clone, Copy, Debug)]
struct Root {
    t: f64,
    uv: DVec2,
    at_border: bool,
}

/// A part of a Bézier piece: its net in ray coordinates, and its knot rectangle.
#[derive(Clone)]
struct Part {
    degree: [usize; 2],
    net: Vec<DVec4>,
    domain: [[f64; 2]; 2],
}

impl Part {
    /// Whether the ray may meet the part: both distances take both signs, or nearly so.
    fn may_be_met(&self, error: f64) -> bool {
        let spans = |component: fn(&DVec4) -> f64| {
            let values = self.net.iter().map(component);
            let (low, high) = values.fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
            low <= error && high >= -error
        };
        spans(|c| c.x) && spans(|c| c.y)
    }

    /// De Casteljau at the middle, in one direction.
    fn halves(&self, direction: usize) -> [Self; 2] {
        let [p, q] = self.degree;
        let (mut low, mut high) = (self.clone(), self.clone());
        let (rows, step, degree) = match direction {
            0 => ((0..=q).collect::<Vec<_>>(), q + 1, p),
            _ => ((0..=p).map(|i| i * (q + 1)).collect(), 1, q),
        };
        for start in rows {
            let mut row: Vec<DVec4> = (0..=degree).map(|k| self.net[start + k * step]).collect();
            for level in 0..=degree {
                low.net[start + level * step] = row[0];
                high.net[start + (degree - level) * step] = row[degree - level];
                for k in 0..degree - level {
                    row[k] = 0.5 * (row[k] + row[k + 1]);
                }
            }
        }
        let [from, to] = self.domain[direction];
        low.domain[direction] = [from, 0.5 * (from + to)];
        high.domain[direction] = [0.5 * (from + to), to];
        [low, high]
    }

    fn middle(&self) -> DVec2 {
        DVec2::from_array(self.domain.map(|[from, to]| 0.5 * (from + to)))
    }
}

/// The Bézier pieces of a surface in ray coordinates.
fn pieces(surface: &NurbsSurface, ray: &Ray, axes: [DVec3; 3]) -> Vec<Part> {
    let bezier = surface.bezier_form();
    let [_, columns] = bezier.size();
    let degree = [bezier.knots_u().degree(), bezier.knots_v().degree()];
    let seen = |c: &DVec4| {
        let from_origin = c.truncate() - c.w * ray.origin();
        DVec3::from_array(axes.map(|axis| axis.dot(from_origin))).extend(c.w)
    };
    let mut parts = Vec::new();
    for u in bezier.knots_u().spans() {
        for v in bezier.knots_v().spans() {
            let rows: Range<usize> = u.index - degree[0]..u.index + 1;
            let row = |i: usize| {
                &bezier.control()[i * columns + v.index - degree[1]..=i * columns + v.index]
            };
            let net = rows.flat_map(row).map(seen).collect();
            parts.push(Part { degree, net, domain: [[u.start, u.end], [v.start, v.end]] });
        }
    }
    parts
}

/// Newton's iteration on the surface as authored.
fn polished(surface: &NurbsSurface, ray: &Ray, axes: [DVec3; 3], start: DVec2) -> Option<Root> {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let (low, high) = (DVec2::new(u0, v0), DVec2::new(u1, v1));
    let mut uv = start.clamp(low, high);
    for _ in 0..12 {
        let at = surface.derivatives(uv);
        let across = |v: DVec3| DVec2::new(axes[0].dot(v), axes[1].dot(v));
        let (f, a, b) = (across(at.point - ray.origin()), across(at.du), across(at.dv));
        let step = DVec2::new(f.perp_dot(b), a.perp_dot(f)) / a.perp_dot(b);
        if !step.is_finite() {
            return None;
        }
        uv = (uv - step).clamp(low, high);
    }
    let at = surface.derivatives(uv);
    let steepness = at.du.cross(at.dv).normalize_or_zero().dot(axes[2]).abs();
    let margin = ((uv - low).min(high - uv) / (high - low)).min_element();
    let t = axes[2].dot(at.point - ray.origin()) / ray.direction().length();
    let residual = at.point.distance(ray.at(t));
    let converged = residual <= 1e-12 * at.point.abs().max(ray.origin().abs()).max_element();
    (converged && steepness > STEEP).then_some(Root { t, uv, at_border: margin < BORDER })
}

/// All roots of the whole line on a surface; `None` where halving cannot tell.
fn roots(surface: &NurbsSurface, ray: &Ray, error: f64) -> Option<Vec<Root>> {
    let axis = ray.direction().normalize();
    let (x, y) = axis.any_orthonormal_pair();
    let axes = [x, y, axis];
    let mut parts = pieces(surface, ray, axes);
    let weight = parts.iter().flat_map(|part| &part.net).map(|c| c.w).fold(0.0, f64::max);
    parts.retain(|part| part.may_be_met(error * weight));
    for depth in 0..2 * DEPTH {
        let halved = parts.iter().flat_map(|part| part.halves(depth as usize % 2));
        parts = halved.filter(|part| part.may_be_met(error * weight)).collect();
        if parts.len() > MOST_BOXES {
            return None;
        }
    }
    let mut found: Vec<Root> = Vec::new();
    for part in &parts {
        let root = polished(surface, ray, axes, part.middle())?;
        let sides = DVec2::from_array(part.domain.map(|[from, to]| to - from));
        let strayed = ((root.uv - part.middle()) / sides).abs().max_element();
        if strayed > 1e4 {
            return None; // far from the box it began in
        }
        let reach = 1e-9 * (1.0 + root.t.abs());
        if !found.iter().any(|other| (other.t - root.t).abs() < reach) {
            found.push(root);
        }
    }
    Some(found)
}

#[derive(Clone, Debug, Default)]
struct Tally {
    rays: u64,
    compared: u64,
    roots: u64,
    faults: Vec<String>,
}

/// Compares all hits on the whole line with what halving finds.
fn compare(
    model: &Model,
    judge: &Judge<'_>,
    tracer: &mut Tracer<'_>,
    ray: &Ray,
    tally: &mut Tally,
) -> Option<String> {
    let line = Ray::with_range(ray.origin(), ray.direction(), f64::NEG_INFINITY, f64::INFINITY);
    let line = line.unwrap();
    let (low, high) = model.bounds();
    let magnitude = low.abs().max(high.abs()).max(ray.origin().abs()).max_element();
    tally.rays += 1;
    let mut truth = Vec::new();
    for surface in &model.surfaces {
        truth.extend(roots(nurbs(surface), &line, 1e-13 * magnitude)?);
    }
    let mut hits = Vec::new();
    if tracer.exact_all_hits(&Query::primary(line), &mut hits) {
        return None;
    }
    tally.compared += 1;
    tally.roots += truth.len() as u64;

    let near = |hit: &Hit, root: &Root| {
        let measure = judge.measure(&line, hit);
        let slack = judge.slack(4.0 * (measure.promise + measure.excuse), measure.incidence);
        (hit.t - root.t).abs() * line.direction().length() <= slack
    };
    for root in truth.iter().filter(|root| !root.at_border) {
        if !hits.iter().any(|hit| near(hit, root)) {
            return Some(format!("lost {root:?}"));
        }
    }
    let in_vain = |hit: &&Hit| {
        !hit.flags.contains(HitFlags::BORDER) && !truth.iter().any(|root| near(hit, root))
    };
    if let Some(hit) = hits.iter().find(in_vain) {
        return Some(format!("met {} {} in vain, there are {truth:?}", hit.t, hit.uv));
    }
    None
}

fn survey(model: &Model, class: Class, count: u64, seed: u64) -> Tally {
    let bvh = model.bvh();
    let judge = Judge::new(model);
    let rays = Rays::new(model);
    let mut tracer = bvh.tracer();
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    for _ in 0..count {
        let ray = rays.shot(class, &mut random).ray;
        let fault = compare(model, &judge, &mut tracer, &ray, &mut tally);
        tally
            .faults
            .extend(fault.map(|fault| format!("{} {class}: {fault}\n    {ray:?}", model.name)));
    }
    tally
}

#[test]
fn all_hits_agree_with_halving() {
    let mut some: Vec<Model> = (0..24).map(models::random_rational).collect();
    some.extend((0..8).map(|k| models::bezier([2 + k % 3, 3 + k % 2], k % 2 == 0, 60 + k as u64)));
    some.extend([models::bezier([5, 5], true, 1), models::bezier([12, 11], false, 2)]);
    some.extend([
        models::wavy_sheet(),
        models::periodic_tube(),
        models::torus(),
        models::cylinder(),
    ]);
    some.extend([models::saddle(), models::twisted()]);
    some.extend(models::lecture());
    let classes = [
        Class::Random,
        Class::Aimed,
        Class::Lines,
        Class::Borders,
        Class::Rulings,
        Class::Entering(2),
    ];
    let cases: Vec<_> = some.iter().flat_map(|model| classes.map(|class| (model, class))).collect();
    let tallies = cases.into_par_iter().map(|(model, class)| survey(model, class, 40, 61));
    let tally = tallies.reduce(Tally::default, |mut a, b| {
        a.rays += b.rays;
        a.compared += b.compared;
        a.roots += b.roots;
        a.faults.extend(b.faults);
        a
    });
    println!("{} rays, {} compared, {} roots", tally.rays, tally.compared, tally.roots);
    assert!(
        tally.faults.is_empty(),
        "{} faults:\n{}",
        tally.faults.len(),
        tally.faults[..tally.faults.len().min(12)].join("\n")
    );
    assert!(tally.compared > tally.rays / 2, "halving could tell too little");
}
