//! The pieces of a chart, row by row.

use std::ops::Range;

/// The index of the first piece among all, and the numbers of rows and columns.
#[derive(Clone, Copy, Debug)]
pub(in crate::patch) struct ChartGrid {
    pub(in crate::patch) first: usize,
    pub(in crate::patch) rows: usize,
    pub(in crate::patch) columns: usize,
}

impl ChartGrid {
    /// How many pieces there are.
    pub(in crate::patch) fn count(&self) -> usize {
        self.rows * self.columns
    }

    /// The indices of the pieces among all.
    pub(in crate::patch) fn pieces(&self) -> Range<usize> {
        self.first..self.first + self.count()
    }
}
