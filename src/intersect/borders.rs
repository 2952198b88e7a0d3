//! Borders of surfaces and edges of trims: which roots are on this side of them, and which are at
//! them as far as rounding lets one know.

use glam::{DVec2, DVec3};

use super::exact::holds;
use super::grazing::KnownRoot;
use super::newton::project;
use crate::geometry::trim::Side;
use crate::math::RayFrame;
use crate::patch::{Jet, Leaf, Piece, WIDENING};

/// How far a computed point of the piece may be from the true one, for this ray.
pub(super) fn error_bound(piece: &Piece, ray: &RayFrame) -> f64 {
    piece.patch.error_bound(ray.magnitude)
}

/// The [`error_bound`] of a piece that is no larger than one of its points.
pub(super) fn rounding_at(point: DVec3, piece: &Piece, ray: &RayFrame) -> f64 {
    piece.patch.residual_factor() * point.abs().max_element().max(ray.magnitude)
}

/// The place itself if it is on the piece, else the point of the piece's border that is
/// nearest to the ray there.
///
/// The slack of a border is a distance in space: where the ray grazes, a root that rounding
/// has put outside by much in one parameter is near the border for another value of the
/// other parameter. Where the ray runs inside the surface, the end of the stretch may be
/// well outside, and the ray cross the border far from there.
pub(super) fn on_piece(piece: &Piece, ray: &RayFrame, st: DVec2) -> DVec2 {
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

/// The point of a border nearest to the ray, from a place on it: least squares along the
/// direction that is free, as long as the point is not so near that rounding would have a say in
/// where to go. (Where the ray runs along the border, to within rounding, every point of it is.)
fn along_border(piece: &Piece, ray: &RayFrame, start: DVec2, free: DVec2) -> DVec2 {
    // Gauss and Newton's steps double the digits, but only near the end of a long way.
    let most_steps = 8;
    let near = AT_RAY * error_bound(piece, ray);
    let mut nearest = start;
    for _ in 0..most_steps {
        let jet = piece.patch.jet(nearest);
        let at = ray.coordinates(jet.point).truncate();
        if at.length() <= near {
            break;
        }
        let along = project(ray, free.x * jet.ds + free.y * jet.dt);
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

/// Points are at the ray if they are this part of the error from it, or less.
const AT_RAY: f64 = 0.25;

/// How much farther than a hit may be off, as far as is known, a trim edge counts as near: the
/// edge itself is on a surface known to rounding, and the edge it is shared with on another.
pub(super) const TRIM_REACH: f64 = 4.0;

/// Whether a root of a leaf is kept by the trims of its surface.
pub(super) fn trim_side(
    leaf: &Leaf,
    piece: &Piece,
    (st, jet): (DVec2, &Jet),
    known: &KnownRoot<'_>,
) -> Side {
    // A border's point that is nearest to the ray may be off the leaf.
    let kept = || !leaf.is_trimmed() && holds(leaf.widened(piece, WIDENING), st);
    if piece.trims().is_none() || kept() {
        return Side::Inside;
    }
    let side = piece.side(st, trim_reach(jet, known.along));
    match side {
        Side::Edge { .. } if known.is_long() && !leaf.has_pole() => {
            known.side(piece, st, jet).unwrap_or(side)
        }
        _ => side,
    }
}

/// How near a trim edge must be, in each parameter, for a root that may be off by `error` in
/// space to be at it.
///
/// A step in `s` alone moves the point by `|S_s|`; among steps in `s` and `t` the part of `s` is
/// at most the distance over `|S_s| sin θ`, with `θ` the angle between the tangents. At a pole
/// one tangent vanishes, and its parameter may be anything.
pub(super) fn trim_reach(jet: &Jet, error: f64) -> DVec2 {
    let lengths = DVec2::new(jet.ds.length(), jet.dt.length());
    let sine = jet.ds.cross(jet.dt).length() / (lengths.x * lengths.y);
    let sine = if sine > 0.0 { sine } else { 1.0 }; // also where it is not a number
    TRIM_REACH * error / (lengths * sine)
}

/// A hit is at a border if it is no more errors from it than this: enough for a ray that passes the border by half of one
/// and a root off by one, as distances by way of the parameters are only about those in space. (Fast kernels ask about those
/// hits that are within twice as much, see [`Leaf::near_border`].)
const AT_BORDER: f64 = 4.0;

/// Whether a point lies within rounding of a side that is a border of the surface.
pub(super) fn at_border(piece: &Piece, st: DVec2, jet: &Jet, error: f64) -> bool {
    let distances = piece.side_distances(st, jet);
    (0..4).any(|side| piece.is_border(side) && distances[side] <= AT_BORDER * error)
}
