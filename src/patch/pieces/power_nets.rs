//! Nets by powers, kept or made on demand.

use super::powers::ToPowers;

/// Pieces that are not well conditioned, whose sums stay in Bernstein form: the rows and columns in
/// which they begin, in order.
#[derive(Debug)]
pub(super) struct Others(pub(super) Vec<[u32; 2]>);

impl Others {
    /// Whether they are fewer than half of this many pieces.
    pub(super) fn are_few(&self, count: usize) -> bool {
        2 * self.0.len() < count
    }

    #[inline(always)]
    pub(super) fn contain(&self, first: [u32; 2]) -> bool {
        !self.0.is_empty() && self.0.binary_search(&first).is_ok()
    }
}

/// The power nets of pieces, and the Bézier points of those that are not well conditioned.
#[derive(Debug)]
pub(super) struct KeptPowers {
    /// Net by net, and one more number: so that four can be read at any point.
    pub(super) numbers: Vec<f64>,
    /// The degrees of the nets. They may be less than those of the pieces, unless there are others.
    pub(super) degree: [usize; 2],
    pub(super) others: Others,
}

/// Power nets that are made on demand.
#[derive(Debug)]
pub(super) struct MadePowers {
    /// How they are made, by the row and the column in which pieces begin: the shares of
    /// [`ToPowers`], one piece after another.
    pub(super) along: [Vec<f64>; 2],
    pub(super) degree: [usize; 2],
    pub(super) others: Others,
}

impl KeptPowers {
    /// Leaves out the powers beyond these degrees; `size` numbers belong to a point. There must be
    /// no others: they need their degrees.
    pub(super) fn lower(&mut self, degree: [usize; 2], size: usize) {
        debug_assert!(self.others.0.is_empty());
        let [p, q] = self.degree;
        let (row, lower_row) = (size * (q + 1), size * (degree[1] + 1));
        let nets = self.numbers.chunks_exact((p + 1) * row);
        let rows = nets.flat_map(|net| net.chunks_exact(row).take(degree[0] + 1));
        let mut numbers: Vec<f64> = rows.flat_map(|row| &row[..lower_row]).copied().collect();
        numbers.push(0.0);
        (self.numbers, self.degree) = (numbers, degree);
    }

    pub(super) fn bytes(&self) -> usize {
        size_of::<Self>() + size_of_val(&self.numbers[..]) + size_of_val(&self.others.0[..])
    }
}

impl MadePowers {
    /// How the net of a piece is made, if it is well conditioned.
    #[inline(always)]
    pub(super) fn of(&self, first: [u32; 2]) -> Option<[ToPowers<'_>; 2]> {
        let along = |k: usize| {
            let length = self.degree[k] * (self.degree[k] + 1);
            ToPowers::new(&self.along[k][length * first[k] as usize..][..length])
        };
        let suits = !self.others.contain(first);
        suits.then(|| [along(0), along(1)])
    }

    pub(super) fn bytes(&self) -> usize {
        let along: usize = self.along.iter().map(|some| size_of_val(&some[..])).sum();
        size_of::<Self>() + along + size_of_val(&self.others.0[..])
    }
}
