//! Vectors in lanes: a register for each coordinate.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8, mask32x16};
use fearless_simd_macros::simd;

use super::PACKET;

/// A vector of f64 for each ray of a packet, by coordinate.
pub(super) type Lanes3 = [[f64; PACKET]; 3];

/// A vector of f32 for each ray of a packet, by coordinate.
pub(super) type Lanes3f = [[f32; PACKET]; 3];

/// Sixteen vectors, from `base` on.
#[simd]
pub(super) fn load3<S: Simd>(simd: S, lanes: &Lanes3f, base: usize) -> [f32x16<S>; 3] {
    [
        f32x16::from_slice(simd, &lanes[0][base..base + 16]),
        f32x16::from_slice(simd, &lanes[1][base..base + 16]),
        f32x16::from_slice(simd, &lanes[2][base..base + 16]),
    ]
}

/// Eight vectors in f64, from `base` on.
#[simd]
pub(super) fn load3d<S: Simd>(simd: S, lanes: &Lanes3, base: usize) -> [f64x8<S>; 3] {
    [
        f64x8::from_slice(simd, &lanes[0][base..base + 8]),
        f64x8::from_slice(simd, &lanes[1][base..base + 8]),
        f64x8::from_slice(simd, &lanes[2][base..base + 8]),
    ]
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
pub(super) fn dot_d<S: Simd>(a: [f64x8<S>; 3], b: [f64x8<S>; 3]) -> f64x8<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// The lanes of a mask as bits.
#[simd]
pub(super) fn lane_bits<S: Simd>(mask: mask32x16<S>) -> u32 {
    mask.to_bitmask() as u32
}

/// Cross products in f64.
#[inline(always)]
pub(super) fn cross_d<S: Simd>(a: [f64x8<S>; 3], b: [f64x8<S>; 3]) -> [f64x8<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The sum of the components' absolute values, which is no less than the length.
#[inline(always)]
pub(super) fn sum_of_sizes<S: Simd>([x, y, z]: [f64x8<S>; 3]) -> f64x8<S> {
    x.abs() + y.abs() + z.abs()
}
