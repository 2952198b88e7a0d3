//! Proofs from the bicubic approximations of leaves for sixteen rays: what is proved of a part is
//! what [`one_ray`](super::one_ray) proves of it.
//!
//! The limits are others: one ray alone is left to the scalar search after a number of parts, or of
//! parts with a root each; a lane is only where a part that was halved `MOST_HALVINGS` times would
//! have to be halved again.
//!
//! Some rays need many parts. So the lanes hold parts of any of the rays, sixteen at a time
//! ([`LaneParts`]). Which parts of a ray are examined, and what is proved of them, depends on the
//! ray and the leaf alone.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, mask32x16, u8x64};
use fearless_simd_macros::simd;

use super::bounds::{
    DISTANCE_ROUNDING, GROWN, LeafPart, MAY_STEP, MOST_INVERSE, MOST_NOISE, SMALLEST, UNDERFLOW,
};
use super::cubic::{bernstein, moved, slope_weights};
use super::lane_parts::{LaneParts, PartSixteen};
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::search::distances::LaneDistances;
use crate::intersect::wide::vectors::lane_bits;
use crate::math::bits::set_bits;

/// How often a leaf is halved before it is left to the scalar search.
const MOST_HALVINGS: u32 = 14;

/// Scratch memory.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// Parts still to be examined.
    waiting: LaneParts,
    /// Parts with at most one root of their rays.
    unique: LaneParts,
}

/// The proofs for parts of leaves, each for one ray.
pub(crate) struct LaneProof<'a, S: Simd> {
    simd: S,
    distances: &'a LaneDistances,
    parts: &'a mut Parts,
    /// The approximate lengths of the leaves' half sides.
    lengths: [f32x16<S>; 2],
    errors: Errors<S>,
    /// The lanes for which nothing could be proved.
    pub undecided: u32,
}

/// Error bounds of what is computed, lane by lane.
#[derive(Clone, Copy)]
pub(crate) struct Errors<S: Simd> {
    /// Error bound of a point's distance from the ray, times the weight.
    pub error: f32x16<S>,
    /// A ray that passes within the error of a border meets it: what is closer than this is not
    /// missed.
    pub off_ray: f32x16<S>,
    pub slope_noise: f32x16<S>,
}

impl<'a, S: Simd> LaneProof<'a, S> {
    /// Begins the proof for the lanes that are `asked` for.
    #[inline(always)]
    pub(crate) fn new(
        simd: S,
        distances: &'a LaneDistances,
        parts: &'a mut Parts,
        lengths: [f32x16<S>; 2],
        errors: Errors<S>,
        asked: u32,
    ) -> Self {
        parts.waiting.clear();
        parts.unique.clear();
        let mut proof = Self { simd, distances, parts, lengths, errors, undecided: 0 };
        // The whole leaf shows little more than its certificate says.
        let LeafPart { middle, half } = LeafPart::whole();
        proof.halve(&PartSixteen::all(simd, middle, half), lengths, asked);
        proof
    }

    /// Returns a part for each of some lanes, with at most one root in it. All roots of a lane are
    /// in such parts, except for the lanes that are `undecided` at the end.
    ///
    /// Lanes that are undecided by now get no more parts: which of their parts were examined before
    /// that was known depends on the other lanes.
    #[inline(always)]
    pub(crate) fn next(&mut self) -> Option<(PartSixteen<S>, u32)> {
        while let Some((parts, taken)) = self.parts.waiting.pop(self.simd) {
            look_at_parts(self.simd, self, &parts, taken);
        }
        let (parts, lanes) = self.parts.unique.pop_by_lane(self.simd)?;
        Some((parts, lanes & !self.undecided))
    }

    /// Also examines the halves of the parts returned last for these lanes.
    #[inline(always)]
    pub(crate) fn go_on(&mut self, parts: &PartSixteen<S>, lanes: u32) {
        if lanes != 0 {
            let bytes = parts.bytes_of_lanes(self.simd);
            let lengths = [self.lengths[0].swizzle_dyn(bytes), self.lengths[1].swizzle_dyn(bytes)];
            self.halve(parts, lengths, lanes);
        }
    }

    #[inline(always)]
    fn halve(&mut self, parts: &PartSixteen<S>, lengths: [f32x16<S>; 2], places: u32) {
        let simd = self.simd;
        let small = places & lane_bits(parts.halved_so_often(simd, MOST_HALVINGS));
        self.undecided |= lanes_of(parts, small);
        let places = mask(simd, places & !small);
        let [first, second] = parts.halved(simd, lengths);
        self.parts.waiting.push(&first, places);
        self.parts.waiting.push(&second, places);
    }
}

/// Examines parts of any lanes: those whose bit is set in `taken`.
#[simd]
fn look_at_parts<S: Simd>(
    simd: S,
    proof: &mut LaneProof<'_, S>,
    parts: &PartSixteen<S>,
    taken: u32,
) {
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
    let open = asked & !local.missed(simd, off_ray.swizzle_dyn(bytes));
    if open == 0 {
        return;
    }
    let [half_x, half_y] = parts.half;
    let smallest = f32x16::splat(simd, SMALLEST);
    let slope_error = slope_noise.swizzle_dyn(bytes) * half_x.max(half_y);
    let large = lane_bits(half_x.simd_gt(smallest) & half_y.simd_gt(smallest));
    let unique = open
        & local.unique(simd, slope_error, error.swizzle_dyn(bytes))
        & !(large & local.leading_away(simd));
    if unique != 0 {
        proof.parts.unique.push(parts, mask(simd, unique));
    }
    if open != unique {
        let [length_x, length_y] = proof.lengths;
        let lengths = [length_x.swizzle_dyn(bytes), length_y.swizzle_dyn(bytes)];
        proof.halve(parts, lengths, open & !unique);
    }
}

/// The bits of the lanes whose parts are at these places.
#[inline(always)]
fn lanes_of<S: Simd>(parts: &PartSixteen<S>, places: u32) -> u32 {
    set_bits(places).fold(0, |lanes, place| lanes | 1 << parts.lane(place))
}

#[inline(always)]
fn mask<S: Simd>(simd: S, bits: u32) -> mask32x16<S> {
    mask32x16::from_bitmask(simd, u64::from(bits))
}

/// The lanes with no root in the whole leaf; `error` is the error bound of the distances.
#[simd]
pub(crate) fn missed<S: Simd>(simd: S, distances: &LaneDistances, error: f32x16<S>) -> u32 {
    let LeafPart { middle, half } = LeafPart::whole();
    let whole = PartSixteen::all(simd, middle, half);
    let local = Local::over(simd, distances, &whole, None);
    local.missed(simd, error)
}

/// The distances of sixteen rays, each over a part, in coordinates from −1 to 1.
#[derive(Default)]
struct Local(LaneDistances);

impl Local {
    /// The distances of the parts' lanes, over the parts; `bytes` gives these lanes if not every
    /// part is at its lane's place.
    #[inline(always)]
    fn over<S: Simd>(
        simd: S,
        distances: &LaneDistances,
        parts: &PartSixteen<S>,
        bytes: Option<u8x64<S>>,
    ) -> Self {
        let mut local = Self::default();
        let zero = f32x16::splat(simd, 0.0);
        let (in_x, in_y) = ((parts.middle[0], parts.half[0]), (parts.middle[1], parts.half[1]));
        for k in 0..2 {
            let to = &mut local.0.terms_mut()[k];
            for j in 0..4 {
                let mut column = [zero; 4];
                for i in 0..4 {
                    column[i] = f32x16::from_slice(simd, &distances.terms()[k][4 * i + j]);
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
        f32x16::from_slice(simd, &self.0.terms()[k][m])
    }

    /// The derivatives in the middle, by `x` and by `y`, of both distances.
    #[inline(always)]
    fn slopes<S: Simd>(&self, simd: S) -> [[f32x16<S>; 2]; 2] {
        [[self.at(simd, 0, 4), self.at(simd, 1, 4)], [self.at(simd, 0, 1), self.at(simd, 1, 1)]]
    }

    /// The lanes with no root in the part; `error` is the error bound of the distances.
    #[inline(always)]
    fn missed<S: Simd>(&self, simd: S, error: f32x16<S>) -> u32 {
        let [[a1, a2], [b1, b2]] = self.slopes(simd);
        let underflow = f32x16::splat(simd, UNDERFLOW);
        let mut missed = 0;
        for [along_1, along_2] in [[b1, b2], [a1, a2]] {
            let [least, most] = self.range(simd, along_2, along_1);
            let off = error.mul_add(along_1.abs() + along_2.abs(), underflow);
            missed |= lane_bits(least.simd_gt(off)) | lane_bits(most.simd_lt(-off));
        }
        missed
    }

    /// The lanes for which Newton's step from the middle leads out of the part, where the iteration
    /// for the part's one root could not follow; its halves can be proved to be missed.
    #[simd]
    fn leading_away<S: Simd>(&self, simd: S) -> u32 {
        let [[a1, a2], [b1, b2]] = self.slopes(simd);
        let (f1, f2) = (self.at(simd, 0, 0), self.at(simd, 1, 0));
        let farthest = f32x16::splat(simd, MAY_STEP) * (a1 * b2 - a2 * b1).abs();
        lane_bits((f1 * b2 - f2 * b1).abs().simd_gt(farthest))
            | lane_bits((a1 * f2 - a2 * f1).abs().simd_gt(farthest))
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
        let rounding = f32x16::splat(simd, DISTANCE_ROUNDING);
        let slope_error = (rounding + rounding).mul_add(size, slope_error);
        let mut unique = u32::MAX;
        let mut turning = [[one; 2]; 2];
        for (k, [along_1, along_2]) in [[b1, b2], [-a1, -a2]].into_iter().enumerate() {
            let reach = along_1.abs() + along_2.abs();
            let mut slope = [reach * slope_error; 2];
            for m in 1..16 {
                let size = self.combined(simd, m, along_2, along_1).abs();
                for (direction, slope) in slope.iter_mut().enumerate() {
                    let weight = SLOPE_WEIGHTS[direction][m];
                    if weight > 0.0 {
                        *slope = size.mul_add(f32x16::splat(simd, weight), *slope);
                    }
                }
            }
            turning[k] = slope;
            unique &= lane_bits((reach * error).simd_le(f32x16::splat(simd, MOST_NOISE)));
        }
        // The sums contain the 1 that is wanted on the diagonal of `g'`, hence the two: see
        // `one_ray`. All are false for NaN.
        let two = one + one;
        let [[xx, xy], [yx, yy]] = turning;
        let (left_x, left_y) = (two - xx, two - yy);
        let sure = (left_x * left_y - xy * yx) * f32x16::splat(simd, MOST_INVERSE);
        let zero = f32x16::splat(simd, 0.0);
        unique
            & lane_bits(left_x.simd_gt(zero))
            & lane_bits(left_y.simd_gt(zero))
            & lane_bits(sure.simd_gt(left_y + xy))
            & lane_bits(sure.simd_gt(left_x + yx))
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

/// `i GROWNⁱ⁺ʲ⁻¹`, and `j GROWNⁱ⁺ʲ⁻¹`.
const SLOPE_WEIGHTS: [[f32; 16]; 2] = {
    let mut weights = [[0.0; 16]; 2];
    let mut k = 1;
    while k < 16 {
        [weights[0][k], weights[1][k]] = slope_weights(k / 4, k % 4, GROWN);
        k += 1;
    }
    weights
};

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use fearless_simd::f32x8;
    use glam::{DMat2, DVec2};
    use proptest::prelude::*;

    use super::*;
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::intersect::wide::search::one_ray::Distances;
    use crate::math::testing::same_cases;

    /// Two bicubics: coefficients of `xⁱ yʲ`, at `4 i + j`.
    type Bicubics = [[f64; 16]; 2];

    fn value(of: &[f64; 16], at: DVec2) -> f64 {
        (0..16).map(|m| of[m] * at.x.powi(m as i32 / 4) * at.y.powi(m as i32 % 4)).sum()
    }

    /// The derivatives by `x` and by `y`, as columns.
    fn jacobian(of: &Bicubics, at: DVec2) -> DMat2 {
        let by = |of: &[f64; 16], k: usize| -> f64 {
            let term = |m: usize| {
                let mut powers = [m as i32 / 4, m as i32 % 4];
                let factor = f64::from(powers[k]);
                powers[k] = (powers[k] - 1).max(0);
                of[m] * factor * at.x.powi(powers[0]) * at.y.powi(powers[1])
            };
            (0..16).map(term).sum()
        };
        let column = |k: usize| DVec2::new(by(&of[0], k), by(&of[1], k));
        DMat2::from_cols(column(0), column(1))
    }

    /// The bicubics, changed to have roots at these two places.
    fn through(mut of: Bicubics, [p, q]: [DVec2; 2]) -> Bicubics {
        let way = q - p;
        for f in &mut of {
            f[0] -= value(f, p);
            let slope = value(f, q) / way.length_squared();
            f[0] += slope * way.dot(p);
            f[4] -= slope * way.x;
            f[1] -= slope * way.y;
        }
        of
    }

    /// What is proved of the whole of a leaf, each time by sixteen lanes and by the search of one
    /// ray.
    struct Said {
        /// That there is one root at most.
        unique: [bool; 2],
        /// That there is none, where distances may be off by a hundredth.
        missed: [bool; 2],
        /// That Newton's step leads away.
        away: [bool; 2],
    }

    /// What all lanes say, if they agree.
    fn of_all(lanes: u32) -> bool {
        assert!(lanes == 0 || lanes == (1 << LANES) - 1 || lanes == u32::MAX, "{lanes:#b}");
        lanes != 0
    }

    fn said(of: &Bicubics) -> Said {
        dispatch!(Kernel::best_level(), simd => {
            let mut lanes = LaneDistances::default();
            let mut rows = [f32x8::splat(simd, 0.0); 4];
            for k in 0..2 {
                for m in 0..16 {
                    lanes.terms_mut()[k][m] = [of[k][m] as f32; LANES];
                    rows[m / 4][4 * k + m % 4] = of[k][m] as f32;
                }
            }
            let part = LeafPart { middle: [0.0; 2], half: [1.0; 2] };
            let zero = f32x16::splat(simd, 0.0);
            let parts = PartSixteen::all(simd, part.middle, part.half);
            let local = Local::over(simd, &lanes, &parts, None);
            let one = Distances { rows }.over(simd, &part);
            let off = f32x16::splat(simd, 0.01);
            Said {
                unique: [of_all(local.unique(simd, zero, zero)), one.is_unique(simd, 0.0, 0.0)],
                missed: [of_all(local.missed(simd, off)), one.is_missed(simd, 0.01)],
                away: [of_all(local.leading_away(simd)), one.leads_away()],
            }
        })
    }

    /// For bent bicubics, at most three in twelve thousand results differ, by rounding.
    #[test]
    fn lanes_say_what_the_search_of_one_ray_says() {
        let coefficients = (0.0..0.3f64, 0.2..2.0f64, prop::collection::vec(-1.0..1.0f64, 32))
            .prop_map(|(bent, far, of)| {
                let mut two: Bicubics = [[0.0; 16]; 2];
                for (m, x) in of.into_iter().enumerate() {
                    let scale = match m % 16 / 4 + m % 4 {
                        0 => far,
                        1 => 0.5,
                        _ => bent,
                    };
                    two[m / 16][m % 16] = scale * x;
                }
                two[0][4] += 1.0;
                two[1][1] += 1.0;
                two
            });
        let counts = Cell::new([[0; 2]; 3]);
        proptest!(same_cases(4000), |(of in coefficients)| {
            let Said { unique, missed, away } = said(&of);
            let mut all = counts.get();
            for ([yes, differ], [lanes, one]) in all.iter_mut().zip([unique, missed, away]) {
                *yes += u32::from(one);
                *differ += u32::from(lanes != one);
            }
            counts.set(all);
        });
        let counts = counts.get();
        assert!(counts.iter().all(|[yes, _]| (300..3700).contains(yes)), "{counts:?}");
        assert!(counts.iter().map(|[_, differ]| differ).sum::<u32>() <= 3, "{counts:?}");
    }

    /// Uniqueness is never claimed for two functions with two common roots; where it is claimed,
    /// the inverse of the mean of the derivatives between any two places is as small as promised.
    #[test]
    fn one_root_is_one() {
        let bicubics =
            (0.0..0.2f64, prop::collection::vec(-1.0..1.0f64, 32)).prop_map(|(bent, of)| {
                let mut two: Bicubics = [[0.0; 16]; 2];
                for (m, x) in of.into_iter().enumerate() {
                    let (i, j) = (m % 16 / 4, m % 4);
                    two[m / 16][m % 16] = if i + j > 1 { bent * x } else { 0.5 * x };
                }
                two[0][4] += 1.0;
                two[1][1] += 1.0;
                two
            });
        let place = || (-1.1..=1.1f64, -1.1..=1.1f64).prop_map(|(x, y)| DVec2::new(x, y));
        let ends = || [place(), place()].prop_filter("apart", |[p, q]| p.distance(*q) > 1e-3);
        let [unique, folded] = [Cell::new(0), Cell::new(0)];
        let config = same_cases(4000);
        proptest!(config, |(of in bicubics, ends in ends())| {
            let two = through(of, ends);
            prop_assert_eq!(said(&two).unique, [false; 2], "{:?} has roots at {:?}", two, ends);
            folded.set(folded.get() + 1);
            let [lanes, one] = said(&of).unique;
            unique.set(unique.get() + u32::from(lanes) + u32::from(one));
            if lanes || one {
                // Gauss's rule with four points, exact for the mean.
                let nodes = [(-0.861_136_311_594_052_6, 0.347_854_845_137_453_85),
                    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1)];
                let mut mean = DMat2::ZERO;
                for (node, weight) in nodes {
                    for node in [node, -node] {
                        mean += 0.5 * weight * jacobian(&of, ends[0].lerp(ends[1], 0.5 + 0.5 * node));
                    }
                }
                let inverse = (jacobian(&of, DVec2::ZERO).inverse() * mean).inverse();
                let rows = inverse.row(0).abs().element_sum().max(inverse.row(1).abs().element_sum());
                prop_assert!(rows <= f64::from(MOST_INVERSE) * 1.001, "{rows}: {of:?}");
            }
        });
        let (unique, folded) = (unique.get(), folded.get());
        assert!(unique > 400 && folded > 3000, "{unique} of {folded}");
    }
}
