//! Sweeps: a profile carried along a path.

use glam::{DVec3, DVec4};

use super::compatible::compatible;
use super::fold::{check_fold, check_moved};
use super::frames::Frame;
use super::moving::{MovingFrames, approximate, sampled};
use super::net_size::net_size;
use super::path::{OnCircle, is_straight, kinks};
use super::stops::without_stops;
use super::{ConstructError, MAX_SCALES, Sweep, SweepOptions};
use crate::geometry::curve::SAME_PLACE;
use crate::geometry::knots::unit_knots;
use crate::geometry::shapes::{Turned, turned_net};
use crate::geometry::{NurbsCurve, NurbsSurface};

/// The default tolerance as a fraction of [`sweep_size`]: far below what is visible.
const TOLERANCE: f64 = 1e-6;

/// The default tolerance as a fraction of the profile's size: the radius of a thin tube along a
/// long path must be accurate, too.
const OF_PROFILE: f64 = 1e-3;

/// The smallest default tolerance, as a fraction of [`sweep_size`] or of the path's largest
/// coordinate: rounding does not allow less.
const FINEST_TOLERANCE: f64 = 1e-11;

/// The surface that a profile passes over when it is carried along a path by a frame that
/// does not turn about the path.
///
/// The profile lies in its own plane of x and y, around the origin, z along the path (it may
/// leave the plane). At the start of the path its y axis points to `up`; from there the
/// rotation-minimising frame carries it. Where the profile runs counterclockwise, the
/// surface faces outward. On a smooth closed path the frame would come back turned; this turn is
/// spread over the path (evenly in its parameter), so that the sweep closes.
///
/// The surface is an exact rational one for straight paths without twist (a scale that varies needs
/// a polynomial path), and for circles and arcs, of any degree, without twist and with constant
/// scale. All other sweeps are approximated: the frame's coordinates by cubic pieces that
/// interpolate its derivatives, halved until the distance to the true sweep is within the
/// tolerance.
///
/// # Errors
/// When the profile or the path runs back over itself; when the path has a kink, a gap or a cusp,
/// or stands still everywhere (a path that only pauses is accepted); when the sweep folds, because
/// a profile that leaves its plane passes over itself along a straight path, or because the profile
/// reaches beyond the centre of curvature where the path bends; when the scale is negative, zero
/// everywhere, or has too many coefficients; when the tolerance cannot be held.
pub fn sweep(
    profile: &NurbsCurve,
    path: &NurbsCurve,
    options: &SweepOptions,
) -> Result<Sweep, ConstructError> {
    check_options(options)?;
    check_fold(profile, "profile")?;
    check_fold(path, "path")?;
    let path = without_stops(path)?.clamped();
    if let Some(kink) = kinks(&path)?.first() {
        let (t, degrees, point) = (kink.t, kink.degrees, path.point_at(kink.t));
        return Err(ConstructError::Kink { path: "path", t, point, degrees });
    }
    let first = Frame::first(&path, options.up)?;
    let constant = options.scale.iter().all(|&factor| factor == options.scale[0]);
    if options.twist == 0.0 {
        if is_straight(&path) && constant {
            check_moved(profile, DVec3::Z, "profile")?;
        }
        if is_straight(&path) && (constant || !path.is_rational()) {
            return exact(along_a_line(profile, &path, &first, &options.scale)?);
        }
        if let (true, Some(circle)) = (constant, OnCircle::of(&path)) {
            return exact(along_a_circle(profile, &path, &first, (&circle, options.scale[0]))?);
        }
    }
    let frames = MovingFrames::new(&path, first, options)?;
    frames.check_folds(profile)?;
    let tolerance = options.tolerance.unwrap_or_else(|| default_tolerance(profile, &path, options));
    approximate(profile, &frames, tolerance)
}

fn default_tolerance(profile: &NurbsCurve, path: &NurbsCurve, options: &SweepOptions) -> f64 {
    let size = sweep_size(profile, path, options);
    let of_profile = OF_PROFILE * (size - extent(path));
    of_profile.max(FINEST_TOLERANCE * size.max(path.magnitude())).min(TOLERANCE * size)
}

/// The size to which default tolerances of sweeps, tubes and ribbons are relative: the diagonal of
/// the box around the path's control points, plus the largest distance of the profile's control
/// points from its origin times the largest scale.
///
/// No coordinate difference of the sweep is larger than twice that size. The profile of a tube, a
/// circle of radius r, reaches √2 r; that of a ribbon, half its width.
pub fn sweep_size(profile: &NurbsCurve, path: &NurbsCurve, options: &SweepOptions) -> f64 {
    extent(path) + reach(profile) * options.scale.iter().fold(0.0, |a: f64, &b| a.max(b))
}

fn exact(surface: NurbsSurface) -> Result<Sweep, ConstructError> {
    Ok(Sweep { surface, deviation: 0.0 })
}

fn check_options(options: &SweepOptions) -> Result<(), ConstructError> {
    let SweepOptions { twist, scale, tolerance, .. } = options;
    if let Some(index) = scale.iter().position(|&factor| !(factor >= 0.0 && factor.is_finite())) {
        return Err(ConstructError::Scale { index, factor: scale[index] });
    }
    if !scale.is_empty() && scale.iter().all(|&factor| factor == 0.0) {
        return Err(ConstructError::NoScale);
    }
    if !(1..=MAX_SCALES).contains(&scale.len()) {
        return Err(ConstructError::ScaleCount { found: scale.len(), most: MAX_SCALES });
    }
    if !twist.is_finite() {
        return Err(ConstructError::Twist { degrees: *twist });
    }
    match tolerance {
        Some(tolerance) if !(*tolerance > 0.0 && tolerance.is_finite()) => {
            Err(ConstructError::Tolerance { tolerance: *tolerance })
        }
        _ => Ok(()),
    }
}

/// The largest distance of a profile's control points from its origin.
pub(crate) fn reach(profile: &NurbsCurve) -> f64 {
    profile.points().map(|point| point.length()).fold(0.0, f64::max)
}

/// The diagonal of the bounding box of the control points.
fn extent(curve: &NurbsCurve) -> f64 {
    let points = curve.points();
    let (low, high) = points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), point| {
        (low.min(point), high.max(point))
    });
    low.distance(high)
}

/// The surface `S(u, v) = T(v) + σ(v) (x r + y s + z t)`, whose frame is constant.
///
/// With `T` and `σ` in the same spline space, each point of the net is that sum for a pair of
/// coefficients; where `σ` is constant, weights of the path multiply those of the profile.
fn along_a_line(
    profile: &NurbsCurve,
    path: &NurbsCurve,
    frame: &Frame,
    scale: &[f64],
) -> Result<NurbsSurface, ConstructError> {
    let constant = scale.iter().all(|&factor| factor == scale[0]);
    let factors = if constant { &scale[..1] } else { scale };
    let (path, factors) = match factors {
        [factor] => (path.clone(), vec![*factor; path.control().len()]),
        factors => {
            let graph = factors.iter().map(|&f| DVec4::new(f, 0.0, 0.0, 1.0)).collect();
            let [start, end] = path.domain();
            let graph = NurbsCurve::from_homogeneous(unit_knots(factors.len() - 1), graph)
                .and_then(|graph| graph.on_domain(start, end))
                .map_err(ConstructError::of("scale"))?;
            let both = compatible(&[path.clone(), graph], &|_| "path".to_owned())?;
            let factors = both[1].points().map(|point| point.x);
            (both[0].clone(), factors.collect())
        }
    };
    let mut net = Vec::with_capacity(net_size(profile.control().len(), factors.len())?);
    for i in 0..profile.control().len() {
        let p = profile.vertex(i);
        let offset = p.x * frame.normal + p.y * frame.side() + p.z * frame.tangent;
        for (j, factor) in factors.iter().enumerate() {
            let weight = profile.control()[i].w * path.control()[j].w;
            net.push((weight * (path.vertex(j) + *factor * offset)).extend(weight));
        }
    }
    let knots = path.knots().clone();
    Ok(NurbsSurface::from_homogeneous(profile.knots().clone(), knots, net)?)
}

/// The profile turned about the axis of the circle that the path lies on, at the path's own
/// speed.
fn along_a_circle(
    profile: &NurbsCurve,
    path: &NurbsCurve,
    frame: &Frame,
    (circle, factor): (&OnCircle, f64),
) -> Result<NurbsSurface, ConstructError> {
    let place = |p: DVec3| {
        let offset = p.x * frame.normal + p.y * frame.side() + p.z * frame.tangent;
        frame.origin + factor * offset - circle.center
    };
    let across = sampled(profile).into_iter().map(|point| place(point).dot(circle.across));
    let nearest = across.fold(f64::INFINITY, f64::min);
    let radius = circle.radius;
    if nearest <= SAME_PLACE * radius {
        let reach = radius - nearest;
        let (what, called, t) = ("sweep", "path", path.domain()[0]);
        let point = frame.origin;
        return Err(ConstructError::Fold { what, path: called, t, point, radius, reach });
    }
    net_size(profile.control().len(), circle.points.len())?;
    let axis = circle.across.cross(circle.ahead);
    let points: Vec<Turned> = (0..profile.control().len())
        .map(|i| {
            let from = place(profile.vertex(i));
            let along = from.dot(axis) * axis;
            let across = from - along;
            let (center, weight) = (circle.center + along, profile.control()[i].w);
            Turned { center, across, ahead: axis.cross(across), weight }
        })
        .collect();
    let net = turned_net(&circle.points, &points);
    let knots = [path.knots().clone(), profile.knots().clone()];
    let [around, along] = knots;
    Ok(NurbsSurface::from_homogeneous(around, along, net)?.swapped())
}
