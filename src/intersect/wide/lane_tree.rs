//! The hierarchy as one ray goes through it: sixteen boxes at a time, down to the leaves.

use super::LANES;
use super::record::SearchRecord;
use crate::intersect::hierarchy::{Hierarchy, Node};

/// Marks a child that is a block of leaves: the rest of the number is its index.
const BLOCK: u32 = 1 << 31;

/// What a child of a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Child {
    Node(u32),
    Block(u32),
}

/// A child as a number: a node's index, or a block's with [`BLOCK`] set.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct ChildCode(u32);

impl ChildCode {
    pub(super) fn child(self) -> Child {
        if self.0 & BLOCK == 0 { Child::Node(self.0) } else { Child::Block(self.0 & !BLOCK) }
    }
}

/// Sixteen children's axis-parallel boxes in scaled coordinates.
///
/// Boxes of children that are not there lie from +∞ to −∞: with the nearer plane chosen by
/// the sign of the direction, every ray enters them after it has left them.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct LaneNode {
    /// The lower and the upper planes of the first coordinate, of the second, of the third.
    pub(super) planes: [[f32; LANES]; 6],
    pub(super) child: [ChildCode; LANES],
}

/// Up to sixteen leaves' oriented boxes, in the form of [`SearchRecord::rows`].
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct LeafBlock {
    /// Four numbers for each of three rows.
    pub(super) rows: [[f32; LANES]; 12],
    pub(super) leaf: [u32; LANES],
    /// One bit for each leaf that is there.
    pub(super) filled: u32,
}

/// Nodes over blocks of leaves.
#[derive(Clone, Debug, Default)]
pub(in crate::intersect) struct LaneTree {
    pub(super) nodes: Vec<LaneNode>,
    pub(super) blocks: Vec<LeafBlock>,
    /// Where every ray begins; nowhere if there are no leaves.
    pub(super) root: Option<ChildCode>,
}

impl LaneTree {
    pub(in crate::intersect) fn new(hierarchy: &Hierarchy, records: &[SearchRecord]) -> Self {
        let mut tree = Self::default();
        if hierarchy.nodes().is_empty() {
            return tree;
        }
        let mut collapse = Collapse::new(hierarchy, records, &mut tree);
        let root = collapse.child(0);
        collapse.descend();
        tree.root = Some(root);
        tree
    }

    pub(in crate::intersect) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..])
    }
}

/// A binary hierarchy on the way to become a wide one.
struct Collapse<'a> {
    hierarchy: &'a Hierarchy,
    records: &'a [SearchRecord],
    /// The number of leaves below each binary node.
    below: Vec<u32>,
    tree: &'a mut LaneTree,
    /// Binary nodes to be opened, and the wide nodes they become.
    waiting: Vec<(u32, usize)>,
}

impl<'a> Collapse<'a> {
    fn new(hierarchy: &'a Hierarchy, records: &'a [SearchRecord], tree: &'a mut LaneTree) -> Self {
        let below = leaves_below(hierarchy.nodes());
        Self { hierarchy, records, below, tree, waiting: Vec::new() }
    }

    /// What a binary node becomes: a block if its leaves fit into one, else a node.
    fn child(&mut self, index: u32) -> ChildCode {
        let node = self.hierarchy.nodes()[index as usize];
        if self.below[index as usize] as usize <= LANES {
            let leaves = self.leaves(index);
            self.block(&leaves)
        } else if node.leaves > 0 {
            let leaves = self.leaves(index);
            self.crowd(&node, &leaves)
        } else {
            self.waiting.push((index, self.tree.nodes.len()));
            self.node()
        }
    }

    /// Every node takes in the largest of its descendants until it has sixteen children.
    fn descend(&mut self) {
        let binary = self.hierarchy.nodes();
        while let Some((root, place)) = self.waiting.pop() {
            let mut open = vec![root];
            while open.len() < LANES {
                let inner = |&k: &usize| {
                    let index = open[k] as usize;
                    binary[index].leaves == 0 && self.below[index] as usize > LANES
                };
                let largest = (0..open.len()).filter(inner).max_by(|&a, &b| {
                    let area = |k: usize| half_area(&binary[open[k] as usize]);
                    area(a).total_cmp(&area(b))
                });
                let Some(k) = largest else { break };
                let first = binary[open[k] as usize].first;
                open[k] = first;
                open.push(first + 1);
            }
            for (k, &index) in open.iter().enumerate() {
                let child = self.child(index);
                self.tree.nodes[place].set(k, &binary[index as usize], child);
            }
        }
    }

    /// All leaves below a binary node.
    fn leaves(&self, index: u32) -> Vec<u32> {
        let (nodes, order) = (self.hierarchy.nodes(), self.hierarchy.order());
        let mut leaves = Vec::new();
        let mut waiting = vec![index];
        while let Some(index) = waiting.pop() {
            let node = &nodes[index as usize];
            if node.leaves > 0 {
                let range = node.first as usize..(node.first + node.leaves) as usize;
                leaves.extend_from_slice(&order[range]);
            } else {
                waiting.extend([node.first, node.first + 1]);
            }
        }
        leaves
    }

    /// Blocks of leaves that share one box, and nodes above them.
    fn crowd(&mut self, node: &Node, leaves: &[u32]) -> ChildCode {
        if leaves.len() <= LANES {
            return self.block(leaves);
        }
        let place = self.tree.nodes.len();
        let code = self.node();
        let part = leaves.len().div_ceil(LANES).next_multiple_of(LANES);
        for (k, part) in leaves.chunks(part).enumerate() {
            let child = self.crowd(node, part);
            self.tree.nodes[place].set(k, node, child);
        }
        code
    }

    fn node(&mut self) -> ChildCode {
        let code = ChildCode(self.tree.nodes.len() as u32);
        self.tree.nodes.push(LaneNode::empty());
        code
    }

    fn block(&mut self, leaves: &[u32]) -> ChildCode {
        let code = ChildCode(self.tree.blocks.len() as u32 | BLOCK);
        let mut block = LeafBlock { rows: [[0.0; LANES]; 12], leaf: [0; LANES], filled: 0 };
        for (k, &leaf) in leaves.iter().enumerate() {
            let rows = self.records[leaf as usize].rows.as_flattened();
            for (lanes, &value) in block.rows.iter_mut().zip(rows) {
                lanes[k] = value;
            }
            block.leaf[k] = leaf;
            block.filled |= 1 << k;
        }
        self.tree.blocks.push(block);
        code
    }
}

impl LaneNode {
    fn empty() -> Self {
        let mut planes = [[f32::INFINITY; LANES]; 6];
        for axis in 0..3 {
            planes[2 * axis + 1] = [f32::NEG_INFINITY; LANES];
        }
        Self { planes, child: [ChildCode::default(); LANES] }
    }

    fn set(&mut self, k: usize, node: &Node, child: ChildCode) {
        for axis in 0..3 {
            self.planes[2 * axis][k] = node.min[axis];
            self.planes[2 * axis + 1][k] = node.max[axis];
        }
        self.child[k] = child;
    }
}

/// The number of leaves below each node of a binary tree.
fn leaves_below(nodes: &[Node]) -> Vec<u32> {
    let mut parents_first = Vec::with_capacity(nodes.len());
    let mut waiting = vec![0];
    while let Some(index) = waiting.pop() {
        parents_first.push(index);
        let node = &nodes[index as usize];
        if node.leaves == 0 {
            waiting.extend([node.first, node.first + 1]);
        }
    }
    let mut below: Vec<u32> = nodes.iter().map(|node| node.leaves).collect();
    for &index in parents_first.iter().rev() {
        let node = &nodes[index as usize];
        if node.leaves == 0 {
            below[index as usize] = below[node.first as usize] + below[node.first as usize + 1];
        }
    }
    below
}

fn half_area(node: &Node) -> f32 {
    let size = node.max - node.min;
    size.x * size.y + size.y * size.z + size.z * size.x
}
