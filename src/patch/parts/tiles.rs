//! Neighbouring pieces whose leaves lie side by side.
//!
//! Where there are so many pieces that most of them are one leaf, a tree would put the leaves of a
//! few rows and columns of a chart together anyway. If it is given these groups, it has a sixteenth
//! of the boxes to sort, and its blocks are full. Measured: a sheet of a million pieces is ready in
//! 0.7 of the time; on sheets of 256 × 256 and more pieces rays are traced 1.0 to 1.2 times as
//! fast.

use std::ops::Range;

use glam::DVec3;
use rayon::prelude::*;

use crate::math::Aabb;
use crate::patch::pieces::chart_grid::ChartGrid;
use crate::patch::{Part, Piece};

/// The parts of pieces that become leaves, and which of them are kept together: consecutive groups
/// of neighbours on a surface, each of at least one part and no more than sixteen.
#[derive(Clone, Debug, Default)]
pub(crate) struct GroupedParts {
    parts: Vec<Part>,
    groups: Vec<u32>,
}

/// The most parts that are kept together.
pub(crate) const MOST_TOGETHER: usize = 16;
const _: () = assert!(MOST_TOGETHER.is_power_of_two());

/// A few rows and columns of a grid.
struct Tile {
    grid: ChartGrid,
    rows: Range<usize>,
    columns: Range<usize>,
}

impl GroupedParts {
    /// All parts, group by group.
    pub(crate) fn all(&self) -> &[Part] {
        &self.parts
    }

    /// The number of parts in each group.
    pub(crate) fn groups(&self) -> &[u32] {
        &self.groups
    }

    /// A box that holds all points that leaves of these parts answer for.
    pub(in crate::patch) fn bounds(&self) -> Aabb {
        self.parts.iter().fold(Aabb::EMPTY, |bounds, part| bounds.union(part.bounds))
    }

    /// Parts that are not kept together with others.
    pub(in crate::patch) fn single(parts: Vec<Part>) -> Self {
        let groups = vec![1; parts.len()];
        Self { parts, groups }
    }

    /// The parts of all pieces of the grids, tile by tile, in the order of the grids, whatever the
    /// number of threads. `add_parts` adds those of one piece.
    pub(in crate::patch) fn of(
        pieces: &[Piece],
        grids: &[ChartGrid],
        add_parts: impl Fn(usize, &mut Vec<Part>) + Sync,
    ) -> Self {
        let tiles: Vec<Tile> = grids.iter().flat_map(|grid| grid.tiles(pieces)).collect();
        // In chunks, so that there are few lists to join.
        let some: Vec<Self> = tiles
            .par_chunks(256)
            .map(|tiles| {
                let mut some = Self::default();
                some.parts.reserve(tiles.len() * MOST_TOGETHER);
                for tile in tiles {
                    some.add(tile, &add_parts);
                }
                some
            })
            .collect();
        let mut all = Self::default();
        all.parts.reserve(some.iter().map(|some| some.parts.len()).sum());
        all.groups.reserve(some.iter().map(|some| some.groups.len()).sum());
        for some in some {
            all.append(some);
        }
        all
    }

    /// Adds the groups of others after its own.
    pub(in crate::patch) fn append(&mut self, others: Self) {
        self.parts.extend(others.parts);
        self.groups.extend(others.groups);
    }

    /// Adds the parts of a tile, as one group if there are not too many.
    fn add(&mut self, tile: &Tile, add_parts: &impl Fn(usize, &mut Vec<Part>)) {
        let before = self.parts.len();
        for k in tile.pieces() {
            add_parts(k, &mut self.parts);
        }
        match self.parts.len() - before {
            0 => {}
            count @ 1..=MOST_TOGETHER => self.groups.push(count as u32),
            count => self.groups.extend(std::iter::repeat_n(1, count)),
        }
    }
}

impl ChartGrid {
    /// Tiles of [`MOST_TOGETHER`] pieces, fewer at the ends, about as long as they are wide.
    /// Squares of that many rows and columns are each cut into tiles of one shape, chosen by the
    /// sides of their own pieces.
    fn tiles(self, pieces: &[Piece]) -> impl Iterator<Item = Tile> {
        let whole = Tile { grid: self, rows: 0..self.rows, columns: 0..self.columns };
        whole.cut([MOST_TOGETHER; 2]).flat_map(|square| {
            let rows = square.rows_of_a_tile(pieces);
            square.cut([rows, MOST_TOGETHER / rows])
        })
    }
}

impl Tile {
    /// Tiles of this many rows and columns, fewer at the ends.
    fn cut(self, [rows, columns]: [usize; 2]) -> impl Iterator<Item = Self> {
        let ranges = |range: Range<usize>, most: usize| {
            range.clone().step_by(most).map(move |start| start..(start + most).min(range.end))
        };
        ranges(self.rows, rows).flat_map(move |rows| {
            let tile = move |columns| Self { grid: self.grid, rows: rows.clone(), columns };
            ranges(self.columns.clone(), columns).map(tile)
        })
    }

    /// The indices of the pieces among all, row by row.
    fn pieces(&self) -> impl Iterator<Item = usize> {
        let ChartGrid { first, columns, .. } = self.grid;
        let row = move |row: usize| self.columns.clone().map(move |k| first + row * columns + k);
        self.rows.clone().flat_map(row)
    }

    /// The number of rows that its tiles get: a power of two, from the side lengths of some pieces.
    fn rows_of_a_tile(&self, pieces: &[Piece]) -> usize {
        // A prime larger than a square's number of columns, so that the pieces looked at are in all
        // columns.
        const LOOKED_AT: usize = 17;
        let mut lengths = [0.0; 2];
        for k in self.pieces().step_by(LOOKED_AT) {
            let sides = pieces[k].patch.chords([[0.0, 1.0]; 2]).map(DVec3::length);
            lengths = [lengths[0] + sides[0], lengths[1] + sides[1]];
        }
        // As long as wide: r rows of the first length, 16 / r columns of the second.
        let ratio = lengths[1] / lengths[0];
        let rows = (0.5 * (MOST_TOGETHER as f64 * ratio).log2()).round();
        // Negative numbers and NaN become 0.
        let rows = 1 << (rows as u32).min(MOST_TOGETHER.ilog2());
        rows.min(self.rows.len().next_power_of_two())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface};
    use crate::patch::PatchSet;
    use crate::patch::leaves::coarse;
    use glam::DVec4;

    /// A wavy sheet of this many pieces, in a box of these sides.
    fn sheet(pieces: [usize; 2], sides: [f64; 2]) -> PatchSet {
        let knots = pieces.map(|count| KnotVector::clamped_uniform(2, count + 2).unwrap());
        let [rows, columns] = pieces.map(|count| count + 2);
        let point = |k: usize| {
            let x = sides[0] * (k / columns) as f64 / rows as f64;
            let y = sides[1] * (k % columns) as f64 / columns as f64;
            DVec4::new(x, y, 0.01 * (x + y).sin(), 1.0)
        };
        let net = (0..rows * columns).map(point).collect();
        let [u, v] = knots;
        let surface = NurbsSurface::from_homogeneous(u, v, net).unwrap();
        PatchSet::new(&[surface]).unwrap().0
    }

    fn rows(pieces: [usize; 2], sides: [f64; 2]) -> usize {
        let set = sheet(pieces, sides);
        let grid = ChartGrid { first: 0, rows: pieces[0], columns: pieces[1] };
        let tile = grid.tiles(set.pieces()).next().unwrap();
        assert_eq!(tile.rows.len() * tile.columns.len(), MOST_TOGETHER);
        tile.rows.len()
    }

    #[test]
    fn tiles_are_about_square() {
        assert_eq!(rows([20, 20], [1.0, 1.0]), 4);
        assert_eq!(rows([20, 20], [1.0, 4.0]), 8);
        assert_eq!(rows([20, 20], [100.0, 1.0]), 1);
        assert_eq!(rows([80, 20], [1.0, 4.0]), 16);
    }

    #[test]
    fn every_piece_is_in_one_tile() {
        let grid = ChartGrid { first: 5, rows: 9, columns: 23 };
        let set = sheet([20, 12], [3.0, 1.0]); // there is a piece wherever tiles look
        let mut seen = Vec::new();
        for tile in grid.tiles(set.pieces()) {
            assert!(tile.pieces().count() <= MOST_TOGETHER);
            seen.extend(tile.pieces());
        }
        seen.sort_unstable();
        assert!(seen.into_iter().eq(5..5 + 9 * 23));
    }

    #[test]
    fn groups_are_of_all_parts() {
        let set = sheet([61, 79], [1.0, 1.0]);
        let grid = ChartGrid { first: 0, rows: 61, columns: 79 };
        let GroupedParts { parts, groups } = coarse(set.pieces(), &[grid]);
        assert_eq!(groups.iter().sum::<u32>() as usize, parts.len());
        assert_eq!(groups.len(), 61usize.div_ceil(4) * 79usize.div_ceil(4));
        let mut pieces: Vec<_> = parts.iter().map(|part| part.piece).collect();
        pieces.sort_unstable();
        assert!(pieces.into_iter().eq(0..61 * 79));
    }

    #[test]
    fn tiles_of_many_parts_are_not_kept_together() {
        let set = bent(4);
        let grid = ChartGrid { first: 0, rows: 4, columns: 4 };
        let many = coarse(set.pieces(), &[grid]);
        assert!(many.all().len() > MOST_TOGETHER);
        assert!(many.groups().iter().all(|&count| count == 1));
        assert_eq!(many.groups().len(), many.all().len());
    }

    /// A wave of this many pieces each way, each of which bends by half a turn.
    fn bent(pieces: usize) -> PatchSet {
        let points = pieces + 2;
        let knots = KnotVector::clamped_uniform(2, points).unwrap();
        let point = |k: usize| {
            let [i, j] = [k / points, k % points];
            DVec4::new(i as f64, j as f64, if i % 2 == 0 { 3.0 } else { -3.0 }, 1.0)
        };
        let net = (0..points * points).map(point).collect();
        let surface = NurbsSurface::from_homogeneous(knots.clone(), knots, net).unwrap();
        PatchSet::new(&[surface]).unwrap().0
    }
}
