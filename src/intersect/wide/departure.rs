//! Secondary rays on the leaf they leave, or one beside it: whether they meet it again.
//!
//! The certificate says so of steep rays, and the proofs of single rays and packets of others, part
//! by part; but no proof that there is one root only can succeed where the ray's line meets the
//! leaf again *behind* the ray's start, as it does wherever the surface bends away from the ray.
//! What lies ahead must be told from what lies behind.
//!
//! # Proof
//! Let the ray leave the root `y₁` of the leaf or not far beside it on the same piece, and let `y` be
//! another one, in the leaf, farther along the ray by `z > 0`: `S(y) − S(y₁) = z d`. For any vector
//! `N` with `N · d > 0`, of length one, the height `h = N · (S(y) − S(y₁))` is `z (N · d)`, and
//! `z = |S(y) − S(y₁)|`. So there is no such root where `h` stays below `(N · d) |S(y) − S(y₁)|` on
//! the leaf.
//!
//! `N` is the approximation's normal at the start. With `Δ = y − y₁`, each coordinate times the
//! length of the leaf's half side in its direction:
//!
//! - the points are at least `|Δ| / stretch` apart ([`Leaf::stretch`]);
//! - the approximation's own height is at most `½ Λ |Δ|² + ε |Δ|`. `Λ` is the largest eigenvalue of
//!   its second derivatives, from the sums of their terms' sizes: below zero where the leaf bends
//!   away from the ray. `ε` bounds how far `N` is from being perpendicular to the tangents at `y₁`. At the stated start
//!   it is perpendicular to them, but for rounding; from there to `y₁` they change by at most the norm of
//!   the second derivatives times the distance of the two places. That is no more than `stretch` times how
//!   far apart their points are: as far as the ray's origin is from the stated start's, over the cosine. (All of
//!   these bounds hold a little outside the leaf, so that must not be far.)
//! - or `Λ` is what they are in the one direction that `Δ` can have, but for a small angle. Let `m` be
//!   the unit vector across the ray in the tangent plane: `m · (S(y) − S(y₁))` is zero. The
//!   approximation's is `g · Δ` but for what its own second derivatives come to, `ε |Δ|` with theirs for the
//!   height's, and the slopes' error times `|Δ|`. So the sine of the angle between `Δ` and the line `g · Δ = 0` is at most all
//!   that over `|g| |Δ|`: `τ`; and a quadratic form over `|Δ|²` differs from what it is on the line by
//!   at most `2 τ + 2 τ²` of its norm. (Of `Δx²`, `Δx Δy` and `Δy²`, over `|Δ|`, the first is at most
//!   the largest `|Δx|`, the last the largest `|Δy|`, and the other the smaller of the two.)
//! - the true height differs from it by no more than the bound of the slopes' error times the sum
//!   of the parameters' differences.
//!
//! Where there is a weight `W` (see [`Leaf`](crate::patch::Leaf)) all that is said of `N · X̂ − (N · p) Ŵ` instead,
//! with `p` the approximation's point at the stated start: there its slopes are those of the height, times the weight.
//! What it differs by at two places in the leaf is
//! `N · (X − S(y₁) W)`, which is the height times the weight, but for `N · (S(y₁) − p)` times what the weight differs by:
//! at most how far `p` is from `S(y₁)`, times the weight's slopes, times `|Δ|`. (`p` is off `S` at the stated start
//! by the bound of the distances' error, over the weight; as `p` lies where the bounds hold, they are good for its
//! heights, too.) So the height stays below where all that
//! does below the least weight times what it is to stay below; and it is the same across the ray.
//!
//! All is divided by `|Δ|`, which is at most what it is from the start to the farthest corner.
//!
//! How far the origin is from the surface's point at the start is seen from the approximation first,
//! and only where its error matters from the surface itself.

mod approximation;

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;

use self::approximation::{Bends, Plane, Weights};
use super::proof::LEAF;
use super::searched::Fitted;
use super::vectors::{lane_bits, splat};
use crate::patch::FIT_DOMAIN;

/// What rounding to f32 does to places, as a part of the sides' lengths, and to what does not depend on
/// the normal: 30 units of 2⁻²⁴. Terms add up to twice the sides at most where there is a stretch; to
/// each happen 12 by Horner's scheme, and few to the origin, the axis and where it starts. (Of quotients there are more
/// and larger ones: see [`Weights::terms`].)
const PLACE_ROUNDING: f32 = 2e-6;

/// What it does to slopes measured along the normal, over what the tangents' cross product is of the
/// sides': 280 units. Each tangent errs by seven units of its terms, so the normal by 64 at most; it is
/// multiplied with the ray's direction, with both tangents, and with half the second derivatives.
const NORMAL_ROUNDING: f32 = 1.8e-5;

/// Where the ray may start, in box coordinates: the approximation's bounds hold a little farther.
pub(super) const MAY_START: f32 = 1.19;

/// How far the ray's own root may be from the place it is said to start at, in box coordinates: so
/// much farther do the approximation's bounds hold.
const ROOT_APART: f32 = 0.0099;
const _: () = assert!(FARTHEST < FIT_DOMAIN as f32);

/// How far the bounds are to hold, in box coordinates.
const FARTHEST: f32 = MAY_START + ROOT_APART;

/// Nothing is said of leaves of other sizes: squares of lengths might be no numbers of f32.
const LENGTHS: std::ops::Range<f32> = 1e-15..1e15;

/// Rays as steep as this, by the sine, are not told from others by their direction.
const STEEPEST: f32 = 0.1;

/// A little less than all of the cosine: for rounding of the sums that are compared.
const ALMOST: f32 = 0.99;

/// Sixteen rays that start on a leaf.
pub(super) struct Departure<S: Simd> {
    /// Where, in box coordinates.
    pub(super) place: [f32x16<S>; 2],
    /// Their origins, from the leaf's middle.
    pub(super) origin: [f32x16<S>; 3],
    /// Their unit directions.
    pub(super) axis: [f32x16<S>; 3],
    /// How far the origin should be from the surface's point there at most.
    pub(super) reach: f32x16<S>,
}

/// Rays that do not meet the leaf again, a bit each.
#[derive(Clone, Copy)]
pub(super) struct Final {
    /// Without more ado.
    pub(super) surely: u32,
    /// If their origins are where they should be.
    pub(super) if_near: u32,
}

impl<S: Simd> Departure<S> {
    /// Which rays the leaf is proved not to lie ahead of again.
    #[simd]
    pub(super) fn is_final(&self, simd: S, fitted: Fitted<'_>) -> Final {
        let leaf = fitted.leaf;
        let (stretch, lengths) = (leaf.stretch(), leaf.half_side_lengths());
        let in_range = lengths.iter().all(|length| LENGTHS.contains(length));
        if stretch == f32::INFINITY || !in_range {
            return Final { surely: 0, if_near: 0 };
        }
        let weights = Weights::new(simd, fitted, lengths);
        let plane = Plane::new(simd, fitted, self);
        let bends = Bends::new(simd, fitted, &plane);
        let errors = Errors::new(simd, fitted, &weights, &plane);
        let most = splat(simd, ALMOST * weights.least / stretch) * plane.cosine - errors.slopes;

        // How much slopes may be other than at the stated start, over the origin's distance from there.
        let moved = splat(simd, stretch) / plane.cosine;
        let weight_turned = splat(simd, weights.slope) / plane.cosine;
        let turned = moved.mul_add(bends.norm(), weight_turned);

        // In any direction; what rounding of the normal does to that is a part of the norm.
        let [far_x, far_y] = self.farthest(simd, lengths);
        let largest = bends.norm().mul_add(errors.flattened, bends.largest(simd));
        // In that of the ray, and those that differ from it by a small angle.
        let (speed, ahead) = bends.ahead(simd, &plane);
        let bent_aside = bends.bent_aside(simd, [far_x, far_y]);
        let turned_aside = moved.mul_add(bends.norm_aside(), weight_turned);
        let angle = (bent_aside + errors.slopes + self.reach * turned_aside) / speed;
        let ahead = angle.mul_add(angle, angle).mul_add(bends.norm() + bends.norm(), ahead);

        let half = splat(simd, 0.5);
        let farthest = far_x.mul_add(far_x, far_y * far_y).sqrt();
        let left = [most - half * largest * farthest, most - half * ahead * farthest];

        // All are false for NaN. Where the leaf bends away, that is no help to what is left.
        let flat = plane.sine.simd_gt(splat(simd, STEEPEST));
        let inside = self.place[0].abs().max(self.place[1].abs()).simd_le(splat(simd, MAY_START));
        let known = self.reach * turned;
        let apart = splat(simd, ROOT_APART * lengths[0].min(lengths[1]));
        let bends_less = known.simd_lt(left[0]) | flat & known.simd_lt(left[1]);
        let inside = inside & (self.reach * moved).simd_lt(apart);
        let if_near = inside & known.simd_lt(most) & bends_less;
        // The origin is off by that in no coordinate, so by less than twice that.
        let seen = self.reach + self.reach + splat(simd, 3.0 * errors.point);
        let near = plane.off.simd_le(self.reach + splat(simd, errors.point));
        let surely = if_near & near & (seen * moved).simd_lt(apart);
        let seen = seen * turned;
        let surely = surely & seen.simd_lt(most) & seen.simd_lt(left[0]);
        Final { surely: lane_bits(surely), if_near: lane_bits(if_near) }
    }

    /// How far the leaf's sides may be from the start, and a little more: a distance in each parameter,
    /// times the length of the half side.
    #[inline(always)]
    fn farthest(&self, simd: S, [length_x, length_y]: [f32; 2]) -> [f32x16<S>; 2] {
        let [x, y] = self.place;
        let reach = splat(simd, LEAF + ROOT_APART);
        [(x.abs() + reach) * splat(simd, length_x), (y.abs() + reach) * splat(simd, length_y)]
    }
}

/// What the approximation and rounding leave unknown.
struct Errors<S: Simd> {
    /// How far its points may be off.
    point: f32,
    /// By how much slopes may be, those of the height and across the ray.
    slopes: f32x16<S>,
    /// What the normal's rounding adds to slopes, and, over their norm, to second derivatives.
    flattened: f32x16<S>,
}

impl<S: Simd> Errors<S> {
    #[inline(always)]
    fn new(simd: S, fitted: Fitted<'_>, weights: &Weights, plane: &Plane<S>) -> Self {
        let leaf = fitted.leaf;
        let [length_x, length_y] = leaf.half_side_lengths();
        let per_side = (1.0 / length_x).hypot(1.0 / length_y);
        let rounding = PLACE_ROUNDING * weights.terms * (length_x + length_y);
        // The point times the weight's slopes is a part of tangents that may be far shorter than the leaf is long.
        let [x, y, z] = plane.point;
        let size = x.abs() + y.abs() + z.abs();
        let by_weight = (size + splat(simd, length_x + length_y)) * splat(simd, weights.slope);
        let flattened = (by_weight + splat(simd, weights.terms)) * plane.per_length;
        let flattened = flattened * splat(simd, NORMAL_ROUNDING);
        let by_weight = by_weight * splat(simd, PLACE_ROUNDING);
        let point = leaf.fit_error() * fitted.heaviest() + rounding;
        let slope_error = leaf.slope_error().mul_add(per_side, PLACE_ROUNDING * weights.terms);
        let slopes = splat(simd, slope_error + point * weights.slope) + by_weight + flattened;
        Self { point, slopes, flattened }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use fearless_simd::{Level, dispatch};
    use glam::{DVec2, DVec3};
    use proptest::prelude::*;

    use super::super::weighted_hills;
    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::{Hit, Query, Root, SurfaceBvh};
    use crate::math::Ray;
    use crate::math::testing::same_cases;

    /// A ray that leaves a leaf, and what is said of it.
    struct Leaving {
        said: Final,
        /// Whether the exact solver meets the leaf ahead.
        meets_again: bool,
    }

    /// From box coordinates `place` of a leaf, at an angle of this cosine to the normal, which may
    /// be negative; `turn` is an angle about it.
    fn leaving(
        bvh: &SurfaceBvh,
        leaf: usize,
        place: [f64; 2],
        (cosine, turn): (f64, f64),
    ) -> Leaving {
        let index = leaf as u32;
        let leaf = &bvh.leaves[leaf];
        let piece = &bvh.patches().pieces()[leaf.piece as usize];
        let at = |k: usize| {
            let [from, to] = leaf.rect()[k];
            0.5 * ((from + to) + place[k] * (to - from))
        };
        let st = DVec2::new(at(0), at(1));
        let jet = piece.patch.jet(st);
        let normal = jet.ds.cross(jet.dt).normalize();
        let (a, b) = normal.any_orthonormal_pair();
        let sine = (1.0 - cosine * cosine).sqrt();
        let direction = cosine * normal + sine * (turn.cos() * a + turn.sin() * b);

        let level = Level::new();
        let scene = bvh.scene();
        let fitted = scene.fitted(index, &piece.patch);
        let said = dispatch!(level, simd => {
            let splat = |x: f64| f32x16::splat(simd, x as f32);
            let splat3 = |v: DVec3| [splat(v.x), splat(v.y), splat(v.z)];
            Departure {
                place: [splat(place[0]), splat(place[1])],
                origin: splat3(jet.point - leaf.middle),
                axis: splat3(direction),
                reach: splat(1e-14),
            }
            .is_final(simd, fitted)
        });

        let root = Root { piece: leaf.piece, cosine: 1.0, st, error: 1e-14 };
        let ray = Ray::new(jet.point, direction).unwrap();
        let mut hits: Vec<Hit> = Vec::new();
        bvh.tracer().all_hits(&Query { ray, from: Some(root) }, &mut hits);
        let rect = leaf.rect();
        let inside = |st: DVec2| (0..2).all(|k| rect[k][0] <= st[k] && st[k] <= rect[k][1]);
        let meets_again =
            hits.iter().any(|hit| hit.root.piece == leaf.piece && inside(hit.root.st));
        Leaving { said, meets_again }
    }

    /// What is proved of rays that leave a sphere outwards, and a stout and a thin torus, and hills, anywhere: never
    /// of one that meets its leaf again, and of the sphere's whatever the angle.
    #[test]
    fn only_what_is_not_met_again_is_final() {
        let sphere = SurfaceBvh::build(&[shapes::sphere(1.0).unwrap()]).unwrap();
        let torus = SurfaceBvh::build(&[shapes::torus(1.0, 0.4).unwrap()]).unwrap();
        let ring = SurfaceBvh::build(&[shapes::torus(1.0, 0.03).unwrap()]).unwrap();
        let hills = SurfaceBvh::build(&[weighted_hills()]).unwrap();
        let met_again = Cell::new(0);
        let proved = [Cell::new(0), Cell::new(0), Cell::new(0), Cell::new(0)];
        let config = same_cases(20_000);
        let rays =
            (0usize.., -1.19..1.19f64, -1.19..1.19f64, -6.0..0.0f64, any::<bool>(), 0.0..6.3f64);
        proptest!(config, |((k, x, y, size, inwards, turn) in rays)| {
            for (m, bvh) in [&sphere, &torus, &ring, &hills].into_iter().enumerate() {
                let index = k % bvh.leaves.len();
                let leaf = &bvh.leaves[index];
                let cosine = 10f64.powf(size) * if inwards { -1.0 } else { 1.0 };
                let piece = &bvh.patches().pieces()[leaf.piece as usize];
                let on_piece = [x, y].iter().zip(leaf.rect()).all(|(x, [from, to])| {
                    (0.0..=1.0).contains(&(0.5 * ((from + to) + x * (to - from))))
                });
                if leaf.pole(piece).is_some() || !on_piece {
                    continue;
                }
                let Leaving { said, meets_again } = leaving(bvh, index, [x, y], (cosine, turn));
                let said = (said.surely | said.if_near) & 1 != 0;
                prop_assert!(!(said && meets_again), "leaf {k} at {x}, {y}, {cosine}, {turn}");
                met_again.set(met_again.get() + u32::from(meets_again));
                proved[m].set(proved[m].get() + u32::from(said));
                // Outside the sphere nothing is met again.
                let clear = m > 0 || inwards || leaf.stretch() > 2.0 || cosine < 1e-2;
                prop_assert!(said || clear, "leaf {k} at {x}, {y}, {cosine}, {turn}");
            }
        });
        assert!(met_again.get() > 500, "{met_again:?}");
        assert!(proved[0].get() > 5_000 && proved[1].get() > 4_000, "{proved:?}");
        assert!(proved[2].get() > 4_000 && proved[3].get() > 3_000, "{proved:?}");
    }

    /// A ray that starts beside the surface, though it is said to start on it, is left to others.
    #[test]
    fn origins_elsewhere_are_noticed() {
        let sphere = shapes::sphere(1.0).unwrap();
        let bvh = SurfaceBvh::build(&[sphere]).unwrap();
        let normal = DVec3::new(0.6, 0.48, 0.64);
        let hit = |query: &Query| bvh.tracer().first_hit(query).hit;
        let seen = hit(&Query::primary(Ray::new(3.0 * normal, -normal).unwrap())).unwrap();
        let aside = normal.any_orthonormal_vector();
        for depth in [1e-3, 1e-2, 0.1] {
            // From inside and nearly along the surface: it comes out again.
            let direction = (aside + 0.02 * normal).normalize();
            let ray = Ray::new(seen.point - depth * normal, direction).unwrap();
            let leaving = Query { ray, from: Some(seen.root) };
            let far = hit(&leaving).map(|hit| hit.point.length());
            assert!(far.is_some_and(|r| (r - 1.0).abs() < 1e-12), "{depth}: {far:?}");
        }
    }
}
