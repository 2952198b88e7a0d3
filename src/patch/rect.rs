//! Rectangles made by halving the unit square.

/// A rectangle made from the unit square by halving it some number of times in each direction.
///
/// A range is numbered as in a heap: the unit range is 1, the halves of range `k` are `2k` and
/// `2k + 1`. So range `k` has been halved `⌊log₂ k⌋` times, and its ends are exact in f32.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DyadicRect([u32; 2]);

impl DyadicRect {
    /// The unit square.
    pub(super) const UNIT: Self = Self([1; 2]);

    /// How often the square was halved in a direction.
    pub(super) fn halvings(self, direction: usize) -> u32 {
        self.0[direction].ilog2()
    }

    /// The lower or upper half.
    pub(super) fn half(mut self, direction: usize, side: u32) -> Self {
        self.0[direction] = 2 * self.0[direction] + side;
        self
    }

    /// The ends of the range in `s`, then in `t`.
    #[inline]
    pub(crate) fn ranges(self) -> [[f64; 2]; 2] {
        let Self([s, t]) = self;
        [range(s), range(t)]
    }
}

/// The ends of the range with that number.
#[inline(always)]
fn range(number: u32) -> [f64; 2] {
    let halvings = number.ilog2();
    // 2⁻ʰ, by its exponent.
    let side = f64::from_bits(u64::from(1023 - halvings) << 52);
    let from = f64::from(number - (1 << halvings)) * side;
    [from, from + side]
}

impl PartialOrd for DyadicRect {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

/// Ordered by where they begin, in `s`, then in `t`.
impl Ord for DyadicRect {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        let key = |rect: Self| {
            let [s, t] = rect.ranges();
            [s[0], t[0], s[1], t[1]].map(f64::to_bits)
        };
        key(*self).cmp(&key(*other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn halves_are_halves() {
        let rect = DyadicRect::UNIT.half(0, 1).half(0, 0).half(1, 1).half(0, 1);
        assert_eq!(rect.ranges(), [[0.625, 0.75], [0.5, 1.0]]);
        assert_eq!([rect.halvings(0), rect.halvings(1)], [3, 1]);
        assert!(
            DyadicRect::UNIT.half(1, 0) < rect && rect < DyadicRect::UNIT.half(0, 1).half(0, 1)
        );
        let fine = (0..16).fold(DyadicRect::UNIT, |rect, _| rect.half(1, 1));
        assert_eq!(fine.ranges()[1], [1.0 - 2f64.powi(-16), 1.0]);
    }
}
