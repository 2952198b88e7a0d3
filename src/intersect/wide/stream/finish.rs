//! Eight pairs of a ray and a leaf, in f64 on the true surfaces.

use fearless_simd::{Simd, SimdBase, SimdMask, f64x8, mask64x8};
use fearless_simd_macros::simd;

use super::pairs::{Outcomes, PairLanes, eight};
use crate::intersect::wide::frames::EightRays;
use crate::intersect::wide::reach::WIDENED;
use crate::intersect::wide::search::newton::{Ends, Leaves, Rays, Step, newton};
use crate::intersect::wide::surface::jets::jets;
use crate::intersect::wide::surface::lane_net::LaneNet;
use crate::intersect::wide::surface::sums::Jets;

impl PairLanes {
    /// Takes Newton's steps in f64 for one half of the pairs.
    #[simd]
    pub(super) fn finish<S: Simd>(
        &mut self,
        simd: S,
        half: usize,
        wanted: mask64x8<S>,
        frames: &EightRays<S>,
        normals: [[f64x8<S>; 3]; 2],
        near: &[f64x8<S>; 2],
    ) -> Outcomes {
        let widened = f64x8::splat(simd, WIDENED);
        let error = self.error(simd, frames, half);
        let rays = PairRays { frames, normals, error };
        let sides = [eight(simd, &self.half[0], half), eight(simd, &self.half[1], half)];
        let middle = [eight(simd, &self.middle[0], half), eight(simd, &self.middle[1], half)];
        let leaves = EightLeaves {
            net: &self.net,
            half: sides,
            middle,
            domain: [
                middle[0] - sides[0] * widened,
                middle[0] + sides[0] * widened,
                middle[1] - sides[1] * widened,
                middle[1] + sides[1] * widened,
            ],
            bend: eight(simd, &self.bend, half),
            third: eight(simd, &self.third, half),
            clearance: eight(simd, &self.clearance, half),
            own_error: eight(simd, &self.residual_factor, half)
                * eight(simd, &self.magnitude, half),
        };
        let mut root = newton(simd, &leaves, &rays, wanted, near);
        let (unconverged, steps) = (root.unconverged.to_bitmask() as u32, root.steps);
        if root.found.all_false() {
            return Outcomes { unconverged, steps, ..Outcomes::default() };
        }
        // The point and the normal at the place itself, not at one a last step away.
        root.look(simd, &leaves);
        let from_error = Some(eight(simd, &self.from_error, half));
        let ends = Ends { z: frames.ends, from_error };
        let verdict = root.verdict(simd, &ends, error, true);
        let met = verdict.acceptable & root.z.simd_lt(frames.ends[1]);
        let to = 8 * half..8 * half + 8;
        root.z.store_slice(&mut self.z[to.clone()]);
        verdict.z_error.store_slice(&mut self.z_error[to.clone()]);
        for k in 0..2 {
            root.st[k].store_slice(&mut self.st[k][to.clone()]);
        }
        for i in 0..3 {
            root.point[i].store_slice(&mut self.point[i][to.clone()]);
            root.cross[i].store_slice(&mut self.cross[i][to.clone()]);
        }
        let [met, undecided, at_end] =
            [met, verdict.undecided, verdict.at_end].map(|lanes| lanes.to_bitmask() as u32);
        Outcomes { met, undecided, at_end, unconverged, steps }
    }
}

/// The rays of eight pairs.
struct PairRays<'a, S: Simd> {
    frames: &'a EightRays<S>,
    normals: [[f64x8<S>; 3]; 2],
    error: f64x8<S>,
}

impl<S: Simd> Rays<S, f64x8<S>> for PairRays<'_, S> {
    #[inline(always)]
    fn origin(&self, _: S) -> [f64x8<S>; 3] {
        self.frames.origin
    }

    #[inline(always)]
    fn axis(&self, _: S) -> [f64x8<S>; 3] {
        self.frames.axis
    }

    #[inline(always)]
    fn normals(&self, _: S) -> [[f64x8<S>; 3]; 2] {
        self.normals
    }

    #[inline(always)]
    fn error(&self) -> f64x8<S> {
        self.error
    }
}

/// The leaves of eight pairs.
struct EightLeaves<'a, S: Simd> {
    net: &'a LaneNet,
    half: [f64x8<S>; 2],
    middle: [f64x8<S>; 2],
    domain: [f64x8<S>; 4],
    bend: f64x8<S>,
    third: f64x8<S>,
    clearance: f64x8<S>,
    own_error: f64x8<S>,
}

impl<S: Simd> Leaves<S, f64x8<S>> for EightLeaves<'_, S> {
    #[inline(always)]
    fn jets(&self, simd: S, st: &[f64x8<S>; 2]) -> Jets<f64x8<S>> {
        jets::<_, _, _, true>(simd, self.net, self.net.form, st)
    }

    #[inline(always)]
    fn tangents(&self, simd: S, st: &[f64x8<S>; 2]) -> Jets<f64x8<S>> {
        jets::<_, _, _, false>(simd, self.net, self.net.form, st)
    }

    #[inline(always)]
    fn half(&self, _: S) -> [f64x8<S>; 2] {
        self.half
    }

    #[inline(always)]
    fn per_half(&self, simd: S) -> [f64x8<S>; 2] {
        let one = f64x8::splat(simd, 1.0);
        [one / self.half[0], one / self.half[1]]
    }

    #[inline(always)]
    fn middle(&self, _: S) -> [f64x8<S>; 2] {
        self.middle
    }

    #[inline(always)]
    fn domain(&self, _: S) -> [f64x8<S>; 4] {
        self.domain
    }

    #[inline(always)]
    fn bend(&self, _: S) -> f64x8<S> {
        self.bend
    }

    #[inline(always)]
    fn third(&self, _: S) -> f64x8<S> {
        self.third
    }

    #[inline(always)]
    fn own_error(&self, _: S) -> f64x8<S> {
        self.own_error
    }

    /// Both are evaluated at the roots instead.
    #[inline(always)]
    fn asks_places(&self) -> bool {
        false
    }

    #[inline(always)]
    fn clearance<R: Rays<S, f64x8<S>>>(&self, _: S, _: &R) -> f64x8<S> {
        self.clearance
    }

    /// None: such rays are left to their own proof.
    #[inline(always)]
    fn surely_away<R: Rays<S, f64x8<S>>>(&self, simd: S, _: &R, _: &Step<f64x8<S>>) -> mask64x8<S> {
        simd.splat_mask64x8(false)
    }
}
