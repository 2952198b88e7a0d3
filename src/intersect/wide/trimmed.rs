//! Decides which hits of a leaf the trims of its surface keep.

use glam::DVec2;

use crate::geometry::trim::Side;
use crate::intersect::crossings::borders::{TRIM_REACH, TRIM_SPARE, trim_reach};
use crate::patch::Piece;

/// How near a trim edge must be, in either parameter, in units of the error times the sum of both
/// tangents' lengths over the length of their cross product. This is no less than [`trim_reach`]
/// says, as a length is at most the sum.
pub(super) const EDGE_REACH: f64 = TRIM_SPARE * TRIM_REACH;

/// Whether a root of a leaf that a trim curve passes through is kept, if its error bound along the
/// ray is `error`; an edge where the scalar search must judge it.
#[inline(never)]
pub(super) fn trim_side(piece: &Piece, st: DVec2, error: f64) -> Side {
    piece.side(st, TRIM_SPARE * trim_reach(&piece.patch.jet(st), error))
}
