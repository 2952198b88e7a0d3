//! Newton's iteration on the rational surface: the readable specification.

use glam::{DVec2, DVec3};

use crate::math::{RayFrame, rounding};
use crate::patch::{CLEAR_OF_ERROR, Jet, SURELY, StRect, TensorPatch};

/// The most steps: from a flat leaf's middle plane three are usual, since the number of
/// correct digits doubles; what needs more steps than this is left to the exact solver.
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
    /// Beyond the leaf, where a step leads away so clearly that, by the certificate, the leaf
    /// is proved to be missed.
    Missed,
    /// Outside the domain, or nowhere: nothing is known.
    Failed,
}

/// Where Newton's iteration may go, for a certified leaf and ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct CertifiedLeaf {
    /// The rectangle on which there is at most one root.
    pub(super) domain: StRect,
    /// The part of it that roots are wanted in: the leaf with its slack.
    pub(super) wanted: StRect,
    /// Unit vectors along the leaf's tangents and its normal, and how far tangents tilt: see
    /// [`Certificate`](crate::patch::Certificate).
    pub(super) axes: [DVec3; 3],
    pub(super) tilts: [[f64; 2]; 2],
}

impl CertifiedLeaf {
    /// Whether the step `−delta` from `st` proves that the leaf is missed; `f` is the residual.
    ///
    /// The cross product of `f` and a projected vector `v` is `v · g`, where `g` is `f` turned
    /// by a right angle in the plane perpendicular to the ray.
    fn rule_out(&self, ray: &RayFrame, st: DVec2, delta: DVec2, f: DVec2) -> bool {
        let g = f.x * ray.normals[1] - f.y * ray.normals[0];
        let [a, b, normal] = self.axes.map(|axis| axis.dot(g).abs());
        let (across, rest) = ([a, b], SURELY * f.length());
        (0..2).any(|k| {
            let [low, high] = self.wanted[k];
            let away = (st[k] < low && delta[k] > 0.0) || (st[k] > high && delta[k] < 0.0);
            let [other, out] = self.tilts[k];
            let turned = other * (across[k] + rest) + out * (normal + rest) + rest;
            away && across[1 - k] > turned
        })
    }
}

/// Searches for the root of the two distances from the ray's planes, from a first guess.
///
/// The ray is the meeting of two perpendicular planes with unit normals `nₖ` through its
/// origin `o`; with `fₖ(s, t) = nₖ · (S(s, t) − o)`, `|f|` is the distance of `S` from the
/// ray, in scene units. A step solves `J δ = −f`, `J = [nₖ · S_s, nₖ · S_t]`, by Cramer's
/// rule; `det J = ± d · (S_s × S_t)` vanishes at silhouettes and poles.
///
/// The iteration stays in the domain, the rectangle on which the caller knows that there is
/// at most one root. It ends where `|f| ≤ error`, after one more step if rounding leaves
/// something to gain; where the leaf is proved to be missed; or where it touches the domain's
/// border for the second time. Also returns the number of steps.
///
/// Kajiya 1982 (two planes); Martin, Cohen, Fish & Shirley 2000 (the iteration).
pub(super) fn newton(
    patch: &TensorPatch,
    ray: &RayFrame,
    start: DVec2,
    certified_leaf: &CertifiedLeaf,
    error: f64,
) -> (Newton, u32) {
    let domain = certified_leaf.domain;
    let low = DVec2::new(domain[0][0], domain[1][0]);
    let high = DVec2::new(domain[0][1], domain[1][1]);
    let finest = 4.0 * rounding::UNIT_ROUNDOFF * patch.magnitude().max(ray.magnitude);
    let mut st = start;
    let mut escapes = 0;
    let mut best: Option<(f64, Newton)> = None;

    let mut room = None;
    let net = patch.net(&mut room);
    let mut steps = 0;
    while steps < MOST_STEPS {
        steps += 1;
        let jet = patch.jet_of(net, st);
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
            return (converged, steps);
        }

        let (a, b) = (ray.across(jet.ds), ray.across(jet.dt));
        let delta = DVec2::new(f.perp_dot(b), a.perp_dot(f)) / a.perp_dot(b);
        if residual > CLEAR_OF_ERROR * error && certified_leaf.rule_out(ray, st, delta, f) {
            return (Newton::Missed, steps);
        }
        let next = (st - delta).clamp(low, high);
        if next != st - delta {
            escapes += 1; // also when delta is not a number
        }
        if escapes > 1 {
            break;
        }
        st = next;
    }
    (best.map_or(Newton::Failed, |(_, converged)| converged), steps)
}
