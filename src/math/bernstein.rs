//! Bernstein polynomials: values, derivatives, and nets cut down to part of their square.

use std::ops::{Add, Mul};

/// The largest degree a piece may have in one direction.
///
/// Bernstein sums stay accurate far beyond; the limit lets basis functions live on the
/// stack. CAD files rarely exceed degree 12.
pub const MAX_DEGREE: usize = 32;

/// Room for the basis functions of one direction.
pub type Basis = [f64; MAX_DEGREE + 1];

/// `B_i(t) = C(p, i) tⁱ (1 − t)^(p−i)` for `i = 0 … p`, and zeros in the room beyond.
///
/// `t` may lie outside `[0, 1]`; the functions then lose positivity, not validity. Each
/// value errs by at most `(2p + 2) u` relatively; at `t = 0` and `t = 1` they are exact.
pub fn basis<const N: usize>(degree: usize, t: f64) -> [f64; N] {
    let mut values = [0.0; N];
    let complement = 1.0 - t;

    // Powers of t upwards with the binomial factor, then powers of 1 − t downwards.
    let binomials = binomials(degree);
    let mut power = 1.0;
    for i in 0..=degree {
        values[i] = binomials[i] * power;
        power *= t;
    }
    power = 1.0;
    for i in (0..=degree).rev() {
        values[i] *= power;
        power *= complement;
    }
    values
}

/// `n` choose `k`, rounded. With `n` below 64 it is far from overflow.
pub fn binomial(n: usize, k: usize) -> f64 {
    (1..=k).fold(1.0, |product, i| product * (n + 1 - i) as f64 / i as f64)
}

/// `n` choose `k` for `k = 0 … n`, exact, and zeros in the room beyond; `n` is at most
/// [`MAX_DEGREE`]. Looked up: worked out one from another they take a division each, and longer
/// than all the rest of a sum over them.
#[inline(always)]
pub(crate) fn binomials(n: usize) -> &'static Basis {
    &BINOMIALS[n]
}

const BINOMIALS: [Basis; MAX_DEGREE + 1] = {
    let mut rows = [[0.0; MAX_DEGREE + 1]; MAX_DEGREE + 1];
    let mut n = 0;
    while n <= MAX_DEGREE {
        rows[n][0] = 1.0;
        let mut k = 1;
        while k <= n {
            rows[n][k] = rows[n - 1][k - 1] + rows[n - 1][k]; // Pascal's triangle
            k += 1;
        }
        n += 1;
    }
    rows
};

/// The derivatives `B_i'(t) = p (B_{i−1}^{p−1}(t) − B_i^{p−1}(t))`, from the functions of
/// degree `p − 1`.
pub fn derivative_from_lower<const N: usize>(degree: usize, lower: &[f64; N]) -> [f64; N] {
    let mut values = [0.0; N];
    let p = degree as f64;
    values[0] = -p * lower[0];
    for i in 1..degree {
        values[i] = p * (lower[i - 1] - lower[i]);
    }
    values[degree] = p * lower[degree - 1];
    values
}

/// The functions of degree `p` from those of degree `p − 1`:
/// `B_i^p = (1 − t) B_i^{p−1} + t B_{i−1}^{p−1}`.
pub fn raised<const N: usize>(degree: usize, t: f64, lower: &[f64; N]) -> [f64; N] {
    let mut values = [0.0; N];
    values[0] = (1.0 - t) * lower[0];
    for i in 1..degree {
        values[i] = (1.0 - t) * lower[i] + t * lower[i - 1];
    }
    values[degree] = t * lower[degree - 1];
    values
}

/// The coefficients of one row of a net: where they start and how far apart they are.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Index of the first coefficient.
    pub start: usize,
    /// Distance between neighbours.
    pub stride: usize,
    /// The degree; there is one coefficient more.
    pub degree: usize,
}

/// Replaces the coefficients of a polynomial on `[0, 1]` by those of the same polynomial
/// on `[a, b]` (de Casteljau at `b`, then at `a / b`; reversed where that is steadier).
///
/// `a` and `b` may lie outside `[0, 1]`. Each coefficient moves by at most `4 p u` times
/// the largest one, for `[a, b]` within `[0, 1]`.
pub fn restrict_row<T>(net: &mut [T], row: Row, a: f64, b: f64)
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    // The same for every degree; small ones in a row of known length, outside the net.
    match row.degree {
        1 => restrict_outside::<T, 2>(net, row, a, b),
        2 => restrict_outside::<T, 3>(net, row, a, b),
        3 => restrict_outside::<T, 4>(net, row, a, b),
        _ if row.stride == 1 => {
            let row = &mut net[row.start..=row.start + row.degree];
            restrict_along(row, a, b);
        }
        degree => cut(degree, a, b, |here, other, [own, others]| {
            let (here, other) = (row.start + here * row.stride, row.start + other * row.stride);
            net[here] = net[here] * own + net[other] * others;
        }),
    }
}

/// Restricts a row of `N` coefficients outside the net.
fn restrict_outside<T, const N: usize>(net: &mut [T], row: Row, a: f64, b: f64)
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let mut coefficients = std::array::from_fn::<T, N, _>(|i| net[row.start + i * row.stride]);
    restrict_along(&mut coefficients, a, b);
    for (i, coefficient) in coefficients.into_iter().enumerate() {
        net[row.start + i * row.stride] = coefficient;
    }
}

/// Restricts all coefficients of a row.
#[inline(always)]
fn restrict_along<T>(row: &mut [T], a: f64, b: f64)
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    cut(row.len() - 1, a, b, |here, other, [own, others]| {
        row[here] = row[here] * own + row[other] * others;
    });
}

/// Restricts all columns of a net at once, given the length of its rows: what lies side by side
/// is worked on side by side.
fn restrict_columns<T>(net: &mut [T], length: usize, a: f64, b: f64)
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    cut(net.len() / length - 1, a, b, |here, other, [own, others]| {
        let range = |row: usize| row * length..(row + 1) * length;
        let Ok([here, other]) = net.get_disjoint_mut([range(here), range(other)]) else {
            return; // two rows never overlap
        };
        for (here, &other) in here.iter_mut().zip(&*other) {
            *here = *here * own + other * others;
        }
    });
}

/// De Casteljau's steps that cut a polynomial of this degree down to `[a, b]`. `mix` is to
/// replace one coefficient, given first, by its mean with another; the weights are of both.
#[inline(always)]
fn cut(degree: usize, a: f64, b: f64, mut mix: impl FnMut(usize, usize, [f64; 2])) {
    // Cutting first at the end that leaves the longer part keeps the second cut inside.
    if 1.0 - a >= b {
        keep_right(degree, a, &mut mix);
        keep_left(degree, (b - a) / (1.0 - a), &mut mix);
    } else {
        keep_left(degree, b, &mut mix);
        keep_right(degree, a / b, &mut mix);
    }
}

/// De Casteljau at `t`, keeping the part on `[0, t]`.
#[inline(always)]
fn keep_left(degree: usize, t: f64, mix: &mut impl FnMut(usize, usize, [f64; 2])) {
    if t == 1.0 {
        return;
    }
    for level in 1..=degree {
        for i in (level..=degree).rev() {
            mix(i, i - 1, [t, 1.0 - t]);
        }
    }
}

/// De Casteljau at `t`, keeping the part on `[t, 1]`.
#[inline(always)]
fn keep_right(degree: usize, t: f64, mix: &mut impl FnMut(usize, usize, [f64; 2])) {
    if t == 0.0 {
        return;
    }
    for level in 1..=degree {
        for i in 0..=degree - level {
            mix(i, i + 1, [1.0 - t, t]);
        }
    }
}

/// Restricts a tensor-product net, second index fastest, to `[s0, s1] × [t0, t1]`.
pub fn restrict_net<T>(net: &mut [T], degree: [usize; 2], s: [f64; 2], t: [f64; 2])
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let [p, q] = degree;
    if s != [0.0, 1.0] && p > 3 {
        restrict_columns(net, q + 1, s[0], s[1]);
    } else if s != [0.0, 1.0] {
        for j in 0..=q {
            restrict_row(net, Row { start: j, stride: q + 1, degree: p }, s[0], s[1]);
        }
    }
    if t != [0.0, 1.0] {
        for i in 0..=p {
            restrict_row(net, Row { start: i * (q + 1), stride: 1, degree: q }, t[0], t[1]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn basis_sums_to_one_and_matches_the_recurrence() {
        for degree in 1..=MAX_DEGREE {
            for t in [-0.1, 0.0, 1e-9, 0.3, 0.5, 0.99, 1.0, 1.1] {
                let values: Basis = basis(degree, t);
                let lower: Basis = basis(degree - 1, t);
                let sum: f64 = values.iter().sum();
                let size: f64 = values.iter().map(|b| b.abs()).sum();
                assert!((sum - 1.0).abs() < 1e-14 * size, "degree {degree} at {t}: {sum}");
                let raised = raised(degree, t, &lower);
                for i in 0..=degree {
                    assert!((values[i] - raised[i]).abs() <= 1e-14 * size, "degree {degree}");
                }
            }
        }
    }

    #[test]
    fn derivative_is_that_of_a_power() {
        // t³ has the coefficients 0, 0, 0, 1; its derivative is 3t².
        let t = 0.37;
        let derivative: Basis = derivative_from_lower(3, &basis(2, t));
        assert!((derivative[3] - 3.0 * t * t).abs() < 1e-15);
    }

    #[test]
    fn a_restricted_net_is_the_same_polynomial() {
        let degree = [4, 3];
        let net: Vec<f64> = (0..20).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
        let value = |net: &[f64], s: f64, t: f64| {
            let (bs, bt): (Basis, Basis) = (basis(4, s), basis(3, t));
            (0..20).map(|k| net[k] * bs[k / 4] * bt[k % 4]).sum::<f64>()
        };
        for (s, t) in
            [([0.2, 0.7], [0.9, 1.0]), ([-0.05, 1.05], [0.0, 0.25]), ([0.5, 0.6], [0.1, 0.9])]
        {
            let mut part = net.clone();
            restrict_net(&mut part, degree, s, t);
            for (a, b) in [(0.0, 0.0), (0.3, 0.8), (1.0, 0.5)] {
                let whole = value(&net, s[0] + a * (s[1] - s[0]), t[0] + b * (t[1] - t[0]));
                assert!((value(&part, a, b) - whole).abs() < 1e-14);
            }
        }
    }
}
