//! A packet's way through the wide hierarchy.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x16};
use fearless_simd_macros::simd;

use super::finish::{Target, finish};
use super::load::{farthest, prepare};
use super::packet::{Packet, PacketBounds};
use super::search::{bits, certify, cross_box, search_fit, widen};
use super::tree::{Child, WideNode, WideTree};
use super::{LANES, PACKET};
use crate::intersect::Statistics;
use crate::patch::PatchSet;

/// Scratch memory and results of tracing packets.
#[derive(Debug, Default)]
pub(in crate::intersect) struct Work {
    stack: Vec<(f32, Child)>,
    /// Rays and leaves the scalar search must look at.
    pub(in crate::intersect) rest: Vec<(usize, u32)>,
    /// One bit for each ray that has leaves left.
    pub(in crate::intersect) rest_rays: u64,
}

/// Finds the nearest certified hit of every ray of a packet that was just loaded; `work.rest` names the pairs of
/// ray and leaf that could not be certified or decided, which may hold nearer ones.
#[simd]
pub(in crate::intersect) fn trace<S: Simd>(
    simd: S,
    tree: &WideTree,
    set: &PatchSet,
    packet: &mut Packet,
    work: &mut Work,
    statistics: &mut Statistics,
) {
    packet.scale = tree.scale;
    prepare(simd, packet, tree.center);
    work.rest.clear();
    work.rest_rays = 0;
    work.stack.clear();
    if tree.nodes.is_empty() {
        return;
    }
    work.stack.push((f32::NEG_INFINITY, Child::Node(0)));
    while let Some((entry, child)) = work.stack.pop() {
        if entry > packet.farthest {
            continue;
        }
        match child {
            Child::Leaf(leaf) => search(simd, tree, set, leaf, packet, work, statistics),
            Child::Node(index) => {
                statistics.nodes += 1;
                let node = &tree.nodes[index as usize];
                let first = work.stack.len();
                let (entries, mut met) = enter(simd, node, &packet.bounds, packet.farthest);
                while met != 0 {
                    let k = met.trailing_zeros() as usize;
                    work.stack.push((entries[k], node.child(k)));
                    met &= met - 1;
                }
                // The nearest child is popped first.
                work.stack[first..].sort_unstable_by(|a, b| b.0.total_cmp(&a.0));
            }
        }
    }
}

/// Where the packet may enter each of a node's boxes, and which it may meet at all.
///
/// For every ray of the packet the entry into a slab is `(plane − o) / d` with `o` and
/// `1 / d` in known ranges; its least value over them bounds the entry of all. Coordinates
/// in which the directions differ in sign decide nothing.
#[simd]
fn enter<S: Simd>(
    simd: S,
    node: &WideNode,
    bounds: &PacketBounds,
    farthest: f32,
) -> ([f32; LANES], u32) {
    let mut near = f32x16::splat(simd, f32::MIN);
    let mut far = f32x16::splat(simd, f32::MAX);
    for axis in 0..3 {
        let low = f32x16::from_slice(simd, &node.min[axis]);
        let high = f32x16::from_slice(simd, &node.max[axis]);
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
    // The spare covers f32 rounding of slabs at the distances a ray has inside the scene.
    let spare = f32x16::splat(simd, 1e-5);
    let met = near.simd_le(far + spare)
        & near.simd_le(f32x16::splat(simd, farthest))
        & far.simd_ge(-spare);
    (near.into(), bits(met) & node.filled)
}

/// One leaf against all rays of the packet.
#[simd]
fn search<S: Simd>(
    simd: S,
    tree: &WideTree,
    set: &PatchSet,
    index: u32,
    packet: &mut Packet,
    work: &mut Work,
    statistics: &mut Statistics,
) {
    let record = &tree.records[index as usize];
    // The boxes of most leaves are missed by most rays: their data are only touched when they
    // are needed.
    let mut target = None;
    let mut found = false;
    for base in (0..packet.count.min(PACKET)).step_by(LANES) {
        let crossing = cross_box(simd, record, packet, base);
        let met = bits(crossing.met);
        if met == 0 {
            continue;
        }
        let target = target.get_or_insert_with(|| Target::new(set, index));
        let patch = &target.piece.patch;
        let factor = patch.residual_factor();
        statistics.leaf_tests += u64::from(met.count_ones());

        // The certificate, lane by lane.
        let (single, cosine) = certify(simd, record, packet, base);
        let magnitude = f32x16::from_slice(simd, &packet.magnitude_f[base..base + LANES])
            .max(f32x16::splat(simd, patch.magnitude() as f32));
        let per_error = f32x16::splat(simd, record.cosine_per_error * factor as f32);
        let certain = met & bits(single & cosine.simd_gt(magnitude * per_error));
        let mut rest = met & !certain;
        if certain != 0 {
            let start = (crossing.x, crossing.y);
            let (x, y) = search_fit(simd, record, packet, base, start);
            let (xs, ys) = (widen(x), widen(y));
            for half in 0..2 {
                let lanes = u64::from(certain >> (8 * half)) & 0xff;
                if lanes == 0 {
                    continue;
                }
                let wanted = fearless_simd::mask64x8::from_bitmask(simd, lanes);
                let at = base + 8 * half;
                let done = finish(simd, target, packet, at, wanted, (xs[half], ys[half]));
                rest |= (done.left as u32) << (8 * half);
                found |= done.found;
                statistics.newton_iterations += u64::from(done.steps);
            }
        }
        work.rest_rays |= u64::from(rest) << base;
        while rest != 0 {
            work.rest.push((base + rest.trailing_zeros() as usize, index));
            rest &= rest - 1;
        }
    }
    if found {
        packet.farthest = farthest(simd, packet);
    }
}
