//! Converts control points to coefficients of powers, line by line of a net: of eight nets side by
//! side, or of eight numbers of one net.

use fearless_simd::{Simd, SimdBase, SimdFloat, f64x8};
use fearless_simd_macros::simd;

use crate::patch::{MOST_DEGREE_BY_POWERS, ToPowers};

/// The largest number of points of a line.
pub(crate) const MOST_IN_LINE: usize = MOST_DEGREE_BY_POWERS + 1;

/// For each coefficient the [shares](ToPowers::shares) of control points, for degrees below `N`.
pub(super) type Shares<S, const N: usize> = [[f64x8<S>; N]; N];

/// The coefficients of powers, from control points, for degrees up to three.
#[inline(always)]
pub(super) fn coefficients<S: Simd>(
    simd: S,
    shares: &Shares<S, 4>,
    degree: usize,
    points: [f64x8<S>; 4],
) -> [f64x8<S>; 4] {
    let mut coefficients = [f64x8::splat(simd, 0.0); 4];
    let middle = ToPowers::middle(degree);
    coefficients[0] = points[middle];
    for k in 0..degree {
        let other = points[k + usize::from(k >= middle)] - points[middle];
        for i in 0..=degree {
            coefficients[i] = other.mul_add(shares[i][k], coefficients[i]);
        }
    }
    coefficients
}

/// Where lines of points lie in an array of groups of eight numbers.
#[derive(Clone, Copy)]
pub(super) struct Lines {
    /// Lines that lie side by side form a block: how many blocks there are, and how far apart they
    /// begin.
    pub(super) blocks: usize,
    pub(super) apart: usize,
    /// How many lines a block has, and how far apart the points of a line are.
    pub(super) count: usize,
    pub(super) step: usize,
}

/// Converts points to coefficients of powers, in place, for any degree up to seven.
#[inline(always)]
pub(super) fn make_lines<S: Simd>(
    simd: S,
    shares: &Shares<S, MOST_IN_LINE>,
    degree: usize,
    lines: Lines,
    numbers: &mut [[f64; 8]],
) {
    match degree {
        1 => make_lines_of::<S, 2>(simd, shares, lines, numbers),
        2 => make_lines_of::<S, 3>(simd, shares, lines, numbers),
        3 => make_lines_of::<S, 4>(simd, shares, lines, numbers),
        4 => make_lines_of::<S, 5>(simd, shares, lines, numbers),
        5 => make_lines_of::<S, 6>(simd, shares, lines, numbers),
        6 => make_lines_of::<S, 7>(simd, shares, lines, numbers),
        _ => make_lines_of::<S, MOST_IN_LINE>(simd, shares, lines, numbers),
    }
}

/// The same for lines of `N` points, with the operations of [`coefficients`]; unrolled, so that
/// sums stay in registers.
#[simd]
fn make_lines_of<S: Simd, const N: usize>(
    simd: S,
    shares: &Shares<S, MOST_IN_LINE>,
    lines: Lines,
    numbers: &mut [[f64; 8]],
) {
    for block in 0..lines.blocks {
        for line in 0..lines.count {
            let first = block * lines.apart + line;
            let point = |k: usize| f64x8::from_slice(simd, &numbers[first + k * lines.step]);
            let at = ToPowers::middle(N - 1);
            let middle = point(at);
            let mut others = [f64x8::splat(simd, 0.0); N];
            for k in 0..N - 1 {
                others[k] = point(k + usize::from(k >= at)) - middle;
            }
            for i in 0..N {
                let mut sum = if i == 0 { middle } else { f64x8::splat(simd, 0.0) };
                for k in 0..N - 1 {
                    sum = others[k].mul_add(shares[i][k], sum);
                }
                sum.store_slice(&mut numbers[first + i * lines.step]);
            }
        }
    }
}
