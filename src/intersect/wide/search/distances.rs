//! The distances of sixteen rays from one leaf's approximation, in f32, and the starts found from
//! them, lane by lane.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, SimdWiden, f32x16, f64x8};
use fearless_simd_macros::simd;

use super::convergence::STEPS_IN_F32;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::lane_rays::{LaneRays, RaySixteen};
use crate::intersect::wide::vectors::{dot_d, load3d};
use crate::intersect::wide::view::Fitted;
use crate::patch::{Leaf, WeightFit};

/// The shortest and the longest last step, in box coordinates, after which the place found is
/// refined.
const LEAST_REFINED: f32 = 1.0 / 256.0;
const MOST_REFINED: f32 = 0.25;

/// The distances `f₁`, `f₂` of a leaf's approximation from the planes of sixteen rays, times its
/// weight (see [`Leaf`]): coefficients of `xⁱ yʲ`, at `4 i + j`, lane by lane.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct LaneDistances {
    of: [[[f32; LANES]; 16]; 2],
    /// Whether all terms of degree three in `x` or `y` are known to be zero, so that nine of the
    /// sixteen are enough.
    are_biquadratic: bool,
}

impl Default for LaneDistances {
    fn default() -> Self {
        Self { of: [[[0.0; LANES]; 16]; 2], are_biquadratic: false }
    }
}

/// The places that the search in f32 has found, and its last step.
#[derive(Clone, Copy)]
pub(crate) struct NearRoots<S: Simd> {
    /// The place, in box coordinates.
    pub(super) near: [f32x16<S>; 2],
    pub last: LastStep<S>,
}

/// A step of the search in f32.
#[derive(Clone, Copy)]
pub(crate) struct LastStep<S: Simd> {
    /// Where it starts, and where it leads if the domain's bounds are ignored.
    pub from: [f32x16<S>; 2],
    pub to: [f32x16<S>; 2],
    /// The distances where it starts, and their derivatives by `x` and by `y`.
    pub distances: [f32x16<S>; 2],
    pub slopes: [[f32x16<S>; 2]; 2],
    /// The inverse Jacobian there: from distances from the ray's planes to box coordinates.
    pub inverse: [[f32x16<S>; 2]; 2],
}

impl<S: Simd> NearRoots<S> {
    /// The place, in box coordinates.
    #[inline(always)]
    pub(crate) fn place(&self) -> [f32x16<S>; 2] {
        self.near
    }
}

impl<S: Simd> LastStep<S> {
    /// The step from a place with these distances and slopes.
    #[inline(always)]
    fn new(
        simd: S,
        from: [f32x16<S>; 2],
        distances: [f32x16<S>; 2],
        slopes: [[f32x16<S>; 2]; 2],
    ) -> Self {
        let ([f1, f2], [[a1, a2], [b1, b2]]) = (distances, slopes);
        let d = f32x16::splat(simd, 1.0) / (a1 * b2 - a2 * b1);
        let inverse = [[b2 * d, -b1 * d], [-a2 * d, a1 * d]];
        let [[xx, xy], [yx, yy]] = inverse;
        let to = [from[0] - xx.mul_add(f1, xy * f2), from[1] - yx.mul_add(f1, yy * f2)];
        Self { from, to, distances, slopes, inverse }
    }
}

impl LaneDistances {
    /// The coefficients: which distance, which term, which lane.
    #[inline(always)]
    pub(crate) fn terms(&self) -> &[[[f32; LANES]; 16]; 2] {
        &self.of
    }

    /// The same, to be set: any of them may then be other than zero.
    #[inline(always)]
    pub(crate) fn terms_mut(&mut self) -> &mut [[[f32; LANES]; 16]; 2] {
        self.are_biquadratic = false;
        &mut self.of
    }

    /// Sets the distances of sixteen rays.
    ///
    /// Those of the leaf's middle are computed in f64; what is added to them in f32 has the size of
    /// the leaf, so its rounding error is small compared with the leaf.
    #[simd]
    pub(crate) fn take<S: Simd>(&mut self, simd: S, fitted: Fitted<'_>, rays: RaySixteen<'_>) {
        self.are_biquadratic = fitted.leaf.is_biquadratic();
        if self.are_biquadratic {
            self.take_terms::<S, 3>(simd, fitted, rays);
        } else {
            self.take_terms::<S, 4>(simd, fitted, rays);
        }
    }

    /// [`Self::take`] for polynomials that have `N` powers of `x` and of `y`.
    #[inline(always)]
    fn take_terms<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        Fitted { leaf, weight }: Fitted<'_>,
        rays: RaySixteen<'_>,
    ) {
        let middle = middle_distances(simd, leaf, rays);
        let normals = rays.normals(simd);
        let [x, y, z] = leaf.fit();
        for m in 0..16 {
            if m / 4 >= N || m % 4 >= N {
                for k in 0..2 {
                    self.of[k][m] = [0.0; LANES];
                }
                continue;
            }
            let (x, y, z) =
                (f32x16::splat(simd, x[m]), f32x16::splat(simd, y[m]), f32x16::splat(simd, z[m]));
            for k in 0..2 {
                let n = normals[k];
                let mut c = n[2].mul_add(z, n[1].mul_add(y, n[0] * x));
                if m == 0 && weight.is_none() {
                    c += middle[k];
                }
                c.store_slice(&mut self.of[k][m]);
            }
        }
        if let Some(weight) = weight {
            self.add_weight::<S, N>(simd, weight, &middle);
        }
    }

    /// Adds the middle's distances times the weight.
    #[inline(always)]
    fn add_weight<S: Simd, const N: usize>(
        &mut self,
        simd: S,
        weight: &WeightFit,
        middle: &[f32x16<S>; 2],
    ) {
        for m in (0..4 * N).filter(|m| m % 4 < N) {
            let w = f32x16::splat(simd, weight[m]);
            for k in 0..2 {
                let lanes = &mut self.of[k][m];
                w.mul_add(middle[k], f32x16::from_slice(simd, lanes)).store_slice(lanes);
            }
        }
    }

    /// The distances in the leaf's middle.
    #[inline(always)]
    pub(crate) fn in_middle<S: Simd>(&self, simd: S) -> [f32x16<S>; 2] {
        [f32x16::from_slice(simd, &self.of[0][0]), f32x16::from_slice(simd, &self.of[1][0])]
    }

    /// Runs Newton's iteration in box coordinates, from starts there and within rectangles.
    #[simd]
    pub(crate) fn newton<S: Simd>(
        &self,
        simd: S,
        start: [f32x16<S>; 2],
        domain: [[f32x16<S>; 2]; 2],
    ) -> NearRoots<S> {
        if self.are_biquadratic {
            self.newton_of::<S, 3>(simd, start, domain)
        } else {
            self.newton_of::<S, 4>(simd, start, domain)
        }
    }

    /// [`Self::newton`] for polynomials that have `N` powers of `x` and of `y`.
    #[inline(always)]
    fn newton_of<S: Simd, const N: usize>(
        &self,
        simd: S,
        start: [f32x16<S>; 2],
        [[low_x, high_x], [low_y, high_y]]: [[f32x16<S>; 2]; 2],
    ) -> NearRoots<S> {
        let [mut x, mut y] = start;
        let both = [start; 2];
        let mut last =
            LastStep { from: start, to: start, distances: start, slopes: both, inverse: both };
        for _ in 0..STEPS_IN_F32 {
            let [f1, a1, b1] = evaluate::<S, N>(simd, &self.of[0], x, y);
            let [f2, a2, b2] = evaluate::<S, N>(simd, &self.of[1], x, y);
            last = LastStep::new(simd, [x, y], [f1, f2], [[a1, a2], [b1, b2]]);
            // NaN becomes a bound, or stays: then nothing converges.
            x = last.to[0].max(low_x).min(high_x);
            y = last.to[1].max(low_y).min(high_y);
        }
        NearRoots { near: [x, y], last }
    }

    /// Refines the places that were found, by one more step with the matrix of the last step: this
    /// leaves a hundredth of the error, for a third of that step's time. Short last steps leave
    /// less error than is worth it.
    #[simd]
    pub(crate) fn refine<S: Simd>(&self, simd: S, searched: &NearRoots<S>) -> [f32x16<S>; 2] {
        let NearRoots { near: [x, y], last } = *searched;
        let [last_x, last_y] = [last.to[0] - last.from[0], last.to[1] - last.from[1]];
        let longest = last_x.abs().max(last_y.abs());
        // False for NaN.
        let long = longest.simd_gt(f32x16::splat(simd, LEAST_REFINED))
            & longest.simd_le(f32x16::splat(simd, MOST_REFINED));
        if long.all_false() {
            return [x, y];
        }
        let (f1, f2) = (value(simd, &self.of[0], x, y), value(simd, &self.of[1], x, y));
        let [[xx, xy], [yx, yy]] = last.inverse;
        let step = [xx.mul_add(f1, xy * f2), yx.mul_add(f1, yy * f2)];
        [long.select(x - step[0], x), long.select(y - step[1], y)]
    }
}

/// One step of Newton's from the middle of a flat leaf, by the linear terms of the distances of
/// sixteen rays: there it leads about as near to the root as f32 can tell.
#[simd]
pub(crate) fn step_from_middle<S: Simd>(
    simd: S,
    fitted: Fitted<'_>,
    rays: RaySixteen<'_>,
    widened: f32x16<S>,
) -> NearRoots<S> {
    let middle = middle_distances(simd, fitted.leaf, rays);
    let normals = rays.normals(simd);
    // The values in the middle, and the slopes by `x` and `y`.
    let distances = coefficient(simd, fitted, 0, middle, &normals);
    let by_x = coefficient(simd, fitted, 4, middle, &normals);
    let by_y = coefficient(simd, fitted, 1, middle, &normals);
    let last = LastStep::new(simd, [f32x16::splat(simd, 0.0); 2], distances, [by_x, by_y]);
    let [x, y] = last.to;
    let near = [x.max(-widened).min(widened), y.max(-widened).min(widened)];
    NearRoots { near, last }
}

/// The sum of the absolute values of all terms that a leaf's distances from sixteen rays were added
/// up from, for the larger of the two: the measure of their rounding error. `middle` are the
/// distances in the leaf's middle.
#[simd]
pub(crate) fn terms<S: Simd>(
    simd: S,
    fitted: Fitted<'_>,
    middle: [f32x16<S>; 2],
    rays: RaySixteen<'_>,
) -> f32x16<S> {
    let sizes = sizes(simd, fitted);
    let mut terms = f32x16::splat(simd, 0.0);
    let normals = rays.normals(simd);
    for k in 0..2 {
        let mut sum = middle[k].abs() * f32x16::splat(simd, sizes[3]);
        for axis in 0..3 {
            sum = normals[k][axis].abs().mul_add(f32x16::splat(simd, sizes[axis]), sum);
        }
        terms = terms.max(sum);
    }
    terms
}

/// The sums of the absolute values of the coefficients of a leaf's approximation, by coordinate,
/// and of its weight.
#[inline(always)]
pub(crate) fn sizes<S: Simd>(simd: S, Fitted { leaf, weight }: Fitted<'_>) -> [f32; 4] {
    let sum = |row: &[f32; 16]| f32x16::from_slice(simd, row).abs().reduce_sum();
    let [x, y, z] = leaf.fit();
    [sum(x), sum(y), sum(z), weight.map_or(1.0, sum)]
}

/// A bicubic polynomial and its derivatives by `x` and `y` (Horner), of which `N` powers of `x` and
/// of `y` are not zero: three or four.
#[simd]
fn evaluate<S: Simd, const N: usize>(
    simd: S,
    lanes: &[[f32; LANES]; 16],
    x: f32x16<S>,
    y: f32x16<S>,
) -> [f32x16<S>; 3] {
    let zero = f32x16::splat(simd, 0.0);
    let three = f32x16::splat(simd, 3.0);
    let (x2, x3) = (x + x, x * x * three);
    let (y2, y3) = (y + y, y * y * three);
    let mut row = [zero; 4];
    let mut slope = [zero; 4];
    for j in 0..N {
        let [c0, c1, c2, c3] = coefficients(simd, lanes, j);
        if N == 3 {
            row[j] = c2.mul_add(x, c1).mul_add(x, c0);
            slope[j] = c2.mul_add(x2, c1);
        } else {
            row[j] = c3.mul_add(x, c2).mul_add(x, c1).mul_add(x, c0);
            slope[j] = c3.mul_add(x3, c2.mul_add(x2, c1));
        }
    }
    if N == 3 {
        return [
            row[2].mul_add(y, row[1]).mul_add(y, row[0]),
            slope[2].mul_add(y, slope[1]).mul_add(y, slope[0]),
            row[2].mul_add(y2, row[1]),
        ];
    }
    [
        row[3].mul_add(y, row[2]).mul_add(y, row[1]).mul_add(y, row[0]),
        slope[3].mul_add(y, slope[2]).mul_add(y, slope[1]).mul_add(y, slope[0]),
        row[3].mul_add(y3, row[2].mul_add(y2, row[1])),
    ]
}

/// The coefficients of `xⁱ yʲ` for one `j`.
#[inline(always)]
fn coefficients<S: Simd>(simd: S, lanes: &[[f32; LANES]; 16], j: usize) -> [f32x16<S>; 4] {
    // Written out: where `map` of an array is not inlined, its vectors go through memory.
    let of = |row: usize| f32x16::from_slice(simd, &lanes[row + j]);
    [of(0), of(4), of(8), of(12)]
}

/// A bicubic polynomial alone.
#[inline(always)]
fn value<S: Simd>(simd: S, lanes: &[[f32; LANES]; 16], x: f32x16<S>, y: f32x16<S>) -> f32x16<S> {
    let mut row = [y; 4];
    for j in 0..4 {
        let [c0, c1, c2, c3] = coefficients(simd, lanes, j);
        row[j] = c3.mul_add(x, c2).mul_add(x, c1).mul_add(x, c0);
    }
    row[3].mul_add(y, row[2]).mul_add(y, row[1]).mul_add(y, row[0])
}

/// The distances of a leaf's approximation from sixteen rays in its middle, where `middle` are
/// those of the point that the approximation is relative to.
#[inline(always)]
pub(crate) fn distances_in_middle<S: Simd>(
    simd: S,
    fitted: Fitted<'_>,
    middle: [f32x16<S>; 2],
    rays: RaySixteen<'_>,
) -> [f32x16<S>; 2] {
    coefficient(simd, fitted, 0, middle, &rays.normals(simd))
}

/// The coefficient `m` of the distances of a leaf's approximation from sixteen rays.
#[inline(always)]
fn coefficient<S: Simd>(
    simd: S,
    Fitted { leaf, weight }: Fitted<'_>,
    m: usize,
    middle: [f32x16<S>; 2],
    normals: &[[f32x16<S>; 3]; 2],
) -> [f32x16<S>; 2] {
    let [x, y, z] = leaf.fit();
    let (x, y, z) =
        (f32x16::splat(simd, x[m]), f32x16::splat(simd, y[m]), f32x16::splat(simd, z[m]));
    let weight = f32x16::splat(simd, weight.unwrap_or(&ONE)[m]);
    let mut of = middle;
    for k in 0..2 {
        let n = &normals[k];
        let c = n[2].mul_add(z, n[1].mul_add(y, n[0] * x));
        of[k] = weight.mul_add(middle[k], c);
    }
    of
}

/// All sixteen coefficients of the distance of a leaf's approximation from the `k`-th plane of one
/// of sixteen rays: what [`LaneDistances::take`] puts into its lane. `middle` is the distance of
/// the point that the approximation is relative to.
#[inline(always)]
pub(crate) fn coefficients_of_lane<S: Simd>(
    simd: S,
    Fitted { leaf, weight }: Fitted<'_>,
    rays: RaySixteen<'_>,
    (k, lane): (usize, usize),
    middle: f32,
) -> f32x16<S> {
    let [x, y, z] = leaf.fit();
    let row = |row: &[f32; 16]| f32x16::from_slice(simd, row);
    let n = |axis: usize| f32x16::splat(simd, rays.scaled.normals[k][axis][rays.base + lane]);
    let c = n(2).mul_add(row(z), n(1).mul_add(row(y), n(0) * row(x)));
    row(weight.unwrap_or(&ONE)).mul_add(f32x16::splat(simd, middle), c)
}

/// The weight where there is none.
const ONE: [f32; 16] = {
    let mut one = [0.0; 16];
    one[0] = 1.0;
    one
};

/// The distances of the leaf's middle from the rays' planes, computed in f64.
#[simd]
pub(crate) fn middle_distances<S: Simd>(
    simd: S,
    leaf: &Leaf,
    rays: RaySixteen<'_>,
) -> [f32x16<S>; 2] {
    let [a1, a2] = half_distances(simd, leaf, rays.rays, rays.base);
    let [b1, b2] = half_distances(simd, leaf, rays.rays, rays.base + 8);
    [simd.narrow_f64x8(a1, b1), simd.narrow_f64x8(a2, b2)]
}

#[simd]
fn half_distances<S: Simd>(simd: S, leaf: &Leaf, rays: &LaneRays, base: usize) -> [f64x8<S>; 2] {
    let origin: [f64x8<S>; 3] = load3d(simd, &rays.origin, base);
    let offset = [
        f64x8::splat(simd, leaf.middle.x) - origin[0],
        f64x8::splat(simd, leaf.middle.y) - origin[1],
        f64x8::splat(simd, leaf.middle.z) - origin[2],
    ];
    let n1: [f64x8<S>; 3] = load3d(simd, &rays.normals[0], base);
    let n2: [f64x8<S>; 3] = load3d(simd, &rays.normals[1], base);
    [dot_d(n1, offset), dot_d(n2, offset)]
}

/// One half of sixteen lanes, in f64.
#[inline(always)]
pub(crate) fn widened<S: Simd>(value: f32x16<S>, half: usize) -> f64x8<S> {
    let (low, high) = value.widen();
    if half == 0 { low } else { high }
}

/// Those of sixteen numbers from `first` on that fit into a register, in f64.
#[inline(always)]
pub(crate) fn part_in_f64<S: Simd>(simd: S, value: f32x16<S>, first: usize) -> S::f64s {
    let narrow = S::f32s::LEN;
    let base = first / narrow * narrow;
    let (low, high) = S::f32s::from_slice(simd, &value.as_slice()[base..base + narrow]).widen();
    if first == base { low } else { high }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{NurbsSurface, shapes};
    use crate::intersect::level::dispatch;
    use crate::intersect::{Kernel, SurfaceBvh};
    use crate::math::SplitMix;

    #[test]
    fn leaves_of_quadrics_are_biquadratic() {
        let share = |surface: NurbsSurface| {
            let bvh = SurfaceBvh::build(&[surface]).unwrap();
            let biquadratic = bvh.leaves().iter().filter(|leaf| leaf.is_biquadratic()).count();
            biquadratic as f64 / bvh.leaves().len() as f64
        };
        let cylinder = shapes::cylinder(1.0, 2.0).unwrap().elevated_v(1).unwrap();
        for surface in [shapes::sphere(1.0).unwrap(), shapes::torus(2.0, 0.5).unwrap(), cylinder] {
            assert_eq!(share(surface), 1.0);
        }
        assert_eq!(share(shapes::bicubic_graph()), 0.0);
    }

    /// Nine terms lead to the places of sixteen, of which seven are zero, bit for bit.
    #[test]
    fn terms_that_are_zero_change_nothing() {
        let mut random = SplitMix::new(19);
        let mut sixteen = |size: f32| -> [f32; LANES] {
            std::array::from_fn(|_| size * (random.unit() as f32 - 0.5))
        };
        for _ in 0..200 {
            let mut all = LaneDistances::default();
            for k in 0..2 {
                for m in [0, 1, 2, 4, 5, 6, 8, 9, 10] {
                    all.of[k][m] = sixteen(if m == 4 >> (2 * k) { 4.0 } else { 0.3 });
                }
            }
            let fewer = LaneDistances { are_biquadratic: true, ..all.clone() };
            let start = [sixteen(1.0), sixteen(1.0)];
            for level in Kernel::ALL.iter().filter_map(|kernel| kernel.level()) {
                let [places, same] = [&all, &fewer].map(|distances| {
                    dispatch!(level, simd => {
                        let one = f32x16::splat(simd, 1.0);
                        let start = [0, 1].map(|k| f32x16::from_slice(simd, &start[k]));
                        let near = distances.newton(simd, start, [[-one, one]; 2]);
                        near.place().map(<[f32; LANES]>::from)
                    })
                });
                assert_eq!(places, same);
            }
        }
    }
}
