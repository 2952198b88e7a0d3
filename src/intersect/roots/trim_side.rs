//! On which side of trims roots lie.

use glam::DVec2;

use super::grazing::KnownRoot;
use super::reach::trim_reach;
use crate::geometry::trim::Side;
use crate::patch::{Jet, Leaf, Piece, WIDENING, holds};

/// The side of its surface's trims on which a root of a leaf lies.
pub(crate) fn trim_side(
    leaf: &Leaf,
    piece: &Piece,
    (st, jet): (DVec2, &Jet),
    known: &KnownRoot<'_>,
) -> Side {
    if piece.trims().is_none() {
        return Side::Inside;
    }
    let reach = trim_reach(jet, known.along);
    // The border point nearest to the ray may be off the leaf; and a root that no certificate
    // vouches for may be known to a tenth of the leaf only. At a pole one parameter may be
    // anything.
    let off = if leaf.has_pole() { DVec2::ZERO } else { reach };
    let answered = leaf.widened(piece, WIDENING);
    if !leaf.is_trimmed() && holds(answered, st - off) && holds(answered, st + off) {
        return Side::Inside;
    }
    let side = piece.side(st, reach);
    match side {
        Side::Edge { .. } if known.is_long() && !leaf.has_pole() => {
            known.side(piece, st, jet).unwrap_or(side)
        }
        _ => side,
    }
}
