//! Borders of surfaces: which roots lie inside them, and which lie on them, or near an edge of
//! trims, to within rounding.

use glam::{DVec2, DVec3};

use crate::geometry::RectSide;
use crate::math::RayFrame;
use crate::patch::{BORDER_REACH, Jet, Piece};

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

/// Returns the place itself if it is on the piece, else the point of the piece's border that is
/// nearest to the ray there.
///
/// The slack of a border is a distance in space: where the ray grazes, a root that rounding
/// has moved far outside in one parameter is near the border for another value of the
/// other parameter. Where the ray runs inside the surface, the end of the stretch may be
/// well outside, and the ray may cross the border far from there.
pub(crate) fn on_piece(piece: &Piece, ray: &RayFrame, st: DVec2) -> DVec2 {
    let nearest = st.clamp(DVec2::ZERO, DVec2::ONE);
    let residual = |st: DVec2| ray.distance(piece.patch.point(st));
    match [nearest.x != st.x, nearest.y != st.y] {
        [false, false] => nearest,
        [true, false] => along_border(piece, ray, nearest, DVec2::Y),
        [false, true] => along_border(piece, ray, nearest, DVec2::X),
        [true, true] => {
            // Beyond a corner the ray may cross either of its sides.
            let [a, b] = [DVec2::X, DVec2::Y].map(|free| along_border(piece, ray, nearest, free));
            if residual(b) < residual(a) { b } else { a }
        }
    }
}

/// The point of a border nearest to the ray, by least squares along the free direction, from a
/// place on the border. The search stops where the point is so near that rounding would affect the
/// next step. (Where the ray runs along the border to within rounding, every point is that near.)
fn along_border(piece: &Piece, ray: &RayFrame, start: DVec2, free: DVec2) -> DVec2 {
    // Gauss–Newton steps double the correct digits, but only near the end of a long way.
    let most_steps = 8;
    let near = AT_RAY * piece.patch.error_bound(ray.magnitude);
    let mut nearest = start;
    for _ in 0..most_steps {
        let jet = piece.patch.jet(nearest);
        let at = ray.coordinates(jet.point).truncate();
        if at.length() <= near {
            break;
        }
        let along = ray.across(free.x * jet.ds + free.y * jet.dt);
        let step = along.dot(at) / along.length_squared();
        if !step.is_finite() {
            break;
        }
        let next = (nearest - step * free).clamp(DVec2::ZERO, DVec2::ONE);
        if next == nearest {
            break;
        }
        nearest = next;
    }
    nearest
}

/// Points count as on the ray if they are within this part of the error bound of it.
const AT_RAY: f64 = 0.25;

/// A trim edge counts as near within this many times the error bound of a hit: the edge itself is
/// on a surface known to rounding, and the edge it is shared with is on another.
pub(crate) const TRIM_REACH: f64 = 4.0;

/// Two searches that are about equally exact find one root within twice the error: a root at a trim
/// edge by one search is within this many times the reach of the edge by the other.
pub(crate) const TRIM_SPARE: f64 = 2.0;

/// How near a trim edge must be, in each parameter, for a root with the error bound `error` in
/// space to be on it.
///
/// A step in `s` alone moves the point by `|S_s|`; among steps in `s` and `t` the part of `s` is
/// at most the distance over `|S_s| sin θ`, with `θ` the angle between the tangents. At a pole
/// one tangent vanishes, and its parameter may be anything.
pub(crate) fn trim_reach(jet: &Jet, error: f64) -> DVec2 {
    let lengths = DVec2::new(jet.ds.length(), jet.dt.length());
    let sine = jet.ds.cross(jet.dt).length() / (lengths.x * lengths.y);
    let sine = if sine > 0.0 { sine } else { 1.0 }; // also where it is not a number
    TRIM_REACH * error / (lengths * sine)
}

/// How far a root may be off in each parameter: by `across` in any direction, and by `along` in the
/// direction of the ray; at a pole, where that says nothing, by `along` in any direction.
pub(crate) fn root_reach(jet: &Jet, axis: DVec3, across: f64, along: f64) -> DVec2 {
    let step = step_towards(jet, axis).abs();
    if !step.is_finite() {
        return trim_reach(jet, along) / TRIM_REACH;
    }
    trim_reach(jet, across) / TRIM_REACH + along * step
}

/// The step in parameters that moves the point, to first order, by the part of a vector in the
/// tangent plane.
pub(super) fn step_towards(jet: &Jet, v: DVec3) -> DVec2 {
    let (ss, st, tt) = (jet.ds.length_squared(), jet.ds.dot(jet.dt), jet.dt.length_squared());
    let (s, t) = (jet.ds.dot(v), jet.dt.dot(v));
    DVec2::new(tt * s - st * t, ss * t - st * s) / (ss * tt - st * st)
}

/// Whether a point lies within rounding of a side that is a border of the surface.
pub(crate) fn at_border(piece: &Piece, st: DVec2, jet: &Jet, error: f64) -> bool {
    let distances = piece.side_distances(st, jet);
    let mut sides = RectSide::ALL.into_iter();
    sides.any(|side| piece.is_border(side) && distances[side] <= BORDER_REACH * error)
}
