//! Whether the fast path's answer is right, given all roots from the exact solver.

use nurbray::geometry::NurbsSurface;
use nurbray::intersect::{Answer, Hit, HitFlags};
use nurbray::math::Ray;
use nurbray::math::rounding::{UNIT_ROUNDOFF, residual_factor};

use super::sites::{Sites, magnitude};

/// What is wrong with an answer that carries no doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// The exact solver has a certain hit, the fast path none.
    Miss,
    /// The fast path's hit lies behind a certain hit of the exact solver, by more than the
    /// error bound of `t`.
    WrongRoot,
    /// The fast path's hit is not on the surface and the ray to within the error bound, or not
    /// in the ray's range, or no root of the exact solver lies there.
    FalseHit,
}

/// What was found out about one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Finding {
    /// What is wrong, if anything.
    pub(crate) fault: Option<Fault>,
    /// The residual of the fast path's hit over the largest coordinate magnitude.
    pub(crate) error: Option<f64>,
}

/// Where a hit is and how exact it can be.
#[derive(Clone, Copy, Debug)]
struct Measure {
    /// `|S(u, v) − (o + t d)|`, by the surface as authored.
    residual: f64,
    /// The largest coordinate magnitude of the ray's origin and the surface.
    magnitude: f64,
    /// What the residual may be.
    bound: f64,
    /// `|N·d|` for unit vectors; 0 where there is no normal.
    incidence: f64,
}

/// At `|N·d| → 0` a root moves by the square root of the residual: by `√(8 r b)` for a
/// residual of `b` on a radius of curvature `r`, one root on each side of the tangent point.
/// With r up to two radii of the model (flatter ones are compared by the residual between the
/// roots) this is `4 √(b · radius)`.
const TANGENT_FACTOR: f64 = 4.0;

/// Compares answers for one set of surfaces.
#[derive(Debug)]
pub(crate) struct Judge<'a> {
    surfaces: &'a [NurbsSurface],
    magnitudes: Vec<f64>,
    radius: f64,
}

impl<'a> Judge<'a> {
    /// A judge for the surfaces hits refer to.
    pub(crate) fn new(surfaces: &'a [NurbsSurface]) -> Self {
        Self {
            surfaces,
            magnitudes: surfaces.iter().map(magnitude).collect(),
            radius: Sites::new(surfaces).map_or(0.0, |sites| sites.radius()),
        }
    }

    /// Compares the fast path's answer with all roots by the exact solver, in order of `t`.
    /// `undecided` says that the exact solver could not decide everything.
    pub(crate) fn judge(
        &self,
        ray: &Ray,
        answer: &Answer,
        truth: &[Hit],
        undecided: bool,
    ) -> Finding {
        let measured = answer.hit.map(|hit| (hit, self.measure(ray, &hit)));
        let error = measured.map(|(_, m)| m.residual / m.magnitude);
        let fault = match measured {
            _ if is_doubtful(answer) => None,
            Some((hit, measure)) => self.fault_of_hit(ray, (&hit, &measure), truth, undecided),
            None => truth.iter().any(|hit| self.is_due(ray, hit)).then_some(Fault::Miss),
        };
        Finding { fault, error }
    }

    fn fault_of_hit(
        &self,
        ray: &Ray,
        (hit, measure): (&Hit, &Measure),
        truth: &[Hit],
        undecided: bool,
    ) -> Option<Fault> {
        let in_range = ray.t_min() < hit.t && hit.t < ray.t_max();
        let on_both = measure.residual <= measure.bound; // false for NaN
        if !(in_range && on_both) {
            return Some(Fault::FalseHit);
        }
        let same = |root: &Hit| self.same_root(ray, (hit, measure), root);
        if truth.iter().any(|root| root.t < hit.t && self.is_due(ray, root) && !same(root)) {
            return Some(Fault::WrongRoot);
        }
        let known = truth.iter().any(same);
        let excused = undecided || self.at_range_end(ray, hit, measure) || outside(hit, measure);
        (!known && !excused).then_some(Fault::FalseHit)
    }

    /// Whether the fast path owes this root: it is certain, well inside the range, and not in
    /// the outer half of the slack around a border, where the promise leaves both answers open.
    fn is_due(&self, ray: &Ray, root: &Hit) -> bool {
        let measure = self.measure(ray, root);
        !root.flags.contains(HitFlags::DOUBTFUL)
            && !self.at_range_end(ray, root, &measure)
            && !outside(root, &measure)
    }

    /// Whether two hits are one root: their `t` agree to within their error bounds, or the
    /// surface between them cannot be told from the ray.
    fn same_root(&self, ray: &Ray, (hit, measure): (&Hit, &Measure), root: &Hit) -> bool {
        let other = self.measure(ray, root);
        let bound = measure.bound + other.bound;
        let incidence = measure.incidence.min(other.incidence);
        let tolerance = self.slack(bound, incidence);
        if (hit.t - root.t).abs() * ray.direction().length() <= tolerance {
            return true;
        }
        if hit.surface != root.surface {
            return false;
        }
        let between = Hit { t: 0.5 * (hit.t + root.t), uv: 0.5 * (hit.uv + root.uv), ..*hit };
        let between = self.measure(ray, &between);
        between.residual <= between.bound
    }

    /// Whether a hit is so near an end of the range that rounding decides if it lies inside.
    fn at_range_end(&self, ray: &Ray, hit: &Hit, measure: &Measure) -> bool {
        let slack = self.slack(measure.bound, measure.incidence);
        let near = |end: f64| (hit.t - end).abs() * ray.direction().length() <= slack;
        near(ray.t_min()) || near(ray.t_max())
    }

    /// How far along the ray a root may be off, as a length.
    fn slack(&self, bound: f64, incidence: f64) -> f64 {
        (bound / incidence).min(TANGENT_FACTOR * (bound * self.radius).sqrt())
    }

    fn measure(&self, ray: &Ray, hit: &Hit) -> Measure {
        let index = hit.surface as usize;
        let Some(surface) = self.surfaces.get(index) else {
            // A surface that does not exist: nothing is near it.
            return Measure { residual: f64::NAN, magnitude: 1.0, bound: 0.0, incidence: 0.0 };
        };
        let at = surface.derivatives(hit.uv.x, hit.uv.y);
        let magnitude = ray.origin().abs().max_element().max(self.magnitudes[index]);
        let normal = at.du.cross(at.dv).normalize_or_zero();

        // The promise, twice: once for the hit and once for this evaluation of the surface as
        // authored, not by its pieces. What (u, v) lose by being rounded in their own domain
        // comes on top.
        let factor = residual_factor(surface.knots_u().degree(), surface.knots_v().degree());
        let parameters = hit.uv.x.abs() * at.du.length() + hit.uv.y.abs() * at.dv.length();
        Measure {
            residual: at.point.distance(ray.at(hit.t)),
            magnitude,
            bound: 2.0 * (factor * magnitude + UNIT_ROUNDOFF * parameters),
            incidence: normal.dot(ray.direction().normalize()).abs(),
        }
    }
}

/// Whether the fast path left anything open.
pub(crate) fn is_doubtful(answer: &Answer) -> bool {
    answer.doubtful || answer.hit.is_some_and(|hit| hit.flags.contains(HitFlags::DOUBTFUL))
}

/// Whether the ray passes a border on its outside, farther off than half the slack.
fn outside(hit: &Hit, measure: &Measure) -> bool {
    hit.flags.contains(HitFlags::BORDER) && measure.residual > 0.25 * measure.bound
}
