//! What the fast kernels search, and its prefetching.

use crate::intersect::tree::nodes::Tree;
use crate::math::bits::set_bits;
use crate::math::{Aabb, Ray, prefetch};
use crate::patch::{Leaf, MOST_WEIGHT, PatchSet, Piece, TensorPatch, TrimWindows, WeightFit};

/// The parts of a [`SurfaceBvh`](crate::intersect::SurfaceBvh) that the fast kernels search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BvhView<'a> {
    pub tree: &'a Tree,
    pub leaves: &'a [Leaf],
    /// One weight for each leaf, or none if no leaf is approximated by a quotient.
    pub weights: &'a [WeightFit],
    pub windows: &'a TrimWindows,
    pub set: &'a PatchSet,
    /// The largest coordinate an origin may have for the work in f32.
    pub reach_of_f32: f64,
    /// Bounds of all that rays from within that reach may be said to meet.
    pub surroundings: &'a Aabb,
}

/// A leaf, with its weight if its piece is one of those whose leaves have weights.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fitted<'a> {
    pub(super) leaf: &'a Leaf,
    pub(super) weight: Option<&'a WeightFit>,
}

impl Fitted<'_> {
    /// An upper bound of the weight. Where a point may be off a ray by some error, its distances
    /// times the weight may be off by this many times that error.
    #[inline(always)]
    pub(super) fn heaviest(self) -> f32 {
        if self.weight.is_some() { MOST_WEIGHT } else { 1.0 }
    }
}

/// Scenes of as many leaves as this do not fit into the processor's caches. In smaller ones, without
/// AVX-512, first hits are not traced in streams. Measured on Zen 3: one by one they take 0.7 to 1.1
/// times as long with AVX2, 0.55 to 0.95 times with SSE2; from 2¹⁶ leaves on, 1.1 to 1.3 times.
const MORE_THAN_CACHES: usize = 1 << 14;

/// In scenes of as many leaves as this, occlusion is traced in streams. Measured: 1.04 to 1.6 times
/// as fast with 2¹⁸ leaves and more, 0.87 to 1.03 times with 2¹⁶ and less.
const WORTH_STREAMS: usize = 1 << 17;

impl<'a> BvhView<'a> {
    /// Whether an origin with this largest coordinate is too far away for the work in f32.
    #[inline(always)]
    pub(crate) fn is_beyond_f32(&self, magnitude: f64) -> bool {
        magnitude > self.reach_of_f32
    }

    /// Whether a ray surely passes beside everything.
    #[inline(always)]
    pub(super) fn is_passed_by(&self, ray: &Ray) -> bool {
        self.surroundings.is_beside(ray) && !self.is_beyond_f32(ray.origin().abs().max_element())
    }

    /// Whether data needed soon are worth prefetching, stage by stage: leaves, their pieces, and
    /// the control points of these; and so many rays worth tracing side by side for first hits.
    #[inline(always)]
    pub(crate) fn outgrows_caches(&self) -> bool {
        self.leaves.len() >= MORE_THAN_CACHES
    }

    /// Whether rays wait so long for their data that many are worth tracing side by side, even if
    /// each asks for any hit only.
    pub(crate) fn is_worth_streams(&self) -> bool {
        self.leaves.len() >= WORTH_STREAMS
    }

    /// A leaf of a piece, with its weight if it has one.
    #[inline(always)]
    pub(super) fn fitted(&self, leaf: u32, patch: &TensorPatch) -> Fitted<'_> {
        let weight = patch.has_quotient_leaves().then(|| &self.weights[leaf as usize]);
        Fitted { leaf: &self.leaves[leaf as usize], weight }
    }

    /// Prefetches those leaves of a block whose bits are set in `met`.
    #[inline(always)]
    pub(super) fn prefetch_leaves(&self, first: u32, met: u32) {
        set_bits(met).for_each(|k| self.leaves[first as usize + k].prefetch());
        if !self.weights.is_empty() {
            set_bits(met).for_each(|k| prefetch(&self.weights[first as usize + k]));
        }
    }

    /// Prefetches the pieces of such leaves, which have arrived by now.
    #[inline(always)]
    pub(super) fn prefetch_pieces(&self, first: u32, met: u32) {
        set_bits(met).for_each(|k| prefetch(self.piece_of(first + k as u32)));
    }

    /// Prefetches the control points of such pieces, which have arrived by now.
    #[inline(always)]
    pub(super) fn prefetch_nets(&self, first: u32, met: u32) {
        set_bits(met).for_each(|k| self.piece_of(first + k as u32).patch.prefetch_net());
    }

    /// The piece that a leaf is a part of.
    #[inline(always)]
    pub(crate) fn piece_of(&self, leaf: u32) -> &'a Piece {
        &self.set.pieces()[self.leaves[leaf as usize].piece as usize]
    }
}
