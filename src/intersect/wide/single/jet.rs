//! The true surface at one place, in f64, with lanes for the coordinates.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f64x4, mask64x4};

use crate::intersect::wide::surface::sums::OneNet;
use crate::math::bernstein::binomials;
use crate::patch::TensorPatch;

/// How the sums of a patch are computed at one place, in parameters `x`, `y` of their own.
pub(super) trait NetSums<S: Simd> {
    /// Where the unit square of `s` and `t` begins in these parameters, and how long its sides are.
    const START: f64;
    const SIDE: f64;

    /// Returns `X, W` and their derivatives by `x` and by `y`, with lanes for the coordinates.
    fn at(simd: S, surface: &OneNet<'_>, x: f64, y: f64) -> [f64x4<S>; 3];
}

/// By powers (Horner), for degrees `P` and `Q`, zero standing for any below `N`, and `C` numbers a
/// point: four where weights differ, else three.
pub(super) struct Powers<const P: usize, const Q: usize, const C: usize, const N: usize = 4>;

impl<S: Simd, const P: usize, const Q: usize, const C: usize, const N: usize> NetSums<S>
    for Powers<P, Q, C, N>
{
    // Powers are those of twice the distance from the middle.
    const START: f64 = -1.0;
    const SIDE: f64 = 2.0;

    #[inline(always)]
    fn at(simd: S, OneNet { patch, net }: &OneNet<'_>, x: f64, y: f64) -> [f64x4<S>; 3] {
        let [p, q] = if P == 0 { patch.sums_degree() } else { [P, Q] };
        let (x, y) = (f64x4::splat(simd, x), f64x4::splat(simd, y));
        let zero = f64x4::splat(simd, 0.0);
        // Rows do not wait for each other.
        let (mut sums, mut slopes) = ([zero; N], [zero; N]);
        for i in 0..=p {
            // A length that is known takes fewer comparisons.
            let row = if Q == 0 { net.row(i) } else { net.numbers_from(i, C * (Q + 1) + 1) };
            let (mut sum, mut slope) = (load::<S, C>(simd, row, q), zero);
            for j in (0..q).rev() {
                slope = if j + 1 == q { sum } else { slope.mul_add(y, sum) };
                sum = sum.mul_add(y, load::<S, C>(simd, row, j));
            }
            (sums[i], slopes[i]) = (sum, slope);
        }
        let (mut value, mut along_x, mut along_y) = (sums[p], zero, slopes[p]);
        for i in (0..p).rev() {
            along_x = if i + 1 == p { value } else { along_x.mul_add(x, value) };
            value = value.mul_add(x, sums[i]);
            along_y = along_y.mul_add(x, slopes[i]);
        }
        weighted::<S, C>(patch, [value, along_x, along_y])
    }
}

/// By Bernstein functions, the same sums as in [`TensorPatch::jet`], of any degree below `N`.
pub(super) struct Bernstein<const N: usize, const C: usize>;

impl<S: Simd, const N: usize, const C: usize> NetSums<S> for Bernstein<N, C> {
    const START: f64 = 0.0;
    const SIDE: f64 = 1.0;

    #[inline(always)]
    fn at(simd: S, OneNet { patch, net }: &OneNet<'_>, s: f64, t: f64) -> [f64x4<S>; 3] {
        let [p, q] = patch.sums_degree();
        let mut bases = [Basis::<N>::ZERO; 2];
        bases[0].fill(p, s);
        bases[1].fill(q, t);
        let [bs, bt] = bases.each_ref().map(|basis| &basis.values);
        let [ds, dt] = bases.each_ref().map(|basis| &basis.slopes);
        let zero = f64x4::splat(simd, 0.0);
        let (mut value, mut along_s, mut along_t) = (zero, zero, zero);
        for i in 0..=p {
            let row = net.row(i);
            let (mut sum, mut slope) = (zero, zero);
            for j in 0..=q {
                let control = load::<S, C>(simd, row, j);
                sum = control.mul_add(f64x4::splat(simd, bt[j]), sum);
                slope = control.mul_add(f64x4::splat(simd, dt[j]), slope);
            }
            value = sum.mul_add(f64x4::splat(simd, bs[i]), value);
            along_s = sum.mul_add(f64x4::splat(simd, ds[i]), along_s);
            along_t = slope.mul_add(f64x4::splat(simd, bs[i]), along_t);
        }
        weighted::<S, C>(patch, [value, along_s, along_t])
    }
}

/// Sets the one weight of all points, where points have three numbers.
#[inline(always)]
fn weighted<S: Simd, const C: usize>(
    patch: &TensorPatch,
    [value, along_s, along_t]: [f64x4<S>; 3],
) -> [f64x4<S>; 3] {
    if C == 4 {
        return [value, along_s, along_t];
    }
    let weight = patch.weight().unwrap_or(1.0);
    [with_weight(value, weight), with_weight(along_s, 0.0), with_weight(along_t, 0.0)]
}

/// A control point of a row, of `C` numbers; where it has three, the weight is any number.
#[inline(always)]
fn load<S: Simd, const C: usize>(simd: S, row: &[f64], j: usize) -> f64x4<S> {
    f64x4::from_slice(simd, &row[C * j..C * j + 4])
}

/// The vector with another weight.
#[inline(always)]
fn with_weight<S: Simd>(v: f64x4<S>, weight: f64) -> f64x4<S> {
    let simd = v.simd;
    mask64x4::from_bitmask(simd, 0b1000).select(f64x4::splat(simd, weight), v)
}

/// Bernstein functions and their derivatives, filled in where they stand: returned ones would be
/// copied, which stalls.
struct Basis<const N: usize> {
    values: [f64; N],
    slopes: [f64; N],
}

impl<const N: usize> Basis<N> {
    const ZERO: Self = Self { values: [0.0; N], slopes: [0.0; N] };

    /// Fills in the functions of a degree, by the recurrence from those of one degree less.
    #[inline(always)]
    fn fill(&mut self, degree: usize, t: f64) {
        let Self { values, slopes } = self;
        let rest = 1.0 - t;
        let binomials = binomials(degree - 1);
        // The functions of the lower degree are kept in `slopes` for a while.
        let mut power = 1.0;
        for i in 0..degree {
            slopes[i] = power * binomials[i];
            power *= t;
        }
        power = 1.0;
        for i in (0..degree).rev() {
            slopes[i] *= power;
            power *= rest;
        }
        let p = degree as f64;
        let mut before = 0.0;
        for i in 0..degree {
            let here = slopes[i];
            values[i] = rest * here + t * before;
            slopes[i] = p * (before - here);
            before = here;
        }
        values[degree] = t * before;
        slopes[degree] = p * before;
    }
}
