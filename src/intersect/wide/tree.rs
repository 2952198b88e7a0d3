//! The hierarchy collapsed into nodes of sixteen children.

use glam::{DVec3, Vec3};

use super::LANES;
use super::record::SearchRecord;
use crate::intersect::hierarchy::{Hierarchy, Node};
use crate::patch::PatchSet;

/// Marks a child that is a leaf: the rest of the number is its index.
const LEAF: u32 = 1 << 31;

/// What a child of a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    Node(u32),
    Leaf(u32),
}

/// Sixteen children's boxes in scaled coordinates, coordinate by coordinate; boxes of
/// children that are not there are empty.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct WideNode {
    pub(super) min: [[f32; LANES]; 3],
    pub(super) max: [[f32; LANES]; 3],
    child: [u32; LANES],
    /// One bit for each child that is there: an empty box is only missed by a test that looks
    /// at it.
    pub(super) filled: u32,
}

impl WideNode {
    fn empty() -> Self {
        Self {
            min: [[f32::INFINITY; LANES]; 3],
            max: [[f32::NEG_INFINITY; LANES]; 3],
            child: [0; LANES],
            filled: 0,
        }
    }

    fn set(&mut self, k: usize, min: Vec3, max: Vec3, child: u32) {
        for axis in 0..3 {
            self.min[axis][k] = min[axis];
            self.max[axis][k] = max[axis];
        }
        self.child[k] = child;
        self.filled |= 1 << k;
    }

    pub(super) fn child(&self, k: usize) -> Child {
        let child = self.child[k];
        if child & LEAF == 0 { Child::Node(child) } else { Child::Leaf(child & !LEAF) }
    }
}

/// The wide hierarchy and the leaves' search records.
#[derive(Clone, Debug)]
pub(in crate::intersect) struct WideTree {
    pub(super) nodes: Vec<WideNode>,
    pub(super) records: Vec<SearchRecord>,
    /// Scaled coordinates: `(P − center) · scale`.
    pub(super) center: DVec3,
    pub(super) scale: f64,
}

impl WideTree {
    pub(in crate::intersect) fn new(set: &PatchSet, hierarchy: &Hierarchy) -> Self {
        let (center, scale) = hierarchy.frame();
        let records = SearchRecord::all(set, hierarchy);
        let mut tree = Self { nodes: Vec::new(), records, center, scale };
        if !hierarchy.nodes().is_empty() {
            tree.collapse(hierarchy);
        }
        tree
    }

    /// Every node takes in the largest of its descendants until it has sixteen children.
    fn collapse(&mut self, hierarchy: &Hierarchy) {
        let binary = hierarchy.nodes();
        self.nodes.push(WideNode::empty());
        let mut waiting = vec![(0u32, 0usize)];
        while let Some((root, place)) = waiting.pop() {
            let mut open = vec![root];
            // A root that is a leaf stays; else the largest inner node is replaced by its two.
            while open.len() < LANES {
                let largest = (0..open.len())
                    .filter(|&k| binary[open[k] as usize].leaves == 0)
                    .max_by(|&a, &b| {
                        let area = |k: usize| half_area(&binary[open[k] as usize]);
                        area(a).total_cmp(&area(b))
                    });
                let Some(k) = largest else { break };
                let first = binary[open[k] as usize].first;
                open[k] = first;
                open.push(first + 1);
            }
            let mut filled = 0;
            for &index in &open {
                let node = &binary[index as usize];
                filled = self.place(hierarchy, node, index, (place, filled), &mut waiting);
            }
        }
    }

    /// Puts a binary node into its wide node; a leaf of several primitives takes several
    /// places, or a node of its own if there is no room.
    fn place(
        &mut self,
        hierarchy: &Hierarchy,
        node: &Node,
        index: u32,
        (place, filled): (usize, usize),
        waiting: &mut Vec<(u32, usize)>,
    ) -> usize {
        if node.leaves == 1 {
            let leaf = hierarchy.order()[node.first as usize];
            self.nodes[place].set(filled, node.min, node.max, leaf | LEAF);
        } else if node.leaves > 1 {
            let leaves = node.first as usize..(node.first + node.leaves) as usize;
            let child = self.crowd(node, &hierarchy.order()[leaves]);
            self.nodes[place].set(filled, node.min, node.max, child);
        } else {
            let child = self.nodes.len();
            self.nodes.push(WideNode::empty());
            waiting.push((index, child));
            self.nodes[place].set(filled, node.min, node.max, child as u32);
        }
        filled + 1
    }

    /// A node over leaves that share one box, and the nodes below it.
    fn crowd(&mut self, node: &Node, leaves: &[u32]) -> u32 {
        let place = self.nodes.len();
        self.nodes.push(WideNode::empty());
        if leaves.len() <= LANES {
            for (k, leaf) in leaves.iter().enumerate() {
                self.nodes[place].set(k, node.min, node.max, leaf | LEAF);
            }
        } else {
            for (k, part) in leaves.chunks(leaves.len().div_ceil(LANES)).enumerate() {
                let child = self.crowd(node, part);
                self.nodes[place].set(k, node.min, node.max, child);
            }
        }
        place as u32
    }

    /// The leaves' search records.
    pub(in crate::intersect) fn records(&self) -> &[SearchRecord] {
        &self.records
    }

    pub(in crate::intersect) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.records[..])
    }
}

fn half_area(node: &Node) -> f32 {
    let size = node.max - node.min;
    size.x * size.y + size.y * size.z + size.z * size.x
}
