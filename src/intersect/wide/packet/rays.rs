//! Sixty-four rays, with the roots they start on, and what has been found for each.

use fearless_simd::{Select, Simd, SimdBase, SimdMask, f32x16, f64x8, mask32x16};
use fearless_simd_macros::simd;

use super::box_passage::BoxPassage;
use super::hits::NearestHits;
use super::starts::Starts;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::PACKET;
use crate::intersect::wide::box_ray::BOX_SPARE;
use crate::intersect::wide::frames::END_SPARE;
use crate::intersect::wide::lane_rays::{LaneRays, RaySixteen, ScaledRays};
use crate::intersect::wide::vectors::{lane_bits, load};
use crate::math::bits::set_bits;

/// Rays that are traced together, and the nearest hit of each.
#[derive(Clone, Debug, Default)]
#[repr(align(64))]
pub(crate) struct Packet {
    /// How many rays there are.
    pub(super) count: usize,
    /// What is asked for. If any hit will do, a ray that has one ends before it begins.
    pub wanted: Wanted,
    /// One bit a ray: whether it comes from too far away for the work in f32, and is left out.
    pub(super) far_off: u64,
    pub rays: LaneRays,
    pub scaled: ScaledRays,
    pub(super) starts: Starts,
    pub(super) hits: NearestHits,
    /// Where the roots are met, less their error, that were last found near an edge of trims: see
    /// [`Done::at_edge`](super::finish::Done::at_edge).
    pub(super) edges: PerRay,
}

/// A number for each ray of a packet.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct PerRay(pub(super) [f64; PACKET]);

impl Default for PerRay {
    fn default() -> Self {
        Self([0.0; PACKET])
    }
}

impl Packet {
    /// Forgets all rays: now there are `count` rays that meet nothing.
    pub(crate) fn clear(&mut self, count: usize) {
        self.count = count;
        (self.far_off, self.hits.met, self.hits.needs_look) = (0, 0, 0);
    }

    /// One bit for each ray; none for lanes left over.
    #[inline(always)]
    pub(super) fn all(&self) -> u64 {
        u64::MAX.checked_shr((PACKET - self.count) as u32).unwrap_or(0)
    }

    /// One bit for each ray that is still searched for.
    #[inline(always)]
    pub(super) fn open(&self) -> u64 {
        let done = if self.wanted == Wanted::Any { self.hits.met } else { 0 };
        self.all() & !(self.far_off | done)
    }

    /// The sixteen rays from `base` on.
    #[inline(always)]
    pub(crate) fn sixteen(&self, base: usize) -> RaySixteen<'_> {
        RaySixteen { rays: &self.rays, scaled: &self.scaled, base }
    }

    /// Says what the rays to come ask for: their first hits, or any.
    pub(crate) fn ask(&mut self, wanted: Wanted) {
        self.wanted = wanted;
    }

    /// Shortens the f32 ends of rays to their nearest hits, for those of the sixteen rays from
    /// `base` on whose bit is set.
    #[simd]
    pub(super) fn shorten<S: Simd>(&mut self, simd: S, base: usize, hits: u32) {
        let scale = f64x8::splat(simd, self.scaled.scale);
        let mut far = [scale; 2];
        for half in 0..2 {
            let at = base + 8 * half;
            let z: f64x8<S> = load(simd, &self.hits.z, at);
            let shift: f64x8<S> = load(simd, &self.scaled.shift, at);
            far[half] = (z - shift) * scale;
        }
        let far = simd.narrow_f64x8(far[0], far[1]) + f32x16::splat(simd, END_SPARE);
        let lanes = &mut self.scaled.far[base..base + LANES];
        let old = f32x16::from_slice(simd, lanes);
        mask32x16::from_bitmask(simd, u64::from(hits)).select(far, old).store_slice(lanes);
    }

    /// One bit for each of sixteen rays whose passage of a box lies in the range in which hits
    /// count, and ahead of the root it starts on. The box was grown by more than the errors of its
    /// leaf or of the ray.
    #[simd]
    pub(crate) fn within_range<S: Simd>(&self, simd: S, passage: &BoxPassage<S>) -> u32 {
        let base = passage.base;
        let sixteen = base..base + LANES;
        let near = f32x16::from_slice(simd, &self.scaled.near[sixteen.clone()]);
        let far = f32x16::from_slice(simd, &self.scaled.far[sixteen]);
        // The ends are known with some slack to the other side.
        let spare = f32x16::splat(simd, 2.0 * END_SPARE + BOX_SPARE);
        let within = passage.entry.simd_gt(near + spare) & passage.exit.simd_lt(far - spare);
        if !self.starts.exist {
            return lane_bits(within);
        }
        let scale = f64x8::splat(simd, self.scaled.scale);
        let mut start = [scale; 2];
        for half in 0..2 {
            let eight = base + 8 * half..base + 8 * half + 8;
            let error = f64x8::from_slice(simd, &self.starts.error[eight.clone()]);
            start[half] = (error - f64x8::from_slice(simd, &self.scaled.shift[eight])) * scale;
        }
        let ahead = simd.narrow_f64x8(start[0], start[1]) + spare;
        lane_bits(within & passage.entry.simd_gt(ahead))
    }

    /// Notes a hit for those of the sixteen rays from `base` on whose bit is set: nothing more is
    /// asked of them.
    #[simd]
    pub(super) fn meet<S: Simd>(&mut self, simd: S, base: usize, hits: u32) {
        self.hits.met |= u64::from(hits) << base;
        for k in set_bits(hits) {
            self.hits.z[base + k] = f64::NEG_INFINITY;
        }
        self.shorten(simd, base, hits);
    }

    /// One bit a ray: whether it was left out, for others to trace.
    pub(crate) fn far_off(&self) -> u64 {
        self.far_off
    }
}
