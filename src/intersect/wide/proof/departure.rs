//! Proves that secondary rays do not meet a leaf again: the one that they leave, or one beside it.
//!
//! The certificate proves this for steep rays; the proofs of single rays and packets prove it for
//! others, part by part. But no proof of a single root can succeed where the ray's line meets the
//! leaf again *behind* the ray's start, as it does wherever the surface bends away from the ray.
//! Roots ahead must be told from roots behind.
//!
//! # Proof
//! Let the ray leave the root `y₁`, on the leaf or not far beside it on the same piece, and let `y`
//! be another root, in the leaf, farther along the ray by `z > 0`: `S(y) − S(y₁) = z d`. For any
//! unit vector `N` with `N · d > 0`, the height `h = N · (S(y) − S(y₁))` is `z (N · d)`, and
//! `z = |S(y) − S(y₁)|`. So there is no such root where `h` stays below `(N · d) |S(y) − S(y₁)|` on
//! the leaf.
//!
//! `N` is the approximation's normal at the start. With `Δ = y − y₁`, each coordinate times the
//! length of the leaf's half side in its direction:
//!
//! - The points are at least `|Δ| / stretch` apart
//!   ([`Leaf::stretch`](crate::patch::Leaf::stretch)).
//! - The approximation's own height is at most `½ Λ |Δ|² + ε |Δ|`. `Λ` is the largest eigenvalue of
//!   its second derivatives, from the sums of their terms' absolute values: below zero where the
//!   leaf bends away from the ray. `ε` bounds how far `N` is from being perpendicular to the
//!   tangents at `y₁`. At the stated start `N` is perpendicular to them, except for rounding; from
//!   there to `y₁` they change by at most the norm of the second derivatives times the distance of
//!   the two places. This distance is at most `stretch` times that of their points, `D`. Let `r` be
//!   the distance of the ray's origin from the point of the stated start, and `c` the cosine. If
//!   the surface were the plane there, `D` would be `r / c` at most; it leaves the plane by at most
//!   `½ κ D²`, so `D ≤ r / c + ½ κ D² / c`. Where `2 κ r < c²`, as is asked for, this leaves a gap
//!   from `2 r / c` to `c / κ`, and as the origin moves from that point to its place, the root
//!   moves from there and stays below the gap. (All of these bounds hold a little outside the leaf,
//!   so this distance must not be large.)
//! - Or `Λ` is the second derivative in the one direction that `Δ` can have, up to a small angle.
//!   Let `m` be the unit vector across the ray in the tangent plane: `m · (S(y) − S(y₁))` is zero.
//!   The approximation's value differs from `g · Δ` by at most the sum of what its own second
//!   derivatives contribute, `ε |Δ|` with these in place of the height's, and the slopes' error
//!   times `|Δ|`. So the sine of the angle between `Δ` and the line `g · Δ = 0` is at most `τ`,
//!   this sum over `|g| |Δ|`; and a quadratic form over `|Δ|²` differs from its value on the line
//!   by at most `2 τ + 2 τ²` of its norm. (Of `Δx²`, `Δx Δy` and `Δy²`, over `|Δ|`, the first is at
//!   most the largest `|Δx|`, the last the largest `|Δy|`, and the middle one the smaller of the
//!   two.)
//! - The true height differs from the approximation's by no more than the bound of the slopes'
//!   error times the sum of the parameters' differences.
//!
//! Where there is a weight `W` (see [`Leaf`](crate::patch::Leaf)), all this is said of
//! `N · X̂ − (N · p) Ŵ` instead, where `p` is the approximation's point at the stated start: there
//! its slopes are those of the height, times the weight. Between the two places the true function
//! changes by `N · (X − S(y₁) W)`, which is the height times the weight, and by `N · (S(y₁) − p)`
//! times the change of the weight. The latter is at most the distance of `p` from `S(y₁)`, times
//! the weight's slopes, times `|Δ|`. (At the stated start, `p` is off `S` by the bound of the
//! distances' error, over the weight; as `p` lies where the bounds hold, they are good for its
//! heights, too.) So the height stays below its limit where all this stays below the least weight
//! times that limit; and it is the same across the ray.
//!
//! All terms are divided by `|Δ|`, which is at most its value from the start to the farthest
//! corner.
//!
//! How far the origin is from the surface's point at the start is first taken from the
//! approximation, and from the surface itself only where the approximation's error matters.

mod approximation;

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;

use self::approximation::{Bends, Plane, Weights};
use crate::intersect::wide::reach::WITH_SLACK_F32;
use crate::intersect::wide::vectors::lane_bits;
use crate::intersect::wide::view::Fitted;
use crate::patch::FIT_DOMAIN;

/// Rounding error in f32 of places, as a part of the sides' lengths, and of all that does not
/// depend on the normal: 30 units of 2⁻²⁴. Where the stretch is finite, terms add up to at most
/// twice the sides; each takes 12 roundings by Horner's scheme; the origin, the axis and the start
/// take few. (Quotients have more terms and larger ones: see [`Weights::terms`].)
const PLACE_ROUNDING: f32 = 2e-6;

/// Rounding error in f32 of slopes measured along the normal, over the ratio of the tangents' cross
/// product to that of the sides: 280 units. Each tangent errs by seven units of its terms, so the
/// normal by 64 at most; the normal is multiplied with the ray's direction, with both tangents, and
/// with half the second derivatives.
const NORMAL_ROUNDING: f32 = 1.8e-5;

/// How far from the middle the ray may start, in box coordinates; the approximation's bounds hold a
/// little farther.
pub(crate) const MAY_START: f32 = 1.19;

/// How far the ray's own root may be from the place where it is said to start, in box coordinates:
/// the approximation's bounds hold farther by this.
const ROOT_APART: f32 = 0.0099;
const _: () = assert!(FARTHEST < FIT_DOMAIN as f32);

/// How far from the middle the bounds must hold, in box coordinates.
const FARTHEST: f32 = MAY_START + ROOT_APART;

/// Half side lengths of leaves of which anything is proved: the squares of others might leave the
/// range of f32.
const LENGTHS: std::ops::Range<f32> = 1e-15..1e15;

/// Rays whose angle to the normal has at most this sine are too steep for their direction to be
/// used.
const STEEPEST: f32 = 0.1;

/// The part of the cosine that is used, a little less than all: for rounding of the sums that are
/// compared.
const ALMOST: f32 = 0.99;

/// Sixteen rays that start on a leaf.
pub(crate) struct Departure<S: Simd> {
    /// The starts, in box coordinates.
    pub place: [f32x16<S>; 2],
    /// The origins, relative to the leaf's middle.
    pub origin: [f32x16<S>; 3],
    /// The unit directions.
    pub axis: [f32x16<S>; 3],
    /// How far each origin should be, at most, from the surface's point at the start.
    pub reach: f32x16<S>,
}

/// Rays that are proved not to meet the leaf again, a bit each.
#[derive(Clone, Copy)]
pub(crate) struct Final {
    /// Unconditionally.
    pub surely: u32,
    /// If their origins are where they should be.
    pub if_near: u32,
}

impl<S: Simd> Departure<S> {
    /// Which rays are proved not to have the leaf ahead of them again.
    #[simd]
    pub(crate) fn is_final(&self, simd: S, fitted: Fitted<'_>) -> Final {
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
        let most =
            f32x16::splat(simd, ALMOST * weights.least / stretch) * plane.cosine - errors.slopes;

        // How far the root may be from the stated start, and how much slopes may differ, per unit
        // of the origin's distance from there.
        let moved = f32x16::splat(simd, 2.0 * stretch) / plane.cosine;
        let weight_turned = f32x16::splat(simd, 2.0 * weights.slope) / plane.cosine;
        let turned = moved.mul_add(bends.norm(), weight_turned);

        // In any direction; the effect of the normal's rounding on that is a part of the norm.
        let [far_x, far_y] = self.farthest(simd, lengths);
        let largest = bends.norm().mul_add(errors.flattened, bends.largest(simd));
        // In the direction of the ray, and in those that differ from it by a small angle.
        let (speed, ahead) = bends.ahead(simd, &plane);
        let bent_aside = bends.bent_aside(simd, [far_x, far_y]);
        let turned_aside = moved.mul_add(bends.norm_aside(), weight_turned);
        let angle = (bent_aside + errors.slopes + self.reach * turned_aside) / speed;
        let ahead = angle.mul_add(angle, angle).mul_add(bends.norm() + bends.norm(), ahead);

        let half = f32x16::splat(simd, 0.5);
        let farthest = far_x.mul_add(far_x, far_y * far_y).sqrt();
        let left = [most - half * largest * farthest, most - half * ahead * farthest];

        // All are false for NaN. Where the leaf bends away, `left` is larger than `most`, which
        // still is the limit.
        let flat = plane.sine.simd_gt(f32x16::splat(simd, STEEPEST));
        let inside =
            self.place[0].abs().max(self.place[1].abs()).simd_le(f32x16::splat(simd, MAY_START));
        let known = self.reach * turned;
        let apart = f32x16::splat(simd, ROOT_APART * lengths[0].min(lengths[1]));
        let bends_less = known.simd_lt(left[0]) | flat & known.simd_lt(left[1]);
        let inside = inside & (self.reach * moved).simd_lt(apart);
        let if_near = inside & known.simd_lt(most) & bends_less;
        // In no coordinate is the origin off by more than that, so in space by less than twice
        // that.
        let seen = self.reach + self.reach + f32x16::splat(simd, 3.0 * errors.point);
        let near = plane.off.simd_le(self.reach + f32x16::splat(simd, errors.point));
        let surely = if_near & near & (seen * moved).simd_lt(apart);
        let seen = seen * turned;
        let surely = surely & seen.simd_lt(most) & seen.simd_lt(left[0]);
        Final { surely: lane_bits(surely), if_near: lane_bits(if_near) }
    }

    /// How far the leaf's sides may be from the start, and a little more: a distance in each
    /// parameter, times the length of the half side.
    #[inline(always)]
    fn farthest(&self, simd: S, [length_x, length_y]: [f32; 2]) -> [f32x16<S>; 2] {
        let [x, y] = self.place;
        let reach = f32x16::splat(simd, WITH_SLACK_F32 + ROOT_APART);
        [
            (x.abs() + reach) * f32x16::splat(simd, length_x),
            (y.abs() + reach) * f32x16::splat(simd, length_y),
        ]
    }
}

/// Errors of the approximation and of rounding.
struct Errors<S: Simd> {
    /// Error bound of the approximation's points.
    point: f32,
    /// Error bound of slopes, both of the height and across the ray.
    slopes: f32x16<S>,
    /// What the normal's rounding adds to slopes and, relative to their norm, to second
    /// derivatives.
    flattened: f32x16<S>,
}

impl<S: Simd> Errors<S> {
    #[inline(always)]
    fn new(simd: S, fitted: Fitted<'_>, weights: &Weights, plane: &Plane<S>) -> Self {
        let leaf = fitted.leaf;
        let [length_x, length_y] = leaf.half_side_lengths();
        let per_side = (1.0 / length_x).hypot(1.0 / length_y);
        let rounding = PLACE_ROUNDING * weights.terms * (length_x + length_y);
        // Tangents, which may be far shorter than the leaf is long, contain the point times the
        // weight's slopes.
        let [x, y, z] = plane.point;
        let size = x.abs() + y.abs() + z.abs();
        let by_weight =
            (size + f32x16::splat(simd, length_x + length_y)) * f32x16::splat(simd, weights.slope);
        let flattened = (by_weight + f32x16::splat(simd, weights.terms)) * plane.per_length;
        let flattened = flattened * f32x16::splat(simd, NORMAL_ROUNDING);
        let by_weight = by_weight * f32x16::splat(simd, PLACE_ROUNDING);
        let point = leaf.fit_error() * fitted.heaviest() + rounding;
        let slope_error = leaf.slope_error().mul_add(per_side, PLACE_ROUNDING * weights.terms);
        let slopes =
            f32x16::splat(simd, slope_error + point * weights.slope) + by_weight + flattened;
        Self { point, slopes, flattened }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use glam::{DVec2, DVec3};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::intersect::wide::testing::weighted_hills;
    use crate::intersect::{Hit, Query, SurfaceBvh};
    use crate::math::Ray;
    use crate::math::testing::same_cases;

    /// A ray that leaves a leaf, and what is proved of it.
    struct Leaving {
        said: Final,
        /// Whether the exact solver meets the leaf farther along the ray than at the root nearest
        /// to the stated start.
        meets_again: bool,
    }

    /// How rays leave a leaf.
    #[derive(Clone, Copy, Debug)]
    struct Way {
        /// The stated start, in box coordinates.
        place: [f64; 2],
        /// The cosine of the angle to the normal, which may be negative, and an angle about it.
        cosine: f64,
        turn: f64,
        /// How far the origin is from the surface's point at the start, and where: along the
        /// normal, which may be negative, and across.
        reach: f64,
        height: f64,
        around: f64,
    }

    fn leaving(bvh: &SurfaceBvh, leaf: usize, way: Way) -> Leaving {
        let index = leaf as u32;
        let leaf = &bvh.leaves[leaf];
        let piece = &bvh.patches().pieces()[leaf.piece as usize];
        let Way { place, cosine, turn, reach, height, around } = way;
        let at = |k: usize| {
            let [from, to] = leaf.rect()[k];
            0.5 * ((from + to) + place[k] * (to - from))
        };
        let st = DVec2::new(at(0), at(1));
        let jet = piece.patch.jet(st);
        let normal = jet.ds.cross(jet.dt).normalize();
        let (a, b) = normal.any_orthonormal_pair();
        let tilted = |cosine: f64, turn: f64| {
            let sine = (1.0 - cosine * cosine).sqrt();
            cosine * normal + sine * (turn.cos() * a + turn.sin() * b)
        };
        let direction = tilted(cosine, turn);
        let origin = jet.point + reach * tilted(height, around);

        let level = Kernel::best_level();
        let view = bvh.view();
        let fitted = view.fitted(index, &piece.patch);
        let said = dispatch!(level, simd => {
            let splat = |x: f64| f32x16::splat(simd, x as f32);
            let splat3 = |v: DVec3| [splat(v.x), splat(v.y), splat(v.z)];
            Departure {
                place: [splat(place[0]), splat(place[1])],
                origin: splat3(origin - leaf.middle),
                axis: splat3(direction),
                reach: splat(1.001 * reach + 1e-14),
            }
            .is_final(simd, fitted)
        });

        // The whole line, so that the root that is left is among its hits.
        let ray = Ray::with_range(origin, direction, -9.0, f64::INFINITY).unwrap();
        let mut hits: Vec<Hit> = Vec::new();
        let _ = bvh.tracer().exact_all_hits(&Query::primary(ray), &mut hits);
        hits.retain(|hit| hit.root.piece == leaf.piece);
        let apart = |hit: &Hit| hit.root.st.distance(st);
        let left = hits.iter().min_by(|a, b| apart(a).total_cmp(&apart(b))).copied();
        let rect = leaf.rect();
        let inside = |st: DVec2| (0..2).all(|k| rect[k][0] <= st[k] && st[k] <= rect[k][1]);
        let meets_again = left.is_some_and(|left| {
            hits.iter().any(|hit| hit.t > left.t + 1e-9 && inside(hit.root.st))
        });
        Leaving { said, meets_again }
    }

    /// Rays leave a sphere, a stout and a thin torus, and hills, anywhere, on the surface or beside
    /// it. None that meets its leaf again is proved final; all that leave the sphere itself outwards
    /// are, except at a cosine below 1e-2 or on a leaf with a stretch above 2.
    #[test]
    fn only_what_is_not_met_again_is_final() {
        let sphere = SurfaceBvh::build(&[shapes::sphere(1.0).unwrap()]).unwrap();
        let torus = SurfaceBvh::build(&[shapes::torus(1.0, 0.4).unwrap()]).unwrap();
        let ring = SurfaceBvh::build(&[shapes::torus(1.0, 0.03).unwrap()]).unwrap();
        let hills = SurfaceBvh::build(&[weighted_hills()]).unwrap();
        let met_again = Cell::new(0);
        let proved = [Cell::new(0), Cell::new(0), Cell::new(0), Cell::new(0)];
        let proved_beside = Cell::new(0);
        let config = same_cases(30_000);
        let place = || -1.19..1.19f64;
        // In units of `c² / κ`: around the largest at which anything is proved, and below.
        let part = prop_oneof![
            Just(0.0),
            (-1.5..0.5f64).prop_map(|size| 10f64.powf(size)),
            (-9.0..0.0f64).prop_map(|size| 10f64.powf(size)),
        ];
        let ways = (place(), place(), -6.0..0.0f64, any::<bool>(), 0.0..6.3f64);
        let ways = (0usize.., ways, part, -1.0..1.0f64, 0.0..6.3f64);
        proptest!(config, |((k, (x, y, size, inwards, turn), part, height, around) in ways)| {
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
                let least_radius = [1.0, 0.4, 0.03, 1.0][m];
                let reach = part * cosine * cosine * least_radius;
                let way = Way { place: [x, y], cosine, turn, reach, height, around };
                let Leaving { said, meets_again } = leaving(bvh, index, way);
                let said = (said.surely | said.if_near) & 1 != 0;
                prop_assert!(!(said && meets_again), "leaf {index} of {m}: {way:?}");
                met_again.set(met_again.get() + u32::from(meets_again));
                proved[m].set(proved[m].get() + u32::from(said));
                proved_beside.set(proved_beside.get() + u32::from(said && part > 0.05));
                // Outside the sphere nothing is met again.
                let elsewhere = m > 0 || inwards || part > 0.0;
                let clear = elsewhere || leaf.stretch() > 2.0 || cosine < 1e-2;
                prop_assert!(said || clear, "leaf {index} of {m}: {way:?}");
            }
        });
        let [met_again, beside] = [met_again.get(), proved_beside.get()];
        assert!(met_again > 500 && beside > 500, "{met_again} {beside}");
        assert!(proved[0].get() > 5_000 && proved[1].get() > 4_000, "{proved:?}");
        assert!(proved[2].get() > 4_000 && proved[3].get() > 3_000, "{proved:?}");
    }

    /// A ray that starts beside the surface, though it is said to start on it, is left to other
    /// searches.
    #[test]
    fn origins_elsewhere_are_noticed() {
        let sphere = shapes::sphere(1.0).unwrap();
        let bvh = SurfaceBvh::build(&[sphere]).unwrap();
        let normal = DVec3::new(0.6, 0.48, 0.64);
        let hit = |query: &Query| bvh.tracer().first_hit(query).hit;
        let seen = hit(&Query::primary(Ray::new(3.0 * normal, -normal).unwrap())).unwrap();
        let aside = normal.any_orthonormal_vector();
        for depth in [1e-3, 1e-2, 0.1] {
            // From inside and nearly along the surface: the ray comes out again.
            let direction = (aside + 0.02 * normal).normalize();
            let ray = Ray::new(seen.point - depth * normal, direction).unwrap();
            let leaving = Query { ray, from: Some(seen.root) };
            let far = hit(&leaving).map(|hit| hit.point.length());
            assert!(far.is_some_and(|r| (r - 1.0).abs() < 1e-12), "{depth}: {far:?}");
        }
    }
}
