//! Profiles cut where they meet the axis that they are turned about.
//!
//! A surface of revolution has a singular point wherever its profile meets the axis. Inside a
//! patch, rays near that point keep the solver busy, and their hits are never certain; on a side
//! that is collapsed to a point it is a pole like any other.

use glam::{DVec3, DVec4};

use super::Axis;
use super::ConstructError;
use crate::geometry::NurbsCurve;
use crate::geometry::curve::{add_extremes, add_sign_changes};
use crate::math::rounding::UNIT_ROUNDOFF;
use crate::math::unit;

/// The distance from the axis up to which a point of a curve counts as on it, in rounding errors of
/// the largest coordinate per control point of a piece: the point is a sum of that many products,
/// with half a dozen operations each.
const ROUNDINGS: f64 = 8.0;

/// The same curve with knots inserted where it meets the axis inside its domain, so many that these
/// places become control points; these are put exactly on the axis, from which only rounding had
/// moved them.
///
/// Where a whole piece lies on the axis, its ends are such places.
///
/// # Errors
/// When the curve with these knots is not valid.
pub(super) fn cut_at_axis(profile: &NurbsCurve, axis: &Axis) -> Result<NurbsCurve, ConstructError> {
    let mut cut = profile.clone();
    let tolerance = Tolerance::new(profile, axis);
    for t in meetings(profile, axis, &tolerance) {
        let degree = profile.knots().degree();
        let missing = degree.saturating_sub(cut.knots().multiplicity(t));
        if missing == 0 {
            continue; // a control point already, as its author has it
        }
        let of_profile = || ConstructError::of("profile");
        let whole = cut.insert_knot(t, missing).map_err(of_profile())?;
        let index = whole.knots().span_index(t) - degree;
        let (point, weight) = (whole.vertex(index), whole.control()[index].w);
        let away = axis.across(point);
        if away.length() <= tolerance.at(t) {
            let mut control: Vec<DVec4> = whole.control().to_vec();
            control[index] = (weight * axis.nearest(point)).extend(weight);
            let knots = whole.knots().clone();
            cut = NurbsCurve::from_homogeneous(knots, control).map_err(of_profile())?;
        }
    }
    Ok(cut)
}

/// The distance from the axis up to which a curve counts as meeting it at a parameter: the rounding
/// error of its coordinates, plus the distance that the curve runs while the parameter stays the
/// same number.
struct Tolerance<'a> {
    profile: &'a NurbsCurve,
    /// The rounding error.
    rounding: f64,
    /// The distance between two numbers in the domain.
    step: f64,
}

impl<'a> Tolerance<'a> {
    fn new(profile: &'a NurbsCurve, axis: &Axis) -> Self {
        let magnitude = profile.magnitude().max(axis.magnitude());
        let count = (profile.knots().degree() + 1) as f64;
        let [start, end] = profile.domain();
        let step = f64::EPSILON * start.abs().max(end.abs());
        Self { profile, rounding: ROUNDINGS * count * f64::EPSILON * magnitude, step }
    }

    fn at(&self, t: f64) -> f64 {
        self.rounding + self.step * self.profile.derivatives(t).first.length()
    }
}

/// The parameters within the domain where a curve meets the axis, in order.
fn meetings(profile: &NurbsCurve, axis: &Axis, tolerance: &Tolerance<'_>) -> Vec<f64> {
    let knots: Vec<f64> = profile.knots().spans().skip(1).map(|span| span.start).collect();
    let mut found = knots.clone();
    for piece in profile.bezier_pieces() {
        found.extend(candidates(&piece, axis));
    }
    let distance = |t: f64| axis.across(profile.point_at(t)).length();
    let on_axis = |t: f64| distance(t) <= tolerance.at(t); // false for NaN
    found.retain(|&t| on_axis(t));
    found.sort_by(f64::total_cmp);
    found.dedup();

    // One place may have been found several times, at slightly different parameters: then
    // everything between these is on the axis, too. Of these parameters a knot of the curve is the
    // best.
    let mut meetings: Vec<f64> = Vec::new();
    for t in found {
        let Some(last) = meetings.last_mut() else {
            meetings.push(t);
            continue;
        };
        let is_knot = [*last, t].map(|t| knots.binary_search_by(|knot| knot.total_cmp(&t)).is_ok());
        if is_knot == [true, true] || !on_axis(0.5 * (*last + t)) {
            meetings.push(t);
        } else if is_knot[1] || (!is_knot[0] && distance(t) < distance(*last)) {
            *last = t;
        }
    }
    meetings
}

/// The parameters within a Bézier piece where it may meet the axis.
///
/// The vector from the axis has two coordinates. Where both vanish, one changes its sign or touches
/// zero at an extreme: whatever the order of the zero, one of these two events is located so
/// accurately that the coordinate itself vanishes up to rounding.
fn candidates(piece: &NurbsCurve, axis: &Axis) -> Vec<f64> {
    let count = piece.control().len();
    let away = |index: usize| axis.across(piece.vertex(index));
    let farthest = (0..count)
        .map(away)
        .fold(DVec3::ZERO, |a, b| if b.length_squared() > a.length_squared() { b } else { a });
    let Some(first) = unit(farthest) else { return Vec::new() };
    let weights: Vec<f64> = (0..count).map(|index| piece.control()[index].w).collect();
    let magnitude = piece.magnitude().max(axis.magnitude());
    let noise: Vec<f64> =
        weights.iter().map(|weight| ROUNDINGS * UNIT_ROUNDOFF * magnitude * weight).collect();
    let mut shares = Vec::new();
    for direction in [first, axis.direction().cross(first)] {
        let coordinate: Vec<f64> =
            (0..count).map(|index| weights[index] * away(index).dot(direction)).collect();
        add_extremes(&coordinate, &weights, 0.0, &mut shares);
        add_sign_changes(coordinate, noise.clone(), &mut shares);
    }
    let [start, end] = piece.domain();
    let within = |&t: &f64| start < t && t < end;
    shares.into_iter().map(|share| start + share * (end - start)).filter(within).collect()
}

#[cfg(test)]
mod tests {
    use super::super::revolve;
    use super::*;
    use crate::geometry::shapes::circle_arc;
    use crate::geometry::{KnotVector, NurbsSurface};
    use glam::{DAffine3, DMat3, DQuat, DVec2};

    fn bezier(points: &[[f64; 3]], weights: Option<&[f64]>) -> NurbsCurve {
        let knots = KnotVector::bezier(points.len() - 1).unwrap();
        let points = points.iter().copied().map(DVec3::from).collect();
        NurbsCurve::new(knots, points, weights.map(<[f64]>::to_vec)).unwrap()
    }

    /// Profiles, and how many times each meets the z axis within its domain: lines and curves that
    /// cross and touch it, at a knot, with a triple zero, from several sides.
    fn profiles() -> Vec<(&'static str, NurbsCurve, usize)> {
        let double_cone = bezier(&[[-1.0, 0.0, 0.0], [1.0, 0.0, 1.0]], None);
        let uneven = bezier(&[[-1.0, 0.0, 0.0], [0.7, 0.0, 1.0]], Some(&[1.0, 3.0]));
        let touches = bezier(&[[1.0, 0.0, 0.0], [-1.0, 0.0, 0.5], [1.0, 0.0, 1.0]], None);
        let weighted =
            bezier(&[[1.0, 2.0, 0.0], [-0.5, -1.0, 0.5], [1.0, 2.0, 1.0]], Some(&[1.0, 2.0, 1.0]));
        let third = 1.0 / 3.0;
        let triple = bezier(
            &[[-1.0, 0.0, 0.0], [1.0, 0.0, third], [-1.0, 0.0, 2.0 * third], [1.0, 0.0, 1.0]],
            None,
        );
        let twice =
            bezier(&[[-1.0, 0.0, 0.0], [2.0, 0.3, 0.5], [-2.0, -0.3, 1.0], [1.0, 0.0, 1.5]], None);
        let points = [[-2.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [1.0, 2.0], [2.0, 2.5]];
        let points = points.map(|[x, z]| DVec3::new(x, 0.0, z)).to_vec();
        let smooth = KnotVector::clamped_uniform(2, 5).unwrap();
        let at_a_corner = KnotVector::clamped_uniform(1, 5).unwrap();
        let spline = NurbsCurve::new(smooth, points.clone(), None).unwrap();
        let polygon = NurbsCurve::new(at_a_corner, points, None).unwrap();
        let upright = DAffine3::from_mat3(DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y));
        let aside = DAffine3::from_translation(DVec3::new(-0.5, 0.0, 0.0));
        let arc = circle_arc(1.0, 10.0, 110.0).unwrap().transformed(&(aside * upright)).unwrap();
        let apart = bezier(&[[-1.0, 1e-9, 0.0], [1.0, 1e-9, 1.0]], None);
        vec![
            ("double cone", double_cone, 1),
            ("double cone at uneven speed", uneven, 1),
            ("a parabola that touches", touches, 1),
            ("a hyperbola that touches", weighted, 1),
            ("a triple zero", triple, 1),
            ("a cubic", twice, 1),
            ("a spline", spline, 1),
            ("a corner that is there", polygon, 0),
            ("an arc", arc, 1),
            ("close by", apart, 0),
        ]
    }

    /// The surface is the same, and each place on the axis is a row of equal control points.
    #[test]
    fn places_on_the_axis_become_collapsed_rows() {
        let turn = DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
        let slanted = |size| {
            let at = DVec3::new(0.3, -0.2, 0.1) * size;
            DAffine3::from_scale_rotation_translation(DVec3::splat(size), turn, at)
        };
        for place in [DAffine3::IDENTITY, slanted(1.0), slanted(1e-8), slanted(1e8)] {
            let at = place.transform_point3(DVec3::ZERO);
            let axis = Axis::new(at, place.transform_vector3(DVec3::Z)).unwrap();
            for (name, profile, count) in profiles() {
                let profile = profile.transformed(&place).unwrap();
                // Other parameters, with other rounding errors.
                for profile in [profile.clone(), profile.on_domain(100.3, 107.0).unwrap()] {
                    check(name, &profile, &axis, count);
                }
            }
        }
    }

    fn check(name: &str, profile: &NurbsCurve, axis: &Axis, count: usize) {
        let surface = revolve(profile, axis, 360.0).unwrap();
        let knots = surface.knots_v();
        let degree = knots.degree();
        let collapsed = |t: &f64| {
            let row = knots.span_index(*t) - degree;
            let first = surface.vertex(0, row);
            // The same homogeneous point except for the weights around, division by which rounds.
            let one = 2.0 * f64::EPSILON * first.abs().max_element();
            let mut around = 1..surface.size()[0];
            knots.multiplicity(*t) == degree
                && around.all(|i| surface.vertex(i, row).distance(first) <= one)
        };
        let inner: Vec<f64> = knots.spans().skip(1).map(|span| span.start).collect();
        let collapsed = inner.iter().filter(|t| collapsed(t)).count();
        let authored = usize::from(name == "a corner that is there");
        assert_eq!(collapsed, count + authored, "{name}: {inner:?}");
        if count == 0 {
            assert_eq!(surface.knots_v(), profile.knots(), "{name}");
        }
        same_points(name, &surface, profile, axis);
    }

    fn same_points(name: &str, surface: &NurbsSurface, profile: &NurbsCurve, axis: &Axis) {
        let [start, end] = profile.domain();
        for k in 0..=40 {
            let t = start + (end - start) * f64::from(k) / 40.0;
            let off = surface.point_at(DVec2::new(0.0, t)).distance(profile.point_at(t));
            assert!(off <= 2.0 * Tolerance::new(profile, axis).at(t), "{name}, {t}: {off:e}");
        }
    }
}
