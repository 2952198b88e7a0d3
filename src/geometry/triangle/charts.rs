//! Triangular patches as three tensor-product patches.

use std::borrow::Cow;

use glam::{DVec2, DVec4};

use super::TrianglePatch;
use super::triangle_patch::{Barycentric, mix};
use crate::geometry::chart::Sealed;
use crate::geometry::knots::unit_knots;
use crate::geometry::{Chart, ChartMap, Charts, NurbsSurface};

/// The middle of the parameter triangle: w = 1 − u − v is exact for these numbers.
const MIDDLE: DVec2 = DVec2::splat(1.0 / 3.0);

impl Sealed for TrianglePatch {}

impl Charts for TrianglePatch {
    /// Three patches of bidegree (n, n), one for each corner: from the corner to the middles of
    /// its two sides and the middle of the triangle. Together they are the triangle, exactly except
    /// for the rounding of their control points.
    ///
    /// Let `f` be the blossom of the homogeneous patch `A` of degree n, and
    /// `P(s, t) = (1−s)(1−t) c₀₀ + s(1−t) c₁₀ + (1−s)t c₀₁ + s t c₁₁` a quadrilateral in its
    /// parameters. Then `A(P) = f(P, …, P)`, where `f` is affine in each argument. Multiplied
    /// out, the term in which c₀₀, c₁₀, c₀₁, c₁₁ are taken a, b, c and k times occurs
    /// `n!/(a! b! c! k!)` times, with the factor `(1−s)ᵃ⁺ᶜ sᵇ⁺ᵏ (1−t)ᵃ⁺ᵇ tᶜ⁺ᵏ`. With `i = b + k`
    /// and `j = c + k` that is `Bᵢ(s) Bⱼ(t) / (C(n,i) C(n,j))`: the patch over the
    /// quadrilateral has the homogeneous control points
    ///
    /// `bᵢⱼ = Σₖ C(i,k) C(n−i, j−k) / C(n,j) · f(c₀₀ⁿ⁻ⁱ⁻ʲ⁺ᵏ, c₁₀ⁱ⁻ᵏ, c₀₁ʲ⁻ᵏ, c₁₁ᵏ)`.
    ///
    /// The factors are positive and add up to 1, and blossoms at places inside the triangle are
    /// convex combinations of its control points: weights stay positive. (DeRose, Goldman,
    /// Hagen & Mann 1993, "Functional composition algorithms via blossoming".)
    ///
    /// Blossoms take corners first, then middles of sides, then the middle. So charts share the
    /// control points of their common sides bit for bit, and so do two triangles that share
    /// the control points of a side.
    fn charts(&self) -> Vec<Chart<'_>> {
        let corners = [DVec2::ZERO, DVec2::X, DVec2::Y];
        let chart = |k: usize| {
            let [here, next, before] = [0, 1, 2].map(|step| corners[(k + step) % 3]);
            let places = [here, 0.5 * (here + next), 0.5 * (here + before), MIDDLE];
            Chart {
                surface: Cow::Owned(self.over(places)),
                map: ChartMap::Bilinear(places),
                border: [true, false, true, false],
                open_end: [false; 2],
                trims: None,
            }
        };
        (0..3).map(chart).collect()
    }
}

impl TrianglePatch {
    /// The part over the convex quadrilateral with these corners: the places to which (0, 0),
    /// (1, 0), (0, 1), (1, 1) are mapped.
    fn over(&self, places: [DVec2; 4]) -> NurbsSurface {
        let n = self.degree();
        let binomials = binomials(n);
        let choose = |n: usize, k: usize| binomials[n][k];
        let mut control = vec![DVec4::ZERO; (n + 1) * (n + 1)];
        self.blossoms(places.map(|at| [at.x, at.y, 1.0 - at.x - at.y]), &mut |[b, c, k], f| {
            let (i, j) = (b + k, c + k);
            let share = choose(i, k) * choose(n - i, c) / choose(n, j);
            control[i * (n + 1) + j] += share * f;
        });
        if !self.is_rational() {
            // Sums of equal weights differ by rounding only.
            let weight = self.control()[0].w;
            control.iter_mut().for_each(|point| point.w = weight);
        }
        NurbsSurface::assembled([unit_knots(n), unit_knots(n)], control)
    }

    /// Calls `found` with the blossom at n places out of four, for all ways to choose them, and
    /// with the numbers of times that the second, the third and the fourth are taken.
    fn blossoms(&self, at: [Barycentric; 4], found: &mut impl FnMut([usize; 3], DVec4)) {
        let n = self.degree();
        let mut first = self.control().to_vec();
        for a in 0..=n {
            let mut second = first.clone();
            for b in 0..=n - a {
                let mut third = second.clone();
                for c in 0..=n - a - b {
                    let k = n - a - b - c;
                    let mut last = third.clone();
                    (1..=k).rev().for_each(|degree| mix(&mut last, degree, at[3]));
                    found([b, c, k], last[0]);
                    if k > 0 {
                        mix(&mut third, k, at[2]);
                    }
                }
                if a + b < n {
                    mix(&mut second, n - a - b, at[1]);
                }
            }
            if a < n {
                mix(&mut first, n - a, at[0]);
            }
        }
    }
}

/// `C(m, k)` for m up to n ≤ 32, exact in f64.
fn binomials(n: usize) -> Vec<Vec<f64>> {
    let mut rows = vec![vec![1.0]];
    for m in 1..=n {
        let above = &rows[m - 1];
        let at = |k: usize| above.get(k).copied().unwrap_or(0.0);
        let row = (0..=m).map(|k| at(k) + k.checked_sub(1).map_or(0.0, at)).collect();
        rows.push(row);
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::RectSide;
    use crate::geometry::shapes::octant_quartic;
    use crate::math::rounding::{UNIT_ROUNDOFF, residual_factor};
    use glam::DVec3;

    /// A patch of any degree with weights from 0.3 to 1.7.
    fn bumpy(degree: usize, rational: bool) -> TrianglePatch {
        let exponents = (0..=degree).flat_map(|i| (0..=degree - i).map(move |j| (i, j)));
        let at = |(i, j): (usize, usize)| {
            let (x, y) = (i as f64 / degree as f64, j as f64 / degree as f64);
            DVec3::new(x, y, 0.5 + 0.3 * (5.0 * x + 3.0 * y * y).sin())
        };
        let points: Vec<DVec3> = exponents.map(at).collect();
        let weights = (0..points.len()).map(|k| 1.0 + 0.7 * (k as f64 * 1.7).sin()).collect();
        TrianglePatch::new(degree, points, rational.then_some(weights)).unwrap()
    }

    #[test]
    fn charts_are_the_triangle_to_rounding_at_every_degree() {
        let octant = octant_quartic(1.0).unwrap();
        let bumps =
            [1, 2, 3, 5, 9, 20, 32].into_iter().flat_map(|n| [bumpy(n, true), bumpy(n, false)]);
        for patch in bumps.chain([octant]) {
            let n = patch.degree();
            let mut worst: f64 = 0.0;
            for chart in patch.charts() {
                assert_eq!(chart.surface.is_rational(), patch.is_rational());
                for (s, t) in (0..=12).flat_map(|i| (0..=12).map(move |j| (i, j))) {
                    let (s, t) = (f64::from(s) / 12.0, f64::from(t) / 12.0);
                    let uv = chart.map.uv(DVec2::new(s, t));
                    let truth = patch.derivatives(uv);
                    let found = chart.surface.derivatives(DVec2::new(s, t));
                    // The place itself is rounded, by some units of the largest parameter, 1.
                    let speed = truth.du.length() + truth.dv.length();
                    let off = truth.point.distance(found.point) - 2.0 * UNIT_ROUNDOFF * speed;
                    worst = worst.max(off / UNIT_ROUNDOFF);
                    // Orientation stays.
                    let turned = truth.du.cross(truth.dv).dot(found.du.cross(found.dv));
                    assert!(turned > 0.0 || truth.du.cross(truth.dv).length() < 1e-6);
                }
            }
            let promise = residual_factor(n, n) / UNIT_ROUNDOFF;
            println!("degree {n}, {}: {worst} of {promise}", patch.is_rational());
            assert!(worst < 0.25 * promise, "degree {n}: {worst} of {promise}");
        }
    }

    #[test]
    fn common_sides_have_the_same_bits() {
        let patch = bumpy(5, true);
        let along = |surface: &NurbsSurface, side: RectSide| -> Vec<DVec4> {
            let [n, _] = surface.size();
            let at = |k: usize| side.control_point([n - 1; 2], k);
            (0..n).map(at).map(|[i, j]| surface.control()[i * n + j]).collect()
        };
        let charts = patch.charts();
        for k in 0..3 {
            let (here, next) = (&charts[k].surface, &charts[(k + 1) % 3].surface);
            assert_eq!(along(here, RectSide::LastU), along(next, RectSide::LastV));
        }
        // A neighbour beyond v = 0, run the other way: its corner w = 1 is our u = 1.
        let n = patch.degree();
        let mut control = bumpy(5, false).control().to_vec();
        let index = |i: usize| i * (2 * n + 3 - i) / 2;
        for i in 0..=n {
            control[index(i)] = patch.homogeneous(n - i, 0).unwrap();
        }
        let neighbour = TrianglePatch::from_homogeneous(n, control).unwrap();
        let others = neighbour.charts();
        let [first_u, first_v] = [RectSide::FirstU, RectSide::FirstV];
        assert_eq!(along(&charts[0].surface, first_v), along(&others[1].surface, first_u));
        assert_eq!(along(&charts[1].surface, first_u), along(&others[0].surface, first_v));
    }
}
