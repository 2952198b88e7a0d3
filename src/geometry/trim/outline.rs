//! Loops as polylines, for plots.

use glam::{DVec2, DVec3};

use super::curve::euclidean;
use super::segment::Segment;
use super::{TrimError, Trims};
use crate::math::bernstein::restrict;

/// The most points the outlines of all loops may have together.
const MAX_OUTLINE_POINTS: usize = 1 << 20;

impl Trims {
    /// The loops as closed polylines, each beginning and ending at the same point, in the direction
    /// given. A loop that reaches into a periodic domain several times appears several times; none
    /// is cut at the domain's border.
    ///
    /// No point of a curve is farther than `tolerance` from its polyline, with u and v in the same
    /// unit: a part is replaced by its chord once all its control points are that near. The
    /// polyline contains the curves' extremes and the ends of all pieces.
    ///
    /// # Errors
    /// When the tolerance is not positive, or needs more than 2²⁰ points.
    pub fn outlines(&self, tolerance: f64) -> Result<Vec<Vec<DVec2>>, TrimError> {
        let refused = || TrimError::Tolerance { tolerance, limit: MAX_OUTLINE_POINTS };
        let usable = tolerance > 0.0; // false for NaN
        if !usable {
            return Err(refused());
        }
        let mut left = MAX_OUTLINE_POINTS;
        let mut outlines = Vec::new();
        for segments in self.loop_segments() {
            let mut outline = vec![segments[0].directed_ends()[0]];
            for segment in segments {
                let before = outline.len();
                sample(segment, tolerance, left, &mut outline).ok_or_else(refused)?;
                left = left.checked_sub(outline.len() - before).ok_or_else(refused)?;
            }
            outlines.push(outline);
        }
        Ok(outlines)
    }
}

/// Adds the points of a segment after its first; `None` when there are more than `most`.
fn sample(segment: &Segment, tolerance: f64, most: usize, outline: &mut Vec<DVec2>) -> Option<()> {
    let [_, end] = segment.directed_ends();
    let mut control = segment.homogeneous();
    if !segment.is_forward() {
        control.reverse();
    }
    let full = outline.len() + most;
    let mut waiting = vec![control];
    while let Some(part) = waiting.pop() {
        if outline.len() + waiting.len() >= full {
            return None;
        }
        if is_flat(&part, tolerance) {
            outline.push(euclidean(part[part.len() - 1]));
            continue;
        }
        let mut below = part.clone();
        let mut above = part;
        restrict(&mut below, 0.0, 0.5);
        restrict(&mut above, 0.5, 1.0);
        waiting.push(above);
        waiting.push(below);
    }
    if let Some(last) = outline.last_mut() {
        *last = end;
    }
    Some(())
}

/// Whether all control points lie near the chord between the outer two, or the outer two are
/// neighbouring numbers.
fn is_flat(control: &[DVec3], tolerance: f64) -> bool {
    let (from, to) = (euclidean(control[0]), euclidean(control[control.len() - 1]));
    let chord = to - from;
    let finest = 4.0 * f64::EPSILON * from.abs().max(to.abs());
    let near = |&c: &DVec3| {
        let offset = euclidean(c) - from;
        let along = (offset.dot(chord) / chord.length_squared()).clamp(0.0, 1.0);
        let along = if along.is_nan() { 0.0 } else { along };
        (offset - along * chord).length() <= tolerance
    };
    chord.abs().cmple(finest).all() || control.iter().all(near)
}
