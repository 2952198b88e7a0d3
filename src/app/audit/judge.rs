//! Whether the fast path's answer is right, given all roots from the exact solver.
//!
//! The tests judge by `tests/common/judge.rs`, which says in what the two differ.

use glam::{DVec2, DVec3};
use nurbray::geometry::trim::Side;
use nurbray::geometry::{Charts, Surface};
use nurbray::intersect::{Answer, Hit, HitFlags, Occlusion};
use nurbray::math::Ray;
use nurbray::math::rounding::{UNIT_ROUNDOFF, residual_factor};

use super::super::border::magnitude;
use super::outlines::Outline;
use super::rays::Shot;
use super::sites::{Site, control_radius};

/// What is wrong with an answer that carries no doubt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Fault {
    /// There is a certain hit, but the fast path reports no hit or no occlusion. Certain hits are
    /// those of the exact solver without doubt, and the surface point the ray was aimed at.
    Miss,
    /// The fast path's hit lies behind a certain hit, by more than the error bound of `t`.
    WrongRoot,
    /// The fast path's hit is off the surface or the ray by more than the error bound, outside the
    /// ray's range, in a part that trims have cut off, or not a root of the exact solver; or the
    /// fast path reports a ray that meets nothing as occluded.
    FalseHit,
}

/// The audit's finding on one ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Finding {
    /// What is wrong, if anything.
    pub(crate) fault: Option<Fault>,
    /// The residual of the fast path's hit over the largest coordinate magnitude.
    pub(crate) error: Option<f64>,
    /// Whether the fast path's first-hit answer is doubtful.
    pub(crate) doubtful: bool,
    /// Whether the fast path's occlusion answer is doubtful.
    pub(crate) doubtful_any: bool,
    /// Whether the ray is exactly tangent to a surface, as far as floating point can tell, or
    /// runs inside one.
    pub(crate) tangent: bool,
}

/// The exact solver's result for the ray.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Truth<'a> {
    /// All hits by the exact solver. If the ray leaves a root, those of the plain ray are among them,
    /// too, as far as they [are ahead](Judge::is_ahead).
    pub(crate) hits: &'a [Hit],
    /// Whether the exact solver could not decide everything.
    pub(crate) undecided: bool,
}

/// The error of a hit and its bounds.
#[derive(Clone, Copy, Debug)]
struct Measure {
    /// `|S(u, v) − (o + t d)|`, by the surface as authored.
    residual: f64,
    /// The largest coordinate magnitude of the ray's origin and the surface's control points.
    magnitude: f64,
    /// The largest residual that the promise allows.
    promise: f64,
    /// The largest residual allowed as measured here.
    bound: f64,
    /// `|N·d|` for unit vectors; 0 where there is no normal.
    incidence: f64,
}

/// As `|N·d| → 0`, a root moves with the square root of the residual: a residual of `b` on a
/// radius of curvature `r` moves it by `√(8 r b)`, with one root on each side of the tangent point.
/// For `r` up to two radii of the model this is `4 √(b · radius)`; flatter surfaces are compared
/// by the residual between the roots.
const TANGENT_FACTOR: f64 = 4.0;

/// The `|N·d|` from which on an aimed ray surely crosses the surface. A ray that passes the
/// surface at a distance `b` with `|N·d| = c` does if the radius of curvature exceeds `2 b / c²`:
/// with rounding for `b` and this constant for `c`, that is 1e-11 of the coordinates' size.
const SURE_INCIDENCE: f64 = 0.01;

/// What a plain ray meets counts as ahead of a start beyond this many times the start's error along
/// the ray: the start may be off by that, and so may what another surface has there.
const START: f64 = 4.0;

/// How wide the strip is beside a trim edge in which a ray is said to meet the edge, in error bounds
/// of hits.
const EDGE_STRIP: f64 = 10.0;

/// Compares answers for one set of surfaces.
#[derive(Debug)]
pub(crate) struct Judge<'a> {
    surfaces: &'a [Surface],
    magnitudes: Vec<f64>,
    /// The kept parts of the surfaces, found without the tracer's own trim test.
    outlines: Vec<Outline>,
    /// The radius of a sphere about all control points.
    radius: f64,
}

impl<'a> Judge<'a> {
    /// Makes a judge for the surfaces that hits refer to.
    pub(crate) fn new(surfaces: &'a [Surface]) -> Self {
        Self {
            surfaces,
            magnitudes: surfaces.iter().map(largest).collect(),
            outlines: surfaces.iter().map(Outline::of).collect(),
            radius: control_radius(surfaces),
        }
    }

    /// Compares the fast path's first hit and its occlusion answer with the truth.
    pub(crate) fn judge(
        &self,
        shot: &Shot,
        (answer, shadow): (&Answer, Occlusion),
        truth: &Truth<'_>,
    ) -> Finding {
        let ray = shot.query.ray();
        let measured = answer.hit.map(|hit| (hit, self.measure(ray, &hit)));
        let error = measured.map(|(_, m)| m.residual / m.magnitude);
        let doubtful = answer.doubtful;
        let fault = match measured {
            _ if doubtful => None,
            Some((hit, measure)) => self.fault_of_hit(shot, (&hit, &measure), truth),
            None => self.is_owed(shot, truth).then_some(Fault::Miss),
        };
        let fault = fault.or_else(|| self.fault_of_shadow(shot, shadow, answer, truth));
        let tangent = self.tangent(ray, answer.hit.iter().chain(truth.hits));
        Finding { fault, error, doubtful, doubtful_any: shadow.doubtful, tangent }
    }

    /// Whether a hit of a ray that leaves no root, asked of the exact solver, is ahead of the place
    /// where one does: by several times what the root there, and the hit, may be off. So it does not
    /// depend on how the tracer tells the start from what lies beside it.
    pub(crate) fn is_ahead(&self, ray: &Ray, start: Site, hit: &Hit) -> bool {
        let slack = |measure: Measure| self.slack(measure.bound, measure.incidence);
        let clear = START * slack(self.at(ray, start, 0.0)) + slack(self.measure(ray, hit));
        hit.t * ray.direction().length() > clear
    }

    /// Returns the fault of the occlusion answer `shadow`, if any. `first` is the fast path's
    /// answer for the first hit of the same ray.
    ///
    /// A root within rounding of a border or of an end of the range may be found by one of the
    /// three searches and not by the others. If only the occlusion search finds one, it would be
    /// called a false hit, too. No such ray is known.
    fn fault_of_shadow(
        &self,
        shot: &Shot,
        shadow: Occlusion,
        first: &Answer,
        truth: &Truth<'_>,
    ) -> Option<Fault> {
        if shadow.doubtful {
            return None;
        }
        if shadow.occluded {
            // The occlusion answer does not say where: any root justifies it, certain or not.
            let nothing = truth.hits.is_empty() && !truth.undecided;
            return (nothing && first.hit.is_none() && !first.doubtful).then_some(Fault::FalseHit);
        }
        self.is_owed(shot, truth).then_some(Fault::Miss)
    }

    /// Whether the fast path must report a hit.
    fn is_owed(&self, shot: &Shot, truth: &Truth<'_>) -> bool {
        let due = |hit| self.is_due(shot.query.ray(), hit);
        truth.hits.iter().any(due) || self.target(shot).is_some()
    }

    fn fault_of_hit(
        &self,
        shot: &Shot,
        (hit, measure): (&Hit, &Measure),
        truth: &Truth<'_>,
    ) -> Option<Fault> {
        let ray = shot.query.ray();
        let in_range = ray.t_min() < hit.t && hit.t < ray.t_max();
        let on_both = measure.residual <= measure.bound; // false for NaN
        if !(in_range && on_both) || self.cut_off(hit, measure) {
            return Some(Fault::FalseHit);
        }
        let same = |root: &Hit| {
            self.same_root(ray, (hit, measure), root) || self.same_edge(ray, (hit, measure), root)
        };
        let behind = |root: &Hit| root.t < hit.t && self.is_due(ray, root) && !same(root);
        let behind_target = self.target(shot).is_some_and(|last| hit.t > last);
        if behind_target || truth.hits.iter().any(behind) {
            return Some(Fault::WrongRoot);
        }
        let known = truth.hits.iter().any(same);
        let excused =
            truth.undecided || self.at_range_end(ray, hit, measure) || self.is_beyond(hit, measure);
        (!known && !excused).then_some(Fault::FalseHit)
    }

    /// Whether a hit is surely in a part that trims have cut off: no trim edge lies within the
    /// hit's error bound, which near a pole is large in the parameter that runs around the pole.
    fn cut_off(&self, hit: &Hit, measure: &Measure) -> bool {
        let outlines = self.outlines.get(hit.surface as usize).and_then(Outline::lines);
        outlines.is_some_and(|outlines| {
            let at = self.surfaces[hit.surface as usize].derivatives(hit.uv);
            let off = 2.0 * self.slack(measure.bound, measure.incidence);
            let reach = off / DVec2::new(at.du.length(), at.dv.length());
            outlines.keeps(hit.uv) == Some(false) && !outlines.passes(hit.uv, reach)
        })
    }

    /// Returns the last `t` at which the first hit of a ray aimed at a point of a surface may lie.
    /// Returns `None` if the ray is not aimed at a point, if it is too flat there to be sure that
    /// it crosses the surface, or if trims may have cut the point off, as far as is known. On a
    /// border or a trim edge the ray need not cross: whatever passes within rounding has to be
    /// reported.
    fn target(&self, shot: &Shot) -> Option<f64> {
        let (site, t) = shot.target?;
        let (on_edge, kept) = match &self.outlines[site.surface] {
            Outline::Whole => (false, true),
            Outline::Within(lines) => {
                (lines.is_kept_corner(site.uv), lines.keeps(site.uv) == Some(true))
            }
            Outline::Unknown => (false, false),
        };
        if !(kept || on_edge) {
            return None;
        }
        let ray = shot.query.ray();
        let length = ray.direction().length();
        let surface = &self.surfaces[site.surface];
        let normal = surface.normal(site.uv).unwrap_or_default();
        let incidence = normal.dot(ray.direction()).abs() / length;
        let Measure { bound, promise, .. } = self.at(ray, site, t);
        let on_border = surface.on_border(site.uv);
        // Rounded parameters may lie beyond a side along which neither is constant, such as the
        // third side of a triangle; where weights make points move fast, by more than the promise.
        if on_border && surface.nurbs().is_none() && bound > 2.5 * promise {
            return None;
        }
        let due = on_border || on_edge || incidence >= SURE_INCIDENCE;
        due.then(|| t + self.slack(bound, incidence) / length)
    }

    /// Whether the fast path owes this root: the root is certain, well inside the range, and
    /// neither in the outer half of the slack around a border nor beyond a trim edge, where the
    /// promise leaves both answers open.
    fn is_due(&self, ray: &Ray, root: &Hit) -> bool {
        let measure = self.measure(ray, root);
        !root.flags.contains(HitFlags::DOUBTFUL)
            && !self.at_range_end(ray, root, &measure)
            && !self.is_beyond(root, &measure)
    }

    /// Whether the ray passes outside a border by more than half the slack, or on the cut-off side
    /// of a trim edge by more than the promise and the curve's error together. As far as the tracer
    /// can tell, the distance is within the hit's error bound.
    fn is_beyond(&self, hit: &Hit, measure: &Measure) -> bool {
        (hit.flags.contains(HitFlags::BORDER) && measure.residual > 0.25 * measure.bound)
            || (hit.flags.contains(HitFlags::TRIM_EDGE)
                && self.is_beyond_edge(hit, measure.promise))
    }

    /// Whether everything within the distance `near` of a hit, in space, is cut off.
    fn is_beyond_edge(&self, hit: &Hit, near: f64) -> bool {
        let Some(surface) = self.surfaces.get(hit.surface as usize) else { return false };
        let Some(trimmed) = surface.trimmed() else { return false };
        let at = surface.derivatives(hit.uv);
        let lengths = DVec2::new(at.du.length(), at.dv.length());
        let sine = at.du.cross(at.dv).length() / (lengths.x * lengths.y);
        let reach = near / (lengths * sine); // NaN or infinite at a pole
        let reach = DVec2::select(reach.cmpge(DVec2::ZERO), reach, DVec2::INFINITY);
        trimmed.trims().side_within(hit.uv, reach) == Side::Outside
    }

    /// Whether two hits are one root: their `t` agree to within their error bounds, or the
    /// surface between them cannot be distinguished from the ray.
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
        // Where the ray comes nearest to a surface point between them; weights may put this point
        // near one of them.
        let uv = 0.5 * (hit.uv + root.uv);
        let offset = self.surfaces[hit.surface as usize].point_at(uv) - ray.origin();
        let t = offset.dot(ray.direction()) / ray.direction().length_squared();
        let between = self.measure(ray, &Hit { t, uv, ..*hit });
        between.residual <= between.bound
    }

    /// Whether a hit and a root are on two faces that end at one edge. Among all hits they are one
    /// crossing, and either face may be named: edges that nearly meet are met within a strip.
    fn same_edge(&self, ray: &Ray, (hit, measure): (&Hit, &Measure), root: &Hit) -> bool {
        let at_trims = root.flags.contains(HitFlags::TRIM_EDGE);
        let at_end = |flag| hit.flags.contains(flag);
        let are_ends = at_trims && (at_end(HitFlags::BORDER) || at_end(HitFlags::TRIM_EDGE));
        let other = self.measure(ray, root);
        let incidence = measure.incidence.min(other.incidence);
        let strip = EDGE_STRIP * self.slack(measure.bound + other.bound, incidence);
        are_ends
            && hit.surface != root.surface
            && (hit.t - root.t).abs() * ray.direction().length() <= strip
    }

    /// Whether a hit is so near an end of the range that rounding decides if it lies inside.
    fn at_range_end(&self, ray: &Ray, hit: &Hit, measure: &Measure) -> bool {
        let slack = self.slack(measure.bound, measure.incidence);
        let near = |end: f64| (hit.t - end).abs() * ray.direction().length() <= slack;
        near(ray.t_min()) || near(ray.t_max())
    }

    /// Whether the ray is exactly tangent at one of these hits: on its way from the hit to the
    /// tangent point it departs from the surface by no more than the bound of the residual. With
    /// the radius of curvature `r` and `|N·d| = c`, the way is `r c`, and the departure `r c² / 2`.
    fn tangent<'h>(&self, ray: &Ray, mut hits: impl Iterator<Item = &'h Hit>) -> bool {
        hits.any(|hit| {
            let incidence = hit.normal.dot(ray.direction().normalize()); // NaN without a normal
            let bound = self.measure(ray, hit).bound;
            let flat = 0.5 * self.radius * incidence.powi(2) <= bound;
            flat || hit.flags.contains(HitFlags::INSIDE)
        })
    }

    /// The error bound of a root along the ray, as a length.
    fn slack(&self, bound: f64, incidence: f64) -> f64 {
        (bound / incidence).min(TANGENT_FACTOR * (bound * self.radius).sqrt())
    }

    fn measure(&self, ray: &Ray, hit: &Hit) -> Measure {
        let surface = hit.surface as usize;
        if surface >= self.surfaces.len() {
            // A surface that does not exist: nothing is near it.
            let (residual, magnitude) = (f64::NAN, 1.0);
            return Measure { residual, magnitude, promise: 0.0, bound: 0.0, incidence: 0.0 };
        }
        self.at(ray, Site { surface, uv: hit.uv }, hit.t)
    }

    fn at(&self, ray: &Ray, site: Site, t: f64) -> Measure {
        let surface = &self.surfaces[site.surface];
        let at = surface.derivatives(site.uv);
        let magnitude = ray.origin().abs().max_element().max(self.magnitudes[site.surface]);
        let normal = at.du.cross(at.dv).normalize_or_zero();

        // Twice the promise: once for the hit and once for this evaluation, which uses the surface
        // as authored and not its pieces. The rounding of (u, v) in their own domain comes on top;
        // at a knot its effect may be larger before the knot than behind it.
        let [p, q] = surface.degree();
        let factor = residual_factor(p, q);
        let [u, v] = site.uv.to_array();
        let before = surface.derivatives(DVec2::new(u.next_down(), v.next_down()));
        let speed = |here: DVec3, before: DVec3| here.length().max(before.length());
        let parameters = u.abs() * speed(at.du, before.du) + v.abs() * speed(at.dv, before.dv);
        Measure {
            residual: at.point.distance(ray.at(t)),
            magnitude,
            promise: factor * magnitude,
            bound: 2.0 * (factor * magnitude + UNIT_ROUNDOFF * parameters),
            incidence: normal.dot(ray.direction().normalize()).abs(),
        }
    }
}

/// The largest coordinate of a surface's control points, in absolute value.
fn largest(surface: &Surface) -> f64 {
    surface.charts().iter().map(|chart| magnitude(&chart.surface)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests;
