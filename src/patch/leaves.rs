//! Which parts of pieces become leaves: the more room there is, the flatter they are.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use rayon::prelude::*;
use smallvec::SmallVec;

use super::parts::part::{Cut, PartNet};
use super::pieces::chart_grid::ChartGrid;
use super::{DyadicRect, GroupedParts, Leaf, OrientedBox, Part, Piece};
use crate::math::Aabb;

/// Finer leaves are made as long as all leaves together take no more than this: a tenth of the
/// memory of triangles that approximate the teapot to 1e-5 of its diagonal.
const WORTHWHILE_BYTES: usize = 25 << 15;

/// Up to 1.5 times as many leaves as there are coarsest ones may take this, about the size of a
/// second-level cache.
const MOST_BYTES: usize = 5 << 18;

/// Parts that bend much and are large in the scene are worth more memory, up to this; in scenes of
/// more leaves, up to half of this in addition.
const SCENE_BYTES: usize = 5 << 20;

/// The least [`Cut::worth`] that is worth that memory, with lengths as fractions of the scene's
/// diagonal: half an angle of 0.42 is enough for a part of size a hundredth, and 0.1 for one of
/// size 0.18.
///
/// Measured on models of 500 to 2700 pieces: a teapot with its parts blended is traced 1.3 to 1.6
/// times as fast (shadow rays 2.5 times) with 8400 leaves instead of 6300, a lamp 1.2 to 1.3 times
/// with 5900 instead of 3700, others 1.0 to 1.2 times. Half this value gains packets nothing more,
/// and takes 1.4 to 2.2 times the memory.
const WORTHWHILE_IN_SCENE: f64 = 1.0 / 24.0;

/// However many leaves a scene has, it may have this part of them in addition, where halving is
/// worth half of [`WORTHWHILE_IN_SCENE`]: what fills the picture may be a few large pieces among
/// thousands of small ones.
const MORE: usize = 8;

/// The memory of a leaf without its weight, including its share of the tree: its box in a block
/// that is half full.
const BYTES_A_LEAF: usize = size_of::<Leaf>() + size_of::<OrientedBox>() * 2;

/// The same limits as numbers of leaves.
const WORTHWHILE: usize = WORTHWHILE_BYTES / BYTES_A_LEAF;
const MOST: usize = MOST_BYTES / BYTES_A_LEAF;
const MOST_OF_SCENE: usize = SCENE_BYTES / BYTES_A_LEAF;

/// The parts of all pieces that become leaves; none of a piece that trims have cut off entirely.
///
/// Charts of more than [`MOST`] pieces get the coarsest parts. Neighbours are kept together where
/// there are so many pieces.
pub(super) fn parts(pieces: &[Piece], grids: &[ChartGrid]) -> GroupedParts {
    let (dense, others): (Vec<ChartGrid>, Vec<ChartGrid>) =
        grids.iter().partition(|grid| grid.count() > MOST);
    let mut parts = coarse(pieces, &dense);
    let fine = halved(pieces, &others, parts.bounds());
    if pieces_of(&others) > MOST {
        parts.append(GroupedParts::of(pieces, &others, |piece, parts| {
            let first = fine.partition_point(|part| (part.piece as usize) < piece);
            let of_piece = |part: &&Part| part.piece as usize == piece;
            parts.extend(fine[first..].iter().take_while(of_piece));
        }));
    } else {
        parts.append(GroupedParts::single(fine));
    }
    parts
}

fn pieces_of(grids: &[ChartGrid]) -> usize {
    grids.iter().map(ChartGrid::count).sum()
}

/// The coarsest parts of all pieces of some charts. Control points are needed only for a moment.
pub(super) fn coarse(pieces: &[Piece], grids: &[ChartGrid]) -> GroupedParts {
    GroupedParts::of(pieces, grids, |k, parts| {
        let piece = &pieces[k];
        PartNet::whole(piece).coarse_parts(piece, &mut |part_net| {
            parts.push(part_net.part(k as u32, piece));
        });
    })
}

/// The parts of the pieces of some charts, piece by piece; `bounds` hold what else is in the scene.
///
/// All parts are as flat as a leaf must be. Then the part for which halving is worth most is
/// halved, again and again, as long as there is room. Halves that are not flat enough by themselves
/// may take a little more.
fn halved(pieces: &[Piece], grids: &[ChartGrid], bounds: Aabb) -> Vec<Part> {
    let charts = || grids.par_iter().flat_map(|grid| grid.pieces());
    let flats = |k: usize| flats_of(k, &pieces[k]);
    // The parts that stay as they are, and those that may be halved.
    let (mut leaves, mut open, room): (Vec<Part>, BinaryHeap<Flat>, Room);
    if pieces_of(grids) <= MOST_OF_SCENE {
        let coarse: Vec<Flats> = charts().map(flats).collect();
        leaves = Vec::new();
        open = coarse.into_iter().flatten().collect();
        let boxes = open.iter().map(|flat| flat.part_net.bounds());
        room = Room::new(open.len(), boxes.fold(bounds, Aabb::union));
    } else {
        // The control points of all parts at once would take too much memory.
        let coarse: Vec<(usize, f64, SmallVec<[Part; 1]>)> = charts()
            .map(|k| {
                let flats = flats(k);
                let worth = flats.iter().map(Flat::worth).fold(0.0, f64::max);
                (k, worth, flats.iter().map(|flat| flat.part(pieces)).collect())
            })
            .collect();
        let parts = || coarse.iter().flat_map(|(_, _, parts)| parts);
        let boxes = parts().map(|part| part.bounds);
        room = Room::new(parts().count(), boxes.fold(bounds, Aabb::union));
        let (bent, others): (Vec<_>, Vec<_>) =
            coarse.into_iter().partition(|(_, worth, _)| room.may_be_for(*worth));
        leaves = others.into_iter().flat_map(|(_, _, parts)| parts).collect();
        let bent: Vec<Flats> = bent.into_par_iter().map(|(k, _, _)| flats(k)).collect();
        open = bent.into_iter().flatten().collect();
    }

    while let Some(way) = open.peek().and_then(|flat| flat.way) {
        if !room.is_for(way.worth, leaves.len() + open.len()) {
            break;
        }
        let Some(flat) = open.pop() else { break };
        let piece = &pieces[flat.piece as usize];
        flat.part_net.halved(piece, way, &mut |part_net| {
            open.push(Flat::new(flat.piece, piece, part_net));
        });
    }
    leaves.par_extend(open.into_vec().into_par_iter().map(|flat| flat.part(pieces)));
    leaves.par_sort_unstable_by_key(|part| (part.piece, part.rect));
    leaves
}

/// How many leaves there may be besides those of dense charts.
struct Room {
    /// If halving is worth anything.
    worthwhile: usize,
    /// If it is worth half of `worth_in_scene`.
    more: usize,
    /// If it is worth more than that.
    in_scene: usize,
    worth_in_scene: f64,
}

impl Room {
    /// For a scene of this many coarsest parts and this size.
    fn new(coarse: usize, bounds: Aabb) -> Self {
        let more = coarse / MORE;
        Self {
            worthwhile: (coarse + coarse / 2).clamp(WORTHWHILE, MOST),
            more: coarse + more,
            in_scene: MOST_OF_SCENE.max(coarse + more.max(MOST_OF_SCENE / 2)),
            worth_in_scene: WORTHWHILE_IN_SCENE * bounds.size().length().sqrt(),
        }
    }

    /// Whether a part may be halved that is worth this much, when there are this many leaves.
    fn is_for(&self, worth: f64, count: usize) -> bool {
        let most = if worth > self.worth_in_scene {
            self.in_scene
        } else if self.may_be_for(worth) {
            self.more
        } else {
            0
        };
        count < most.max(self.worthwhile)
    }

    /// Whether it may be the turn of such a part in a large scene.
    fn may_be_for(&self, worth: f64) -> bool {
        worth > 0.5 * self.worth_in_scene
    }
}

/// The coarsest parts of a piece.
fn flats_of(index: usize, piece: &Piece) -> Flats {
    let mut flats = Flats::new();
    PartNet::whole(piece).coarse_parts(piece, &mut |part_net| {
        flats.push(Flat::new(index as u32, piece, part_net));
    });
    flats
}

type Flats = SmallVec<[Flat; 1]>;

/// A part that becomes a leaf unless there is room for its halves.
struct Flat {
    piece: u32,
    part_net: Box<PartNet>,
    /// How to halve the part, if that is worth anything.
    way: Option<Cut>,
}

impl Flat {
    fn new(index: u32, piece: &Piece, part_net: PartNet) -> Self {
        let way = part_net.way(piece);
        Self { piece: index, part_net: Box::new(part_net), way }
    }

    fn place(&self) -> (u32, DyadicRect) {
        (self.piece, self.part_net.rect())
    }

    /// What halving is worth.
    fn worth(&self) -> f64 {
        self.way.map_or(0.0, |way| way.worth)
    }

    fn part(&self, pieces: &[Piece]) -> Part {
        self.part_net.part(self.piece, &pieces[self.piece as usize])
    }
}

/// Ordered by what halving is worth; among equal ones the first in place is the greatest.
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

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{MOST, MOST_OF_SCENE, coarse};
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::patch::pieces::chart_grid::ChartGrid;
    use crate::patch::{GroupedParts, Part, PatchSet};

    /// A wavy biquadratic sheet of this many pieces each way, on a square with sides of 1.
    fn sheet(pieces: usize, height: f64) -> NurbsSurface {
        let points = pieces + 2;
        let knots = KnotVector::clamped_uniform(2, points).unwrap();
        let at = |i: usize| i as f64 / points as f64;
        let point = |k: usize| {
            let [x, y] = [at(k / points), at(k % points)];
            DVec4::new(x, y, height * (6.0 * x).sin() * (6.0 * y).cos(), 1.0)
        };
        let net = (0..points * points).map(point).collect();
        NurbsSurface::from_homogeneous(knots.clone(), knots, net).unwrap()
    }

    #[test]
    fn what_lies_beside_a_dense_surface_is_halved_as_if_it_were_alone() {
        let side = MOST.isqrt() + 1;
        let (dense, bent) = (sheet(side, 0.01), sheet(4, 0.3));
        let (_, alone) = PatchSet::new(std::slice::from_ref(&bent)).unwrap();
        let (set, together) = PatchSet::new(&[dense, bent]).unwrap();
        let of_bent = set.pieces_of(1);
        let is_bent = |piece: u32| of_bent.contains(&(piece as usize));
        let count = together.all().iter().filter(|part| is_bent(part.piece)).count();
        assert_eq!(count, alone.all().len());
        assert!(count > 100, "{count} leaves of {} pieces", of_bent.len());

        // The others, one each, are together with their neighbours.
        assert_eq!(together.all().len() - count, side * side);
        assert!(together.groups().len() < count + side * side / 12);
        assert_eq!(together.groups().iter().sum::<u32>() as usize, together.all().len());
    }

    #[test]
    fn beside_many_pieces_is_halved_what_bends_much_in_the_scene() {
        let side = (MOST / 2).isqrt() + 1;
        let surfaces = [sheet(side, 0.01), sheet(side, 0.01), sheet(4, 0.3)];
        let (set, parts) = PatchSet::new(&surfaces).unwrap();
        let count = |parts: &GroupedParts, k: usize| {
            let of_surface = set.pieces_of(k);
            let is_there = |part: &&Part| of_surface.contains(&(part.piece as usize));
            parts.all().iter().filter(is_there).count()
        };
        assert!(count(&parts, 0) < 2 * side * side);
        let bent = ChartGrid { first: set.pieces_of(2).start, rows: 4, columns: 4 };
        let [fine, coarse] = [count(&parts, 2), count(&coarse(set.pieces(), &[bent]), 2)];
        assert!(fine > 2 * coarse, "{fine} leaves, of the coarsest {coarse}");
    }

    #[test]
    fn beside_thousands_of_small_bodies_a_large_one_is_halved_all_the_same() {
        let bent = sheet(4, 0.3);
        let small = |k: usize| {
            let at = DVec4::new(0.01 * (k % 100) as f64, 0.01 * (k / 100) as f64, -1.0, 0.0);
            let square = sheet(2, 0.3);
            let net = square.control().iter().map(|c| 0.005 * (*c - DVec4::W) + DVec4::W + at);
            let [knots_u, knots_v] = [square.knots_u(), square.knots_v()].map(Clone::clone);
            NurbsSurface::from_homogeneous(knots_u, knots_v, net.collect()).unwrap()
        };
        let count = |others: usize| {
            let surfaces: Vec<_> =
                [bent.clone()].into_iter().chain((0..others).map(small)).collect();
            let (set, parts) = PatchSet::new(&surfaces).unwrap();
            let of_bent = set.pieces_of(0);
            let is_there = |part: &&Part| of_bent.contains(&(part.piece as usize));
            (parts.all().iter().filter(is_there).count(), parts.all().len())
        };
        let (fine, _) = count(MOST / 8);
        let (beside_many, all) = count(MOST_OF_SCENE / 3);
        assert!(all > MOST_OF_SCENE && 10 * beside_many > 9 * fine, "{beside_many}, {fine}");
    }
}
