//! One leaf against the rays of a packet, sixteen at a time.

use fearless_simd::{Simd, SimdBase, f32x16};
use fearless_simd_macros::simd;

use super::box_crossing::{BoxCrossing, cross_box};
use super::finish::{Done, away_from_pole, finish_all};
use super::load::{farthest, find_planes};
use super::rays::Packet;
use super::read_ahead::{Ahead, Moment};
use super::screening::screen;
use super::settle::settle;
use super::target::{Closer, Ground, Target};
use super::work::Work;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::PACKET;
use crate::intersect::wide::proof::certified::certify;
use crate::intersect::wide::proof::screen::Screened;
use crate::intersect::wide::reach::WIDENED;
use crate::intersect::wide::surface::sums::OneNet;
use crate::intersect::wide::vectors::lane_bits;
use crate::intersect::wide::view::BvhView;
use crate::math::rounding;
use crate::patch::OrientedBox;

/// Searches one leaf for the rays of the packet that may meet it, sixteen by sixteen: the groups
/// whose bit is set in `groups`.
#[simd]
pub(super) fn search_leaf<S: Simd, Q>(
    simd: S,
    view: &BvhView<'_>,
    (index, oriented, groups, ahead): (u32, &OrientedBox, u32, &mut Ahead<'_, Q>),
    packet: &mut Packet,
    work: &mut Work,
) {
    let mut groups = groups;
    // The boxes of most leaves are missed by most rays, so the leaf's data are only touched when
    // they are needed.
    let Some(mut next) = next_group(simd, oriented, packet, &mut groups) else { return };
    if !packet.rays.planes_known {
        find_planes(simd, packet);
    }
    // Not an option that is filled in the loop: the target would be made elsewhere, and copied.
    let target = Target::new(view, oriented, index);
    let mut closer = None;
    let mut found = false;
    loop {
        let (base, crossing) = next;
        let rays = (&mut *packet, base, &crossing);
        found |= search_group(simd, (&target, &mut closer), rays, ahead, work);
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

/// The next sixteen rays, of those whose bit is set in `groups`, of which some meet the box: the
/// index of the first ray, and the rays' ways through the box.
#[inline(always)]
fn next_group<S: Simd>(
    simd: S,
    oriented: &OrientedBox,
    packet: &Packet,
    groups: &mut u32,
) -> Option<(usize, BoxCrossing<S>)> {
    while *groups != 0 {
        let base = LANES * groups.trailing_zeros() as usize;
        *groups &= *groups - 1;
        if base >= packet.count.min(PACKET) {
            return None;
        }
        let crossing = cross_box(simd, oriented, &packet.scaled, base);
        if lane_bits(crossing.met) != 0 {
            return Some((base, crossing));
        }
    }
    None
}

/// Searches one leaf for the sixteen rays from `base` on, whose ways through its box are in
/// `crossing`; returns whether some ray's nearest hit is new.
#[inline(always)]
fn search_group<S: Simd, Q>(
    simd: S,
    (target, closer): (&Target<'_>, &mut Option<Closer>),
    (packet, base, crossing): (&mut Packet, usize, &BoxCrossing<S>),
    ahead: &mut Ahead<'_, Q>,
    work: &mut Work,
) -> bool {
    let met = lane_bits(crossing.met);
    let patch = &target.piece.patch;
    let factor = patch.residual_factor();
    work.statistics.leaf_tests += u64::from(met.count_ones());

    // The certificate, lane by lane.
    let magnitude = f32x16::from_slice(simd, &packet.scaled.magnitude[base..base + LANES])
        .max(f32x16::splat(simd, rounding::f32_above(patch.magnitude())));
    let certified = certify(simd, target.leaf, crossing.slopes, (magnitude, factor));
    let mut certain = met & lane_bits(certified);
    let mut doubted = met & !certain;
    if packet.starts.exist {
        certain &= !start_here(simd, target, (&*packet, base), certain);
        if doubted != 0 {
            doubted &= !packet.departs_from(simd, base, target, (magnitude, factor));
        }
    }
    if certain | doubted == 0 {
        return false;
    }
    let error = magnitude * f32x16::splat(simd, rounding::f32_above(factor));
    // Flat leaves need no search in f32, which shows no more of them before the closer look in f64.
    let is_flat = target.leaf.is_flat() && !packet.any;
    let known = !is_flat || doubted != 0;
    if known {
        work.distances.take(simd, target.fitted(), packet.sixteen(base));
    }
    let mut done = Done::default();
    if certain != 0 {
        let rays = (&mut *packet, base, crossing);
        done = search_certified(simd, (target, closer), rays, (certain, error), ahead, work);
        doubted |= done.unconverged;
    }
    let mut undecided = done.undecided;
    if doubted != 0 {
        if !known {
            work.distances.take(simd, target.fitted(), packet.sixteen(base));
        }
        let lanes = (doubted, crossing.entry, error);
        undecided |= work.doubts.put(simd, (target, &work.distances), (&*packet, base), lanes);
    }
    work.statistics.newton_iterations += u64::from(done.steps);
    work.leave(base, undecided, target.index);
    done.found
}

/// Searches for the `certain` of sixteen rays, for which the leaf's certificate holds; `error` is
/// the error bound of points' distances.
#[inline(always)]
fn search_certified<S: Simd, Q>(
    simd: S,
    (target, closer): (&Target<'_>, &mut Option<Closer>),
    (packet, base, crossing): (&mut Packet, usize, &BoxCrossing<S>),
    (mut certain, error): (u32, f32x16<S>),
    ahead: &mut Ahead<'_, Q>,
    work: &mut Work,
) -> Done {
    let mut found = false;
    let start = [crossing.x, crossing.y];
    let widened = f32x16::splat(simd, WIDENED as f32);
    let is_flat = target.leaf.is_flat() && !packet.any;
    let searched = (!is_flat).then(|| work.distances.newton(simd, start, [[-widened, widened]; 2]));
    if let Some(searched) = &searched {
        let search = (&work.distances, crossing, searched);
        let asked = (certain, error);
        let Screened { missed, met } = screen(simd, target, (&*packet, base), search, asked);
        certain &= !(missed | met);
        if met != 0 {
            packet.meet(simd, base, met);
            found = true;
        }
    }
    if certain == 0 {
        return Done { found, ..Done::default() };
    }
    ahead.ask(Moment::Finish);
    let near = match &searched {
        Some(searched) => work.distances.refine(simd, searched),
        None => start.map(|x| x.max(-widened).min(widened)),
    };
    let closer = match closer {
        Some(known) => &*known,
        none => none.insert(target.closer()),
    };
    let lanes = (certain, Ground::Certificate);
    let patch = &target.piece.patch;
    let net = work.nets.net_of(simd, (target.leaf.piece, patch));
    let about = (target, closer, &OneNet { patch, net });
    let finished = finish_all(simd, about, (packet, base), lanes, &near);
    Done { found: found | finished.found, ..finished }
}

/// Of sixteen rays for which the leaf's certificate holds, those whose one root in it is the one
/// they start on.
#[inline(always)]
fn start_here<S: Simd>(
    simd: S,
    target: &Target<'_>,
    (packet, base): (&Packet, usize),
    certain: u32,
) -> u32 {
    let certified = [target.certified(simd); 2];
    let starting = certain & packet.starts.are_in(simd, base, target.leaf.piece, &certified);
    match target.pole {
        Some(pole) if starting != 0 => {
            starting & away_from_pole(simd, target, pole, (packet, base))
        }
        _ => starting,
    }
}
