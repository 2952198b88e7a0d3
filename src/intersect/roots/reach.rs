//! How far off roots may be: across and along the ray, in space and in parameters.

use glam::{DVec2, DVec3};

use crate::math::RayFrame;
use crate::patch::{Jet, Piece};

/// The [error bound](crate::patch::TensorPatch::error_bound) of a piece whose coordinates are no
/// larger than those of `point`.
pub(crate) fn rounding_at(point: DVec3, piece: &Piece, ray: &RayFrame) -> f64 {
    piece.patch.residual_factor() * point.abs().max_element().max(ray.magnitude)
}

/// A ray aimed at a point of a border, or of a trim edge, passes the point within this part of the
/// rounding error bound there: 0.1 is the most that was seen.
pub(crate) const AIMED: f64 = 0.25;

/// The part that counts, for such a ray, of the error bounds of parameters and trim curves. These
/// allow for many more roundings than there are; in space they may be more than a border that meets
/// the edge allows, so that a ray would be said to meet the edge alone, without doubt.
pub(crate) const AIMED_AT_TRIMS: f64 = 0.0625;

/// A trim edge counts as near within this many times the error bound of a hit: the edge itself is
/// on a surface known to rounding, and the edge it is shared with is on another.
pub(crate) const TRIM_REACH: f64 = 4.0;

/// Two searches that are about equally exact find one root within twice the error: a root at a trim
/// edge by one search is within this many times the reach of the edge by the other.
pub(crate) const TRIM_SPARE: f64 = 2.0;

/// How near a trim edge must be, in each parameter, for a root with the error bound `error` in
/// space to be on it.
pub(crate) fn trim_reach(jet: &Jet, error: f64) -> DVec2 {
    parameter_reach(jet, TRIM_REACH * error)
}

/// How far a step of this length on the surface leads in each parameter, at most.
///
/// A step in `s` alone moves the point by `|S_s|`; among steps in `s` and `t` the part of `s` is
/// at most the distance over `|S_s| sin θ`, with `θ` the angle between the tangents. At a pole
/// one tangent vanishes, and its parameter may be anything.
pub(super) fn parameter_reach(jet: &Jet, distance: f64) -> DVec2 {
    let lengths = DVec2::new(jet.ds.length(), jet.dt.length());
    let sine = jet.ds.cross(jet.dt).length() / (lengths.x * lengths.y);
    let sine = if sine > 0.0 { sine } else { 1.0 }; // also where it is not a number
    distance / (lengths * sine)
}

/// How far a root may be off in each parameter: by `across` in any direction, and by `along` in the
/// direction of the ray; at a pole, where that says nothing, by `along` in any direction.
pub(crate) fn root_reach(jet: &Jet, axis: DVec3, across: f64, along: f64) -> DVec2 {
    let step = step_towards(jet, axis).abs();
    if !step.is_finite() {
        return parameter_reach(jet, along);
    }
    parameter_reach(jet, across) + along * step
}

/// The step in parameters that moves the point, to first order, by the part of a vector in the
/// tangent plane.
pub(super) fn step_towards(jet: &Jet, v: DVec3) -> DVec2 {
    let (ss, st, tt) = (jet.ds.length_squared(), jet.ds.dot(jet.dt), jet.dt.length_squared());
    let (s, t) = (jet.ds.dot(v), jet.dt.dot(v));
    DVec2::new(tt * s - st * t, ss * t - st * s) / (ss * tt - st * st)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tangents of different lengths, from a right angle to almost one line.
    fn jets() -> impl Iterator<Item = Jet> {
        let ds = DVec3::new(3.0, 0.0, 0.0);
        [1.5, 1.0, 0.3, 1e-2, 1e-4].into_iter().map(move |angle: f64| {
            let dt = 0.02 * DVec3::new(angle.cos(), 0.6 * angle.sin(), 0.8 * angle.sin());
            Jet { point: DVec3::ZERO, ds, dt }
        })
    }

    /// Unit vectors in the tangent plane, all round.
    fn ways(jet: &Jet) -> impl Iterator<Item = DVec3> + use<> {
        let along = jet.ds.normalize();
        let aside = jet.ds.cross(jet.dt).cross(jet.ds).normalize();
        (0..3600).map(move |k| {
            let (sine, cosine) = (0.1 * f64::from(k)).to_radians().sin_cos();
            cosine * along + sine * aside
        })
    }

    #[test]
    fn steps_lead_to_the_foot() {
        for jet in jets() {
            let normal = jet.ds.cross(jet.dt).normalize();
            for way in ways(&jet) {
                let step = step_towards(&jet, way + 0.7 * normal);
                let moved = step.x * jet.ds + step.y * jet.dt;
                assert!(moved.distance(way) < 1e-6, "{jet:?}: {moved} for {way}");
            }
        }
    }

    /// No step of a length leads farther in a parameter than is said, and some lead as far.
    #[test]
    fn no_step_leads_farther_than_the_reach() {
        let distance = 1e-3;
        for jet in jets() {
            let farthest = ways(&jet)
                .map(|way| step_towards(&jet, distance * way).abs())
                .fold(DVec2::ZERO, DVec2::max);
            let share = farthest / parameter_reach(&jet, distance);
            assert!(share.max_element() < 1.0 + 1e-6, "{jet:?}: {share}");
            assert!(share.min_element() > 1.0 - 1e-5, "{jet:?}: {share}");
        }
    }

    /// A root off by one length across the ray in any direction, and by another along the ray.
    #[test]
    fn roots_are_no_farther_off_than_the_reach() {
        let (across, along) = (1e-6, 1e-3);
        for jet in jets() {
            for axis in ways(&jet).step_by(60) {
                let reach = root_reach(&jet, axis, across, along);
                for way in ways(&jet).step_by(30) {
                    let step = step_towards(&jet, across * way + along * axis).abs();
                    assert!(step.cmple((1.0 + 1e-6) * reach).all(), "{jet:?}: {step} {reach}");
                }
            }
        }
    }

    #[test]
    fn at_a_pole_a_parameter_may_be_anything() {
        let pole = Jet { point: DVec3::ZERO, ds: DVec3::X, dt: DVec3::ZERO };
        let reach = root_reach(&pole, DVec3::X, 1e-15, 1e-12);
        assert_eq!(reach.y, f64::INFINITY);
        assert!((reach.x - 1e-12).abs() < 1e-24, "{reach}");
        assert_eq!(trim_reach(&pole, 1e-12).x, TRIM_REACH * 1e-12);
    }
}
