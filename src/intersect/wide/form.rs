//! The form of a piece's sums: their degrees, how many numbers a point has, and of which functions they are.

use super::lane_net::MOST_DEGREE;
use crate::math::bernstein;
use crate::patch::TensorPatch;

/// The degrees of a piece, whether its weights differ, and whether its sums are made by powers. Pieces
/// of one form can be searched side by side.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Form {
    degree: [u8; 2],
    pub(super) rational: bool,
    pub(super) by_powers: bool,
}

const _: () = assert!(bernstein::MAX_DEGREE <= u8::MAX as usize);

impl Default for Form {
    /// The form of bilinear pieces.
    fn default() -> Self {
        Self { degree: [1, 1], rational: false, by_powers: false }
    }
}

impl Form {
    /// The form of a piece.
    #[inline(always)]
    pub(super) fn of(patch: &TensorPatch) -> Self {
        let degree = patch.degree().map(|degree| degree as u8);
        Self { degree, rational: patch.is_rational(), by_powers: patch.sums_by_powers() }
    }

    /// The form of a piece, if pairs can have it.
    #[inline(always)]
    pub(super) fn of_pairs(patch: &TensorPatch) -> Option<Self> {
        let [p, q] = patch.degree();
        (p.max(q) <= MOST_DEGREE).then(|| Self::of(patch))
    }

    /// The degrees in `s` and `t`.
    #[inline(always)]
    pub(super) fn degree(self) -> [usize; 2] {
        self.degree.map(usize::from)
    }

    /// Numbers in a row of the net.
    #[inline(always)]
    pub(super) fn row_length(self) -> usize {
        (if self.rational { 4 } else { 3 }) * (self.degree()[1] + 1)
    }
}
