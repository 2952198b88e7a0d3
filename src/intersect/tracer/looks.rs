//! What is said of a hit besides where it is: its normal, and whether it lies on a border.
//!
//! The rules are here so that all ways of asking follow the same ones.

use glam::{DVec2, DVec3};

use crate::intersect::HitFlags;
use crate::intersect::roots::borders::at_border;
use crate::patch::{Jet, Piece};

/// The normal to report at a point of a piece, of which `limit` is the normal in the piece, or its
/// limit at a pole: none at an apex, where other pieces have other limits.
#[inline]
pub(super) fn reported_normal(piece: &Piece, point: DVec3, limit: Option<DVec3>) -> Option<DVec3> {
    limit.filter(|_| !piece.is_apex(point))
}

/// [`HitFlags::BORDER`] for a certain hit on a border of its surface, to within the errors of a ray
/// of this magnitude ([`RayFrame::magnitude`](crate::math::RayFrame::magnitude)).
#[inline]
pub(super) fn border_flag(piece: &Piece, st: DVec2, jet: &Jet, magnitude: f64) -> HitFlags {
    let error = piece.patch.error_bound(magnitude);
    if at_border(piece, st, jet, error) { HitFlags::BORDER } else { HitFlags::NONE }
}
