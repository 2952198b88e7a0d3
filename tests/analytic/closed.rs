//! Hits of every class of rays on spheres, cylinder, cone, torus, disk and plane, of all sizes
//! and far from the origin, against their closed forms.

use glam::DVec3;
use nurbray::intersect::{Hit, HitFlags, Query, Tracer};
use nurbray::math::Ray;
use nurbray::math::rounding::residual_factor;
use rayon::prelude::*;

use crate::forms::Form;
use crate::model::{Model, nurbs};
use crate::random::Random;
use crate::rays::{Class, Rays};
use crate::truth::{Crossing, Line, Placed};

/// Rays of each class on each form in each place.
const COUNT: u64 = 100;

/// Near tangency a root moves by more than `bound / |N·d|`: at a dip of twice the bound, by
/// 1.18 times that.
const SECOND_ORDER: f64 = 1.2;

/// The error of the ends of a stretch inside the form, as a part of the form's size.
const INSIDE_ERROR: f64 = 1e-7;

/// Counts, largest errors and faults of some rays.
#[derive(Clone, Debug, Default)]
struct Tally {
    rays: u64,
    certain: u64,
    doubtful: u64,
    /// The largest error of `t` times `|N·d|`, as a part of the promise.
    t_error: f64,
    /// The largest angle between normals, over the largest allowed.
    normal_error: f64,
    faults: Vec<String>,
}

struct Case<'a> {
    placed: &'a Placed,
    model: &'a Model,
    /// Control points' largest coordinate.
    magnitude: f64,
    factor: f64,
}

impl Case<'_> {
    /// The promise for a ray, in form sizes.
    fn bound(&self, ray: &Ray) -> f64 {
        let magnitude = self.magnitude.max(ray.origin().abs().max_element());
        self.factor * magnitude / self.placed.scale
    }

    fn ask(&self, ray: &Ray, tracer: &mut Tracer<'_>, tally: &mut Tally) -> Vec<String> {
        let bound = self.bound(ray);
        let line = Line::new(self.placed, ray);
        let origin = line.place(0.0);
        let truth: Vec<Crossing> = line
            .crossings(self.placed.form, bound)
            .into_iter()
            .filter_map(|crossing| {
                let ahead = (crossing.at - origin).round();
                let slack = 2.0 * bound / crossing.cosine;
                let certain = crossing.certain && ahead > slack;
                (ahead >= -slack).then_some(Crossing { certain, ..crossing })
            })
            .collect();

        let query = Query::primary(*ray);
        let first = tracer.first_hit(&query);
        let mut all = Vec::new();
        let all_doubtful = tracer.all_hits(&query, &mut all);
        tally.rays += 1;
        tally.doubtful += u64::from(first.doubtful);

        let mut faults = Vec::new();
        for hit in first.hit.iter().chain(&all) {
            faults.extend(self.judge_hit(&line, hit, &truth, bound, tally));
        }
        // The first certain crossing bounds the first hit; all hits have each certain one once.
        if let Some(due) = truth.iter().find(|crossing| crossing.certain) {
            tally.certain += 1;
            let last = due.at.round() + SECOND_ORDER * bound / due.cosine;
            let late = first.hit.is_none_or(|hit| line.place(hit.t).round() > last);
            if late && !first.doubtful {
                let first = first.hit.map(|hit| (hit.t, hit.uv));
                faults.push(format!("miss: first hit {first:?}, a crossing at {due:?}"));
            }
        }
        for crossing in truth.iter().filter(|crossing| crossing.certain) {
            let count = all.iter().filter(|hit| matches(&line, hit, crossing, bound)).count();
            if count != 1 && !all_doubtful {
                faults.push(format!("{count} of all hits at {crossing:?}"));
            }
        }
        faults
    }

    fn judge_hit(
        &self,
        line: &Line,
        hit: &Hit,
        truth: &[Crossing],
        bound: f64,
        tally: &mut Tally,
    ) -> Option<String> {
        let doubtful = hit.flags.contains(HitFlags::DOUBTFUL);
        let certain =
            |crossing: &&Crossing| crossing.certain && matches(line, hit, crossing, bound);
        let Some(crossing) = truth.iter().find(certain) else {
            return self.false_hit(line, hit, bound);
        };
        if doubtful {
            return None;
        }
        let off = (line.place(hit.t) - crossing.at).abs().round() * crossing.cosine / bound;
        tally.t_error = tally.t_error.max(off);

        // A normal errs by its own rounding, and because the point is off along the ray by the
        // error of t. The rounding grows near a pole, up to the place where the pole itself gives
        // the normal; a tip gives none: there it grows up to half of the digits.
        let form = self.placed.form;
        let from_pole = form.pole_distance(crossing.point);
        let has_tip = form.tip_distance(crossing.point).is_finite();
        let most = if has_tip { 1.0 / bound.sqrt() } else { 100.0 };
        let rounding = bound * (1.0 + 1.0 / from_pole).min(most);
        let allowed = 8.0 * (rounding + bound / crossing.cosine);
        let angle = hit.normal.distance(crossing.normal);
        tally.normal_error = tally.normal_error.max(angle / allowed);
        let wrong = (angle.is_nan() || angle > allowed) && from_pole > bound;
        wrong.then(|| format!("normal {} at {crossing:?}: {angle:e} > {allowed:e}", hit.normal))
    }
}

impl Case<'_> {
    /// Returns the fault of a hit that no certain crossing accounts for, unless rounding can have
    /// made it: if the line is there as near to the form, and to its border, as a computed point
    /// may be.
    fn false_hit(&self, line: &Line, hit: &Hit, bound: f64) -> Option<String> {
        let form = self.placed.form;
        let at = line.place(hit.t);
        let point = line.point(at);
        let distance = line.distance(form, at);
        let border = -form.inside_border(point);
        let allowed = if hit.flags.contains(HitFlags::INSIDE) { INSIDE_ERROR } else { 4.0 * bound };
        let excused = distance <= allowed && border <= allowed; // false for NaN
        (!excused).then(|| {
            let flags = hit.flags;
            format!(
                "false hit {} {} {flags:?}: {distance:e} off, {border:e} outside",
                hit.t, hit.uv
            )
        })
    }
}

/// Whether a hit is this crossing, to within the promise.
fn matches(line: &Line, hit: &Hit, crossing: &Crossing, bound: f64) -> bool {
    let off = (line.place(hit.t) - crossing.at).abs().round();
    off <= SECOND_ORDER * bound / crossing.cosine
}

fn survey(placed: &Placed, class: Class, seed: u64) -> Tally {
    let unit = placed.form.surface();
    let name = format!("{:?}", placed.form);
    let unit =
        if placed.form.is_closed() { Model::closed(name, unit) } else { Model::new(name, unit) };
    let model = unit.placed(placed.scale, placed.shift);
    let surface = nurbs(&model.surfaces[0]);
    let points = surface.control().iter().map(|c| (c.truncate() / c.w).abs().max_element());
    let case = Case {
        placed,
        model: &model,
        magnitude: points.fold(0.0, f64::max),
        factor: residual_factor(surface.knots_u().degree(), surface.knots_v().degree()),
    };
    let rays = Rays::new(&model);
    let bvh = model.bvh();
    let mut tracer = bvh.tracer();
    let mut random = Random::new(seed);
    let mut tally = Tally::default();
    for _ in 0..COUNT {
        let ray = rays.shot(class, &mut random).ray;
        let faults = case.ask(&ray, &mut tracer, &mut tally);
        let told = |fault| format!("{} {class}: {fault}\n      {ray:?}", case.model.name);
        tally.faults.extend(faults.into_iter().map(told));
    }
    tally
}

#[test]
fn every_class_of_rays_agrees_with_the_closed_forms() {
    let places = [
        (1.0, DVec3::ZERO),
        (1e-8, DVec3::ZERO),
        (1e8, DVec3::ZERO),
        (1.0, DVec3::new(1e6, -1e6, 1e6)),
    ];
    let mut cases = Vec::new();
    for form in Form::ALL {
        for (scale, shift) in places {
            let placed = Placed { form, scale, shift };
            cases.extend(Class::all().into_iter().map(|class| (placed, class)));
        }
    }
    let tallies: Vec<Tally> =
        cases.par_iter().map(|(placed, class)| survey(placed, *class, 7)).collect();
    let mut faults = Vec::new();
    for class in Class::all() {
        let mut sum = Tally::default();
        for (_, tally) in cases.iter().zip(&tallies).filter(|(case, _)| case.1 == class) {
            sum.rays += tally.rays;
            sum.certain += tally.certain;
            sum.doubtful += tally.doubtful;
            sum.t_error = sum.t_error.max(tally.t_error);
            sum.normal_error = sum.normal_error.max(tally.normal_error);
            sum.faults.extend(tally.faults.iter().take(3).cloned());
        }
        println!(
            "{class:14} rays {} certain {} doubtful {:.4} t error {:.2} normal {:.2} faults {}",
            sum.rays,
            sum.certain,
            sum.doubtful as f64 / sum.rays as f64,
            sum.t_error,
            sum.normal_error,
            sum.faults.len()
        );
        faults.extend(sum.faults);
    }
    assert!(
        faults.is_empty(),
        "{} faults:\n{}",
        faults.len(),
        faults[..faults.len().min(30)].join("\n")
    );
}
