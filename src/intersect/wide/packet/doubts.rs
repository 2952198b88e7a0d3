//! Rays and leaves whose certificates do not hold for them: put aside until there are sixteen pairs
//! to be examined side by side.
//!
//! A leaf has few such rays at a time: at a silhouette, or among rays that leave a surface at all
//! angles. The cost of examining their proofs does not depend on how many lanes are filled. So the
//! lanes hold pairs of any rays of the packet with any leaves.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x16, mask32x16};
use fearless_simd_macros::simd;

use super::box_crossing::BoxCrossing;
use super::rays::Packet;
use super::screening::Asked;
use super::target::Target;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::proof::bounds::{DISTANCE_ROUNDING, LARGEST};
use crate::intersect::wide::proof::lanes::Errors;
use crate::intersect::wide::search::distances::{LaneDistances, terms};
use crate::intersect::wide::vectors::lane_bits;
use crate::math::bits::set_bits;

/// Room for sixteen pairs that are examined, and for as many that are left over.
const ROOM: usize = 2 * LANES;

/// A ray of the packet and a leaf, and where the ray enters the leaf's box.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Doubt {
    pub(super) ray: usize,
    pub(super) leaf: u32,
    pub(super) entry: f32,
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
pub(super) struct Taken<S: Simd> {
    pub(super) pairs: [Doubt; LANES],
    pub(super) count: usize,
    pub(super) distances: LaneDistances,
    pub(super) errors: Errors<S>,
    pub(super) lengths: [f32x16<S>; 2],
}

impl Doubts {
    pub(super) fn clear(&mut self) {
        self.count = 0;
    }

    pub(super) fn is_empty(&self) -> bool {
        self.count == 0
    }

    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Whether there are enough pairs to be examined.
    #[inline(always)]
    pub(super) fn are_many(&self) -> bool {
        self.count >= LANES
    }

    /// Puts aside those of sixteen rays that are asked for, with their distances from a leaf and
    /// where they enter its box. Returns the lanes for which nothing can be proved.
    #[simd]
    pub(super) fn put<S: Simd>(
        &mut self,
        simd: S,
        target: &Target<'_>,
        distances: &LaneDistances,
        packet: &Packet,
        crossing: &BoxCrossing<S>,
        Asked { lanes, error }: Asked<S>,
    ) -> u32 {
        let BoxCrossing { base, entry, .. } = *crossing;
        let leaf = target.leaf;
        let fitted = target.fitted();
        let terms = terms(simd, fitted, distances.in_middle(simd), packet.sixteen(base));
        let weighted = error * f32x16::splat(simd, fitted.heaviest());
        let noise = terms * f32x16::splat(simd, DISTANCE_ROUNDING);
        let [x, y] = leaf.half_side_lengths();
        // Nothing can be proved where rounding hides the leaf, as `shows` tells for one ray; both
        // are false for NaN.
        let in_range = terms.simd_le(f32x16::splat(simd, LARGEST));
        let known = lanes & lane_bits(in_range & noise.simd_lt(f32x16::splat(simd, x.min(y))));
        let chosen = mask32x16::from_bitmask(simd, u64::from(known));
        let at = self.count..self.count + LANES;
        for k in 0..2 {
            for m in 0..16 {
                let row = f32x16::from_slice(simd, &distances.of[k][m]);
                row.compress(chosen).store_slice(&mut self.distances[k][m][at.clone()]);
            }
            let length = f32x16::splat(simd, [x, y][k]);
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
    pub(super) fn take<S: Simd>(&mut self, simd: S) -> Taken<S> {
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
