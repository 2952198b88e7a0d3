//! The hierarchy of boxes around leaves: built by obvhs, traversed by our own test.
//!
//! The tree is built in coordinates moved and scaled (by a power of two) so that all boxes
//! lie within `[−1, 1]`: f32 is then as fine at 1e6 as at the origin, and no fixed length
//! inside the builder can matter. Traps of obvhs 0.4 closed here, each held shut by a
//! test: its traversals clamp directions, ignore `t_min`, cull before `t = 1e-4` and lose
//! axis-parallel rays in a box's face, so only its builder is used; boxes that are equal
//! chain in the tree, so they become one primitive; its leaves hold slots, not indices.

use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb as BuilderBox;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

use crate::math::{Aabb, RayFrame, rounding};
use crate::patch::PatchSet;

/// Boxes are grown by this part of the scene's half size: some roundings of f32, and far
/// more than any rounding of f64.
const PADDING: f64 = 4.0 * f32::EPSILON as f64;

/// A node: its box and what is in it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) min: Vec3,
    pub(super) max: Vec3,
    /// The first of two children, or the first leaf.
    pub(super) first: u32,
    /// The number of leaves; none for an inner node.
    pub(super) leaves: u32,
}

/// A binary tree of boxes in scaled coordinates.
#[derive(Clone, Debug, Default)]
pub(super) struct Hierarchy {
    nodes: Vec<Node>,
    /// Leaf indices, in the order of the tree.
    order: Vec<u32>,
    center: DVec3,
    scale: f64,
}

impl Hierarchy {
    /// The tree over the leaves of a set, given a box around each.
    pub(super) fn new(set: &PatchSet, leaves: &[Aabb]) -> Self {
        let bounds = set.bounds();
        if bounds.is_empty() {
            return Self::default();
        }
        let center = bounds.center();
        let half = (0.5 * bounds.size()).max_element().max(f64::MIN_POSITIVE);
        let scale = power_of_two_below(1.0 / half);
        let mut hierarchy = Self { nodes: Vec::new(), order: Vec::new(), center, scale };

        // Leaves with equal boxes become one primitive.
        let mut boxes: Vec<(Box32, u32)> =
            (0u32..).zip(leaves).map(|(k, &leaf)| (hierarchy.scaled(leaf), k)).collect();
        boxes.sort_by(|(a, j), (b, k)| a.total_cmp(b).then(j.cmp(k)));
        let mut primitives: Vec<(Box32, std::ops::Range<u32>)> = Vec::new();
        for (at, (boundary, leaf)) in (0u32..).zip(boxes) {
            match primitives.last_mut() {
                Some((last, range)) if *last == boundary => range.end = at + 1,
                _ => primitives.push((boundary, at..at + 1)),
            }
            hierarchy.order.push(leaf);
        }
        hierarchy.build(&primitives);
        hierarchy
    }

    /// The tree over primitives: PLOC, then reinsertion, one primitive to a leaf.
    fn build(&mut self, primitives: &[(Box32, std::ops::Range<u32>)]) {
        let boxes: Vec<BuilderBox> = primitives
            .iter()
            .map(|(b, _)| BuilderBox::new(Vec3A::from(b.min), Vec3A::from(b.max)))
            .collect();
        let indices = (0..boxes.len() as u32).collect();
        let mut tree = PlocBuilder::with_capacity(boxes.len()).build(
            PlocSearchDistance::Medium,
            &boxes,
            indices,
            SortPrecision::U64,
            0,
        );
        ReinsertionOptimizer::default().run(&mut tree, 0.15, None);
        self.nodes = tree
            .nodes
            .iter()
            .map(|node| {
                let bounds = node.aabb();
                let (min, max) = (bounds.min.into(), bounds.max.into());
                if node.is_leaf() {
                    // A leaf's index is a slot in the builder's own order.
                    let slot = tree.primitive_indices[node.first_index as usize];
                    let range = &primitives[slot as usize].1;
                    Node { min, max, first: range.start, leaves: range.len() as u32 }
                } else {
                    Node { min, max, first: node.first_index, leaves: 0 }
                }
            })
            .collect();
    }

    /// A leaf's box in scaled coordinates, rounded outwards and padded.
    fn scaled(&self, bounds: Aabb) -> Box32 {
        let (min, max) = (
            (bounds.min - self.center) * self.scale - PADDING,
            (bounds.max - self.center) * self.scale + PADDING,
        );
        let below = |v: DVec3| Vec3::from_array(v.to_array().map(rounding::f32_below));
        let above = |v: DVec3| Vec3::from_array(v.to_array().map(rounding::f32_above));
        Box32 { min: below(min), max: above(max) }
    }

    /// The nodes, the root first.
    pub(super) fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// The leaf indices that nodes refer to.
    pub(super) fn order(&self) -> &[u32] {
        &self.order
    }

    /// What scaled coordinates are: `(P − center) · scale`.
    pub(super) fn frame(&self) -> (DVec3, f64) {
        (self.center, self.scale)
    }

    pub(super) fn bytes(&self) -> usize {
        size_of_val(&self.nodes[..]) + size_of_val(&self.order[..])
    }

    /// Visits the leaves whose boxes the ray meets, nearer boxes first.
    ///
    /// `visit` is given a leaf and returns how far along the ray, in scene units, anything
    /// is still of interest. Every leaf is visited whose box begins before that, and no
    /// box is entered later than the ray really does: so a result that is the least of all
    /// does not depend on the tree. Returns the number of nodes looked at.
    pub(super) fn traverse(
        &self,
        ray: &RayFrame,
        stack: &mut Vec<(f64, u32)>,
        mut visit: impl FnMut(u32) -> f64,
    ) -> u64 {
        if self.nodes.is_empty() {
            return 0;
        }
        let slabs = Slabs::new(self, ray);
        let mut limit = ray.z_range[1];
        let mut visited = 0;
        stack.clear();
        if let Some(entry) = slabs.entry(&self.nodes[0]) {
            stack.push((entry, 0));
        }
        while let Some((entry, index)) = stack.pop() {
            visited += 1;
            if entry > limit {
                continue;
            }
            let node = &self.nodes[index as usize];
            if node.leaves > 0 {
                let leaves = node.first as usize..(node.first + node.leaves) as usize;
                for &leaf in &self.order[leaves] {
                    limit = limit.min(visit(leaf));
                }
                continue;
            }
            let children = [node.first, node.first + 1]
                .map(|child| slabs.entry(&self.nodes[child as usize]).map(|entry| (entry, child)));
            match children {
                [Some(a), Some(b)] if a.0 <= b.0 => stack.extend([b, a]),
                [Some(a), Some(b)] => stack.extend([a, b]),
                [a, b] => stack.extend(a.or(b)),
            }
        }
        visited
    }
}

/// The largest power of two not above `x`, kept normal: scaling by it is exact.
fn power_of_two_below(x: f64) -> f64 {
    x.clamp(f64::MIN_POSITIVE, 2f64.powi(1000)).log2().floor().exp2()
}

/// A box in f32.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Box32 {
    min: Vec3,
    max: Vec3,
}

impl Box32 {
    fn total_cmp(&self, other: &Self) -> std::cmp::Ordering {
        let key = |b: &Self| {
            let (a, c) = (b.min.to_array(), b.max.to_array());
            [a[0], a[1], a[2], c[0], c[1], c[2]]
        };
        let (a, b) = (key(self), key(other));
        let pairs = a.iter().zip(&b);
        pairs.map(|(x, y)| x.total_cmp(y)).find(|o| o.is_ne()).unwrap_or(std::cmp::Ordering::Equal)
    }
}

/// A ray prepared for box tests in scaled coordinates.
struct Slabs {
    /// The origin, moved by the rounding error of the test towards either side.
    origin_low: DVec3,
    origin_high: DVec3,
    inverse: DVec3,
    /// Takes scaled lengths to scene units.
    unscale: f64,
    /// The range of `z`, in scaled units.
    range: [f64; 2],
}

impl Slabs {
    fn new(hierarchy: &Hierarchy, ray: &RayFrame) -> Self {
        let origin = (ray.origin - hierarchy.center) * hierarchy.scale;
        // Rounding of the subtraction, and of the surface's own points for this origin.
        let center = hierarchy.center.abs().max_element();
        let error = 512.0
            * rounding::UNIT_ROUNDOFF
            * ((ray.magnitude + center) * hierarchy.scale + origin.abs().max_element() + 1.0);
        Self {
            origin_low: origin + error,
            origin_high: origin - error,
            inverse: 1.0 / ray.axis,
            unscale: 1.0 / hierarchy.scale,
            range: ray.z_range.map(|z| z * hierarchy.scale),
        }
    }

    /// Where the ray enters a box, in scene units and never too late; `None` for a miss.
    ///
    /// A direction component of zero gives an infinite inverse; a NaN arises only when the
    /// widened origin lies exactly in a padded face, where nothing is, and `min` and `max`
    /// pass over it.
    fn entry(&self, node: &Node) -> Option<f64> {
        let low = (node.min.as_dvec3() - self.origin_low) * self.inverse;
        let high = (node.max.as_dvec3() - self.origin_high) * self.inverse;
        let mut near = self.range[0];
        let mut far = self.range[1];
        for k in 0..3 {
            near = near.max(low[k].min(high[k]));
            far = far.min(low[k].max(high[k]));
        }
        let rounded = 8.0 * f64::EPSILON * (near.abs().min(f64::MAX) + far.abs().min(f64::MAX));
        let missed = near > far + rounded;
        (!missed).then_some((near - rounded) * self.unscale)
    }
}
