//! Sixteen pairs, side by side, of a ray and a leaf that it meets at most once.
//!
//! A lane is treated as [`single`](crate::intersect::wide::single) treats one ray and one leaf, in
//! the steps that the packets take; its result does not depend on the other lanes.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8, mask64x8};
use fearless_simd_macros::simd;
use glam::{DVec2, DVec3};

use crate::intersect::Shot;
use crate::intersect::query::StartIn;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::frames::{EightRays, perpendicular, transposed};
use crate::intersect::wide::hit_place::HitPlace;
use crate::intersect::wide::proof::bounds::{DISTANCE_ROUNDING, LARGEST};
use crate::intersect::wide::proof::lanes::missed;
use crate::intersect::wide::reach::WIDENED;
use crate::intersect::wide::search::distances::{self, LaneDistances};
use crate::intersect::wide::single::ray::{Guess, SingleHit};
use crate::intersect::wide::surface::form::Form;
use crate::intersect::wide::surface::lane_net::LaneNet;
use crate::intersect::wide::vectors::{dot_d, lane_bits};
use crate::intersect::wide::view::{BvhView, Fitted};
use crate::math::Ray;
use crate::math::bits::half_of_sixteen;
use crate::patch::{Leaf, Piece};

/// A ray, and a leaf whose certificate holds for it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair {
    /// Which ray of the batch.
    pub(super) ray: u32,
    pub(super) leaf: u32,
    pub(super) form: Form,
    pub(super) guess: Guess,
}

/// A number for each lane.
pub(super) type Lanes = [f64; LANES];

/// Scratch memory for sixteen pairs, and what was found for them.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct PairLanes {
    start: [[f32; LANES]; 2],
    distances: LaneDistances,
    /// Data of the leaves.
    leaf_middle: [Lanes; 3],
    pub(super) half: [Lanes; 2],
    pub(super) middle: [Lanes; 2],
    pub(super) bend: Lanes,
    pub(super) third: Lanes,
    /// See [`Guess::clearance`].
    pub(super) clearance: Lanes,
    /// See [`TensorPatch::residual_factor`](crate::patch::TensorPatch::residual_factor), and the
    /// largest coordinate of the piece.
    pub(super) residual_factor: Lanes,
    pub(super) magnitude: Lanes,
    fit_error: [f32; LANES],
    /// Error bounds of the roots that rays start on.
    pub(super) from_error: Lanes,
    pub(super) net: LaneNet,
    /// The roots that were found.
    pub(super) z: Lanes,
    pub(super) z_error: Lanes,
    pub(super) st: [Lanes; 2],
    pub(super) point: [Lanes; 3],
    pub(super) cross: [Lanes; 3],
}

/// The outcome for sixteen pairs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Outcomes {
    /// The lanes with a root within the ray's range.
    pub(super) met: u32,
    /// The lanes whose root the scalar search must judge.
    pub(super) undecided: u32,
    /// Those of them for which trims may cut it off first: see
    /// [`Verdict::at_end`](crate::intersect::wide::search::newton::Verdict::at_end).
    pub(super) at_end: u32,
    /// The lanes that did not converge.
    pub(super) unconverged: u32,
    /// Newton's steps taken, over all lanes.
    pub(super) steps: u32,
}

impl Default for PairLanes {
    fn default() -> Self {
        let lanes = [0.0; LANES];
        Self {
            start: [[0.0; LANES]; 2],
            distances: LaneDistances::default(),
            leaf_middle: [lanes; 3],
            half: [lanes; 2],
            middle: [lanes; 2],
            bend: lanes,
            third: lanes,
            clearance: lanes,
            residual_factor: lanes,
            magnitude: lanes,
            fit_error: [0.0; LANES],
            from_error: lanes,
            net: LaneNet::default(),
            z: lanes,
            z_error: lanes,
            st: [lanes; 2],
            point: [lanes; 3],
            cross: [lanes; 3],
        }
    }
}

impl PairLanes {
    /// Searches up to sixteen pairs of one form.
    #[simd]
    pub(super) fn search<S: Simd, Q: Shot>(
        &mut self,
        simd: S,
        view: &BvhView<'_>,
        shots: &[Q],
        pairs: &[Pair],
    ) -> Outcomes {
        let Some(first) = pairs.first() else { return Outcomes::default() };
        let mut rays = [shots[first.ray as usize].ray(); LANES];
        let mut pieces = [view.piece_of(first.leaf); LANES];
        let mut leaves = [view.fitted(first.leaf, &pieces[0].patch); LANES];
        // Lanes left over repeat the first.
        for (lane, pair) in pairs.iter().enumerate() {
            pieces[lane] = view.piece_of(pair.leaf);
            leaves[lane] = view.fitted(pair.leaf, &pieces[lane].patch);
            rays[lane] = shots[pair.ray as usize].ray();
        }
        for lane in 0..LANES {
            let pair = pairs.get(lane).unwrap_or(first);
            let from = shots[pair.ray as usize].start_in(view.set);
            self.take(lane, pair.guess, leaves[lane].leaf, pieces[lane]);
            self.from_error[lane] = from.map_or(0.0, |root| root.error);
        }

        let halves = [frames_of(simd, &rays, 0), frames_of(simd, &rays, 8)];
        let normals = [perpendicular(simd, halves[0].axis), perpendicular(simd, halves[1].axis)];
        self.take_distances(simd, &leaves, &halves, &normals);
        let start =
            [f32x16::from_slice(simd, &self.start[0]), f32x16::from_slice(simd, &self.start[1])];
        let widened = f32x16::splat(simd, WIDENED as f32);
        let searched = self.distances.newton(simd, start, [[-widened, widened]; 2]);
        let near = self.distances.refine(simd, &searched);
        let mut all = Outcomes::default();
        let mut wanted = ((1u64 << pairs.len()) - 1) as u32;
        // As a rule, a start outside leads to a root outside, which the proof shows sooner.
        let farthest = near[0].abs().max(near[1].abs());
        let outside = wanted & !lane_bits(farthest.simd_lt(widened));
        if outside != 0 {
            all.unconverged = outside & !self.missed(simd, outside, &leaves, &halves, &normals);
            wanted &= !outside;
        }
        for half in 0..2 {
            let wanted = half_of_sixteen(wanted, half);
            if wanted == 0 {
                continue;
            }
            let wanted = mask64x8::from_bitmask(simd, wanted);
            self.net.take(simd, first.form, &pieces, 8 * half, wanted);
            let near = [distances::widened(near[0], half), distances::widened(near[1], half)];
            let done = self.finish(simd, half, wanted, &halves[half], normals[half], &near);
            all.met |= done.met << (8 * half);
            all.undecided |= done.undecided << (8 * half);
            all.at_end |= done.at_end << (8 * half);
            all.unconverged |= done.unconverged << (8 * half);
            all.steps += done.steps;
        }
        all
    }

    /// Those of the `asked` lanes that are proved not to meet the leaf: see
    /// [`lanes`](crate::intersect::wide::proof::lanes).
    #[simd]
    fn missed<S: Simd>(
        &self,
        simd: S,
        asked: u32,
        leaves: &[Fitted<'_>; LANES],
        halves: &[EightRays<S>; 2],
        normals: &[[[f64x8<S>; 3]; 2]; 2],
    ) -> u32 {
        let zero = f32x16::splat(simd, 0.0);
        let mut sizes = [zero; 4];
        for (lane, leaf) in leaves.iter().enumerate() {
            let of_leaf = distances::sizes(simd, *leaf);
            for axis in 0..4 {
                sizes[axis][lane] = of_leaf[axis];
            }
        }
        let mut terms = zero;
        for k in 0..2 {
            let mut sum = f32x16::from_slice(simd, &self.distances.terms()[k][0]).abs() * sizes[3];
            for axis in 0..3 {
                let n = simd.narrow_f64x8(normals[0][k][axis], normals[1][k][axis]);
                sum = n.abs().mul_add(sizes[axis], sum);
            }
            terms = terms.max(sum);
        }
        let low = self.error(simd, &halves[0], 0);
        let high = self.error(simd, &halves[1], 1);
        let above = f32x16::splat(simd, (1.0 + f32::EPSILON) * leaves[0].heaviest());
        let error = simd.narrow_f64x8(low, high) * above;
        let noise = terms * f32x16::splat(simd, DISTANCE_ROUNDING);
        let off_ray = noise + f32x16::from_slice(simd, &self.fit_error) + error;
        // False for NaN.
        let known = asked & lane_bits(terms.simd_le(f32x16::splat(simd, LARGEST)));
        known & missed(simd, &self.distances, off_ray)
    }

    /// Error bounds of points' distances from eight rays.
    #[inline(always)]
    pub(super) fn error<S: Simd>(&self, simd: S, frames: &EightRays<S>, half: usize) -> f64x8<S> {
        let factor = eight(simd, &self.residual_factor, half);
        factor * frames.magnitude.max(eight(simd, &self.magnitude, half))
    }

    /// Where a lane's root is.
    #[inline(always)]
    pub(super) fn place(&self, lane: usize, leaf: u32) -> HitPlace {
        let st = DVec2::new(self.st[0][lane], self.st[1][lane]);
        HitPlace { leaf, z: self.z[lane], z_error: self.z_error[lane], st }
    }

    /// Puts a lane's root into a hit.
    #[inline(always)]
    pub(super) fn put<S: Simd>(&self, simd: S, lane: usize, leaf: u32, hit: &mut SingleHit) {
        hit.place = self.place(lane, leaf);
        for i in 0..3 {
            hit.point[i] = self.point[i][lane];
        }
        let [x, y, z] = [self.cross[0][lane], self.cross[1][lane], self.cross[2][lane]];
        let cross = DVec3::new(x, y, z);
        hit.set_normal(simd, cross, cross.length());
    }

    /// Takes in the data of a leaf except its approximation.
    #[inline(always)]
    fn take(&mut self, lane: usize, guess: Guess, leaf: &Leaf, piece: &Piece) {
        let rect = leaf.rect();
        for k in 0..2 {
            let [from, to] = rect[k];
            self.start[k][lane] = guess.start[k];
            self.half[k][lane] = 0.5 * (to - from);
            self.middle[k][lane] = 0.5 * (from + to);
        }
        for i in 0..3 {
            self.leaf_middle[i][lane] = leaf.middle[i];
        }
        self.bend[lane] = f64::from(leaf.fit_bend());
        self.third[lane] = leaf.fit_third();
        self.clearance[lane] = guess.clearance;
        self.residual_factor[lane] = piece.patch.residual_factor();
        self.magnitude[lane] = piece.patch.magnitude();
        self.fit_error[lane] = leaf.fit_error();
    }

    /// Sets the distances of the approximations from the rays' planes, as in
    /// [`LaneDistances::take`].
    #[simd]
    fn take_distances<S: Simd>(
        &mut self,
        simd: S,
        leaves: &[Fitted<'_>; LANES],
        halves: &[EightRays<S>; 2],
        normals: &[[[f64x8<S>; 3]; 2]; 2],
    ) {
        let zero = f64x8::splat(simd, 0.0);
        let mut middle = [[zero; 2]; 2];
        for half in 0..2 {
            let mut offset = [zero; 3];
            for i in 0..3 {
                offset[i] = eight(simd, &self.leaf_middle[i], half) - halves[half].origin[i];
            }
            for k in 0..2 {
                middle[k][half] = dot_d(normals[half][k], offset);
            }
        }
        for k in 0..2 {
            let mut normal = [[0.0; LANES]; 3];
            for i in 0..3 {
                let both = simd.narrow_f64x8(normals[0][k][i], normals[1][k][i]);
                both.store_slice(&mut normal[i]);
            }
            // Each lane's sixteen coefficients come first: so two matrices are transposed, not
            // three.
            let mut rows = [f32x16::splat(simd, 0.0); LANES];
            for lane in 0..LANES {
                let [x, y, z] = leaves[lane].leaf.fit();
                let sum = f32x16::splat(simd, normal[0][lane]) * f32x16::from_slice(simd, x);
                let ny = f32x16::splat(simd, normal[1][lane]);
                let sum = ny.mul_add(f32x16::from_slice(simd, y), sum);
                let nz = f32x16::splat(simd, normal[2][lane]);
                rows[lane] = nz.mul_add(f32x16::from_slice(simd, z), sum);
            }
            let middle = simd.narrow_f64x8(middle[k][0], middle[k][1]);
            // All leaves are of one form: if one is approximated by a quotient, all are.
            let weighted = leaves[0].weight.is_some();
            debug_assert!(leaves.iter().all(|leaf| leaf.weight.is_some() == weighted));
            if weighted {
                let mut of_lane = [0.0; LANES];
                middle.store_slice(&mut of_lane);
                for lane in 0..LANES {
                    let Some(weight) = leaves[lane].weight else { continue };
                    let middle = f32x16::splat(simd, of_lane[lane]);
                    rows[lane] = f32x16::from_slice(simd, weight).mul_add(middle, rows[lane]);
                }
            }
            let mut columns = transposed(rows);
            if !weighted {
                columns[0] += middle;
            }
            let to = &mut self.distances.terms_mut()[k];
            for m in 0..16 {
                columns[m].store_slice(&mut to[m]);
            }
        }
    }
}

/// One half of the lanes.
#[inline(always)]
pub(super) fn eight<S: Simd>(simd: S, lanes: &Lanes, half: usize) -> f64x8<S> {
    f64x8::from_slice(simd, &lanes[8 * half..8 * half + 8])
}

#[inline(always)]
fn frames_of<S: Simd>(simd: S, rays: &[&Ray; LANES], first: usize) -> EightRays<S> {
    let mut eight = [rays[first]; 8];
    eight.copy_from_slice(&rays[first..first + 8]);
    EightRays::new(simd, eight)
}
