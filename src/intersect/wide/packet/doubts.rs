//! Rays and leaves whose certificates do not hold for them: put aside until there are sixteen pairs
//! to be examined side by side.
//!
//! A leaf has few such rays at a time: at a silhouette, or among rays that leave a surface at all
//! angles. The cost of examining their proofs does not depend on how many lanes are filled. So the
//! lanes hold pairs of any rays of the packet with any leaves.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x16, mask32x16, u8x64, u32x16};
use fearless_simd_macros::simd;

use super::finish::{Done, finish_all};
use super::load::farthest;
use super::rays::Packet;
use super::target::{Ground, Target};
use super::work::Work;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::box_ray::BOX_SPARE;
use crate::intersect::wide::proof::bounds::{DISTANCE_ROUNDING, GROWN, LARGEST, START_GROWN};
use crate::intersect::wide::proof::lane_parts::bytes_of;
use crate::intersect::wide::proof::lanes::{Errors, LaneProof, Parts};
use crate::intersect::wide::search::distances::{LaneDistances, sizes};
use crate::intersect::wide::surface::jets::OneNet;
use crate::intersect::wide::surface::spline_net::RecentNets;
use crate::intersect::wide::vectors::lane_bits;
use crate::intersect::wide::view::BvhView;
use crate::math::bits::set_bits;

/// Room for sixteen pairs that are examined, and for as many that are left over.
const ROOM: usize = 2 * LANES;

/// A ray of the packet and a leaf, and where the ray enters the leaf's box.
#[derive(Clone, Copy, Debug, Default)]
struct Doubt {
    ray: usize,
    leaf: u32,
    entry: f32,
}

/// Pairs of a ray and a leaf, as a structure of arrays.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct Doubts {
    count: usize,
    pairs: [Doubt; ROOM],
    /// As in [`LaneDistances`].
    distances: [[[f32; ROOM]; 16]; 2],
    /// As in [`Errors`].
    errors: [[f32; ROOM]; 3],
    /// The approximate lengths of the leaves' half sides.
    lengths: [[f32; ROOM]; 2],
}

impl Default for Doubts {
    fn default() -> Self {
        Self {
            count: 0,
            pairs: [Doubt::default(); ROOM],
            distances: [[[0.0; ROOM]; 16]; 2],
            errors: [[0.0; ROOM]; 3],
            lengths: [[0.0; ROOM]; 2],
        }
    }
}

/// Sixteen pairs, or fewer.
struct Taken<S: Simd> {
    pairs: [Doubt; LANES],
    count: usize,
    distances: LaneDistances,
    errors: Errors<S>,
    lengths: [f32x16<S>; 2],
}

impl Doubts {
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether there are enough pairs to be examined.
    #[inline(always)]
    pub(super) fn are_many(&self) -> bool {
        self.count >= LANES
    }

    /// Puts aside those of sixteen rays whose bit is set in `lanes`, with their distances from a
    /// leaf and where they enter its box; `error` is the error bound of a point's distance from the
    /// ray. Returns the lanes for which nothing can be proved.
    #[simd]
    pub(super) fn put<S: Simd>(
        &mut self,
        simd: S,
        (target, distances): (&Target<'_>, &LaneDistances),
        (packet, base): (&Packet, usize),
        (lanes, entry, error): (u32, f32x16<S>, f32x16<S>),
    ) -> u32 {
        let leaf = target.leaf;
        let fitted = target.fitted();
        let terms = distances.terms(simd, sizes(simd, fitted), packet.sixteen(base));
        let weighted = error * f32x16::splat(simd, fitted.heaviest());
        // False for NaN.
        let known = lanes & lane_bits(terms.simd_le(f32x16::splat(simd, LARGEST)));
        let noise = terms * f32x16::splat(simd, DISTANCE_ROUNDING);
        let chosen = mask32x16::from_bitmask(simd, u64::from(known));
        let at = self.count..self.count + LANES;
        for k in 0..2 {
            for m in 0..16 {
                let row = f32x16::from_slice(simd, &distances.of[k][m]);
                row.compress(chosen).store_slice(&mut self.distances[k][m][at.clone()]);
            }
            let length = f32x16::splat(simd, leaf.half_side_lengths()[k]);
            length.store_slice(&mut self.lengths[k][at.clone()]);
        }
        let off_ray = noise + f32x16::splat(simd, leaf.fit_error()) + weighted;
        let slope_noise = noise + noise + f32x16::splat(simd, leaf.slope_error());
        weighted.compress(chosen).store_slice(&mut self.errors[0][at.clone()]);
        off_ray.compress(chosen).store_slice(&mut self.errors[1][at.clone()]);
        slope_noise.compress(chosen).store_slice(&mut self.errors[2][at]);
        for k in set_bits(known) {
            self.pairs[self.count] = Doubt { ray: base + k, leaf: target.index, entry: entry[k] };
            self.count += 1;
        }
        lanes & !known
    }

    /// Takes out the first sixteen pairs, or as many as there are.
    #[simd]
    fn take<S: Simd>(&mut self, simd: S) -> Taken<S> {
        let count = self.count.min(LANES);
        let mut distances = LaneDistances::default();
        for k in 0..2 {
            for m in 0..16 {
                first(simd, &mut self.distances[k][m]).store_slice(&mut distances.of[k][m]);
            }
        }
        let [error, off_ray, slope_noise] = &mut self.errors;
        let errors = Errors {
            error: first(simd, error),
            off_ray: first(simd, off_ray),
            slope_noise: first(simd, slope_noise),
        };
        let [x, y] = &mut self.lengths;
        let lengths = [first(simd, x), first(simd, y)];
        let mut pairs = [Doubt::default(); LANES];
        pairs[..count].copy_from_slice(&self.pairs[..count]);
        self.pairs.copy_within(count..self.count, 0);
        self.count -= count;
        Taken { pairs, count, distances, errors, lengths }
    }
}

/// Takes out the first sixteen numbers; the others move to their place.
#[inline(always)]
fn first<S: Simd>(simd: S, numbers: &mut [f32; ROOM]) -> f32x16<S> {
    let first = f32x16::from_slice(simd, &numbers[..LANES]);
    f32x16::from_slice(simd, &numbers[LANES..]).store_slice(&mut numbers[..LANES]);
    first
}

/// Examines the pairs that were put aside, sixteen at a time, as long as there are at least `least`
/// of them.
#[simd]
pub(super) fn settle<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    packet: &mut Packet,
    work: &mut Work,
    least: usize,
) {
    let mut found = false;
    while work.doubts.count >= least {
        let taken = work.doubts.take(simd);
        let room = (&mut work.parts, &mut work.nets);
        let done = settle_sixteen(simd, view, packet, &taken, room);
        found |= done.found;
        work.statistics.newton_iterations += u64::from(done.steps);
        for place in set_bits(done.undecided) {
            let Doubt { ray, leaf, .. } = taken.pairs[place];
            work.leave(ray, 1, leaf);
        }
    }
    if found {
        packet.scaled.farthest = farthest(simd, packet);
    }
}

/// Searches the leaves part by part, as far as the rays' own proofs go. Returns the outcome for the
/// pairs, a bit each: some are undecided, all others done with.
#[simd]
fn settle_sixteen<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    packet: &mut Packet,
    taken: &Taken<S>,
    (parts, nets): (&mut Parts, &mut RecentNets),
) -> Done {
    let Taken { pairs, count, distances, errors, lengths } = taken;
    let mut asked = 0;
    for (lane, pair) in pairs[..*count].iter().enumerate() {
        // Something nearer may have been found since.
        let beyond = pair.entry > packet.scaled.far[pair.ray] + BOX_SPARE;
        asked |= u32::from(!beyond) << lane;
    }
    let mut all = Done::default();
    let mut proof = LaneProof::new(simd, (distances, parts), *lengths, *errors, asked);
    while let Some((part, lanes)) = proof.next() {
        let lanes = lanes & !all.undecided;
        if lanes == 0 {
            continue;
        }
        let domain = part.widened(simd, GROWN);
        let start = part.widened(simd, START_GROWN);
        let near = distances.refine(simd, &distances.newton(simd, part.middle, domain));
        // Pairs of one leaf and the same sixteen rays are finished together.
        let (mut left, mut unconverged) = (lanes, 0);
        while left != 0 {
            let Doubt { ray, leaf, .. } = pairs[left.trailing_zeros() as usize];
            let base = ray / LANES * LANES;
            let group = Group::of(pairs, left, (leaf, base));
            left &= !group.places;
            let bytes = group.bytes(simd);
            let oriented = view.tree.oriented(leaf);
            let target = Target::new(view, &oriented, leaf);
            let mut wanted = group.lanes;
            if packet.starts.exist {
                // If a ray starts in its part, the part's one root is the root it starts on.
                let start = moved(start, bytes);
                let start =
                    [target.parameters(simd, &start, 0), target.parameters(simd, &start, 1)];
                wanted &= !packet.starts_in(simd, base, target.leaf.piece, &start);
                if wanted == 0 {
                    continue;
                }
            }
            let near = [near[0].swizzle_dyn(bytes), near[1].swizzle_dyn(bytes)];
            let ground = Ground::Own(moved(domain, bytes));
            let patch = &target.piece.patch;
            let net = nets.net_of(simd, (target.leaf.piece, patch));
            let surface = OneNet { patch, net };
            let about = (&target, &target.closer(), &surface);
            let done = finish_all(simd, about, (&mut *packet, base), (wanted, ground), &near);
            all.found |= done.found;
            all.steps += done.steps;
            all.undecided |= group.places_of(done.undecided);
            unconverged |= group.places_of(done.unconverged);
        }
        // Rays that are led out of the part may be proved to miss its halves.
        proof.go_on(&part, unconverged);
    }
    all.undecided |= proof.undecided;
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
    fn of(pairs: &[Doubt; LANES], places: u32, (leaf, base): (u32, usize)) -> Self {
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
