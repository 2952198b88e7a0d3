//! The roots that rays start on, and which leaves cannot lie ahead of such rays again.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8, u32x16};
use fearless_simd_macros::simd;

use super::hits::{gather, pair};
use super::rays::Packet;
use super::target::Target;
use crate::intersect::Shot;
use crate::intersect::hit::StartIn;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::PACKET;
use crate::intersect::wide::proof::departure::{Departure, Final, MAY_START};
use crate::intersect::wide::vectors::load3;
use crate::math::bits::set_bits;
use crate::patch::PatchSet;

/// The roots that the rays of a packet start on.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct Starts {
    /// Whether some rays start on a root.
    pub(super) exist: bool,
    /// The piece of each root; `u32::MAX` for none.
    pub(super) piece: [u32; PACKET],
    /// The place on the piece.
    pub(super) st: [[f64; PACKET]; 2],
    /// Error bound of the place along the ray.
    pub(super) error: [f64; PACKET],
}

impl Default for Starts {
    fn default() -> Self {
        Self {
            exist: false,
            piece: [u32::MAX; PACKET],
            st: [[0.0; PACKET]; 2],
            error: [0.0; PACKET],
        }
    }
}

impl Packet {
    /// Takes in the roots that rays start on.
    pub(super) fn start_on_roots<Q: Shot>(&mut self, shots: &[Q], set: &PatchSet) {
        self.starts.exist = shots.iter().any(|shot| shot.start_in(set).is_some());
        if !self.starts.exist {
            return;
        }
        self.starts.piece = [u32::MAX; PACKET];
        self.starts.error = [0.0; PACKET];
        for (k, shot) in shots.iter().enumerate() {
            if let Some(root) = shot.start_in(set) {
                self.starts.piece[k] = root.piece;
                (self.starts.st[0][k], self.starts.st[1][k]) = (root.st.x, root.st.y);
                self.starts.error[k] = root.error;
            }
        }
    }

    /// One bit for each of the sixteen rays from `base` on that starts in its part of a piece;
    /// `parts` holds from and to in `s`, then in `t`, for each half of the rays.
    #[simd]
    pub(super) fn starts_in<S: Simd>(
        &self,
        simd: S,
        base: usize,
        piece: u32,
        parts: &[[f64x8<S>; 4]; 2],
    ) -> u32 {
        let from = u32x16::from_slice(simd, &self.starts.piece[base..base + LANES]);
        let on_piece = from.simd_eq(u32x16::splat(simd, piece)).to_bitmask() as u32;
        if on_piece == 0 {
            return 0;
        }
        let mut inside = 0;
        for half in 0..2 {
            let eight = base + 8 * half..base + 8 * half + 8;
            let at_s = f64x8::from_slice(simd, &self.starts.st[0][eight.clone()]);
            let at_t = f64x8::from_slice(simd, &self.starts.st[1][eight]);
            let [s0, s1, t0, t1] = parts[half];
            let within = at_s.simd_ge(s0) & at_s.simd_le(s1) & at_t.simd_ge(t0) & at_t.simd_le(t1);
            inside |= (within.to_bitmask() as u32) << (8 * half);
        }
        inside & on_piece
    }

    /// One bit for each of the sixteen rays from `base` on that starts on a leaf, or near it on its
    /// piece, and is proved not to have that leaf ahead of it again. The error bound of a point's
    /// distance from a ray is the ray's magnitude times `factor`.
    #[simd]
    pub(super) fn departs_from<S: Simd>(
        &self,
        simd: S,
        base: usize,
        target: &Target<'_>,
        (magnitude, factor): (f32x16<S>, f64),
    ) -> u32 {
        let leaf = target.leaf;
        let nearby = [f32x16::splat(simd, -MAY_START), f32x16::splat(simd, MAY_START)];
        let here =
            self.starts_in(simd, base, leaf.piece, &[target.parameters(simd, &[nearby; 2], 0); 2]);
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
