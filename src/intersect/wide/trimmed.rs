//! Decides which hits of a leaf the trims of its surface keep.

use glam::DVec2;

use crate::geometry::trim::Side;
use crate::intersect::borders::{TRIM_REACH, trim_reach};
use crate::patch::Piece;

/// The scalar search's root and the one found here are each off by at most the error: a root that
/// is near an edge there is within this many times that reach here.
const SPARE: f64 = 2.0;

/// How near a trim edge must be, in either parameter, in units of the error times the sum of both
/// tangents' lengths over the length of their cross product. This is no less than [`trim_reach`]
/// says, as a length is at most the sum.
pub(super) const EDGE_REACH: f64 = SPARE * TRIM_REACH;

/// Whether a root of a leaf that a trim curve passes through is kept, if its error bound along the
/// ray is `error`; an edge where the scalar search must judge it.
#[inline(never)]
pub(super) fn trim_side(piece: &Piece, st: DVec2, error: f64) -> Side {
    piece.side(st, SPARE * trim_reach(&piece.patch.jet(st), error))
}
