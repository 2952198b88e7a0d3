//! The Bernstein coefficients of a leaf and of the fields derived from them, which bound its
//! tangents.

use glam::{DVec3, DVec4};

use super::tensor::euclidean;
use crate::geometry::RectSide;
use crate::math::Interval;
use crate::math::bernstein::binomials;
use crate::patch::{BezierNet, mapped};

/// The homogeneous control net over a leaf's widened rectangle.
#[derive(Clone, Copy, Debug)]
pub(in crate::patch) struct Net<'a> {
    pub(in crate::patch) degree: [usize; 2],
    pub(in crate::patch) control: &'a [DVec4],
    /// The error bound of a control point, in scene units.
    pub(in crate::patch) noise: f64,
    /// Whether the weights differ.
    pub(in crate::patch) rational: bool,
    /// The rounding error of the parameters, as fractions of the net's sides.
    pub(in crate::patch) spacing: [f64; 2],
}

impl Net<'_> {
    pub(in crate::patch) fn middle(&self) -> DVec3 {
        euclidean(self.control[self.control.len() / 2])
    }

    /// The coefficients `(w (P − c), w)`.
    #[inline(always)]
    pub(in crate::patch) fn recentered(&self, center: DVec3) -> Field {
        let values = mapped(self.control, |c| (c.truncate() - c.w * center).extend(c.w));
        Field { degree: self.degree, values }
    }

    /// The net turned so that the collapsed side becomes `t = 0`.
    pub(in crate::patch) fn with_collapsed_first(&self, side: RectSide) -> ([usize; 2], BezierNet) {
        let [p, q] = self.degree;
        let at = |i: usize, j: usize| self.control[i * (q + 1) + j];
        let turned = |rows: usize, columns: usize, pick: &dyn Fn(usize, usize) -> DVec4| {
            (0..=rows)
                .flat_map(|i| (0..=columns).map(move |j| (i, j)))
                .map(|(i, j)| pick(i, j))
                .collect()
        };
        match side {
            RectSide::FirstV => ([p, q], self.control.into()),
            RectSide::LastV => ([p, q], turned(p, q, &|i, j| at(i, q - j))),
            RectSide::FirstU => ([q, p], turned(q, p, &|i, j| at(j, i))),
            RectSide::LastU => ([q, p], turned(q, p, &|i, j| at(p - j, i))),
        }
    }
}

/// Bernstein coefficients of three components and a weight on a rectangle.
pub(in crate::patch) struct Field {
    pub(in crate::patch) degree: [usize; 2],
    pub(in crate::patch) values: BezierNet,
}

impl Field {
    pub(in crate::patch) fn derivative_s(&self) -> Self {
        let [p, q] = self.degree;
        let mut values = BezierNet::from_slice(&self.values[q + 1..]);
        for (after, here) in values.iter_mut().zip(&self.values) {
            *after = (*after - *here) * p as f64;
        }
        Self { degree: [p - 1, q], values }
    }

    pub(in crate::patch) fn derivative_t(&self) -> Self {
        let [p, q] = self.degree;
        let mut values = BezierNet::from_elem(DVec4::ZERO, (p + 1) * q);
        for (to, row) in values.chunks_exact_mut(q).zip(self.values.chunks_exact(q + 1)) {
            for j in 0..q {
                to[j] = (row[j + 1] - row[j]) * q as f64;
            }
        }
        Self { degree: [p, q - 1], values }
    }

    /// The quotient by `t`; the first coefficient of each row is taken for zero.
    pub(in crate::patch) fn over_t(&self) -> Self {
        let [p, q] = self.degree;
        let pairs = (0..=p).flat_map(|i| (0..q).map(move |j| (i, j)));
        let factor = |j: usize| q as f64 / (j + 1) as f64;
        let values = pairs.map(|(i, j)| self.values[i * (q + 1) + j + 1] * factor(j));
        Self { degree: [p, q - 1], values: values.collect() }
    }

    /// `W² S_s`, or `W² S_t`, in Bernstein form: `W X_s − X W_s`, where the highest powers cancel.
    ///
    /// For `bᵢ = C(p, i) sⁱ (1 − s)ᵖ⁻ⁱ`,
    /// `bᵢ bⱼ′ − bⱼ bᵢ′ = C(p, i) C(p, j) (j − i) sⁱ⁺ʲ⁻¹ (1 − s)²ᵖ⁻ⁱ⁻ʲ⁻¹`.
    pub(in crate::patch) fn quotients_slope(&self, which: usize) -> Self {
        let mut degree = self.degree;
        let (p, q) = (degree[which], degree[1 - which]);
        let at = |i: usize, k: usize| {
            self.values[if which == 0 { i * (q + 1) + k } else { k * (p + 1) + i }]
        };
        let (along, across) = (binomials(p), binomials(q));
        let columns = 2 * q + 1;
        let mut values = BezierNet::from_elem(DVec4::ZERO, (2 * p - 1) * columns);
        for i in 0..p {
            for j in i + 1..=p {
                let times = (j - i) as f64 * along[i] * along[j];
                let row = &mut values[(i + j - 1) * columns..(i + j) * columns];
                for k in 0..=q {
                    let here = times * across[k] * at(i, k);
                    for l in 0..=q {
                        let there = across[l] * at(j, l);
                        row[k + l] += here.w * there - there.w * here;
                    }
                }
            }
        }
        let (along, across) = (binomials(2 * p - 2), binomials(2 * q));
        for (k, row) in values.chunks_exact_mut(columns).enumerate() {
            for (value, across) in row.iter_mut().zip(across) {
                *value *= 1.0 / (along[k] * across);
            }
        }
        // The coefficients may be stored transposed: only their ranges are used.
        (degree[which], degree[1 - which]) = (2 * p - 2, 2 * q);
        Self { degree, values }
    }

    /// The points less the centre.
    pub(in crate::patch) fn offsets(&self) -> Self {
        let values = mapped(&self.values, |x| (x.truncate() / x.w).extend(1.0));
        Self { degree: self.degree, values }
    }

    pub(in crate::patch) fn weights(&self) -> Interval {
        Interval::hull(self.values.iter().map(|value| value.w))
    }

    /// The range of the component along a direction.
    pub(in crate::patch) fn component(&self, direction: DVec3) -> Interval {
        Interval::hull(self.values.iter().map(|value| direction.dot(value.truncate())))
    }

    pub(in crate::patch) fn length(&self) -> f64 {
        self.values.iter().map(|value| value.truncate().length_squared()).fold(0.0, f64::max).sqrt()
    }
}
