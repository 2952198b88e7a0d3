//! Rectangles of a piece's parameters: any, and those made by halving the unit square and by
//! cutting off what trims remove.

use glam::DVec2;

/// A closed rectangle of a piece's parameters: from and to in `s`, then in `t`.
pub type StRect = [[f64; 2]; 2];

/// Whether such a rectangle holds a place.
pub(crate) fn holds(rect: StRect, st: DVec2) -> bool {
    (0..2).all(|k| rect[k][0] <= st[k] && st[k] <= rect[k][1])
}

/// A rectangle whose ends are multiples of powers of one half, made from the unit square.
///
/// A range from `k / 2ʰ` to `(k + n) / 2ʰ`, with `n` from 1 to 16, is stored as `2ʰ + k`, as in a
/// heap, and, in the four lowest bits, `n − 1`. Its ends are exact in f32, and `h` is the least.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DyadicRect([u32; 2]);

/// The largest `h` that can be stored.
const MOST_BITS: u32 = 20;

/// The largest `h` of a range that was cut down. Where a curve runs along the side of a part beyond
/// which nothing is kept, all that is left is the margin; as a leaf far narrower than others it
/// would hold no more than the rounding errors of flat rays, and put these in doubt.
const FINEST_CUT: u32 = 8;

/// The largest `n`.
const MOST_STEPS: u32 = 16;

impl DyadicRect {
    /// The unit square.
    pub(in crate::patch) const UNIT: Self = Self([MOST_STEPS; 2]);

    /// How often the unit square can be halved in a direction and still be no smaller.
    pub(in crate::patch) fn halvings(self, direction: usize) -> u32 {
        let Steps { bits, count, .. } = Steps::of(self.0[direction]);
        bits - count.ilog2()
    }

    /// The lower or upper half; of a range that is halved less often than a piece may be.
    pub(in crate::patch) fn half(mut self, direction: usize, side: u32) -> Self {
        let mut steps = Steps::of(self.0[direction]);
        if steps.count.is_multiple_of(2) {
            steps.count /= 2;
        } else {
            steps.bits += 1;
            steps.first *= 2;
        }
        steps.first += side * steps.count;
        self.0[direction] = steps.number();
        self
    }

    /// A rectangle that holds a part of this one, about the smallest that can be stored, but no
    /// narrower than [`FINEST_CUT`] allows.
    pub(in crate::patch) fn cut_down_to(mut self, part: StRect) -> Self {
        for (number, [from, to]) in self.0.iter_mut().zip(part) {
            let steps = Steps::of(*number);
            let end = steps.first + steps.count;
            for bits in steps.bits..=FINEST_CUT {
                let more = bits - steps.bits;
                let scale = f64::from(1 << bits);
                let low = ((from * scale).floor() as u32).max(steps.first << more);
                let high = ((to * scale).ceil() as u32).min(end << more);
                if high <= low || high - low > MOST_STEPS {
                    break; // out of order, or NaN, or too long
                }
                *number = Steps { bits, first: low, count: high - low }.number();
            }
        }
        self
    }

    /// The ends of the range in `s`, then in `t`.
    #[inline]
    pub(crate) fn ranges(self) -> StRect {
        self.0.map(|number| Steps::of(number).range())
    }
}

/// A range of `count` steps of `1 / 2ᵇ`, where `b` is `bits`, after the `first` such steps.
struct Steps {
    bits: u32,
    first: u32,
    count: u32,
}

impl Steps {
    #[inline(always)]
    fn of(number: u32) -> Self {
        let (place, count) = (number / MOST_STEPS, number % MOST_STEPS + 1);
        let bits = place.ilog2();
        Self { bits, first: place - (1 << bits), count }
    }

    /// The one number of the range, with the largest steps.
    fn number(&self) -> u32 {
        debug_assert!(self.bits <= MOST_BITS, "{} bits", self.bits);
        let spare = (self.first | self.count).trailing_zeros().min(self.bits);
        let [first, count] = [self.first, self.count].map(|number| number >> spare);
        ((1 << (self.bits - spare)) + first) * MOST_STEPS + count - 1
    }

    #[inline(always)]
    fn range(&self) -> [f64; 2] {
        // 2⁻ᵇ, by its exponent.
        let step = f64::from_bits(u64::from(1023 - self.bits) << 52);
        [f64::from(self.first) * step, f64::from(self.first + self.count) * step]
    }
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

    #[test]
    fn what_is_cut_down_holds_the_part_closely() {
        let cell = DyadicRect::UNIT.half(0, 1).half(1, 0).half(1, 1);
        for (k, [from, to]) in
            [[0.51, 0.53], [0.5, 1.0], [0.7, 0.7 + 1e-6], [0.6, 0.99]].into_iter().enumerate()
        {
            let cut = cell.cut_down_to([[from, to], [0.25, 0.5]]);
            let [[low, high], t] = cut.ranges();
            assert_eq!(t, [0.25, 0.5], "{k}");
            assert!(0.5 <= low && low <= from && to <= high && high <= 1.0, "{k}: {low} {high}");
            assert!(high - low <= 1.25 * (to - from) + 2f64.powi(-8), "{k}: {low} {high}");
            let [lower, upper] = [0, 1].map(|side| cut.half(0, side).ranges()[0]);
            assert_eq!([lower, upper], [[low, lower[1]], [lower[1], high]], "{k}");
            assert_eq!(lower[1] - low, high - lower[1], "{k}");
            assert_eq!(cut.half(0, 0).halvings(0), cut.halvings(0) + 1, "{k}");
        }
        assert_eq!(cell.cut_down_to([[0.5, 1.0], [0.25, 0.5]]), cell);
        assert_eq!(cell.cut_down_to([[f64::NAN, 1.0], [0.3, 0.2]]), cell);
    }
}
