//! Turns a binary hierarchy into a tree with up to sixteen children per node.

use std::collections::HashMap;
use std::ops::Range;

use super::hierarchy::{BinaryNode, Hierarchy};
use super::nodes::{Child, ChildCode, LANES, Node, Way};

/// The nodes, and blocks of leaves, made so far.
#[derive(Debug)]
pub(super) struct Wide {
    pub(super) nodes: Vec<Node>,
    /// The first leaf of each block, and the end of the last.
    pub(super) starts: Vec<u32>,
    /// The parts that become leaves, block by block.
    pub(super) order: Vec<u32>,
}

impl Wide {
    /// Nothing yet.
    pub(super) fn new() -> Self {
        Self { nodes: Vec::new(), starts: vec![0], order: Vec::new() }
    }
}

/// A binary hierarchy while it is turned into a wide tree.
pub(super) struct Collapse<'a> {
    binary: &'a Hierarchy,
    /// The number of leaves below each binary node.
    below: &'a [u32],
    /// The binary nodes that become regions, and the regions' numbers.
    regions: &'a HashMap<u32, u32>,
    /// The part that each leaf of the hierarchy stands for.
    parts: &'a [u32],
    wide: &'a mut Wide,
    /// Binary nodes to be opened, and the wide nodes they become.
    waiting: Vec<(u32, usize)>,
}

impl<'a> Collapse<'a> {
    /// Adds the nodes and blocks of a hierarchy, whose leaves are `parts`, to those of `wide`;
    /// returns the child where rays begin.
    pub(super) fn of(
        (binary, below): (&'a Hierarchy, &'a [u32]),
        regions: &'a HashMap<u32, u32>,
        parts: &'a [u32],
        wide: &'a mut Wide,
    ) -> Option<ChildCode> {
        wide.order.reserve(binary.order.len());
        let mut collapse = Self { binary, below, regions, parts, wide, waiting: Vec::new() };
        if binary.nodes.is_empty() {
            return None;
        }
        let root = collapse.child(0);
        collapse.descend();
        Some(ChildCode::new(root))
    }

    /// What a binary node becomes: a region if it is to be one, else a block if its leaves fit into
    /// one, else a node.
    fn child(&mut self, index: u32) -> Child {
        let node = self.binary.nodes[index as usize];
        if let Some(&region) = self.regions.get(&index) {
            Child::Region(region, Way::In)
        } else if self.below[index as usize] as usize <= LANES {
            self.take_leaves(index);
            self.end_block()
        } else if node.leaves > 0 {
            self.crowd(&node)
        } else {
            self.waiting.push((index, self.wide.nodes.len()));
            self.node()
        }
    }

    /// Replaces, in every node, the largest child by the two below it until there are sixteen.
    fn descend(&mut self) {
        let binary = &self.binary.nodes;
        let mut open = Vec::with_capacity(LANES);
        while let Some((root, place)) = self.waiting.pop() {
            open.clear();
            open.push(root);
            while open.len() < LANES {
                let inner = |&k: &usize| {
                    let index = open[k] as usize;
                    binary[index].leaves == 0
                        && self.below[index] as usize > LANES
                        && !self.regions.contains_key(&open[k])
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
                self.wide.nodes[place].set(k, &binary[index as usize].bounds, child);
            }
        }
    }

    /// Puts all leaves below a binary node into the block that is being filled.
    fn take_leaves(&mut self, index: u32) {
        let node = &self.binary.nodes[index as usize];
        if node.leaves > 0 {
            let range = node.first as usize..(node.first + node.leaves) as usize;
            self.take(range);
        } else {
            self.take_leaves(node.first);
            self.take_leaves(node.first + 1);
        }
    }

    /// Puts a range of the hierarchy's leaves into the block that is being filled.
    fn take(&mut self, leaves: Range<usize>) {
        let leaves = self.binary.order[leaves].iter();
        self.wide.order.extend(leaves.map(|&leaf| self.parts[leaf as usize]));
    }

    fn end_block(&mut self) -> Child {
        self.wide.starts.push(self.wide.order.len() as u32);
        Child::Block(self.wide.starts.len() as u32 - 2)
    }

    /// Makes blocks of the many leaves of a binary node (groups that share one box), and nodes
    /// above them.
    fn crowd(&mut self, node: &BinaryNode) -> Child {
        let leaves = node.first as usize..(node.first + node.leaves) as usize;
        if leaves.len() <= LANES {
            self.take(leaves);
            return self.end_block();
        }
        let place = self.wide.nodes.len();
        let child = self.node();
        let part = leaves.len().div_ceil(LANES).next_multiple_of(LANES);
        for (k, first) in leaves.clone().step_by(part).enumerate() {
            let count = part.min(leaves.end - first);
            let some = BinaryNode { first: first as u32, leaves: count as u32, ..*node };
            let below = self.crowd(&some);
            self.wide.nodes[place].set(k, &node.bounds, below);
        }
        child
    }

    fn node(&mut self) -> Child {
        self.wide.nodes.push(Node::empty());
        Child::Node(self.wide.nodes.len() as u32 - 1)
    }
}

fn half_area(node: &BinaryNode) -> f32 {
    let size = node.bounds.max - node.bounds.min;
    size.x * size.y + size.y * size.z + size.z * size.x
}
