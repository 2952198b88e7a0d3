//! Sides of loops that run to and fro along lines across a periodic direction, as along a seam.

use glam::DVec2;

use super::segment::Segment;
use super::trim_loop::NEAR_SEAM;
use super::{SEAM_TOLERANCE, TrimDomain};
use crate::geometry::Direction;

/// What sides of loops cover of the lines across the periodic directions. Lines a period apart are
/// one, as both are the same curve in space.
///
/// Where two sides lie upon each other and run in opposite directions, both sides of the line are
/// alike: both kept, or both cut off. A loop's shifted copies run in the same direction and do not
/// count as the other side.
pub(super) struct SeamSides {
    domain: TrimDomain,
    /// Lines of constant u, and of constant v, in order.
    lines: [Vec<Line>; 2],
    /// How far apart rounding puts sides on one line, in u and in v.
    slack: DVec2,
}

/// A line of constant parameter on which sides of loops lie.
struct Line {
    /// The smallest and the largest place of such a side: its parameter, less whole periods.
    at: [f64; 2],
    /// The ranges of the other parameter that sides running backwards, and forwards, cover: apart
    /// from each other, in order.
    covered: [Vec<[f64; 2]>; 2],
}

/// The parts of a segment whose two sides are alike.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Alike {
    /// The parameter that varies along the segment.
    along: Direction,
    /// Ranges of this parameter, in order.
    ranges: Vec<[f64; 2]>,
}

impl Alike {
    const NOTHING: Self = Self { along: Direction::U, ranges: Vec::new() };

    /// The values of a parameter at which such parts begin or end.
    pub(super) fn ends(&self, axis: Direction) -> &[f64] {
        if axis == self.along { self.ranges.as_flattened() } else { &[] }
    }

    /// Whether a point of the segment lies on such a part.
    pub(super) fn hold(&self, point: DVec2) -> bool {
        let at = point[self.along];
        self.ranges.iter().any(|[from, to]| (from..=to).contains(&&at))
    }
}

impl SeamSides {
    /// The sides among these segments.
    pub(super) fn new(domain: TrimDomain, segments: &[Segment]) -> Self {
        let periods = domain.bounds().size();
        let mut all = Self { domain, lines: [Vec::new(), Vec::new()], slack: DVec2::ZERO };
        for axis in Direction::BOTH {
            let across = segments.iter().filter(|segment| all.across(segment) == Some(axis));
            let across: Vec<&Segment> = across.collect();
            let largest = across.iter().map(|one| one.ends()[0][axis].abs()).fold(0.0, f64::max);
            all.slack[axis] = 8.0 * f64::EPSILON * (largest + periods[axis]);

            let place = |one: &Segment| all.place(axis, one.ends()[0][axis]);
            let mut sides: Vec<(f64, &Segment)> =
                across.into_iter().map(|one| (place(one), one)).collect();
            sides.sort_by(|a, b| a.0.total_cmp(&b.0));
            let lines = sides.chunk_by(|a, b| b.0 - a.0 <= all.slack[axis]).map(|sides| {
                let covered = [false, true].map(|forward| {
                    let those = sides.iter().filter(|(_, one)| one.is_forward() == forward);
                    joined(those.map(|(_, one)| one.ends().map(|end| end[axis.other()])).collect())
                });
                Line { at: [sides[0].0, sides[sides.len() - 1].0], covered }
            });
            all.lines[axis] = lines.collect();
        }
        all
    }

    /// The parts of one of the segments, of a loop of this extent, whose two sides are alike.
    ///
    /// Ends of sides that differ by no more than those of a side and its seam may agree: CAD files
    /// fit both sides separately.
    pub(super) fn alike(&self, segment: &Segment, size: DVec2) -> Alike {
        let Some(axis) = self.across(segment) else { return Alike::NOTHING };
        let along = axis.other();
        let place = self.place(axis, segment.ends()[0][axis]);
        let index = self.lines[axis].partition_point(|line| line.at[1] < place);
        let Some(line) = self.lines[axis].get(index) else { return Alike::NOTHING };
        let other = &line.covered[usize::from(!segment.is_forward())];

        let length = self.domain.bounds().size()[along];
        let tolerance = (SEAM_TOLERANCE * length).min(NEAR_SEAM * size[along]);
        let [low, high] = segment.ends().map(|end| end[along]);
        let first = other.partition_point(|range| range[1] < low - tolerance);
        let near = other[first..].iter().take_while(|range| range[0] <= high + tolerance);
        let mut ranges: Vec<[f64; 2]> = Vec::new();
        for &[from, to] in near {
            let from = if from - low <= tolerance { low } else { from };
            let to = if high - to <= tolerance { high } else { to };
            match ranges.last_mut() {
                Some(last) if from - last[1] <= tolerance => last[1] = to,
                _ => ranges.push([from, to]),
            }
        }
        // A side that only touches another one end to end is not beside it.
        ranges.retain(|&[from, to]| to - from > tolerance || [from, to] == [low, high]);
        Alike { along, ranges }
    }

    /// The periodic direction across which a segment runs, at one parameter.
    fn across(&self, segment: &Segment) -> Option<Direction> {
        let [from, to] = segment.ends();
        let runs_across = |axis: &Direction| from[*axis] == to[*axis];
        Direction::BOTH.into_iter().filter(|axis| self.domain.is_periodic(*axis)).find(runs_across)
    }

    /// A parameter less whole periods: from 0, or just below it, to just below one period.
    fn place(&self, axis: Direction, at: f64) -> f64 {
        let [start, end] = self.domain.range()[axis];
        let period = end - start;
        let place = (at - start).rem_euclid(period);
        if period - place <= self.slack[axis] { place - period } else { place }
    }
}

/// The union of ranges, as separate ones in order.
fn joined(mut ranges: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    ranges.sort_by(|a, b| a[0].total_cmp(&b[0]));
    ranges.dedup_by(|next, before| {
        let is_joined = next[0] <= before[1];
        if is_joined {
            before[1] = before[1].max(next[1]);
        }
        is_joined
    });
    ranges
}
