//! The control net of a piece: kept, or made on demand.
//!
//! A dense B-spline surface has up to nine times as many Bézier points as control points. So its
//! control points are kept, and a piece's net is made from them when the piece is searched
//! ([`SplineNet`]): always by the same operations, so that every caller gets the same numbers.

use glam::DVec4;

use super::piece_net::{PieceNet, numbers_a_point};
use super::power_nets::MadePowers;
use super::powers::ToPowers;
use crate::geometry::{Extraction, Extractions};
use crate::patch::BezierNet;

/// Where the control net of a piece is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NetSource<'a> {
    /// Kept.
    Kept(PieceNet<'a>),
    /// To be made.
    Spline(SplineNet<'a>),
}

/// The control points of a B-spline that govern a piece, of degree 7 or less in both directions,
/// and how nets are made from them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SplineNet<'a> {
    degree: [usize; 2],
    /// How nets by powers are made, if they are.
    made: Option<&'a MadePowers>,
    extraction: &'a [Extractions; 2],
    points: PieceNet<'a>,
    /// The row and the column of the first point.
    first: [u32; 2],
}

/// The lengths, in numbers, of the longest row and of the longest of degree 3.
pub(crate) const LONGEST: usize = 4 * Extractions::MOST_POINTS;
pub(crate) const LONGEST_OF_CUBIC: usize = 16;

/// Room for a net that is made: with a row to spare, because one more number may be read.
#[derive(Clone, Debug)]
pub(crate) struct NetRoom([f64; LONGEST * (Extractions::MOST_POINTS + 1)]);

impl NetRoom {
    /// No net yet.
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self([0.0; LONGEST * (Extractions::MOST_POINTS + 1)])
    }

    /// All of it, eight numbers at a time.
    #[inline(always)]
    pub(crate) fn eights(&mut self) -> &mut [[f64; 8]] {
        self.0.as_chunks_mut().0
    }

    /// One of its rows, if each has room for `N` numbers.
    #[inline(always)]
    pub(crate) fn row<const N: usize>(&mut self, i: usize) -> &mut [f64; N] {
        &mut self.0.as_chunks_mut().0[i]
    }
}

impl<'a> SplineNet<'a> {
    /// The net of a chart's piece, by the row and the column of the first point.
    #[inline(always)]
    pub(super) fn new(
        (degree, extraction): ([usize; 2], &'a [Extractions; 2]),
        made: Option<&'a MadePowers>,
        points: PieceNet<'a>,
        first: [u32; 2],
    ) -> Self {
        Self { degree, made, extraction, points, first }
    }

    /// The control points that govern the piece, row by row.
    pub(super) fn control(&self) -> BezierNet {
        (0..=self.degree()[0]).flat_map(|i| self.points.points(i)).collect()
    }

    /// The degrees in `s` and `t`.
    #[inline(always)]
    pub(crate) fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// How many numbers a point has.
    #[inline(always)]
    pub(crate) fn size(&self) -> usize {
        numbers_a_point(self.points.weight)
    }

    /// The control points that govern the piece, as they lie in memory.
    #[inline(always)]
    pub(crate) fn points(&self) -> PieceNet<'a> {
        self.points
    }

    /// What makes a power net from these points, along `s` and `t`; `None` where sums are in
    /// Bernstein form.
    #[inline(always)]
    pub(crate) fn by_powers(&self) -> Option<[ToPowers<'a>; 2]> {
        self.made?.of(self.first)
    }

    /// The numbers of a row of control points, and those that follow in memory.
    #[inline(always)]
    pub(crate) fn row<const N: usize>(&self, i: usize) -> &'a [f64; N] {
        let from = &self.points.numbers[i * self.points.stride..];
        debug_assert!(from.len() >= N, "a chart keeps as many behind its last row");
        from.first_chunk().unwrap_or(&[0.0; N])
    }

    /// How many numbers a row has room for in a net that is made.
    #[inline(always)]
    fn row_room(&self) -> usize {
        if self.is_cubic() { LONGEST_OF_CUBIC } else { LONGEST }
    }

    /// Whether it is of degree 3 or less in both directions.
    #[inline(always)]
    fn is_cubic(&self) -> bool {
        self.degree()[0].max(self.degree()[1]) <= 3
    }

    /// The net that was made in this room.
    #[inline(always)]
    pub(crate) fn made<'r>(&self, room: &'r NetRoom) -> PieceNet<'r> {
        PieceNet::new(&room.0, self.row_room(), self.points.length, self.points.weight)
    }

    /// The Bézier points, row by row. Every other way to make them must agree with these, bit for
    /// bit.
    pub(super) fn bezier_net(&self) -> BezierNet {
        let mut net = if self.is_cubic() { self.cubic_net() } else { self.long_net() };
        if let Some(weight) = self.points.weight {
            for point in &mut net {
                point.w = weight;
            }
        }
        net
    }

    /// The net of a piece of degree 3 or less, without the common weight of all points.
    fn cubic_net(&self) -> BezierNet {
        // Degrees known in advance need no branches.
        let points = match self.degree() {
            [3, 3] => self.bezier_points_of([3, 3]),
            [2, 2] => self.bezier_points_of([2, 2]),
            degree => self.bezier_points_of(degree),
        };
        let [p, q] = self.degree();
        let mut net = BezierNet::from_slice(points.as_flattened());
        if q < 3 {
            for i in 1..=p {
                net.copy_within(4 * i..4 * i + q + 1, i * (q + 1));
            }
        }
        net.truncate((p + 1) * (q + 1));
        net
    }

    /// The net of a piece of any degrees, without that weight.
    fn long_net(&self) -> BezierNet {
        let ([p, q], size) = (self.degree(), self.size());
        let mut net = BezierNet::from_elem(DVec4::ZERO, (p + 1) * (q + 1));
        for (i, to) in net.chunks_exact_mut(q + 1).enumerate() {
            let row = self.points.row(i);
            for (j, to) in to.iter_mut().enumerate() {
                *to = DVec4::from_slice(&row[size * j..size * j + 4]);
            }
        }
        let [along_s, along_t] = self.extraction();
        for j in 0..=q {
            along_s.apply(p, &mut net[j..], q + 1);
        }
        for row in net.chunks_exact_mut(q + 1) {
            along_t.apply(q, row, 1);
        }
        net
    }

    /// How the Bézier points come from the control points, along `s` and `t`.
    #[inline(always)]
    fn extraction(&self) -> [Extraction<'a>; 2] {
        let [along_s, along_t] = self.extraction;
        [along_s.at(self.first[0] as usize), along_t.at(self.first[1] as usize)]
    }

    /// The Bézier points for degree 3 or less, with room for those of degree 3. Where points have
    /// three numbers, the fourth is arbitrary.
    #[inline(always)]
    fn bezier_points_of(&self, [p, q]: [usize; 2]) -> [[DVec4; 4]; 4] {
        let size = self.size();
        let mut net = [[DVec4::ZERO; 4]; 4];
        let [Extraction::Steps(along_s), Extraction::Steps(along_t)] = self.extraction() else {
            return net; // such degrees always have steps
        };
        for (i, to) in net[..=p].iter_mut().enumerate() {
            let row = self.row::<LONGEST_OF_CUBIC>(i);
            for (j, to) in to[..=q].iter_mut().enumerate() {
                *to = DVec4::from_slice(&row[size * j..size * j + 4]);
            }
        }
        for j in 0..=q {
            let column = [net[0][j], net[1][j], net[2][j], net[3][j]];
            let column = along_s.apply(p, column);
            for i in 0..=p {
                net[i][j] = column[i];
            }
        }
        for row in &mut net[..=p] {
            *row = along_t.apply(q, *row);
        }
        net
    }

    /// Makes the Bézier net in this room.
    pub(crate) fn make<'r>(&self, room: &'r mut NetRoom) -> PieceNet<'r> {
        let (columns, size, length) = (self.degree()[1] + 1, self.size(), self.row_room());
        for (i, row) in self.bezier_net().chunks_exact(columns).enumerate() {
            let room = &mut room.0[i * length..];
            // Points of three numbers write a fourth, which the next point replaces.
            for (j, point) in row.iter().enumerate() {
                room[size * j..size * j + 4].copy_from_slice(&point.to_array());
            }
        }
        self.made(room)
    }
}
