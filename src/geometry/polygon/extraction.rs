//! Bézier extraction (Borden, Scott, Evans and Hughes 2011): the Bézier points of one span,
//! directly from the control points that govern the span.

use glam::{BVec4, DVec4};

use super::mix_by;
use super::shares as of_both;
use crate::geometry::KnotVector;

/// For every span of a clamped spline, how its Bézier points follow from the control points. The
/// index of a span is that of the first control point that governs it.
#[derive(Debug)]
pub(crate) enum Extractions {
    /// For degree 3 or less.
    Steps(Vec<Steps>),
    /// For higher degrees: operators (matrices) of `(p + 1)²` numbers each.
    Operators {
        /// The degree.
        degree: usize,
        /// The operators row by row. A row belongs to a Bézier point and holds the share of each
        /// control point in it.
        shares: Vec<f64>,
    },
}

/// How the Bézier points of one span follow from the control points: one item of [`Extractions`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum Extraction<'a> {
    /// For degree 3 or less.
    Steps(&'a Steps),
    /// For higher degrees.
    Operator(&'a [f64]),
}

impl Extractions {
    /// The highest degree supported.
    pub(crate) const MOST_DEGREE: usize = 7;

    /// The largest number of control points that govern a span.
    pub(crate) const MOST_POINTS: usize = Self::MOST_DEGREE + 1;

    /// The memory of each span, as a number of f64 values.
    pub(crate) fn numbers_a_span(degree: usize) -> usize {
        if degree <= Steps::MOST_DEGREE {
            size_of::<Steps>() / size_of::<f64>()
        } else {
            (degree + 1) * (degree + 1)
        }
    }

    /// The extractions of all spans of a clamped knot vector.
    pub(crate) fn of(knots: &KnotVector) -> Self {
        let degree = knots.degree();
        let count = knots.point_count();
        if degree <= Steps::MOST_DEGREE {
            let mut steps = vec![Steps::default(); count];
            for span in knots.spans() {
                steps[span.index - degree] = Steps::of(knots, span.index);
            }
            return Self::Steps(steps);
        }
        let size = Self::numbers_a_span(degree);
        let mut shares = vec![0.0; size * count];
        let mut before = None;
        for span in knots.spans() {
            let first = span.index - degree;
            let (done, rest) = shares.split_at_mut(size * first);
            let own = &mut rest[..size];
            fill_operator(knots, span.index, own);
            // Neighbouring spans share the point between them, by the same operations on the same
            // points. The knot there is repeated as often as there are control points that govern
            // only the span before.
            if let Some(before) = before.filter(|before| before + degree >= first) {
                let last_row: &[f64] = &done[size * (before + 1) - (degree + 1)..][..degree + 1];
                let (common, others) = own[..degree + 1].split_at_mut(before + degree + 1 - first);
                common.copy_from_slice(&last_row[first - before..]);
                others.fill(0.0);
            }
            before = Some(first);
        }
        Self::Operators { degree, shares }
    }

    /// The extraction of the span whose first control point is `first`.
    #[inline(always)]
    pub(crate) fn at(&self, first: usize) -> Extraction<'_> {
        match self {
            Self::Steps(steps) => Extraction::Steps(&steps[first]),
            Self::Operators { degree, shares } => {
                let size = (degree + 1) * (degree + 1);
                Extraction::Operator(&shares[size * first..][..size])
            }
        }
    }

    /// The memory held, in bytes.
    pub(crate) fn bytes(&self) -> usize {
        size_of::<Self>()
            + match self {
                Self::Steps(steps) => size_of_val(&steps[..]),
                Self::Operators { shares, .. } => size_of_val(&shares[..]),
            }
    }
}

/// Fills in the operator of span `index`. Bézier points are values of the span's polar form
/// (Ramshaw 1989), with its start as some arguments and its end as the others. De Boor's scheme
/// computes these values from the control points by convex combinations.
fn fill_operator(knots: &KnotVector, index: usize, operator: &mut [f64]) {
    const MOST: usize = Extractions::MOST_POINTS;
    let (p, values) = (knots.degree(), knots.values());
    let span = [values[index], values[index + 1]];
    for (k, row) in operator.chunks_exact_mut(p + 1).enumerate() {
        let mut shares = [[0.0; MOST]; MOST];
        for (j, own) in shares.iter_mut().enumerate() {
            own[j] = 1.0;
        }
        for level in 1..=p {
            let argument = span[usize::from(level > p - k)];
            for j in (level..=p).rev() {
                let (left, right) = (values[index - p + j], values[index + 1 + j - level]);
                let [beta, alpha] = of_both(argument, left, right);
                let before = shares[j - 1];
                for (share, before) in shares[j].iter_mut().zip(before) {
                    *share = beta * before + alpha * *share;
                }
            }
        }
        row.copy_from_slice(&shares[p][..=p]);
    }
}

impl Extraction<'_> {
    /// Replaces control points by Bézier points, in place: every `step`-th of `points`, from the
    /// first on.
    pub(crate) fn apply(&self, degree: usize, points: &mut [DVec4], step: usize) {
        let mut from = [DVec4::ZERO; Extractions::MOST_POINTS];
        for (k, point) in from[..=degree].iter_mut().enumerate() {
            *point = points[k * step];
        }
        match self {
            Self::Steps(steps) => {
                let [a, b, c, d, ..] = from;
                let made = steps.apply(degree, [a, b, c, d]);
                for (k, &point) in made[..=degree].iter().enumerate() {
                    points[k * step] = point;
                }
            }
            Self::Operator(operator) => {
                for (k, shares) in operator.chunks_exact(degree + 1).enumerate() {
                    points[k * step] = mixed(&from[..=degree], shares);
                }
            }
        }
    }

    /// The share of control point `j` in each Bézier point.
    pub(crate) fn shares_of(&self, degree: usize, j: usize) -> [f64; Extractions::MOST_POINTS] {
        let mut shares = [0.0; Extractions::MOST_POINTS];
        match self {
            Self::Steps(steps) => {
                for (share, of) in shares.iter_mut().zip(steps.apply(degree, DVec4::AXES)) {
                    *share = of[j];
                }
            }
            Self::Operator(operator) => {
                for (share, row) in shares.iter_mut().zip(operator.chunks_exact(degree + 1)) {
                    *share = row[j];
                }
            }
        }
        shares
    }
}

/// A convex combination; coordinates that are equal in all points with a nonzero share are kept as
/// they are.
fn mixed(points: &[DVec4], shares: &[f64]) -> DVec4 {
    let mut sum = DVec4::ZERO;
    let (mut one, mut alike) = (None, BVec4::TRUE);
    for (&point, &share) in points.iter().zip(shares) {
        if share != 0.0 {
            sum += share * point;
            alike &= point.cmpeq(*one.get_or_insert(point));
        }
    }
    DVec4::select(alike, one.unwrap_or(sum), sum)
}

/// How the Bézier points of a span follow from the `p + 1` control points that govern it, in a
/// spline of degree 3 or less.
///
/// This is not a matrix but the steps of knot insertion: every point is computed from the same
/// numbers by the same operations as if all knots of the clamped spline were inserted from left to
/// right, as [`Insertions`](super::Insertions) does. So it is the same to the last bit,
/// except for the sign of zeros, and neighbouring spans share the point between them.
///
/// With the polar form `f` of a cubic (Ramshaw 1989) and the knots `t₋₁ ≤ t₀ ≤ t₁ < t₂ ≤ t₃ ≤ t₄`
/// about its span `t₁ … t₂`, the control points are `f(t₋₁,t₀,t₁)`, `f(t₀,t₁,t₂)`, `f(t₁,t₂,t₃)`
/// and `f(t₂,t₃,t₄)`. Each step mixes two points that differ in one argument, `a` and `b`, into the
/// one with the argument `t` there, by `α = (t − a) / (b − a)`. Where a knot is repeated already, α
/// is 0 or 1.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Steps {
    /// `1 − α` and `α` for `t = t₀` between `t₋₁` and `t₂`; `t₁` between `t₀` and `t₂`; `t₁`
    /// between `t₀` and `t₃`; `t₂` between `t₁` and `t₃`; `t₂` between `t₁` and `t₄`. Lower degrees
    /// need fewer.
    by: [[f64; 2]; 5],
}

impl Steps {
    /// The highest degree for which steps are used.
    const MOST_DEGREE: usize = 3;

    /// The steps of the span that begins at knot `index` of a clamped knot vector.
    fn of(knots: &KnotVector, index: usize) -> Self {
        // For lower degrees a clamped vector may end sooner; the steps made from other knots are
        // then not used.
        let values = knots.values();
        let knot = |k: isize| values[index.saturating_add_signed(k).min(values.len() - 1)];
        let [before, t0, t1, t2, t3, t4] = [-2, -1, 0, 1, 2, 3].map(knot);
        let by = [(t0, before, t2), (t1, t0, t2), (t1, t0, t3), (t2, t1, t3), (t2, t1, t4)];
        Self { by: by.map(|(t, left, right)| of_both(t, left, right)) }
    }

    /// The Bézier points, computed from the control points; only the first `p + 1` of either count.
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
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::polygon::refine;

    /// Knot vectors with knots of every multiplicity, far apart and close together, and control
    /// points with and without equal coordinates.
    fn splines() -> impl Strategy<Value = (KnotVector, Vec<DVec4>)> {
        let knots = (1usize..=Extractions::MOST_DEGREE).prop_flat_map(|p| {
            let step = (-4.0..1.0f64).prop_map(|log: f64| 10f64.powf(log));
            let inner = prop::collection::vec((1..=p + 1, step), 0..7);
            (Just(p), inner, any::<bool>())
        });
        knots.prop_flat_map(|(p, inner, same_weight)| {
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
            let knots = KnotVector::new(p, values);
            let points = points.prop_map(move |points| {
                let point = |(x, y, z, w)| DVec4::new(x, y, z, if same_weight { 1.75 } else { w });
                points.into_iter().map(point).collect()
            });
            (Just(knots).prop_filter_map("knots rounded to one", Result::ok), points)
        })
    }

    proptest! {
        #[test]
        fn points_are_those_of_knot_insertion((knots, points) in splines()) {
            let p = knots.degree();
            let missing = knots.missing_for_bezier();
            let all = refine(&knots, &points, &missing);
            let extractions = Extractions::of(&knots);
            let (mut first, mut end) = (0, None);
            for span in knots.spans() {
                // Where the spline may jump, the next span has a point of its own.
                let jumps = span.index > p && knots.multiplicity(span.start) > p;
                first += usize::from(jumps);
                let mut made = points[span.index - p..=span.index].to_vec();
                extractions.at(span.index - p).apply(p, &mut made, 1);
                let truth = &all[first..=first + p];
                if p <= 3 {
                    prop_assert_eq!(&made[..], truth, "the span at {}", span.start);
                } else {
                    for (made, truth) in made.iter().zip(truth) {
                        let off = (*made - *truth).abs().max_element();
                        prop_assert!(off < 3e-14, "{:e} in the span at {}", off, span.start);
                    }
                    // Neighbours share the point between them, to the last bit.
                    let start = made[0];
                    prop_assert!(end.is_none_or(|end| jumps || end == start));
                }
                // What is equal in all points stays as it is.
                let same_weight = points.iter().all(|point| point.w == points[0].w);
                prop_assert!(!same_weight || made.iter().all(|point| point.w == points[0].w));
                end = Some(made[p]);
                first += p;
            }
            prop_assert_eq!(first + 1, all.len());
        }
    }
}
