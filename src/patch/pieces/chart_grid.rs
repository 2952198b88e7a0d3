//! The pieces of a chart, row by row.

use std::ops::Range;

/// The pieces of a chart, row by row: the index of the first among all pieces, and the numbers of
/// rows and columns.
#[derive(Clone, Copy, Debug)]
pub(in crate::patch) struct Grid {
    pub(in crate::patch) first: usize,
    pub(in crate::patch) rows: usize,
    pub(in crate::patch) columns: usize,
}

impl Grid {
    /// How many pieces there are.
    pub(in crate::patch) fn count(&self) -> usize {
        self.rows * self.columns
    }

    /// The indices of the pieces among all.
    pub(in crate::patch) fn pieces(&self) -> Range<usize> {
        self.first..self.first + self.count()
    }
}
