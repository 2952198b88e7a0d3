//! Parameter boxes: a part of a leaf's domain with the surface's net over it, as the ray
//! sees it.

use glam::{DMat2, DVec2, DVec4};

use crate::math::Interval;
use crate::math::bernstein::{self, Basis};
use crate::patch::StRect;

/// The net of a piece over a rectangle in ray coordinates: `(w x, w y, w z, w)` with `x`
/// and `y` the distances from the ray's two planes. The ray meets the surface where the
/// polynomials `w x` and `w y` vanish together (Kajiya 1982; Nishita et al. 1990).
#[derive(Debug, Default)]
pub(super) struct RayNet {
    pub(super) degree: [usize; 2],
    pub(super) control: Vec<DVec4>,
}

/// Bernstein bounds of a net.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) x: Interval,
    pub(super) y: Interval,
    pub(super) z: Interval,
}

impl RayNet {
    /// Becomes the net of `whole` over `rect`, which is given in the domain of `whole`.
    pub(super) fn restrict_from(&mut self, whole: &Self, rect: StRect) {
        self.degree = whole.degree;
        self.control.clear();
        self.control.extend_from_slice(&whole.control);
        bernstein::restrict_net(&mut self.control, self.degree, rect[0], rect[1]);
    }

    /// The ranges of `w x` and `w y`, and that of `z` itself: hulls of coefficients.
    pub(super) fn bounds(&self) -> Bounds {
        let mut bounds = Bounds { x: Interval::EMPTY, y: Interval::EMPTY, z: Interval::EMPTY };
        for c in &self.control {
            bounds.x = bounds.x.with(c.x);
            bounds.y = bounds.y.with(c.y);
            bounds.z = bounds.z.with(c.z / c.w);
        }
        // The slack may reach where weights are no longer positive: then z is unknown.
        if !self.control.iter().all(|c| c.w > 0.0) {
            bounds.z = Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY };
        }
        bounds
    }

    /// A bound of the extent of the image along each parameter: the longest step between
    /// neighbouring control points, times the degree.
    pub(super) fn spread(&self) -> DVec2 {
        let [p, q] = self.degree;
        let at = |i: usize, j: usize| self.control[i * (q + 1) + j].truncate();
        let mut spread = DVec2::ZERO;
        for i in 0..=p {
            for j in 0..=q {
                if i < p {
                    spread.x = spread.x.max((at(i + 1, j) - at(i, j)).length() * p as f64);
                }
                if j < q {
                    spread.y = spread.y.max((at(i, j + 1) - at(i, j)).length() * q as f64);
                }
            }
        }
        spread
    }

    /// The mean Jacobian of `(w x, w y)` over the box; columns are derivatives by the two
    /// parameters, in units of the box's sides.
    pub(super) fn mean_jacobian(&self) -> DMat2 {
        let [p, q] = self.degree;
        let at = |i: usize, j: usize| {
            let c = self.control[i * (q + 1) + j];
            DVec2::new(c.x, c.y)
        };
        let along_s: DVec2 = (0..=q).map(|j| at(p, j) - at(0, j)).sum();
        let along_t: DVec2 = (0..=p).map(|i| at(i, q) - at(i, 0)).sum();
        DMat2::from_cols(along_s / (q + 1) as f64, along_t / (p + 1) as f64)
    }
}

/// The pair of polynomials `g = A · (w x, w y)` with the fixed matrix `A`, near the
/// identity map when `A` is the inverse of the mean Jacobian.
#[derive(Debug, Default)]
pub(super) struct Preconditioned {
    degree: [usize; 2],
    values: Vec<DVec2>,
}

impl Preconditioned {
    pub(super) fn assign(&mut self, net: &RayNet, matrix: DMat2) {
        self.degree = net.degree;
        self.values.clear();
        self.values.extend(net.control.iter().map(|c| matrix * DVec2::new(c.x, c.y)));
    }

    /// The ranges of both polynomials.
    pub(super) fn ranges(&self) -> [Interval; 2] {
        [0, 1].map(|k| Interval::hull(self.values.iter().map(|value| value[k])))
    }

    /// Bounds of `|1 − ∂g₁/∂s| + |∂g₁/∂t|` and `|∂g₂/∂s| + |1 − ∂g₂/∂t|` over the box, from
    /// the Bernstein coefficients of the derivatives. Where both are below 1 the map
    /// `x − g(x)` contracts, so `g` has at most one root in the box.
    pub(super) fn contraction(&self) -> DVec2 {
        let [p, q] = self.degree;
        let mut slopes = [[Interval::EMPTY; 2]; 2];
        for i in 0..=p {
            for j in 0..=q {
                let here = self.values[i * (q + 1) + j];
                if i < p {
                    let step = (self.values[(i + 1) * (q + 1) + j] - here) * p as f64;
                    slopes[0][0] = slopes[0][0].with(step.x);
                    slopes[1][0] = slopes[1][0].with(step.y);
                }
                if j < q {
                    let step = (self.values[i * (q + 1) + j + 1] - here) * q as f64;
                    slopes[0][1] = slopes[0][1].with(step.x);
                    slopes[1][1] = slopes[1][1].with(step.y);
                }
            }
        }
        let away_from_one = |slope: Interval| (slope.lo - 1.0).abs().max((slope.hi - 1.0).abs());
        DVec2::new(
            away_from_one(slopes[0][0]) + slopes[0][1].magnitude(),
            slopes[1][0].magnitude() + away_from_one(slopes[1][1]),
        )
    }

    /// `g` at the middle of the box.
    pub(super) fn middle(&self) -> DVec2 {
        let [p, q] = self.degree;
        let (bs, bt): (Basis, Basis) = (bernstein::basis(p, 0.5), bernstein::basis(q, 0.5));
        let rows = self.values.chunks_exact(q + 1).zip(&bs);
        rows.map(|(row, &b)| b * row.iter().zip(&bt).map(|(&g, &b)| b * g).sum::<DVec2>()).sum()
    }

    /// The part of `[0, 1]` in direction `axis` outside which component `component` is
    /// proved to differ from zero by more than `error`; `None` if that is proved for all of it.
    ///
    /// A polynomial lies in the convex hull of its Bernstein coefficients over `i / p`
    /// (Bézier clipping: Sederberg & Nishita 1990); of each row of coefficients only the
    /// smallest and the largest count.
    pub(super) fn clip(&self, component: usize, axis: usize, error: f64) -> Option<[f64; 2]> {
        let [p, q] = self.degree;
        let degree = self.degree[axis];
        let (others, step, other_step) = if axis == 0 { (q, q + 1, 1) } else { (p, 1, q + 1) };
        let mut low = [0.0; bernstein::MAX_DEGREE + 1];
        let mut high = low;
        for i in 0..=degree {
            let column = (0..=others).map(|k| self.values[i * step + k * other_step][component]);
            let range = Interval::hull(column);
            (low[i], high[i]) = (range.lo - error, range.hi + error);
        }
        clip_hull(&low[..=degree], &high[..=degree])
    }
}

/// The range where the hull of the points `(i / p, low_i)` and `(i / p, high_i)` meets zero.
///
/// It begins at 0 if the first column holds zero; else, with the first column above zero,
/// where the hull's lower border comes down to zero. That border runs through some of the
/// points `(i / p, low_i)`, and joins one above zero to one below; every other such segment
/// lies inside the hull. So the beginning is the least over all pairs: quadratic in the degree,
/// but simple and without special cases. With the first column below zero it is where the
/// upper border comes up to zero. The end is the beginning seen from the other side.
fn clip_hull(low: &[f64], high: &[f64]) -> Option<[f64; 2]> {
    let last = low.len() - 1;
    let begin = first_zero(|i| (low[i], high[i]), last)?;
    let end = last as f64 - first_zero(|i| (low[last - i], high[last - i]), last)?;
    // Rounding may swap the ends where they are a single point.
    Some([begin.min(end) / last as f64, end.max(begin) / last as f64])
}

/// The least abscissa at which the hull of columns `0 … last` meets zero.
#[inline(always)]
fn first_zero(column: impl Fn(usize) -> (f64, f64), last: usize) -> Option<f64> {
    let (low, high) = column(0);
    if low <= 0.0 && high >= 0.0 {
        return Some(0.0);
    }
    // Mirrored where the first column is below zero: then only lower ends count.
    let height = |i: usize| if low > 0.0 { column(i).0 } else { -column(i).1 };
    let mut first = f64::INFINITY;
    for j in 1..=last {
        let below = height(j);
        if below > 0.0 {
            continue;
        }
        for i in 0..j {
            let above = height(i);
            if above > 0.0 {
                first = first.min(i as f64 + (j - i) as f64 * (above / (above - below)));
            }
        }
    }
    (first < f64::INFINITY).then_some(first)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clipping_keeps_the_roots() {
        // x − 0.3 as a cubic: its coefficients lie on the line, so the clip is exact.
        let line: Vec<f64> = (0..4).map(|i| f64::from(i) / 3.0 - 0.3).collect();
        let [a, b] = clip_hull(&line, &line).unwrap();
        assert!((a - 0.3).abs() < 1e-15 && (b - 0.3).abs() < 1e-15);
        assert_eq!(clip_hull(&[1.0, 2.0], &[1.5, 2.5]), None);
        assert_eq!(clip_hull(&[-1.0, 2.0, -1.0], &[-1.0, 2.0, -1.0]), Some([1.0 / 6.0, 5.0 / 6.0]));
    }

    #[test]
    fn an_affine_map_contracts_completely() {
        let control = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)];
        let control = control.map(|(s, t)| DVec4::new(2.0 * s + t, s - t, 0.0, 1.0)).to_vec();
        let net = RayNet { degree: [1, 1], control };
        let inverse = net.mean_jacobian().inverse();
        let mut g = Preconditioned::default();
        g.assign(&net, inverse);
        assert!(g.contraction().max_element() < 1e-15);
        assert!((g.middle() - DVec2::splat(0.5)).length() < 1e-15);
    }
}
