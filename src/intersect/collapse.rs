//! A binary hierarchy becomes a tree of sixteen children a node.

use super::hierarchy::{BinaryNode, Hierarchy};
use super::tree::{Child, ChildCode, LANES, Node};

/// A binary hierarchy on the way to become a wide tree.
pub(super) struct Collapse<'a> {
    binary: &'a Hierarchy,
    /// The number of leaves below each binary node.
    below: Vec<u32>,
    pub(super) nodes: Vec<Node>,
    /// The first leaf of each block, and the end of the last.
    pub(super) starts: Vec<u32>,
    /// The leaves, block by block.
    pub(super) order: Vec<u32>,
    pub(super) root: Option<ChildCode>,
    /// Binary nodes to be opened, and the wide nodes they become.
    waiting: Vec<(u32, usize)>,
}

impl<'a> Collapse<'a> {
    pub(super) fn of(binary: &'a Hierarchy) -> Self {
        let mut collapse = Self {
            binary,
            below: leaves_below(&binary.nodes),
            nodes: Vec::new(),
            starts: vec![0],
            order: Vec::with_capacity(binary.order.len()),
            root: None,
            waiting: Vec::new(),
        };
        if !binary.nodes.is_empty() {
            let root = collapse.child(0);
            collapse.descend();
            collapse.root = Some(ChildCode::new(root));
        }
        collapse
    }

    /// What a binary node becomes: a block if its leaves fit into one, else a node.
    fn child(&mut self, index: u32) -> Child {
        let node = self.binary.nodes[index as usize];
        if self.below[index as usize] as usize <= LANES {
            self.take_leaves(index);
            self.end_block()
        } else if node.leaves > 0 {
            self.crowd(&node)
        } else {
            self.waiting.push((index, self.nodes.len()));
            self.node()
        }
    }

    /// Every node takes in the largest of its descendants until it has sixteen children.
    fn descend(&mut self) {
        let binary = &self.binary.nodes;
        let mut open = Vec::with_capacity(LANES);
        while let Some((root, place)) = self.waiting.pop() {
            open.clear();
            open.push(root);
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
                self.nodes[place].set(k, &binary[index as usize].bounds, child);
            }
        }
    }

    /// Puts all leaves below a binary node into the block that is being filled.
    fn take_leaves(&mut self, index: u32) {
        let node = &self.binary.nodes[index as usize];
        if node.leaves > 0 {
            let range = node.first as usize..(node.first + node.leaves) as usize;
            self.order.extend_from_slice(&self.binary.order[range]);
        } else {
            self.take_leaves(node.first);
            self.take_leaves(node.first + 1);
        }
    }

    fn end_block(&mut self) -> Child {
        self.starts.push(self.order.len() as u32);
        Child::Block(self.starts.len() as u32 - 2)
    }

    /// Blocks of the many leaves of a binary node, of groups that share one box, and nodes above them.
    fn crowd(&mut self, node: &BinaryNode) -> Child {
        let leaves = node.first as usize..(node.first + node.leaves) as usize;
        if leaves.len() <= LANES {
            self.order.extend_from_slice(&self.binary.order[leaves]);
            return self.end_block();
        }
        let place = self.nodes.len();
        let child = self.node();
        let part = leaves.len().div_ceil(LANES).next_multiple_of(LANES);
        for (k, first) in leaves.clone().step_by(part).enumerate() {
            let count = part.min(leaves.end - first);
            let some = BinaryNode { first: first as u32, leaves: count as u32, ..*node };
            let below = self.crowd(&some);
            self.nodes[place].set(k, &node.bounds, below);
        }
        child
    }

    fn node(&mut self) -> Child {
        self.nodes.push(Node::empty());
        Child::Node(self.nodes.len() as u32 - 1)
    }
}

/// The number of leaves below each node of a binary tree.
fn leaves_below(nodes: &[BinaryNode]) -> Vec<u32> {
    let mut parents_first = Vec::with_capacity(nodes.len());
    let mut waiting: Vec<u32> = (!nodes.is_empty()).then_some(0).into_iter().collect();
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

fn half_area(node: &BinaryNode) -> f32 {
    let size = node.bounds.max - node.bounds.min;
    size.x * size.y + size.y * size.z + size.z * size.x
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface, shapes};
    use crate::patch::{PatchSet, ScaledBox, SceneFrame};

    /// A flat sheet of so many pieces each way.
    fn sheet(pieces: usize) -> NurbsSurface {
        let points = pieces + 1;
        let knots = KnotVector::clamped_uniform(1, points).unwrap();
        let point = |k: usize| DVec4::new((k / points) as f64, (k % points) as f64, 0.0, 1.0);
        let net = (0..points * points).map(point).collect();
        NurbsSurface::from_homogeneous(knots.clone(), knots, net).unwrap()
    }

    #[test]
    fn every_leaf_has_one_place() {
        // One leaf, a block of them, several; and many surfaces in one place.
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let one = vec![plane.clone()];
        let crowd = vec![plane; 300];
        let many = vec![shapes::sphere(1.0).unwrap(), shapes::torus(2.0, 0.5).unwrap()];
        // Dense ones, of which neighbours are kept together; and several in one place.
        let dense = vec![sheet(64)];
        let dense_crowd = vec![sheet(48); 3];
        for surfaces in [one, crowd, many, dense, dense_crowd] {
            let (set, grouped) = PatchSet::new(&surfaces).unwrap();
            let parts = grouped.all();
            let frame = SceneFrame::around(&set.bounds());
            let boxes: Vec<ScaledBox> =
                parts.iter().map(|part| frame.scaled_box(&part.bounds)).collect();
            let binary = Hierarchy::new(&boxes, grouped.groups());
            let tree = Collapse::of(&binary);
            let mut order = tree.order.clone();
            order.sort_unstable();
            assert!(order.iter().copied().eq(0..parts.len() as u32));

            // Every block is reached once, through boxes that hold its leaves.
            let mut reached = Vec::new();
            let mut waiting: Vec<_> = tree.root.map(|root| (root, None)).into_iter().collect();
            while let Some((code, bounds)) = waiting.pop() {
                match code.child() {
                    Child::Node(index) => {
                        let node = &tree.nodes[index as usize];
                        waiting.extend(node.filled().map(|k| (node.child[k], Some((node, k)))));
                    }
                    Child::Block(index) => {
                        reached.push(index);
                        let ends = &tree.starts[index as usize..];
                        assert!(ends[0] < ends[1] && ends[1] - ends[0] <= LANES as u32);
                        for &leaf in &tree.order[ends[0] as usize..ends[1] as usize] {
                            let leaf = &boxes[leaf as usize];
                            let Some((node, k)) = bounds else { continue };
                            assert!((0..3).all(|axis| {
                                node.planes[2 * axis][k] <= leaf.min[axis]
                                    && leaf.max[axis] <= node.planes[2 * axis + 1][k]
                            }));
                        }
                    }
                }
            }
            reached.sort_unstable();
            assert!(reached.iter().copied().eq(0..tree.starts.len() as u32 - 1));
            let fill = parts.len() as f64 / reached.len() as f64;
            let least = if grouped.groups().len() < parts.len() { 15.9 } else { 6.0 };
            assert!(parts.len() < 100 || fill > least, "{fill} leaves a block");
        }
    }
}
