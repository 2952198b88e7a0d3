//! One line of homogeneous control points along one knot vector: what curves and the rows
//! and columns of surfaces have in common.
//!
//! Everything here forms convex combinations only, coordinate by coordinate, and keeps a
//! coordinate that is equal in both points as it is, bit for bit. So weights stay
//! positive, equal weights stay equal, flat nets stay flat and collapsed edges collapsed.

use std::borrow::Cow;

use glam::DVec4;

use crate::geometry::knots::KnotVector;

/// `(1 − α) a + α b` for `0 ≤ α ≤ 1`, coordinates that are equal kept as they are.
pub(crate) fn mix(a: DVec4, b: DVec4, alpha: f64) -> DVec4 {
    mix_by(a, b, [1.0 - alpha, alpha])
}

/// As [`mix`], with `1 − α` and `α` given.
#[inline]
pub(crate) fn mix_by(a: DVec4, b: DVec4, [beta, alpha]: [f64; 2]) -> DVec4 {
    // Computed even where coordinates are equal: branches would take more time.
    let mixed = beta * a + alpha * b;
    let one = |a: f64, b: f64, mixed: f64| if a == b { a } else { mixed };
    DVec4::new(
        one(a.x, b.x, mixed.x),
        one(a.y, b.y, mixed.y),
        one(a.z, b.z, mixed.z),
        one(a.w, b.w, mixed.w),
    )
}

/// `1 − α` and `α` for `α = (t − left) / (right − left)`.
///
/// The smaller of the two is computed from the knots, and the other from the smaller. So neither
/// loses digits, however near to an end `t` is: the small share of a point may count more than all
/// the rest, if the point is far heavier.
#[inline]
pub(crate) fn shares(t: f64, left: f64, right: f64) -> [f64; 2] {
    let width = right - left;
    let alpha = (t - left) / width;
    if alpha <= 0.5 {
        [1.0 - alpha, alpha]
    } else {
        let beta = (right - t) / width;
        [beta, 1.0 - beta]
    }
}

/// The insertion of knots into lines of control points that share one knot vector: everything that
/// depends on the knots alone, computed once for all lines.
///
/// Boehm 1980. Let `t` be among the knots `s` times already, and `l` the last knot below it.
/// Inserting `t` once more keeps the points up to `l + s − p`, replaces those from there to
/// `l` by `Q_i = (1 − αᵢ) P_{i−1} + αᵢ Pᵢ` with `αᵢ = (t − tᵢ) / (tᵢ₊ₚ − tᵢ)`, and continues
/// with the old `P_l` and the points after it. Knots are inserted from left to right: everything
/// right of `t` is then still untouched, so that one sweep does all insertions.
pub(crate) struct Insertions {
    steps: Vec<Insertion>,
    /// `1 − αᵢ` and `αᵢ` of all steps; within a step from right to left.
    shares: Vec<[f64; 2]>,
}

/// One knot to be inserted.
struct Insertion {
    /// The number of points copied from the old line before this insertion.
    taken: usize,
    /// `l`: the last point that is replaced; its old value follows it.
    last: usize,
    /// The number of points replaced.
    replaced: usize,
}

impl Insertions {
    /// The insertion of the knots `new`, in increasing order.
    ///
    /// They must lie in the domain and no knot may end up with more than `p + 1` copies. Adding
    /// the last of these copies duplicates a control point: there the spline falls apart.
    pub(crate) fn new(knots: &KnotVector, new: &[f64]) -> Self {
        let p = knots.degree();
        let old = knots.values();
        let mut insertions = Self { steps: Vec::with_capacity(new.len()), shares: Vec::new() };
        let mut done_knots = Vec::with_capacity(old.len() + new.len());
        let (mut next_knot, mut done) = (0, 0);
        for &t in new {
            // Copy all knots up to t, and all points up to the last one that t changes.
            let upto = next_knot + old[next_knot..].partition_point(|&knot| knot <= t);
            done_knots.extend_from_slice(&old[next_knot..upto]);
            next_knot = upto;
            let below = done_knots.partition_point(|&knot| knot < t); // l + 1
            let taken = below.saturating_sub(done);
            done += taken + 1;

            let (last, last_knot) = (below - 1, done_knots.len() - 1);
            let first = last_knot + 1 - p;
            for i in (first..=last).rev() {
                let right = old[next_knot + (i + p - done_knots.len())];
                let left = done_knots[i];
                insertions.shares.push(shares(t, left, right));
            }
            let replaced = (last + 1).saturating_sub(first);
            insertions.steps.push(Insertion { taken, last, replaced });
            done_knots.push(t);
        }
        insertions
    }

    /// The control points of the same spline over the old and the new knots.
    pub(crate) fn apply(&self, points: &[DVec4]) -> Vec<DVec4> {
        self.apply_to_rows(points, 1)
    }

    /// As [`Self::apply`], for lines that lie side by side, as the columns of a net do: whole rows,
    /// of this length, take the place of points.
    #[inline(always)] // rows of one point get code of their own
    pub(crate) fn apply_to_rows(&self, points: &[DVec4], length: usize) -> Vec<DVec4> {
        let mut done = Vec::with_capacity(points.len() + self.steps.len() * length);
        let (mut rest, mut shares) = (points, &self.shares[..]);
        for &Insertion { taken, last, replaced } in &self.steps {
            let (taken, others) = rest.split_at(taken * length);
            done.extend_from_slice(taken);
            rest = others;
            // The old value of the last row that is replaced follows it.
            let (from, end) = (last * length, done.len());
            done.resize(end + length, DVec4::ZERO);
            done.copy_within(from..end, from + length);
            // From the right, so that the old points are still there to be combined.
            let (own, others) = shares.split_at(replaced);
            for (k, &of_both) in own.iter().enumerate() {
                let (before, row) = done.split_at_mut((last - k) * length);
                let before = &before[(last - k - 1) * length..];
                for (point, &before) in row.iter_mut().zip(before) {
                    *point = mix_by(before, *point, of_both);
                }
            }
            shares = others;
        }
        done.extend_from_slice(rest);
        done
    }
}

/// Inserts the knots `new` into one line: see [`Insertions`].
pub(crate) fn refine(knots: &KnotVector, points: &[DVec4], new: &[f64]) -> Vec<DVec4> {
    Insertions::new(knots, new).apply(points)
}

/// The knots `old` together with `new`, both in increasing order.
pub(crate) fn merged(old: &[f64], new: &[f64]) -> Vec<f64> {
    let mut values = Vec::with_capacity(old.len() + new.len());
    let mut rest = new;
    for &knot in old {
        let before = rest.partition_point(|&t| t < knot);
        values.extend_from_slice(&rest[..before]);
        rest = &rest[before..];
        values.push(knot);
    }
    values.extend_from_slice(rest);
    values
}

/// The part of a spline between two parameters `start < end` of its domain, clamped:
/// both become knots of multiplicity `p + 1` and the ends of the domain.
///
/// On the domain's own ends this turns an unclamped or periodic spline into a clamped one.
pub(crate) fn restrict(
    knots: &KnotVector,
    points: &[DVec4],
    [start, end]: [f64; 2],
) -> (KnotVector, Vec<DVec4>) {
    let p = knots.degree();
    let missing = |t| p.saturating_sub(knots.multiplicity(t));
    let mut new = vec![start; missing(start)];
    new.extend(std::iter::repeat_n(end, missing(end)));
    // A curve is cut into its pieces one by one, and no knots are missing then: do not copy the
    // whole curve for each.
    let (values, points) = match new.as_slice() {
        [] => (Cow::Borrowed(knots.values()), Cow::Borrowed(points)),
        new => (Cow::Owned(merged(knots.values(), new)), Cow::Owned(refine(knots, points, new))),
    };

    // With p copies of each end present, the points from `last_start − p` to `beyond − 1` alone
    // decide what happens between them, whatever knots lie outside.
    let last_start = values.partition_point(|&knot| knot <= start) - 1;
    let beyond = values.partition_point(|&knot| knot < end);
    let mut kept = vec![start; p + 1];
    kept.extend_from_slice(&values[last_start + 1..beyond]);
    kept.extend(std::iter::repeat_n(end, p + 1));
    (KnotVector::derived(p, kept), points[last_start - p..beyond].to_vec())
}
