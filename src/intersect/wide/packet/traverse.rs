//! Takes a packet through the wide hierarchy.

use fearless_simd::Simd;
use fearless_simd_macros::simd;

use super::leaf::{BlockLeaf, search_leaf};
use super::load::{change_to, load};
use super::outline::{Outline, outline};
use super::rays::Packet;
use super::read_ahead::{Ahead, Moment};
use super::settle::settle;
use super::shared_bounds::{enter, enter_block};
use super::work::PacketWork;
use crate::intersect::Shot;
use crate::intersect::query::StartIn;
use crate::intersect::tree::nodes::{Child, LANES, Region};
use crate::intersect::wide::PACKET;
use crate::intersect::wide::box_ray::{first_entered, push_in_order};
use crate::intersect::wide::view::BvhView;
use crate::math::bits::set_bits;

/// Finds the nearest certified hit of each of up to [`PACKET`] rays, or any hit if that is all they
/// ask for (`packet.wanted`). `work.undecided` lists the pairs of ray and leaf that could not be
/// certified or decided, which may hold nearer hits. The rays `ahead` are prefetched on the way.
#[simd]
pub(crate) fn trace_packet<S: Simd, Q: Shot>(
    simd: S,
    view: &BvhView<'_>,
    shots: &[Q],
    ahead: &mut Ahead<'_, Q>,
    packet: &mut Packet,
    work: &mut PacketWork,
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
    work.apart.set(packet);
    work.stack.clear();
    work.stack.extend(tree.root().map(|root| (f32::NEG_INFINITY, root, packet.open())));
    while let Some((entry, code, rays)) = work.stack.pop() {
        let rays = rays & packet.open();
        // The way back out of a region is always taken: what follows is in other coordinates.
        let is_box = code.is_node() || code.is_block();
        if entry > packet.scaled.farthest || is_box && rays == 0 {
            continue;
        }
        ahead.ask(Moment::Box);
        match code.child() {
            Child::Block(index) => {
                search_block(simd, view, index, rays, ahead, packet, work);
            }
            Child::Node(index) => {
                work.statistics.nodes += 1;
                let node = &tree.nodes[index as usize];
                let (entries, met) =
                    enter(simd, node, &packet.scaled.bounds, packet.scaled.farthest);
                let meeting = work.apart.meeting(simd, packet, node, (&entries, met), rays);
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
    work: &mut PacketWork,
) {
    settle(simd, view, packet, work, 1);
    change_to(simd, packet, &region.frame, view.reach_of_f32);
    work.apart.set(packet);
}

/// Whether the outline of some rays is enough to see that they meet no leaf.
#[simd]
fn meets_nothing<S: Simd, Q: Shot>(
    simd: S,
    view: &BvhView<'_>,
    shots: &[Q],
    work: &mut PacketWork,
) -> bool {
    let tree = view.tree;
    let (bounds, farthest) = match outline(simd, shots, view) {
        Outline::Unknown => return false,
        Outline::Beside => return true,
        Outline::Bounds(bounds, farthest) => (bounds, farthest),
    };
    // Here, only the codes on the stack matter.
    work.stack.clear();
    work.stack.extend(tree.root().map(|root| (0.0, root, 0)));
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
                    work.stack.push((0.0, node.child[k], 0));
                }
            }
            // This needs a closer look.
            Child::Region(..) => return false,
        }
    }
    true
}

/// Searches the leaves of a block, near ones first unless the rays point anywhere.
#[simd]
fn search_block<S: Simd, Q>(
    simd: S,
    view: &BvhView<'_>,
    index: u32,
    rays: u64,
    ahead: &mut Ahead<'_, Q>,
    packet: &mut Packet,
    work: &mut PacketWork,
) {
    let block = &view.tree.blocks[index as usize];
    let leaves = view.tree.leaves(index);
    let (entries, met) = if work.apart.point_anywhere() {
        ([f32::MIN; LANES], u32::MAX)
    } else {
        enter_block(simd, block, &packet.scaled.bounds, packet.scaled.farthest)
    };
    let apart = work.apart.leaves(simd, block, leaves.of(met), packet, rays);
    let two = apart | apart >> 32;
    let mut met = (two | two >> 16) as u32 & 0xffff;
    view.prefetch_leaves(leaves.first, met);
    while met != 0 {
        let nearest = first_entered(&entries, met);
        met &= !(1 << nearest);
        if entries[nearest] > packet.scaled.farthest {
            return;
        }
        let mut groups = 0;
        for k in 0..PACKET / LANES {
            groups |= ((apart >> (LANES * k + nearest)) as u32 & 1) << k;
        }
        let index = leaves.first + nearest as u32;
        let leaf = BlockLeaf { index, oriented: block.oriented(nearest), groups };
        search_leaf(simd, view, &leaf, ahead, packet, work);
    }
}
