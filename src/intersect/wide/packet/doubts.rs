//! Rays and leaves whose certificates do not hold for them: put aside until there are sixteen pairs
//! to be examined side by side.
//!
//! A leaf has few such rays at a time: at a silhouette, or among rays that leave a surface at all
//! angles. The cost of examining their proofs does not depend on how many lanes are filled. So the
//! lanes hold pairs of any rays of the packet with any leaves.

use fearless_simd::{Simd, SimdBase, SimdMask, f32x16, mask32x16};
use fearless_simd_macros::simd;

use super::box_passage::BoxPassage;
use super::rays::Packet;
use super::screening::Asked;
use super::target::Target;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::frames::transposed;
use crate::intersect::wide::proof::bounds::{DISTANCE_ROUNDING, LARGEST};
use crate::intersect::wide::proof::lanes::Errors;
use crate::intersect::wide::search::distances::{
    LaneDistances, coefficients_of_lane, distances_in_middle, middle_distances, terms,
};
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

/// The distances of a leaf's approximation from the two planes of one ray: the coefficients of
/// `xⁱ yʲ`, at `4 i + j`.
type PairDistances = [[f32; 16]; 2];

/// Pairs of a ray and a leaf, number by number, but for their distances.
#[derive(Debug)]
#[repr(align(64))]
pub(super) struct Doubts {
    count: usize,
    pairs: [Doubt; ROOM],
    /// Pair by pair, as most calls put aside one or two. Measured against the distances of all
    /// sixteen rays, packed: ambient occlusion is traced 1.00 to 1.06 times as fast with AVX-512,
    /// 0.98 to 1.04 times with AVX2.
    distances: [PairDistances; ROOM],
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
            distances: [[[0.0; 16]; 2]; ROOM],
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
        packet: &Packet,
        passage: &BoxPassage<S>,
        Asked { lanes, error }: Asked<S>,
    ) -> u32 {
        let BoxPassage { base, entry, .. } = *passage;
        let leaf = target.leaf;
        let (fitted, rays) = (target.fitted(), packet.sixteen(base));
        let middle = middle_distances(simd, leaf, rays);
        let terms = terms(simd, fitted, distances_in_middle(simd, fitted, middle, rays), rays);
        let weighted = error * f32x16::splat(simd, fitted.heaviest());
        let noise = terms * f32x16::splat(simd, DISTANCE_ROUNDING);
        let [x, y] = leaf.half_side_lengths();
        // Nothing can be proved where rounding hides the leaf, as `shows` tells for one ray; both
        // are false for NaN.
        let in_range = terms.simd_le(f32x16::splat(simd, LARGEST));
        let known = lanes & lane_bits(in_range & noise.simd_lt(f32x16::splat(simd, x.min(y))));
        let chosen = mask32x16::from_bitmask(simd, u64::from(known));
        let at = self.count..self.count + LANES;
        for (lengths, length) in self.lengths.iter_mut().zip([x, y]) {
            f32x16::splat(simd, length).store_slice(&mut lengths[at.clone()]);
        }
        let off_ray = noise + f32x16::splat(simd, leaf.fit_error()) + weighted;
        let slope_noise = noise + noise + f32x16::splat(simd, leaf.slope_error());
        weighted.compress(chosen).store_slice(&mut self.errors[0][at.clone()]);
        off_ray.compress(chosen).store_slice(&mut self.errors[1][at.clone()]);
        slope_noise.compress(chosen).store_slice(&mut self.errors[2][at]);
        for lane in set_bits(known) {
            let ray = base + lane;
            let distances = &mut self.distances[self.count];
            for k in 0..2 {
                let middle = middle[k][lane];
                coefficients_of_lane(simd, fitted, rays, (k, lane), middle)
                    .store_slice(&mut distances[k]);
            }
            self.pairs[self.count] = Doubt { ray, leaf: target.index, entry: entry[lane] };
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
            let mut rows = [f32x16::splat(simd, 0.0); LANES];
            for (row, pair) in rows.iter_mut().zip(&self.distances) {
                *row = f32x16::from_slice(simd, &pair[k]);
            }
            for (column, to) in transposed(rows).into_iter().zip(&mut distances.terms_mut()[k]) {
                column.store_slice(to);
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
        self.distances.copy_within(count..self.count, 0);
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::level::dispatch;
    use crate::intersect::wide::packet::box_passage::pass_box;
    use crate::intersect::wide::packet::load::{find_planes, load};
    use crate::intersect::wide::testing::weighted_hills;
    use crate::intersect::{Kernel, Query, SurfaceBvh};
    use crate::math::Ray;

    /// Pairs of the rays with one leaf, and then with another, come back in this order, with the
    /// distances that all rays of their leaf have, computed side by side.
    #[test]
    fn pairs_keep_the_distances_of_their_ray_and_leaf() {
        let queries: Vec<Query> = (0..LANES)
            .map(|k| {
                let turn = 0.4 * k as f64;
                let along = DVec3::new(turn.sin(), (0.7 * turn).cos(), -1.0 - 0.1 * turn);
                Query::primary(Ray::new(DVec3::new(0.3, 0.2, 4.0), along).unwrap())
            })
            .collect();
        let surfaces =
            [shapes::torus(2.0, 0.5).unwrap(), shapes::red_book_patch(), weighted_hills()];
        for surface in surfaces {
            let bvh = SurfaceBvh::build(&[surface]).unwrap();
            let view = bvh.view();
            let mut packet = Packet::default();
            let mut doubts = Doubts::default();
            let leaves = [(0, 0b0110_1101_1011_0111), (bvh.leaves.len() as u32 - 1, 0xffff)];
            dispatch!(Kernel::best_level(), simd => {
                load(simd, &mut packet, &queries, &view);
                find_planes(simd, &mut packet);
                let mut expected = Vec::new();
                for (index, lanes) in leaves {
                    let oriented = view.tree.oriented(index);
                    let target = Target::new(&view, &oriented, index);
                    let passage = pass_box(simd, &oriented, &packet.scaled, 0);
                    let error = f32x16::splat(simd, 1e-6);
                    let mut distances = LaneDistances::default();
                    distances.take(simd, target.fitted(), packet.sixteen(0));
                    let asked = Asked { lanes, error };
                    let left = doubts.put(simd, &target, &packet, &passage, asked);
                    assert_eq!(left, 0);
                    expected.extend(set_bits(lanes).map(|lane| (lane, index, distances.clone())));
                }
                let mut expected = expected.into_iter();
                while !doubts.is_empty() {
                    let taken = doubts.take(simd);
                    for (place, pair) in taken.pairs[..taken.count].iter().enumerate() {
                        let (lane, index, distances) = expected.next().unwrap();
                        assert_eq!((pair.ray, pair.leaf), (lane, index));
                        for (of_pair, of_ray) in taken.distances.terms().iter().zip(distances.terms()) {
                            for (m, of_ray) in of_ray.iter().enumerate() {
                                assert_eq!(of_pair[m][place], of_ray[lane], "{m} of {pair:?}");
                            }
                        }
                    }
                }
                assert!(expected.next().is_none());
            });
        }
    }
}
