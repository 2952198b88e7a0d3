//! The control net of a piece: as it is kept, or made where it is wanted.
//!
//! Of a dense B-spline surface the Bézier points are up to nine times as many as its own control points.
//! So those are kept, and a piece's net is made of them when the piece is searched ([`SplineNet`]): always
//! by the same operations, so that whoever makes it has the same numbers.

use glam::{DVec3, DVec4};

use super::ControlNet;
use super::powers::ToPowers;
use crate::geometry::Extraction;

/// How many numbers are kept of a control point: its weight, too, where not all have the same.
#[inline(always)]
pub(super) fn numbers_a_point(common_weight: Option<f64>) -> usize {
    if common_weight.is_some() { 3 } else { 4 }
}

/// Rows of control points, as they lie in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PieceNet<'a> {
    /// From the first number of the first row on.
    numbers: &'a [f64],
    /// How many numbers further on the next row begins.
    stride: usize,
    /// The numbers of a row that belong to the piece.
    length: usize,
    /// The weight of all points, if it is one: then a point has three numbers, else four.
    weight: Option<f64>,
}

impl<'a> PieceNet<'a> {
    /// No points.
    pub(crate) const EMPTY: Self = Self { numbers: &[], stride: 0, length: 0, weight: None };

    /// There is one number more after the last row.
    pub(super) fn new(
        numbers: &'a [f64],
        stride: usize,
        length: usize,
        weight: Option<f64>,
    ) -> Self {
        Self { numbers, stride, length, weight }
    }

    /// The numbers of a row, which in a Bézier net is that of the `i`-th Bernstein function of `s`: four for
    /// each point, or three where all weights are the same, and one more, so that four can be read at
    /// every point.
    #[inline(always)]
    pub(crate) fn row(&self, i: usize) -> &'a [f64] {
        &self.numbers[i * self.stride..=i * self.stride + self.length]
    }

    /// Whether each row follows the one before at once.
    #[inline(always)]
    pub(crate) fn is_without_gaps(&self) -> bool {
        self.stride == self.length
    }

    /// So many numbers from the beginning of a row on.
    #[inline(always)]
    pub(crate) fn numbers_from(&self, i: usize, count: usize) -> &'a [f64] {
        &self.numbers[i * self.stride..][..count]
    }

    /// The homogeneous control points `(w x, w y, w z, w)` of a row.
    #[inline]
    pub(super) fn points(&self, i: usize) -> impl Iterator<Item = DVec4> + 'a {
        let weight = self.weight;
        let numbers = &self.row(i)[..self.length];
        numbers.chunks_exact(numbers_a_point(weight)).map(move |point| match weight {
            Some(weight) => DVec3::from_slice(point).extend(weight),
            None => DVec4::from_slice(point),
        })
    }
}

/// Where the control net of a piece is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NetSource<'a> {
    /// Kept.
    Kept(PieceNet<'a>),
    /// To be made.
    Spline(SplineNet<'a>),
}

/// The control points of a B-spline that govern a piece, of degree 3 or less in both directions, and how
/// its Bézier points come from them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SplineNet<'a> {
    pub(super) degree: [usize; 2],
    pub(super) points: PieceNet<'a>,
    pub(super) extraction: [&'a Extraction; 2],
    /// How its net by powers comes from them; `None` where its sums are of Bernstein functions.
    pub(super) to_powers: Option<[&'a ToPowers; 2]>,
}

/// The numbers of the longest row.
pub(super) const LONGEST: usize = 4 * Extraction::MOST_POINTS;

/// Room for a net that is made: a row more, as one more number may be read.
#[derive(Clone, Debug)]
pub(crate) struct NetRoom([[f64; LONGEST]; Extraction::MOST_POINTS + 1]);

impl NetRoom {
    /// No net yet.
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self([[0.0; LONGEST]; Extraction::MOST_POINTS + 1])
    }

    /// A row of it.
    #[inline(always)]
    pub(crate) fn row(&mut self, i: usize) -> &mut [f64; LONGEST] {
        &mut self.0[i]
    }
}

impl<'a> SplineNet<'a> {
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

    /// Those control points.
    #[inline(always)]
    pub(crate) fn points(&self) -> PieceNet<'a> {
        self.points
    }

    /// What makes a net by powers of them, along `s` and `t`, if one is wanted.
    #[inline(always)]
    pub(crate) fn by_powers(&self) -> Option<[&'a ToPowers; 2]> {
        self.to_powers
    }

    /// The numbers of a row of control points, and those that follow in memory.
    #[inline(always)]
    pub(crate) fn row(&self, i: usize) -> &'a [f64; LONGEST] {
        let from = &self.points.numbers[i * self.points.stride..];
        debug_assert!(from.len() >= LONGEST, "a chart keeps as many behind its last row");
        from.first_chunk().unwrap_or(&[0.0; LONGEST])
    }

    /// The net that was made there.
    #[inline(always)]
    pub(crate) fn made<'r>(&self, room: &'r NetRoom) -> PieceNet<'r> {
        PieceNet::new(room.0.as_flattened(), LONGEST, self.points.length, self.points.weight)
    }

    /// The Bézier points, with room for those of degree 3: what every other way to make them must agree
    /// with, bit for bit. Where points have three numbers, the fourth is any number.
    pub(super) fn bezier_points(&self) -> [[DVec4; 4]; 4] {
        // Degrees known in advance need no branches.
        match self.degree {
            [3, 3] => self.bezier_points_of([3, 3]),
            [2, 2] => self.bezier_points_of([2, 2]),
            degree => self.bezier_points_of(degree),
        }
    }

    #[inline(always)]
    fn bezier_points_of(&self, [p, q]: [usize; 2]) -> [[DVec4; 4]; 4] {
        let size = self.size();
        let mut net = [[DVec4::ZERO; 4]; 4];
        for (i, to) in net[..=p].iter_mut().enumerate() {
            let row = self.row(i);
            for (j, to) in to[..=q].iter_mut().enumerate() {
                *to = DVec4::from_slice(&row[size * j..size * j + 4]);
            }
        }
        for j in 0..=q {
            let column = [net[0][j], net[1][j], net[2][j], net[3][j]];
            let column = self.extraction[0].apply(p, column);
            for i in 0..=p {
                net[i][j] = column[i];
            }
        }
        for row in &mut net[..=p] {
            *row = self.extraction[1].apply(q, *row);
        }
        net
    }

    /// The same points, row by row, and no others.
    pub(super) fn bezier_net(&self) -> ControlNet {
        let [p, q] = self.degree;
        self.bezier_points()[..=p].iter().flat_map(|row| &row[..=q]).copied().collect()
    }

    /// Makes the Bézier net where it has room.
    pub(crate) fn make<'r>(&self, room: &'r mut NetRoom) -> PieceNet<'r> {
        let ([p, q], size) = (self.degree, self.size());
        for (i, row) in self.bezier_points()[..=p].iter().enumerate() {
            // The last numbers of points of three are those of the next ones.
            for (j, point) in row[..=q].iter().enumerate() {
                room.row(i)[size * j..size * j + 4].copy_from_slice(&point.to_array());
            }
        }
        self.made(room)
    }
}
