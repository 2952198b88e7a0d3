//! Takes a packet through the wide hierarchy.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;
use glam::Vec3;

use super::apart::{ALL, Apart};
use super::doubts::{Doubts, settle};
use super::leaf::search_leaf;
use super::load::{change_to, load};
use super::outline::{Outline, outline};
use super::rays::{Packet, PacketBounds};
use super::read_ahead::{Ahead, Moment};
use crate::intersect::hit::StartIn;
use crate::intersect::tree::nodes::{Child, ChildCode, LANES, LeafBlock, Node, Region};
use crate::intersect::wide::PACKET;
use crate::intersect::wide::box_ray::{first_entered, push_in_order};
use crate::intersect::wide::proof::lanes::Parts;
use crate::intersect::wide::search::distances::LaneDistances;
use crate::intersect::wide::surface::spline_net::RecentNets;
use crate::intersect::wide::vectors::lane_bits;
use crate::intersect::wide::view::BvhView;
use crate::intersect::{Shot, Statistics};
use crate::math::bits::set_bits;

/// Where the first ray may enter a child, the child, and the rays that may enter it.
type Visit = (f32, ChildCode, u64);

/// Slack for the f32 rounding of slabs at the distances a ray has inside the scene.
const SLAB_SPARE: f32 = 1e-5;

/// A box's row decides only where the least slope of a packet's rays is more than this part of the
/// largest: else the slope may vanish, as far as rounding can tell, and the row would say little.
const LEAST_DECIDED: f32 = 1e-3;

/// Scratch memory and results of tracing packets.
#[derive(Debug, Default)]
pub(crate) struct Work {
    stack: Vec<Visit>,
    /// Rays and leaves that the scalar search must examine.
    pub undecided: Vec<(usize, u32)>,
    apart: Apart,
    /// The distances of sixteen rays from the leaf that is searched.
    pub(super) distances: LaneDistances,
    /// Rays and leaves that need a closer look, and parts of such leaves.
    pub(super) doubts: Box<Doubts>,
    pub(super) parts: Parts,
    pub(super) nets: RecentNets,
    /// One bit for each ray that has leaves left.
    pub undecided_rays: u64,
    pub statistics: Statistics,
}

impl Work {
    /// Leaves a leaf to the scalar search, for those of sixteen rays whose bit is set in `lanes`.
    #[inline(always)]
    pub(super) fn leave(&mut self, base: usize, lanes: u32, leaf: u32) {
        self.undecided_rays |= u64::from(lanes) << base;
        self.undecided.extend(set_bits(lanes).map(|lane| (base + lane, leaf)));
    }
}

/// Finds the nearest certified hit of each of up to [`PACKET`] rays, or any hit if that is all they
/// ask for (`packet.any`). `work.undecided` lists the pairs of ray and leaf that could not be
/// certified or decided, which may hold nearer hits. The rays `ahead` are prefetched on the way.
#[simd]
pub(crate) fn trace<S: Simd, Q: Shot>(
    simd: S,
    view: &BvhView<'_>,
    (shots, ahead): (&[Q], &mut Ahead<'_, Q>),
    packet: &mut Packet,
    work: &mut Work,
) {
    let tree = view.tree;
    work.undecided.clear();
    work.doubts.clear();
    work.undecided_rays = 0;
    // If the packet before has met something, this one probably does, too; rays that leave a hit
    // meet the box of its leaf.
    let leaves_hits = shots.first().is_some_and(|shot| shot.start_in(view.set).is_some());
    if packet.met() == 0 && !leaves_hits && meets_nothing(simd, view, shots, work) {
        return packet.clear(shots.len());
    }
    load(simd, packet, shots, view);
    work.apart.set(simd, packet, tree.regions[0].leaf_width);
    work.stack.clear();
    work.stack.extend(tree.root().map(|root| (f32::NEG_INFINITY, root, ALL)));
    while let Some((entry, code, rays)) = work.stack.pop() {
        if entry > packet.scaled.farthest {
            continue;
        }
        ahead.ask(Moment::Box);
        match code.child() {
            Child::Block(index) => {
                let block = (index, rays, &mut *ahead);
                search_block(simd, view, block, packet, work);
            }
            Child::Node(index) => {
                work.statistics.nodes += 1;
                let node = &tree.nodes[index as usize];
                let (entries, met) =
                    enter(simd, node, &packet.scaled.bounds, packet.scaled.farthest);
                let meeting = work.apart.meeting(simd, packet, (node, met), rays);
                let kept = (0..LANES).map(|k| u32::from(meeting[k] != 0) << k).sum::<u32>();
                let visit = |k: usize| (entries[k], node.child[k], meeting[k]);
                push_in_order(simd, &mut work.stack, &entries, met & kept, visit);
            }
            Child::Region(index, way) => {
                let (region, next) = tree.enter(index, way);
                work.stack.extend(next.map(|code| (f32::NEG_INFINITY, code, rays)));
                change_region(simd, view, region, packet, work);
            }
        }
    }
    if !work.doubts.is_empty() {
        settle(simd, view, packet, work, 1);
    }
}

/// Goes on in the coordinates of another region; the pairs put aside, in those of the last, are
/// settled first.
#[cold]
#[simd]
fn change_region<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    region: &Region,
    packet: &mut Packet,
    work: &mut Work,
) {
    settle(simd, view, packet, work, 1);
    change_to(simd, packet, &region.frame, view.reach_of_f32);
    work.apart.set(simd, packet, region.leaf_width);
}

/// Whether the outline of some rays is enough to see that they meet no leaf.
#[simd]
fn meets_nothing<S: Simd, Q: Shot>(
    simd: S,
    view: &BvhView<'_>,
    shots: &[Q],
    work: &mut Work,
) -> bool {
    let tree = view.tree;
    let (bounds, farthest) = match outline(simd, shots, view) {
        Outline::Unknown => return false,
        Outline::Beside => return true,
        Outline::Bounds(bounds, farthest) => (bounds, farthest),
    };
    work.stack.clear();
    work.stack.extend(tree.root().map(|root| (f32::NEG_INFINITY, root, ALL)));
    while let Some((_, code, _)) = work.stack.pop() {
        match code.child() {
            Child::Block(index) => {
                let block = &tree.blocks[index as usize];
                let (_, met) = enter_block(simd, block, &bounds, farthest);
                if tree.leaves(index).of(met) != 0 {
                    return false;
                }
            }
            Child::Node(index) => {
                work.statistics.nodes += 1;
                let node = &tree.nodes[index as usize];
                let (_, met) = enter(simd, node, &bounds, farthest);
                for k in set_bits(met) {
                    work.stack.push((0.0, node.child[k], ALL));
                }
            }
            // This needs a closer look.
            Child::Region(..) => return false,
        }
    }
    true
}

/// Returns where the packet may enter each of a node's boxes, and which boxes it may meet at all.
///
/// For every ray of the packet the entry into a slab is `(plane − o) / d` with `o` and `1 / d` in
/// known ranges; the least value over these ranges bounds the entry of all rays. Coordinates in
/// which the directions differ in sign decide nothing.
#[simd]
fn enter<S: Simd>(
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

/// Searches the leaves of a block, near ones first.
#[simd]
fn search_block<S: Simd, Q>(
    simd: S,
    view: &BvhView<'_>,
    (index, rays, ahead): (u32, u64, &mut Ahead<'_, Q>),
    packet: &mut Packet,
    work: &mut Work,
) {
    let block = &view.tree.blocks[index as usize];
    let leaves = view.tree.leaves(index);
    let (entries, met) = enter_block(simd, block, &packet.scaled.bounds, packet.scaled.farthest);
    let apart = work.apart.leaves(simd, (block, leaves.of(met)), packet, rays);
    let two = apart | apart >> 32;
    let mut met = (two | two >> 16) as u32 & 0xffff;
    view.prefetch_leaves(leaves.first, met);
    while met != 0 {
        let nearest = first_entered(&entries, met);
        met &= !(1 << nearest);
        if entries[nearest] > packet.scaled.farthest {
            return;
        }
        let oriented = block.oriented(nearest);
        let mut groups = 0;
        for k in 0..PACKET / LANES {
            groups |= ((apart >> (LANES * k + nearest)) as u32 & 1) << k;
        }
        let leaf = (leaves.first + nearest as u32, &oriented, groups, &mut *ahead);
        search_leaf(simd, view, leaf, packet, work);
    }
}
