//! Sixteen boxes against all rays of a packet at once, by bounds that the rays share.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;
use glam::Vec3;

use crate::intersect::tree::nodes::{LANES, LeafBlock, Node};
use crate::intersect::wide::lane_rays::PacketBounds;
use crate::intersect::wide::vectors::lane_bits;

/// Slack for the f32 rounding of slabs at the distances a ray has inside the scene.
const SLAB_SPARE: f32 = 1e-5;

/// A box's row decides only where the least slope of a packet's rays is more than this part of the
/// largest: else the slope may vanish, as far as rounding can tell, and the row would say little.
const LEAST_DECIDED: f32 = 1e-3;

/// Returns where the packet may enter each of a node's boxes, and which boxes it may meet at all.
///
/// For every ray of the packet the entry into a slab is `(plane − o) / d` with `o` and `1 / d` in
/// known ranges; the least value over these ranges bounds the entry of all rays. Coordinates in
/// which the directions differ in sign decide nothing.
#[simd]
pub(super) fn enter<S: Simd>(
    simd: S,
    node: &Node,
    bounds: &PacketBounds,
    farthest: f32,
) -> ([f32; LANES], u32) {
    let mut near = f32x16::splat(simd, f32::MIN);
    let mut far = f32x16::splat(simd, f32::MAX);
    let mut filled = u32::MAX;
    for axis in 0..3 {
        let low = f32x16::from_slice(simd, &node.planes[axis][0]);
        let high = f32x16::from_slice(simd, &node.planes[axis][1]);
        filled &= lane_bits(low.simd_le(high));
        let (a, b) = (
            f32x16::splat(simd, bounds.inverse_min[axis]),
            f32x16::splat(simd, bounds.inverse_max[axis]),
        );
        let (origin_min, origin_max) = (
            f32x16::splat(simd, bounds.origin_min[axis]),
            f32x16::splat(simd, bounds.origin_max[axis]),
        );
        let (to_near, to_far) = match bounds.sign[axis] {
            1 => (low - origin_max, high - origin_min),
            -1 => (origin_min - high, origin_max - low),
            _ => continue,
        };
        near = near.max((to_near * a).min(to_near * b));
        far = far.min((to_far * a).max(to_far * b));
    }
    let spare = f32x16::splat(simd, SLAB_SPARE);
    let met = near.simd_le(far + spare)
        & near.simd_le(f32x16::splat(simd, farthest))
        & far.simd_ge(f32x16::splat(simd, bounds.nearest) - spare);
    (near.into(), lane_bits(met) & filled)
}

/// Returns where the packet may enter each of a block's boxes, and which boxes it may meet at all.
///
/// Box coordinates of a ray are `at + z·slope`, both linear in origin and direction. Over all rays
/// of the packet, each of the two lies within the sum of the absolute values of its terms from that
/// of the middle ray. Rows whose slopes may vanish decide nothing.
#[simd]
pub(super) fn enter_block<S: Simd>(
    simd: S,
    block: &LeafBlock,
    bounds: &PacketBounds,
    farthest: f32,
) -> ([f32; LANES], u32) {
    let (one, zero) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, 0.0));
    let mut near = f32x16::splat(simd, f32::MIN);
    let mut far = f32x16::splat(simd, f32::MAX);
    let (origin, origin_reach) = middle_and_reach(bounds.origin_min, bounds.origin_max);
    let (axis, axis_reach) = middle_and_reach(bounds.axis_min, bounds.axis_max);
    for k in 0..3 {
        let mut at = zero - f32x16::from_slice(simd, &block.rows[4 * k + 3]);
        let (mut at_reach, mut slope, mut slope_reach) = (zero, zero, zero);
        for i in 0..3 {
            let row = f32x16::from_slice(simd, &block.rows[4 * k + i]);
            at = row.mul_add(f32x16::splat(simd, origin[i]), at);
            slope = row.mul_add(f32x16::splat(simd, axis[i]), slope);
            let size = row.abs();
            at_reach = size.mul_add(f32x16::splat(simd, origin_reach[i]), at_reach);
            slope_reach = size.mul_add(f32x16::splat(simd, axis_reach[i]), slope_reach);
        }
        // Turned so that the slope is not negative.
        let at = at * one.copysign(slope);
        let (least, most) = (slope.abs() - slope_reach, slope.abs() + slope_reach);
        let decided = least.simd_gt(f32x16::splat(simd, LEAST_DECIDED) * most);
        let (a, b) = (one / decided.select(least, one), one / most);
        let to_near = zero - one - (at + at_reach);
        let to_far = one - (at - at_reach);
        near = decided.select(near.max((to_near * a).min(to_near * b)), near);
        far = decided.select(far.min((to_far * a).max(to_far * b)), far);
    }
    let spare = f32x16::splat(simd, SLAB_SPARE);
    let met = near.simd_le(far + spare)
        & near.simd_le(f32x16::splat(simd, farthest))
        & far.simd_ge(f32x16::splat(simd, bounds.nearest) - spare);
    (near.into(), lane_bits(met))
}

/// The middle of a range, and how far the range reaches from there, with slack for some roundings.
fn middle_and_reach(min: Vec3, max: Vec3) -> (Vec3, Vec3) {
    let middle = 0.5 * (min + max);
    (middle, 0.5 * (max - min) + 4.0 * f32::EPSILON * min.abs().max(max.abs()))
}
