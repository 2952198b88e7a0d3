//! One leaf against the rays of a packet, sixteen at a time.

use std::cell::OnceCell;

use fearless_simd::{Simd, SimdBase, f32x16};
use fearless_simd_macros::simd;

use super::box_passage::{BoxPassage, pass_box};
use super::finish::{Done, away_from_pole, finish_all};
use super::load::{farthest, find_planes};
use super::one_leaf::{TrueLeaf, Uniqueness};
use super::rays::Packet;
use super::read_ahead::{Ahead, Moment};
use super::screening::{Asked, Searched, screen};
use super::settle::settle;
use super::target::{LeafNumbers, Target};
use super::work::{PacketWork, Undecided};
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::PACKET;
use crate::intersect::wide::proof::certified::certify;
use crate::intersect::wide::proof::screen::Screened;
use crate::intersect::wide::reach::WIDENED;
use crate::intersect::wide::search::distances::step_from_middle;
use crate::intersect::wide::surface::sums::OneNet;
use crate::intersect::wide::vectors::lane_bits;
use crate::intersect::wide::view::BvhView;
use crate::math::bits::set_bits;
use crate::math::rounding;
use crate::patch::OrientedBox;

/// A leaf of a block.
pub(super) struct BlockLeaf {
    pub(super) index: u32,
    pub(super) oriented: OrientedBox,
    /// Which rays of the packet may meet it: a bit for each sixteen.
    pub(super) groups: u32,
}

/// A leaf that is searched.
struct Opened<'a> {
    target: Target<'a>,
    /// Made when it is needed.
    numbers: OnceCell<LeafNumbers>,
}

/// Searches one leaf for the rays of the packet that may meet it, sixteen by sixteen.
#[simd]
pub(super) fn search_leaf<S: Simd, Q>(
    simd: S,
    view: &BvhView<'_>,
    &BlockLeaf { index, ref oriented, mut groups }: &BlockLeaf,
    ahead: &mut Ahead<'_, Q>,
    packet: &mut Packet,
    work: &mut PacketWork,
) {
    // The boxes of most leaves are missed by most rays, so the leaf's data are only touched when
    // they are needed.
    let Some(mut next) = next_group(simd, oriented, packet, &mut groups) else { return };
    if !packet.rays.planes_known {
        find_planes(simd, packet);
    }
    // Not an option that is filled in the loop: the target would be made elsewhere, and copied.
    let leaf = Opened { target: Target::new(view, oriented, index), numbers: OnceCell::new() };
    let mut found = false;
    loop {
        found |= search_group(simd, &leaf, packet, &next, ahead, work);
        if work.doubts.are_many() {
            settle(simd, view, packet, work, LANES);
        }
        let Some(group) = next_group(simd, oriented, packet, &mut groups) else { break };
        next = group;
    }
    if found {
        packet.scaled.farthest = farthest(simd, packet);
    }
}

/// The ways through the box of the next sixteen rays, of those whose bit is set in `groups`, of
/// which some meet it.
#[inline(always)]
fn next_group<S: Simd>(
    simd: S,
    oriented: &OrientedBox,
    packet: &Packet,
    groups: &mut u32,
) -> Option<BoxPassage<S>> {
    while *groups != 0 {
        let base = LANES * groups.trailing_zeros() as usize;
        *groups &= *groups - 1;
        // With the least of both the compiler knows that all sixteen are there.
        if base >= packet.count.min(PACKET) {
            return None;
        }
        let passage = pass_box(simd, oriented, &packet.scaled, base);
        if lane_bits(passage.met) != 0 {
            return Some(passage);
        }
    }
    None
}

/// Searches one leaf for the sixteen rays whose ways through its box are in `passage`; returns
/// whether some ray's nearest hit is new.
#[inline(always)]
fn search_group<S: Simd, Q>(
    simd: S,
    leaf: &Opened<'_>,
    packet: &mut Packet,
    passage: &BoxPassage<S>,
    ahead: &mut Ahead<'_, Q>,
    work: &mut PacketWork,
) -> bool {
    let (target, base) = (&leaf.target, passage.base);
    let met = lane_bits(passage.met);
    let patch = &target.piece.patch;
    let factor = patch.residual_factor();
    work.statistics.leaf_tests += u64::from(met.count_ones());

    // The certificate, lane by lane.
    let magnitude = f32x16::from_slice(simd, &packet.scaled.magnitude[base..base + LANES])
        .max(f32x16::splat(simd, rounding::f32_above(patch.magnitude())));
    let certified = certify(simd, target.leaf, passage.slopes, magnitude, factor);
    let mut certain = met & lane_bits(certified);
    let mut doubted = met & !certain;
    if packet.starts.exist {
        certain &= !start_here(simd, target, packet, base, certain);
        if doubted != 0 {
            doubted &= !packet.departs_from(simd, base, target, magnitude, factor);
        }
    }
    if certain | doubted == 0 {
        return false;
    }
    let error = magnitude * f32x16::splat(simd, rounding::f32_above(factor));
    let mut done = Done::default();
    if certain != 0 {
        let asked = Asked { lanes: certain, error };
        done = search_certified(simd, leaf, packet, passage, asked, ahead, work);
        doubted |= done.unconverged;
    }
    let mut undecided = done.undecided;
    if doubted != 0 {
        let asked = Asked { lanes: doubted, error };
        undecided |= work.doubts.put(simd, target, packet, passage, asked);
    }
    work.statistics.newton_iterations += u64::from(done.steps);
    work.leave(base, undecided, target.index);
    for lane in set_bits(done.at_edge) {
        let (ray, leaf) = (base + lane, target.index);
        work.leave_one(Undecided { ray, leaf, from: packet.edges.0[ray] });
    }
    done.hits != 0
}

/// Searches for those of sixteen rays that are asked for; the leaf's certificate holds for them.
#[inline(always)]
fn search_certified<S: Simd, Q>(
    simd: S,
    leaf: &Opened<'_>,
    packet: &mut Packet,
    passage: &BoxPassage<S>,
    asked: Asked<S>,
    ahead: &mut Ahead<'_, Q>,
    work: &mut PacketWork,
) -> Done {
    let target = &leaf.target;
    let (base, mut certain) = (passage.base, asked.lanes);
    let mut hits = 0;
    let start = [passage.x, passage.y];
    let widened = f32x16::splat(simd, WIDENED as f32);
    // On a parallelogram the search in f32 finds no better place than the one where the ray passes
    // the middle of the box: it is left out, but for rays that its proofs may save from f64.
    let is_parallelogram = target.leaf.is_parallelogram();
    let near = if !is_parallelogram {
        work.distances.take(simd, target.fitted(), packet.sixteen(base));
        Some(work.distances.newton(simd, start, [[-widened, widened]; 2]))
    } else if packet.wanted == Wanted::Any {
        Some(step_from_middle(simd, target.fitted(), packet.sixteen(base), widened))
    } else {
        None
    };
    if let Some(near) = &near {
        let middle =
            if is_parallelogram { near.last.distances } else { work.distances.in_middle(simd) };
        let searched = Searched { middle, near };
        let Screened { missed, met } = screen(simd, target, packet, passage, searched, asked);
        certain &= !(missed | met);
        if met != 0 {
            packet.meet(simd, base, met);
            hits = met;
        }
    }
    if certain == 0 {
        return Done { hits, ..Done::default() };
    }
    ahead.ask(Moment::Finish);
    let refined = match &near {
        Some(near) if !is_parallelogram => work.distances.refine(simd, near),
        Some(near) => near.place(),
        None => start.map(|x| x.max(-widened).min(widened)),
    };
    let numbers = leaf.numbers.get_or_init(|| target.numbers());
    let patch = &target.piece.patch;
    let net = work.nets.net_of(simd, target.leaf.piece, patch);
    let on = TrueLeaf { target, numbers, surface: &OneNet { patch, net } };
    let finished = finish_all(simd, on, packet, base, certain, &Uniqueness::Certificate, &refined);
    Done { hits: hits | finished.hits, ..finished }
}

/// Of sixteen rays for which the leaf's certificate holds, those whose one root in it is the one
/// they start on.
#[inline(always)]
fn start_here<S: Simd>(
    simd: S,
    target: &Target<'_>,
    packet: &Packet,
    base: usize,
    certain: u32,
) -> u32 {
    let certified = [target.certified(simd); 2];
    let starting = certain & packet.starts.are_in(simd, base, target.leaf.piece, &certified);
    match target.pole {
        Some(pole) if starting != 0 => starting & away_from_pole(simd, target, pole, packet, base),
        _ => starting,
    }
}
