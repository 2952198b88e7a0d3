//! The roots that rays start on.

use fearless_simd::{Simd, SimdBase, SimdMask, f64x8, u32x16};
use fearless_simd_macros::simd;

use crate::intersect::Shot;
use crate::intersect::query::StartIn;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::PACKET;
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

impl Starts {
    /// Takes in the roots that rays start on.
    pub(super) fn take<Q: Shot>(&mut self, shots: &[Q], set: &PatchSet) {
        self.exist = shots.iter().any(|shot| shot.start_in(set).is_some());
        if !self.exist {
            return;
        }
        self.piece = [u32::MAX; PACKET];
        self.error = [0.0; PACKET];
        for (k, shot) in shots.iter().enumerate() {
            if let Some(root) = shot.start_in(set) {
                self.piece[k] = root.piece;
                (self.st[0][k], self.st[1][k]) = (root.st.x, root.st.y);
                self.error[k] = root.error;
            }
        }
    }

    /// One bit for each of the sixteen rays from `base` on that starts in its part of a piece;
    /// `parts` holds from and to in `s`, then in `t`, for each half of the rays.
    #[simd]
    pub(super) fn are_in<S: Simd>(
        &self,
        simd: S,
        base: usize,
        piece: u32,
        parts: &[[f64x8<S>; 4]; 2],
    ) -> u32 {
        let from = u32x16::from_slice(simd, &self.piece[base..base + LANES]);
        let on_piece = from.simd_eq(u32x16::splat(simd, piece)).to_bitmask() as u32;
        if on_piece == 0 {
            return 0;
        }
        let mut inside = 0;
        for half in 0..2 {
            let eight = base + 8 * half..base + 8 * half + 8;
            let at_s = f64x8::from_slice(simd, &self.st[0][eight.clone()]);
            let at_t = f64x8::from_slice(simd, &self.st[1][eight]);
            let [s0, s1, t0, t1] = parts[half];
            let within = at_s.simd_ge(s0) & at_s.simd_le(s1) & at_t.simd_ge(t0) & at_t.simd_le(t1);
            inside |= (within.to_bitmask() as u32) << (8 * half);
        }
        inside & on_piece
    }
}
