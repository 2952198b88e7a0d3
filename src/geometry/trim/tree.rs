//! A hierarchy of rectangles over the segments of all loops.

use glam::DVec2;

use super::UvBox;
use super::segment::Segment;

/// Marks a node that is no segment.
const INNER: u32 = u32::MAX;

/// A chain of segments, or several loops, and the rectangle that contains it.
///
/// Below a loop, a node stands for consecutive segments, halved recursively: curves are continuous,
/// so their order is already a spatial order. A horizontal ray that starts left of the rectangle
/// crosses a chain as often upwards as downwards if both ends of the chain lie on the same side of
/// the ray, else once more in one direction. So only chains near the point are entered. Loops are
/// closed chains.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Node {
    /// Contains the segments, grown by their reach.
    bounds: UvBox,
    /// The v of the two ends of the chain; the same number for loops.
    ends: [f64; 2],
    /// The index of the node that follows the subtree of this one.
    next: u32,
    /// The segment, or [`INNER`].
    segment: u32,
}

/// The nodes in the order of traversal, each before its descendants.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Tree {
    nodes: Vec<Node>,
}

impl Tree {
    /// The hierarchy of loops, each a range of the segments.
    pub(super) fn new(segments: &[Segment], loops: &[std::ops::Range<usize>]) -> Self {
        let mut tree = Self { nodes: Vec::with_capacity(2 * segments.len()) };
        let mut boxed: Vec<(DVec2, std::ops::Range<usize>)> = loops
            .iter()
            .map(|range| {
                let bounds = segments[range.clone()].iter().map(Segment::bounds);
                (bounds.fold(UvBox::EMPTY, UvBox::union).center(), range.clone())
            })
            .collect();
        tree.add_loops(segments, &mut boxed);
        tree
    }

    /// Halves the loops by their centers, along the axis in which these spread widest.
    fn add_loops(&mut self, segments: &[Segment], loops: &mut [(DVec2, std::ops::Range<usize>)]) {
        match loops {
            [] => {}
            [(_, range)] => self.add_chain(segments, range.clone()),
            _ => {
                let spread = UvBox::around(loops.iter().map(|(center, _)| *center)).size();
                let axis = usize::from(spread.y > spread.x);
                loops.sort_by(|(a, _), (b, _)| a[axis].total_cmp(&b[axis]));
                let (first, second) = loops.split_at_mut(loops.len() / 2);
                let place = self.open();
                self.add_loops(segments, first);
                let between = self.nodes.len();
                self.add_loops(segments, second);
                let bounds = self.nodes[place + 1].bounds.union(self.nodes[between].bounds);
                self.close(place, bounds, [0.0; 2]);
            }
        }
    }

    fn add_chain(&mut self, segments: &[Segment], range: std::ops::Range<usize>) {
        let (first, last) = (range.start, range.end - 1);
        let place = self.open();
        if first == last {
            let segment = &segments[first];
            let bounds = segment.bounds().grown(segment.reach());
            self.close(place, bounds, segment.directed_ends().map(|end| end.y));
            self.nodes[place].segment = first as u32;
            return;
        }
        let middle = first + range.len() / 2;
        self.add_chain(segments, first..middle);
        let between = self.nodes.len();
        self.add_chain(segments, middle..range.end);
        let bounds = self.nodes[place + 1].bounds.union(self.nodes[between].bounds);
        let [start, _] = segments[first].directed_ends();
        let [_, end] = segments[last].directed_ends();
        self.close(place, bounds, [start.y, end.y]);
    }

    fn open(&mut self) -> usize {
        self.nodes.push(Node { bounds: UvBox::EMPTY, ends: [0.0; 2], next: 0, segment: INNER });
        self.nodes.len() - 1
    }

    fn close(&mut self, place: usize, bounds: UvBox, ends: [f64; 2]) {
        let next = self.nodes.len() as u32;
        self.nodes[place] = Node { bounds, ends, next, segment: INNER };
    }

    /// The number of times a ray from `point` towards larger u crosses the curves upwards, minus
    /// the number of downward crossings; its parity is that of the number of all crossings.
    /// `crosses` is called for the segments whose grown rectangle meets the target around the
    /// point.
    #[inline]
    pub(super) fn crossings(
        &self,
        point: DVec2,
        target: &UvBox,
        mut crosses: impl FnMut(usize) -> i32,
    ) -> i32 {
        let mut sum = 0;
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            let UvBox { min, max } = node.bounds;
            if target.max.y < min.y || target.min.y > max.y || target.min.x > max.x {
                at = node.next as usize;
            } else if target.max.x < min.x {
                sum += i32::from(node.ends[0] <= point.y) - i32::from(node.ends[1] <= point.y);
                at = node.next as usize;
            } else {
                if node.segment != INNER {
                    sum += crosses(node.segment as usize);
                }
                at += 1;
            }
        }
        sum
    }

    /// Whether `wanted` is true of a segment whose grown rectangle meets the target.
    #[inline]
    pub(super) fn any(&self, target: &UvBox, mut wanted: impl FnMut(usize) -> bool) -> bool {
        let mut at = 0;
        while let Some(node) = self.nodes.get(at) {
            if !node.bounds.meets(target) {
                at = node.next as usize;
                continue;
            }
            if node.segment != INNER && wanted(node.segment as usize) {
                return true;
            }
            at += 1;
        }
        false
    }

    /// The memory taken by the nodes, in bytes.
    pub(super) fn bytes(&self) -> usize {
        std::mem::size_of_val(&*self.nodes)
    }
}
