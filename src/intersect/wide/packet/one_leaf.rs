//! The search of one leaf for some rays in f64, on the true surface.

use fearless_simd::{Simd, SimdMask, f32x16};
use fearless_simd_macros::simd;

use super::target::{LeafNumbers, Target, splat3};
use crate::intersect::wide::reach::WITH_SLACK;
use crate::intersect::wide::search::newton::{Leaves, Rays, Step};
use crate::intersect::wide::surface::jets::jets;
use crate::intersect::wide::surface::sums::{Jets, OneNet};
use crate::intersect::wide::vectors::{Reals, dot_d};
use crate::patch::{CLEAR_OF_ERROR, SURELY};

/// A leaf as it is searched in f64, on the true surface.
#[derive(Clone, Copy)]
pub(super) struct TrueLeaf<'a> {
    pub(super) target: &'a Target<'a>,
    pub(super) numbers: &'a LeafNumbers,
    /// The piece and its control net.
    pub(super) surface: &'a OneNet<'a>,
}

/// A leaf, and the domain in it where some rays have at most one root each.
pub(super) struct OneLeaf<'a, V> {
    pub(super) on: TrueLeaf<'a>,
    /// The domain: from and to in `s`, then in `t`.
    pub(super) domain: [V; 4],
    /// Whether the domain is that of the leaf's certificate.
    pub(super) certified: bool,
    /// Whether points and normals are asked for.
    pub(super) places: bool,
}

impl<S: Simd, V: Reals<S>> Leaves<S, V> for OneLeaf<'_, V> {
    #[inline(always)]
    fn jets(&self, simd: S, st: &[V; 2]) -> Jets<V> {
        jets::<_, _, _, true>(simd, self.on.surface, self.on.numbers.form, st)
    }

    #[inline(always)]
    fn tangents(&self, simd: S, st: &[V; 2]) -> Jets<V> {
        jets::<_, _, _, false>(simd, self.on.surface, self.on.numbers.form, st)
    }

    #[inline(always)]
    fn half(&self, simd: S) -> [V; 2] {
        splat2(simd, self.on.numbers.half)
    }

    #[inline(always)]
    fn per_half(&self, simd: S) -> [V; 2] {
        splat2(simd, self.on.numbers.per_half)
    }

    #[inline(always)]
    fn middle(&self, simd: S) -> [V; 2] {
        splat2(simd, self.on.numbers.middle)
    }

    #[inline(always)]
    fn domain(&self, _: S) -> [V; 4] {
        self.domain
    }

    #[inline(always)]
    fn bend(&self, simd: S) -> V {
        V::splat(simd, self.on.numbers.bend)
    }

    #[inline(always)]
    fn third(&self, simd: S) -> V {
        V::splat(simd, self.on.numbers.third)
    }

    #[inline(always)]
    fn own_error(&self, simd: S) -> V {
        V::splat(simd, self.on.numbers.residual_factor * self.on.numbers.magnitude)
    }

    #[inline(always)]
    fn asks_places(&self) -> bool {
        self.places
    }

    #[inline(always)]
    fn clearance<R: Rays<S, V>>(&self, simd: S, rays: &R) -> V {
        let target = self.on.target;
        if !self.certified || target.pole.is_some() {
            return V::splat(simd, f64::INFINITY);
        }
        let per_error = V::splat(simd, target.leaf.certificate.clearance_per_error());
        rays.error() * per_error / target.steepness(simd, rays)
    }

    /// The lanes where a step from beyond the leaf surely leads away from it, so that the leaf is
    /// missed, as in the scalar search.
    #[simd]
    fn surely_away<R: Rays<S, V>>(&self, simd: S, rays: &R, step: &Step<V>) -> V::Mask {
        if !self.certified {
            return V::Mask::splat(simd, false);
        }
        let ([s, t], [step_s, step_t], [f1, f2]) = (step.at, step.by, step.distances);
        let [n1, n2] = rays.normals(simd);
        let reach = V::splat(simd, WITH_SLACK);
        let [half_s, half_t] = self.half(simd);
        let (outer_s, outer_t) = (half_s * reach, half_t * reach);
        let [middle_s, middle_t] = self.middle(simd);
        let (from_middle_s, from_middle_t) = (s - middle_s, t - middle_t);
        let beyond_s = from_middle_s.abs().simd_gt(outer_s);
        let beyond_t = from_middle_t.abs().simd_gt(outer_t);
        if (beyond_s | beyond_t).all_false() {
            return beyond_s;
        }
        let zero = V::splat(simd, 0.0);
        let residual = f1.mul_add(f1, f2 * f2);
        let g = [f1 * n2[0] - f2 * n1[0], f1 * n2[1] - f2 * n1[1], f1 * n2[2] - f2 * n1[2]];
        let [a, b, n] = self.on.target.oriented.unit_axes();
        let across_a = dot_d(splat3(simd, a), g).abs();
        let across_b = dot_d(splat3(simd, b), g).abs();
        let rest = residual.sqrt() * V::splat(simd, SURELY);
        let normal = dot_d(splat3(simd, n), g).abs() + rest;
        let [[other_s, out_s], [other_t, out_t]] = self.on.target.leaf.certificate.tilts();
        let turned_s = (across_a + rest)
            .mul_add(V::splat(simd, other_s), normal.mul_add(V::splat(simd, out_s), rest));
        let turned_t = (across_b + rest)
            .mul_add(V::splat(simd, other_t), normal.mul_add(V::splat(simd, out_t), rest));
        // The step goes back by `step_s` and `step_t`: it leads away where it has the sign of the
        // place's side.
        let away_s = beyond_s & (from_middle_s * step_s).simd_lt(zero);
        let away_t = beyond_t & (from_middle_t * step_t).simd_lt(zero);
        let (sure_s, sure_t) = (across_b.simd_gt(turned_s), across_a.simd_gt(turned_t));
        let clear = residual
            .simd_gt(rays.error() * rays.error() * V::splat(simd, CLEAR_OF_ERROR * CLEAR_OF_ERROR));
        clear & (away_s & sure_s | away_t & sure_t)
    }
}

/// The reason why there is at most one root, and where.
#[derive(Clone, Copy)]
pub(super) enum Uniqueness<S: Simd> {
    /// The leaf's certificate holds for the rays: in the widened leaf.
    Certificate,
    /// The rays' own proofs: in rectangles of box coordinates.
    Own([[f32x16<S>; 2]; 2]),
}

#[inline(always)]
fn splat2<S: Simd, V: Reals<S>>(simd: S, [s, t]: [f64; 2]) -> [V; 2] {
    [V::splat(simd, s), V::splat(simd, t)]
}
