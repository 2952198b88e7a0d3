//! The control net of a piece: as it is kept, or made where it is wanted.
//!
//! Of a dense B-spline surface the Bézier points are up to nine times as many as its own control points.
//! So those are kept, and a piece's net is made of them when the piece is searched ([`Spline`]): always
//! by the same operations, so that whoever makes it has the same numbers.

use glam::{DVec3, DVec4};

use crate::geometry::Extraction;

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

    /// The numbers of a row, for the `i`-th Bernstein function of `s`: four for each point, or three
    /// where all weights are the same, and one more, so that four can be read at every point.
    #[inline(always)]
    pub(crate) fn row(&self, i: usize) -> &'a [f64] {
        &self.numbers[i * self.stride..=i * self.stride + self.length]
    }

    /// The homogeneous control points `(w x, w y, w z, w)` of a row.
    #[inline]
    pub(super) fn points(&self, i: usize) -> impl Iterator<Item = DVec4> + 'a {
        let weight = self.weight;
        let numbers = &self.row(i)[..self.length];
        numbers.chunks_exact(if weight.is_some() { 3 } else { 4 }).map(move |point| match weight {
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
    Spline(Spline<'a>),
}

/// The control points of a B-spline that govern a piece, of degree 3 or less in both directions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spline<'a> {
    pub(super) degree: [usize; 2],
    pub(super) points: PieceNet<'a>,
    pub(super) extraction: [&'a Extraction; 2],
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

impl Default for NetRoom {
    fn default() -> Self {
        Self::new()
    }
}

impl<'a> Spline<'a> {
    /// The degrees in `s` and `t`.
    #[inline(always)]
    pub(crate) fn degree(&self) -> [usize; 2] {
        self.degree
    }

    /// How many numbers a point has.
    #[inline(always)]
    pub(crate) fn size(&self) -> usize {
        if self.points.weight.is_some() { 3 } else { 4 }
    }

    /// The numbers of a row of control points, and those that follow in memory.
    #[inline(always)]
    pub(crate) fn row(&self, i: usize) -> &'a [f64; LONGEST] {
        let from = &self.points.numbers[i * self.points.stride..];
        from.first_chunk().unwrap_or(&[0.0; LONGEST]) // there are as many
    }

    /// What makes Bézier points of them, along `s` (0) or `t` (1).
    #[inline(always)]
    pub(crate) fn along(&self, direction: usize) -> &'a Extraction {
        self.extraction[direction]
    }

    /// The net that was put there.
    #[inline(always)]
    pub(crate) fn net<'r>(&self, room: &'r NetRoom) -> PieceNet<'r> {
        PieceNet::new(room.0.as_flattened(), LONGEST, self.points.length, self.points.weight)
    }

    /// Makes the net, with room for that of degree 3: what every other way to make it must agree with,
    /// bit for bit. Where points have three numbers, the fourth is any number.
    pub(super) fn made(&self) -> [[DVec4; 4]; 4] {
        // For each degree an own loop, without branches.
        match self.degree {
            [3, 3] => self.made_of::<3, 3>(),
            [3, 2] => self.made_of::<3, 2>(),
            [2, 3] => self.made_of::<2, 3>(),
            [2, 2] => self.made_of::<2, 2>(),
            [3, _] => self.made_of::<3, 1>(),
            [_, 3] => self.made_of::<1, 3>(),
            [2, _] => self.made_of::<2, 1>(),
            [_, 2] => self.made_of::<1, 2>(),
            _ => self.made_of::<1, 1>(),
        }
    }

    fn made_of<const P: usize, const Q: usize>(&self) -> [[DVec4; 4]; 4] {
        let mut net = [[DVec4::ZERO; 4]; 4];
        let size = self.size();
        for i in 0..=P {
            let row = self.row(i);
            for j in 0..=Q {
                net[i][j] = DVec4::from_slice(&row[size * j..size * j + 4]);
            }
        }
        for j in 0..=Q {
            let column = [net[0][j], net[1][j], net[2][j], net[3][j]];
            let column = self.extraction[0].apply(P, column);
            for i in 0..=P {
                net[i][j] = column[i];
            }
        }
        for row in &mut net[..=P] {
            *row = self.extraction[1].apply(Q, *row);
        }
        net
    }

    /// Makes the net where it has room.
    pub(crate) fn make<'r>(&self, room: &'r mut NetRoom) -> PieceNet<'r> {
        let ([p, q], size) = (self.degree, self.size());
        for (i, row) in self.made()[..=p].iter().enumerate() {
            // The last numbers of points of three are those of the next ones.
            for (j, point) in row[..=q].iter().enumerate() {
                room.row(i)[size * j..size * j + 4].copy_from_slice(&point.to_array());
            }
        }
        self.net(room)
    }
}
