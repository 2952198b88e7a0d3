//! Which parts of pieces become leaves: the flatter the more room there is.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::*;
use smallvec::SmallVec;

use super::part::{Halving, Way};
use super::tiles::Grid;
use super::{DyadicRect, GroupedParts, Leaf, OrientedBox, Piece};
use crate::math::Aabb;

/// Finer leaves are made as long as all of them take no more than this: a tenth of what triangles
/// take that are off by 1e-5 of the teapot.
const WORTHWHILE_BYTES: usize = 25 << 15;

/// Those that are no more than half as many again as the coarsest may take this, about the size of a second-level
/// cache.
const MOST_BYTES: usize = 5 << 18;

/// Halving what bends by a good deal and is large in the scene is worth more memory, up to this.
const SCENE_BYTES: usize = 5 << 20;

/// From here on it is: [`Way::worth`] where lengths are parts of the scene's diagonal, so that half an angle of 0.42 is
/// enough of a part a hundredth as large, and 0.1 of one that takes 0.18 of it.
///
/// Measured on models of 500 to 2700 pieces: a teapot with its parts blended is traced 1.3 to 1.6 times as fast
/// (shadow rays 2.5 times) with 8400 leaves instead of 6300, a lamp 1.2 to 1.3 times with 5900 instead of 3700, others
/// 1.0 to 1.2 times. Half of it is worth nothing more to packets, and takes 1.4 to 2.2 times the memory.
const WORTHWHILE_IN_SCENE: f64 = 1.0 / 24.0;

/// What a leaf takes, but for its weight, with its share of the tree: its box in a block that is half full.
const BYTES_A_LEAF: usize = size_of::<Leaf>() + size_of::<OrientedBox>() * 2;

/// The same as numbers of leaves.
const WORTHWHILE: usize = WORTHWHILE_BYTES / BYTES_A_LEAF;
const MOST: usize = MOST_BYTES / BYTES_A_LEAF;
const MOST_OF_SCENE: usize = SCENE_BYTES / BYTES_A_LEAF;

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
    let worthwhile = (open.len() + open.len() / 2).clamp(WORTHWHILE, MOST);
    let worth_in_scene = WORTHWHILE_IN_SCENE * diagonal(&open).sqrt();
    while let Some(way) = open.peek().and_then(|flat| flat.way) {
        let is_due = open.len() < MOST_OF_SCENE && way.worth > worth_in_scene;
        if !is_due && open.len() >= worthwhile {
            break;
        }
        let Some(flat) = open.pop() else { break };
        let piece = &pieces[flat.piece as usize];
        flat.halving.halved(piece, way, &mut |halving| {
            open.push(Flat::new(flat.piece, piece, halving));
        });
    }
    let mut leaves = open.into_vec();
    leaves.par_sort_unstable_by_key(Flat::place);
    let part = |flat: &Flat| flat.halving.part(flat.piece, &pieces[flat.piece as usize]);
    GroupedParts::single(leaves.par_iter().map(part).collect())
}

/// Of the box around all parts.
fn diagonal(parts: &BinaryHeap<Flat>) -> f64 {
    let bounds = parts.iter().map(|flat| flat.halving.bounds());
    bounds.fold(Aabb::EMPTY, Aabb::union).size().length()
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
