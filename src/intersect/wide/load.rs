//! Rays into lanes: what [`RayFrame`](crate::math::RayFrame) holds of a ray, for all rays of
//! a packet at once, and the same in f32.

use std::ops::Range;

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8};
use fearless_simd_macros::simd;
use glam::DVec3;

use super::packet::{Lanes3, Packet, PacketBounds};
use super::search::{dot_d, load3, load3d};
use super::{LANES, PACKET};

/// Origins farther than this from the scene, in its half sizes, are moved nearer for the
/// work in f32: it would otherwise lose digits to the distance.
const NEAR: f64 = 3.0;

/// Ends of rays are taken in f32 with this to spare, in scaled coordinates: some units of f32
/// for distances of a few scene sizes.
pub(super) const END_SPARE: f32 = 1e-5;

/// Squares of lengths from here to its inverse are far from where digits are lost.
const PLAIN: f64 = 1e-100;

/// Finishes a packet whose rays are there as they were given: `axis` holds the directions,
/// `z_min` and `z` the ranges of `t`.
///
/// The operations and their order are those of the scalar frame, so both have the same bits.
#[simd]
pub(super) fn prepare<S: Simd>(simd: S, packet: &mut Packet, center: DVec3) {
    for base in (0..PACKET).step_by(8) {
        frames(simd, packet, base);
    }
    // Idle lanes end before they begin.
    packet.z[packet.count..].fill(f64::NEG_INFINITY);
    for base in (0..PACKET).step_by(LANES) {
        narrow(simd, packet, base, center);
    }
    packet.leaf = [u32::MAX; PACKET];
    packet.near_border = 0;
    packet.bounds = bounds(simd, packet, 0..PACKET);
    packet.farthest = farthest(simd, packet);
}

/// Unit directions, the planes' normals and the ranges of eight rays.
#[simd]
fn frames<S: Simd>(simd: S, packet: &mut Packet, base: usize) {
    let (one, least) = (f64x8::splat(simd, 1.0), f64x8::splat(simd, PLAIN));
    let d = load3d(simd, &packet.axis, base);
    let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    let mut length = square.sqrt();
    let inverse = one / length;
    let mut axis = [d[0] * inverse, d[1] * inverse, d[2] * inverse];
    let plain = square.simd_ge(least) & square.simd_lt(one / least);
    if !plain.all_true() {
        let largest = d[0].abs().max(d[1].abs()).max(d[2].abs());
        let v = [d[0] / largest, d[1] / largest, d[2] / largest];
        let rest = (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt();
        length = plain.select(length, largest * rest);
        for i in 0..3 {
            axis[i] = plain.select(axis[i], v[i] / rest);
        }
    }

    // Two perpendicular vectors, as in `RayFrame`.
    let [x, y, z] = axis;
    let sign = one.copysign(z);
    let a = -one / (sign + z);
    let b = x * y * a;
    let first = [one + sign * x * x * a, sign * b, -sign * x];
    let second = [b, sign + y * y * a, -y];
    for i in 0..3 {
        store(simd, &mut packet.axis, i, base, axis[i]);
        store(simd, &mut packet.normals[0], i, base, first[i]);
        store(simd, &mut packet.normals[1], i, base, second[i]);
    }
    let eight = base..base + 8;
    (one / length).store_slice(&mut packet.t_from_z[eight.clone()]);
    let t_min = f64x8::from_slice(simd, &packet.z_min[eight.clone()]);
    let t_max = f64x8::from_slice(simd, &packet.z[eight.clone()]);
    (t_min * length).store_slice(&mut packet.z_min[eight.clone()]);
    (t_max * length).store_slice(&mut packet.z[eight.clone()]);
    (t_max * length).store_slice(&mut packet.z_max[eight.clone()]);
    let origin = load3d(simd, &packet.origin, base);
    let magnitude = origin[0].abs().max(origin[1].abs()).max(origin[2].abs());
    magnitude.store_slice(&mut packet.magnitude[eight]);
}

#[simd]
fn store<S: Simd>(_simd: S, lanes: &mut Lanes3, axis: usize, base: usize, value: f64x8<S>) {
    value.store_slice(&mut lanes[axis][base..base + 8]);
}

/// The f32 coordinates of sixteen rays.
#[simd]
fn narrow<S: Simd>(simd: S, packet: &mut Packet, base: usize, center: DVec3) {
    let scale = f64x8::splat(simd, packet.scale);
    let zero = f64x8::splat(simd, 0.0);
    let mut origin = [[zero; 3]; 2];
    let mut ends = [[zero; 2]; 2];
    let mut magnitudes = [zero; 2];
    for half in 0..2 {
        let at = base + 8 * half;
        let o = load3d(simd, &packet.origin, at);
        let axis = load3d(simd, &packet.axis, at);
        let scaled = [
            (o[0] - f64x8::splat(simd, center.x)) * scale,
            (o[1] - f64x8::splat(simd, center.y)) * scale,
            (o[2] - f64x8::splat(simd, center.z)) * scale,
        ];
        let distance = dot_d(scaled, scaled).sqrt();
        let near = f64x8::splat(simd, NEAR);
        let beyond = distance - near + f64x8::splat(simd, 1.0);
        let shift = distance.simd_gt(near).select(beyond, zero);
        for i in 0..3 {
            origin[half][i] = scaled[i] + shift * axis[i];
        }
        let shift = shift / scale;
        shift.store_slice(&mut packet.shift[at..at + 8]);
        let z_min = f64x8::from_slice(simd, &packet.z_min[at..at + 8]);
        let z_max = f64x8::from_slice(simd, &packet.z[at..at + 8]);
        ends[half] = [(z_min - shift) * scale, (z_max - shift) * scale];
        magnitudes[half] = f64x8::from_slice(simd, &packet.magnitude[at..at + 8]);
    }
    let sixteen = base..base + LANES;
    for i in 0..3 {
        let narrowed = simd.narrow_f64x8(origin[0][i], origin[1][i]);
        narrowed.store_slice(&mut packet.origin_f[i][sixteen.clone()]);
        narrow_lanes(simd, &packet.axis[i], base)
            .store_slice(&mut packet.axis_f[i][sixteen.clone()]);
        for k in 0..2 {
            let narrowed = narrow_lanes(simd, &packet.normals[k][i], base);
            narrowed.store_slice(&mut packet.normals_f[k][i][sixteen.clone()]);
        }
    }
    let spare = f32x16::splat(simd, END_SPARE);
    let near = simd.narrow_f64x8(ends[0][0], ends[1][0]) - spare;
    let far = simd.narrow_f64x8(ends[0][1], ends[1][1]) + spare;
    near.store_slice(&mut packet.near_f[sixteen.clone()]);
    far.store_slice(&mut packet.far_f[sixteen.clone()]);
    let above = f32x16::splat(simd, 1.0 + f32::EPSILON);
    let magnitude = simd.narrow_f64x8(magnitudes[0], magnitudes[1]) * above;
    magnitude.store_slice(&mut packet.magnitude_f[sixteen]);
}

#[simd]
fn narrow_lanes<S: Simd>(simd: S, lanes: &[f64; PACKET], base: usize) -> f32x16<S> {
    let low = f64x8::from_slice(simd, &lanes[base..base + 8]);
    let high = f64x8::from_slice(simd, &lanes[base + 8..base + 16]);
    simd.narrow_f64x8(low, high)
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
