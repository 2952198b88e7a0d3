//! Segments of trim curves, monotone in u and in v.

use glam::{DVec2, DVec3, Vec2Swizzles, Vec3Swizzles};

use super::UvBox;
use super::window_curve::Stretch;
use crate::geometry::{Direction, MAX_DEGREE};
use crate::math::bernstein::{self, binomial};
use crate::math::rounding::UNIT_ROUNDOFF;

/// The most steps of the searches in [`Segment::passing`] and [`Segment::stretch_within`]. Four
/// steps halve the remaining stretch, so they end at 2⁻⁶⁴ of the segment, far below one rounding
/// error.
const MOST_STEPS: usize = 256;

/// A segment is flat if the band of its control points is no wider than this fraction of its chord.
/// A quarter circle makes four flat segments; finer ones would cost more in the hierarchy than they
/// save.
const FLAT: f64 = 0.125;

/// How near to the sides of a rectangle a stretch within it ends, as a fraction of its size.
const NEAR_SIDE: f64 = 1.0 / 4096.0;

/// Error bound of the curve as searched against the curve as written, relative to the largest
/// parameter of its Bézier piece: `16 (p + 1) u` for degree `p`.
///
/// Each step of de Casteljau or Boehm is a convex combination and errs by at most 3 roundings of
/// the largest coordinate: up to `6 (p − 1)` for the Bézier form of a spline, `4 p` for cutting it
/// into monotone segments, `2 p + 6` for evaluation and its division, four for the corners of arcs,
/// and four where the curve goes back a little although it counts as monotone. Cutting a piece off
/// at a gap may add `3 p` at either end, which is within the bound up to degree 6, and beyond
/// unless all errors add up; it is far less than any such gap.
fn reach_factor(degree: usize) -> f64 {
    16.0 * (degree + 1) as f64 * UNIT_ROUNDOFF
}

/// A piece of a curve that is monotone in u and in v, stored so that v does not decrease along it
/// or, if it is horizontal, u does not.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Segment {
    ends: [DVec2; 2],
    /// `C(p, i)` times the homogeneous control points; empty for a straight line.
    control: Box<[DVec3]>,
    /// Whether the loop runs along the segment in the stored direction.
    forward: bool,
    reach: DVec2,
    /// Whether it lies on the border of the domain, or outside.
    on_border: bool,
    /// The vector perpendicular to the chord, as long as the chord, towards smaller u.
    across: DVec2,
    /// The least and the largest `across · (point − ends[0])` of the control points, grown by the
    /// reach. The segment lies between them.
    band: [f64; 2],
}

/// Where a target lies relative to a segment that it is level with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Passing {
    /// On the side of smaller u.
    Left,
    /// On the side of larger u.
    Right,
    /// On the segment.
    Meets,
}

impl Segment {
    /// The straight line between two points; `None` if they are equal.
    pub(super) fn line(ends: [DVec2; 2]) -> Option<Self> {
        let reach = reach_factor(1) * ends[0].abs().max(ends[1].abs());
        Self::held(ends, Vec::new(), reach)
    }

    /// The monotone rational Bézier curve between two points; `None` if they are equal, because a
    /// monotone closed curve is a point. Only the weights of the outer two control points are used.
    ///
    /// `magnitude` holds the largest |u| and |v| of the control points from which the curve was
    /// computed, perhaps those of a longer curve. It determines the bound on rounding errors.
    pub(super) fn new(ends: [DVec2; 2], control: &[DVec3], magnitude: DVec2) -> Option<Self> {
        let degree = control.len() - 1;
        let scaled = control.iter().enumerate().map(|(i, &c)| binomial(degree, i) * c);
        Self::held(ends, scaled.collect(), reach_factor(degree) * magnitude)
    }

    fn held(ends: [DVec2; 2], mut control: Vec<DVec3>, reach: DVec2) -> Option<Self> {
        let [from, to] = ends;
        if from == to {
            return None;
        }
        let forward = (from.y, from.x) < (to.y, to.x);
        if !forward {
            control.reverse();
        }
        let ends = if forward { [from, to] } else { [to, from] };
        let across = (ends[1] - ends[0]).perp();
        let inner = control.iter().skip(1).rev().skip(1).map(|c| c.xy() / c.z);
        let offsets = inner.map(|point| across.dot(point - ends[0]));
        let [low, high] = offsets.fold([0f64; 2], |[a, b], x| [a.min(x), b.max(x)]);
        let margin = across.abs().dot(reach);
        let band = [low - margin, high + margin];
        let on_border = false;
        Some(Self { ends, control: control.into(), forward, reach, on_border, across, band })
    }

    /// Whether the control points lie so near the chord that a point near the chord is quickly
    /// distinguished from one on the curve.
    pub(super) fn is_flat(&self) -> bool {
        self.is_straight() || self.band[1] - self.band[0] <= FLAT * self.across.length_squared()
    }

    /// Reverses the direction in which the loop runs along the segment.
    pub(super) fn turn_around(&mut self) {
        self.forward = !self.forward;
    }

    /// Its ends, the one with the smaller v first.
    pub(super) fn ends(&self) -> [DVec2; 2] {
        self.ends
    }

    /// Its ends in the order in which the loop runs.
    pub(super) fn directed_ends(&self) -> [DVec2; 2] {
        let [from, to] = self.ends;
        if self.forward { [from, to] } else { [to, from] }
    }

    /// Whether the loop runs along it towards larger v, or, if it is horizontal, larger u.
    pub(super) fn is_forward(&self) -> bool {
        self.forward
    }

    /// Whether it is a straight line.
    pub(super) fn is_straight(&self) -> bool {
        self.control.is_empty()
    }

    /// Error bound of the segment: the distance in u and in v to the curve it was cut from.
    pub(super) fn reach(&self) -> DVec2 {
        self.reach
    }

    /// Finds out whether it reaches into a domain by no more than its reach and `off`, in u or in
    /// v. Of that reach no more counts than a curve within the domain may have.
    pub(super) fn look_for_border(&mut self, domain: &UvBox, off: DVec2) {
        let UvBox { min, max } = self.bounds();
        let most = reach_factor(MAX_DEGREE) * domain.min.abs().max(domain.max.abs());
        let off = off + self.reach.min(most);
        let is_low = max.cmple(domain.min + off).any();
        self.on_border = is_low || min.cmpge(domain.max - off).any();
    }

    /// Whether it lies on the border of the domain, or outside, where it cuts nothing.
    pub(super) fn is_on_border(&self) -> bool {
        self.on_border
    }

    /// The rectangle of the two ends, which contains the segment.
    pub(super) fn bounds(&self) -> UvBox {
        let [from, to] = self.ends;
        UvBox { min: from.min(to), max: from.max(to) }
    }

    /// An upper bound of the absolute values of its second derivative by the parameter, which runs
    /// from 0 to 1, in u and in v; infinite if it is too large to be told.
    ///
    /// Derivatives of the homogeneous curve `(A, w)` lie in the hull of the differences of its
    /// control points, and with `C = A / w` relative to an end, `C″ = (A″ − 2 w′ C′ − w″ C) / w`.
    pub(super) fn bend(&self) -> DVec2 {
        if self.is_straight() {
            return DVec2::ZERO;
        }
        let origin = self.ends[0];
        let relative = |c: DVec3| (c.xy() - c.z * origin).extend(c.z);
        let control: Vec<DVec3> = self.homogeneous().into_iter().map(relative).collect();
        let difference = |of: &[DVec3]| -> Vec<DVec3> {
            let factor = (of.len() - 1) as f64;
            of.windows(2).map(|pair| factor * (pair[1] - pair[0])).collect()
        };
        let largest = |of: &[DVec3]| of.iter().fold(DVec3::ZERO, |most, c| most.max(c.abs()));
        let first = difference(&control);
        let (along, twice) = (largest(&first), largest(&difference(&first)));
        let lightest = control.iter().fold(f64::INFINITY, |least, c| least.min(c.z));
        let size = self.bounds().size();
        let speed = (along.xy() + along.z * size) / lightest;
        let bend = (twice.xy() + 2.0 * along.z * speed + twice.z * size) / lightest;
        if bend.is_nan() { DVec2::INFINITY } else { bend }
    }

    /// The bytes that the segment occupies outside the struct itself.
    pub(super) fn bytes(&self) -> usize {
        std::mem::size_of_val(&*self.control)
    }

    /// The homogeneous control points as stored, without the binomial factors.
    pub(super) fn homogeneous(&self) -> Vec<DVec3> {
        let [from, to] = self.ends;
        let [Some(first), Some(last)] = [self.control.first(), self.control.last()] else {
            return self.ends.map(|end| end.extend(1.0)).to_vec();
        };
        let degree = self.control.len() - 1;
        let inner = (1..degree).map(|i| self.control[i] / binomial(degree, i));
        // Of the outer two only the weights are used.
        let outer = [(from, first.z), (to, last.z)].map(|(end, w)| (w * end).extend(w));
        [outer[0]].into_iter().chain(inner).chain([outer[1]]).collect()
    }

    /// The point at `t` in `[0, 1]`, clamped to the rectangle of the ends and equal to them at 0
    /// and 1.
    #[inline]
    pub(super) fn at(&self, t: f64) -> DVec2 {
        let [from, to] = self.ends;
        if t == 0.0 {
            return from;
        }
        if t == 1.0 {
            return to;
        }
        self.free_at(t).max(from.min(to)).min(from.max(to))
    }

    /// The point at `along` in `[0, 1]`, in the direction of the loop.
    pub(super) fn directed_at(&self, along: f64) -> DVec2 {
        self.at(if self.forward { along } else { 1.0 - along })
    }

    /// A stretch of its own parameter as one of fractions in the direction of the loop.
    pub(super) fn directed(&self, [from, to]: [f64; 2]) -> [f64; 2] {
        if self.forward { [from, to] } else { [1.0 - to, 1.0 - from] }
    }

    /// The point at `t`, not clamped, by Horner's scheme for `Σ cᵢ tⁱ (1 − t)^(p−i)`: all terms of
    /// the weight are positive, so no precision is lost for `t` near either end.
    #[inline]
    pub(super) fn free_at(&self, t: f64) -> DVec2 {
        let s = 1.0 - t;
        let [from, to] = self.ends;
        let Some((&first, rest)) = self.control.split_first() else {
            return s * from + t * to;
        };
        let mut sum = first;
        let mut power = 1.0;
        for &c in rest {
            power *= t;
            sum = sum * s + c * power;
        }
        sum.xy() / sum.z
    }

    /// The parameter at which a coordinate reaches `value`, which lies between the coordinates of
    /// the ends. The segment is monotone, so bisection down to neighbouring numbers finds it.
    pub(super) fn reaching(&self, axis: Direction, value: f64) -> f64 {
        let rises = self.ends[0][axis] < self.ends[1][axis];
        let (mut low, mut high) = (0.0, 1.0);
        loop {
            let middle = 0.5 * (low + high);
            if middle <= low || middle >= high {
                return high;
            }
            let reached = self.at(middle)[axis];
            if reached == value {
                return middle;
            }
            if (reached < value) == rises {
                low = middle;
            } else {
                high = middle;
            }
        }
    }

    /// From and to in the parameter, in `[0, 1]`, where it runs through a rectangle; `None` where
    /// it does not enter. It ends at its own ends, or a little farther out than the rectangle.
    pub(super) fn stretch_within(&self, rect: &UvBox) -> Option<[f64; 2]> {
        let [from, to] = self.ends;
        let mut range = [0.0f64, 1.0f64];
        for axis in 0..2 {
            let [low, high] = [rect.min[axis], rect.max[axis]];
            let rises = from[axis] <= to[axis];
            let [enters, leaves] = if rises { [low, high] } else { [high, low] };
            let is_before = |at: f64, side: f64| if rises { at < side } else { at > side };
            if is_before(to[axis], enters) || is_before(leaves, from[axis]) {
                return None;
            }
            let near = (high - low) * NEAR_SIDE;
            if is_before(from[axis], enters) {
                range[0] = range[0].max(self.short_of(axis, enters, near, [0.0, 1.0]));
            }
            if is_before(leaves, to[axis]) {
                range[1] = range[1].min(self.short_of(axis, leaves, near, [1.0, 0.0]));
            }
        }
        (range[0] < range[1]).then_some(range)
    }

    /// A parameter at which a coordinate is short of `value`, seen from the first of two parameters
    /// between which it reaches it, by no more than `near` if floating-point numbers allow.
    ///
    /// Found by false position, with a bisection every third step.
    fn short_of(&self, axis: usize, value: f64, near: f64, [start, end]: [f64; 2]) -> f64 {
        let off = |t: f64| self.at(t)[axis] - value;
        let sign = off(start).signum();
        // Positive until the value is reached; aims at the middle of what is near.
        let short = |t: f64| sign * off(t);
        let (mut before, mut beyond) = ((start, short(start)), (end, short(end)));
        for step in 1..=MOST_STEPS {
            if before.1 <= near {
                break;
            }
            let part = (before.1 - 0.5 * near) / (before.1 - beyond.1);
            let part = if step % 3 == 0 { 0.5 } else { part };
            let t = before.0 + part * (beyond.0 - before.0);
            if t == before.0 || t == beyond.0 {
                break;
            }
            match short(t) {
                still if still > 0.0 => before = (t, still),
                no_more => beyond = (t, no_more),
            }
        }
        before.0
    }

    /// A stretch of it, which begins and ends at [`Self::at`], in the coordinates of a window with
    /// this center and these half side lengths.
    ///
    /// Where weights differ by orders of magnitude, rounding may move the cuts by more than the
    /// window's spare, along the curve; but there so short a stretch of it is straight.
    pub(super) fn stretch_in(&self, [from, to]: [f64; 2], center: DVec2, half: DVec2) -> Stretch {
        let mut control = self.homogeneous();
        bernstein::restrict(&mut control, from, to);
        for c in &mut control {
            *c = ((c.xy() - c.z * center) / half).extend(c.z);
        }
        let ends = [from, to].map(|t| (self.at(t) - center) / half);
        let last = control.len() - 1;
        for (k, end) in [(0, ends[0]), (last, ends[1])] {
            control[k] = (control[k].z * end).extend(control[k].z);
        }
        Stretch { ends, control }
    }

    /// The direction of the tangent at `t`: that between the last two points of de Casteljau's
    /// scheme.
    pub(super) fn tangent(&self, t: f64) -> DVec2 {
        let mut control = self.homogeneous();
        for last in (2..control.len()).rev() {
            for k in 0..last {
                control[k] = control[k].lerp(control[k + 1], t);
            }
        }
        let [from, to] = [control[0], control[1]].map(|c| c.xy() / c.z);
        to - from
    }

    /// Where a rectangle that meets the segment's bounding rectangle lies relative to the segment.
    ///
    /// If the rectangle lies outside the band of the control points, the chord decides. Otherwise
    /// the segment itself does, mirrored in u if need be so that it rises to the right. If the
    /// target lies above and left of a point `Q` of the segment, it lies above and left of the
    /// whole segment; likewise below and right. Otherwise the target is ahead of `Q`, behind `Q`,
    /// or contains `Q`. The signed distances to the target in u and in v then never have opposite
    /// signs. Scaled by the segment's extents, their sum grows along the segment, and its root is
    /// found by false position with halved end values (the "Illinois" rule; Dowell & Jarratt 1971),
    /// with a bisection where three steps have not halved the stretch.
    ///
    /// If no number is left between the ends of the stretch, the target is met as far as floating
    /// point can tell.
    pub(super) fn passing(&self, target: &UvBox) -> Passing {
        let [from, to] = self.ends;
        let offset = self.across.dot(target.center() - from);
        let spread = 0.5 * self.across.abs().dot(target.size());
        if offset - spread > self.band[1] {
            return Passing::Left;
        }
        if offset + spread < self.band[0] {
            return Passing::Right;
        }
        let falls_back = to.x < from.x;
        let scale = (to - from).abs().recip().min(DVec2::splat(f64::MAX));
        let past = |q: f64, low: f64, high: f64| (q - high).max(0.0) + (q - low).min(0.0);
        let gaps = |q: DVec2| {
            let along = past(q.x, target.min.x, target.max.x);
            let up = past(q.y, target.min.y, target.max.y);
            DVec2::new(if falls_back { -along } else { along }, up)
        };
        let (above, below) = if falls_back {
            (Passing::Right, Passing::Left)
        } else {
            (Passing::Left, Passing::Right)
        };

        // The remaining stretch: the segment is behind the target at t[0] and past it at t[1].
        let mut t = [0.0, 1.0];
        let (start, end) = (gaps(from), gaps(to));
        if start == DVec2::ZERO || end == DVec2::ZERO {
            return Passing::Meets;
        }
        let mut value = [(start * scale).element_sum(), (end * scale).element_sum()];
        let (mut moved, mut width) = (2, 1.0);
        for step in 1..=MOST_STEPS {
            let middle = 0.5 * (t[0] + t[1]);
            let root = (t[0] * value[1] - t[1] * value[0]) / (value[1] - value[0]);
            let inside = |x: f64| t[0] < x && x < t[1]; // false for NaN
            let slow = step % 3 == 0 && t[1] - t[0] > 0.5 * width;
            if step % 3 == 0 {
                width = t[1] - t[0];
            }
            let next = if !slow && inside(root) { root } else { middle };
            if !inside(next) {
                break;
            }
            let gap = gaps(self.at(next));
            if gap.x > 0.0 && gap.y < 0.0 {
                return above;
            }
            if gap.x < 0.0 && gap.y > 0.0 {
                return below;
            }
            if gap == DVec2::ZERO {
                break;
            }
            let side = usize::from(gap.x > 0.0 || gap.y > 0.0);
            t[side] = next;
            value[side] = (gap * scale).element_sum();
            if moved == side {
                value[1 - side] *= 0.5;
            }
            moved = side;
        }
        Passing::Meets
    }

    /// Returns whether the segment passes within `reach` of the point, and how often the loop
    /// crosses the ray from `point` towards larger u along this segment, upwards counted positive.
    ///
    /// A crossing is counted where the lower end of the segment is level with the ray or below it
    /// and the upper end is above. Of two segments that share an end, one counts it where the loop
    /// goes on, and both or neither where the loop turns back. A point on the segment is not left
    /// of it.
    pub(super) fn seen_from(&self, point: DVec2, reach: DVec2) -> (bool, i32) {
        let [from, to] = self.ends;
        let level = from.y <= point.y && point.y < to.y;
        let bounds = self.bounds();
        let target = UvBox::about(point, reach);
        let passing = if bounds.meets(&target) { Some(self.passing(&target)) } else { None };
        let left = match passing {
            Some(Passing::Left) => level,
            Some(Passing::Right) => false,
            _ if !level || point.x > bounds.max.x => false,
            _ if point.x < bounds.min.x => true,
            _ => self.passing(&UvBox { min: point, max: point }) == Passing::Left,
        };
        let crossing = i32::from(left) * if self.forward { 1 } else { -1 };
        (passing == Some(Passing::Meets), crossing)
    }

    /// The segment mirrored in u so that `range`, run backwards, becomes the equally long `new`;
    /// `None` if rounding makes it a point. Its ends are still shared with its neighbours bit for
    /// bit.
    pub(super) fn mirrored_u(&self, range: [f64; 2], new: [f64; 2]) -> Option<Self> {
        let mirror = |u: f64| if u == range[0] { new[1] } else { new[0] + (range[1] - u) };
        let ends = self.directed_ends().map(|end| DVec2::new(mirror(end.x), end.y));
        let mirrored = |c: &DVec3| DVec3::new(c.z * (new[0] + range[1]) - c.x, c.y, c.z);
        let mut control: Vec<DVec3> = self.control.iter().map(mirrored).collect();
        if !self.forward {
            control.reverse();
        }
        let largest = self.control.iter().map(|c| (c.x / c.z).abs());
        let largest = largest.chain(self.ends.map(|end| end.x.abs())).fold(0.0, f64::max);
        let rounding = 4.0 * UNIT_ROUNDOFF * (new[0].abs() + range[1].abs() + largest);
        Self::held(ends, control, self.reach + DVec2::new(rounding, 0.0))
    }

    /// The segment with u and v exchanged; `None` if it is a point, as no segment is. Nothing is
    /// rounded.
    pub(super) fn swapped(&self) -> Option<Self> {
        let ends = self.directed_ends().map(DVec2::yx);
        let mut control: Vec<DVec3> = self.control.iter().map(|c| c.yxz()).collect();
        if !self.forward {
            control.reverse();
        }
        Self::held(ends, control, self.reach.yx())
    }

    /// Increases the error bound of the segment by this much.
    pub(super) fn widen(&mut self, by: DVec2) {
        let margin = self.across.abs().dot(by);
        self.reach += by;
        self.band = [self.band[0] - margin, self.band[1] + margin];
    }
}
