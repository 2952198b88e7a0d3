//! The hierarchy of boxes around leaves, for all kernels: nodes of sixteen children, and blocks
//! of up to sixteen leaves' oriented boxes.

use rayon::prelude::*;

use super::collapse::Collapse;
use super::hierarchy::Hierarchy;
use crate::patch::{MOST_TOGETHER, OrientedBox, ScaledBox, SceneFrame};

/// Children of a node, and leaves in a block, at most: lanes of a vector of f32.
pub(super) const LANES: usize = 16;
const _: () = assert!(MOST_TOGETHER <= LANES, "leaves that are kept together fit into a block");

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
    pub(super) fn new(child: Child) -> Self {
        match child {
            Child::Node(index) => Self(index),
            Child::Block(index) => Self(index | BLOCK),
        }
    }

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
pub(super) struct Node {
    /// The lower and the upper planes of the first coordinate, of the second, of the third.
    pub(super) planes: [[f32; LANES]; 6],
    pub(super) child: [ChildCode; LANES],
}

impl Node {
    pub(super) fn empty() -> Self {
        let mut planes = [[f32::INFINITY; LANES]; 6];
        for axis in 0..3 {
            planes[2 * axis + 1] = [f32::NEG_INFINITY; LANES];
        }
        Self { planes, child: [ChildCode::default(); LANES] }
    }

    pub(super) fn set(&mut self, k: usize, bounds: &ScaledBox, child: Child) {
        for axis in 0..3 {
            self.planes[2 * axis][k] = bounds.min[axis];
            self.planes[2 * axis + 1][k] = bounds.max[axis];
        }
        self.child[k] = ChildCode::new(child);
    }

    /// Which children there are.
    pub(super) fn filled(&self) -> impl Iterator<Item = usize> {
        (0..LANES).filter(|&k| self.planes[0][k] <= self.planes[1][k])
    }
}

/// Up to sixteen leaves' oriented boxes, lane by lane: four numbers for each of three rows.
/// Those of leaves that are not there mean nothing.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct LeafBlock {
    pub(super) rows: [[f32; LANES]; 12],
}

impl LeafBlock {
    fn new(boxes: &[OrientedBox]) -> Self {
        let mut rows = [[0.0; LANES]; 12];
        for (lane, oriented) in boxes.iter().enumerate() {
            for (lanes, &value) in rows.iter_mut().zip(oriented.rows.as_flattened()) {
                lanes[lane] = value;
            }
        }
        Self { rows }
    }

    /// The box of one leaf.
    #[inline(always)]
    pub(super) fn oriented(&self, lane: usize) -> OrientedBox {
        let mut oriented = OrientedBox { rows: [[0.0; 4]; 3] };
        for k in 0..3 {
            for i in 0..4 {
                oriented.rows[k][i] = self.rows[4 * k + i][lane];
            }
        }
        oriented
    }
}

/// Nodes over blocks of leaves. Leaves are numbered in the order of the blocks.
#[derive(Clone, Debug)]
pub(super) struct Tree {
    pub(super) nodes: Vec<Node>,
    pub(super) blocks: Vec<LeafBlock>,
    /// The first leaf of each block, and the end of the last.
    starts: Vec<u32>,
    /// Where every ray begins; nowhere if there are no leaves.
    pub(super) root: Option<ChildCode>,
    pub(super) frame: SceneFrame,
}

impl Tree {
    /// The tree over [`GroupedParts`](crate::patch::GroupedParts) with the given boxes, without oriented
    /// boxes so far, and the order in which the parts are to become leaves.
    pub(super) fn new(frame: SceneFrame, boxes: &[ScaledBox], groups: &[u32]) -> (Self, Vec<u32>) {
        let binary = Hierarchy::new(boxes, groups);
        let Collapse { nodes, starts, order, root, .. } = Collapse::of(&binary);
        (Self { nodes, blocks: Vec::new(), starts, root, frame }, order)
    }

    /// Takes in the leaves' oriented boxes.
    pub(super) fn fill(&mut self, boxes: &[OrientedBox]) {
        let blocks = self.starts.par_windows(2);
        let blocks = blocks.map(|ends| LeafBlock::new(&boxes[ends[0] as usize..ends[1] as usize]));
        self.blocks = blocks.collect();
    }

    /// The first leaf of a block, and how many there are.
    #[inline(always)]
    pub(super) fn leaves(&self, block: u32) -> (u32, usize) {
        let first = self.starts[block as usize];
        (first, (self.starts[block as usize + 1] - first) as usize)
    }

    /// The box of a leaf.
    pub(super) fn oriented(&self, leaf: u32) -> OrientedBox {
        let block = self.starts.partition_point(|&start| start <= leaf) - 1;
        self.blocks[block].oriented((leaf - self.starts[block]) as usize)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.blocks[..]) + size_of_val(&self.starts[..])
    }
}
