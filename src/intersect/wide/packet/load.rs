//! Loads rays into the lanes of a packet.

use std::ops::Range;

use fearless_simd::{Simd, SimdBase, SimdMask, f32x16, f64x8};
use fearless_simd_macros::simd;

use super::rays::Packet;
use crate::intersect::Shot;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::PACKET;
use crate::intersect::wide::box_ray::BLUR;
use crate::intersect::wide::frames::{EightRays, ScaledSixteen, perpendicular};
use crate::intersect::wide::lane_rays::PacketBounds;
use crate::intersect::wide::vectors::{load3, load3d};
use crate::intersect::wide::view::BvhView;
use crate::math::bits::set_bits;
use crate::patch::ScaledFrame;

/// Loads up to [`PACKET`] rays as they are given; lanes left over repeat the first.
#[simd]
pub(crate) fn load<S: Simd, Q: Shot>(
    simd: S,
    packet: &mut Packet,
    shots: &[Q],
    view: &BvhView<'_>,
) {
    let scaled = view.tree.frame();
    packet.clear(shots.len());
    for base in (0..PACKET).step_by(LANES) {
        let low = frames(simd, packet, shots, base);
        let high = frames(simd, packet, shots, base + 8);
        narrow(simd, packet, base, &low, &high, scaled);
    }
    packet.scaled.scale = scaled.scale;
    // Idle lanes end before they begin.
    packet.hits.z[packet.count..].fill(f64::NEG_INFINITY);
    packet.scaled.far[packet.count..].fill(f32::NEG_INFINITY);
    let far_off = beyond(simd, packet, view.reach_of_f32);
    if far_off != 0 {
        for k in set_bits(far_off) {
            packet.hits.z[k] = f64::NEG_INFINITY;
        }
        packet.far_off = far_off & packet.all();
        leave_out(packet, far_off);
    }
    packet.rays.planes_known = false;
    packet.starts.take(shots, view.set);
    packet.scaled.bounds = bounds(simd, packet, 0..PACKET);
    packet.scaled.farthest = farthest(simd, packet);
}

/// Converts the rays of a packet, up to their nearest hits, to other scaled coordinates.
#[cold]
#[simd]
pub(super) fn change_to<S: Simd>(simd: S, packet: &mut Packet, scaled: &ScaledFrame, reach: f64) {
    for base in (0..PACKET).step_by(LANES) {
        let halves = [base, base + 8].map(|base| {
            let eight = base..base + 8;
            let of = |lanes: &[f64; PACKET]| f64x8::from_slice(simd, &lanes[eight.clone()]);
            EightRays {
                origin: load3d(simd, &packet.rays.origin, base),
                axis: load3d(simd, &packet.rays.axis, base),
                t_from_z: of(&packet.rays.t_from_z),
                ends: [of(&packet.rays.z_min), of(&packet.hits.z)],
                magnitude: of(&packet.rays.magnitude),
            }
        });
        narrow(simd, packet, base, &halves[0], &halves[1], scaled);
    }
    packet.scaled.scale = scaled.scale;
    let far_off = beyond(simd, packet, reach);
    if far_off != 0 {
        leave_out(packet, far_off);
    }
    packet.scaled.bounds = bounds(simd, packet, 0..PACKET);
    packet.scaled.farthest = farthest(simd, packet);
}

/// The lanes, including idle ones, whose rays come from too far away.
#[simd]
fn beyond<S: Simd>(simd: S, packet: &Packet, reach_of_f32: f64) -> u64 {
    let reach = f64x8::splat(simd, reach_of_f32);
    let mut far_off = 0;
    for base in (0..PACKET).step_by(8) {
        let magnitude = f64x8::from_slice(simd, &packet.rays.magnitude[base..base + 8]);
        far_off |= magnitude.simd_gt(reach).to_bitmask() << base;
    }
    far_off
}

/// Leaves out the rays that come from too far away. In their lanes, and in idle ones that repeat
/// such a ray, numbers may overflow f32, which would spoil what is computed for all lanes.
fn leave_out(packet: &mut Packet, far_off: u64) {
    let other = (!far_off).trailing_zeros() as usize % PACKET;
    for k in set_bits(far_off) {
        packet.scaled.far[k] = f32::NEG_INFINITY;
        packet.scaled.near[k] = packet.scaled.near[other];
        for i in 0..3 {
            packet.scaled.origin[i][k] = packet.scaled.origin[i][other];
            packet.scaled.axis[i][k] = packet.scaled.axis[i][other];
        }
    }
}

/// The frames of eight rays, which are also stored in the packet.
#[inline(always)]
fn frames<S: Simd, Q: Shot>(
    simd: S,
    packet: &mut Packet,
    shots: &[Q],
    base: usize,
) -> EightRays<S> {
    let frames = EightRays::of(simd, shots, base);
    let EightRays { origin, axis, t_from_z, ends, magnitude } = frames;
    for i in 0..3 {
        store(simd, &mut packet.rays.origin[i], base, origin[i]);
        store(simd, &mut packet.rays.axis[i], base, axis[i]);
    }
    store(simd, &mut packet.rays.t_from_z, base, t_from_z);
    store(simd, &mut packet.rays.z_min, base, ends[0]);
    store(simd, &mut packet.hits.z, base, ends[1]);
    store(simd, &mut packet.rays.z_max, base, ends[1]);
    store(simd, &mut packet.rays.magnitude, base, magnitude);
    frames
}

/// Computes the normals of the planes through the rays of a packet, as in
/// [`RayFrame`](crate::math::RayFrame). Packets that meet no leaf do not need them.
#[simd]
pub(crate) fn find_planes<S: Simd>(simd: S, packet: &mut Packet) {
    let one = f64x8::splat(simd, 1.0);
    for base in (0..PACKET).step_by(LANES) {
        let mut normals = [[[one; 2]; 3]; 2];
        for half in 0..2 {
            let axis = load3d(simd, &packet.rays.axis, base + 8 * half);
            let [first, second] = perpendicular(simd, axis);
            for i in 0..3 {
                (normals[0][i][half], normals[1][i][half]) = (first[i], second[i]);
            }
        }
        for k in 0..2 {
            for i in 0..3 {
                let [low, high] = normals[k][i];
                store(simd, &mut packet.rays.normals[k][i], base, low);
                store(simd, &mut packet.rays.normals[k][i], base + 8, high);
                store_f(simd, &mut packet.scaled.normals[k][i], base, low, high);
            }
        }
    }
    packet.rays.planes_known = true;
}

#[simd]
fn store<S: Simd>(_simd: S, lanes: &mut [f64; PACKET], base: usize, value: f64x8<S>) {
    value.store_slice(&mut lanes[base..base + 8]);
}

/// Stores the f32 coordinates of sixteen rays.
#[inline(always)]
fn narrow<S: Simd>(
    simd: S,
    packet: &mut Packet,
    base: usize,
    low: &EightRays<S>,
    high: &EightRays<S>,
    scaled: &ScaledFrame,
) {
    let narrow = ScaledSixteen::new(simd, low, high, scaled);
    let sixteen = base..base + LANES;
    for half in 0..2 {
        store(simd, &mut packet.scaled.shift, base + 8 * half, narrow.shift[half]);
    }
    for i in 0..3 {
        narrow.origin[i].store_slice(&mut packet.scaled.origin[i][sixteen.clone()]);
        narrow.axis[i].store_slice(&mut packet.scaled.axis[i][sixteen.clone()]);
    }
    narrow.ends[0].store_slice(&mut packet.scaled.near[sixteen.clone()]);
    narrow.ends[1].store_slice(&mut packet.scaled.far[sixteen.clone()]);
    narrow.magnitude.store_slice(&mut packet.scaled.magnitude[sixteen]);
}

/// Stores sixteen numbers as f32.
#[simd]
fn store_f<S: Simd>(
    simd: S,
    lanes: &mut [f32; PACKET],
    base: usize,
    low: f64x8<S>,
    high: f64x8<S>,
) {
    simd.narrow_f64x8(low, high).store_slice(&mut lanes[base..base + LANES]);
}

/// Bounds shared by the rays of some lanes. Idle lanes repeat a ray, so they do no harm.
#[inline(always)] // a returned result would be copied, which stalls
pub(super) fn bounds<S: Simd>(simd: S, packet: &Packet, lanes: Range<usize>) -> PacketBounds {
    let mut bounds = PacketBounds::default();
    let mut axis = load3(simd, &packet.scaled.axis, lanes.start);
    let mut origin = load3(simd, &packet.scaled.origin, lanes.start);
    let (mut axis_max, mut origin_max) = (axis, origin);
    let mut nearest =
        f32x16::from_slice(simd, &packet.scaled.near[lanes.start..lanes.start + LANES]);
    for base in lanes.step_by(LANES).skip(1) {
        let a = load3(simd, &packet.scaled.axis, base);
        let o = load3(simd, &packet.scaled.origin, base);
        for i in 0..3 {
            (axis[i], axis_max[i]) = (axis[i].min(a[i]), axis_max[i].max(a[i]));
            (origin[i], origin_max[i]) = (origin[i].min(o[i]), origin_max[i].max(o[i]));
        }
        nearest = nearest.min(f32x16::from_slice(simd, &packet.scaled.near[base..base + LANES]));
    }
    bounds.nearest = nearest.reduce_min();
    for i in 0..3 {
        bounds.origin_min[i] = origin[i].reduce_min() - BLUR;
        bounds.origin_max[i] = origin_max[i].reduce_max() + BLUR;
        bounds.set_directions(i, axis[i].reduce_min(), axis_max[i].reduce_max());
    }
    bounds
}

/// The largest end of the rays that still look for hits.
#[simd]
pub(super) fn farthest<S: Simd>(simd: S, packet: &Packet) -> f32 {
    let mut most = f32x16::from_slice(simd, &packet.scaled.far[..LANES]);
    for base in (LANES..PACKET).step_by(LANES) {
        most = most.max(f32x16::from_slice(simd, &packet.scaled.far[base..base + LANES]));
    }
    most.reduce_max()
}
