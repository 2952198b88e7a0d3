//! Which parts of pieces become leaves: as flat ones as their number allows.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use smallvec::SmallVec;

use super::part::{Cut, Fineness, Halving};
use super::{Leaf, OrientedBox, Part, Piece};

/// How flat leaves are tried to be, from coarse to fine: see [`Halving::parts`].
///
/// Flatter leaves need fewer Newton steps, fit their boxes better and are certified for
/// more rays; but there are more of them. Measured on sphere, teapot and height fields,
/// the work a ray stops falling at about 0.06, and rises where leaves leave the cache.
const FLATNESS: [f64; 7] = [0.5, 0.35, 0.25, 0.18, 0.12, 0.09, 0.06];

/// How often flat leaves that a trim curve passes through are halved for it, from coarse to fine:
/// see [`Halving::parts`].
///
/// Measured on a sheet with 2132 leaves, 336 of them at a curve: 2 and 4 save more tests of hits
/// than they add leaves, 6 and 8 gain nothing more and take two and three times the memory.
const TRIM_CUTS: [u32; 3] = [0, 2, 4];

/// Finer leaves are made only while all of them take no more than this: about the size of
/// a second-level cache, and a sixth of what triangles take that are off by 1e-5 of the model.
const WORTHWHILE_BYTES: usize = 5 << 18;

/// What a leaf takes with its share of the tree: its box in a block that is four fifths full.
const BYTES_A_LEAF: usize = size_of::<Leaf>() + size_of::<OrientedBox>() * 5 / 4;

/// The most leaves that are made finer than the coarsest.
const WORTHWHILE: usize = WORTHWHILE_BYTES / BYTES_A_LEAF;

/// A part that is to be a leaf, as long as it may still be cut into finer ones.
struct Flat {
    piece: u32,
    halving: Arc<Halving>,
    trimmed: bool,
}

/// The parts of all pieces that are to be leaves, piece by piece: as flat as their number allows,
/// and none where trims have cut all of it off.
///
/// The finest are chosen that take no more room than is worthwhile: first the flattest, then those
/// that follow trim curves most closely.
pub(super) fn parts(pieces: &[Piece]) -> Vec<Part> {
    let coarsest = Fineness { flatness: FLATNESS[0], cuts: TRIM_CUTS[0] };
    let Some(mut leaves) = few(pieces, coarsest) else { return coarse_parts(pieces, coarsest) };
    let mut fineness = coarsest;
    for &flatness in &FLATNESS[1..] {
        let flatter = Fineness { flatness, ..fineness };
        let Some(finer) = refined(pieces, &leaves, flatter) else { break };
        (leaves, fineness) = (finer, flatter);
    }
    if pieces.iter().any(|piece| piece.trims().is_some()) {
        for &cuts in &TRIM_CUTS[1..] {
            let closer = Fineness { cuts, ..fineness };
            let Some(finer) = refined(pieces, &leaves, closer) else { break };
            (leaves, fineness) = (finer, closer);
        }
    }
    let part =
        |flat: &Flat| flat.halving.part(flat.piece, &pieces[flat.piece as usize], flat.trimmed);
    leaves.par_iter().map(part).collect()
}

/// The parts of many pieces: of each the control points are needed for a moment only.
fn coarse_parts(pieces: &[Piece], fineness: Fineness) -> Vec<Part> {
    let parts = pieces.par_iter().enumerate().flat_map_iter(|(k, piece)| {
        let mut parts = SmallVec::<[Part; 1]>::new();
        Halving::whole(piece).cut(piece, fineness, &mut |halving, trimmed| {
            parts.push(halving.part(k as u32, piece, trimmed));
        });
        parts
    });
    parts.collect()
}

/// The parts of pieces, if they are no more than is worthwhile.
fn few(pieces: &[Piece], fineness: Fineness) -> Option<Vec<Flat>> {
    if pieces.len() > WORTHWHILE {
        return None;
    }
    let whole = pieces.par_iter().enumerate().map(|(k, piece)| Flat {
        piece: k as u32,
        halving: Arc::new(Halving::whole(piece)),
        trimmed: false,
    });
    refined(pieces, &whole.collect::<Vec<_>>(), fineness)
}

/// What these are cut into if leaves are to be finer, in the same order; `None` if that is more
/// than is worthwhile.
fn refined(pieces: &[Piece], leaves: &[Flat], fineness: Fineness) -> Option<Vec<Flat>> {
    let count = AtomicUsize::new(0);
    let parts = leaves.par_iter().map(|&Flat { piece, ref halving, .. }| {
        if count.load(Ordering::Relaxed) > WORTHWHILE {
            return None; // whatever else there is
        }
        let mut parts = SmallVec::<[Flat; 2]>::new();
        let cut = halving.parts(&pieces[piece as usize], fineness, &mut |halving, trimmed| {
            parts.push(Flat { piece, halving: Arc::new(halving), trimmed });
        });
        if let Cut::Whole { trimmed } = cut {
            parts.push(Flat { piece, halving: Arc::clone(halving), trimmed });
        }
        count.fetch_add(parts.len(), Ordering::Relaxed);
        Some(parts)
    });
    let parts: Option<Vec<_>> = parts.collect();
    let few = count.into_inner() <= WORTHWHILE;
    parts.filter(|_| few).map(|parts| parts.into_iter().flatten().collect())
}
