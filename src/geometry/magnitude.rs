//! Which numbers control points may have, and what they span.

use glam::DVec3;

use crate::math::rounding;

/// The largest coordinate of a surface or a curve, and the largest weight of a control point.
/// Bounds on normals and curvatures are products of up to four lengths, and must not overflow (at
/// 1.8e308).
pub const MAX_MAGNITUDE: f64 = 1e70;

/// Whether a point can be a control point: no coordinate is NaN, or beyond [`MAX_MAGNITUDE`].
pub(crate) fn is_usable(point: DVec3) -> bool {
    point.abs().cmple(DVec3::splat(MAX_MAGNITUDE)).all() // false for NaN
}

/// The smallest size of a surface, and the smallest weight of a control point. The same products
/// must not underflow (at 2e-308).
pub const MIN_MAGNITUDE: f64 = 1e-70;

/// Whether a number can be the weight of a control point: from [`MIN_MAGNITUDE`] to
/// [`MAX_MAGNITUDE`].
pub fn is_usable_weight(weight: f64) -> bool {
    (MIN_MAGNITUDE..=MAX_MAGNITUDE).contains(&weight) // false for NaN
}

/// Control points closer together than this, relative to their largest coordinate, cannot
/// be told from one point whose coordinates were multiplied and divided by a weight.
const SAME_POINT: f64 = 4.0 * f64::EPSILON;

/// What control points span, to within rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Extent {
    /// Nothing: all are one point.
    Point(DVec3),
    /// A line, which a ray could meet only by a coincidence of rounding.
    Line { from: DVec3, to: DVec3 },
    /// More than a line; `size` is the length along the longest axis.
    Wide { size: f64 },
}

/// The extent of the control points of a surface of degrees p and q.
pub(crate) fn extent<I: Iterator<Item = DVec3>>(
    points: impl Fn() -> I,
    [p, q]: [usize; 2],
) -> Extent {
    let first = points().next().unwrap_or_default();
    let (mut low, mut high) = (first, first);
    for point in points() {
        low = low.min(point);
        high = high.max(point);
    }
    let magnitude = low.abs().max(high.abs()).max_element();
    let size = (high - low).max_element();
    let extended = size > SAME_POINT * magnitude;
    if !extended {
        return Extent::Point(first);
    }
    let distance = |point: &DVec3| point.distance_squared(first);
    let farther = |a: &DVec3, b: &DVec3| distance(a).total_cmp(&distance(b));
    let last = points().max_by(farther).unwrap_or(first);
    let along = (last - first).normalize_or_zero();
    let off_line = |point: DVec3| (point - first).cross(along).length();
    let widest = points().map(off_line).fold(0.0, f64::max);
    let wide = widest > rounding::residual_factor(p, q) * magnitude;
    if wide { Extent::Wide { size } } else { Extent::Line { from: first, to: last } }
}
