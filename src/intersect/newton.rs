//! Newton's iteration on the rational surface: the readable specification.

use glam::{DVec2, DVec3};

use super::exact::Rect;
use crate::math::{RayFrame, rounding};
use crate::patch::{Jet, TensorPatch};

/// Steps allowed: from a flat leaf's middle plane three are usual, since the number of
/// correct digits doubles; what needs more is left to the exact solver.
const MOST_STEPS: u32 = 12;

/// Where Newton's iteration ended.
#[derive(Clone, Copy, Debug)]
pub(super) enum Newton {
    /// At a point whose distance from the ray is within the error given.
    Converged {
        /// Its parameters.
        st: DVec2,
        /// The surface there.
        jet: Jet,
        /// How far along the ray.
        z: f64,
    },
    /// Outside the domain, or nowhere: nothing is known.
    Failed,
}

/// Searches for the root of the two distances from the ray's planes, from a first guess.
///
/// The ray is the meeting of two perpendicular planes with unit normals `nₖ` through its
/// origin `o`; with `fₖ(s, t) = nₖ · (S(s, t) − o)`, `|f|` is the distance of `S` from the
/// ray, in scene units. A step solves `J δ = −f`, `J = [nₖ · S_s, nₖ · S_t]`, by Cramer's
/// rule; `det J = ± d · (S_s × S_t)` vanishes at silhouettes and poles.
///
/// The iteration stays in `domain`, the rectangle on which the caller knows that there is
/// at most one root; it may touch its border once. It ends where `|f| ≤ error`, after one
/// more step if rounding leaves something to gain. Also returns the number of steps.
///
/// Kajiya 1982 (two planes); Martin, Cohen, Fish & Shirley 2000 (the iteration).
pub(super) fn newton(
    patch: &TensorPatch,
    ray: &RayFrame,
    start: DVec2,
    domain: Rect,
    error: f64,
) -> (Newton, u32) {
    let low = DVec2::new(domain[0][0], domain[1][0]);
    let high = DVec2::new(domain[0][1], domain[1][1]);
    let finest = 4.0 * rounding::UNIT_ROUNDOFF * patch.magnitude().max(ray.magnitude);
    let mut st = start;
    let mut escapes = 0;
    let mut best: Option<(f64, Newton)> = None;

    for step in 1..=MOST_STEPS {
        let jet = patch.jet(st);
        let at = ray.coordinates(jet.point);
        let (f, residual) = (at.truncate(), at.truncate().length());

        // Within the promise: keep it, and stop when rounding leaves nothing to gain.
        let better = best.is_none_or(|(least, _)| residual < least);
        if residual <= error && better {
            best = Some((residual, Newton::Converged { st, jet, z: at.z }));
        }
        if let Some((least, converged)) = best
            && (least <= finest || !better)
        {
            return (converged, step);
        }

        let (a, b) = (project(ray, jet.ds), project(ray, jet.dt));
        let delta = DVec2::new(f.perp_dot(b), a.perp_dot(f)) / a.perp_dot(b);
        let next = (st - delta).clamp(low, high);
        if next != st - delta {
            escapes += 1; // also when delta is not a number
        }
        if escapes > 1 || !next.is_finite() {
            break;
        }
        st = next;
    }
    (best.map_or(Newton::Failed, |(_, converged)| converged), MOST_STEPS)
}

/// The components of a vector along the ray's two planes' normals.
pub(super) fn project(ray: &RayFrame, v: DVec3) -> DVec2 {
    DVec2::new(ray.normals[0].dot(v), ray.normals[1].dot(v))
}
