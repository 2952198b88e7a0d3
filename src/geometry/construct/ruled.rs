//! Surfaces of straight lines: extrusions and ruled surfaces.

use glam::{DVec3, DVec4};

use super::compatible::{compatible, same_weights};
use super::fold::{check_fold, check_moved};
use super::net_size::net_size;
use super::{ConstructError, DirectionOf};
use crate::geometry::curve::SAME_PLACE;
use crate::geometry::knots::unit_knots;
use crate::geometry::{NurbsCurve, NurbsSurface};
use crate::math::ShownVector;

/// The surface that a profile passes over when it is moved along a vector: exact.
///
/// `u` runs along the profile on its own domain, `v` in `[0, 1]` along the vector. Where the
/// profile runs counterclockwise as seen from where the vector points, `Sᵤ × Sᵥ` points
/// outward.
///
/// # Errors
/// When the vector is zero, not finite, or within rounding of the profile's coordinates; when the
/// profile runs back over itself; or when it does so as seen along the vector, as a circle does in
/// its own plane: it would pass over the same places twice; or when the surface would be too large.
pub fn extrude(profile: &NurbsCurve, by: DVec3) -> Result<NurbsSurface, ConstructError> {
    let usable = by.is_finite() && by != DVec3::ZERO;
    if !usable {
        return Err(ConstructError::Direction { what: DirectionOf::Extrusion, vector: by });
    }
    if by.length() <= SAME_PLACE * profile.magnitude() {
        let which = format!("the profile and itself moved by {}", ShownVector(by));
        return Err(ConstructError::NothingBetween { which });
    }
    let size = net_size(profile.control().len(), 2)?;
    check_fold(profile, "profile")?;
    check_moved(profile, by, "profile")?;
    let moved = |point: &DVec4| [*point, *point + (point.w * by).extend(0.0)];
    let mut net = Vec::with_capacity(size);
    net.extend(profile.control().iter().flat_map(moved));
    Ok(NurbsSurface::from_homogeneous(profile.knots().clone(), unit_knots(1), net)?)
}

/// Fails if there is nothing between two compatible curves, or if one is the other, translated, and
/// passes over itself on the way.
fn check_between(from: &NurbsCurve, to: &NurbsCurve) -> Result<(), ConstructError> {
    let near = SAME_PLACE * from.magnitude().max(to.magnitude());
    let steps = || (0..from.control().len()).map(|i| to.vertex(i) - from.vertex(i));
    let same_weights = same_weights(from, to);
    if same_weights && steps().all(|step| step.length() <= near) {
        let which = "curves `from` and `to`".to_owned();
        return Err(ConstructError::NothingBetween { which });
    }
    let by = to.vertex(0) - from.vertex(0);
    let moved = steps().all(|step| step.distance(by) <= near);
    if moved && same_weights { check_moved(from, by, "curve `from`") } else { Ok(()) }
}

/// The surface of the straight lines that join two curves, each point of one with the point of the
/// other at the same fraction of its domain.
///
/// `u` runs along both curves (on their common domain, or `[0, 1]` if theirs differ), `v` in
/// `[0, 1]` from the first to the second. Both curves are met exactly; along each line the speed is
/// constant if the weights of its two ends are equal. The method is degree elevation and merging of
/// knots (Piegl & Tiller 1997, 8.4). One of the two curves may run back over itself, as the pressed
/// end of a tube does.
///
/// # Errors
/// When the curves are the same; when one is the other, moved along a direction as seen in which it
/// runs back over itself (as in [`extrude`]); when they have knots too close together; or when both
/// run back over themselves.
pub fn ruled(from: &NurbsCurve, to: &NurbsCurve) -> Result<NurbsSurface, ConstructError> {
    let which = |index| if index == 0 { "curve `from`" } else { "curve `to`" }.to_owned();
    check_fold(from, &which(0)).or_else(|error| check_fold(to, &which(1)).map_err(|_| error))?;
    let both = compatible(&[from.clone(), to.clone()], &which)?;
    check_between(&both[0], &both[1])?;
    let pairs = both[0].control().iter().zip(both[1].control());
    let net = pairs.flat_map(|(a, b)| [*a, *b]).collect();
    Ok(NurbsSurface::from_homogeneous(both[0].knots().clone(), unit_knots(1), net)?)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::geometry::shapes::UnitArc;
    use crate::geometry::{KnotVector, shapes};

    fn arc(from: f64, turn: f64, radius: f64, z: f64) -> NurbsCurve {
        let arc = UnitArc::new(from, turn);
        let point =
            |&(x, y, w): &(f64, f64, f64)| (w * DVec3::new(radius * x, radius * y, z)).extend(w);
        let control = arc.points.iter().map(point).collect();
        NurbsCurve::from_homogeneous(arc.knots, control).unwrap()
    }

    #[test]
    fn a_circle_extruded_is_a_cylinder() {
        for size in [1e-8, 1.0, 1e8] {
            let side = extrude(&arc(0.0, 360.0, 2.0 * size, 0.0), 3.0 * size * DVec3::Z).unwrap();
            let same = shapes::cylinder(2.0 * size, 3.0 * size).unwrap();
            for (a, b) in side.control().iter().zip(same.control()) {
                assert!(a.distance(*b) <= 1e-15 * size, "{a} {b}");
            }
            assert!(
                side.normal(DVec2::new(0.1, 0.5)).unwrap().dot(side.point_at(DVec2::new(0.1, 0.0)))
                    > 0.0
            );
        }
        let profile = arc(0.0, 90.0, 1.0, 0.0);
        assert_eq!(
            extrude(&profile, DVec3::ZERO).unwrap_err().to_string(),
            "extrusion by (0, 0, 0): it must be finite and not zero"
        );
    }

    #[test]
    fn circles_apart_are_joined_by_a_cone_and_turned_ones_by_a_hyperboloid() {
        let frustum = ruled(&arc(0.0, 360.0, 2.0, 0.0), &arc(0.0, 360.0, 1.0, 4.0)).unwrap();
        let turned = ruled(&arc(0.0, 360.0, 2.0, -1.0), &arc(90.0, 360.0, 2.0, 1.0)).unwrap();
        for (i, j) in (0..=20).flat_map(|i| (0..=20).map(move |j| (i, j))) {
            let (u, v) = (f64::from(i) / 20.0, f64::from(j) / 20.0);
            let p = frustum.point_at(DVec2::new(u, v));
            let off = p.truncate().length() - (2.0 - p.z / 4.0);
            assert!(off.abs() < 2e-15 && (p.z - 4.0 * v).abs() < 4e-15, "({u}, {v}): {p}");
            // Chords of a quarter turn: x² + y² = 2 (1 + z²).
            let p = turned.point_at(DVec2::new(u, v));
            let off = p.truncate().length_squared() - 2.0 * (1.0 + p.z * p.z);
            assert!(off.abs() < 1e-14, "({u}, {v}): {off:e}");
        }
    }

    #[test]
    fn unlike_curves_are_both_met() {
        let knots = KnotVector::standard(3, 6).unwrap();
        let points = (0..6).map(|k| DVec3::new(f64::from(k), f64::from(k % 3), 5.0)).collect();
        let cubic = NurbsCurve::new(knots, points, None).unwrap();
        let half = arc(180.0, -180.0, 3.0, 0.0);
        let surface = ruled(&half, &cubic).unwrap();
        assert_eq!((surface.knots_u().degree(), surface.knots_v().degree()), (3, 1));
        let [a, b] = cubic.domain();
        for k in 0..=50 {
            let s = f64::from(k) / 50.0;
            assert!(surface.point_at(DVec2::new(s, 0.0)).distance(half.point_at(s)) < 5e-15);
            let to = cubic.point_at(a + s * (b - a));
            assert!(surface.point_at(DVec2::new(s, 1.0)).distance(to) < 5e-15);
            // The rulings are straight.
            let chord = to - half.point_at(s);
            let off =
                (surface.point_at(DVec2::new(s, 0.3)) - half.point_at(s)).cross(chord).length();
            assert!(off < 1e-14 * chord.length_squared());
        }
    }

    #[test]
    fn a_curve_and_itself_make_no_surface_only_where_they_are_a_point() {
        let line = NurbsCurve::polyline(&[DVec3::ZERO, DVec3::X]).unwrap();
        let point = NurbsCurve::bezier(&[DVec3::ONE, DVec3::ONE]).unwrap();
        assert!(ruled(&line, &point).is_ok(), "a triangle");
        assert_eq!(
            ruled(&point, &point).unwrap_err().to_string(),
            "curves `from` and `to` are the same to within rounding: nothing lies between them"
        );
    }
}
