//! All real roots of a polynomial, to 30 digits.

use crate::double::Double;

/// `c₀ + c₁ x + c₂ x² + …`.
#[derive(Clone, Debug)]
pub(crate) struct Polynomial(pub(crate) Vec<Double>);

impl Polynomial {
    pub(crate) fn at(&self, x: Double) -> Double {
        self.0.iter().rev().fold(Double::ZERO, |sum, &c| sum * x + c)
    }

    pub(crate) fn derivative(&self) -> Self {
        Self((1..self.0.len()).map(|k| self.0[k] * k as f64).collect())
    }

    pub(crate) fn times(&self, other: &Self) -> Self {
        let mut product = vec![Double::ZERO; self.0.len() + other.0.len() - 1];
        for (i, &a) in self.0.iter().enumerate() {
            for (j, &b) in other.0.iter().enumerate() {
                product[i + j] = product[i + j] + a * b;
            }
        }
        Self(product)
    }

    pub(crate) fn plus(&self, other: &Self) -> Self {
        let at = |p: &Self, k: usize| p.0.get(k).copied().unwrap_or(Double::ZERO);
        Self((0..self.0.len().max(other.0.len())).map(|k| at(self, k) + at(other, k)).collect())
    }

    pub(crate) fn scaled(&self, factor: f64) -> Self {
        Self(self.0.iter().map(|&c| c * factor).collect())
    }

    /// The roots in `[−reach, reach]` where the sign changes, in order.
    ///
    /// Between two neighbouring roots of the derivative a polynomial is monotone, so it has a
    /// root there exactly if it changes its sign, and bisection finds it.
    pub(crate) fn roots(&self, reach: f64) -> Vec<Double> {
        if self.0.len() < 2 {
            return Vec::new();
        }
        let mut ends = vec![Double::from(-reach)];
        ends.extend(self.derivative().roots(reach));
        ends.push(Double::from(reach));
        ends.windows(2).filter_map(|pair| self.root_between(pair[0], pair[1])).collect()
    }

    fn root_between(&self, mut from: Double, mut to: Double) -> Option<Double> {
        let rises = self.at(to).round() > 0.0;
        if (self.at(from).round() > 0.0) == rises {
            return None;
        }
        // 110 halvings take any interval to the last of 32 digits.
        for _ in 0..110 {
            let middle = (from + to) * 0.5;
            if (self.at(middle).round() > 0.0) == rises {
                to = middle;
            } else {
                from = middle;
            }
        }
        Some((from + to) * 0.5)
    }
}

#[test]
fn finds_planted_roots() {
    // (x − 0.1)(x − 0.1 − 1e-12)(x² + 1)(x + 2)
    let linear = |root: Double| Polynomial(vec![-root, Double::from(1.0)]);
    let near = Double::from(0.1) + Double::from(1e-12);
    let circle = Polynomial(vec![Double::from(1.0), Double::ZERO, Double::from(1.0)]);
    let p = linear(Double::from(0.1)).times(&linear(near)).times(&circle);
    let p = p.times(&linear(Double::from(-2.0)));
    let roots = p.roots(10.0);
    let expected = [Double::from(-2.0), Double::from(0.1), near];
    assert_eq!(roots.len(), 3);
    for (root, expected) in roots.iter().zip(expected) {
        assert!((*root - expected).abs().round() < 1e-18, "{root:?}");
    }
}
