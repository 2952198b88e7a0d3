//! Rays into lanes: what [`RayFrame`](crate::math::RayFrame) holds of a ray, for all rays of
//! a packet at once, and the same in f32.

use std::ops::Range;

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8};
use fearless_simd_macros::simd;
use glam::DVec3;

use super::packet::{Packet, PacketBounds};
use super::search::{dot_d, load3, load3d};
use super::{LANES, PACKET};
use crate::intersect::Shot;

/// Origins farther than this from the scene, in its half sizes, are moved nearer for the
/// work in f32: it would otherwise lose digits to the distance.
const NEAR: f64 = 3.0;

/// Ends of rays are taken in f32 with this to spare, in scaled coordinates: some units of f32
/// for distances of a few scene sizes.
pub(super) const END_SPARE: f32 = 1e-5;

/// Squares of lengths from here to its inverse are far from where digits are lost.
const PLAIN: f64 = 1e-100;

/// Takes in up to [`PACKET`] rays as they are given; lanes left over repeat the first.
///
/// The operations and their order are those of the scalar frame, so both have the same bits.
#[simd]
pub(super) fn load<S: Simd, Q: Shot>(simd: S, packet: &mut Packet, shots: &[Q], center: DVec3) {
    packet.count = shots.len();
    for base in (0..PACKET).step_by(LANES) {
        let low = frames(simd, packet, shots, base);
        let high = frames(simd, packet, shots, base + 8);
        narrow(simd, packet, base, (low, high), center);
    }
    // Idle lanes end before they begin.
    packet.z[packet.count..].fill(f64::NEG_INFINITY);
    packet.far_f[packet.count..].fill(f32::NEG_INFINITY);
    packet.leaf = [u32::MAX; PACKET];
    packet.near_border = 0;
    packet.turned = false;
    packet.start_on_roots(shots);
    packet.bounds = bounds(simd, packet, 0..PACKET);
    packet.farthest = farthest(simd, packet);
}

/// What is known of eight rays in f64.
#[derive(Clone, Copy)]
struct Frames<S: Simd> {
    origin: [f64x8<S>; 3],
    axis: [f64x8<S>; 3],
    magnitude: f64x8<S>,
    /// The range of `z`.
    ends: [f64x8<S>; 2],
}

/// Unit directions and the ranges of eight rays.
#[simd]
fn frames<S: Simd, Q: Shot>(simd: S, packet: &mut Packet, shots: &[Q], base: usize) -> Frames<S> {
    let mut rays = [f64x8::splat(simd, 0.0); 8];
    for k in 0..8 {
        let shot = shots.get(base + k).unwrap_or(&shots[0]);
        rays[k] = f64x8::from_slice(simd, &shot.ray().to_array());
    }
    let [ox, oy, oz, dx, dy, dz, t_min, t_max] = transposed(simd, rays);
    let (origin, d) = ([ox, oy, oz], [dx, dy, dz]);

    let (one, least) = (f64x8::splat(simd, 1.0), f64x8::splat(simd, PLAIN));
    let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    let mut length = square.sqrt();
    let inverse = one / length;
    let mut t_from_z = inverse;
    let mut axis = [d[0] * inverse, d[1] * inverse, d[2] * inverse];
    let plain = square.simd_ge(least) & square.simd_lt(one / least);
    if !plain.all_true() {
        let largest = d[0].abs().max(d[1].abs()).max(d[2].abs());
        let v = [d[0] / largest, d[1] / largest, d[2] / largest];
        let rest = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        length = plain.select(length, largest * rest);
        t_from_z = one / length;
        for i in 0..3 {
            axis[i] = plain.select(axis[i], v[i] / rest);
        }
    }

    for i in 0..3 {
        store(simd, &mut packet.origin[i], base, origin[i]);
        store(simd, &mut packet.axis[i], base, axis[i]);
    }
    let ends = [t_min * length, t_max * length];
    let magnitude = ox.abs().max(oy.abs()).max(oz.abs());
    store(simd, &mut packet.t_from_z, base, t_from_z);
    store(simd, &mut packet.z_min, base, ends[0]);
    store(simd, &mut packet.z, base, ends[1]);
    store(simd, &mut packet.z_max, base, ends[1]);
    store(simd, &mut packet.magnitude, base, magnitude);
    Frames { origin, axis, magnitude, ends }
}

/// The normals of the planes through the rays of a packet, as in
/// [`RayFrame`](crate::math::RayFrame): those of packets that meet no leaf are not needed.
#[simd]
pub(super) fn turn<S: Simd>(simd: S, packet: &mut Packet) {
    let one = f64x8::splat(simd, 1.0);
    for base in (0..PACKET).step_by(LANES) {
        let mut normals = [[[one; 2]; 3]; 2];
        for half in 0..2 {
            let [x, y, z] = load3d(simd, &packet.axis, base + 8 * half);
            let sign = one.copysign(z);
            let a = -one / (sign + z);
            let b = x * y * a;
            let first = [one + sign * x * x * a, sign * b, -sign * x];
            let second = [b, sign + y * y * a, -y];
            for i in 0..3 {
                (normals[0][i][half], normals[1][i][half]) = (first[i], second[i]);
            }
        }
        for k in 0..2 {
            for i in 0..3 {
                let [low, high] = normals[k][i];
                store(simd, &mut packet.normals[k][i], base, low);
                store(simd, &mut packet.normals[k][i], base + 8, high);
                store_f(simd, &mut packet.normals_f[k][i], base, (low, high));
            }
        }
    }
    packet.turned = true;
}

#[simd]
fn store<S: Simd>(_simd: S, lanes: &mut [f64; PACKET], base: usize, value: f64x8<S>) {
    value.store_slice(&mut lanes[base..base + 8]);
}

/// Eight vectors as the rows of a matrix, transposed.
#[simd]
pub(super) fn transposed<S: Simd>(simd: S, rows: [f64x8<S>; 8]) -> [f64x8<S>; 8] {
    // Each round brings together rows that are twice as near: 4, 2, 1 apart.
    let mut rows = rows;
    for _ in 0..3 {
        let mut next = rows;
        for k in 0..4 {
            next[2 * k] = simd.zip_low_f64x8(rows[k], rows[k + 4]);
            next[2 * k + 1] = simd.zip_high_f64x8(rows[k], rows[k + 4]);
        }
        rows = next;
    }
    rows
}

/// The f32 coordinates of sixteen rays.
#[simd]
fn narrow<S: Simd>(
    simd: S,
    packet: &mut Packet,
    base: usize,
    halves: (Frames<S>, Frames<S>),
    center: DVec3,
) {
    let scale = f64x8::splat(simd, packet.scale);
    let unscale = f64x8::splat(simd, 1.0 / packet.scale); // of a power of two, so exact
    let zero = f64x8::splat(simd, 0.0);
    let mut origin = [[zero; 3]; 2];
    let mut ends = [[zero; 2]; 2];
    let halves = [halves.0, halves.1];
    for half in 0..2 {
        let Frames { origin: o, axis, ends: z, .. } = halves[half];
        let scaled = [
            (o[0] - f64x8::splat(simd, center.x)) * scale,
            (o[1] - f64x8::splat(simd, center.y)) * scale,
            (o[2] - f64x8::splat(simd, center.z)) * scale,
        ];
        let square = dot_d(scaled, scaled);
        let near = f64x8::splat(simd, NEAR);
        let far_off = square.simd_gt(near * near);
        let mut shift = zero;
        if far_off.any_true() {
            let beyond = square.sqrt() - near + f64x8::splat(simd, 1.0);
            shift = far_off.select(beyond, zero);
        }
        for i in 0..3 {
            origin[half][i] = scaled[i] + shift * axis[i];
        }
        let shift = shift * unscale;
        store(simd, &mut packet.shift, base + 8 * half, shift);
        ends[half] = [(z[0] - shift) * scale, (z[1] - shift) * scale];
    }
    let [low, high] = halves;
    for i in 0..3 {
        store_f(simd, &mut packet.origin_f[i], base, (origin[0][i], origin[1][i]));
        store_f(simd, &mut packet.axis_f[i], base, (low.axis[i], high.axis[i]));
    }
    let sixteen = base..base + LANES;
    let spare = f32x16::splat(simd, END_SPARE);
    let near = simd.narrow_f64x8(ends[0][0], ends[1][0]) - spare;
    let far = simd.narrow_f64x8(ends[0][1], ends[1][1]) + spare;
    near.store_slice(&mut packet.near_f[sixteen.clone()]);
    far.store_slice(&mut packet.far_f[sixteen.clone()]);
    let above = f32x16::splat(simd, 1.0 + f32::EPSILON);
    let magnitude = simd.narrow_f64x8(low.magnitude, high.magnitude) * above;
    magnitude.store_slice(&mut packet.magnitude_f[sixteen]);
}

/// Sixteen numbers as f32.
#[simd]
fn store_f<S: Simd>(
    simd: S,
    lanes: &mut [f32; PACKET],
    base: usize,
    (low, high): (f64x8<S>, f64x8<S>),
) {
    simd.narrow_f64x8(low, high).store_slice(&mut lanes[base..base + LANES]);
}

/// What some lanes' rays have in common. Idle lanes repeat a ray, so they do no harm.
#[simd]
pub(super) fn bounds<S: Simd>(simd: S, packet: &Packet, lanes: Range<usize>) -> PacketBounds {
    let mut bounds = PacketBounds::default();
    let mut axis = load3(simd, &packet.axis_f, lanes.start);
    let mut origin = load3(simd, &packet.origin_f, lanes.start);
    let (mut axis_max, mut origin_max) = (axis, origin);
    for base in lanes.step_by(LANES).skip(1) {
        let a = load3(simd, &packet.axis_f, base);
        let o = load3(simd, &packet.origin_f, base);
        for i in 0..3 {
            (axis[i], axis_max[i]) = (axis[i].min(a[i]), axis_max[i].max(a[i]));
            (origin[i], origin_max[i]) = (origin[i].min(o[i]), origin_max[i].max(o[i]));
        }
    }
    for i in 0..3 {
        bounds.origin_min[i] = origin[i].reduce_min();
        bounds.origin_max[i] = origin_max[i].reduce_max();
        bounds.set_directions(i, axis[i].reduce_min(), axis_max[i].reduce_max());
    }
    bounds
}

/// The largest end of the rays that still look for hits.
#[simd]
pub(super) fn farthest<S: Simd>(simd: S, packet: &Packet) -> f32 {
    let mut most = f32x16::from_slice(simd, &packet.far_f[..LANES]);
    for base in (LANES..PACKET).step_by(LANES) {
        most = most.max(f32x16::from_slice(simd, &packet.far_f[base..base + LANES]));
    }
    most.reduce_max()
}
