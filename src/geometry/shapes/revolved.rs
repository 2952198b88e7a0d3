//! Surfaces of revolution around the z axis: biquadratic sphere, torus, cylinder, cone, disk.

use std::f64::consts::FRAC_1_SQRT_2;

use glam::DVec3;

use super::arc::{UnitArc, arc_knots};
use super::turned::{Turned, turned_net};
use super::{ShapeError, check_length, checked};
use crate::geometry::knots::unit_knots;
use crate::geometry::{KnotVector, NurbsSurface};

/// A profile `(r, z, w)` in the half plane `r ≥ 0`, turned around the z axis.
///
/// `u` runs around, counterclockwise seen from `+z`, `v` along the profile, so that
/// `Sᵤ × Sᵥ` points to the right of the profile in the plane of r and z: outward where the
/// profile rises.
fn revolved(profile: &[(f64, f64, f64)], knots_v: KnotVector) -> Result<NurbsSurface, ShapeError> {
    let points: Vec<Turned> = profile
        .iter()
        .map(|&(r, z, weight)| Turned {
            center: z * DVec3::Z,
            across: r * DVec3::X,
            ahead: r * DVec3::Y,
            weight,
        })
        .collect();
    let circle = UnitArc::circle();
    checked([circle.knots, knots_v], turned_net(&circle.points, &points))
}

/// The sphere around the origin as a biquadratic surface of revolution, 9 × 5 control points.
///
/// `u` runs around from `+x` over `+y`, `v` from the pole `−z` to the pole `+z`.
///
/// # Errors
/// When the radius is not from 1e-70 to 1e70.
pub fn sphere_biquadratic(radius: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    let (r, c) = (radius, FRAC_1_SQRT_2);
    let profile = [(0.0, -r, 1.0), (r, -r, c), (r, 0.0, 1.0), (r, r, c), (0.0, r, 1.0)];
    revolved(&profile, arc_knots(&[0.5]))
}

/// The torus around the z axis: the tube of radius `minor` about the circle of radius
/// `major` in the plane `z = 0`. Biquadratic, 9 × 9 control points.
///
/// `u` runs around the axis, `v` around the tube, from its outer equator upwards.
///
/// # Errors
/// When a radius is not from 1e-70 to 1e70, or `minor` is not smaller than `major`.
pub fn torus(major: f64, minor: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("major radius", major)?;
    check_length("minor radius", minor)?;
    if minor >= major {
        return Err(ShapeError::Torus { major, minor });
    }
    let circle = UnitArc::circle();
    let around = circle.points.iter().map(|&(r, z, w)| (major + minor * r, minor * z, w));
    revolved(&around.collect::<Vec<_>>(), circle.knots)
}

/// The side of a cylinder around the z axis, open at `z = 0` and at `z = height`.
///
/// `u` runs around, `v` up.
///
/// # Errors
/// When the radius or the height is not from 1e-70 to 1e70.
pub fn cylinder(radius: f64, height: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    check_length("height", height)?;
    revolved(&[(radius, 0.0, 1.0), (radius, height, 1.0)], unit_knots(1))
}

/// The side of a cone around the z axis: its open base at `z = 0`, its tip at `z = height`.
///
/// `u` runs around, `v` up. The tip has no normal of its own; each `u` has its own limit normal.
///
/// # Errors
/// When the radius or the height is not from 1e-70 to 1e70.
pub fn cone(radius: f64, height: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    check_length("height", height)?;
    revolved(&[(radius, 0.0, 1.0), (0.0, height, 1.0)], unit_knots(1))
}

/// The disk around the origin in the plane `z = 0`, facing `+z`.
///
/// `u` runs from the centre, a collapsed edge, to the rim, `v` around.
///
/// # Errors
/// When the radius is not from 1e-70 to 1e70.
pub fn disk(radius: f64) -> Result<NurbsSurface, ShapeError> {
    check_length("radius", radius)?;
    Ok(revolved(&[(0.0, 0.0, 1.0), (radius, 0.0, 1.0)], unit_knots(1))?.swapped())
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    /// Closed surfaces close bit for bit: the last points around are the first.
    fn closes_in_u(surface: &NurbsSurface) {
        let [nu, nv] = surface.size();
        for j in 0..nv {
            assert_eq!(surface.homogeneous(0, j), surface.homogeneous(nu - 1, j));
        }
    }

    #[test]
    fn revolved_spheres_and_tori_are_round_and_closed() {
        for size in [1e-8, 1.0, 1e8] {
            let sphere = sphere_biquadratic(size).unwrap();
            let torus = torus(3.0 * size, size).unwrap();
            closes_in_u(&sphere);
            closes_in_u(&torus);
            closes_in_u(&torus.swapped());
            for i in 0..=30 {
                for j in 0..=30 {
                    let (u, v) = (f64::from(i) / 30.0, f64::from(j) / 30.0);
                    let round = sphere.point_at(DVec2::new(u, v)).length() / size - 1.0;
                    assert!(round.abs() < 1e-15, "({u}, {v}): off by {round:e}");
                    let p = torus.point_at(DVec2::new(u, v)) / size;
                    let tube = (p.truncate().length() - 3.0).hypot(p.z) - 1.0;
                    assert!(tube.abs() < 2e-15, "({u}, {v}): off by {tube:e}");
                }
            }
            assert_eq!(torus.point_at(DVec2::new(0.0, 0.25)), DVec3::new(3.0 * size, 0.0, size));
            assert_eq!(sphere.point_at(DVec2::new(0.25, 0.5)), DVec3::new(0.0, size, 0.0));
        }
    }

    #[test]
    fn cones_and_disks_have_straight_rulings() {
        let (cone, disk) = (cone(2.0, 3.0).unwrap(), disk(2.0).unwrap());
        closes_in_u(&cone);
        closes_in_u(&disk.swapped());
        for i in 0..=20 {
            for j in 0..=20 {
                let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
                let p = cone.point_at(DVec2::new(u, v));
                assert!((p.z - 3.0 * v).abs() < 1e-15 * 3.0);
                assert!((p.truncate().length() - 2.0 * (1.0 - v)).abs() < 1e-15 * 2.0);
                let p = disk.point_at(DVec2::new(v, u));
                assert!(p.z == 0.0 && (p.length() - 2.0 * v).abs() < 1e-15 * 2.0);
            }
        }
    }

    #[test]
    fn measures_must_be_lengths() {
        assert_eq!(
            torus(1.0, 1.5).unwrap_err().to_string(),
            "minor radius 1.5: it must be smaller than the major radius 1, \
             else the torus meets itself"
        );
        assert_eq!(
            cylinder(1.0, 0.0).unwrap_err().to_string(),
            "height 0: it must be positive and finite (from 1e-70 to 1e70)"
        );
        assert!(torus(f64::NAN, 1.0).is_err() && torus(1.0, -1.0).is_err());
        assert!(cone(0.0, 1.0).is_err() && cone(1.0, 0.0).is_err() && disk(-1.0).is_err());
        assert!(sphere_biquadratic(0.0).is_err() && cylinder(0.0, 1.0).is_err());
    }
}
