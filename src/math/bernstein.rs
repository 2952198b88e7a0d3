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
pub(crate) fn basis<const N: usize>(degree: usize, t: f64) -> [f64; N] {
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

/// `n` choose `k`, rounded; 0 for `k` above `n`. With `n` below 64 it is far from overflow.
pub(crate) fn binomial(n: usize, k: usize) -> f64 {
    if k > n {
        return 0.0;
    }
    (1..=k).fold(1.0, |product, i| product * (n - (i - 1)) as f64 / i as f64)
}

/// `n` choose `k` for `k = 0 … n`, exact, and zeros in the room beyond. `n` is at most
/// [`MAX_DEGREE`] + 3, because products of pieces with cubics occur, and of small pieces with each
/// other. They are looked up: to compute one from another takes a division each, and longer than
/// all the rest of a sum over them.
#[inline(always)]
pub(crate) const fn binomials(n: usize) -> &'static [f64; MAX_DEGREE + 4] {
    &BINOMIALS[n]
}

const BINOMIALS: [[f64; MAX_DEGREE + 4]; MAX_DEGREE + 4] = {
    let mut rows = [[0.0; MAX_DEGREE + 4]; MAX_DEGREE + 4];
    let mut n = 0;
    while n < rows.len() {
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
pub(crate) fn derivative_from_lower<const N: usize>(degree: usize, lower: &[f64; N]) -> [f64; N] {
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
pub(crate) fn raised<const N: usize>(degree: usize, t: f64, lower: &[f64; N]) -> [f64; N] {
    let mut values = [0.0; N];
    values[0] = (1.0 - t) * lower[0];
    for i in 1..degree {
        values[i] = (1.0 - t) * lower[i] + t * lower[i - 1];
    }
    values[degree] = t * lower[degree - 1];
    values
}

/// Replaces the coefficients of a polynomial on `[0, 1]` by those of the same polynomial
/// on `[a, b]` (de Casteljau at `b`, then at `a / b`; reversed where that is steadier).
///
/// There are `p + 1` coefficients (an empty slice stays empty). `a ≤ b` may lie outside `[0, 1]`.
/// For `[a, b]` within `[0, 1]`, each coefficient is off by at most `6 p u` times the largest one:
/// each of the two cuts mixes `p` times, with three roundings a mix; with random signs they come to
/// less than `4 p u`. (The parameter of the second cut is rounded itself, as if the part ended up to
/// `3 u` beside `a` or `b`.) Beyond, the error grows as polynomials do: at `e` outside at both ends, by a
/// factor of up to `(1 + 2 e)ᵖ`.
pub(crate) fn restrict<T>(coefficients: &mut [T], a: f64, b: f64)
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    Cuts::to(a, b).apply(coefficients);
}

/// Restricts a tensor-product net of `(p + 1)(q + 1)` coefficients, second index fastest, to
/// `[s0, s1] × [t0, t1]`: first all columns, then all rows, which rounds twice as often as one
/// restriction of a curve.
///
/// # Panics
/// If there are not that many coefficients.
#[track_caller]
pub fn restrict_net<T>(net: &mut [T], degree: [usize; 2], s: [f64; 2], t: [f64; 2])
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    let [p, q] = degree;
    assert_eq!(net.len(), (p + 1) * (q + 1), "coefficients of degrees {degree:?}");
    if s != [0.0, 1.0] {
        let cuts = Cuts::to(s[0], s[1]);
        match p {
            1 => cuts.apply_to_columns::<T, 2>(net, q + 1),
            2 => cuts.apply_to_columns::<T, 3>(net, q + 1),
            3 => cuts.apply_to_columns::<T, 4>(net, q + 1),
            _ => cuts.apply_to_long_columns(net, q + 1),
        }
    }
    if t != [0.0, 1.0] {
        let cuts = Cuts::to(t[0], t[1]);
        for row in net.chunks_exact_mut(q + 1) {
            cuts.apply(row);
        }
    }
}

/// De Casteljau's cuts that leave `[a, b]` of `[0, 1]`, worked out once for many polynomials.
#[derive(Clone, Copy)]
struct Cuts {
    /// What lies right of this parameter is kept: it is one of `[0, 1]`, or of `[0, right]` if that
    /// is cut first.
    left: f64,
    /// What lies left of this parameter is kept: it is one of `[0, 1]`, or of `[left, 1]`.
    right: f64,
    left_first: bool,
}

impl Cuts {
    fn to(a: f64, b: f64) -> Self {
        // Cutting first at the end that leaves the longer part keeps the second cut inside.
        if 1.0 - a >= b {
            Self { left: a, right: (b - a) / (1.0 - a), left_first: true }
        } else {
            Self { left: a / b, right: b, left_first: false }
        }
    }

    /// The steps that cut a polynomial of this degree. `mix` must replace one coefficient, given
    /// first, by its mean with another, with the weights of both.
    #[inline(always)]
    fn steps(&self, degree: usize, mut mix: impl FnMut(usize, usize, [f64; 2])) {
        if self.left_first {
            self.cut_left(degree, &mut mix);
            self.cut_right(degree, &mut mix);
        } else {
            self.cut_right(degree, &mut mix);
            self.cut_left(degree, &mut mix);
        }
    }

    #[inline(always)]
    fn cut_left(&self, degree: usize, mix: &mut impl FnMut(usize, usize, [f64; 2])) {
        let t = self.left;
        if t == 0.0 {
            return;
        }
        // Half-open ranges: loops over them are unrolled where the degree is known.
        for last in (0..degree).rev() {
            for i in 0..last + 1 {
                mix(i, i + 1, [1.0 - t, t]);
            }
        }
    }

    #[inline(always)]
    fn cut_right(&self, degree: usize, mix: &mut impl FnMut(usize, usize, [f64; 2])) {
        let t = self.right;
        if t == 1.0 {
            return;
        }
        for first in 0..degree {
            for i in (first..degree).rev() {
                mix(i + 1, i, [t, 1.0 - t]);
            }
        }
    }

    /// Cuts one polynomial: by the same steps for every degree, which are unrolled for small ones.
    #[inline(always)]
    fn apply<T>(&self, coefficients: &mut [T])
    where
        T: Copy + Add<Output = T> + Mul<f64, Output = T>,
    {
        match coefficients.len() {
            0 => {}
            2 => self.apply_to_columns::<T, 2>(coefficients, 1),
            3 => self.apply_to_columns::<T, 3>(coefficients, 1),
            4 => self.apply_to_columns::<T, 4>(coefficients, 1),
            length => self.steps(length - 1, |here, other, [own, others]| {
                coefficients[here] = coefficients[here] * own + coefficients[other] * others;
            }),
        }
    }

    /// Cuts the columns of a net of `N` rows, each in a copy outside the net.
    #[inline(always)]
    fn apply_to_columns<T, const N: usize>(&self, net: &mut [T], length: usize)
    where
        T: Copy + Add<Output = T> + Mul<f64, Output = T>,
    {
        let net = &mut net[..N * length];
        for j in 0..length {
            let mut column = std::array::from_fn::<T, N, _>(|i| net[i * length + j]);
            self.steps(N - 1, |here, other, [own, others]| {
                column[here] = column[here] * own + column[other] * others;
            });
            for (i, coefficient) in column.into_iter().enumerate() {
                net[i * length + j] = coefficient;
            }
        }
    }

    /// Cuts the columns of a net side by side, given the length of its rows.
    fn apply_to_long_columns<T>(&self, net: &mut [T], length: usize)
    where
        T: Copy + Add<Output = T> + Mul<f64, Output = T>,
    {
        self.steps(net.len() / length - 1, |here, other, [own, others]| {
            let range = |row: usize| row * length..(row + 1) * length;
            let Ok([here, other]) = net.get_disjoint_mut([range(here), range(other)]) else {
                return; // two rows never overlap
            };
            for (here, &other) in here.iter_mut().zip(&*other) {
                *here = *here * own + other * others;
            }
        });
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
        for degree in (1..=5).flat_map(|p| (1..=5).map(move |q| [p, q])) {
            let [p, q] = degree;
            let count = (p + 1) * (q + 1);
            let net: Vec<f64> = (0..count).map(|k| ((k * k) as f64 * 0.37).sin()).collect();
            let value = |net: &[f64], s: f64, t: f64| {
                let (bs, bt): (Basis, Basis) = (basis(p, s), basis(q, t));
                (0..count).map(|k| net[k] * bs[k / (q + 1)] * bt[k % (q + 1)]).sum::<f64>()
            };
            for (s, t) in
                [([0.2, 0.7], [0.9, 1.0]), ([-0.05, 1.05], [0.0, 0.25]), ([0.5, 0.6], [0.1, 0.9])]
            {
                let mut part = net.clone();
                restrict_net(&mut part, degree, s, t);
                for (a, b) in [(0.0, 0.0), (0.3, 0.8), (1.0, 0.5)] {
                    let whole = value(&net, s[0] + a * (s[1] - s[0]), t[0] + b * (t[1] - t[0]));
                    assert!((value(&part, a, b) - whole).abs() < 1e-14, "{degree:?}");
                }
            }
        }
    }
}
