//! Proofs from the search in f32 about a leaf's one root, before anything is done in f64: that it
//! is not there, or cut off by trims, or that it surely is there and kept.
//!
//! Most rays that meet the box of a leaf beside the one they hit have a root just outside of that
//! leaf; and for a ray that asks for any hit, it only matters that there is one.
//!
//! # Proof
//! Let `f`, `a`, `b` be the approximation's distances from the ray's planes, times its weight, and
//! their derivatives at `x₁`, in box coordinates; let `A` be the matrix meant to be the inverse of
//! `J = (a b)`, and `x₂ = x₁ + h`. With the bounds `E`, `σ` and `M` of
//! [`FitError`](crate::patch::FitError), the true distances are, at any `x` with `|x − x₁| ≤ r`
//! (the larger component),
//!
//! `F(x) = f + J (x − x₁) + e = q + J (x − x₂) + e`, `q = f + J h`, `|e| ≤ E + 2σ r + M r²`,
//!
//! except for the error that a point may have anyway, times the weight, and for rounding: both are
//! added to `E`.
//!
//! *There is a root near `x₂`.* Let `α` be the largest row sum of `|A|`, and `ν` that of
//! `|A J − I|`. Then `A F(x)` differs from `x − x₂` by no more than `α (|q| + |e|) + ν |x − x₂|`.
//! If this is less than `ρ` wherever `|x − x₂| = ρ`, the two components of `A F` have the signs of
//! those of `x − x₂` on the sides of the square of half side `ρ` about `x₂`, so there is a root in
//! it (Miranda 1940). Where the leaf's certificate holds for the ray, that root is the only one in
//! the widened leaf.
//!
//! *Trims keep it, or do not.* The leaf's window tells on which side of the trim curves the square
//! of half side `ρ` about `x₂` lies, and as much more as the closer look in f64 would count as an
//! edge: `8 e s / l` along a half side of length `l`, with the leaf's stretch `s`, and the error `e`
//! of the hit along the ray, which is that of a point over the cosine between ray and normal. Of
//! all steps in the tangent plane whose part across the ray has length one, the longest is as long
//! as one over the cosine. In box coordinates it is at most `α'`, the largest row sum of the inverse
//! Jacobian at the root; so one over the cosine is at most `α' (|S_x| + |S_y|)`. The Jacobian at the
//! root differs from `J` by at most `2σ + 2M r` in a row; where `α` times that is at most a quarter,
//! `α'` is at most `4 α`, as `ν` is less than a half. And `|S_x| + |S_y|` is at most its value in
//! the middle and `2σ + 2M |x|`.
//!
//! *There is none.* Where `x₁` lies beyond the leaf, the certificate shows from `F(x₁)` alone that
//! the leaf is missed: see [`Certificate`](crate::patch::Certificate). `F(x₁)` differs from `f` by
//! at most `E`, and the condition on `F(x₁)` holds for its multiples, too.

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16, mask32x16};

use super::bounds::{DISTANCE_ROUNDING, LARGEST};
use crate::geometry::trim::WindowCurve;
use crate::intersect::wide::reach::{WIDENED_F32, WITH_SLACK_F32};
use crate::intersect::wide::search::distances::{LastStep, NearRoots};
use crate::intersect::wide::trimmed::{EDGE_REACH, Places, kept_in_window};
use crate::intersect::wide::vectors::lane_bits;
use crate::patch::{CLEAR_OF_ERROR, Leaf, OrientedBox, SURELY};

/// Half the side of the largest square about the root that was found, in box coordinates.
const MOST_OFF: f32 = 1.0 / 128.0;

/// How far from the middle the surface surely goes on: a little less than the leaf.
pub(crate) const INSIDE: f32 = 1.0 - 2.0 * f32::EPSILON;

/// The inverse Jacobian is accurate to a twentieth or better where its largest row sum times the
/// Jacobian's entries is less than this: its rounding error is at most ten units of 2⁻²⁴ of that.
const WORST: f32 = 8e4;

/// Derivatives smaller than this are not trusted: products of two of them lose digits.
const SHORTEST: f32 = 1e-12;

/// What is proved of sixteen rays, a bit each.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Screened {
    /// The rays that miss the leaf, or what trims keep of it.
    pub missed: u32,
    /// The rays that meet what is kept of the leaf, and ask no more.
    pub met: u32,
}

/// Sixteen rays and a leaf.
pub(crate) struct Screen<'a, S: Simd> {
    pub leaf: &'a Leaf,
    pub oriented: &'a OrientedBox,
    /// The normals of the rays' planes.
    pub normals: [[f32x16<S>; 3]; 2],
    /// How steep the rays are. The sign is that of the determinant, which is the same on all of the
    /// leaf.
    pub upright: f32x16<S>,
    /// The measure of the rounding error of the distances.
    pub terms: f32x16<S>,
    /// Error bound of a point's distance from the ray, times the weight.
    pub error: f32x16<S>,
    /// What trims keep of the leaf, if a trim curve passes through it.
    pub window: &'a [WindowCurve],
}

impl<S: Simd> Screen<'_, S> {
    /// What the last step of the search proves of the rays whose bit is set in `lanes`, whatever the
    /// part of them that counts.
    #[inline(always)]
    pub(crate) fn ask(&self, simd: S, searched: &NearRoots<S>, lanes: u32) -> Screened {
        let LastStep { from, to, distances: [f1, f2], slopes, inverse } = searched.last;
        let ([[a1, a2], [b1, b2]], [[xx, xy], [yx, yy]]) = (slopes, inverse);
        let leaf = self.leaf;

        // Distances take twelve roundings of coefficients and sums, or eighteen where products are
        // not added in one rounding; derivatives, of three times the size, take as many. The
        // roundings of the step and of what it leaves are small compared with the slack given to it
        // (`per_move`, `MOST_OFF`).
        let noise = self.terms * f32x16::splat(simd, DISTANCE_ROUNDING);
        let off = noise + f32x16::splat(simd, leaf.fit_error()) + self.error;
        let per_move =
            f32x16::splat(simd, 2.0 * leaf.slope_error()) + noise * f32x16::splat(simd, 4.0);

        let (move_x, move_y) = (to[0] - from[0], to[1] - from[1]);
        let left_1 = a1.mul_add(move_x, b1.mul_add(move_y, f1)).abs();
        let left_2 = a2.mul_add(move_x, b2.mul_add(move_y, f2)).abs();
        let reach = move_x.abs().max(move_y.abs()) + f32x16::splat(simd, MOST_OFF);
        let bend = f32x16::splat(simd, leaf.fit_bend());
        let rest = left_1.max(left_2) + bend.mul_add(reach, per_move).mul_add(reach, off);
        let by_inverse = (xx.abs() + xy.abs()).max(yx.abs() + yy.abs());
        // The row sums of `A J − I` are less than a half, and a little is left for rounding.
        let radius = f32x16::splat(simd, 2.2) * by_inverse * rest;
        let size = a1.abs() + a2.abs() + (b1.abs() + b2.abs());
        // All are false for NaN.
        let known = radius.simd_le(f32x16::splat(simd, MOST_OFF))
            & (by_inverse * size).simd_le(f32x16::splat(simd, WORST))
            & size.simd_ge(f32x16::splat(simd, SHORTEST))
            & self.terms.simd_le(f32x16::splat(simd, LARGEST));

        let (x, y) = (to[0].abs(), to[1].abs());
        let (farthest, spare) = (x.max(y), radius + f32x16::splat(simd, 2.0 * f32::EPSILON));
        let in_domain = (farthest + spare).simd_le(f32x16::splat(simd, WIDENED_F32));
        let beyond = (farthest - spare).simd_gt(f32x16::splat(simd, WITH_SLACK_F32));
        let within = (farthest + spare).simd_le(f32x16::splat(simd, INSIDE));
        let mut missed = lane_bits(known & in_domain & beyond);
        let mut met = lane_bits(known & within);
        if leaf.is_trimmed() {
            let turned = bend.mul_add(reach + reach, per_move);
            let steady = (by_inverse * turned).simd_le(f32x16::splat(simd, 0.25));
            let [kept, decided] = self.kept(simd, to, radius, by_inverse, lanes);
            missed |= lane_bits(known & in_domain & steady) & decided & !kept;
            met &= lane_bits(steady) & decided & kept;
        }
        let outside = [
            from[0].abs().simd_gt(f32x16::splat(simd, WITH_SLACK_F32)),
            from[1].abs().simd_gt(f32x16::splat(simd, WITH_SLACK_F32)),
        ];
        let open = lanes & !(missed | met);
        if open & lane_bits(outside[0] | outside[1]) != 0 {
            missed |= lane_bits(self.away(simd, (from, outside), [f1, f2], off));
        }
        Screened { missed: lanes & missed, met: lanes & met }
    }

    /// Which roots trims keep, and for which that is known, a bit each: of roots that are within
    /// `radius` of a place, for the largest row sums of the inverse Jacobian there, in these lanes.
    #[inline(always)]
    fn kept(
        &self,
        simd: S,
        at: [f32x16<S>; 2],
        radius: f32x16<S>,
        by_inverse: f32x16<S>,
        lanes: u32,
    ) -> [u32; 2] {
        let leaf = self.leaf;
        let lengths = leaf.half_side_lengths();
        let span = lengths[0]
            + lengths[1]
            + 2.0 * leaf.slope_error()
            + 2.0 * WIDENED_F32 * leaf.fit_bend();
        // How near an edge counts, times the length of the half side. A tenth is for rounding.
        let edge = 4.4 * EDGE_REACH as f32 * leaf.stretch() * span;
        let edge = by_inverse * self.error * f32x16::splat(simd, edge);
        let [x, y] = lengths;
        let reach = [
            edge.mul_add(f32x16::splat(simd, 1.0 / x), radius),
            edge.mul_add(f32x16::splat(simd, 1.0 / y), radius),
        ];
        kept_in_window(simd, self.window, &Places { at, reach }, lanes)
    }

    /// The lanes that are beyond the leaf on some side, and for which the certificate shows that
    /// the leaf is missed.
    #[inline(always)]
    fn away(
        &self,
        simd: S,
        (at, outside): ([f32x16<S>; 2], [mask32x16<S>; 2]),
        [f1, f2]: [f32x16<S>; 2],
        off: f32x16<S>,
    ) -> mask32x16<S> {
        let (zero, [n1, n2]) = (f32x16::splat(simd, 0.0), self.normals);
        let axes = self.oriented.unit_axes();
        let mut along = [zero; 3];
        for i in 0..3 {
            let g = f1 * n2[i] - f2 * n1[i];
            for k in 0..3 {
                along[k] = g.mul_add(f32x16::splat(simd, axes[k][i] as f32), along[k]);
            }
        }
        let [along_a, along_b, along_n] = along;
        let size = f1.abs() + f2.abs();
        let rest = size * f32x16::splat(simd, SURELY as f32) + off * f32x16::splat(simd, 2.0);
        let [[other_s, out_s], [other_t, out_t]] = self.leaf.certificate.tilts();
        let (other_s, out_s) =
            (f32x16::splat(simd, other_s as f32), f32x16::splat(simd, out_s as f32));
        let (other_t, out_t) =
            (f32x16::splat(simd, other_t as f32), f32x16::splat(simd, out_t as f32));
        // What an error of the distances does to each of the three.
        let (across_a, across_b) = (along_a.abs() + rest, along_b.abs() + rest);
        let across_n = along_n.abs() + rest;
        let turned_s = across_a.mul_add(other_s, across_n.mul_add(out_s, rest));
        let turned_t = across_b.mul_add(other_t, across_n.mul_add(out_t, rest));
        let sign = self.upright;
        let away_s = (along_b * sign * at[0]).simd_lt(zero) & along_b.abs().simd_gt(turned_s);
        let away_t = (along_a * sign * at[1]).simd_gt(zero) & along_a.abs().simd_gt(turned_t);
        let clear = f1
            .abs()
            .max(f2.abs())
            .simd_gt(off + self.error * f32x16::splat(simd, CLEAR_OF_ERROR as f32));
        clear & (outside[0] & away_s | outside[1] & away_t)
    }
}
