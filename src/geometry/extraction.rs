//! Bézier points of one span, straight from the control points that govern it.

use glam::DVec4;

use super::KnotVector;
use super::line::mix_by;

/// How the Bézier points of a span come from the `p + 1` control points of a spline of degree 3 or
/// less that govern it.
///
/// Bézier extraction (Borden, Scott, Evans and Hughes 2011), not by a matrix but by the steps of knot
/// insertion: every point comes from the same numbers by the same operations as if all knots of the
/// clamped spline were inserted from left to right, as [`Insertions`](super::line::Insertions) does. So
/// it is the same to the last bit, but for the sign of zeros, and neighbouring spans share the point
/// between them.
///
/// With the polar form `f` of a cubic (Ramshaw 1989) and the knots `t₋₁ ≤ t₀ ≤ t₁ < t₂ ≤ t₃ ≤ t₄` about
/// its span `t₁ … t₂`, the control points are `f(t₋₁,t₀,t₁)`, `f(t₀,t₁,t₂)`, `f(t₁,t₂,t₃)` and
/// `f(t₂,t₃,t₄)`. Each step mixes two points that differ in one argument, `a` and `b`, to one that has
/// `t` there, by `α = (t − a) / (b − a)`. Where a knot is repeated already, α is 0 or 1.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Extraction {
    /// `1 − α` and `α` for `t = t₀` between `t₋₁` and `t₂`; `t₁` between `t₀` and `t₂`; `t₁` between
    /// `t₀` and `t₃`; `t₂` between `t₁` and `t₃`; `t₂` between `t₁` and `t₄`. Lower degrees need fewer.
    by: [[f64; 2]; 5],
}

impl Extraction {
    /// The highest degree.
    pub(crate) const MOST_DEGREE: usize = 3;

    /// The most control points of a span.
    pub(crate) const MOST_POINTS: usize = Self::MOST_DEGREE + 1;

    /// That of the span that begins with the knot of an index, in a clamped knot vector.
    pub(crate) fn of(knots: &KnotVector, index: usize) -> Self {
        // Of lower degrees a clamped vector may end sooner; what is made of other knots then has no use.
        let values = knots.values();
        let knot = |k: isize| values[index.saturating_add_signed(k).min(values.len() - 1)];
        let [before, t0, t1, t2, t3, t4] = [-2, -1, 0, 1, 2, 3].map(knot);
        let by = |t: f64, from: f64, to: f64| {
            let alpha = (t - from) / (to - from);
            [1.0 - alpha, alpha]
        };
        let by =
            [by(t0, before, t2), by(t1, t0, t2), by(t1, t0, t3), by(t2, t1, t3), by(t2, t1, t4)];
        Self { by }
    }

    /// The Bézier points, from the control points; only `p + 1` of either count.
    #[inline(always)] // degrees known in advance need no branches
    pub(crate) fn apply(&self, degree: usize, [a, b, c, d]: [DVec4; 4]) -> [DVec4; 4] {
        let [first, near, left, right, last] = self.by;
        match degree {
            3 => {
                // f(t₀,t₀,t₁) and f(t₀,t₁,t₁) of the span before, f(t₁,t₁,t₂), f(t₁,t₂,t₂), and
                // f(t₂,t₂,t₃) of the span behind.
                let before = mix_by(mix_by(a, b, first), b, near);
                let second = mix_by(b, c, left);
                let third = mix_by(second, c, right);
                let behind = mix_by(c, d, last);
                [mix_by(before, second, near), second, third, mix_by(third, behind, right)]
            }
            2 => [mix_by(a, b, near), b, mix_by(b, c, right), d],
            _ => [a, b, c, d],
        }
    }

    /// How much of each control point there is in each Bézier point, by the latter.
    pub(crate) fn shares(&self, degree: usize) -> [DVec4; 4] {
        self.apply(degree, DVec4::AXES)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::line::refine;

    /// Knot vectors with knots of every multiplicity, and control points with and without equal
    /// coordinates.
    fn splines() -> impl Strategy<Value = (KnotVector, Vec<DVec4>)> {
        let knots = (1usize..=3).prop_flat_map(|p| {
            let inner = prop::collection::vec((1..=p + 1, 0.01..2.0f64), 0..7);
            (Just(p), inner)
        });
        knots.prop_flat_map(|(p, inner)| {
            let mut values = vec![-1.0; p + 1];
            let mut t = -1.0;
            for (times, step) in inner {
                t += step;
                values.extend(std::iter::repeat_n(t, times));
            }
            values.extend(std::iter::repeat_n(t + 0.7, p + 1));
            let count = values.len() - p - 1;
            let coordinate = || prop_oneof![Just(0.25), -3.0..3.0f64];
            let point = (coordinate(), coordinate(), coordinate(), 0.1..4.0f64);
            let points = prop::collection::vec(point, count);
            (Just(KnotVector::new(p, values).unwrap()), points).prop_map(|(knots, points)| {
                let points = points.into_iter().map(|(x, y, z, w)| DVec4::new(x, y, z, w));
                (knots, points.collect())
            })
        })
    }

    proptest! {
        #[test]
        fn points_are_those_of_knot_insertion((knots, points) in splines()) {
            let p = knots.degree();
            let missing = knots.missing_for_bezier();
            let all = refine(&knots, &points, &missing);
            let mut first = 0;
            for span in knots.spans() {
                // Where the spline may jump, the next span has a point of its own.
                if span.index > p && knots.multiplicity(span.start) > p {
                    first += 1;
                }
                let mut own = [DVec4::ZERO; 4];
                own[..=p].copy_from_slice(&points[span.index - p..=span.index]);
                let made = Extraction::of(&knots, span.index).apply(p, own);
                prop_assert_eq!(&made[..=p], &all[first..=first + p], "the span at {}", span.start);
                first += p;
            }
            prop_assert_eq!(first + 1, all.len());
        }
    }
}
