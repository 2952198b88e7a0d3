//! Which leaves cannot lie ahead of rays that start on them.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8};
use fearless_simd_macros::simd;

use super::hits::{gather, pair};
use super::rays::Packet;
use super::target::Target;
use crate::intersect::wide::proof::departure::{Departure, Final, MAY_START};
use crate::intersect::wide::search::distances::widened;
use crate::intersect::wide::vectors::load3;
use crate::math::bits::set_bits;

impl Packet {
    /// One bit for each of the sixteen rays from `base` on that starts on a leaf, or near it on its
    /// piece, and is proved not to have that leaf ahead of it again. The error bound of a point's
    /// distance from a ray is the ray's magnitude times `factor`.
    #[simd]
    pub(super) fn departs_from<S: Simd>(
        &self,
        simd: S,
        base: usize,
        target: &Target<'_>,
        magnitude: f32x16<S>,
        factor: f64,
    ) -> u32 {
        let leaf = target.leaf;
        let nearby = [f32x16::splat(simd, -MAY_START), f32x16::splat(simd, MAY_START)];
        let here = self.starts.are_in(
            simd,
            base,
            leaf.piece,
            &[target.parameters(simd, &[nearby; 2], |ends| widened(ends, 0)); 2],
        );
        if here == 0 {
            return 0;
        }
        let mut ahead = 0;
        let zero = f64x8::splat(simd, 0.0);
        let (mut place, mut origin, mut known) = ([[zero; 2]; 2], [[zero; 2]; 3], [zero; 2]);
        for half in 0..2 {
            let eight = base + 8 * half..base + 8 * half + 8;
            let z_min = f64x8::from_slice(simd, &self.rays.z_min[eight.clone()]);
            ahead |= (z_min.simd_ge(zero).to_bitmask() as u32) << (8 * half);
            for k in 0..2 {
                let [from, to] = leaf.rect()[k];
                let at = f64x8::from_slice(simd, &self.starts.st[k][eight.clone()]);
                let twice = at + at - f64x8::splat(simd, from + to);
                place[k][half] = twice * f64x8::splat(simd, 1.0 / (to - from));
            }
            for k in 0..3 {
                let at = f64x8::from_slice(simd, &self.rays.origin[k][eight.clone()]);
                origin[k][half] = at - f64x8::splat(simd, leaf.middle[k]);
            }
            known[half] = f64x8::from_slice(simd, &self.starts.error[eight]);
        }
        if here & ahead == 0 {
            return 0;
        }
        let narrow = |[low, high]: [f64x8<S>; 2]| simd.narrow_f64x8(low, high);
        // Both are rounded up by more than their rounding errors.
        let error = magnitude * f32x16::splat(simd, 1.001 * factor as f32);
        let departure = Departure {
            place: [narrow(place[0]), narrow(place[1])],
            origin: [narrow(origin[0]), narrow(origin[1]), narrow(origin[2])],
            axis: load3(simd, &self.scaled.axis, base),
            reach: narrow(known).mul_add(f32x16::splat(simd, 1.001), error),
        };
        let Final { mut surely, if_near } = departure.is_final(simd, target.fitted());
        for k in set_bits(here & ahead & if_near & !surely) {
            let at = base + k;
            let point = target.piece.patch.point(pair(&self.starts.st, at));
            let reach = self.starts.error[at] + factor * f64::from(magnitude[k]);
            surely |= u32::from(point.distance(gather(&self.rays.origin, at)) <= reach) << k;
        }
        here & ahead & surely
    }
}
