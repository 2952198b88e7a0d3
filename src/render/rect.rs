//! Rectangles of pixels.

use std::fmt;

use thiserror::Error;

/// A half-open rectangle of pixels: `x0 ≤ x < x1`, `y0 ≤ y < y1`, y pointing down.
///
/// # Invariants, checked once in [`PixelRect::new`]
/// - neither side is empty: `x0 < x1` and `y0 < y1`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    min: [u32; 2],
    max: [u32; 2],
}

/// Why numbers cannot be a rectangle of pixels.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RectError {
    /// A side has no pixels.
    #[error("{},{},{},{} holds no pixels: X0,Y0,X1,Y1 needs X0 < X1 and Y0 < Y1", .0[0], .0[1], .0[2], .0[3])]
    Empty([u32; 4]),
}

impl PixelRect {
    /// The pixel at the corner of every picture.
    pub(super) const FIRST: Self = Self { min: [0, 0], max: [1, 1] };

    /// The pixels from `(x0, y0)` up to, not including, `(x1, y1)`.
    ///
    /// # Errors
    /// When a side is empty.
    pub fn new([x0, y0]: [u32; 2], [x1, y1]: [u32; 2]) -> Result<Self, RectError> {
        if x0 >= x1 || y0 >= y1 {
            return Err(RectError::Empty([x0, y0, x1, y1]));
        }
        Ok(Self { min: [x0, y0], max: [x1, y1] })
    }

    /// The first column and row.
    pub fn min(&self) -> [u32; 2] {
        self.min
    }

    /// The first column and row no longer inside.
    pub fn max(&self) -> [u32; 2] {
        self.max
    }

    /// Pixels in a row.
    pub fn width(&self) -> u32 {
        self.max[0] - self.min[0]
    }

    /// Pixels in a column.
    pub fn height(&self) -> u32 {
        self.max[1] - self.min[1]
    }

    /// Pixels in all.
    pub fn area(&self) -> u64 {
        u64::from(self.width()) * u64::from(self.height())
    }

    /// Whether a pixel lies inside.
    pub fn contains(&self, [x, y]: [u32; 2]) -> bool {
        self.min[0] <= x && x < self.max[0] && self.min[1] <= y && y < self.max[1]
    }

    /// The pixels of both; `None` when they share none.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Option<Self> {
        let min = [self.min[0].max(other.min[0]), self.min[1].max(other.min[1])];
        let max = [self.max[0].min(other.max[0]), self.max[1].min(other.max[1])];
        Self::new(min, max).ok()
    }

    /// The place of a pixel among those of the rectangle, row after row. The pixel must
    /// lie inside.
    pub(super) fn index_of(&self, [x, y]: [u32; 2]) -> usize {
        let (column, row) = ((x - self.min[0]) as usize, (y - self.min[1]) as usize);
        row * self.width() as usize + column
    }
}

impl fmt::Display for PixelRect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{},{},{},{}", self.min[0], self.min[1], self.max[0], self.max[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn has_pixels_and_tells_which() {
        let rect = PixelRect::new([8, 16], [24, 20]).unwrap();
        assert_eq!((rect.min(), rect.max()), ([8, 16], [24, 20]));
        assert_eq!((rect.width(), rect.height(), rect.area()), (16, 4, 64));
        assert_eq!(rect.to_string(), "8,16,24,20");
        let empty = PixelRect::new([4, 0], [4, 9]);
        assert_eq!(empty, Err(RectError::Empty([4, 0, 4, 9])));
        let message = empty.unwrap_err().to_string();
        assert_eq!(message, "4,0,4,9 holds no pixels: X0,Y0,X1,Y1 needs X0 < X1 and Y0 < Y1");
    }

    #[test]
    fn intersects_and_counts() {
        let a = PixelRect::new([0, 0], [4, 4]).unwrap();
        let b = PixelRect::new([2, 3], [9, 9]).unwrap();
        assert_eq!(a.intersection(&b), PixelRect::new([2, 3], [4, 4]).ok());
        assert_eq!(a.intersection(&PixelRect::new([4, 0], [5, 4]).unwrap()), None);
        assert!(b.contains([2, 3]) && !b.contains([9, 3]));
        assert_eq!(b.index_of([3, 4]), 8);
    }
}
