//! What the bicubic approximations of leaves prove of sixteen rays, each lane as in
//! [`single_proof`](super::single_proof).
//!
//! Of whole leaves all rays are asked at once. Most need no more, some many parts: so the lanes
//! hold parts, sixteen at a time, of whichever rays ([`LaneParts`]). Which parts a ray is asked for, and
//! what is proved of them, depends on the ray and the leaf alone.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16, u8x64};
use fearless_simd_macros::simd;

use super::LANES;
use super::cubic::{bernstein, moved, slope_weight};
use super::distances::LaneDistances;
use super::lane_parts::{LaneParts, Sixteen};
use super::search::bits;
use super::single_proof::{
    MOST_NOISE, MOST_TURNING, NEARBY, Part, REACH, ROUNDING, SMALLEST, UNDERFLOW,
};

/// How often a leaf is halved before the scalar search is called.
const MOST_HALVINGS: u32 = 14;

/// Scratch memory.
#[derive(Debug, Default)]
pub(super) struct Parts {
    /// To be looked at.
    waiting: LaneParts,
    /// With one root at most for their rays.
    unique: LaneParts,
}

/// What is asked of the parts of leaves, each for one ray.
pub(super) struct LaneProof<'a, S: Simd> {
    simd: S,
    distances: &'a LaneDistances,
    parts: &'a mut Parts,
    /// The lengths, about, of the leaves' half sides.
    lengths: [f32x16<S>; 2],
    errors: Errors<S>,
    /// The lanes of which nothing could be proved.
    pub(super) undecided: u32,
}

/// How far what is computed may be off, lane by lane.
#[derive(Clone, Copy)]
pub(super) struct Errors<S: Simd> {
    /// How far a point may be from the ray.
    pub(super) error: f32x16<S>,
    /// A ray that passes within the error of a border meets it: closer is not missed.
    pub(super) off_ray: f32x16<S>,
    pub(super) slope_noise: f32x16<S>,
}

impl<'a, S: Simd> LaneProof<'a, S> {
    /// For the lanes that are `asked` for.
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        (distances, parts): (&'a LaneDistances, &'a mut Parts),
        lengths: [f32x16<S>; 2],
        errors: Errors<S>,
        asked: u32,
    ) -> Self {
        parts.waiting.clear();
        parts.unique.clear();
        let mut proof = Self { simd, distances, parts, lengths, errors, undecided: 0 };
        let Part { middle, half } = Part::whole();
        let whole = Sixteen::all(simd, middle, half);
        let local = Local::over(simd, distances, &whole, None);
        proof.look_at(&whole, asked, &local, (&errors, lengths));
        proof
    }

    /// A part for each of some lanes that has one root at most in it: all of their roots are in
    /// such parts, but for the lanes that are `undecided` at the end.
    ///
    /// Lanes that are undecided by now are told no more parts: which of theirs were looked at before
    /// that was known depends on the other lanes.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<(Sixteen<S>, u32)> {
        while let Some((parts, taken)) = self.parts.waiting.pop(self.simd) {
            look_at_parts(self.simd, self, &parts, taken);
        }
        let (parts, lanes) = self.parts.unique.pop_by_lane(self.simd)?;
        Some((parts, lanes & !self.undecided))
    }

    /// Looks at the halves of parts told last for these lanes, too.
    #[inline(always)]
    pub(super) fn go_on(&mut self, parts: &Sixteen<S>, lanes: u32) {
        if lanes != 0 {
            let bytes = parts.bytes_of_lanes(self.simd);
            let lengths = [self.lengths[0].swizzle_dyn(bytes), self.lengths[1].swizzle_dyn(bytes)];
            self.halve(parts, lengths, lanes);
        }
    }

    /// Parts `asked` for whose distances are given.
    #[inline(always)]
    fn look_at(
        &mut self,
        parts: &Sixteen<S>,
        asked: u32,
        local: &Local,
        (errors, lengths): (&Errors<S>, [f32x16<S>; 2]),
    ) {
        let simd = self.simd;
        let open = asked & !local.missed(simd, errors.off_ray);
        if open == 0 {
            return;
        }
        let [half_x, half_y] = parts.half;
        let smallest = f32x16::splat(simd, SMALLEST);
        let slope_error = errors.slope_noise * half_x.max(half_y);
        let large = bits(half_x.simd_gt(smallest) & half_y.simd_gt(smallest));
        let unique = open
            & local.unique(simd, slope_error, errors.error)
            & !(large & local.leading_away(simd));
        if unique != 0 {
            self.parts.unique.push(parts, mask(simd, unique));
        }
        if open != unique {
            self.halve(parts, lengths, open & !unique);
        }
    }

    #[inline(always)]
    fn halve(&mut self, parts: &Sixteen<S>, lengths: [f32x16<S>; 2], places: u32) {
        let simd = self.simd;
        let small = places & bits(parts.halved_so_often(simd, MOST_HALVINGS));
        self.undecided |= lanes_of(parts, small);
        let places = mask(simd, places & !small);
        let [first, second] = parts.halved(simd, lengths);
        self.parts.waiting.push(&first, places);
        self.parts.waiting.push(&second, places);
    }
}

/// Looks at parts of any lanes: those whose bit is set.
#[simd]
fn look_at_parts<S: Simd>(simd: S, proof: &mut LaneProof<'_, S>, parts: &Sixteen<S>, taken: u32) {
    let mut asked = taken;
    if proof.undecided != 0 {
        for place in 0..LANES {
            asked &= !((proof.undecided >> parts.lane(place) & 1) << place);
        }
    }
    if asked == 0 {
        return;
    }
    let bytes = parts.bytes_of_lanes(simd);
    let local = Local::over(simd, proof.distances, parts, Some(bytes));
    let Errors { error, off_ray, slope_noise } = proof.errors;
    let errors = Errors {
        error: error.swizzle_dyn(bytes),
        off_ray: off_ray.swizzle_dyn(bytes),
        slope_noise: slope_noise.swizzle_dyn(bytes),
    };
    let [length_x, length_y] = proof.lengths;
    let lengths = [length_x.swizzle_dyn(bytes), length_y.swizzle_dyn(bytes)];
    proof.look_at(parts, asked, &local, (&errors, lengths));
}

/// The bits of the lanes of parts in these places.
#[inline(always)]
fn lanes_of<S: Simd>(parts: &Sixteen<S>, mut places: u32) -> u32 {
    let mut lanes = 0;
    while places != 0 {
        lanes |= 1 << parts.lane(places.trailing_zeros() as usize);
        places &= places - 1;
    }
    lanes
}

#[inline(always)]
fn mask<S: Simd>(simd: S, bits: u32) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, u64::from(bits))
}

/// The lanes with no root in the whole leaf; `error` is how far the distances may be off.
#[simd]
pub(super) fn missed<S: Simd>(simd: S, distances: &LaneDistances, error: f32x16<S>) -> u32 {
    let Part { middle, half } = Part::whole();
    let whole = Sixteen::all(simd, middle, half);
    let local = Local::over(simd, distances, &whole, None);
    local.missed(simd, error)
}

/// The distances of sixteen rays, each over a part, in coordinates from −1 to 1.
#[derive(Default)]
struct Local(LaneDistances);

impl Local {
    /// From the distances of the parts' lanes, which `bytes` tells if not every part is in its
    /// lane's place.
    #[inline(always)]
    fn over<S: Simd>(
        simd: S,
        distances: &LaneDistances,
        parts: &Sixteen<S>,
        bytes: Option<u8x64<S>>,
    ) -> Self {
        let mut local = Self::default();
        let zero = f32x16::splat(simd, 0.0);
        let (in_x, in_y) = ((parts.middle[0], parts.half[0]), (parts.middle[1], parts.half[1]));
        for k in 0..2 {
            let to = &mut local.0.of[k];
            for j in 0..4 {
                let mut column = [zero; 4];
                for i in 0..4 {
                    column[i] = f32x16::from_slice(simd, &distances.of[k][4 * i + j]);
                    if let Some(bytes) = bytes {
                        column[i] = column[i].swizzle_dyn(bytes);
                    }
                }
                let column = moved(simd, column, in_x);
                for i in 0..4 {
                    column[i].store_slice(&mut to[4 * i + j]);
                }
            }
            for i in 0..4 {
                let mut row = [zero; 4];
                for j in 0..4 {
                    row[j] = f32x16::from_slice(simd, &to[4 * i + j]);
                }
                let row = moved(simd, row, in_y);
                for j in 0..4 {
                    row[j].store_slice(&mut to[4 * i + j]);
                }
            }
        }
        local
    }

    #[inline(always)]
    fn at<S: Simd>(&self, simd: S, k: usize, m: usize) -> f32x16<S> {
        f32x16::from_slice(simd, &self.0.of[k][m])
    }

    /// The derivatives in the middle, by `x` and by `y`, of both distances.
    #[inline(always)]
    fn slopes<S: Simd>(&self, simd: S) -> [[f32x16<S>; 2]; 2] {
        [[self.at(simd, 0, 4), self.at(simd, 1, 4)], [self.at(simd, 0, 1), self.at(simd, 1, 1)]]
    }

    /// The lanes with no root in the part; `error` is how far the distances may be off.
    #[inline(always)]
    fn missed<S: Simd>(&self, simd: S, error: f32x16<S>) -> u32 {
        let [[a1, a2], [b1, b2]] = self.slopes(simd);
        let underflow = f32x16::splat(simd, UNDERFLOW);
        let mut missed = 0;
        for [along_1, along_2] in [[b1, b2], [a1, a2]] {
            let [least, most] = self.range(simd, along_2, along_1);
            let off = error.mul_add(along_1.abs() + along_2.abs(), underflow);
            missed |= bits(least.simd_gt(off)) | bits(most.simd_lt(-off));
        }
        missed
    }

    /// The lanes for which Newton's step from the middle leads to a place outside, where the
    /// iteration for the one root of this part could not follow: halves can be proved to be missed.
    #[simd]
    fn leading_away<S: Simd>(&self, simd: S) -> u32 {
        let [[a1, a2], [b1, b2]] = self.slopes(simd);
        let (f1, f2) = (self.at(simd, 0, 0), self.at(simd, 1, 0));
        let farthest = f32x16::splat(simd, NEARBY) * (a1 * b2 - a2 * b1).abs();
        bits((f1 * b2 - f2 * b1).abs().simd_gt(farthest))
            | bits((a1 * f2 - a2 * f1).abs().simd_gt(farthest))
    }

    /// The lanes with at most one root in the widened part.
    #[simd]
    fn unique<S: Simd>(&self, simd: S, slope_error: f32x16<S>, error: f32x16<S>) -> u32 {
        let one = f32x16::splat(simd, 1.0);
        let [[a1, a2], [b1, b2]] = self.slopes(simd);
        let inverse = one / (a1 * b2 - a2 * b1);
        let [a1, a2, b1, b2] = [a1 * inverse, a2 * inverse, b1 * inverse, b2 * inverse];
        let mut size = f32x16::splat(simd, 0.0);
        for k in 0..2 {
            for m in 0..16 {
                size += self.at(simd, k, m).abs();
            }
        }
        let rounding = f32x16::splat(simd, ROUNDING);
        let slope_error = rounding.mul_add(size, slope_error) * f32x16::splat(simd, 2.0);
        let mut unique = u32::MAX;
        for [along_1, along_2] in [[b1, b2], [-a1, -a2]] {
            let mut slope = f32x16::splat(simd, 0.0);
            for m in 1..16 {
                let g = self.combined(simd, m, along_2, along_1);
                slope = g.abs().mul_add(f32x16::splat(simd, SLOPE_WEIGHTS[m]), slope);
            }
            // What is wanted of g is part of the sum: 1. False for NaN.
            let reach = along_1.abs() + along_2.abs();
            let turning = reach.mul_add(slope_error, slope - one);
            unique &= bits(turning.simd_lt(f32x16::splat(simd, MOST_TURNING)));
            unique &= bits((reach * error).simd_le(f32x16::splat(simd, MOST_NOISE)));
        }
        unique
    }

    /// A coefficient of `p f₁ − q f₂`.
    #[inline(always)]
    fn combined<S: Simd>(&self, simd: S, m: usize, p: f32x16<S>, q: f32x16<S>) -> f32x16<S> {
        p * self.at(simd, 0, m) - q * self.at(simd, 1, m)
    }

    /// The least and the greatest Bernstein coefficient of `p f₁ − q f₂`.
    #[inline(always)]
    fn range<S: Simd>(&self, simd: S, p: f32x16<S>, q: f32x16<S>) -> [f32x16<S>; 2] {
        let mut g = [[f32x16::splat(simd, 0.0); 4]; 4];
        for j in 0..4 {
            let mut column = [p; 4];
            for i in 0..4 {
                column[i] = self.combined(simd, 4 * i + j, p, q);
            }
            let column = bernstein(simd, column);
            for i in 0..4 {
                g[i][j] = column[i];
            }
        }
        let mut least = f32x16::splat(simd, f32::INFINITY);
        let mut most = f32x16::splat(simd, f32::NEG_INFINITY);
        for i in 0..4 {
            let [a, b, c, d] = bernstein(simd, g[i]);
            least = least.min(a.min(b).min(c.min(d)));
            most = most.max(a.max(b).max(c.max(d)));
        }
        [least, most]
    }
}

/// `(i + j) REACHⁱ⁺ʲ⁻¹`.
const SLOPE_WEIGHTS: [f32; 16] = {
    let mut weights = [0.0; 16];
    let mut k = 1;
    while k < 16 {
        weights[k] = slope_weight(k / 4, k % 4, REACH);
        k += 1;
    }
    weights
};
