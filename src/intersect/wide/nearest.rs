//! Which of two hits counts.

use super::hit_place::HitPlace;
use super::trimmed::trims_keep;
use super::view::BvhView;
use crate::intersect::hit::SPARE;
use crate::patch::Leaf;

/// What is to be done with a hit.
pub(super) enum Fate {
    /// The hit is the nearest so far.
    Nearer,
    /// It is not the nearest, or it is trimmed away.
    Dropped,
    /// It lies near an edge of the trims: the scalar search must judge it.
    Undecided,
}

/// Keeps a hit if it is nearer than the nearest so far, and trims keep it.
///
/// Of hits at the same place, the one on the first piece counts, and there the one on its first
/// part, whichever was searched first: so the order of the search does not matter.
#[inline(always)]
pub(super) fn keep(found: &HitPlace, view: &BvhView<'_>, nearest: Option<&HitPlace>) -> Fate {
    let leaf = &view.leaves[found.leaf as usize];
    // A hit that lies beyond the nearest by more than twice its own error bound need not be judged.
    let beyond = |known: &HitPlace| found.z > known.z + SPARE * found.z_error;
    if leaf.is_trimmed() && !nearest.is_some_and(beyond) {
        match trims_keep(found, view) {
            Some(true) => {}
            Some(false) => return Fate::Dropped,
            None => return Fate::Undecided,
        }
    }
    let nearer = nearest.is_none_or(|known| {
        found.z < known.z
            || (found.z == known.z && comes_first(view.leaves, found.leaf, known.leaf))
    });
    if nearer { Fate::Nearer } else { Fate::Dropped }
}

/// Whether trims cut off a root for certain.
#[inline(always)]
pub(super) fn is_cut_off(found: &HitPlace, view: &BvhView<'_>) -> bool {
    view.leaves[found.leaf as usize].is_trimmed() && trims_keep(found, view) == Some(false)
}

/// Whether a leaf comes before another one in the order of pieces and their parts.
pub(super) fn comes_first(leaves: &[Leaf], leaf: u32, other: u32) -> bool {
    let order = |leaf: u32| {
        let leaf = &leaves[leaf as usize];
        (leaf.piece, leaf.place())
    };
    order(leaf) < order(other)
}
