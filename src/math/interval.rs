//! Closed intervals of f64, rounded outwards.

use std::ops::{Add, Mul, Sub};

/// All numbers from `lo` to `hi`; the result of an operation holds every result of the
/// operation on members.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    /// The lower end.
    pub(crate) lo: f64,
    /// The upper end.
    pub(crate) hi: f64,
}

impl Interval {
    /// The interval that holds nothing, to collect with [`Interval::with`].
    pub(crate) const EMPTY: Self = Self { lo: f64::INFINITY, hi: f64::NEG_INFINITY };

    /// The interval that holds only `x`.
    #[inline(always)]
    pub(crate) fn point(x: f64) -> Self {
        Self { lo: x, hi: x }
    }

    /// The smallest interval that holds all values.
    pub(crate) fn hull(values: impl IntoIterator<Item = f64>) -> Self {
        values.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// The smallest interval that holds this one and `x`.
    #[must_use]
    pub(crate) fn with(self, x: f64) -> Self {
        self.union(Self::point(x))
    }

    /// The smallest interval that holds this one and the other. A NaN end of the other is ignored;
    /// one of this interval stays.
    #[must_use]
    #[inline(always)]
    pub(crate) fn union(self, other: Self) -> Self {
        Self {
            lo: if other.lo < self.lo { other.lo } else { self.lo },
            hi: if other.hi > self.hi { other.hi } else { self.hi },
        }
    }

    /// What both have in common; it is empty where they have nothing in common.
    #[must_use]
    pub(crate) fn intersection(self, other: Self) -> Self {
        Self { lo: self.lo.max(other.lo), hi: self.hi.min(other.hi) }
    }

    /// The smallest interval symmetric about zero that holds this one.
    #[must_use]
    pub(crate) fn symmetric(self) -> Self {
        let reach = self.magnitude();
        Self { lo: -reach, hi: reach }
    }

    /// Half of its width.
    pub(crate) fn radius(self) -> f64 {
        0.5 * (self.hi - self.lo)
    }

    /// Grown by `margin ≥ 0` at both ends.
    #[must_use]
    #[inline(always)]
    pub(crate) fn grown(self, margin: f64) -> Self {
        Self { lo: self.lo - margin, hi: self.hi + margin }.outward()
    }

    /// The largest absolute value of a member.
    #[inline(always)]
    pub(crate) fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// Wider by one to two units in the last place at both ends, or by the least normal number:
    /// what one rounding may have done to them. For intervals whose ends are rounded to nearest.
    #[must_use]
    #[inline(always)]
    pub(crate) fn outward(self) -> Self {
        let more = |x: f64| f64::EPSILON * x.abs() + f64::MIN_POSITIVE;
        Self { lo: self.lo - more(self.lo), hi: self.hi + more(self.hi) }
    }
}

impl Add for Interval {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self { lo: self.lo + other.lo, hi: self.hi + other.hi }.outward()
    }
}

impl Sub for Interval {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self { lo: self.lo - other.hi, hi: self.hi - other.lo }.outward()
    }
}

impl Mul for Interval {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let products =
            [self.lo * other.lo, self.lo * other.hi, self.hi * other.lo, self.hi * other.hi];
        Self::hull(products).outward()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn operations_enclose_those_on_members() {
        let a = Interval { lo: -0.1, hi: 0.3 };
        let b = Interval { lo: 0.7, hi: 1.9 };
        for i in 0..=10 {
            for j in 0..=10 {
                let x = a.lo + (a.hi - a.lo) * f64::from(i) / 10.0;
                let y = b.lo + (b.hi - b.lo) * f64::from(j) / 10.0;
                let cases = [(a + b, x + y), (a - b, x - y), (a * b, x * y)];
                for (interval, value) in cases {
                    assert!(interval.lo <= value && value <= interval.hi);
                }
            }
        }
        assert!((a * b).lo < -0.1 * 1.9 && (a * b).lo > -0.1901);
    }
}
