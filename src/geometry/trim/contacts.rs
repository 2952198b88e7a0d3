//! Where segments of trim curves come near each other.

use std::ops::Range;

use glam::DVec2;

use super::UvBox;
use super::segment::Segment;
use super::tree::Tree;

/// If more than this many parts of two segments are near each other, the segments touch or run
/// along each other: a crossing leaves only a few. The parts are then not halved further.
const MANY_PARTS: usize = 64;

/// What the bounds of two curves' second derivatives cost, in comparisons of parts.
const WORK_FOR_BENDS: usize = 16;

/// The most halvings, after which parts of a segment are as small as its rounding error.
const MOST_LEVELS: usize = 60;

/// A place where two segments come so near each other that they may meet, other than the
/// end they share as neighbours.
#[derive(Clone, Copy, Debug)]
pub(super) struct Contact {
    /// The two loops.
    pub(super) loops: [usize; 2],
    /// The two segments.
    pub(super) segments: [usize; 2],
    /// The stretch of each segment, in its own parameter.
    pub(super) stretches: [[f64; 2]; 2],
}

/// The contacts of segment `a` with later segments, and the number of parts of segments that were
/// compared.
pub(super) fn contacts_after(
    a: usize,
    segments: &[Segment],
    loops: &[Range<usize>],
    tree: &Tree,
) -> (Vec<Contact>, usize) {
    let target = segments[a].bounds().grown(segments[a].reach());
    let mut meeting = Vec::new();
    tree.any(&target, |b| {
        meeting.extend((b > a).then_some(b));
        false
    });

    let owner = |index: usize| loops.partition_point(|range| range.end <= index);
    let this = owner(a);
    let (mut found, mut work) = (Vec::new(), meeting.len());
    for b in meeting {
        let joints = joints(segments, &loops[this], [a, b]);
        let shared = |stretches: &[[f64; 2]; 2]| {
            joints.iter().any(|joint| {
                (0..2).all(|k| stretches[k][0] <= joint[k] && joint[k] <= stretches[k][1])
            })
        };
        if !joints.is_empty() && only_joined([&segments[a], &segments[b]]) {
            continue;
        }
        let near = stretches_near([&segments[a], &segments[b]], &mut work);
        let own = near.into_iter().filter(|stretches| !shared(stretches));
        let loops = [this, owner(b)];
        found.extend(own.map(|stretches| Contact { loops, segments: [a, b], stretches }));
    }
    (found, work)
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

/// Whether two segments that share an end certainly have nothing else in common, unless they run
/// back over each other. This holds for two lines, and for two curves that go on in the same
/// direction in u or in v, so that one ends where the other begins.
fn only_joined(pair: [&Segment; 2]) -> bool {
    let [a, b] = pair.map(Segment::bounds);
    let common = a.max.min(b.max) - a.min.max(b.min);
    let goes_on = |axis: usize| common[axis] <= 0.0 && a.size().min(b.size())[axis] > 0.0;
    pair.iter().all(|segment| segment.is_straight()) || goes_on(0) || goes_on(1)
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

    /// Whether one part clearly lies on one side of the line through the ends of the other, of
    /// which both stray by no more than their second derivatives, bounded by `bends`, allow.
    fn are_beside(&self, bends: [DVec2; 2], reach: DVec2) -> bool {
        // A curve over a stretch of length h is within h²/8 times its second derivative of its
        // chord.
        let stray = |k: usize| {
            let [from, to] = self.stretches[k];
            (to - from) * (to - from) / 8.0 * bends[k]
        };
        let margin = stray(0) + stray(1) + 2.0 * reach;
        (0..2).any(|k| {
            let [from, to] = self.ends[k];
            let across = (to - from).perp();
            let offsets = self.ends[1 - k].map(|end| across.dot(end - from));
            let margin = across.abs().dot(margin);
            offsets.iter().all(|x| *x > margin) || offsets.iter().all(|x| *x < -margin)
        })
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

/// The stretches of two segments that may meet; connected stretches are merged into one.
///
/// Both segments are halved repeatedly, and pairs of parts that are clearly apart are dropped:
/// their rectangles are apart, which for a monotone part is that of its ends, or one part lies
/// beside the line through the ends of the other.
fn stretches_near(pair: [&Segment; 2], work: &mut usize) -> Vec<[[f64; 2]; 2]> {
    let reach = pair[0].reach() + pair[1].reach();
    let whole = Parts { stretches: [[0.0, 1.0]; 2], ends: pair.map(Segment::ends) };
    if !whole.bounds(0).grown(reach).meets(&whole.bounds(1)) {
        return Vec::new();
    }
    *work += WORK_FOR_BENDS;
    let bends = pair.map(Segment::bend);
    let meet = |part: &Parts| {
        part.bounds(0).grown(reach).meets(&part.bounds(1)) && !part.are_beside(bends, reach)
    };
    let fine = |part: &Parts| (0..2).all(|k| part.bounds(k).size().cmple(2.0 * reach).all());
    let mut parts = vec![whole];
    parts.retain(meet);
    for _ in 0..MOST_LEVELS {
        if parts.is_empty() || parts.len() > MANY_PARTS || parts.iter().all(fine) {
            break;
        }
        *work += 4 * parts.len();
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::trim::{Kept, TrimCurve, TrimDomain, TrimLoop, Trims};

    #[test]
    fn second_derivatives_are_within_their_bounds() {
        let cubic = [(0.0, 0.0), (3.0, 0.5), (-1.0, 2.0), (2.0, 3.0)].map(DVec2::from);
        let heavy = [(2.0, 3.0), (0.0, 4.0), (0.0, 0.0)].map(DVec2::from);
        let curves = [
            TrimCurve::bezier(&cubic, None).unwrap(),
            TrimCurve::bezier(&heavy, Some(&[1.0, 8.0, 0.5])).unwrap(),
        ];
        let circle = TrimLoop::circle(DVec2::new(30.0, 7.0), 4.0).unwrap();
        let domain = TrimDomain::new([-99.0, 99.0], [-99.0, 99.0]).unwrap();
        let loops = [circle, TrimLoop::new(&curves).unwrap()];
        let trims = Trims::new(domain, Kept::Odd, &loops).unwrap();
        assert!(trims.segments.len() > 20);
        for segment in &trims.segments {
            let (bend, step) = (segment.bend(), 1e-3);
            let mut largest = DVec2::ZERO;
            for k in 1..1000 {
                let at = |more: f64| segment.free_at((f64::from(k) + more) * step);
                let second = (at(1.0) - 2.0 * at(0.0) + at(-1.0)) / (step * step);
                largest = largest.max(second.abs());
            }
            // Differences are exact to their square, and to rounding.
            assert!(largest.cmple(1.001 * bend + 1e-7).all(), "{largest} {bend}");
            assert!((16.0 * largest).cmpge(bend).any(), "{largest} {bend}");
        }
    }
}
