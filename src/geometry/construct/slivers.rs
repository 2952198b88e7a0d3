//! Removes slivers from paths: pieces too short for their derivatives to mean anything.
//!
//! Two knots that were meant to be one, and differ by rounding, leave a piece between them whose
//! control points are nearly equal. Each is known to a rounding error e of the largest coordinate;
//! on a piece of length L, the direction is then known to e / L, and the curvature only to e / L²:
//! where L is 1e-12 and e is 1e-16, to 1e8. Such a piece must not be differentiated, but nor does
//! its place tell more than its neighbours' do: where one of them, continued by its own polynomial,
//! runs through all of the piece to within rounding, the neighbour takes its place. What a sliver
//! shows clearly, like a corner at each of its ends, is kept.

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::path::{SMOOTH, angle};
use crate::math::bernstein::restrict;
use crate::math::unit;

/// A Bézier piece of a path: its homogeneous control points, and the parameter at which it begins.
#[derive(Clone)]
pub(super) struct Part {
    pub(super) start: f64,
    pub(super) control: Vec<DVec4>,
}

/// A part is a sliver if its control polygon is no longer than this fraction of the path's largest
/// coordinate. The curvature of longer parts is known to (1e-16 / 1e-12) over that coordinate times
/// the square of the degree: far less than any bend for which something folds.
const SHORT: f64 = 1e-6;

/// How far the neighbour may be off a sliver, as a fraction of the path's largest coordinate: the
/// rounding errors of control points that were made by inserting knots, or by composing a curve
/// with a surface. The path is moved by no more than that.
const OFF: f64 = 64.0 * f64::EPSILON;

/// A run of slivers this many times as long as they may be off, or shorter, cannot tell a corner:
/// one of 7° is off a straight line by 1/32 of its length, and so on.
const HIDDEN: f64 = 32.0;

/// The most of its own parameters by which a part is continued. Its end is known to 2ᵖ times the
/// rounding error of its control points then, and usually far better, as slivers are short.
const LONGEST: f64 = 0.5;

/// Newton's steps towards a point of a sliver. Each doubles the digits, and the first one begins
/// within a run of slivers.
const STEPS: usize = 3;

/// The same path with each run of slivers replaced by the continuation of a part beside it, where
/// that is within rounding.
pub(super) fn without_slivers(parts: Vec<Part>, magnitude: f64) -> Vec<Part> {
    let short = |part: &Part| length(&part.control) <= SHORT * magnitude;
    let mut kept: Vec<Part> = Vec::with_capacity(parts.len());
    let mut rest = parts.into_iter().peekable();
    while let Some(part) = rest.next() {
        if !short(&part) {
            kept.push(part);
            continue;
        }
        let mut run = vec![part];
        while let Some(part) = rest.next_if(short) {
            run.push(part);
        }
        let run = Run { parts: run, slack: OFF * magnitude };
        let after = rest.peek_mut();
        if let Some(before) = kept.last_mut()
            && let Some(control) = run.continued(before, after.as_deref())
        {
            before.control = control;
        } else if let Some(after) = after
            && let Some(control) = run.preceded(kept.last(), after)
        {
            *after = Part { start: run.parts[0].start, control };
        } else {
            kept.extend(run.parts);
        }
    }
    kept
}

/// Consecutive slivers.
struct Run {
    parts: Vec<Part>,
    /// The length up to which points are the same.
    slack: f64,
}

impl Run {
    /// The part before the run continued to its end.
    fn continued(&self, before: &Part, after: Option<&Part>) -> Option<Vec<DVec4>> {
        let last = &self.parts[self.parts.len() - 1].control;
        let control = self.through(&before.control, last[last.len() - 1])?;
        after.is_none_or(|after| self.goes_on(&control, &after.control)).then_some(control)
    }

    /// The part after the run continued backwards to its beginning.
    fn preceded(&self, before: Option<&Part>, after: &Part) -> Option<Vec<DVec4>> {
        let mut control = after.control.clone();
        control.reverse();
        let mut control = self.through(&control, self.parts[0].control[0])?;
        control.reverse();
        before.is_none_or(|before| self.goes_on(&before.control, &control)).then_some(control)
    }

    /// A part continued to a point, the far end of the run, if it passes all of the run.
    fn through(&self, control: &[DVec4], to: DVec4) -> Option<Vec<DVec4>> {
        let p = control.len() - 1;
        let passes = |target: DVec3| {
            let longer = continued(control, target)?;
            (place(longer[p]).distance(target) <= self.slack).then_some(longer)
        };
        for part in &self.parts {
            // As many places as determine a polynomial of the degree p.
            for k in 0..=p {
                let mut so_far = part.control.clone();
                restrict(&mut so_far, 0.0, k as f64 / p as f64);
                passes(place(so_far[p]))?;
            }
        }
        let mut longer = passes(place(to))?;
        longer[p] = (place(to) * longer[p].w).extend(longer[p].w);
        Some(longer)
    }

    /// Whether two parts that are to meet in place of the run do so without a corner, or with one
    /// that the run was too short to tell.
    fn goes_on(&self, before: &[DVec4], after: &[DVec4]) -> bool {
        let length: f64 = self.parts.iter().map(|part| length(&part.control)).sum();
        let backwards = self.direction(before.iter().rev());
        let forwards = self.direction(after.iter());
        let turn = backwards.zip(forwards).map(|(back, on)| angle(-back, on));
        length <= HIDDEN * self.slack || turn.is_some_and(|turn| turn <= SMOOTH)
    }

    /// The direction in which the first of these control points is left.
    fn direction<'a>(&self, mut points: impl Iterator<Item = &'a DVec4>) -> Option<DVec3> {
        let from = place(*points.next()?);
        let away = points.map(|point| place(*point) - from);
        away.filter(|vector| vector.length() > self.slack).find_map(unit)
    }
}

/// A part continued to where it is nearest to a point, if that is close to its end.
fn continued(control: &[DVec4], target: DVec3) -> Option<Vec<DVec4>> {
    let p = control.len() - 1;
    let mut reached = 1.0;
    let mut longer = control.to_vec();
    for _ in 0..STEPS {
        let [leg, end] = [longer[p - 1], longer[p]];
        // The derivative with respect to the share of what is there so far.
        let speed = (place(end) - place(leg)) * (leg.w / end.w * p as f64);
        let ahead = target - place(end);
        reached *= 1.0 + ahead.dot(speed) / speed.length_squared();
        let within = (1.0 - LONGEST..=1.0 + LONGEST).contains(&reached); // false for NaN
        if !within {
            return None;
        }
        longer.copy_from_slice(control);
        restrict(&mut longer, 0.0, reached);
    }
    Some(longer)
}

fn place(control: DVec4) -> DVec3 {
    control.xyz() / control.w
}

/// The length of a control polygon.
fn length(control: &[DVec4]) -> f64 {
    control.windows(2).map(|pair| place(pair[0]).distance(place(pair[1]))).sum()
}
