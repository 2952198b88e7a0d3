//! Rows of control points, as they lie in memory.

use glam::{DVec3, DVec4};

/// How many numbers are kept of a control point: three, and its weight where not all have the same.
#[inline(always)]
pub(super) fn numbers_a_point(common_weight: Option<f64>) -> usize {
    if common_weight.is_some() { 3 } else { 4 }
}

/// Rows of control points, as they lie in memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PieceNet<'a> {
    /// From the first number of the first row on.
    pub(super) numbers: &'a [f64],
    /// The distance in numbers from the beginning of a row to that of the next.
    pub(super) stride: usize,
    /// How many numbers of a row belong to the piece.
    pub(super) length: usize,
    /// The weight of all points, if all have the same: then a point has three numbers, else four.
    pub(super) weight: Option<f64>,
}

impl<'a> PieceNet<'a> {
    /// No points.
    pub(crate) const EMPTY: Self = Self { numbers: &[], stride: 0, length: 0, weight: None };

    /// The net with these numbers, which include one more after the last row.
    pub(super) fn new(
        numbers: &'a [f64],
        stride: usize,
        length: usize,
        weight: Option<f64>,
    ) -> Self {
        Self { numbers, stride, length, weight }
    }

    /// The numbers of a row, which in a Bézier net is that of the `i`-th Bernstein function of `s`:
    /// four for each point, or three where all weights are the same, and one more, so that four can
    /// be read at every point.
    #[inline(always)]
    pub(crate) fn row(&self, i: usize) -> &'a [f64] {
        &self.numbers[i * self.stride..=i * self.stride + self.length]
    }

    /// Whether each row directly follows the one before.
    #[inline(always)]
    pub(crate) fn is_without_gaps(&self) -> bool {
        self.stride == self.length
    }

    /// This many numbers from the beginning of a row on.
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
