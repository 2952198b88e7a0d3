//! Small lobes: what a loop runs around where it crosses itself close to a joint of its curves.

use std::ops::Range;

use glam::DVec2;

use super::UvBox;
use super::contacts::Contact;
use super::segment::Segment;

/// A loop may cross itself close to a joint of its curves if what it runs around there is no larger
/// than a square of this side, relative to the loop's extent in u and in v. It may also run on by
/// no more than this and back over itself.
///
/// In CAD files, two curves that are tangent where they join may cross again beside the joint,
/// because each is fitted by itself: at up to 10⁻⁵ of the extent in the files that were seen. The
/// lobe counts by the even–odd rule like all else. For a loop drawn a thousand pixels wide, it
/// covers a hundredth of a pixel.
pub const LOBE_TOLERANCE: f64 = 1e-4;

/// How far a lobe may reach, relative to the loop's extent, though it be narrow.
const LONGEST: f64 = 1e-2;

/// The most segments that a lobe may have. It bounds the work for loops of very many points, each
/// of which has others close by.
const MOST_SEGMENTS: usize = 64;

/// Parts of a segment by which the area of a lobe is measured: a segment is flat.
const PARTS: usize = 8;

/// The small lobes of a loop, as separate ranges of its places, in order: a place is the index of
/// the segment plus the fraction of it that the loop has run through.
#[derive(Default)]
pub(super) struct Lobes {
    ranges: Vec<[f64; 2]>,
}

impl Lobes {
    /// The lobes that begin and end at contacts of a loop with itself.
    pub(super) fn between<'a>(
        contacts: impl Iterator<Item = &'a Contact>,
        segments: &[Segment],
        range: &Range<usize>,
    ) -> Self {
        let size = segments[range.clone()].iter().map(Segment::bounds);
        let size = size.fold(UvBox::EMPTY, UvBox::union).size();
        let mut ranges = Vec::new();
        for contact in contacts {
            let [a, b] = [0, 1].map(|k| {
                let index = contact.segments[k];
                (index, segments[index].directed(contact.stretches[k]))
            });
            for [(first, [from, _]), (last, [_, to])] in [[a, b], [b, a]] {
                let count = (last + range.len() - first) % range.len();
                let follow = |k: usize| range.start + (first - range.start + k) % range.len();
                let path = (0..=count).map(|k| {
                    let ends = [if k == 0 { from } else { 0.0 }, if k == count { to } else { 1.0 }];
                    (&segments[follow(k)], ends)
                });
                if count > MOST_SEGMENTS || !is_small(path, size) {
                    continue;
                }
                let (from, to) = (first as f64 + from, last as f64 + to);
                if first <= last {
                    ranges.push([from, to]);
                } else {
                    ranges.extend([[from, range.end as f64], [range.start as f64, to]]);
                }
            }
        }
        ranges.sort_by(|a: &[f64; 2], b| a[0].total_cmp(&b[0]));
        ranges.dedup_by(|next, before| {
            let overlap = next[0] <= before[1];
            if overlap {
                before[1] = before[1].max(next[1]);
            }
            overlap
        });
        Self { ranges }
    }

    /// Whether a place is on one of the lobes.
    pub(super) fn hold(&self, place: f64) -> bool {
        let before = self.ranges.partition_point(|range| range[0] <= place);
        self.ranges[..before].last().is_some_and(|range| place <= range[1])
    }
}

/// Whether a path along stretches of segments, which ends about where it begins, runs around little
/// of a loop of this size: no more than the triangles between its beginning and its parts.
fn is_small<'a>(path: impl Iterator<Item = (&'a Segment, [f64; 2])>, size: DVec2) -> bool {
    let (mut start, mut before, mut area) = (None, DVec2::ZERO, 0.0);
    for (segment, [from, to]) in path {
        for k in 0..=PARTS {
            let along = from + k as f64 / PARTS as f64 * (to - from);
            let point = segment.directed_at(along) / size;
            let off = point - *start.get_or_insert(point);
            area += 0.5 * before.perp_dot(off).abs();
            before = off;
            let is_small = off.abs().max_element() <= LONGEST && area <= LOBE_TOLERANCE.powi(2);
            if !is_small {
                return false; // also for NaN
            }
        }
    }
    true
}
