//! The hierarchy of boxes around leaves, for all kernels: nodes of sixteen children, and blocks
//! of up to sixteen leaves' oriented boxes.

use rayon::prelude::*;

use crate::patch::{MOST_TOGETHER, OrientedBox, ScaledBox, ScaledFrame};

/// The most children of a node, and the most leaves in a block: the lanes of a vector of f32.
pub(crate) const LANES: usize = 16;
const _: () = assert!(MOST_TOGETHER <= LANES, "leaves that are kept together fit into a block");

/// The highest two bits of a [`ChildCode`] say what its index counts.
const KIND: u32 = 3 << 30;
const INDEX: u32 = !KIND;
const NODE: u32 = 0;
const REGION: u32 = 1 << 30;
const BLOCK: u32 = 2 << 30;
const BACK: u32 = 3 << 30;

/// What a ray comes to next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Child {
    Node(u32),
    Block(u32),
    /// A [`Region`] of the scene, in whose coordinates the search goes on.
    Region(u32, Way),
}

/// How a ray comes to a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// From the region around it.
    In,
    /// From a region inside it that is done.
    Back,
}

/// A [`Child`] as a number.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct ChildCode(u32);

impl ChildCode {
    pub(crate) fn new(child: Child) -> Self {
        let (index, what) = match child {
            Child::Node(index) => (index, NODE),
            Child::Block(index) => (index, BLOCK),
            Child::Region(index, Way::In) => (index, REGION),
            Child::Region(index, Way::Back) => (index, BACK),
        };
        debug_assert!(index <= INDEX, "there are not so many parts");
        Self(index | what)
    }

    /// The number of the node, block or region.
    #[inline(always)]
    pub(crate) fn index(self) -> u32 {
        self.0 & INDEX
    }

    #[inline(always)]
    pub(crate) fn is_node(self) -> bool {
        self.0 & KIND == NODE
    }

    #[inline(always)]
    pub(crate) fn is_block(self) -> bool {
        self.0 & KIND == BLOCK
    }

    #[inline(always)]
    pub(crate) fn child(self) -> Child {
        let index = self.index();
        match self.0 & KIND {
            NODE => Child::Node(index),
            BLOCK => Child::Block(index),
            REGION => Child::Region(index, Way::In),
            _ => Child::Region(index, Way::Back),
        }
    }
}

/// Sixteen children's axis-parallel boxes in the scaled coordinates of their region.
///
/// Boxes of absent children reach from +∞ to −∞: with the nearer plane chosen by the sign of the
/// direction, every ray enters them after it has left them.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct Node {
    /// The lower and the upper planes of the first coordinate, of the second, of the third.
    pub planes: [[[f32; LANES]; 2]; 3],
    pub child: [ChildCode; LANES],
}

impl Node {
    pub(crate) fn empty() -> Self {
        let nowhere = [[f32::INFINITY; LANES], [f32::NEG_INFINITY; LANES]];
        Self { planes: [nowhere; 3], child: [ChildCode::default(); LANES] }
    }

    pub(super) fn set(&mut self, k: usize, bounds: &ScaledBox, child: Child) {
        for axis in 0..3 {
            self.planes[axis][0][k] = bounds.min[axis];
            self.planes[axis][1][k] = bounds.max[axis];
        }
        self.child[k] = ChildCode::new(child);
    }

    /// The indices of the children that exist.
    pub(crate) fn filled(&self) -> impl Iterator<Item = usize> {
        (0..LANES).filter(|&k| self.planes[0][0][k] <= self.planes[0][1][k])
    }
}

/// The oriented boxes of up to sixteen leaves, lane by lane: four numbers for each of three rows.
/// Unused lanes mean nothing.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct LeafBlock {
    pub rows: [[f32; LANES]; 12],
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
    pub(crate) fn oriented(&self, lane: usize) -> OrientedBox {
        let mut oriented = OrientedBox { rows: [[0.0; 4]; 3] };
        for k in 0..3 {
            for i in 0..4 {
                oriented.rows[k][i] = self.rows[4 * k + i][lane];
            }
        }
        oriented
    }
}

/// The leaves of a block: the first, and how many there are.
#[derive(Clone, Copy, Debug)]
pub(crate) struct BlockLeaves {
    pub first: u32,
    pub count: usize,
}

impl BlockLeaves {
    /// The bits of `lanes` that stand for leaves: unused lanes mean nothing.
    #[inline(always)]
    pub(crate) fn of(self, lanes: u32) -> u32 {
        lanes & ((1 << self.count) - 1)
    }
}

/// A part of the scene with scaled coordinates of its own: all of it, or something small in it (see
/// [`regions`](super::regions)).
#[derive(Clone, Debug)]
pub(crate) struct Region {
    pub frame: ScaledFrame,
    /// Where rays begin in it; `None` if there are no leaves.
    pub(super) root: Option<ChildCode>,
    /// The region around it; for the first region, itself.
    pub(super) around: u32,
    /// The first of its own leaves, which exclude those of regions inside it; they end where the
    /// next region's begin.
    pub(super) first_leaf: u32,
}

/// Nodes over blocks of leaves. Leaves are numbered in the order of the blocks.
#[derive(Clone, Debug)]
pub(crate) struct Tree {
    pub nodes: Vec<Node>,
    pub blocks: Vec<LeafBlock>,
    /// The first leaf of each block, and the end of the last.
    pub(super) starts: Vec<u32>,
    /// The whole scene first.
    pub regions: Vec<Region>,
}

impl Tree {
    /// Fills the blocks with the leaves' oriented boxes.
    pub(crate) fn fill(&mut self, boxes: &[OrientedBox]) {
        let blocks = self.starts.par_windows(2);
        let blocks = blocks.map(|ends| LeafBlock::new(&boxes[ends[0] as usize..ends[1] as usize]));
        self.blocks = blocks.collect();
    }

    /// The coordinates of the whole scene.
    pub(crate) fn frame(&self) -> &ScaledFrame {
        &self.regions[0].frame
    }

    /// Where rays begin.
    pub(crate) fn root(&self) -> Option<ChildCode> {
        self.regions[0].root
    }

    /// The region that a ray comes to, and what to push onto the stack then. The way back lies
    /// below all of the region, so everything is popped in the coordinates in which it was pushed.
    pub(crate) fn enter(
        &self,
        region: u32,
        way: Way,
    ) -> (&Region, impl Iterator<Item = ChildCode>) {
        let region = &self.regions[region as usize];
        let next = match way {
            Way::In => {
                let back = Child::Region(region.around, Way::Back);
                [Some(ChildCode::new(back)), region.root]
            }
            Way::Back => [None; 2],
        };
        (region, next.into_iter().flatten())
    }

    /// The coordinates in which a leaf's box is given.
    pub(crate) fn frame_of(&self, leaf: u32) -> &ScaledFrame {
        // The last region that begins no later: one without leaves begins where the next does.
        let after = self.regions.partition_point(|region| region.first_leaf <= leaf);
        &self.regions[after - 1].frame
    }

    /// The leaves of a block.
    #[inline(always)]
    pub(crate) fn leaves(&self, block: u32) -> BlockLeaves {
        let first = self.starts[block as usize];
        BlockLeaves { first, count: (self.starts[block as usize + 1] - first) as usize }
    }

    /// The box of a leaf.
    pub(crate) fn oriented(&self, leaf: u32) -> OrientedBox {
        let block = self.starts.partition_point(|&start| start <= leaf) - 1;
        self.blocks[block].oriented((leaf - self.starts[block]) as usize)
    }

    pub(crate) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..])
            + size_of_val(&self.blocks[..])
            + size_of_val(&self.starts[..])
            + size_of_val(&self.regions[..])
    }
}
