//! Straight lines that overlap, joined.

use glam::DVec3;

use crate::math::unit;

/// Joins segments that overlap along a line. Returns what each segment becomes: the first of the
/// joined segments becomes all of them, the others `None`. Segments that only touch, or cross, are
/// unchanged.
///
/// Two segments are on one line if the ends of the shorter are no farther than `tolerance` from the
/// line of the longer, and overlap if they have more than four times that length in common.
/// Segments are sorted by a number that is the same for all segments of a line, so that none is
/// compared with many others.
pub(super) fn united(segments: &[[DVec3; 2]], tolerance: f64) -> Vec<Option<[DVec3; 2]>> {
    let mut united: Vec<Option<[DVec3; 2]>> = segments.iter().copied().map(Some).collect();
    let points = || segments.iter().flatten();
    let (low, high) = points()
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(low, high), &p| (low.min(p), high.max(p)));
    let frame = Frame { middle: 0.5 * low + 0.5 * high, size: (high - low).max_element() };
    let mut lines: Vec<Line> = (0..segments.len())
        .filter_map(|index| Line::of(index, &segments[index], &frame, tolerance))
        .collect();

    // Group those that may lie on one line into rows.
    lines.sort_by(|a, b| a.range[0].total_cmp(&b.range[0]).then(a.index.cmp(&b.index)));
    let mut rest = &lines[..];
    while let Some(first) = rest.first() {
        let mut reached = first.range[1];
        let count = rest
            .iter()
            .take_while(|line| {
                let together = line.range[0] <= reached;
                reached = reached.max(line.range[1]);
                together
            })
            .count();
        let (row, others) = rest.split_at(count);
        unite_row(row, segments, tolerance, &mut united);
        rest = others;
    }
    united
}

/// The reference frame for the numbers of lines: the box around all segments.
struct Frame {
    middle: DVec3,
    size: f64,
}

/// A segment as part of a line.
#[derive(Clone, Copy)]
struct Line {
    index: usize,
    length: f64,
    /// The interval that contains the number of its line.
    range: [f64; 2],
}

/// The factors of a line's six coordinates in its number: no integers or roots of integers, so that
/// the lines of usual figures have different numbers.
const MIXED: [DVec3; 2] =
    [DVec3::new(0.7390851, 0.4142879, 0.5671433), DVec3::new(0.2614972, 0.9159656, 0.3275823)];

/// A segment whose line is known less accurately than this, in direction and relative to the box,
/// is left alone: it is no longer than 8 / `VAGUE` tolerances, and many would be compared with
/// many.
const VAGUE: f64 = 1e-4;

impl Line {
    fn of(index: usize, &[a, b]: &[DVec3; 2], frame: &Frame, tolerance: f64) -> Option<Self> {
        let length = a.distance(b);
        let along = unit(b - a)?;
        let from = a - frame.middle;
        let foot = (from - from.dot(along) * along) / frame.size;
        // The number does not depend on the direction of the segment.
        let number = MIXED[0].dot(along).abs() + MIXED[1].dot(foot);
        // Ends that are off by the tolerance turn the direction by twice the tolerance over the
        // length, and move the foot, which may be as far away as the box reaches.
        let doubt = 8.0 * tolerance / length;
        let clear = doubt <= VAGUE; // false for NaN
        clear.then_some(Self { index, length, range: [number - doubt, number + doubt] })
    }
}

/// Joins those segments of a row that overlap on one line, line by line.
fn unite_row(
    row: &[Line],
    segments: &[[DVec3; 2]],
    tolerance: f64,
    united: &mut [Option<[DVec3; 2]>],
) {
    let mut rest = row.to_vec();
    rest.sort_by(|a, b| b.length.total_cmp(&a.length).then(a.index.cmp(&b.index)));
    while rest.len() > 1 {
        // The longest segment determines the line most accurately.
        let [start, end] = segments[rest[0].index];
        let along = (end - start) / rest[0].length;
        let away = |point: DVec3| (point - start).reject_from_normalized(along).length();
        let on_it = |line: &Line| segments[line.index].iter().all(|&p| away(p) <= tolerance);
        let (same, others): (Vec<Line>, Vec<Line>) = rest.iter().partition(|line| on_it(line));
        let mut stretches: Vec<Stretch> = same
            .iter()
            .map(|line| {
                let [a, b] = segments[line.index].map(|point| (along.dot(point - start), point));
                let [from, to] = if a.0 <= b.0 { [a, b] } else { [b, a] };
                Stretch { index: line.index, from, to }
            })
            .collect();
        stretches.sort_by(|a, b| a.from.0.total_cmp(&b.from.0).then(a.index.cmp(&b.index)));
        let mut whole = stretches[0];
        for &next in &stretches[1..] {
            let common = whole.to.0.min(next.to.0) - next.from.0;
            if common <= 4.0 * tolerance {
                whole = next;
                continue;
            }
            united[whole.index.max(next.index)] = None;
            whole.index = whole.index.min(next.index);
            whole.to = if next.to.0 > whole.to.0 { next.to } else { whole.to };
            united[whole.index] = Some([whole.from.1, whole.to.1]);
        }
        rest = others;
    }
}

/// A segment along a line: its ends, each with its position along the line.
#[derive(Clone, Copy)]
struct Stretch {
    index: usize,
    from: (f64, DVec3),
    to: (f64, DVec3),
}
