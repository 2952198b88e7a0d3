//! Vectors in lanes: a register for each coordinate.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16};
use fearless_simd_macros::simd;

use super::PACKET;

/// A vector of f64 for each ray of a packet, by coordinate.
pub(super) type Lanes3 = [[f64; PACKET]; 3];

/// A vector of f32 for each ray of a packet, by coordinate.
pub(super) type Lanes3f = [[f32; PACKET]; 3];

/// Numbers in f64, a lane each: eight, or as many as a register holds. Code that needs dozens of
/// vectors takes the latter: AVX2 has sixteen registers of four lanes, and of vectors that take two
/// each most would be in memory. (So primary rays were traced 1.1 to 1.2 times as fast with
/// AVX2, 1.6 to 1.9 times with SSE2.)
pub(super) trait Reals<S: Simd>: SimdFloat<S, Element = f64> {}

impl<S: Simd, V: SimdFloat<S, Element = f64>> Reals<S> for V {}

/// Sixteen vectors, from `base` on.
#[simd]
pub(super) fn load3<S: Simd>(simd: S, lanes: &Lanes3f, base: usize) -> [f32x16<S>; 3] {
    [
        f32x16::from_slice(simd, &lanes[0][base..base + 16]),
        f32x16::from_slice(simd, &lanes[1][base..base + 16]),
        f32x16::from_slice(simd, &lanes[2][base..base + 16]),
    ]
}

/// Vectors in f64, from `base` on.
#[simd]
pub(super) fn load3d<S: Simd, V: Reals<S>>(simd: S, lanes: &Lanes3, base: usize) -> [V; 3] {
    [load(simd, &lanes[0], base), load(simd, &lanes[1], base), load(simd, &lanes[2], base)]
}

/// Numbers in f64, from `base` on.
#[inline(always)]
pub(super) fn load<S: Simd, V: Reals<S>>(simd: S, lanes: &[f64; PACKET], base: usize) -> V {
    V::from_slice(simd, &lanes[base..base + V::LEN])
}

/// Vectors times numbers.
#[inline(always)]
pub(super) fn scaled<S: Simd>([x, y, z]: [f32x16<S>; 3], by: f32x16<S>) -> [f32x16<S>; 3] {
    [x * by, y * by, z * by]
}

/// Dot products.
#[inline(always)]
pub(super) fn dot<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> f32x16<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// Cross products.
#[inline(always)]
pub(super) fn cross<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Dot products in f64.
#[inline(always)]
pub(super) fn dot_d<S: Simd, V: Reals<S>>(a: [V; 3], b: [V; 3]) -> V {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// The lanes of a mask as bits.
#[simd]
pub(super) fn lane_bits<S: Simd>(mask: mask32x16<S>) -> u32 {
    mask.to_bitmask() as u32
}

/// Cross products in f64.
#[inline(always)]
pub(super) fn cross_d<S: Simd, V: Reals<S>>(a: [V; 3], b: [V; 3]) -> [V; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The sum of the components' absolute values, which is no less than the length.
#[inline(always)]
pub(super) fn sum_of_sizes<S: Simd, V: Reals<S>>([x, y, z]: [V; 3]) -> V {
    x.abs() + y.abs() + z.abs()
}
