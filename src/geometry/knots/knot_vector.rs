//! Knot vectors: the parameter values at which the pieces of a spline meet.

use super::KnotError;
use crate::geometry::{MAX_CONTROL_POINTS, MAX_DEGREE};

/// The knots of a B-spline: the parameter values at which its pieces meet.
///
/// A spline of degree `p` with `n` control points has `n + p + 1` knots `t₀ ≤ t₁ ≤ …` and
/// lives on the domain `[tₚ, tₙ]` (Piegl & Tiller 1997, ch. 2). At a knot of multiplicity
/// `m` it is `p − m` times continuously differentiable; at multiplicity `p + 1` it may
/// jump, and takes the value of the piece that begins there.
///
/// # Invariants, checked once in [`KnotVector::new`] and relied on everywhere else
/// - `1 ≤ p ≤` [`MAX_DEGREE`], `p + 1 ≤ n ≤` [`MAX_CONTROL_POINTS`];
/// - every knot is finite, none is smaller than the one before it, none occurs more than
///   `p + 1` times, and `t_last − t₀` is finite;
/// - the domain is not empty: `tₚ < tₙ`.
///
/// Clamped ends are *not* assumed: periodic and imported knots are welcome.
///
/// There are `p + 1` more knots than control points, and the domain is `[tₚ, tₙ]`, not
/// `[t₀, t_last]`, unless the ends are clamped. A knot makes a corner if it occurs `p` times, a
/// jump if `p + 1` times.
#[derive(Clone, Debug, PartialEq)]
pub struct KnotVector {
    degree: usize,
    values: Vec<f64>,
}

/// A part of the domain without knots inside: `[start, end]` with `start < end`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// The index `i` of its first knot: `start = tᵢ`, `end = tᵢ₊₁`.
    pub index: usize,
    /// Where it begins.
    pub start: f64,
    /// Where it ends.
    pub end: f64,
}

impl KnotVector {
    /// The knots `values` of a spline of this degree, multiple knots listed repeatedly.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn new(degree: usize, values: Vec<f64>) -> Result<Self, KnotError> {
        check_degree(degree)?;
        let knots = values.len();
        if knots < 2 * degree + 2 {
            return Err(KnotError::TooFewKnots { knots, degree });
        }
        check_points(degree, knots - degree - 1)?;
        check_values(degree, &values)?;
        let last = knots - degree - 1;
        let (start, end) = (values[degree], values[last]);
        if start == end {
            return Err(KnotError::EmptyDomain { start, end, degree, last });
        }
        Ok(Self { degree, values })
    }

    /// The knots `values` for a known number of control points, as a file states both.
    ///
    /// # Errors
    /// When the numbers of knots and points do not match, and as [`KnotVector::new`].
    pub fn for_points(degree: usize, values: Vec<f64>, points: usize) -> Result<Self, KnotError> {
        check_degree(degree)?;
        let count = KnotError::Count { knots: values.len(), points, degree };
        // Where the order is given for the degree, both counts are right for one less, and this says
        // so.
        if points == degree && values.len() == points + degree {
            return Err(count);
        }
        check_points(degree, points)?;
        if values.len() != points + degree + 1 {
            return Err(count);
        }
        Self::new(degree, values)
    }

    /// Knots listed once each, with the number of times they occur.
    ///
    /// # Errors
    /// As [`KnotVector::new`], and when a multiplicity is 0.
    pub fn with_multiplicities(degree: usize, knots: &[(f64, usize)]) -> Result<Self, KnotError> {
        check_degree(degree)?;
        for &(knot, times) in knots {
            if times == 0 {
                return Err(KnotError::NoMultiplicity { knot });
            }
            if times > degree + 1 {
                return Err(KnotError::Multiplicity { knot, times, degree });
            }
        }
        let values = knots.iter().flat_map(|&(knot, times)| std::iter::repeat_n(knot, times));
        Self::new(degree, values.collect())
    }

    /// The knots `0, …, 0, 1, …, 1` of a single Bézier piece.
    ///
    /// # Errors
    /// When the degree is not supported.
    pub fn bezier(degree: usize) -> Result<Self, KnotError> {
        check_degree(degree)?;
        Self::with_multiplicities(degree, &[(0.0, degree + 1), (1.0, degree + 1)])
    }

    /// Clamped knots on `[0, 1]`, evenly spaced inside.
    ///
    /// # Errors
    /// When the degree or the number of points is not supported.
    pub fn clamped_uniform(degree: usize, points: usize) -> Result<Self, KnotError> {
        let spans = Self::clamped_spans(degree, points)?;
        Self::clamped_at(degree, spans, |i| i as f64 / spans as f64)
    }

    /// The "standard knot vector" of the textbooks: clamped, `0, 1, 2, …` inside.
    ///
    /// Five points of degree 3 get `0, 0, 0, 0, 1, 2, 2, 2, 2`.
    ///
    /// # Errors
    /// When the degree or the number of points is not supported.
    pub fn standard(degree: usize, points: usize) -> Result<Self, KnotError> {
        let spans = Self::clamped_spans(degree, points)?;
        Self::clamped_at(degree, spans, |i| i as f64)
    }

    /// Unclamped knots `0, 1, 2, …`: the domain is `[p, n]`, and the spline does not reach
    /// its first and last control points.
    ///
    /// # Errors
    /// When the degree or the number of points is not supported.
    pub fn uniform(degree: usize, points: usize) -> Result<Self, KnotError> {
        check_degree(degree)?;
        check_points(degree, points)?;
        Self::new(degree, (0..points + degree + 1).map(|i| i as f64).collect())
    }

    /// The knots of a closed spline, repeated with its period.
    ///
    /// `period` lists the knots `k₀ ≤ … ≤ kₙ` of one period, for `n` different control points; the
    /// domain is `[k₀, kₙ]`. The spline has `n + p` control points: the first `p` follow again
    /// after the last. Its smoothness at the seam is that of a knot of the same multiplicity (`kₙ`
    /// is `k₀` again, and the two count once).
    ///
    /// # Errors
    /// When the degree is not supported; when there are fewer than four knots, or too many; when
    /// they are not finite numbers in order; when all are equal, or one occurs more than `p + 1`
    /// times.
    pub fn periodic(degree: usize, period: &[f64]) -> Result<Self, KnotError> {
        check_degree(degree)?;
        Self::new(degree, periodic_values(degree, period)?)
    }

    /// Knots made from valid ones by an operation that keeps the invariants.
    pub(crate) fn derived(degree: usize, values: Vec<f64>) -> Self {
        debug_assert!(Self::new(degree, values.clone()).is_ok(), "{degree}: {values:?}");
        Self { degree, values }
    }

    /// The number of spans of a clamped spline whose inner knots are simple.
    fn clamped_spans(degree: usize, points: usize) -> Result<usize, KnotError> {
        check_degree(degree)?;
        check_points(degree, points)?;
        Ok(points - degree)
    }

    fn clamped_at(
        degree: usize,
        spans: usize,
        knot: impl Fn(usize) -> f64,
    ) -> Result<Self, KnotError> {
        let mut values = vec![knot(0); degree];
        values.extend((0..=spans).map(&knot));
        values.extend(std::iter::repeat_n(knot(spans), degree));
        Self::new(degree, values)
    }

    /// The degree `p`.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All knots, in order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The number `n` of control points.
    pub fn point_count(&self) -> usize {
        self.values.len() - self.degree - 1
    }

    /// The domain `[tₚ, tₙ]`.
    pub fn domain(&self) -> [f64; 2] {
        [self.values[self.degree], self.values[self.point_count()]]
    }

    /// Index `i` of the non-empty span that holds `t`: `tᵢ ≤ t < tᵢ₊₁`, the last span closed.
    ///
    /// Parameters off the domain get its end spans, NaN the first.
    pub fn span_index(&self, t: f64) -> usize {
        let [start, end] = self.domain();
        let t = t.max(start); // `max` also turns NaN into `start`
        let inside = &self.values[self.degree + 1..self.point_count()];
        self.degree + inside.partition_point(|&knot| knot <= t && knot < end)
    }

    /// The non-empty spans of the domain, in order; there is at least one.
    pub fn spans(&self) -> impl Iterator<Item = Span> + '_ {
        self.spans_from(self.degree)
    }

    /// The non-empty spans that hold some of the parameters between two, in order.
    pub fn spans_between(&self, from: f64, to: f64) -> impl Iterator<Item = Span> + '_ {
        self.spans_from(self.span_index(from)).take_while(move |span| span.start < to)
    }

    fn spans_from(&self, first: usize) -> impl Iterator<Item = Span> + '_ {
        (first..self.point_count())
            .map(|index| Span { index, start: self.values[index], end: self.values[index + 1] })
            .filter(|span| span.start < span.end)
    }

    /// How often `t` occurs among all the knots.
    pub fn multiplicity(&self, t: f64) -> usize {
        let before = self.values.partition_point(|&knot| knot < t);
        self.values[before..].iter().take_while(|&&knot| knot == t).count()
    }

    /// Whether both ends of the domain are knots of multiplicity `p + 1` and no knots lie
    /// outside, so that the spline begins and ends at its outermost control points.
    pub fn is_clamped(&self) -> bool {
        let [start, end] = self.domain();
        self.values[0] == start && self.values[self.values.len() - 1] == end
    }

    /// The knots to insert into a clamped vector to get a spline of Bézier pieces: every knot
    /// inside the domain as often as it takes to reach multiplicity `p`, in order.
    pub fn missing_for_bezier(&self) -> Vec<f64> {
        let mut missing = Vec::new();
        for span in self.spans().skip(1) {
            let present = self.multiplicity(span.start);
            missing.extend(std::iter::repeat_n(span.start, self.degree.saturating_sub(present)));
        }
        missing
    }

    /// The knots of the same spline run backwards.
    ///
    /// The domain stays `[a, b]`: `t` becomes `a + b − t`. Where the rounding of that sum
    /// would merge knots that differ (spans far shorter than the ulp of the ends), the
    /// knots are mirrored at 0 instead, which is exact: the domain becomes `[−b, −a]`.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let [a, b] = self.domain();
        let mirror = |t: f64| if t == a { b } else { a + (b - t) };
        let values: Vec<f64> = self.values.iter().rev().map(|&t| mirror(t)).collect();
        let backwards: Vec<f64> = self.values.iter().rev().map(|t| -t).collect();
        let same_spans = values
            .windows(2)
            .zip(backwards.windows(2))
            .all(|(new, old)| if old[0] == old[1] { new[0] == new[1] } else { new[0] < new[1] });
        let values = match Self::new(self.degree, values) {
            Ok(mirrored) if same_spans => return mirrored,
            _ => backwards,
        };
        Self { degree: self.degree, values }
    }

    /// These knots mapped linearly to another domain; equal knots stay equal.
    ///
    /// # Errors
    /// When the domain is empty or not finite, or too short for the knots to stay apart.
    pub fn on_domain(&self, start: f64, end: f64) -> Result<Self, KnotError> {
        let [a, b] = self.domain();
        if (start, end) == (a, b) {
            return Ok(self.clone());
        }
        let exists = start <= end && (end - start).is_finite(); // false for NaN
        if !exists {
            return Err(KnotError::OtherDomain { start, end });
        }
        // The ends exactly.
        let moved = |&t: &f64| {
            if t == a {
                start
            } else if t == b {
                end
            } else {
                start + (t - a) / (b - a) * (end - start)
            }
        };
        let values: Vec<f64> = self.values().iter().map(moved).collect();
        let merged = self.values().windows(2).zip(values.windows(2));
        for (old, new) in merged {
            if old[0] != old[1] && new[0] == new[1] {
                return Err(KnotError::Merged { first: old[0], second: old[1], start, end });
            }
        }
        Self::new(self.degree(), values)
    }
}

/// The fewest different control points of a closed spline: two would make it double back on itself.
pub(crate) const LEAST_AROUND: usize = 3;

/// The knots of one period, with `degree` more before it and after it, which repeat it.
pub(crate) fn periodic_values(degree: usize, period: &[f64]) -> Result<Vec<f64>, KnotError> {
    let count = period.len().saturating_sub(1);
    if count < LEAST_AROUND {
        return Err(KnotError::ShortPeriod { points: count, needed: LEAST_AROUND });
    }
    check_points(degree, count.saturating_add(degree))?;
    check_order(period)?;
    let (first, last) = (period[0], period[count]);
    if first == last {
        return Err(KnotError::AllEqual { knot: first });
    }
    // Each further period begins where the one before it ends, so that equal knots stay equal and
    // all stay in order.
    let (mut before, mut after) = (Vec::new(), Vec::new());
    let (mut start, mut end) = (first, last);
    while after.len() < degree {
        before.extend(period[..count].iter().rev().map(|knot| start - (last - knot)));
        after.extend(period[1..].iter().map(|knot| end + (knot - first)));
        (start, end) = (before[before.len() - 1], after[after.len() - 1]);
    }
    before.truncate(degree);
    after.truncate(degree);
    Ok(before.into_iter().rev().chain(period.iter().copied()).chain(after).collect())
}

fn check_degree(degree: usize) -> Result<(), KnotError> {
    match degree {
        1..=MAX_DEGREE => Ok(()),
        _ => Err(KnotError::Degree { degree }),
    }
}

fn check_points(degree: usize, points: usize) -> Result<(), KnotError> {
    if points < degree + 1 {
        return Err(KnotError::TooFewPoints { points, degree });
    }
    if points > MAX_CONTROL_POINTS {
        return Err(KnotError::TooManyPoints { points });
    }
    Ok(())
}

/// Checks that the knots pass [`check_order`] and that none is repeated more than `p + 1` times.
fn check_values(degree: usize, values: &[f64]) -> Result<(), KnotError> {
    check_order(values)?;
    for run in values.chunk_by(|a, b| a == b) {
        if run.len() > degree + 1 {
            return Err(KnotError::Multiplicity { knot: run[0], times: run.len(), degree });
        }
    }
    Ok(())
}

/// Checks that the knots, at least one, are finite, in order, and not too far apart.
pub(super) fn check_order(values: &[f64]) -> Result<(), KnotError> {
    if let Some(index) = values.iter().position(|knot| !knot.is_finite()) {
        return Err(KnotError::NotFinite { index, knot: values[index] });
    }
    if let Some(index) = (1..values.len()).find(|&i| values[i] < values[i - 1]) {
        return Err(KnotError::Order { index, before: values[index - 1], knot: values[index] });
    }
    let (first, last) = (values[0], values[values.len() - 1]);
    if !(last - first).is_finite() {
        return Err(KnotError::TooWide { first, last });
    }
    Ok(())
}

/// The knots of one Bézier piece on `[0, 1]`.
pub(crate) fn unit_knots(degree: usize) -> KnotVector {
    let mut values = vec![0.0; degree + 1];
    values.extend(std::iter::repeat_n(1.0, degree + 1));
    KnotVector::derived(degree, values)
}
