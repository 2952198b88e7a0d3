//! Sixteen rays against one leaf: the box, and a start for Newton, in f32.

use fearless_simd::{
    Select, Simd, SimdBase, SimdFloat, SimdMask, SimdWiden, f32x16, f64x8, mask32x16,
};
use fearless_simd_macros::simd;

use super::packet::{Lanes3, Lanes3f, Packet};
use crate::patch::{Leaf, OrientedBox, WIDENING};

/// Directions along a box's side are taken for at least this part of a turn: so quotients
/// stay finite, and far larger than any distance that matters.
const LEAST_SLOPE: f32 = 1e-12;

/// Box entries and exits are compared with this to spare, in scaled coordinates: some
/// roundings of f32 at the distances a ray has inside the scene.
const SPARE: f32 = 4e-6;

/// Steps in f32: from the middle of a flat leaf the first leaves about 1e-4 of the leaf, the
/// second the fit's error.
const STEPS: usize = 2;

/// The search may leave the leaf by this much of its half side: as far as its certificate
/// reaches.
const REACH: f32 = 1.0 + 2.0 * WIDENING as f32;

/// Which of sixteen rays meet a leaf's box, and where they cross its middle; what the box's rows
/// say of their directions.
pub(super) struct Crossing<S: Simd> {
    pub(super) met: mask32x16<S>,
    pub(super) x: f32x16<S>,
    pub(super) y: f32x16<S>,
    pub(super) slopes: [f32x16<S>; 3],
}

#[simd]
pub(super) fn load3<S: Simd>(simd: S, lanes: &Lanes3f, base: usize) -> [f32x16<S>; 3] {
    [
        f32x16::from_slice(simd, &lanes[0][base..base + 16]),
        f32x16::from_slice(simd, &lanes[1][base..base + 16]),
        f32x16::from_slice(simd, &lanes[2][base..base + 16]),
    ]
}

#[simd]
pub(super) fn load3d<S: Simd>(simd: S, lanes: &Lanes3, base: usize) -> [f64x8<S>; 3] {
    [
        f64x8::from_slice(simd, &lanes[0][base..base + 8]),
        f64x8::from_slice(simd, &lanes[1][base..base + 8]),
        f64x8::from_slice(simd, &lanes[2][base..base + 8]),
    ]
}

/// The slab test of the oriented box for rays `base … base + 15`.
#[simd]
pub(super) fn cross_box<S: Simd>(
    simd: S,
    oriented: &OrientedBox,
    packet: &Packet,
    base: usize,
) -> Crossing<S> {
    let origin = load3(simd, &packet.origin_f, base);
    let axis = load3(simd, &packet.axis_f, base);
    let near = f32x16::from_slice(simd, &packet.near_f[base..base + 16]);
    let far = f32x16::from_slice(simd, &packet.far_f[base..base + 16]);
    let mut entry = f32x16::splat(simd, f32::MIN);
    let mut exit = f32x16::splat(simd, f32::MAX);
    let (one, least) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, LEAST_SLOPE));
    let mut at = [one; 3];
    let mut along = [one; 3];
    for k in 0..3 {
        let row = oriented.rows[k];
        let (rx, ry, rz) =
            (f32x16::splat(simd, row[0]), f32x16::splat(simd, row[1]), f32x16::splat(simd, row[2]));
        let offset = f32x16::splat(simd, -row[3]);
        at[k] = rx.mul_add(origin[0], ry.mul_add(origin[1], rz.mul_add(origin[2], offset)));
        let slope = rx.mul_add(axis[0], ry.mul_add(axis[1], rz * axis[2]));
        let steep = slope.abs().simd_gt(least);
        along[k] = steep.select(slope, least.copysign(slope));
        let inverse = one / along[k];
        let a = (-one - at[k]) * inverse;
        let b = (one - at[k]) * inverse;
        entry = entry.max(a.min(b));
        exit = exit.min(a.max(b));
    }
    let spare = f32x16::splat(simd, SPARE);
    let met = entry.max(near).simd_le(exit.min(far) + spare);

    // The middle plane, if it is crossed inside the box. What is known of the ray's end must
    // have no say in it: the start would depend on what was searched before.
    let z = (-at[2] / along[2]).max(entry).min(exit);
    let x = z.mul_add(along[0], at[0]).max(-one).min(one);
    let y = z.mul_add(along[1], at[1]).max(-one).min(one);
    Crossing { met, x, y, slopes: along }
}

/// The certificate: which of sixteen rays with these slopes meet the leaf at most once. A point
/// may be as far from a ray as the ray's magnitude times `factor`.
#[simd]
pub(super) fn certify<S: Simd>(
    simd: S,
    leaf: &Leaf,
    [a, b, c]: [f32x16<S>; 3],
    (magnitude, factor): (f32x16<S>, f64),
) -> mask32x16<S> {
    let [by_a, by_b, rounding] = leaf.certificate.turning();
    let (by_a, by_b) = (f32x16::splat(simd, by_a), f32x16::splat(simd, by_b));
    let turned = by_a.mul_add(a.abs(), by_b.mul_add(b.abs(), f32x16::splat(simd, rounding)));
    // Products in this order stay within the range of f32.
    let per_magnitude = leaf.certificate.steep_per_error() * factor as f32;
    let needed = magnitude * f32x16::splat(simd, per_magnitude);
    let steep = c.abs();
    steep.simd_gt(turned) & steep.simd_gt(needed)
}

/// What the search in f32 has found.
#[derive(Clone, Copy)]
pub(super) struct Approximate<V> {
    /// The place, in box coordinates.
    pub(super) x: V,
    pub(super) y: V,
    /// What takes distances from the ray's planes to box coordinates there, or near it.
    pub(super) inverse: [[V; 2]; 2],
}

/// Newton's iteration on the leaf's bicubic approximation.
///
/// The distances of the leaf's middle from the ray's planes are found in f64; what is added
/// to them in f32 is of the size of the leaf, so its rounding is small against the leaf.
#[simd]
pub(super) fn search_fit<S: Simd>(
    simd: S,
    leaf: &Leaf,
    packet: &Packet,
    base: usize,
    start: (f32x16<S>, f32x16<S>),
) -> Approximate<f32x16<S>> {
    let n1 = load3(simd, &packet.normals_f[0], base);
    let n2 = load3(simd, &packet.normals_f[1], base);
    let (e1, e2) = middle_distances(simd, leaf, packet, base);
    let (mut x, mut y) = start;
    let (low, high) = (f32x16::splat(simd, -REACH), f32x16::splat(simd, REACH));
    let mut inverse = [[low; 2]; 2];
    for _ in 0..STEPS {
        let [value, along_x, along_y] = evaluate(simd, leaf.fit(), x, y);
        let (f1, f2) = (dot(n1, value) + e1, dot(n2, value) + e2);
        let (a1, a2) = (dot(n1, along_x), dot(n2, along_x));
        let (b1, b2) = (dot(n1, along_y), dot(n2, along_y));
        let d = f32x16::splat(simd, 1.0) / (a1 * b2 - a2 * b1);
        inverse = [[b2 * d, -b1 * d], [-a2 * d, a1 * d]];
        // `max` and `min` with the bound first turn a NaN into a bound.
        let [[xx, xy], [yx, yy]] = inverse;
        x = (x - xx.mul_add(f1, xy * f2)).max(low).min(high);
        y = (y - yx.mul_add(f1, yy * f2)).max(low).min(high);
    }
    Approximate { x, y, inverse }
}

/// The distances of the leaf's middle from the rays' planes, found in f64.
#[simd]
fn middle_distances<S: Simd>(
    simd: S,
    leaf: &Leaf,
    packet: &Packet,
    base: usize,
) -> (f32x16<S>, f32x16<S>) {
    let (a1, a2) = half_distances(simd, leaf, packet, base);
    let (b1, b2) = half_distances(simd, leaf, packet, base + 8);
    (simd.narrow_f64x8(a1, b1), simd.narrow_f64x8(a2, b2))
}

#[simd]
fn half_distances<S: Simd>(
    simd: S,
    leaf: &Leaf,
    packet: &Packet,
    base: usize,
) -> (f64x8<S>, f64x8<S>) {
    let origin = load3d(simd, &packet.origin, base);
    let offset = [
        f64x8::splat(simd, leaf.middle.x) - origin[0],
        f64x8::splat(simd, leaf.middle.y) - origin[1],
        f64x8::splat(simd, leaf.middle.z) - origin[2],
    ];
    let n1 = load3d(simd, &packet.normals[0], base);
    let n2 = load3d(simd, &packet.normals[1], base);
    (dot_d(n1, offset), dot_d(n2, offset))
}

/// The dot product of vectors in f32, lane by lane.
#[inline(always)]
fn dot<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> f32x16<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// The dot product of vectors in f64, lane by lane.
#[inline(always)]
pub(super) fn dot_d<S: Simd>(a: [f64x8<S>; 3], b: [f64x8<S>; 3]) -> f64x8<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

/// The polynomial and its derivatives by `x` and `y` (Horner).
#[simd]
fn evaluate<S: Simd>(
    simd: S,
    fit: &[[f32; 16]; 3],
    x: f32x16<S>,
    y: f32x16<S>,
) -> [[f32x16<S>; 3]; 3] {
    let zero = f32x16::splat(simd, 0.0);
    let mut result = [[zero; 3]; 3];
    let (x2, x3) = (x + x, x * x * f32x16::splat(simd, 3.0));
    let (y2, y3) = (y + y, y * y * f32x16::splat(simd, 3.0));
    for axis in 0..3 {
        let c = &fit[axis];
        let mut row = [zero; 4];
        let mut slope = [zero; 4];
        for j in 0..4 {
            let (c0, c1) = (f32x16::splat(simd, c[j]), f32x16::splat(simd, c[4 + j]));
            let (c2, c3) = (f32x16::splat(simd, c[8 + j]), f32x16::splat(simd, c[12 + j]));
            row[j] = c3.mul_add(x, c2).mul_add(x, c1).mul_add(x, c0);
            slope[j] = c3.mul_add(x3, c2.mul_add(x2, c1));
        }
        result[0][axis] = row[3].mul_add(y, row[2]).mul_add(y, row[1]).mul_add(y, row[0]);
        result[1][axis] = slope[3].mul_add(y, slope[2]).mul_add(y, slope[1]).mul_add(y, slope[0]);
        result[2][axis] = row[3].mul_add(y3, row[2].mul_add(y2, row[1]));
    }
    result
}

impl<S: Simd> Approximate<f32x16<S>> {
    /// One half of the lanes in f64.
    #[inline(always)]
    pub(super) fn half(&self, half: usize) -> Approximate<f64x8<S>> {
        let wide = |value: f32x16<S>| {
            let (low, high) = value.widen();
            if half == 0 { low } else { high }
        };
        let inverse = self.inverse.map(|row| row.map(wide));
        Approximate { x: wide(self.x), y: wide(self.y), inverse }
    }
}

/// The lanes of a mask as bits.
#[simd]
pub(super) fn bits<S: Simd>(mask: mask32x16<S>) -> u32 {
    mask.to_bitmask() as u32
}
