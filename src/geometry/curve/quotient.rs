//! Derivatives of any order of quotients of polynomials.

use std::collections::VecDeque;
use std::ops::{Div, Mul, Sub};

/// Derivative `order` of `C = A / w` where `A` and `w` are polynomials, from their derivatives of
/// order 0 to the degree, as many of one as of the other. By the product rule for `w C = A`:
///
/// `C⁽ᵏ⁾ = (A⁽ᵏ⁾ − Σⱼ (k over j) w⁽ʲ⁾ C⁽ᵏ⁻ʲ⁾) / w`, j from 1 to k, and at most the degree
///
/// (Piegl & Tiller 1997, eq. 4.8). Not finite where one of the orders on the way is beyond f64.
pub(super) fn derivative<V>(order: usize, numerator: &[V], weight: &[f64]) -> V
where
    V: Copy + Default + PartialEq + Sub<Output = V> + Mul<f64, Output = V> + Div<f64, Output = V>,
{
    let degree = weight.len() - 1;
    // The last derivatives found, the newest first.
    let mut found = VecDeque::with_capacity(degree + 1);
    for k in 0..order {
        let value = next(k, numerator, weight, &found);
        let is_finite = value * 0.0 == V::default();
        found.push_front(value);
        found.truncate(degree.max(1));
        let all_others_vanish = k >= degree && found.iter().all(|&value| value == V::default());
        if !is_finite || all_others_vanish {
            return value;
        }
    }
    next(order, numerator, weight, &found)
}

/// Derivative k from those before it.
fn next<V>(k: usize, numerator: &[V], weight: &[f64], found: &VecDeque<V>) -> V
where
    V: Copy + Default + Sub<Output = V> + Mul<f64, Output = V> + Div<f64, Output = V>,
{
    let mut rest = numerator.get(k).copied().unwrap_or_default();
    let mut choose = 1.0;
    for (j, (&slope, &before)) in (1..).zip(weight[1..].iter().zip(found)) {
        choose *= (k - j + 1) as f64 / j as f64;
        rest = rest - before * (choose * slope);
    }
    rest / weight[0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 1 / (1 + t) has the derivatives (−1)ᵏ k! at 0, and 1 / (100 + t) those over 100ᵏ⁺¹.
    #[test]
    fn derivatives_of_any_order() {
        let mut factorial = 1.0;
        for k in 0..170 {
            let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
            assert_eq!(derivative(k, &[1.0, 0.0], &[1.0, 1.0]), sign * factorial);
            factorial *= (k + 1) as f64;
        }
        assert!(!derivative(usize::MAX, &[1.0, 0.0], &[1.0, 1.0]).is_finite());
        // 300! / 100³⁰¹
        let ratio: f64 = (1..=300).map(|k| f64::from(k) / 100.0).product();
        let found = derivative(300, &[1.0, 0.0], &[100.0, 1.0]);
        assert!((found / (ratio / 100.0) - 1.0).abs() < 1e-12);
    }

    #[test]
    fn polynomials_have_no_derivatives_beyond_their_degree() {
        for (order, expected) in [(0, 3.0), (1, 2.0), (2, 4.0), (3, 0.0), (usize::MAX, 0.0)] {
            assert_eq!(derivative(order, &[6.0, 4.0, 8.0], &[2.0, 0.0, 0.0]), expected);
        }
        assert_eq!(derivative(usize::MAX, &[6.0], &[2.0]), 0.0);
    }
}
