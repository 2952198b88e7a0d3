//! The form of a piece: the degrees of its sums, how many numbers a point has, of which functions
//! they are, and how its leaves are approximated.

use crate::math::bernstein;
use crate::patch::{MOST_DEGREE_BY_POWERS, TensorPatch};

/// The degrees of a piece's sums, whether its weights differ, whether its sums are made by powers,
/// and whether its leaves are approximated by quotients. Pieces of one form can be searched side by
/// side. Their own degrees, and so their error bounds, may differ: sums of a piece whose degree was
/// elevated have the degree from before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Form {
    degree: [u8; 2],
    pub rational: bool,
    pub by_powers: bool,
    pub by_quotients: bool,
}

/// The nets of pieces of higher degrees are too large to hold eight of them side by side.
pub(super) const MOST_DEGREE: usize = MOST_DEGREE_BY_POWERS;

const _: () = assert!(bernstein::MAX_DEGREE <= u8::MAX as usize);

impl Default for Form {
    /// The form of bilinear pieces.
    fn default() -> Self {
        Self { degree: [1, 1], rational: false, by_powers: false, by_quotients: false }
    }
}

impl Form {
    /// The form of a piece.
    #[inline(always)]
    pub(crate) fn of(patch: &TensorPatch) -> Self {
        let degree = patch.sums_degree().map(|degree| degree as u8);
        Self {
            degree,
            rational: patch.is_rational(),
            by_powers: patch.sums_by_powers(),
            by_quotients: patch.has_quotient_leaves(),
        }
    }

    /// The form of a piece, if pairs can have it.
    #[inline(always)]
    pub(crate) fn of_pairs(patch: &TensorPatch) -> Option<Self> {
        let [p, q] = patch.sums_degree();
        (p.max(q) <= MOST_DEGREE).then(|| Self::of(patch))
    }

    /// The degrees in `s` and `t`.
    #[inline(always)]
    pub(crate) fn degree(self) -> [usize; 2] {
        self.degree.map(usize::from)
    }

    /// The larger of both degrees.
    #[inline(always)]
    pub(crate) fn highest_degree(self) -> usize {
        let [p, q] = self.degree();
        p.max(q)
    }

    /// Numbers in a row of the net.
    #[inline(always)]
    pub(super) fn row_length(self) -> usize {
        (if self.rational { 4 } else { 3 }) * (self.degree()[1] + 1)
    }
}

/// Evaluates an expression in which the numbers of a form are constants, so that its loops are
/// unrolled: the degrees `$p` and `$q` of the most common forms, else zeros, which stand for any
/// degrees; and `$c`, how many numbers a point has, four for rational pieces, else three.
macro_rules! with_degrees {
    (@of $($name:ident = $number:literal),*; $value:expr) => {{
        $(const $name: usize = $number;)*
        $value
    }};
    ($form:expr, |$p:ident, $q:ident, $c:ident| $value:expr) => {
        match ($form.degree(), $form.rational) {
            ([3, 3], true) => with_degrees!(@of $p = 3, $q = 3, $c = 4; $value),
            ([3, 3], false) => with_degrees!(@of $p = 3, $q = 3, $c = 3; $value),
            ([2, 2], true) => with_degrees!(@of $p = 2, $q = 2, $c = 4; $value),
            ([2, 2], false) => with_degrees!(@of $p = 2, $q = 2, $c = 3; $value),
            ([2, 1], true) => with_degrees!(@of $p = 2, $q = 1, $c = 4; $value),
            ([1, 2], true) => with_degrees!(@of $p = 1, $q = 2, $c = 4; $value),
            ([1, 1], false) => with_degrees!(@of $p = 1, $q = 1, $c = 3; $value),
            (_, true) => with_degrees!(@of $p = 0, $q = 0, $c = 4; $value),
            (_, false) => with_degrees!(@of $p = 0, $q = 0, $c = 3; $value),
        }
    };
}

/// The same for `$c` alone.
macro_rules! with_numbers {
    ($form:expr, |$c:ident| $value:expr) => {
        if $form.rational {
            const $c: usize = 4;
            $value
        } else {
            const $c: usize = 3;
            $value
        }
    };
}

pub(crate) use {with_degrees, with_numbers};
