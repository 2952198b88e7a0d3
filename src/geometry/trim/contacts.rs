//! Where segments of trim curves come near each other.

use std::ops::Range;

use glam::DVec2;

use super::segment::Segment;
use super::tree::Tree;
use super::{TrimError, UvBox};

/// Pairs of segments whose rectangles meet: of an honest outline each segment has a few.
const MAX_PAIRS: usize = 1 << 20;

/// More parts than this of a pair of segments near each other mean that they touch or run
/// along each other: a crossing leaves a few. They are not cut further then.
const MANY_PARTS: usize = 64;

/// Halvings after which a segment of the magnitude of its rounding is left.
const MOST_LEVELS: usize = 60;

/// A place where two segments come so near each other that they may meet, other than the
/// end they share as neighbours.
#[derive(Clone, Debug)]
pub(super) struct Contact {
    /// The two loops.
    pub(super) loops: [usize; 2],
    /// The two segments.
    pub(super) segments: [usize; 2],
    /// The stretch of each, in its parameter.
    pub(super) stretches: [[f64; 2]; 2],
}

/// All contacts of the segments of these loops.
pub(super) fn contacts(
    segments: &[Segment],
    loops: &[Range<usize>],
    tree: &Tree,
) -> Result<Vec<Contact>, TrimError> {
    let mut found = Vec::new();
    let mut pairs = 0;
    for (this, range) in loops.iter().enumerate() {
        for a in range.clone() {
            let mut meeting = Vec::new();
            let target = segments[a].bounds().grown(segments[a].reach());
            let too_many = tree.any(&target, |b| {
                pairs += usize::from(b > a);
                meeting.extend((b > a).then_some(b));
                pairs > MAX_PAIRS
            });
            if too_many {
                return Err(TrimError::Entangled { limit: MAX_PAIRS });
            }
            for b in meeting {
                let other = loops.partition_point(|range| range.end <= b);
                let joints = joints(segments, range, [a, b]);
                let shared = |stretches: &[[f64; 2]; 2]| {
                    joints.iter().any(|joint| {
                        (0..2).all(|k| stretches[k][0] <= joint[k] && joint[k] <= stretches[k][1])
                    })
                };
                // Two lines that share an end have nothing else in common, or run back.
                let lines = segments[a].is_straight() && segments[b].is_straight();
                if lines && !joints.is_empty() {
                    continue;
                }
                let near = stretches_near([&segments[a], &segments[b]]);
                let own = near.into_iter().filter(|stretches| !shared(stretches));
                found.extend(own.map(|stretches| Contact {
                    loops: [this, other],
                    segments: [a, b],
                    stretches,
                }));
            }
        }
    }
    Ok(found)
}

/// The parameters at which two segments `a < b` of a loop share an end, because one follows
/// the other.
fn joints(segments: &[Segment], range: &Range<usize>, [a, b]: [usize; 2]) -> Vec<[f64; 2]> {
    let first = |index: usize| if segments[index].is_forward() { 0.0 } else { 1.0 };
    let mut joints = Vec::new();
    if b == a + 1 && range.contains(&b) {
        joints.push([1.0 - first(a), first(b)]);
    }
    if a == range.start && b + 1 == range.end {
        joints.push([first(a), 1.0 - first(b)]);
    }
    joints
}

/// Parts of two segments whose rectangles meet.
#[derive(Clone, Copy)]
struct Parts {
    stretches: [[f64; 2]; 2],
    ends: [[DVec2; 2]; 2],
}

impl Parts {
    fn bounds(&self, k: usize) -> UvBox {
        UvBox::around(self.ends[k])
    }

    fn halves(self, pair: [&Segment; 2]) -> [Self; 4] {
        let middle = self.stretches.map(|[from, to]| 0.5 * (from + to));
        let point = [pair[0].at(middle[0]), pair[1].at(middle[1])];
        [[0, 0], [0, 1], [1, 0], [1, 1]].map(|halves: [usize; 2]| {
            let mut part = self;
            for k in 0..2 {
                part.stretches[k][1 - halves[k]] = middle[k];
                part.ends[k][1 - halves[k]] = point[k];
            }
            part
        })
    }
}

/// The stretches of two segments that may meet, those that hang together as one.
///
/// Both are halved again and again, and parts whose rectangles are apart are dropped. The
/// rectangle of a monotone part is that of its ends.
fn stretches_near(pair: [&Segment; 2]) -> Vec<[[f64; 2]; 2]> {
    if are_apart(pair) {
        return Vec::new();
    }
    let reach = pair[0].reach() + pair[1].reach();
    let meet = |part: &Parts| part.bounds(0).grown(reach).meets(&part.bounds(1));
    let fine = |part: &Parts| (0..2).all(|k| part.bounds(k).size().cmple(2.0 * reach).all());
    let mut parts = vec![Parts { stretches: [[0.0, 1.0]; 2], ends: pair.map(Segment::ends) }];
    parts.retain(meet);
    for _ in 0..MOST_LEVELS {
        if parts.is_empty() || parts.len() > MANY_PARTS || parts.iter().all(fine) {
            break;
        }
        parts = parts.into_iter().flat_map(|part| part.halves(pair)).filter(meet).collect();
    }

    // Parts that follow each other along the first segment are one contact.
    parts.sort_by(|a, b| a.stretches[0][0].total_cmp(&b.stretches[0][0]));
    let mut joined: Vec<[[f64; 2]; 2]> = Vec::new();
    for part in parts {
        let [a, b] = part.stretches;
        match joined.last_mut() {
            Some([ja, jb]) if a[0] <= ja[1] => {
                ja[1] = ja[1].max(a[1]);
                *jb = [jb[0].min(b[0]), jb[1].max(b[1])];
            }
            _ => joined.push([a, b]),
        }
    }
    joined
}

/// Whether two lines are clearly apart: one lies on one side of the other.
fn are_apart(pair: [&Segment; 2]) -> bool {
    if !pair.iter().all(|segment| segment.is_straight()) {
        return false;
    }
    let reach = pair[0].reach() + pair[1].reach();
    let beside = |line: &Segment, other: &Segment| {
        let [from, to] = line.ends();
        let along = to - from;
        let sides = other.ends().map(|end| along.perp_dot(end - from));
        let margin = 2.0 * along.abs().dot(DVec2::new(reach.y, reach.x));
        sides.iter().all(|side| *side > margin) || sides.iter().all(|side| *side < -margin)
    };
    beside(pair[0], pair[1]) || beside(pair[1], pair[0])
}
