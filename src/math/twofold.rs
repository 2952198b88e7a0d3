//! Numbers of twice the precision.

/// A number as the sum of two floating-point numbers, of which the second is no more than the
/// rounding error of the first: 106 bits, where f64 has 53.
///
/// Sums, products and quotients err by a few 2⁻¹⁰⁴ of their own size, unless they or their
/// products of low parts leave the range of f64. Infinite and undefined ones stay so. Dekker 1971;
/// Joldes, Muller, Popescu 2017 (bounds).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Twofold {
    high: f64,
    low: f64,
}

impl From<f64> for Twofold {
    fn from(high: f64) -> Self {
        Self { high, low: 0.0 }
    }
}

impl Twofold {
    /// The nearest floating-point number.
    pub(crate) fn rounded(self) -> f64 {
        self.high
    }

    pub(crate) fn plus(self, other: Self) -> Self {
        let (high, high_error) = two_sum(self.high, other.high);
        let (low, low_error) = two_sum(self.low, other.low);
        Self::joined(high, high_error + low).and(low_error)
    }

    pub(crate) fn times(self, other: Self) -> Self {
        let high = self.high * other.high;
        let error = self.high.mul_add(other.high, -high);
        Self::joined(high, error + (self.high * other.low + self.low * other.high))
    }

    pub(crate) fn over(self, divisor: f64) -> Self {
        let high = self.high / divisor;
        let rest = high.mul_add(-divisor, self.high);
        Self::joined(high, (rest + self.low) / divisor)
    }

    /// The sum of a number and one that is far smaller.
    fn and(self, small: f64) -> Self {
        Self::joined(self.high, self.low + small)
    }

    /// The sum of two numbers, of which the second is smaller.
    fn joined(large: f64, small: f64) -> Self {
        let high = large + small;
        if !high.is_finite() {
            return large.into(); // what is left of it would be NaN
        }
        Self { high, low: small - (high - large) }
    }
}

/// The rounded sum of two numbers, and its exact error (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sum(terms: &[f64]) -> Twofold {
        terms.iter().fold(Twofold::default(), |sum, &term| sum.plus(term.into()))
    }

    #[test]
    fn what_cancels_leaves_the_rest() {
        assert_eq!(sum(&[1e16, 1.0, 0.5, -1e16]).rounded(), 1.5);
        assert_eq!(sum(&[1.0, 1e-25, -1.0]).rounded(), 1e-25);
        let third = Twofold::from(1.0).over(3.0);
        assert_eq!(third.rounded(), 1.0 / 3.0);
        let off = third.times(3.0.into()).plus((-1.0).into()).rounded();
        assert!(off.abs() < 1e-31, "{off:e}");
        // (1 + e)(1 − e) = 1 − e², of which a product of f64 keeps nothing.
        let e = f64::powi(2.0, -30);
        let product = Twofold::from(1.0 + e).times((1.0 - e).into());
        assert_eq!(product.plus((-1.0).into()).rounded(), -e * e);
        let squared = Twofold::from(1.0).over(7.0).times(Twofold::from(1.0).over(7.0));
        let off = squared.times(49.0.into()).plus((-1.0).into()).rounded();
        assert!(off.abs() < 1e-30, "{off:e}");
    }

    #[test]
    fn what_leaves_the_range_is_infinite() {
        let large = Twofold::from(1e200);
        assert_eq!(large.times(large).rounded(), f64::INFINITY);
        assert_eq!(large.times(large).plus(1.0.into()).rounded(), f64::INFINITY);
        assert!(large.times(f64::NAN.into()).rounded().is_nan());
    }
}
