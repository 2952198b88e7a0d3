//! Sixteen rays against one leaf's box.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16, mask32x16};

use crate::intersect::wide::box_ray::{BOX_SPARE, LEAST_SLOPE};
use crate::intersect::wide::lane_rays::ScaledRays;
use crate::intersect::wide::vectors::load3;
use crate::patch::OrientedBox;

/// Which of sixteen rays meet a leaf's box, where they cross its middle, and the slopes of their
/// directions by the box's rows.
pub(crate) struct BoxPassage<S: Simd> {
    /// The first of the rays in their packet.
    pub base: usize,
    pub met: mask32x16<S>,
    pub x: f32x16<S>,
    pub y: f32x16<S>,
    /// Where the rays enter and leave the box, whatever part of them counts.
    pub(super) entry: f32x16<S>,
    pub(super) exit: f32x16<S>,
    pub slopes: [f32x16<S>; 3],
}

/// The slab test of the oriented box for rays `base … base + 15`.
#[inline(always)] // in the innermost loop
pub(crate) fn pass_box<S: Simd>(
    simd: S,
    oriented: &OrientedBox,
    scaled: &ScaledRays,
    base: usize,
) -> BoxPassage<S> {
    let origin = load3(simd, &scaled.origin, base);
    let axis = load3(simd, &scaled.axis, base);
    let near = f32x16::from_slice(simd, &scaled.near[base..base + 16]);
    let far = f32x16::from_slice(simd, &scaled.far[base..base + 16]);
    let mut entry = f32x16::splat(simd, f32::MIN);
    let mut exit = f32x16::splat(simd, f32::MAX);
    let (one, least) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, LEAST_SLOPE));
    let mut at = [one; 3];
    let mut along = [one; 3];
    let mut inverse = one;
    for k in 0..3 {
        let row = oriented.rows[k];
        let (rx, ry, rz) =
            (f32x16::splat(simd, row[0]), f32x16::splat(simd, row[1]), f32x16::splat(simd, row[2]));
        let offset = f32x16::splat(simd, -row[3]);
        at[k] = rx.mul_add(origin[0], ry.mul_add(origin[1], rz.mul_add(origin[2], offset)));
        let slope = rx.mul_add(axis[0], ry.mul_add(axis[1], rz * axis[2]));
        let steep = slope.abs().simd_gt(least);
        along[k] = steep.select(slope, least.copysign(slope));
        inverse = one / along[k];
        let (middle, half) = (-at[k] * inverse, inverse.abs());
        entry = entry.max(middle - half);
        exit = exit.min(middle + half);
    }
    let spare = f32x16::splat(simd, BOX_SPARE);
    let met = entry.max(near).simd_le(exit.min(far) + spare);

    // Where the middle plane is crossed, if inside the box. What is known of the ray's end must not
    // influence this: the start would depend on what was searched before.
    let z = (-at[2] * inverse).max(entry).min(exit);
    let x = z.mul_add(along[0], at[0]).max(-one).min(one);
    let y = z.mul_add(along[1], at[1]).max(-one).min(one);
    BoxPassage { base, met, x, y, entry, exit, slopes: along }
}
