//! Surfaces of revolution around the z axis: biquadratic sphere, torus, cylinder, cone, disk.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::{DVec3, DVec4};

use super::quadrics::unit_knots;
use super::{ShapeError, check_length};
use crate::geometry::{KnotVector, NurbsSurface};

/// The unit circle, counterclockwise from `(1, 0)`, as `(x, y, w)`: four quarter arcs of
/// degree 2, the corners of a square weighted by cos 45° (Piegl & Tiller 1997, ex. 7.2).
const CIRCLE: [(f64, f64, f64); 9] = [
    (1.0, 0.0, 1.0),
    (1.0, 1.0, FRAC_1_SQRT_2),
    (0.0, 1.0, 1.0),
    (-1.0, 1.0, FRAC_1_SQRT_2),
    (-1.0, 0.0, 1.0),
    (-1.0, -1.0, FRAC_1_SQRT_2),
    (0.0, -1.0, 1.0),
    (1.0, -1.0, FRAC_1_SQRT_2),
    (1.0, 0.0, 1.0),
];

/// The knots of [`CIRCLE`]: a quarter of the unit interval for each arc.
fn circle_knots() -> KnotVector {
    arc_knots(&[0.25, 0.5, 0.75])
}

/// Knots of quadratic arcs that meet at these parameters of the unit interval.
fn arc_knots(inside: &[f64]) -> KnotVector {
    let mut values = vec![0.0; 3];
    values.extend(inside.iter().flat_map(|&t| [t, t]));
    values.extend([1.0; 3]);
    KnotVector::derived(2, values)
}

/// A profile `(r, z, w)` in the half plane `r ≥ 0`, turned around the z axis.
///
/// `u` runs around, counterclockwise seen from `+z`, `v` along the profile, so that
/// `Sᵤ × Sᵥ` points to the right of the profile in the plane of r and z: outward where it
/// rises.
fn revolved(profile: &[(f64, f64, f64)], knots_v: KnotVector) -> NurbsSurface {
    let control: Vec<DVec4> = CIRCLE
        .iter()
        .flat_map(|&(x, y, weight)| {
            profile.iter().map(move |&(r, z, w)| {
                let w = weight * w;
                (w * DVec3::new(r * x, r * y, z)).extend(w)
            })
        })
        .collect();
    NurbsSurface::assembled([circle_knots(), knots_v], control)
}

/// The sphere around the origin as a biquadratic surface of revolution, 9 × 5 control points.
///
/// `u` runs around from `+x` over `+y`, `v` from the pole `−z` to the pole `+z`.
///
/// # Errors
/// When the radius is not positive and finite.
pub fn sphere_biquadratic(radius: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    let (r, c) = (radius, FRAC_1_SQRT_2);
    let profile = [(0.0, -r, 1.0), (r, -r, c), (r, 0.0, 1.0), (r, r, c), (0.0, r, 1.0)];
    Ok(revolved(&profile, arc_knots(&[0.5])))
}

/// The torus around the z axis: the tube of radius `minor` about the circle of radius
/// `major` in the plane `z = 0`. Biquadratic, 9 × 9 control points.
///
/// `u` runs around the axis, `v` around the tube, from its outer equator upwards.
///
/// # Errors
/// When a radius is not positive and finite, or `minor` is not smaller than `major`.
pub fn torus(major: f64, minor: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("major radius", major)?;
    check_length("minor radius", minor)?;
    if minor >= major {
        return Err(ShapeError::Torus { major, minor });
    }
    let profile = CIRCLE.map(|(r, z, w)| (major + minor * r, minor * z, w));
    Ok(revolved(&profile, circle_knots()))
}

/// The side of a cylinder around the z axis, open at `z = 0` and at `z = height`.
///
/// `u` runs around, `v` up.
///
/// # Errors
/// When the radius or the height is not positive and finite.
pub fn cylinder(radius: f64, height: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    check_length("height", height)?;
    Ok(revolved(&[(radius, 0.0, 1.0), (radius, height, 1.0)], unit_knots(1)))
}

/// The side of a cone around the z axis: its open base at `z = 0`, its tip at `z = height`.
///
/// `u` runs around, `v` up. The tip has no normal of its own; each `u` has its limit.
///
/// # Errors
/// When the radius or the height is not positive and finite.
pub fn cone(radius: f64, height: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    check_length("height", height)?;
    Ok(revolved(&[(radius, 0.0, 1.0), (0.0, height, 1.0)], unit_knots(1)))
}

/// The disk around the origin in the plane `z = 0`, facing `+z`.
///
/// `u` runs from the centre, a collapsed edge, to the rim, `v` around.
///
/// # Errors
/// When the radius is not positive and finite.
pub fn disk(radius: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    Ok(revolved(&[(0.0, 0.0, 1.0), (radius, 0.0, 1.0)], unit_knots(1)).swapped())
}
