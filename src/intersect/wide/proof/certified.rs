//! A leaf's certificate, for sixteen rays.

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16, mask32x16};
use fearless_simd_macros::simd;

use crate::patch::Leaf;

/// Applies the certificate: which of sixteen rays with these slopes meet the leaf at most once. The
/// error bound of a point's distance from a ray is the ray's magnitude times `factor`.
#[simd]
pub(crate) fn certify<S: Simd>(
    simd: S,
    leaf: &Leaf,
    [a, b, c]: [f32x16<S>; 3],
    magnitude: f32x16<S>,
    factor: f64,
) -> mask32x16<S> {
    let [by_a, by_b, rounding] = leaf.certificate.turning();
    let (by_a, by_b) = (f32x16::splat(simd, by_a), f32x16::splat(simd, by_b));
    let turned = by_a.mul_add(a.abs(), by_b.mul_add(b.abs(), f32x16::splat(simd, rounding)));
    // Products in this order stay within the range of f32.
    let per_magnitude = leaf.certificate.steep_per_error() * factor as f32;
    let needed = magnitude * f32x16::splat(simd, per_magnitude);
    let steep = upright(simd, leaf, [a, b, c]).abs();
    steep.simd_gt(turned) & steep.simd_gt(needed)
}

/// How steep sixteen rays are, by the leaf's certificate. Where the certificate holds for the rays,
/// the sign is that of the determinant of the tangents in the rays' planes.
#[inline(always)]
pub(crate) fn upright<S: Simd>(simd: S, leaf: &Leaf, [a, b, c]: [f32x16<S>; 3]) -> f32x16<S> {
    let [lean_a, lean_b] = leaf.certificate.lean();
    b.mul_add(f32x16::splat(simd, lean_b), a.mul_add(f32x16::splat(simd, lean_a), c))
}
