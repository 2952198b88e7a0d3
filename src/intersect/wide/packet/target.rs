//! A leaf that eight rays are searched in.

use fearless_simd::{Simd, SimdBase, SimdFloat, SimdMask, f32x16, f64x8, mask64x8};
use fearless_simd_macros::simd;
use glam::DVec3;

use crate::geometry::RectSide;
use crate::intersect::wide::reach::WITH_SLACK;
use crate::intersect::wide::search::distances::widened;
use crate::intersect::wide::search::newton::{Leaves, Rays, Step};
use crate::intersect::wide::surface::form::Form;
use crate::intersect::wide::surface::jets::jets;
use crate::intersect::wide::surface::sums::{Jets, OneNet};
use crate::intersect::wide::vectors::dot_d;
use crate::intersect::wide::view::{BvhView, Fitted};
use crate::patch::{
    BESIDE_COLLAPSED, CLEAR_OF_ERROR, Leaf, OrientedBox, Piece, SURELY, StRect, WIDENING,
};

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
pub(super) struct Closer {
    /// Whether a hit may be near a side, in the sense of [`Target::near_side`].
    pub(super) has_near_sides: bool,
    /// Half the sides of the leaf's rectangle, one over that, and its middle.
    half: [f64; 2],
    pub(super) per_half: [f64; 2],
    pub(super) middle: [f64; 2],
    /// Error bound of a computed point, over the larger of two magnitudes: the patch's, and that of
    /// the ray's origin.
    pub(super) residual_factor: f64,
    pub(super) magnitude: f64,
    /// See [`FitError`](crate::patch::FitError).
    bend: f64,
    third: f64,
    /// The form of the piece.
    form: Form,
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
    pub(super) fn closer(&self) -> Closer {
        let [[s0, s1], [t0, t1]] = self.rect;
        Closer {
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

    /// The rectangle where the leaf's certificate holds, the same for all of eight rays.
    #[inline(always)]
    pub(super) fn certified<S: Simd>(&self, simd: S) -> [f64x8<S>; 4] {
        let [[s0, s1], [t0, t1]] = self.domain;
        [
            f64x8::splat(simd, s0),
            f64x8::splat(simd, s1),
            f64x8::splat(simd, t0),
            f64x8::splat(simd, t1),
        ]
    }

    /// The rays that pass the leaf's pole far enough away for its certificate to hold.
    #[inline(always)]
    pub(super) fn is_away_from_pole<S: Simd, R: Rays<S>>(
        &self,
        simd: S,
        pole: DVec3,
        rays: &R,
    ) -> mask64x8<S> {
        let [f1, f2] = rays.distances(simd, splat3(simd, pole));
        let distance = f1.mul_add(f1, f2 * f2).sqrt();
        let steep = self.steepness(simd, rays);
        let needed = f64::from(self.leaf.certificate.pole_per_error());
        (rays.error() * f64x8::splat(simd, needed)).simd_le(steep * distance)
    }

    /// See [`Certificate::steepness`](crate::patch::Certificate::steepness).
    #[inline(always)]
    fn steepness<S: Simd, R: Rays<S>>(&self, simd: S, rays: &R) -> f64x8<S> {
        let row = self.leaf.certificate.upright(self.oriented.directions());
        dot_d(splat3(simd, row), rays.axis(simd)).abs()
    }

    /// Converts half of sixteen rectangles of box coordinates to the piece's parameters: from and
    /// to in `s`, then in `t`.
    #[inline(always)]
    pub(super) fn parameters<S: Simd>(
        &self,
        simd: S,
        rect: &[[f32x16<S>; 2]; 2],
        half: usize,
    ) -> [f64x8<S>; 4] {
        let mut ends = [f64x8::splat(simd, 0.0); 4];
        for k in 0..2 {
            let [from, to] = self.rect[k];
            let middle = f64x8::splat(simd, 0.5 * (from + to));
            let side = f64x8::splat(simd, 0.5 * (to - from));
            for end in 0..2 {
                ends[2 * k + end] = widened(rect[k][end], half).mul_add(side, middle);
            }
        }
        ends
    }
}

/// A leaf as it is searched in f64, on the true surface.
#[derive(Clone, Copy)]
pub(super) struct TrueLeaf<'a> {
    pub(super) target: &'a Target<'a>,
    pub(super) closer: &'a Closer,
    /// The piece and its control net.
    pub(super) surface: &'a OneNet<'a>,
}

/// A leaf, and the domain in it where eight rays have at most one root each.
pub(super) struct Ground8<'a, S: Simd> {
    pub(super) on: TrueLeaf<'a>,
    /// The domain: from and to in `s`, then in `t`.
    pub(super) domain: [f64x8<S>; 4],
    /// Whether the domain is that of the leaf's certificate.
    pub(super) certified: bool,
    /// Whether normals are asked for.
    pub(super) normals: bool,
}

impl<S: Simd> Leaves<S> for Ground8<'_, S> {
    #[inline(always)]
    fn jets(&self, simd: S, st: &[f64x8<S>; 2]) -> Jets<S> {
        jets::<_, _, true>(simd, self.on.surface, self.on.closer.form, st)
    }

    #[inline(always)]
    fn tangents(&self, simd: S, st: &[f64x8<S>; 2]) -> Jets<S> {
        jets::<_, _, false>(simd, self.on.surface, self.on.closer.form, st)
    }

    #[inline(always)]
    fn half(&self, simd: S) -> [f64x8<S>; 2] {
        splat2(simd, self.on.closer.half)
    }

    #[inline(always)]
    fn per_half(&self, simd: S) -> [f64x8<S>; 2] {
        splat2(simd, self.on.closer.per_half)
    }

    #[inline(always)]
    fn middle(&self, simd: S) -> [f64x8<S>; 2] {
        splat2(simd, self.on.closer.middle)
    }

    #[inline(always)]
    fn domain(&self, _: S) -> [f64x8<S>; 4] {
        self.domain
    }

    #[inline(always)]
    fn bend(&self, simd: S) -> f64x8<S> {
        f64x8::splat(simd, self.on.closer.bend)
    }

    #[inline(always)]
    fn third(&self, simd: S) -> f64x8<S> {
        f64x8::splat(simd, self.on.closer.third)
    }

    #[inline(always)]
    fn asks_normals(&self) -> bool {
        self.normals
    }

    #[inline(always)]
    fn clearance<R: Rays<S>>(&self, simd: S, rays: &R) -> f64x8<S> {
        let target = self.on.target;
        if !self.certified || target.pole.is_some() {
            return f64x8::splat(simd, f64::INFINITY);
        }
        let per_error = f64x8::splat(simd, target.leaf.certificate.clearance_per_error());
        rays.error() * per_error / target.steepness(simd, rays)
    }

    /// The lanes where a step from beyond the leaf surely leads away from it, so that the leaf is
    /// missed, as in the scalar search.
    #[simd]
    fn surely_away<R: Rays<S>>(&self, simd: S, rays: &R, step: &Step<S>) -> mask64x8<S> {
        if !self.certified {
            return simd.splat_mask64x8(false);
        }
        let ([s, t], [step_s, step_t], [f1, f2]) = (step.at, step.by, step.distances);
        let [n1, n2] = rays.normals(simd);
        let reach = f64x8::splat(simd, WITH_SLACK);
        let [half_s, half_t] = self.half(simd);
        let (outer_s, outer_t) = (half_s * reach, half_t * reach);
        let [middle_s, middle_t] = self.middle(simd);
        let (from_middle_s, from_middle_t) = (s - middle_s, t - middle_t);
        let beyond_s = from_middle_s.abs().simd_gt(outer_s);
        let beyond_t = from_middle_t.abs().simd_gt(outer_t);
        if (beyond_s | beyond_t).all_false() {
            return beyond_s;
        }
        let zero = f64x8::splat(simd, 0.0);
        let residual = f1.mul_add(f1, f2 * f2);
        let g = [f1 * n2[0] - f2 * n1[0], f1 * n2[1] - f2 * n1[1], f1 * n2[2] - f2 * n1[2]];
        let [a, b, n] = self.on.target.oriented.unit_axes();
        let across_a = dot_d(splat3(simd, a), g).abs();
        let across_b = dot_d(splat3(simd, b), g).abs();
        let rest = residual.sqrt() * f64x8::splat(simd, SURELY);
        let normal = dot_d(splat3(simd, n), g).abs() + rest;
        let [[other_s, out_s], [other_t, out_t]] = self.on.target.leaf.certificate.bend();
        let turned_s = (across_a + rest)
            .mul_add(f64x8::splat(simd, other_s), normal.mul_add(f64x8::splat(simd, out_s), rest));
        let turned_t = (across_b + rest)
            .mul_add(f64x8::splat(simd, other_t), normal.mul_add(f64x8::splat(simd, out_t), rest));
        // The step goes back by `step_s` and `step_t`: it leads away where it has the sign of the
        // place's side.
        let away_s = beyond_s & (from_middle_s * step_s).simd_lt(zero);
        let away_t = beyond_t & (from_middle_t * step_t).simd_lt(zero);
        let (sure_s, sure_t) = (across_b.simd_gt(turned_s), across_a.simd_gt(turned_t));
        let clear = residual.simd_gt(
            rays.error() * rays.error() * f64x8::splat(simd, CLEAR_OF_ERROR * CLEAR_OF_ERROR),
        );
        clear & (away_s & sure_s | away_t & sure_t)
    }
}

/// The reason why there is at most one root, and where.
#[derive(Clone, Copy)]
pub(super) enum Ground<S: Simd> {
    /// The leaf's certificate holds for the rays: in the widened leaf.
    Certificate,
    /// The rays' own proofs: in rectangles of box coordinates.
    Own([[f32x16<S>; 2]; 2]),
}

#[inline(always)]
fn splat2<S: Simd>(simd: S, [s, t]: [f64; 2]) -> [f64x8<S>; 2] {
    [f64x8::splat(simd, s), f64x8::splat(simd, t)]
}

#[inline(always)]
fn splat3<S: Simd>(simd: S, v: DVec3) -> [f64x8<S>; 3] {
    [f64x8::splat(simd, v.x), f64x8::splat(simd, v.y), f64x8::splat(simd, v.z)]
}
