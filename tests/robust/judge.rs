//! What may be said against an answer.

use glam::DVec3;
use nurbray::geometry::NurbsSurface;
use nurbray::intersect::{Answer, Hit, HitFlags, Occlusion, Query, Tracer};
use nurbray::math::Ray;
use nurbray::math::rounding::{UNIT_ROUNDOFF, residual_factor};

use crate::model::Model;
use crate::rays::{Shot, Site};

/// Everything a tracer says of one ray.
pub(crate) struct Answers {
    pub(crate) first: Answer,
    pub(crate) exact: Answer,
    pub(crate) occlusion: Occlusion,
    pub(crate) all: Vec<Hit>,
    pub(crate) all_doubtful: bool,
}

impl Answers {
    pub(crate) fn ask(tracer: &mut Tracer<'_>, query: &Query) -> Self {
        let mut all = Vec::new();
        let all_doubtful = tracer.all_hits(query, &mut all);
        Self {
            first: tracer.first_hit(query),
            exact: tracer.exact_first_hit(query),
            occlusion: tracer.occluded(query),
            all,
            all_doubtful,
        }
    }
}

/// Where a hit is, and how exact it can be.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measure {
    /// `|S(u, v) − (o + t d)|`, by the surface as authored.
    pub(crate) residual: f64,
    /// The promise: `C ε M`.
    pub(crate) promise: f64,
    /// What `S(u, v)` may be off besides: it is evaluated once more, at rounded parameters.
    pub(crate) excuse: f64,
    /// `|N · d|` for unit vectors, 0 without a normal.
    pub(crate) incidence: f64,
}

/// Where `|N · d| → 0`, a root moves by `√(8 r b)` for a distance `b` from a surface of
/// radius of curvature `r`, one root on each side of the tangent point: `4 √(b radius)` for
/// radii up to twice the model's. Flatter surfaces are compared between the two roots.
const TANGENT_FACTOR: f64 = 4.0;

/// A ray that passes a surface within rounding surely crosses it if it is this steep: the
/// surface would need a radius of curvature of 1e-11 of its size not to be crossed.
const STEEP: f64 = 0.01;

/// Compares answers for one model.
pub(crate) struct Judge<'a> {
    model: &'a Model,
    magnitudes: Vec<f64>,
    radius: f64,
}

impl<'a> Judge<'a> {
    pub(crate) fn new(model: &'a Model) -> Self {
        let magnitude = |surface: &NurbsSurface| {
            let points = surface.control().iter().map(|c| c.truncate() / c.w);
            points.fold(0.0, |most: f64, point| most.max(point.abs().max_element()))
        };
        let magnitudes = model.surfaces.iter().map(magnitude).collect();
        Self { model, magnitudes, radius: model.radius() }
    }

    /// Everything that is wrong with the answers to a ray.
    pub(crate) fn faults(&self, shot: &Shot, answers: &Answers) -> Vec<String> {
        let mut faults = Vec::new();
        let said = [answers.first.hit, answers.exact.hit];
        for hit in said.iter().flatten().chain(&answers.all) {
            faults.extend(self.unsound(&shot.ray, hit));
        }
        faults.extend(self.fast_against_exact(&shot.ray, answers));
        faults.extend(self.first_against_all(&shot.ray, answers));
        faults.extend(self.target_lost(shot, answers));
        faults.extend(self.occlusion_wrong(&shot.ray, answers));
        faults
    }

    /// Whether a hit breaks a promise by itself.
    fn unsound(&self, ray: &Ray, hit: &Hit) -> Option<String> {
        let in_range = ray.t_min() < hit.t && hit.t < ray.t_max();
        if !in_range {
            return Some(format!("t = {} out of range", hit.t));
        }
        let measure = self.measure(ray, hit);
        // What is flagged may be off by some times the promise, but not by anything.
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

    /// A ray aimed steeply at a point of a surface meets it there, if not before.
    fn target_lost(&self, shot: &Shot, answers: &Answers) -> Option<String> {
        let (site, t) = shot.target?;
        let ray = &shot.ray;
        let measure = self.measure_at(ray, site, t);
        if measure.incidence < STEEP {
            return None;
        }
        let slack = self.slack(measure.promise + measure.excuse, measure.incidence);
        let last = t + slack / ray.direction().length();
        for (name, answer) in [("first", answers.first), ("exact", answers.exact)] {
            if !answer.doubtful && answer.hit.is_none_or(|hit| hit.t > last) {
                let has = answer.hit.map(|hit| (hit.t, hit.uv));
                return Some(format!("{name} hit lost the target {site:?} {t}, has {has:?}"));
            }
        }
        let found = |hit: &Hit| (hit.t - t).abs() * ray.direction().length() <= slack;
        (!answers.all_doubtful && !answers.all.iter().any(found)).then(|| {
            format!("all hits lost the target {site:?} {t}, steepness {}", measure.incidence)
        })
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

    /// A line through a closed model enters and leaves in turn.
    pub(crate) fn parity_broken(&self, hits: &[Hit], line: &Ray) -> Option<String> {
        let outward = hits.iter().map(|hit| hit.normal.dot(line.direction()) > 0.0);
        let alternate = outward.enumerate().all(|(k, leaves)| leaves == (k % 2 == 1));
        (hits.len() % 2 == 1 || !alternate).then(|| {
            let hits: Vec<_> = hits.iter().map(|hit| (hit.t, hit.uv, hit.flags)).collect();
            format!("crossings do not alternate: {hits:?}")
        })
    }

    /// Whether a hit has to be found by everyone: it is certain, well inside the range, and
    /// not in the outer half of the slack around a border.
    pub(crate) fn due(&self, ray: &Ray, hit: &Hit) -> bool {
        let measure = self.measure(ray, hit);
        let outside = hit.flags.contains(HitFlags::BORDER)
            && measure.residual > 0.5 * measure.promise + measure.excuse;
        let slack = self.slack(measure.promise + measure.excuse, measure.incidence);
        let at_end = [ray.t_min(), ray.t_max()]
            .iter()
            .any(|end| (hit.t - end).abs() * ray.direction().length() <= slack);
        !hit.flags.contains(HitFlags::DOUBTFUL) && !outside && !at_end
    }

    /// Whether two hits are one root: their `t` agree to within their error bounds, or the
    /// surface between them cannot be told from the ray.
    pub(crate) fn same_root(&self, ray: &Ray, a: &Hit, b: &Hit) -> bool {
        let (at_a, at_b) = (self.measure(ray, a), self.measure(ray, b));
        let bound = at_a.promise + at_a.excuse + at_b.promise + at_b.excuse;
        let slack = self.slack(bound, at_a.incidence.min(at_b.incidence));
        if (a.t - b.t).abs() * ray.direction().length() <= slack {
            return true;
        }
        let between = Hit { t: 0.5 * (a.t + b.t), uv: 0.5 * (a.uv + b.uv), ..*a };
        let between = self.measure(ray, &between);
        a.surface == b.surface && between.residual <= 2.0 * bound
    }

    /// How far along the ray a root may be off, as a length.
    pub(crate) fn slack(&self, bound: f64, incidence: f64) -> f64 {
        (bound / incidence).min(TANGENT_FACTOR * (bound * self.radius).sqrt())
    }

    pub(crate) fn measure(&self, ray: &Ray, hit: &Hit) -> Measure {
        let site = Site { surface: hit.surface as usize, u: hit.uv.x, v: hit.uv.y };
        self.measure_at(ray, site, hit.t)
    }

    fn measure_at(&self, ray: &Ray, site: Site, t: f64) -> Measure {
        let surface = &self.model.surfaces[site.surface];
        let at = surface.derivatives(site.u, site.v);
        let magnitude = ray.origin().abs().max_element().max(self.magnitudes[site.surface]);
        let factor = residual_factor(surface.knots_u().degree(), surface.knots_v().degree());
        let parameters = site.u.abs() * at.du.length() + site.v.abs() * at.dv.length();
        let promise = factor * magnitude;
        let normal = unit_normal(surface, site).unwrap_or(DVec3::ZERO);
        Measure {
            residual: at.point.distance(ray.at(t)),
            promise,
            excuse: promise + 2.0 * UNIT_ROUNDOFF * parameters,
            incidence: normal.dot(ray.direction().normalize()).abs(),
        }
    }
}

fn unit_normal(surface: &NurbsSurface, site: Site) -> Option<DVec3> {
    surface.normal(site.u, site.v)
}
