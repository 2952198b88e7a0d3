//! The faults of answers.
//!
//! `nurbray audit` has a judge of its own, `src/app/audit/judge.rs`. The two agree on the promise,
//! on how far a root may move along the ray, and on what is steep. They differ in this:
//!
//! - This one also asks for the exact solver's first hit, the normals and parity, and holds a
//!   hit's point to the promise; that one compares the first hit and occlusion with all hits.
//! - Rounding of (u, v) moves `S(u, v)` by the surface's speed there; that judge takes the speed
//!   before a knot if it is larger.
//! - A hit beside a border is owed here up to a residual of half the promise and all of
//!   [`Measure::excuse`], there of half the promise and half the rounding of (u, v).
//! - A hit beyond a trim edge may be owed here, there not if all within the promise is cut off.
//! - Two roots of a surface are one here if the residual halfway between them, in t as in (u, v),
//!   is within twice the sum of their bounds; there, with the t of the nearest point of the ray,
//!   if it is within its own bound.
//! - A target on a border or a trim edge must be met there whatever the angle, here only if the
//!   ray is steep, as anywhere.
//! - In a pole `|N · d|` is by the limit of the normal here, and 0 there.
//! - Directions may have any length here; there their squares must be representable.

use glam::{DVec2, DVec3};
use nurbray::geometry::Surface;
use nurbray::intersect::{Answer, Hit, HitFlags, Occlusion, Query, Tracer};
use nurbray::math::rounding::{UNIT_ROUNDOFF, residual_factor};
use nurbray::math::{Ray, RayFrame};

use crate::model::{Model, bounds};
use crate::rays::{Shot, Site};

/// All answers of a tracer to one ray.
pub(crate) struct Answers {
    pub(crate) first: Answer,
    pub(crate) exact: Answer,
    pub(crate) occlusion: Occlusion,
    /// All hits by the exact solver, and whether they are doubtful.
    pub(crate) all: Vec<Hit>,
    pub(crate) all_doubtful: bool,
    /// All hits as everybody asks for them.
    pub(crate) fast_all: (Vec<Hit>, bool),
}

impl Answers {
    pub(crate) fn ask(tracer: &mut Tracer<'_>, query: &Query) -> Self {
        let mut all = Vec::new();
        let all_doubtful = tracer.exact_all_hits(query, &mut all);
        let mut fast_all = Vec::new();
        let fast_all_doubtful = tracer.all_hits(query, &mut fast_all);
        Self {
            first: tracer.first_hit(query),
            exact: tracer.exact_first_hit(query),
            occlusion: tracer.occluded(query),
            all,
            all_doubtful,
            fast_all: (fast_all, fast_all_doubtful),
        }
    }
}

/// The residual of a hit, and its bounds.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    /// `|S(u, v) − (o + t d)|`, by the surface as authored.
    pub(crate) residual: f64,
    /// The promise: `C ε M`.
    pub(crate) promise: f64,
    /// The further error of `S(u, v)`, which is evaluated once more, at rounded parameters.
    pub(crate) excuse: f64,
    /// `|N · d|` for unit vectors, 0 without a normal.
    pub(crate) incidence: f64,
}

/// As `|N · d| → 0`, a root moves by `√(8 r b)` for a distance `b` from a surface of radius of
/// curvature `r`, with one root on each side of the tangent point: by `4 √(b radius)` for radii up
/// to twice the model's. Flatter surfaces are compared between the two roots.
const TANGENT_FACTOR: f64 = 4.0;

/// A ray that passes a surface within rounding surely crosses it if it is this steep: the
/// surface would need a radius of curvature of 1e-11 of its size not to be crossed.
const SURE_INCIDENCE: f64 = 0.01;

/// Compares answers for one model.
pub(crate) struct Judge<'a> {
    model: &'a Model,
    magnitudes: Vec<f64>,
    radius: f64,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(model: &'a Model) -> Self {
        let magnitude = |surface: &Surface| {
            let (low, high) = bounds(surface);
            low.abs().max(high.abs()).max_element()
        };
        let magnitudes = model.surfaces.iter().map(magnitude).collect();
        Self { model, magnitudes, radius: model.radius() }
    }

    /// Everything that is wrong with the answers to a ray.
    pub(crate) fn faults(&self, shot: &Shot, answers: &Answers) -> Vec<String> {
        let mut faults = Vec::new();
        let said = [answers.first.hit, answers.exact.hit];
        for hit in said.iter().flatten().chain(&answers.all).chain(&answers.fast_all.0) {
            faults.extend(self.unsound(&shot.ray, hit));
        }
        faults.extend(self.fast_against_exact(&shot.ray, answers));
        faults.extend(self.first_against_all(&shot.ray, answers));
        faults.extend(self.all_against_exact(&shot.ray, answers));
        faults.extend(self.target_lost(shot, answers));
        faults.extend(self.occlusion_wrong(&shot.ray, answers));
        faults
    }

    /// The faults of a first hit alone.
    pub(crate) fn faults_of_first(&self, shot: &Shot, first: &Answer) -> Vec<String> {
        if let Some(hit) = first.hit
            && hit.flags.contains(HitFlags::DOUBTFUL) != first.doubtful
        {
            return vec![format!("doubtful: {}, but the hit {:?}", first.doubtful, hit.flags)];
        }
        let unsound = first.hit.iter().filter_map(|hit| self.unsound(&shot.ray, hit));
        unsound.chain(self.target_passed(shot, "first hit", first)).collect()
    }

    /// Returns the promise that a hit breaks by itself, if any.
    pub(crate) fn unsound(&self, ray: &Ray, hit: &Hit) -> Option<String> {
        let in_range = ray.t_min() < hit.t && hit.t < ray.t_max();
        if !in_range {
            return Some(format!("t = {} out of range", hit.t));
        }
        let measure = self.measure(ray, hit);
        // A flagged hit may be off by a few times the promise, but not by more.
        let allowed = if hit.flags.contains(HitFlags::INSIDE) {
            16.0
        } else if hit.flags.contains(HitFlags::DOUBTFUL) {
            8.0
        } else {
            1.0
        };
        let off_ray = hit.point.distance(ray.at(hit.t));
        let near = off_ray <= allowed * measure.promise; // false for NaN
        if !near {
            return Some(format!(
                "at t = {} {:?}: {off_ray:e} from the ray, {:e} promised",
                hit.t, hit.flags, measure.promise
            ));
        }
        let on_surface = measure.residual <= allowed * measure.promise + measure.excuse;
        if !on_surface {
            return Some(format!(
                "S{} is {:e} from t = {}, {:e} promised",
                hit.uv, measure.residual, hit.t, measure.promise
            ));
        }
        let no_normal = hit.flags.contains(HitFlags::NO_NORMAL);
        let unit = (hit.normal.length() - 1.0).abs() < 1e-14;
        (if no_normal { !hit.normal.is_nan() } else { !unit })
            .then(|| format!("normal {} with flags {:?}", hit.normal, hit.flags))
    }

    fn fast_against_exact(&self, ray: &Ray, answers: &Answers) -> Option<String> {
        let (fast, exact) = (answers.first, answers.exact);
        if fast.doubtful || exact.doubtful {
            return None;
        }
        match (fast.hit, exact.hit) {
            (Some(a), Some(b)) if self.same_root(ray, &a, &b) => None,
            (Some(a), Some(b)) if b.t < a.t => self
                .due(ray, &b)
                .then(|| format!("wrong root: fast {} {}, exact {} {}", a.t, a.uv, b.t, b.uv)),
            (Some(a), b) => self.due(ray, &a).then(|| {
                format!("exact solver lost {} {}, has {:?}", a.t, a.uv, b.map(|b| (b.t, b.uv)))
            }),
            (None, Some(b)) => {
                self.due(ray, &b).then(|| format!("miss: exact has {} {} {:?}", b.t, b.uv, b.flags))
            }
            (None, None) => None,
        }
    }

    fn first_against_all(&self, ray: &Ray, answers: &Answers) -> Option<String> {
        if answers.first.doubtful {
            return None;
        }
        let known = |hit: &Hit| answers.all.iter().any(|other| self.same_root(ray, hit, other));
        if let Some(hit) = answers.first.hit
            && !answers.all_doubtful
            && self.due(ray, &hit)
            && !known(&hit)
        {
            return Some(format!("first hit {} {} is not among all hits", hit.t, hit.uv));
        }
        answers.all.iter().filter(|hit| self.due(ray, hit)).find_map(|hit| {
            let lost = answers
                .first
                .hit
                .is_none_or(|first| hit.t < first.t && !self.same_root(ray, &first, hit));
            lost.then(|| format!("all hits has {} {} before the first", hit.t, hit.uv))
        })
    }

    /// Returns a fault if a hit is among all hits of one search and not among those of the other.
    fn all_against_exact(&self, ray: &Ray, answers: &Answers) -> Option<String> {
        let (fast, fast_doubtful) = &answers.fast_all;
        if *fast_doubtful || answers.all_doubtful {
            return None;
        }
        let lost = |from: &[Hit], of: &[Hit]| {
            let known = |hit: &Hit| from.iter().any(|other| self.same_root(ray, hit, other));
            of.iter().find(|hit| self.due(ray, hit) && !known(hit)).copied()
        };
        let lost_by = [
            ("all hits lack", lost(fast, &answers.all)),
            ("only all hits have", lost(&answers.all, fast)),
        ];
        let (what, hit) = lost_by.into_iter().find_map(|(what, hit)| Some((what, hit?)))?;
        Some(format!("{what} {} {} {:?}", hit.t, hit.uv, hit.flags))
    }

    /// Returns a fault if a ray aimed steeply at a point of a surface meets it neither there nor
    /// before.
    fn target_passed(&self, shot: &Shot, name: &str, answer: &Answer) -> Option<String> {
        let (site, t, slack) = self.target(shot)?;
        let late = |hit: Hit| (hit.t - t) * length(&shot.ray) > slack;
        (!answer.doubtful && answer.hit.is_none_or(late)).then(|| {
            let has = answer.hit.map(|hit| (hit.t, hit.uv));
            format!("{name} lost the target {site:?} {t}, has {has:?}")
        })
    }

    fn target_lost(&self, shot: &Shot, answers: &Answers) -> Option<String> {
        let (site, t, slack) = self.target(shot)?;
        let length = length(&shot.ray);
        let found = |hit: &Hit| (hit.t - t).abs() * length <= slack;
        let lost = !answers.all_doubtful && !answers.all.iter().any(found);
        let of_all = lost.then(|| format!("all hits lost the target {site:?} {t}"));
        of_all
            .or_else(|| self.target_passed(shot, "first hit", &answers.first))
            .or_else(|| self.target_passed(shot, "exact first hit", &answers.exact))
    }

    /// The place a ray surely crosses, its `t`, and the error bound of that place along the ray.
    fn target(&self, shot: &Shot) -> Option<(Site, f64, f64)> {
        let (site, t) = shot.target?;
        if !self.model.keeps(site.surface, DVec2::new(site.u, site.v)) {
            return None;
        }
        let measure = self.measure_at(&shot.ray, site, t);
        let slack = self.slack(measure.promise + measure.excuse, measure.incidence);
        (measure.incidence >= SURE_INCIDENCE).then_some((site, t, slack))
    }

    fn occlusion_wrong(&self, ray: &Ray, answers: &Answers) -> Option<String> {
        let (said, first) = (answers.occlusion, answers.first);
        if said.doubtful || first.doubtful {
            return None;
        }
        let due = first.hit.is_some_and(|hit| self.due(ray, &hit));
        let wrong = if said.occluded { first.hit.is_none() } else { due };
        wrong.then(|| format!("occluded {}, but first hit {:?}", said.occluded, first.hit))
    }

    /// Returns a fault if a line through a closed model does not enter and leave in turn. Where it
    /// touches a sharp edge it does both at one `t`, and either may come first.
    pub(crate) fn parity_broken(&self, hits: &[Hit], line: &Ray) -> Option<String> {
        let mut outward: Vec<bool> =
            hits.iter().map(|hit| hit.normal.dot(line.direction()) > 0.0).collect();
        for k in 1..hits.len() {
            let due = k % 2 == 0; // what the one before should be
            if outward[k - 1] != due && outward[k] == due {
                let slack = |hit: &Hit| {
                    let measure = self.measure(line, hit);
                    self.slack(measure.promise + measure.excuse, measure.incidence)
                };
                let apart = (hits[k].t - hits[k - 1].t) * length(line);
                if apart <= slack(&hits[k]) + slack(&hits[k - 1]) {
                    outward.swap(k, k - 1);
                }
            }
        }
        let alternate = outward.into_iter().enumerate().all(|(k, leaves)| leaves == (k % 2 == 1));
        (hits.len() % 2 == 1 || !alternate).then(|| {
            let hits: Vec<_> = hits.iter().map(|hit| (hit.t, hit.uv, hit.flags)).collect();
            format!("crossings do not alternate: {hits:?}")
        })
    }

    /// Whether every search has to find a hit: the hit is certain, well inside the range, and not
    /// in the outer half of the slack around a border.
    pub(crate) fn due(&self, ray: &Ray, hit: &Hit) -> bool {
        let measure = self.measure(ray, hit);
        let outside = hit.flags.contains(HitFlags::BORDER)
            && measure.residual > 0.5 * measure.promise + measure.excuse;
        let slack = self.slack(measure.promise + measure.excuse, measure.incidence);
        let at_end =
            [ray.t_min(), ray.t_max()].iter().any(|end| (hit.t - end).abs() * length(ray) <= slack);
        !hit.flags.contains(HitFlags::DOUBTFUL) && !outside && !at_end
    }

    /// Whether two hits are one root: their `t` agree to within their error bounds, or the
    /// surface between them cannot be distinguished from the ray.
    pub(crate) fn same_root(&self, ray: &Ray, a: &Hit, b: &Hit) -> bool {
        let (at_a, at_b) = (self.measure(ray, a), self.measure(ray, b));
        let bound = at_a.promise + at_a.excuse + at_b.promise + at_b.excuse;
        let slack = self.slack(bound, at_a.incidence.min(at_b.incidence));
        if (a.t - b.t).abs() * length(ray) <= slack {
            return true;
        }
        let between = Hit { t: 0.5 * (a.t + b.t), uv: 0.5 * (a.uv + b.uv), ..*a };
        let between = self.measure(ray, &between);
        a.surface == b.surface && between.residual <= 2.0 * bound
    }

    /// The error bound of a root along the ray, as a length.
    pub(crate) fn slack(&self, bound: f64, incidence: f64) -> f64 {
        (bound / incidence).min(TANGENT_FACTOR * (bound * self.radius).sqrt())
    }

    pub(crate) fn measure(&self, ray: &Ray, hit: &Hit) -> Measure {
        let site = Site { surface: hit.surface as usize, u: hit.uv.x, v: hit.uv.y };
        self.measure_at(ray, site, hit.t)
    }

    pub(crate) fn measure_at(&self, ray: &Ray, site: Site, t: f64) -> Measure {
        let surface = &self.model.surfaces[site.surface];
        let uv = DVec2::new(site.u, site.v);
        let at = surface.derivatives(uv);
        let magnitude = ray.origin().abs().max_element().max(self.magnitudes[site.surface]);
        let factor = residual_factor(surface.degree()[0], surface.degree()[1]);
        let parameters = site.u.abs() * at.du.length() + site.v.abs() * at.dv.length();
        let promise = factor * magnitude;
        let normal = surface.normal(uv).unwrap_or(DVec3::ZERO);
        Measure {
            residual: at.point.distance(ray.at(t)),
            promise,
            excuse: promise + 2.0 * UNIT_ROUNDOFF * parameters,
            incidence: normal.dot(RayFrame::new(ray).axis).abs(),
        }
    }
}

/// The length of a ray's direction, also where its square cannot be represented.
fn length(ray: &Ray) -> f64 {
    1.0 / RayFrame::new(ray).t_from_z
}

#[cfg(test)]
mod tests {
    use nurbray::intersect::Occlusion;

    use super::*;
    use crate::models;

    /// The faults found in falsified answers for a sphere met head on at t = 2 and t = 4.
    fn verdict(falsify: impl Fn(&mut Answers)) -> Vec<String> {
        let model = models::sphere();
        let bvh = model.bvh();
        let direction = DVec3::new(-0.6, -0.48, -0.64);
        let ray = Ray::new(-3.0 * direction, direction).unwrap();
        let mut answers = Answers::ask(&mut bvh.tracer(), &Query::primary(ray));
        assert_eq!(answers.all.len(), 2);
        falsify(&mut answers);
        Judge::new(&model).faults(&Shot { ray, target: None }, &answers)
    }

    #[test]
    fn what_is_right_has_no_fault() {
        assert_eq!(verdict(|_| ()), Vec::<String>::new());
        // One rounding of t is no other root; and what is doubted may be missing.
        assert!(verdict(|a| moved(&mut a.first, f64::EPSILON)).is_empty());
        assert!(verdict(|a| a.first = Answer { hit: None, doubtful: true }).is_empty());
    }

    fn moved(answer: &mut Answer, by: f64) {
        if let Some(hit) = &mut answer.hit {
            hit.t += by;
        }
    }

    #[test]
    fn every_falsified_answer_has_a_fault() {
        let falsified: [fn(&mut Answers); 11] = [
            |a| a.first.hit = None,
            |a| a.exact.hit = None,
            |a| a.first.hit = Some(a.all[1]),
            |a| a.exact.hit = Some(a.all[1]),
            |a| moved(&mut a.first, 1e-13),
            |a| moved(&mut a.first, f64::NAN),
            |a| {
                a.all.remove(0);
            },
            |a| a.all[0].uv.x += 1e-12,
            |a| a.all[1].normal *= 1.0 + 1e-12,
            |a| a.all[1].normal = DVec3::NAN,
            |a| a.occlusion = Occlusion::default(),
        ];
        for (k, falsify) in falsified.into_iter().enumerate() {
            assert!(!verdict(falsify).is_empty(), "falsification {k} passes");
        }
    }

    #[test]
    fn a_lost_target_is_a_fault_though_all_agree() {
        let model = models::sphere();
        let judge = Judge::new(&model);
        let site = Site { surface: 0, u: 0.4, v: 0.3 };
        let point = model.surfaces[0].point_at(DVec2::new(site.u, site.v));
        let faults = |direction: DVec3| {
            let ray = Ray::new(point - 2.0 * direction, direction).unwrap();
            let shot = Shot { ray, target: Some((site, 2.0)) };
            judge.faults_of_first(&shot, &Answer::default())
        };
        assert_eq!(faults(-point).len(), 1);
        assert_eq!(faults(point.any_orthonormal_vector()).len(), 0, "it may only touch");
    }

    #[test]
    fn parity_is_that_of_in_and_out() {
        let model = models::sphere();
        let bvh = model.bvh();
        let line = Ray::new(DVec3::new(0.1, 0.2, 5.0), DVec3::NEG_Z).unwrap();
        let mut hits = Vec::new();
        let _ = bvh.tracer().exact_all_hits(&Query::primary(line), &mut hits);
        let judge = Judge::new(&model);
        assert_eq!(judge.parity_broken(&hits, &line), None);
        assert!(judge.parity_broken(&hits[..1], &line).is_some());
        assert!(judge.parity_broken(&[hits[0], hits[0]], &line).is_some());
    }
}
