//! On which side of trims roots lie.

use glam::DVec2;

use super::borders::trim_reach;
use super::grazing::KnownRoot;
use crate::geometry::trim::Side;
use crate::patch::{Jet, Leaf, Piece, WIDENING, holds};

/// The side of its surface's trims on which a root of a leaf lies.
pub(crate) fn trim_side(
    leaf: &Leaf,
    piece: &Piece,
    (st, jet): (DVec2, &Jet),
    known: &KnownRoot<'_>,
) -> Side {
    // The border point nearest to the ray may be off the leaf.
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
