//! What a leaf's bicubic approximation proves of sixteen rays, each lane as in
//! [`single_proof`](super::single_proof).
//!
//! All lanes look at the same parts of the leaf, each for as long as it needs to: which parts
//! those are depends on the leaf alone, and what is proved of them on the lane alone.

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;

use super::LANES;
use super::cubic::{bernstein, moved, slope_weight};
use super::distances::LaneDistances;
use super::packet::Packet;
use super::search::bits;
use super::single_proof::{
    LARGEST, MOST_NOISE, MOST_TURNING, NEARBY, Part, REACH, ROUNDING, SMALLEST, UNDERFLOW,
};
use crate::patch::Leaf;

/// How often a leaf is halved before the scalar search is called.
const MOST_HALVINGS: usize = 14;

/// A part of a leaf, and the lanes whose roots in it are looked for.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LanePart {
    pub(super) part: Part,
    pub(super) lanes: u32,
    /// How often the leaf was halved.
    depth: usize,
}

/// What is asked of all parts of a leaf.
pub(super) struct LaneProof<'a, S: Simd> {
    simd: S,
    distances: &'a LaneDistances,
    /// The lengths, about, of the leaf's half sides.
    lengths: [f32; 2],
    /// How far a point may be from the ray.
    error: f32x16<S>,
    /// A ray that passes within the error of a border meets it: closer is not missed.
    off_ray: f32x16<S>,
    slope_noise: f32x16<S>,
    waiting: [LanePart; MOST_HALVINGS + 1],
    count: usize,
    /// The part that was told last, and the lanes for which its halves are to be looked at.
    last: LanePart,
    /// The lanes of which nothing could be proved.
    pub(super) undecided: u32,
}

impl<'a, S: Simd> LaneProof<'a, S> {
    /// All of a leaf; `error` is how far a point may be from the ray.
    #[inline(always)]
    pub(super) fn new(
        simd: S,
        distances: &'a LaneDistances,
        leaf: &Leaf,
        (packet, base): (&Packet, usize),
        (lanes, error): (u32, f32x16<S>),
    ) -> Self {
        let terms = distances.terms(simd, leaf, packet, base);
        // False for NaN.
        let undecided = lanes & !bits(terms.simd_le(f32x16::splat(simd, LARGEST)));
        let noise = terms * f32x16::splat(simd, ROUNDING);
        let mut waiting = [LanePart::default(); MOST_HALVINGS + 1];
        waiting[0] = LanePart { part: Part::whole(), lanes, depth: 0 };
        Self {
            simd,
            distances,
            lengths: leaf.side_lengths(),
            error,
            off_ray: noise + f32x16::splat(simd, leaf.fit_error()) + error,
            slope_noise: noise + f32x16::splat(simd, leaf.slope_error()),
            waiting,
            count: 1,
            last: LanePart::default(),
            undecided,
        }
    }

    /// The next part, and the lanes that have one root at most in it: all of their roots are in
    /// such parts, but for the lanes that are `undecided` at the end.
    #[inline(always)]
    pub(super) fn next(&mut self) -> Option<LanePart> {
        self.halve_last();
        while self.count > 0 {
            self.count -= 1;
            let mut task = self.waiting[self.count];
            task.lanes &= !self.undecided;
            if task.lanes == 0 {
                continue;
            }
            let look = (self.distances, [self.error, self.off_ray, self.slope_noise]);
            let (open, alone) = look_at(self.simd, look, &task);
            self.last = LanePart { lanes: open & !alone, ..task };
            if alone != 0 {
                return Some(LanePart { lanes: alone, ..task });
            }
            self.halve_last();
        }
        None
    }

    /// Looks at the halves of the part told last for these lanes, too.
    #[inline(always)]
    pub(super) fn go_on(&mut self, lanes: u32) {
        self.last.lanes |= lanes;
    }

    #[inline(always)]
    fn halve_last(&mut self) {
        let LanePart { part, lanes, depth } = std::mem::take(&mut self.last);
        if lanes == 0 {
            return;
        }
        if depth == MOST_HALVINGS {
            self.undecided |= lanes;
            return;
        }
        // One part makes place for two, at most once at each depth.
        for part in part.halved(self.lengths) {
            self.waiting[self.count] = LanePart { part, lanes, depth: depth + 1 };
            self.count += 1;
        }
    }
}

/// The lanes that may have roots in a part, and those that have one at most.
#[simd]
fn look_at<S: Simd>(
    simd: S,
    (distances, [error, off_ray, slope_noise]): (&LaneDistances, [f32x16<S>; 3]),
    task: &LanePart,
) -> (u32, u32) {
    let mut local = Local::default();
    local.take(simd, distances, &task.part);
    let open = task.lanes & !local.missed(simd, off_ray);
    if open == 0 {
        return (0, 0);
    }
    let [half_x, half_y] = task.part.half;
    let slope_error = slope_noise * f32x16::splat(simd, half_x.max(half_y));
    let mut alone = open & local.unique(simd, slope_error, error);
    if half_x > SMALLEST && half_y > SMALLEST {
        alone &= !local.leading_away(simd);
    }
    (open, alone)
}

/// The lanes with no root in the whole leaf; `error` is how far the distances may be off.
#[simd]
pub(super) fn missed<S: Simd>(simd: S, distances: &LaneDistances, error: f32x16<S>) -> u32 {
    let mut local = Local::default();
    local.take(simd, distances, &Part::whole());
    local.missed(simd, error)
}

/// The distances over a part, in coordinates from −1 to 1.
#[derive(Default)]
struct Local(LaneDistances);

impl Local {
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, distances: &LaneDistances, part: &Part) {
        let (middle, half) = (part.middle, part.half);
        for k in 0..2 {
            let (from, to) = (&distances.of[k], &mut self.0.of[k]);
            for j in 0..4 {
                let column = [0, 4, 8, 12];
                let c = moved(simd, load4(simd, from, column, j), (middle[0], half[0]));
                store4(simd, to, column, j, c);
            }
            for i in 0..4 {
                let row = [0, 1, 2, 3];
                let c = moved(simd, load4(simd, to, row, 4 * i), (middle[1], half[1]));
                store4(simd, to, row, 4 * i, c);
            }
        }
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

#[inline(always)]
fn load4<S: Simd>(
    simd: S,
    lanes: &[[f32; LANES]; 16],
    places: [usize; 4],
    from: usize,
) -> [f32x16<S>; 4] {
    let [a, b, c, d] = places;
    [
        f32x16::from_slice(simd, &lanes[a + from]),
        f32x16::from_slice(simd, &lanes[b + from]),
        f32x16::from_slice(simd, &lanes[c + from]),
        f32x16::from_slice(simd, &lanes[d + from]),
    ]
}

#[inline(always)]
fn store4<S: Simd>(
    _simd: S,
    lanes: &mut [[f32; LANES]; 16],
    places: [usize; 4],
    from: usize,
    values: [f32x16<S>; 4],
) {
    for k in 0..4 {
        values[k].store_slice(&mut lanes[places[k] + from]);
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
