//! Surfaces of revolution.

use glam::DVec3;

use super::axis_points::cut_at_axis;
use super::fold::check_turned;
use super::net_size::net_size;
use super::{Axis, ConstructError};
use crate::geometry::shapes::{Turned, UnitArc, turned_net};
use crate::geometry::{NurbsCurve, NurbsSurface};

/// A point is on the axis if its distance is within the rounding error of its own coordinates and
/// of the distance: about six operations of half an ulp each.
const ON_AXIS: f64 = 4.0 * f64::EPSILON;

/// A control point of a profile, turned about an axis.
fn turned(point: DVec3, weight: f64, axis: &Axis) -> Turned {
    let across = axis.across(point);
    let rounding = ON_AXIS * point.abs().max_element().max(axis.magnitude());
    if across.length() <= rounding {
        return Turned { center: point, across: DVec3::ZERO, ahead: DVec3::ZERO, weight };
    }
    let ahead = axis.direction().cross(across);
    Turned { center: axis.nearest(point), across, ahead, weight }
}

/// The surface that a profile passes over when it is turned about an axis: exact, rational
/// of degree 2 around.
///
/// `u` in `[0, 1]` runs around, counterclockwise as seen from the tip of the axis (clockwise for a
/// negative angle), `v` along the profile on its own domain. Where the profile rises along the
/// axis, `Sᵤ × Sᵥ` points away from the axis (towards it for a negative angle). A full turn closes
/// bit for bit, and points on the axis (within rounding) become an exactly collapsed edge. A
/// profile may cross the axis: the surface then meets itself there, and beyond that place its
/// normals point inward. Where the profile crosses or touches the axis between control points,
/// knots are inserted, so that no patch has such a place in its interior. But no part of the
/// profile may be taken to where another part has been: a full circle turned about its own diameter
/// makes a sphere with 180°, and covers it twice with 360°.
///
/// The arcs have degree 2 and at most 90° each (Piegl & Tiller 1997, A8.1).
///
/// # Errors
/// When the angle is zero or more than a full turn, or the profile lies on the axis, runs back
/// over itself, or is turned onto another part of itself; when the surface would be too large.
pub fn revolve(
    profile: &NurbsCurve,
    axis: &Axis,
    degrees: f64,
) -> Result<NurbsSurface, ConstructError> {
    let usable = degrees != 0.0 && degrees.abs() <= 360.0; // false for NaN
    if !usable {
        return Err(ConstructError::Angle { degrees });
    }
    let points = |profile: &NurbsCurve| -> Vec<Turned> {
        (0..profile.control().len())
            .map(|index| turned(profile.vertex(index), profile.control()[index].w, axis))
            .collect()
    };
    if points(profile).iter().all(|point| point.across == DVec3::ZERO) {
        return Err(ConstructError::OnAxis);
    }
    let arc = UnitArc::new(0.0, degrees);
    net_size(arc.points.len(), profile.control().len())?;
    check_turned(profile, axis, degrees)?;
    let profile = &cut_at_axis(profile, axis)?;
    net_size(arc.points.len(), profile.control().len())?; // there may be more knots now
    let net = turned_net(&arc.points, &points(profile));
    Ok(NurbsSurface::from_homogeneous(arc.knots, profile.knots().clone(), net)?)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::geometry::{KnotVector, shapes};

    fn line(a: [f64; 3], b: [f64; 3]) -> NurbsCurve {
        NurbsCurve::polyline(&[a.into(), b.into()]).unwrap()
    }

    #[test]
    fn lines_become_cylinders_cones_and_disks() {
        for size in [1e-8, 1.0, 1e8] {
            let at = |x: f64, z: f64| [x * size, 0.0, z * size];
            let cylinder = revolve(&line(at(2.0, 0.0), at(2.0, 3.0)), &Axis::Z, 360.0).unwrap();
            let same = shapes::cylinder(2.0 * size, 3.0 * size).unwrap();
            assert_eq!(cylinder.control(), same.control());
            let cone = revolve(&line(at(2.0, 0.0), at(0.0, 3.0)), &Axis::Z, 360.0).unwrap();
            assert_eq!(cone.control(), shapes::cone(2.0 * size, 3.0 * size).unwrap().control());
        }
    }

    /// A circle off a slanted axis, turned about it: each point of the torus satisfies
    /// (√(x² + y²) − R)² + z² = r² in the axis' own coordinates.
    #[test]
    fn a_circle_becomes_a_torus_about_any_axis() {
        for (size, degrees) in [(1e-8, 360.0), (1.0, 250.0), (1.0, -30.0), (1e8, 360.0)] {
            let origin = DVec3::new(3.0, -1.0, 2.0) * size;
            let w = DVec3::new(1.0, 2.0, -0.5).normalize();
            let (a, b) = w.any_orthonormal_pair();
            let circle = UnitArc::circle();
            let control = circle.points.iter().map(|&(x, y, weight)| {
                let point = origin + size * ((3.0 + x) * a + y * w);
                (weight * point).extend(weight)
            });
            let profile = NurbsCurve::from_homogeneous(circle.knots, control.collect()).unwrap();
            let axis = Axis::new(origin, 1e-5 * w).unwrap();
            let torus = revolve(&profile, &axis, degrees).unwrap();
            for (i, j) in (0..=24).flat_map(|i| (0..=24).map(move |j| (i, j))) {
                let (u, v) = (f64::from(i) / 24.0, f64::from(j) / 24.0);
                let p = (torus.point_at(DVec2::new(u, v)) - origin) / size;
                let z = p.dot(w);
                let off = ((p - z * w).length() - 3.0).hypot(z) - 1.0;
                assert!(off.abs() < 1e-14, "({u}, {v}): off by {off:e}");
            }
            // The turn ends where it should.
            let turn = glam::DQuat::from_axis_angle(w, degrees.to_radians());
            let off = torus.point_at(DVec2::new(1.0, 0.3))
                - origin
                - turn * (torus.point_at(DVec2::new(0.0, 0.3)) - origin);
            assert!(off.length() < 1e-14 * size, "{degrees}: {off}");
            // The normal points outward on the outer equator.
            let normal = torus.normal(DVec2::ZERO).unwrap();
            assert!((normal.dot(a) - degrees.signum()).abs() < 1e-14);
            assert!(normal.dot(b).abs() < 1e-14);
        }
    }

    #[test]
    fn points_on_a_slanted_axis_stay_one_point() {
        let origin = DVec3::new(0.1, 0.2, 0.3);
        let axis = Axis::new(origin, DVec3::new(0.3, -0.7, 0.2)).unwrap();
        let at = |along: f64, away: DVec3| origin + along * axis.direction() + away;
        let side = axis.direction().any_orthogonal_vector();
        let points = vec![at(0.7, DVec3::ZERO), at(1.3, side), at(1.9, DVec3::ZERO)];
        let knots = KnotVector::bezier(2).unwrap();
        let profile = NurbsCurve::new(knots, points.clone(), Some(vec![1.0, 0.7, 2.0])).unwrap();
        let lens = revolve(&profile, &axis, 360.0).unwrap();
        for i in 0..9 {
            let (first, last) = (lens.vertex(i, 0), lens.vertex(i, 2));
            assert!(first.distance(points[0]) < 1e-16 && last.distance(points[2]) < 3e-16);
            assert_eq!(lens.vertex(0, 1), lens.vertex(8, 1), "closed");
        }
        let poles = [lens.normal(DVec2::new(0.3, 0.0)), lens.normal(DVec2::new(0.8, 1.0))]
            .map(Option::unwrap);
        assert!(poles.iter().all(|normal| normal.is_finite()));
    }

    #[test]
    fn what_cannot_be_turned() {
        let profile = line([1.0, 0.0, 0.0], [1.0, 0.0, 2.0]);
        let message = |degrees| revolve(&profile, &Axis::Z, degrees).unwrap_err().to_string();
        assert_eq!(message(0.0), "angle 0°: it must be from -360° to 360°, and not 0°");
        assert_eq!(message(361.0), "angle 361°: it must be from -360° to 360°, and not 0°");
        assert!(revolve(&profile, &Axis::Z, f64::NAN).is_err());
        let on = line([0.0, 0.0, -1.0], [0.0, 0.0, 2.0]);
        assert_eq!(
            revolve(&on, &Axis::Z, 90.0).unwrap_err().to_string(),
            "the profile lies on the axis: turned about it, it remains a line"
        );
        assert_eq!(
            Axis::new(DVec3::ZERO, DVec3::ZERO).unwrap_err().to_string(),
            "direction of the axis (0, 0, 0): it must be finite and not zero"
        );
        assert!(Axis::new(DVec3::NAN, DVec3::X).is_err());
        assert_eq!(
            Axis::new(DVec3::new(1e300, 0.0, 0.0), DVec3::Z).unwrap_err().to_string(),
            "the axis goes through (1e300, 0, 0): that is too far away; give a point of it with \
             coordinates of up to 1e70"
        );
        assert!(Axis::new(DVec3::new(1e70, 0.0, 0.0), DVec3::Z).is_ok());
        assert!(Axis::new(DVec3::ZERO, DVec3::splat(1e-300)).is_ok());
    }
}
