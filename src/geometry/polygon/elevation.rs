//! Degree elevation of a line of homogeneous control points.

use glam::DVec4;

use super::refine;
use crate::geometry::knots::KnotVector;

/// The same clamped spline with its degree raised by one and every knot repeated once more.
///
/// Control point `i` of a spline of degree `p` is its blossom `f` at the `p` knots that
/// follow knot `i`, and the blossom of the elevated spline is the mean of `f` over all ways
/// to leave one of its `p + 1` arguments out. Leaving out every `(p + 1)`-th of the new
/// knots, starting at the `k`-th, omits one of each `p + 1` consecutive ones; the remaining knots
/// are a refinement of the old ones. So the new control points are means of `p + 1` knot
/// insertions (Prautzsch 1984): convex combinations, unlike elevation piece by piece with
/// the removal of knots afterwards.
///
/// Where an inner knot of multiplicity `p + 1` lets the spline jump, each side is elevated
/// by itself.
pub(crate) fn elevate(knots: &KnotVector, points: &[DVec4]) -> (KnotVector, Vec<DVec4>) {
    let p = knots.degree();
    let values = knots.values();
    let mut new_values: Vec<f64> = Vec::new();
    let mut new_points = Vec::new();
    let mut start = 0; // first knot, and first point, of the part between two jumps
    for end in jumps(knots) {
        let part = KnotVector::derived(p, values[start..end + p + 1].to_vec());
        let (part_values, part_points) = elevate_continuous(&part, &points[start..end]);
        let shared = if start == 0 { 0 } else { p + 2 };
        new_values.extend_from_slice(&part_values[shared..]);
        new_points.extend(part_points);
        start = end;
    }
    (KnotVector::derived(p + 1, new_values), new_points)
}

/// The indices above 0 at which `p + 1` equal knots begin: where the spline may jump, and where
/// it ends.
fn jumps(knots: &KnotVector) -> impl Iterator<Item = usize> + '_ {
    let (p, values) = (knots.degree(), knots.values());
    (1..=knots.point_count()).filter(move |&i| values[i] == values[i + p])
}

/// [`elevate`] for a spline without jumps.
fn elevate_continuous(knots: &KnotVector, points: &[DVec4]) -> (Vec<f64>, Vec<DVec4>) {
    // The first and the last knot have no influence; without them no knot occurs more than
    // p times, and leaving out every (p + 1)-th of the new ones takes at most one copy of each.
    let p = knots.degree();
    let values = knots.values();
    let old = &values[1..values.len() - 1];
    let mut new = Vec::with_capacity(2 * old.len());
    for run in old.chunk_by(|a, b| a == b) {
        new.extend_from_slice(run);
        new.push(run[0]);
    }

    // Takes the mean of all splines in which every (p + 1)-th knot is left out, one spline after
    // the other: all at once would take p times the memory of the result.
    let mut first: Vec<DVec4> = Vec::new();
    let mut differences = vec![DVec4::ZERO; new.len() - p];
    for k in 0..=p {
        let left = |&(i, _): &(usize, &f64)| i % (p + 1) != k;
        let kept: Vec<f64> = new.iter().enumerate().filter(left).map(|(_, &t)| t).collect();
        let refinement = refine(knots, points, &without(&kept, old));
        let point = |j: usize| refinement[j - (j + p - k) / (p + 1)]; // minus those left out before
        if k == 0 {
            first = (0..new.len() - p).map(point).collect();
            continue;
        }
        for (j, (sum, first)) in differences.iter_mut().zip(&first).enumerate() {
            *sum += point(j) - *first;
        }
    }
    // Coordinates that are equal in all these splines stay as they are.
    let count = (p + 1) as f64;
    let elevated = first.iter().zip(&differences).map(|(&first, &sum)| first + sum / count);
    let elevated = elevated.collect();

    let mut full = vec![values[0]];
    full.append(&mut new);
    full.push(values[values.len() - 1]);
    (full, elevated)
}

/// What remains of `all` when `some`, a part of it, is taken away; both are increasing.
fn without(all: &[f64], some: &[f64]) -> Vec<f64> {
    let mut taken = some.iter().peekable();
    all.iter().copied().filter(|t| taken.next_if_eq(&t).is_none()).collect()
}
