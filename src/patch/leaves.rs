//! Which parts of pieces become leaves: the flatter the more room there is.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::*;
use smallvec::SmallVec;

use super::part::{Halving, Way};
use super::tiles::Grid;
use super::{DyadicRect, GroupedParts, Leaf, OrientedBox, Piece};

/// Finer leaves are made as long as all of them take no more than this: a tenth of what triangles
/// take that are off by 1e-5 of the teapot.
const WORTHWHILE_BYTES: usize = 25 << 15;

/// Those that are no more than half as many again as the coarsest may take this, about the size of a second-level
/// cache.
const MOST_BYTES: usize = 5 << 18;

/// What a leaf takes, but for its weight, with its share of the tree: its box in a block that is half full.
const BYTES_A_LEAF: usize = size_of::<Leaf>() + size_of::<OrientedBox>() * 2;

/// The same as numbers of leaves.
const WORTHWHILE: usize = WORTHWHILE_BYTES / BYTES_A_LEAF;
const MOST: usize = MOST_BYTES / BYTES_A_LEAF;

/// The parts of all pieces that are to be leaves, of more than [`MOST`] pieces the coarsest, tile by
/// tile; and none where trims have cut all of it off.
///
/// All are as flat as a leaf must be; then always the part is halved for which that is worth most, as
/// long as there is room. Halves that are not flat enough by themselves may take a little more.
pub(super) fn parts(pieces: &[Piece], grids: &[Grid]) -> GroupedParts {
    if pieces.len() > MOST {
        return GroupedParts::coarse(pieces, grids);
    }
    let coarse: Vec<SmallVec<[Flat; 1]>> = pieces
        .par_iter()
        .enumerate()
        .map(|(k, piece)| {
            let mut parts = SmallVec::new();
            Halving::whole(piece).coarse_parts(piece, &mut |halving| {
                parts.push(Flat::new(k as u32, piece, halving));
            });
            parts
        })
        .collect();
    let mut open: BinaryHeap<Flat> = coarse.into_iter().flatten().collect();
    let mut done: Vec<Flat> = Vec::new();
    let worthwhile = (open.len() + open.len() / 2).clamp(WORTHWHILE, MOST);
    while open.len() + done.len() < worthwhile {
        let Some(flat) = open.pop() else { break };
        let Some(way) = flat.way else {
            done.push(flat);
            continue;
        };
        let piece = &pieces[flat.piece as usize];
        flat.halving.halved(piece, way, &mut |halving| {
            open.push(Flat::new(flat.piece, piece, halving));
        });
    }
    done.extend(open);
    done.par_sort_unstable_by_key(Flat::place);
    let part = |flat: &Flat| flat.halving.part(flat.piece, &pieces[flat.piece as usize]);
    GroupedParts::single(done.par_iter().map(part).collect())
}

/// A part that is to be a leaf, as long as there is no room for its halves.
struct Flat {
    piece: u32,
    halving: Box<Halving>,
    /// How to halve it, if that is worth anything.
    way: Option<Way>,
}

impl Flat {
    fn new(index: u32, piece: &Piece, halving: Halving) -> Self {
        let way = halving.way(piece);
        Self { piece: index, halving: Box::new(halving), way }
    }

    fn place(&self) -> (u32, DyadicRect) {
        (self.piece, self.halving.rect())
    }
}

/// By what halving is worth; of equal ones the first comes last, to be the greatest.
impl Ord for Flat {
    fn cmp(&self, other: &Self) -> Ordering {
        let worth = |flat: &Self| flat.way.map_or(f64::NEG_INFINITY, |way| way.worth);
        worth(self).total_cmp(&worth(other)).then_with(|| other.place().cmp(&self.place()))
    }
}

impl PartialOrd for Flat {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Flat {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Flat {}
