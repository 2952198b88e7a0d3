//! The parts of tubes: cylinders, swept parts, balls, caps.

use glam::{DAffine3, DMat3, DVec3};

use super::fold::check_fold;
use super::path::{SAME_DIRECTION, angle, direction, is_straight, smooth_parts};
use super::ruled::extrude;
use super::stops::without_stops;
use super::{
    Axis, Caps, Component, ComponentKind, ConstructError, Sweep, SweepOptions, TubeStyle, revolve,
    sweep,
};
use crate::geometry::NurbsCurve;
use crate::geometry::shapes::{circle_arc, sphere_biquadratic};
use crate::math::unit;

/// The parts of a tube around a curve.
pub(super) struct Parts {
    /// The circle that is carried along the curve.
    pub(super) profile: NurbsCurve,
    /// The curve's smooth parts.
    pub(super) smooth: Vec<SmoothPart>,
    /// The points where the smooth parts meet at an angle.
    pub(super) joints: Vec<DVec3>,
    /// Where the tube ends, and in which directions.
    pub(super) ends: Vec<(DVec3, DVec3)>,
}

pub(super) struct SmoothPart {
    pub(super) curve: NurbsCurve,
    /// Its ends, if it is straight.
    pub(super) straight: Option<[DVec3; 2]>,
}

/// Takes a curve apart at its corners.
///
/// # Errors
/// As [`tube`](super::tube()), except for curves that bend too much.
pub(super) fn parts(curve: &NurbsCurve, radius: f64) -> Result<Parts, ConstructError> {
    let profile = circle_arc(radius, 0.0, 360.0).map_err(ConstructError::of("tube"))?;
    check_fold(curve, "curve")?;
    let curve = &without_stops(curve)?;
    let smooth = smooth_parts(curve)?;
    let mut joints: Vec<DVec3> = smooth[1..].iter().map(|part| part.ends()[0]).collect();
    let mut ends = Vec::new();
    let (first, last) = (&smooth[0], &smooth[smooth.len() - 1]);
    let (start, end) = (first.ends()[0], last.ends()[1]);
    let backwards = -direction(first, first.domain()[0])?;
    let forwards = direction(last, last.domain()[1])?;
    if !curve.is_closed() {
        ends.extend([(start, backwards), (end, forwards)]);
    } else if angle(-backwards, forwards) > SAME_DIRECTION {
        joints.push(start);
    }
    let told = |curve: NurbsCurve| {
        let straight = is_straight(&curve).then(|| curve.ends());
        SmoothPart { curve, straight }
    };
    Ok(Parts { profile, smooth: smooth.into_iter().map(told).collect(), joints, ends })
}

/// The open tube around a straight line: a cylinder is the extrusion of its circle, however the
/// parameter of the line runs.
pub(super) fn cylinder([a, b]: [DVec3; 2], radius: f64) -> Result<Component, ConstructError> {
    let around = || ConstructError::of("tube");
    let still = ConstructError::StandsStill { path: "curve", t: 0.0, point: a };
    let along = unit(b - a).ok_or(still)?;
    let circle = circle_arc(radius, 0.0, 360.0).map_err(around())?;
    let placed = circle.transformed(&frame_at(a, along)).map_err(around())?;
    Ok(Component::exact(ComponentKind::Tube, extrude(&placed, b - a)?))
}

/// The open tube around a smooth part.
pub(super) fn round_part(
    profile: &NurbsCurve,
    part: &NurbsCurve,
    style: &TubeStyle,
) -> Result<Component, ConstructError> {
    let options = SweepOptions { tolerance: style.tolerance, ..SweepOptions::default() };
    let Sweep { surface, deviation } = sweep(profile, part, &options)?;
    Ok(Component { kind: ComponentKind::Tube, surface, deviation })
}

/// The rigid map that takes the origin to a point and z to a direction.
fn frame_at(origin: DVec3, z: DVec3) -> DAffine3 {
    // This is exact along the coordinate axes, too.
    let helper = if z.z.abs() > 0.9 { DVec3::Y } else { DVec3::Z };
    let x = helper.cross(z).normalize();
    DAffine3::from_mat3_translation(DMat3::from_cols(x, z.cross(x), z), origin)
}

/// The sphere of this radius around a point.
///
/// # Errors
/// When the radius is not a positive length, or the point not finite.
pub(crate) fn ball(center: DVec3, radius: f64) -> Result<Component, ConstructError> {
    let sphere = sphere_biquadratic(radius)
        .map_err(|_| ConstructError::JointRadius { radius })?
        .transformed(&DAffine3::from_translation(center))?;
    Ok(Component::exact(ComponentKind::Joint, sphere))
}

/// The surface that closes a tube ending at a point in this direction, if any.
pub(super) fn cap(
    at: DVec3,
    outward: DVec3,
    style: &TubeStyle,
) -> Result<Option<Component>, ConstructError> {
    let radius = style.radius;
    let of_cap = ConstructError::of("cap");
    let profile = match style.caps {
        Caps::Open => return Ok(None),
        Caps::Flat => NurbsCurve::polyline(&[DVec3::X * radius, DVec3::ZERO]).map_err(of_cap)?,
        Caps::Round => circle_arc(radius, 0.0, 90.0)
            .and_then(|arc| arc.transformed(&DAffine3::from_mat3(UPRIGHT)))
            .map_err(of_cap)?,
    };
    let surface = revolve(&profile, &Axis::Z, 360.0)?.transformed(&frame_at(at, outward))?;
    Ok(Some(Component::exact(ComponentKind::Cap, surface)))
}

/// Maps the plane of x and y to that of x and z.
const UPRIGHT: DMat3 = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
