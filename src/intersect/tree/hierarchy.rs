//! The binary hierarchy that the tree is made from: built by obvhs.
//!
//! Boxes are in scaled coordinates, so that no fixed length inside the builder matters. Traps of
//! obvhs 0.4 that are avoided here, each with a test: its traversals clamp directions, ignore
//! `t_min`, cull before `t = 1e-4` and lose axis-parallel rays in a box's face, so only its
//! builder is used; equal boxes form a chain in the tree, so they become one primitive; boxes that
//! are alike and evenly spaced take it the square of their number, so it gets them
//! [unevenly](uneven) grown; its leaves hold slots, not indices.

use std::ops::Range;

use glam::Vec3A;
use obvhs::aabb::Aabb as BuilderBox;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use rayon::prelude::*;

use crate::patch::ScaledBox;

/// In trees over more primitives than this, only the worst nodes are reinserted: reinsertion is
/// slow, and gains little where boxes are many, small and alike.
const MANY: usize = 1 << 17;

/// A node: its box and what is in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct BinaryNode {
    pub(super) bounds: ScaledBox,
    /// The first of two children, or the first of the leaves in [`Hierarchy::order`].
    pub(super) first: u32,
    /// The number of leaves; 0 for an inner node.
    pub(super) leaves: u32,
}

/// A binary tree of boxes.
#[derive(Clone, Debug, Default)]
pub(super) struct Hierarchy {
    /// The root first; empty if there are no leaves.
    pub(super) nodes: Vec<BinaryNode>,
    /// Leaf indices; those of a group, and of groups with the same box, are side by side.
    pub(super) order: Vec<u32>,
}

impl Hierarchy {
    /// The tree over leaves with the given boxes. `groups` are the sizes of the runs of leaves that
    /// are to be kept together: each is at least 1, their sum is the number of leaves.
    pub(super) fn new(leaves: &[ScaledBox], groups: &[u32]) -> Self {
        if leaves.is_empty() {
            return Self::default();
        }
        let mut end = 0;
        let members = groups.iter().map(|&count| {
            end += count;
            end - count..end
        });
        let members: Vec<Range<u32>> = members.collect();
        debug_assert!(end as usize == leaves.len() && !groups.contains(&0));
        let group_boxes: Vec<ScaledBox> = members
            .par_iter()
            .map(|members| ScaledBox::around(&leaves[as_indices(members)]))
            .collect();
        // Groups with equal boxes become one primitive.
        let mut keyed: Vec<(u64, u32)> = group_boxes
            .par_iter()
            .zip(0..groups.len() as u32)
            .map(|(b, k)| (sort_key(b), k))
            .collect();
        keyed.par_sort_unstable();
        for alike in keyed.chunk_by_mut(|a, b| a.0 == b.0).filter(|alike| alike.len() > 1) {
            alike.sort_unstable_by_key(|&(_, k)| (rest_of_key(&group_boxes[k as usize]), k));
        }
        let mut order: Vec<u32> = Vec::with_capacity(leaves.len());
        let mut primitives: Vec<Range<u32>> = Vec::with_capacity(keyed.len());
        let mut primitive_boxes: Vec<&ScaledBox> = Vec::with_capacity(keyed.len());
        for (_, k) in keyed {
            let from = order.len() as u32;
            order.extend(members[k as usize].clone());
            let (bounds, to) = (&group_boxes[k as usize], order.len() as u32);
            match (primitives.last_mut(), primitive_boxes.last()) {
                (Some(primitive), Some(&last)) if last == bounds => primitive.end = to,
                _ => {
                    primitives.push(from..to);
                    primitive_boxes.push(bounds);
                }
            }
        }
        let boxes: Vec<BuilderBox> = primitive_boxes
            .iter()
            .map(|b| BuilderBox::new(Vec3A::from(b.min), Vec3A::from(b.max)))
            .collect();
        Self { nodes: build(&boxes, &primitives), order }
    }

    /// The sum of a quantity over the leaves below each node; `of` returns it for the leaves of one
    /// node.
    pub(super) fn totals<T: Copy + Default + std::ops::Add<Output = T>>(
        &self,
        of: impl Fn(&[u32]) -> T,
    ) -> Vec<T> {
        let nodes = &self.nodes;
        let mut totals = vec![T::default(); nodes.len()];
        for &index in parents_first(nodes).iter().rev() {
            let node = &nodes[index as usize];
            let first = node.first as usize;
            totals[index as usize] = if node.leaves == 0 {
                totals[first] + totals[first + 1]
            } else {
                of(&self.order[first..first + node.leaves as usize])
            };
        }
        totals
    }

    /// The leaves below a node.
    pub(super) fn leaves_below(&self, node: u32) -> Vec<u32> {
        let (mut leaves, mut waiting) = (Vec::new(), vec![node]);
        while let Some(index) = waiting.pop() {
            let node = &self.nodes[index as usize];
            let first = node.first as usize;
            if node.leaves == 0 {
                waiting.extend([node.first, node.first + 1]);
            } else {
                leaves.extend_from_slice(&self.order[first..first + node.leaves as usize]);
            }
        }
        leaves
    }
}

fn as_indices(range: &Range<u32>) -> Range<usize> {
    range.start as usize..range.end as usize
}

/// The tree over primitives: PLOC, then reinsertion, one primitive to a leaf.
fn build(boxes: &[BuilderBox], primitives: &[Range<u32>]) -> Vec<BinaryNode> {
    let indices = (0..boxes.len() as u32).collect();
    let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        &uneven(boxes),
        indices,
        SortPrecision::U64,
        0,
    );
    let passes = if boxes.len() > MANY { Some(vec![1.0 / 3.0]) } else { None };
    ReinsertionOptimizer::default().run(&mut tree, 0.15, passes);
    let node = |node: &obvhs::bvh2::node::Bvh2Node| {
        if node.is_leaf() {
            // A leaf's index is a slot in the builder's own order.
            let slot = tree.primitive_indices[node.first_index as usize] as usize;
            let (bounds, range) = (as_scaled(&boxes[slot]), &primitives[slot]);
            BinaryNode { bounds, first: range.start, leaves: range.len() as u32 }
        } else {
            BinaryNode { bounds: as_scaled(node.aabb()), first: node.first_index, leaves: 0 }
        }
    };
    let mut nodes: Vec<BinaryNode> = tree.nodes.iter().map(node).collect();
    tighten(&mut nodes);
    nodes
}

/// The boxes, each a little larger, neighbours by different fractions.
///
/// The builder merges pairs of boxes that are each other's best. Of boxes that are alike and evenly
/// spaced, as in a row, every one would prefer the neighbour on the same side, and each pass would
/// merge one pair only.
fn uneven(boxes: &[BuilderBox]) -> Vec<BuilderBox> {
    let grown = |(k, b): (usize, &BuilderBox)| {
        // Fibonacci hashing (Knuth 1998, section 6.4): neighbours get fractions that are far apart.
        let fraction = (k as u32).wrapping_mul(0x9E37_79B9) as f32 * f32::powi(2.0, -32);
        let rounding = b.min.abs().max(b.max.abs()) * (UNEVEN_UNITS * f32::EPSILON);
        BuilderBox::new(b.min, b.max + fraction * (UNEVEN * (b.max - b.min) + rounding))
    };
    boxes.iter().enumerate().map(grown).collect()
}

/// The fraction of its size by which a box is grown at most: little enough to leave all other
/// decisions as they are.
const UNEVEN: f32 = 1.0 / 65536.0;

/// The units in the last place of its coordinates by which a box is grown at most, in addition.
const UNEVEN_UNITS: f32 = 4.0;

/// Makes all boxes of inner nodes those around their children's.
fn tighten(nodes: &mut [BinaryNode]) {
    for &index in parents_first(nodes).iter().rev() {
        let BinaryNode { first, leaves, .. } = nodes[index as usize];
        if leaves == 0 {
            let children = [0, 1].map(|k| nodes[first as usize + k].bounds);
            nodes[index as usize].bounds = ScaledBox::around(&children);
        }
    }
}

/// The numbers of all nodes, each before those below it.
fn parents_first(nodes: &[BinaryNode]) -> Vec<u32> {
    let mut found = Vec::with_capacity(nodes.len());
    let mut waiting: Vec<u32> = (!nodes.is_empty()).then_some(0).into_iter().collect();
    while let Some(index) = waiting.pop() {
        found.push(index);
        let node = &nodes[index as usize];
        if node.leaves == 0 {
            waiting.extend([node.first, node.first + 1]);
        }
    }
    found
}

fn as_scaled(b: &BuilderBox) -> ScaledBox {
    ScaledBox { min: b.min.into(), max: b.max.into() }
}

/// The first part of a key that sorts equal boxes next to each other; [`rest_of_key`] is the rest.
fn sort_key(b: &ScaledBox) -> u64 {
    u64::from(ordered_bits(b.min.x)) << 32 | u64::from(ordered_bits(b.min.y))
}

fn rest_of_key(b: &ScaledBox) -> [u32; 4] {
    [b.min.z, b.max.x, b.max.y, b.max.z].map(ordered_bits)
}

/// The bits of a number, the same for both zeros.
fn ordered_bits(x: f32) -> u32 {
    (x + 0.0).to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The number of pairs that one pass of PLOC merges: of boxes that are each other's best among
    /// a few neighbours, by the area of what holds both; the last of equally good ones is the best.
    fn merged_at_once(boxes: &[BuilderBox]) -> usize {
        let best = |k: usize| {
            let area = |other: usize| boxes[k].union(&boxes[other]).half_area();
            let neighbours = k.saturating_sub(14)..(k + 15).min(boxes.len());
            let others = neighbours.filter(|&other| other != k);
            others.rev().min_by(|&a, &b| area(a).total_cmp(&area(b))).unwrap()
        };
        let bests: Vec<usize> = (0..boxes.len()).map(best).collect();
        (0..boxes.len()).filter(|&k| bests[bests[k]] == k).count() / 2
    }

    /// A row of cubes, and a stack of sheets so thin that f32 does not tell the areas of pairs
    /// apart.
    #[test]
    fn many_pairs_of_a_row_are_merged_at_once() {
        let count = 4000u16;
        let at = |k: u16, step: f32, size: Vec3A| {
            let min = step * f32::from(k) * Vec3A::X;
            BuilderBox::new(min, min + size)
        };
        let row: Vec<_> = (0..count).map(|k| at(k, 2.0, Vec3A::ONE)).collect();
        let stack: Vec<_> =
            (0..count).map(|k| at(k, f32::powi(2.0, -20), Vec3A::new(0.0, 1.0, 1.0))).collect();
        for boxes in [row, stack] {
            assert!(merged_at_once(&boxes) < 10, "uneven boxes are not needed any more");
            let merged = merged_at_once(&uneven(&boxes));
            assert!(merged > 300, "{merged}");
            let primitives: Vec<Range<u32>> = (0..u32::from(count)).map(|k| k..k + 1).collect();
            let nodes = build(&boxes, &primitives);
            // No bounds are grown.
            for node in &nodes {
                let first = node.first as usize;
                let expected = match node.leaves {
                    0 => ScaledBox::around(&[nodes[first].bounds, nodes[first + 1].bounds]),
                    _ => as_scaled(&boxes[first]),
                };
                assert_eq!(node.bounds, expected);
            }
        }
    }
}
