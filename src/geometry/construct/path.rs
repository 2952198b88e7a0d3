//! Properties of curves as paths: smooth parts, and whether they are straight, round or closed.

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::ConstructError;
use crate::geometry::NurbsCurve;
use crate::geometry::curve::SAME_PLACE;
use crate::math::unit;

/// Directions that differ by less than this angle, in radians, are the same: a million times the
/// effect of rounding on the tangents of usual curves, and too little to see.
pub(crate) const SAME_DIRECTION: f64 = 1e-9;

/// Where the direction of a path jumps by less than this angle, in radians, the path is smooth:
/// 0.02 seconds of arc. Two knots that differ by h instead of being one make the direction turn by
/// about h times the jump in curvature, and cannot be told from one where h is below 1e-8 or so.
pub(crate) const SMOOTH: f64 = 1e-7;

/// The direction of a clamped curve at `t`. Where the curve stands still at an end, for example at
/// repeated control points, it is the limit from inside: towards the nearest control point that
/// differs.
///
/// # Errors
/// When the curve stands still inside its domain, or everywhere.
pub(crate) fn direction(curve: &NurbsCurve, t: f64) -> Result<DVec3, ConstructError> {
    let [start, end] = curve.domain();
    let found = if t <= start {
        first_leg(curve).and_then(unit)
    } else if t >= end {
        last_leg(curve).and_then(unit)
    } else {
        unit(curve.derivatives(t).first)
    };
    found.ok_or_else(|| ConstructError::StandsStill { path: "path", t, point: curve.point_at(t) })
}

/// The vector from the start of a clamped curve to the nearest control point that differs.
fn first_leg(curve: &NurbsCurve) -> Option<DVec3> {
    leg(curve, 0, 1..curve.control().len())
}

/// The vector to the end of a clamped curve from the nearest control point that differs.
fn last_leg(curve: &NurbsCurve) -> Option<DVec3> {
    let last = curve.control().len() - 1;
    leg(curve, last, (0..last).rev()).map(|back| -back)
}

fn leg(curve: &NurbsCurve, from: usize, mut others: impl Iterator<Item = usize>) -> Option<DVec3> {
    let near = SAME_PLACE * curve.magnitude();
    others.find_map(|index| {
        let away = curve.vertex(index) - curve.vertex(from);
        (away.length() > near).then_some(away)
    })
}

/// The angle between two unit vectors in radians, accurate for small angles too.
pub(crate) fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// A place where the direction of a path jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kink {
    pub(crate) t: f64,
    /// The angle of the jump, in degrees.
    pub(crate) degrees: f64,
}

/// The places within a path where its direction jumps. A jump that rounding of the control points
/// can explain, where a piece is very short, is none: the direction there is known to their
/// rounding error over the length of the piece's first or last leg.
///
/// # Errors
/// When the path has a gap, or stands still at a knot.
pub(crate) fn kinks(curve: &NurbsCurve) -> Result<Vec<Kink>, ConstructError> {
    let same_place = SAME_PLACE * curve.magnitude();
    let pieces = curve.bezier_pieces();
    let mut found = Vec::new();
    for pair in pieces.windows(2) {
        let t = pair[1].domain()[0];
        let point = pair[0].point_at(t);
        let gap = point.distance(pair[1].point_at(t));
        if gap > same_place {
            return Err(ConstructError::Gap { path: "path", t, point, gap });
        }
        let angle = angle(direction(&pair[0], t)?, direction(&pair[1], t)?);
        let legs = [last_leg(&pair[0]), first_leg(&pair[1])].into_iter().flatten();
        let doubt: f64 = legs.map(|leg| same_place / leg.length()).sum();
        if angle > SMOOTH + doubt {
            found.push(Kink { t, degrees: angle.to_degrees() });
        }
    }
    Ok(found)
}

/// The parts of a curve between its kinks.
///
/// # Errors
/// As [`kinks`].
pub(crate) fn smooth_parts(curve: &NurbsCurve) -> Result<Vec<NurbsCurve>, ConstructError> {
    let [start, end] = curve.domain();
    let mut cuts = vec![start];
    cuts.extend(kinks(curve)?.iter().map(|kink| kink.t));
    cuts.push(end);
    let form = curve.bezier_form();
    Ok(cuts.windows(2).map(|pair| form.restricted([pair[0], pair[1]])).collect())
}

/// Whether a clamped curve runs straight on: its control points lie on one line, in order.
pub(crate) fn is_straight(curve: &NurbsCurve) -> bool {
    let [a, b] = curve.ends();
    let Some(along) = unit(b - a) else { return false };
    let slack = SAME_PLACE * curve.magnitude();
    let mut reached = 0.0;
    (0..curve.control().len()).all(|index| {
        let from = curve.vertex(index) - a;
        let length = from.dot(along);
        let on_the_line = (from - length * along).length() <= slack && length >= reached - slack;
        reached = length.max(reached);
        on_the_line
    })
}

/// A circle, and a path on it in the coordinates of the unit circle.
#[derive(Clone, Debug)]
pub(crate) struct OnCircle {
    pub(crate) center: DVec3,
    /// The unit vector from the centre to the start of the path.
    pub(crate) across: DVec3,
    /// The unit vector along the path at its start.
    pub(crate) ahead: DVec3,
    pub(crate) radius: f64,
    /// The path's control points `(x, y, w)` in these coordinates, in which the radius is 1.
    pub(crate) points: Vec<(f64, f64, f64)>,
}

/// The distance from the unit circle up to which a path counts as lying on it.
const ROUND: f64 = 64.0 * f64::EPSILON;

impl OnCircle {
    /// The circle on which a smooth, clamped path lies, if there is one.
    ///
    /// The circle of curvature at the start is the only candidate. The path of degree `p` lies on
    /// it if a polynomial of degree `2p` vanishes on each piece, which `2p + 1` samples decide, up
    /// to rounding; one more is taken.
    pub(crate) fn of(curve: &NurbsCurve) -> Option<Self> {
        let [start, _] = curve.domain();
        let at = curve.derivatives(start);
        let speed = at.first.length();
        let ahead = unit(at.first)?;
        let bend = (at.second - at.second.dot(ahead) * ahead) / (speed * speed);
        let radius = 1.0 / bend.length();
        // Larger circles cannot be told from straight lines.
        let usable = radius.is_finite() && radius * ROUND < curve.magnitude();
        if !usable {
            return None;
        }
        let across = -unit(bend)?;
        let center = at.point - radius * across;
        let axis = across.cross(ahead);
        let local = |point: DVec3| {
            let from = (point - center) / radius;
            DVec3::new(from.dot(across), from.dot(ahead), from.dot(axis))
        };
        let slack = ROUND * (1.0 + curve.magnitude() / radius);
        let samples = 2 * curve.knots().degree() + 1;
        let round = curve.knots().spans().all(|span| {
            (0..=samples).all(|k| {
                let t = span.start + (span.end - span.start) * k as f64 / samples as f64;
                let point = local(curve.point_at(t));
                (point.truncate().length() - 1.0).abs() <= slack && point.z.abs() <= slack
            })
        });
        let plane = |point: &DVec4| {
            let at = local(point.xyz() / point.w);
            (at.x, at.y, point.w)
        };
        let points = curve.control().iter().map(plane).collect();
        round.then_some(Self { center, across, ahead, radius, points })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes::{circle_arc, circle_cubic};
    use glam::{DAffine3, DQuat};

    #[test]
    fn circles_are_known_wherever_they_are() {
        for size in [1e-8, 1.0, 1e8] {
            let place = DAffine3::from_scale_rotation_translation(
                DVec3::splat(size),
                DQuat::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7),
                DVec3::new(3.0, -2.0, 1.0) * size,
            );
            let arcs = [circle_arc(2.0, 10.0, 250.0).unwrap(), circle_cubic()];
            for (arc, radius) in arcs.iter().zip([2.0, 1.0]) {
                let circle = OnCircle::of(&arc.transformed(&place).unwrap()).unwrap();
                assert!((circle.radius / size - radius).abs() < 1e-14);
                let center = place.transform_point3(DVec3::ZERO);
                assert!(circle.center.distance(center) < 1e-14 * size);
            }
            let parabola = [DVec3::ZERO, DVec3::X, DVec3::ONE];
            let parabola = NurbsCurve::bezier(&parabola).unwrap().transformed(&place).unwrap();
            assert!(OnCircle::of(&parabola).is_none() && !is_straight(&parabola));
        }
    }

    #[test]
    fn kinks_and_straight_parts_of_a_polygon() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [3.0, 0.0], [3.0, 2.0], [0.0, 0.0]];
        let corners = corners.map(|[x, y]| DVec3::new(x, y, 0.0));
        let polygon = NurbsCurve::polyline(&corners).unwrap();
        let found = kinks(&polygon).unwrap();
        let (places, turns): (Vec<f64>, Vec<f64>) = found.iter().map(|k| (k.t, k.degrees)).unzip();
        assert_eq!(places, [3.0, 5.0]);
        assert!((turns[0] - 90.0).abs() < 1e-12);
        let parts = smooth_parts(&polygon).unwrap();
        assert_eq!(parts.len(), 3);
        assert!(parts.iter().all(is_straight) && polygon.is_closed() && !parts[0].is_closed());
        let back = NurbsCurve::bezier(&[DVec3::ZERO, DVec3::X * 3.0, DVec3::X]).unwrap();
        assert!(!is_straight(&back), "it turns round on its line");
    }
}
