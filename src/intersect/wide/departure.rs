//! Secondary rays on the leaf they leave, or one beside it: whether they meet it again.
//!
//! The certificate says so of steep rays, and the proofs of single rays and packets of others, part
//! by part; but no proof that there is one root only can succeed where the ray's line meets the
//! leaf again *behind* the ray's start, as it does wherever the surface bends away from the ray.
//! What lies ahead must be told from what lies behind.
//!
//! # Proof
//! Let the ray leave the root `y₁` of the leaf or not far beside it on the same piece, and let `y` be
//! another one, in the leaf, farther along the ray by `z > 0`: `S(y) − S(y₁) = z d`. For any vector `N` with `N · d > 0`, of length one, the
//! height `h = N · (S(y) − S(y₁))` is `z (N · d)`, and `z = |S(y) − S(y₁)|`. So there is no such
//! root where `h` stays below `(N · d) |S(y) − S(y₁)|` on the leaf.
//!
//! `N` is the approximation's normal at the start. With `Δ = y − y₁`, each coordinate times the
//! length of the leaf's half side in its direction:
//!
//! - the points are at least `|Δ| / stretch` apart ([`Leaf::stretch`]);
//! - the approximation's own height is at most `½ Λ |Δ|² + ε |Δ|`. `Λ` is the largest eigenvalue of
//!   its second derivatives, from the sums of their terms' sizes: below zero where the leaf bends
//!   away from the ray. `ε` is what `N` is not perpendicular to the tangents at `y₁` by: it is at
//!   the place the ray is said to start on, but for rounding, and `y₁` is not farther from that
//!   than the ray's origin is, over the cosine;
//! - the true height differs from it by no more than the bound of the slopes' error times the sum
//!   of the parameters' differences.
//!
//! All is divided by `|Δ|`, which is at most what it is from the start to the farthest corner.
//!
//! How far the origin is from the surface's point at the start is seen from the approximation first,
//! and only where its error matters from the surface itself.

use fearless_simd::{Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;

use super::search::bits;
use super::single_proof::LEAF;
use crate::patch::Leaf;

/// What rounding to f32 does to a slope, as a part of the sides' lengths: products of three numbers
/// of sums of sixteen terms, some 60 units of 2⁻²⁴; the terms add up to twice the sides at most
/// where there is a stretch.
const ROUNDING: f32 = 3e-5;

/// Where the ray may start, in box coordinates: the approximation's bounds hold a little farther.
pub(super) const NEARBY: f32 = 1.19;

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
    pub(super) fn is_final(&self, simd: S, leaf: &Leaf) -> Final {
        let stretch = leaf.stretch();
        if stretch == f32::INFINITY {
            return Final { surely: 0, if_near: 0 };
        }
        let lengths = leaf.side_lengths();
        let [per_x, per_y] = lengths.map(|length| 1.0 / length);
        let per_side = per_x.hypot(per_y);

        let Tangents { off, normal, along } = self.tangents(simd, leaf);
        let length = dot(normal, normal).sqrt();
        let sign = splat(simd, 1.0).copysign(along);
        let cosine = along.abs() / length;

        // Second derivatives of the height: at most, and in size for the mixed one.
        let [mut xx, mut xy, mut yy] = [splat(simd, 0.0); 3];
        let fit = leaf.fit();
        for i in 0..4 {
            for j in 0..4 {
                if i + j < 2 {
                    continue;
                }
                let m = 4 * i + j;
                let [x, y, z] = [fit[0][m], fit[1][m], fit[2][m]];
                let height = normal[0].mul_add(
                    splat(simd, x),
                    normal[1].mul_add(splat(simd, y), normal[2] * splat(simd, z)),
                );
                let weight = reach_to(i + j - 2);
                match (i, j) {
                    (2, 0) => xx += height * sign * splat(simd, 2.0),
                    (0, 2) => yy += height * sign * splat(simd, 2.0),
                    _ => {
                        let size = height.abs();
                        xx = size
                            .mul_add(splat(simd, (i * i.saturating_sub(1)) as f32 * weight), xx);
                        xy = size.mul_add(splat(simd, (i * j) as f32 * weight), xy);
                        yy = size
                            .mul_add(splat(simd, (j * j.saturating_sub(1)) as f32 * weight), yy);
                    }
                }
            }
        }
        let (xx, yy) = (xx * splat(simd, per_x * per_x), yy * splat(simd, per_y * per_y));
        let xy = xy * splat(simd, 2.0 * per_x * per_y);
        let apart = xx - yy;
        let largest = splat(simd, 0.5) * (xx + yy + apart.mul_add(apart, xy * xy).sqrt());

        let farthest = {
            let x = (self.place[0].abs() + splat(simd, LEAF)) * splat(simd, lengths[0]);
            let y = (self.place[1].abs() + splat(simd, LEAF)) * splat(simd, lengths[1]);
            x.mul_add(x, y * y).sqrt()
        };
        let bent = splat(simd, 0.5) * largest * farthest / length;
        let fit_error = leaf.fit_error();
        let rounding = ROUNDING * stretch * (lengths[0] + lengths[1]);
        let slopes = splat(simd, (leaf.slope_error() + rounding) * per_side);
        let most = splat(simd, ALMOST / stretch) * cosine;
        let aside = splat(simd, stretch * per_side) / cosine;
        let most_beside = most - bent.max(splat(simd, 0.0)) - slopes;
        // All are false for NaN.
        let inside = self.place[0].abs().max(self.place[1].abs()).simd_le(splat(simd, NEARBY));
        let if_near = inside & (self.reach * aside).simd_lt(most_beside);
        let seen = self.reach + splat(simd, 2.0 * fit_error + rounding);
        let near = off.simd_le(self.reach + splat(simd, fit_error + rounding));
        let surely = if_near & near & (seen * aside).simd_lt(most_beside);
        Final { surely: bits(surely), if_near: bits(if_near) }
    }

    /// What the approximation says of the starts (Horner's scheme, coordinate by coordinate).
    #[simd]
    fn tangents(&self, simd: S, leaf: &Leaf) -> Tangents<S> {
        let zero = f32x16::splat(simd, 0.0);
        let [x, y] = self.place;
        let three = f32x16::splat(simd, 3.0);
        let (x2, x3) = (x + x, x * x * three);
        let (y2, y3) = (y + y, y * y * three);
        let (mut along_x, mut along_y) = ([zero; 3], [zero; 3]);
        let mut off = zero;
        for axis in 0..3 {
            let fit = &leaf.fit()[axis];
            let (mut row, mut slope) = ([zero; 4], [zero; 4]);
            for j in 0..4 {
                let c0 = f32x16::splat(simd, fit[j]);
                let c1 = f32x16::splat(simd, fit[4 + j]);
                let c2 = f32x16::splat(simd, fit[8 + j]);
                let c3 = f32x16::splat(simd, fit[12 + j]);
                row[j] = c3.mul_add(x, c2).mul_add(x, c1).mul_add(x, c0);
                slope[j] = c3.mul_add(x3, c2.mul_add(x2, c1));
            }
            let value = row[3].mul_add(y, row[2]).mul_add(y, row[1]).mul_add(y, row[0]);
            off = off.max((value - self.origin[axis]).abs());
            along_x[axis] = slope[3].mul_add(y, slope[2]).mul_add(y, slope[1]).mul_add(y, slope[0]);
            along_y[axis] = row[3].mul_add(y3, row[2].mul_add(y2, row[1]));
        }
        let normal = cross(along_x, along_y);
        Tangents { off, normal, along: dot(normal, self.axis) }
    }
}

struct Tangents<S: Simd> {
    /// How far the origin is from the approximation, in the coordinate it is farthest in.
    off: f32x16<S>,
    /// Perpendicular to the surface, of any length.
    normal: [f32x16<S>; 3],
    /// Its part along the ray.
    along: f32x16<S>,
}

#[inline(always)]
fn splat<S: Simd>(simd: S, x: f32) -> f32x16<S> {
    f32x16::splat(simd, x)
}

#[inline(always)]
fn dot<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> f32x16<S> {
    a[0].mul_add(b[0], a[1].mul_add(b[1], a[2] * b[2]))
}

#[inline(always)]
fn cross<S: Simd>(a: [f32x16<S>; 3], b: [f32x16<S>; 3]) -> [f32x16<S>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A power of [`NEARBY`].
const fn reach_to(power: usize) -> f32 {
    let mut product = 1.0;
    let mut k = 0;
    while k < power {
        product *= NEARBY;
        k += 1;
    }
    product
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use fearless_simd::{Level, dispatch};
    use glam::{DVec2, DVec3};
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::{BuildOptions, Hit, Query, Root, SurfaceBvh};
    use crate::math::Ray;

    /// A ray that leaves a leaf, and what is said of it.
    struct Leaving {
        said: Final,
        /// Whether the exact solver meets the leaf ahead.
        meets_again: bool,
    }

    /// From box coordinates `place` of a leaf, at an angle of this cosine to the normal, which may
    /// be negative; `turn` is an angle about it.
    fn leaving(bvh: &SurfaceBvh, leaf: &Leaf, place: [f64; 2], cosine: f64, turn: f64) -> Leaving {
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
        let said = dispatch!(level, simd => {
            let splat = |x: f64| f32x16::splat(simd, x as f32);
            let splat3 = |v: DVec3| [splat(v.x), splat(v.y), splat(v.z)];
            Departure {
                place: [splat(place[0]), splat(place[1])],
                origin: splat3(jet.point - leaf.middle),
                axis: splat3(direction),
                reach: splat(1e-14),
            }
            .is_final(simd, leaf)
        });

        let root = Root { piece: leaf.piece, st, error: 1e-14 };
        let ray = Ray::new(jet.point, direction).unwrap();
        let mut hits: Vec<Hit> = Vec::new();
        bvh.tracer().all_hits(&Query { ray, from: Some(root) }, &mut hits);
        let rect = leaf.rect();
        let inside = |st: DVec2| (0..2).all(|k| rect[k][0] <= st[k] && st[k] <= rect[k][1]);
        let meets_again =
            hits.iter().any(|hit| hit.root.piece == leaf.piece && inside(hit.root.st));
        Leaving { said, meets_again }
    }

    /// What is proved of rays that leave a sphere outwards, and a torus anywhere: never of one that
    /// meets its leaf again, and of the sphere's whatever the angle.
    #[test]
    fn only_what_is_not_met_again_is_final() {
        let options = BuildOptions::default();
        let sphere = SurfaceBvh::build(&[shapes::sphere(1.0).unwrap()], &options).unwrap();
        let torus = SurfaceBvh::build(&[shapes::torus(1.0, 0.4).unwrap()], &options).unwrap();
        let met_again = Cell::new(0);
        let proved = [Cell::new(0), Cell::new(0)];
        let config = ProptestConfig { cases: 20_000, ..ProptestConfig::default() };
        let rays =
            (0usize.., -1.19..1.19f64, -1.19..1.19f64, -4.0..0.0f64, any::<bool>(), 0.0..6.3f64);
        proptest!(config, |((k, x, y, size, inwards, turn) in rays)| {
            for (m, bvh) in [&sphere, &torus].into_iter().enumerate() {
                let leaf = &bvh.leaves[k % bvh.leaves.len()];
                let cosine = 10f64.powf(size) * if inwards { -1.0 } else { 1.0 };
                let piece = &bvh.patches().pieces()[leaf.piece as usize];
                let on_piece = [x, y].iter().zip(leaf.rect()).all(|(x, [from, to])| {
                    (0.0..=1.0).contains(&(0.5 * ((from + to) + x * (to - from))))
                });
                if leaf.pole(piece).is_some() || !on_piece {
                    continue;
                }
                let Leaving { said, meets_again } = leaving(bvh, leaf, [x, y], cosine, turn);
                let said = (said.surely | said.if_near) & 1 != 0;
                prop_assert!(!(said && meets_again), "leaf {k} at {x}, {y}, {cosine}, {turn}");
                met_again.set(met_again.get() + u32::from(meets_again));
                proved[m].set(proved[m].get() + u32::from(said));
                // Outside the sphere nothing is met again.
                let clear = m == 1 || inwards || leaf.stretch() > 2.0 || cosine < 1e-2;
                prop_assert!(said || clear, "leaf {k} at {x}, {y}, {cosine}, {turn}");
            }
        });
        assert!(met_again.get() > 500, "{met_again:?}");
        assert!(proved[0].get() > 5_000 && proved[1].get() > 4_000, "{proved:?}");
    }

    /// A ray that starts beside the surface, though it is said to start on it, is left to others.
    #[test]
    fn origins_elsewhere_are_noticed() {
        let sphere = shapes::sphere(1.0).unwrap();
        let bvh = SurfaceBvh::build(&[sphere], &BuildOptions::default()).unwrap();
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
