//! Which curves fold, and which do so once they are turned or moved.

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::path::SAME_DIRECTION;
use super::{Axis, ConstructError};
use crate::geometry::NurbsCurve;
use crate::geometry::curve::{Course, Fold};
use crate::math::bernstein::binomial;
use crate::math::unit;

/// Fails if a curve runs back over itself.
pub(crate) fn check_fold(curve: &NurbsCurve, which: &str) -> Result<(), ConstructError> {
    match Course::in_space(curve).fold() {
        Some(fold) => Err(runs_back(curve, which, fold)),
        None => Ok(()),
    }
}

fn runs_back(curve: &NurbsCurve, which: &str, fold: Fold) -> ConstructError {
    let knots = curve.knots();
    // The corners of a polygon are its control points.
    let corner = || knots.values()[1..].iter().position(|&knot| knot == fold.t);
    let point = curve.point_at(fold.t);
    let length = point.distance(curve.point_at(fold.until));
    let corner = (knots.degree() == 1).then(corner).flatten();
    ConstructError::RunsBack { which: which.to_owned(), t: fold.t, corner, point, length }
}

/// Fails if a profile runs back over itself, or if turning it about an axis by this angle takes it
/// to where another part of it has been.
///
/// The latter is decided in the half plane of `(r², z)`, which are rational; `r` is the distance
/// from the axis and `z` the height. In that plane the profile folds where it crosses the axis and
/// goes on as its own mirror image. The two parts meet if the turn is at least the angle between
/// them. The profile also folds where it is nearest to the axis, or farthest from it, in a plane
/// across the axis. There the two parts begin together, and any turn takes some of the one over the
/// other. All folds are looked at, as one that is allowed says nothing of the next.
pub(crate) fn check_turned(
    profile: &NurbsCurve,
    axis: &Axis,
    degrees: f64,
) -> Result<(), ConstructError> {
    check_fold(profile, "profile")?;
    let course = turned(profile, axis);
    if course.is_point() {
        let distance = axis.across(profile.point_at(profile.domain()[0])).length();
        return Err(ConstructError::OneCircle { distance });
    }
    let reach = profile.points().map(|point| axis.across(point).length());
    let near = ON_AXIS * reach.fold(0.0, f64::max);
    for Fold { t, twice, .. } in course.folds() {
        let point = profile.point_at(t);
        // Off the axis the two parts begin at angle 0.
        if axis.across(point).length() > near {
            return Err(ConstructError::TurnsRound { t, point, twice });
        }
        let [before, after] = twice.map(|t| axis.across(profile.point_at(t)));
        let between = before.cross(after).length().atan2(before.dot(after));
        if degrees.abs().to_radians() > between + SAME_DIRECTION {
            let between = between.to_degrees();
            return Err(ConstructError::CoversItself { t, point, twice, degrees, between });
        }
    }
    Ok(())
}

/// The distance from the axis within which a fold counts as on it, relative to the profile's
/// largest distance: the squared distance is known to the rounding error of 1, and the place to the
/// root of that again.
const ON_AXIS: f64 = 1e-3;

/// Fails if a profile, moved along a vector, passes over places that another part of it has passed,
/// that is, if the profile folds as seen along the vector.
pub(crate) fn check_moved(
    profile: &NurbsCurve,
    by: DVec3,
    which: &str,
) -> Result<(), ConstructError> {
    let which = which.to_owned();
    let seen = seen_along(profile, by);
    if seen.is_point() {
        return Err(ConstructError::MovedAlongItself { which, by });
    }
    let Some(Fold { t, twice, .. }) = seen.fold() else { return Ok(()) };
    Err(ConstructError::FoldsFlat { which, by, t, point: profile.point_at(t), twice })
}

/// The projection of a curve along a vector onto a plane perpendicular to it.
fn seen_along(curve: &NurbsCurve, vector: DVec3) -> Course {
    let along = unit(vector).unwrap_or_default();
    let across = |c: &DVec4| (c.xyz() - c.xyz().dot(along) * along).extend(c.w);
    Course::mapped(curve, |piece| piece.control().iter().map(across).collect())
}

/// The profile as `(r² / R, z, 0)`, where `R` is its largest distance from the axis.
fn turned(profile: &NurbsCurve, axis: &Axis) -> Course {
    let points = || profile.points();
    let reach = points().map(|point| axis.across(point).length()).fold(0.0, f64::max);
    Course::mapped(profile, |piece| {
        let p = piece.knots().degree();
        let mut control = vec![DVec4::ZERO; 2 * p + 1];
        let point = |i: usize| {
            let point = piece.vertex(i);
            (axis.across(point), axis.height(point), piece.control()[i].w)
        };
        let points: Vec<(DVec3, f64, f64)> = (0..=p).map(point).collect();
        for (i, (a, z, w)) in points.iter().enumerate() {
            for (j, (b, _, v)) in points.iter().enumerate() {
                // B_i B_j of degree p is this much of B_{i+j} of degree 2p.
                let share = binomial(p, i) * binomial(p, j) / binomial(2 * p, i + j) * w * v;
                control[i + j] += share * DVec4::new(a.dot(*b) / reach, *z, 0.0, 1.0);
            }
        }
        control
    })
}
