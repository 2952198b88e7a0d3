//! What rounding costs: the unit roundoff and the bounds built on it.

/// The unit roundoff of f64, `u = 2⁻⁵³`: one operation errs by at most this, relatively.
pub const UNIT_ROUNDOFF: f64 = f64::EPSILON / 2.0;

/// The error bound of a computed point of a Bézier piece, per unit of the largest coordinate:
/// `C(p, q) · u` with `C = 4 (p + q + 4)`.
///
/// A basis function of degree `p` is a product of `p` rounded powers and two rounded constants, so
/// it errs by at most `(2p + 2) u`; the sum over `(p + 1)(q + 1)` positive terms adds
/// `(p + q + 2) u`, numerator and denominator double that for a rational piece, and the difference
/// to the ray's origin and the dot product with a plane's normal add the rest (Higham 2002, ch. 3).
/// The worst case would be about `6 (p + q + 4)`; errors of random sign stay below two thirds of
/// it, which is the bound taken here and checked by the tests.
pub const fn residual_factor(degree_u: usize, degree_v: usize) -> f64 {
    4.0 * (degree_u + degree_v + 4) as f64 * UNIT_ROUNDOFF
}

/// The largest f32 not above `x`.
pub(crate) fn f32_below(x: f64) -> f32 {
    -f32_above(-x)
}

/// The smallest f32 not below `x`.
///
/// It has no branch: a branch could not be predicted, and a wrong guess takes as long as a good
/// part of a ray.
#[inline(always)]
pub(crate) fn f32_above(x: f64) -> f32 {
    let nearest = x as f32;
    let bits = nearest.to_bits();
    // One number up: the bits of numbers below zero count downwards.
    let up = 1u32.wrapping_sub(2 * (bits >> 31));
    f32::from_bits(bits.wrapping_add(up.wrapping_mul(u32::from(f64::from(nearest) < x))))
}

/// The largest power of two not above `x`, kept normal: scaling by it is exact.
pub(crate) fn power_of_two_below(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << (f64::MANTISSA_DIGITS - 1);
    f64::from_bits(x.clamp(f64::MIN_POSITIVE, 2f64.powi(1000)).to_bits() & EXPONENT)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_promise_is_what_the_readme_says() {
        assert_eq!(residual_factor(3, 3), 40.0 / 2f64.powi(53));
        assert_eq!(residual_factor(1, 2), 28.0 / 2f64.powi(53));
    }

    #[test]
    fn a_power_of_two_is_not_above_nor_half() {
        for exponent in [-1000, -52, -1, 0, 1, 3, 10, 53, 999] {
            let power = 2f64.powi(exponent);
            for (x, expected) in [
                (power, power),
                (power.next_up(), power),
                (1.5 * power, power),
                (power.next_down(), 0.5 * power),
            ] {
                assert_eq!(power_of_two_below(x), expected, "{x:e}");
            }
        }
        assert_eq!(power_of_two_below(0.0), f64::MIN_POSITIVE);
        assert_eq!(power_of_two_below(f64::MAX), 2f64.powi(1000));
    }

    #[test]
    fn f32_conversions_enclose() {
        let plain = [0.1, 1e30, 1e-30, 1.0, 0.0, 16777217.0, 1e300, 1e-320, 1e-45, f64::INFINITY];
        for x in plain.into_iter().flat_map(|x| [x, -x]) {
            assert!(f64::from(f32_below(x)) <= x && x <= f64::from(f32_above(x)), "{x}");
            assert!(f32_above(x) <= f32_below(x).next_up(), "{x}: not the nearest two");
            let is_number_of_f32 = f64::from(x as f32) == x;
            assert_eq!(f32_above(x) == f32_below(x), is_number_of_f32, "{x}");
        }
        assert!(f32_above(f64::NAN).is_nan() && f32_below(f64::NAN).is_nan());
    }
}
