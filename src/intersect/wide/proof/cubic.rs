//! Cubics, lane by lane: over a part of their range, and in Bernstein form.

use fearless_simd::{Simd, SimdFloat};

/// The coefficients of a cubic in `(x − m) / h`.
#[inline(always)]
pub(super) fn moved<S: Simd, V: SimdFloat<S, Element = f32>>(
    simd: S,
    [c0, c1, c2, c3]: [V; 4],
    (m, h): (V, V),
) -> [V; 4] {
    let (three, h2) = (V::splat(simd, 3.0), h * h);
    let twice = c2 + c2;
    let thrice = c3 * three;
    [
        c3.mul_add(m, c2).mul_add(m, c1).mul_add(m, c0),
        thrice.mul_add(m, twice).mul_add(m, c1) * h,
        thrice.mul_add(m, c2) * h2,
        c3 * (h2 * h),
    ]
}

/// Converts coefficients of powers of a number within ±1 to Bernstein coefficients.
#[inline(always)]
pub(super) fn bernstein<S: Simd, V: SimdFloat<S, Element = f32>>(
    simd: S,
    [c0, c1, c2, c3]: [V; 4],
) -> [V; 4] {
    let third = V::splat(simd, 1.0 / 3.0);
    let (even, odd) = (c0 + c2, c1 + c3);
    let (inner_even, inner_odd) = (c0 - c2 * third, c3 - c1 * third);
    [even - odd, inner_even + inner_odd, inner_even - inner_odd, even + odd]
}

/// The largest absolute values of the derivatives of `xⁱ yʲ` by `x` and by `y` where neither `|x|`
/// nor `|y|` exceeds `reach`: `i reachⁱ⁺ʲ⁻¹` and `j reachⁱ⁺ʲ⁻¹`.
pub(super) const fn slope_weights(i: usize, j: usize, reach: f32) -> [f32; 2] {
    let mut weights = [i as f32, j as f32];
    let mut power = 1;
    while power < i + j {
        weights = [weights[0] * reach, weights[1] * reach];
        power += 1;
    }
    weights
}
