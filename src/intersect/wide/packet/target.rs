//! A leaf to search for rays.

use fearless_simd::{Simd, f32x16};
use glam::DVec3;

use crate::geometry::RectSide;
use crate::intersect::wide::search::newton::Rays;
use crate::intersect::wide::surface::form::Form;
use crate::intersect::wide::vectors::{Reals, dot_d};
use crate::intersect::wide::view::{BvhView, Fitted};
use crate::patch::{BESIDE_COLLAPSED, Leaf, OrientedBox, Piece, StRect, WIDENING};

/// A leaf, its piece, and which leaf it is.
#[derive(Clone, Copy)]
pub(crate) struct Target<'a> {
    pub leaf: &'a Leaf,
    pub piece: &'a Piece,
    pub(super) index: u32,
    pub(super) view: &'a BvhView<'a>,
    pub oriented: &'a OrientedBox,
    rect: StRect,
    /// Where the leaf's certificate holds.
    domain: StRect,
    /// The pole that the leaf ends in, if it does.
    pub pole: Option<DVec3>,
}

/// The data of a leaf that are needed once roots are looked for in it.
#[derive(Clone, Copy)]
pub(super) struct LeafNumbers {
    /// Whether a hit may be near a side, in the sense of [`Target::near_side`].
    pub(super) has_near_sides: bool,
    /// Half the sides of the leaf's rectangle, one over that, and its middle.
    pub(super) half: [f64; 2],
    pub(super) per_half: [f64; 2],
    pub(super) middle: [f64; 2],
    /// Error bound of a computed point, over the larger of two magnitudes: the patch's, and that of
    /// the ray's origin.
    pub(super) residual_factor: f64,
    pub(super) magnitude: f64,
    /// See [`FitError`](crate::patch::FitError).
    pub(super) bend: f64,
    pub(super) third: f64,
    /// The form of the piece.
    pub(super) form: Form,
}

impl<'a> Target<'a> {
    #[inline(always)] // a returned result would be copied, which stalls
    pub(crate) fn new(view: &'a BvhView<'a>, oriented: &'a OrientedBox, index: u32) -> Self {
        let leaf = &view.leaves[index as usize];
        let piece = view.piece_of(index);
        let (rect, domain) = (leaf.rect(), leaf.widened(piece, WIDENING));
        let pole = leaf.pole(piece);
        Self { leaf, piece, index, view, oriented, rect, domain, pole }
    }

    #[inline(always)]
    pub(super) fn numbers(&self) -> LeafNumbers {
        let [[s0, s1], [t0, t1]] = self.rect;
        LeafNumbers {
            has_near_sides: self.leaf.is_at_border() || self.pole.is_some(),
            half: [0.5 * (s1 - s0), 0.5 * (t1 - t0)],
            per_half: [2.0 / (s1 - s0), 2.0 / (t1 - t0)],
            middle: [0.5 * (s0 + s1), 0.5 * (t0 + t1)],
            residual_factor: self.piece.patch.residual_factor(),
            magnitude: self.piece.patch.magnitude(),
            bend: f64::from(self.leaf.fit_bend()),
            third: self.leaf.fit_third(),
            form: Form::of(&self.piece.patch),
        }
    }

    /// The distance from a side of the piece within which a hit may be at a border of the surface,
    /// or its normal may be a limit; minus infinity if neither can be.
    #[inline(always)]
    pub(super) fn near_side(&self, side: RectSide) -> f64 {
        let border = self.leaf.near_border(self.piece, side).unwrap_or(f64::NEG_INFINITY);
        // Near a pole the normal is a limit.
        let is_beside_pole = self.pole.is_some() && self.piece.is_collapsed(side);
        if is_beside_pole { border.max(BESIDE_COLLAPSED) } else { border }
    }

    /// The leaf with its weight.
    #[inline(always)]
    pub(crate) fn fitted(&self) -> Fitted<'_> {
        self.view.fitted(self.index, &self.piece.patch)
    }

    /// The rectangle where the leaf's certificate holds, the same for all rays.
    #[inline(always)]
    pub(super) fn certified<S: Simd, V: Reals<S>>(&self, simd: S) -> [V; 4] {
        let [[s0, s1], [t0, t1]] = self.domain;
        [V::splat(simd, s0), V::splat(simd, s1), V::splat(simd, t0), V::splat(simd, t1)]
    }

    /// The rays that pass the leaf's pole far enough away for its certificate to hold.
    #[inline(always)]
    pub(super) fn is_away_from_pole<S: Simd, V: Reals<S>, R: Rays<S, V>>(
        &self,
        simd: S,
        pole: DVec3,
        rays: &R,
    ) -> V::Mask {
        let [f1, f2] = rays.distances(simd, splat3(simd, pole));
        let distance = f1.mul_add(f1, f2 * f2).sqrt();
        let steep = self.steepness(simd, rays);
        let needed = f64::from(self.leaf.certificate.pole_per_error());
        (rays.error() * V::splat(simd, needed)).simd_le(steep * distance)
    }

    /// See [`Certificate::steepness`](crate::patch::Certificate::steepness).
    #[inline(always)]
    pub(super) fn steepness<S: Simd, V: Reals<S>, R: Rays<S, V>>(&self, simd: S, rays: &R) -> V {
        let row = self.leaf.certificate.upright(self.oriented.directions());
        dot_d(splat3(simd, row), rays.axis(simd)).abs()
    }

    /// Converts rectangles of box coordinates to the piece's parameters: from and to in `s`, then
    /// in `t`. Of sixteen rectangles, `part` takes those that are wanted, in f64.
    #[inline(always)]
    pub(super) fn parameters<S: Simd, V: Reals<S>>(
        &self,
        simd: S,
        rect: &[[f32x16<S>; 2]; 2],
        part: impl Fn(f32x16<S>) -> V,
    ) -> [V; 4] {
        let mut ends = [V::splat(simd, 0.0); 4];
        for k in 0..2 {
            let [from, to] = self.rect[k];
            let middle = V::splat(simd, 0.5 * (from + to));
            let side = V::splat(simd, 0.5 * (to - from));
            for end in 0..2 {
                ends[2 * k + end] = part(rect[k][end]).mul_add(side, middle);
            }
        }
        ends
    }
}

#[inline(always)]
pub(super) fn splat3<S: Simd, V: Reals<S>>(simd: S, v: DVec3) -> [V; 3] {
    [V::splat(simd, v.x), V::splat(simd, v.y), V::splat(simd, v.z)]
}
