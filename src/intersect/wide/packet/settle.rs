//! Rays and leaves that were put aside: examined sixteen pairs at a time.

use fearless_simd::{Simd, SimdBase, f32x16, u8x64, u32x16};
use fearless_simd_macros::simd;

use super::doubts::{Doubt, Taken};
use super::finish::finish_all;
use super::load::farthest;
use super::one_leaf::{TrueLeaf, Uniqueness};
use super::rays::Packet;
use super::target::Target;
use super::work::{PacketWork, Undecided};
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::box_ray::BOX_SPARE;
use crate::intersect::wide::proof::bounds::{GROWN, START_GROWN};
use crate::intersect::wide::proof::lane_parts::bytes_of;
use crate::intersect::wide::proof::lanes::{LaneProof, Parts};
use crate::intersect::wide::search::distances::widened;
use crate::intersect::wide::surface::spline_net::RecentNets;
use crate::intersect::wide::surface::sums::OneNet;
use crate::intersect::wide::view::BvhView;
use crate::math::bits::{has, set_bits};

/// Examines the pairs that were put aside, sixteen at a time, as long as there are at least `least`
/// of them.
#[simd]
pub(super) fn settle<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    packet: &mut Packet,
    work: &mut PacketWork,
    least: usize,
) {
    let mut found = false;
    while work.doubts.count() >= least {
        let taken = work.doubts.take(simd);
        let done = settle_sixteen(simd, view, packet, &taken, &mut work.parts, &mut work.nets);
        found |= done.found;
        work.statistics.newton_iterations += u64::from(done.steps);
        for place in set_bits(done.undecided) {
            let Doubt { ray, leaf, .. } = taken.pairs[place];
            work.leave_one(Undecided { ray, leaf, from: done.from[place] });
        }
    }
    if found {
        packet.scaled.farthest = farthest(simd, packet);
    }
}

/// The outcome for sixteen pairs.
#[derive(Default)]
struct Settled {
    /// One bit for each pair that the scalar search must examine, and from where on, as in
    /// [`Undecided`].
    undecided: u32,
    from: [f64; LANES],
    /// Whether some ray's nearest hit is new.
    found: bool,
    /// Newton's steps taken.
    steps: u32,
}

impl Settled {
    /// Leaves a pair to the scalar search.
    fn leave(&mut self, place: usize, from: f64) {
        let known = if has(self.undecided, place) { self.from[place] } else { f64::INFINITY };
        self.undecided |= 1 << place;
        self.from[place] = from.min(known);
    }
}

/// Searches the leaves part by part, as far as the rays' own proofs go. All pairs are done with but
/// those that are undecided.
///
/// A pair that has one undecided root is searched on: there may be a nearer one, and the undecided
/// one then does not count.
#[simd]
fn settle_sixteen<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    packet: &mut Packet,
    taken: &Taken<S>,
    parts: &mut Parts,
    nets: &mut RecentNets,
) -> Settled {
    let Taken { pairs, count, distances, errors, lengths } = taken;
    let mut asked = 0;
    for (lane, pair) in pairs[..*count].iter().enumerate() {
        // Something nearer may have been found since.
        let beyond = pair.entry > packet.scaled.far[pair.ray] + BOX_SPARE;
        asked |= u32::from(!beyond) << lane;
    }
    let mut all = Settled::default();
    let mut proof = LaneProof::new(simd, distances, parts, *lengths, *errors, asked);
    while let Some((part, lanes)) = proof.next() {
        let domain = part.widened(simd, GROWN);
        let start = part.widened(simd, START_GROWN);
        let near = distances.refine(simd, &distances.newton(simd, part.middle, domain));
        // Pairs of one leaf and the same sixteen rays are finished together.
        let (mut left, mut unconverged) = (lanes, 0);
        while left != 0 {
            let Doubt { ray, leaf, .. } = pairs[left.trailing_zeros() as usize];
            let base = ray / LANES * LANES;
            let group = Group::of(pairs, left, leaf, base);
            left &= !group.places;
            let bytes = group.bytes(simd);
            let oriented = view.tree.oriented(leaf);
            let target = Target::new(view, &oriented, leaf);
            let mut wanted = group.lanes;
            if packet.starts.exist {
                // If a ray starts in its part, the part's one root is the root it starts on.
                let start = moved(start, bytes);
                let half = |k| target.parameters(simd, &start, |ends| widened(ends, k));
                let start = [half(0), half(1)];
                wanted &= !packet.starts.are_in(simd, base, target.leaf.piece, &start);
                if wanted == 0 {
                    continue;
                }
            }
            let near = [near[0].swizzle_dyn(bytes), near[1].swizzle_dyn(bytes)];
            let unique = Uniqueness::Own(moved(domain, bytes));
            let patch = &target.piece.patch;
            let net = nets.net_of(simd, target.leaf.piece, patch);
            let numbers = target.numbers();
            let leaf =
                TrueLeaf { target: &target, numbers: &numbers, surface: &OneNet { patch, net } };
            let done = finish_all(simd, leaf, packet, base, wanted, &unique, &near);
            all.found |= done.hits != 0;
            all.steps += done.steps;
            for lane in set_bits(done.undecided) {
                all.leave(group.place[lane] as usize, f64::NEG_INFINITY);
            }
            for lane in set_bits(done.at_edge) {
                all.leave(group.place[lane] as usize, packet.edges.0[base + lane]);
            }
            unconverged |= group.places_of(done.unconverged);
        }
        // Rays that are led out of the part may be proved to miss its halves.
        proof.go_on(&part, unconverged);
    }
    for place in set_bits(proof.undecided) {
        all.leave(place, f64::NEG_INFINITY);
    }
    all
}

/// Pairs of one leaf and the same sixteen rays.
struct Group {
    /// The places of these pairs among all pairs, a bit each.
    places: u32,
    /// Their rays, a bit each.
    lanes: u32,
    /// The place of each ray's pair.
    place: [u32; LANES],
}

impl Group {
    /// The pairs of this leaf and these rays among `places`.
    fn of(pairs: &[Doubt; LANES], places: u32, leaf: u32, base: usize) -> Self {
        let mut group = Self { places: 0, lanes: 0, place: [0; LANES] };
        for at in set_bits(places) {
            let pair = &pairs[at];
            if pair.leaf == leaf && pair.ray / LANES * LANES == base {
                group.places |= 1 << at;
                group.lanes |= 1 << (pair.ray - base);
                group.place[pair.ray - base] = at as u32;
            }
        }
        group
    }

    /// The byte indices that put the pairs' numbers into the order of their rays.
    #[inline(always)]
    fn bytes<S: Simd>(&self, simd: S) -> u8x64<S> {
        bytes_of(simd, u32x16::from_slice(simd, &self.place))
    }

    /// The places of the pairs of some rays.
    fn places_of(&self, lanes: u32) -> u32 {
        set_bits(lanes & self.lanes).fold(0, |places, lane| places | 1 << self.place[lane])
    }
}

/// Permutes the lanes of numbers.
#[inline(always)]
fn moved<S: Simd>(of: [[f32x16<S>; 2]; 2], bytes: u8x64<S>) -> [[f32x16<S>; 2]; 2] {
    let [[a, b], [c, d]] = of;
    [[a.swizzle_dyn(bytes), b.swizzle_dyn(bytes)], [c.swizzle_dyn(bytes), d.swizzle_dyn(bytes)]]
}
