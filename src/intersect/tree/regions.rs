//! Small things in large scenes: parts of the tree with coordinates of their own.
//!
//! Work in f32 is accurate to about 1e-6 of the scene, and boxes are grown by that much. Leaves of
//! that size would all be met at once: on a teapot on a table 1e5 times its size, a ray met 1800
//! leaves instead of one. So a thing that is small compared with the scene, and has small leaves,
//! becomes a region: a tree of its own, in coordinates scaled to it. A ray that enters a region is
//! converted to its coordinates anew, from f64, and back when the region is done. A region may
//! contain smaller ones.

use std::collections::{HashMap, VecDeque};

use rayon::prelude::*;

use super::collapse::{Collapse, Wide};
use super::hierarchy::Hierarchy;
use super::nodes::{LANES, Region, Tree};
use crate::math::Aabb;
use crate::patch::{Part, ScaledBox, ScaledFrame};

/// A region is no larger than this, in the scaled coordinates of the region around it, where sizes
/// are up to 2: the change of coordinates must gain something.
const SMALL: f32 = 1.0 / 32.0;

/// A region's parts are no wider than this on average: about thirty times the growth of their
/// boxes.
const FINE: f64 = 1.0 / 8192.0;

/// A change of coordinates that gains less than this factor is not made: the scale is then near its
/// limit, for deeper regions, too.
const GAIN: f64 = 8.0;

/// Parts that are to become a region.
struct Waiting {
    frame: ScaledFrame,
    /// The parts, and the sizes of the runs of them that are to be kept together.
    parts: Vec<u32>,
    groups: Vec<u32>,
    around: u32,
}

/// The tree over parts in the coordinates of a scene, still without blocks, and the order in which
/// the parts are to become leaves.
///
/// `groups` are as in [`Hierarchy::new`]. No region's coordinates are scaled up by more than
/// `most_scale`.
pub(crate) fn tree_over(
    parts: &[Part],
    groups: &[u32],
    scene: ScaledFrame,
    most_scale: f64,
) -> (Tree, Vec<u32>) {
    let group_ends = ends(groups);
    let all = (0..parts.len() as u32).collect();
    let scene = Waiting { frame: scene, parts: all, groups: groups.to_vec(), around: 0 };
    let mut waiting = VecDeque::from([scene]);
    let (mut wide, mut regions) = (Wide::new(), Vec::new());
    while let Some(Waiting { frame, parts: own, groups, around }) = waiting.pop_front() {
        let boxes = own.par_iter().map(|&k| frame.scaled_box(&parts[k as usize].bounds));
        let boxes: Vec<ScaledBox> = boxes.collect();
        let binary = Hierarchy::new(&boxes, &groups);
        let counts = binary.totals(|leaves| leaves.len() as u32);

        let index = regions.len() as u32;
        let mut inner = HashMap::new();
        for node in small_subtrees(&binary, &counts, &boxes) {
            let mut inside: Vec<u32> =
                binary.leaves_below(node).iter().map(|&k| own[k as usize]).collect();
            inside.sort_unstable(); // so that groups lie side by side
            let holds = |all: Aabb, &k: &u32| all.union(parts[k as usize].bounds);
            let mut frame_inside = ScaledFrame::around(&inside.iter().fold(Aabb::EMPTY, holds));
            frame_inside.scale = frame_inside.scale.min(most_scale);
            if frame_inside.scale < GAIN * frame.scale {
                continue;
            }
            // Regions are numbered in the order of the queue.
            inner.insert(node, index + 1 + waiting.len() as u32);
            let groups =
                inside.chunk_by(|&a, &b| group_of(a, &group_ends) == group_of(b, &group_ends));
            let groups = groups.map(|group| group.len() as u32).collect();
            waiting.push_back(Waiting {
                frame: frame_inside,
                parts: inside,
                groups,
                around: index,
            });
        }

        let first_leaf = wide.order.len() as u32;
        let root = Collapse::of((&binary, &counts), &inner, &own, &mut wide);
        regions.push(Region { frame, root, around, first_leaf });
    }
    let Wide { nodes, starts, order } = wide;
    (Tree { nodes, blocks: Vec::new(), starts, regions }, order)
}

/// Where each group ends.
fn ends(groups: &[u32]) -> Vec<u32> {
    let mut end = 0;
    let ends = groups.iter().map(|&count| {
        end += count;
        end
    });
    ends.collect()
}

fn group_of(part: u32, ends: &[u32]) -> usize {
    ends.partition_point(|&end| end <= part)
}

/// The largest subtrees that are small, have small leaves, and more of them than fit into a block.
fn small_subtrees(binary: &Hierarchy, counts: &[u32], boxes: &[ScaledBox]) -> Vec<u32> {
    let width = |b: &ScaledBox| (b.max - b.min).max_element();
    if boxes.par_iter().all(|b| f64::from(width(b)) > FINE) {
        return Vec::new(); // so no subtree is narrower on average
    }
    let widths = binary
        .totals(|leaves| leaves.iter().map(|&k| f64::from(width(&boxes[k as usize]))).sum::<f64>());
    let mut small = Vec::new();
    let mut waiting = vec![0];
    while let Some(index) = waiting.pop() {
        let node = &binary.nodes[index as usize];
        let count = counts[index as usize];
        if count as usize <= LANES {
            continue;
        }
        if width(&node.bounds) <= SMALL && widths[index as usize] <= FINE * f64::from(count) {
            small.push(index);
        } else if node.leaves == 0 {
            waiting.extend([node.first, node.first + 1]);
        }
    }
    small
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DQuat, DVec3, DVec4, Vec3};

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface, shapes};
    use crate::intersect::tree::nodes::{BlockLeaves, Child, ChildCode, Way};
    use crate::patch::PatchSet;

    /// A flat sheet of this many pieces each way.
    fn sheet(pieces: usize) -> NurbsSurface {
        let points = pieces + 1;
        let knots = KnotVector::clamped_uniform(1, points).unwrap();
        let point = |k: usize| DVec4::new((k / points) as f64, (k % points) as f64, 0.0, 1.0);
        let net = (0..points * points).map(point).collect();
        NurbsSurface::from_homogeneous(knots.clone(), knots, net).unwrap()
    }

    /// A sphere of this radius, its centre at `x` along the first axis.
    fn ball(radius: f64, x: f64) -> NurbsSurface {
        let to = DAffine3::from_translation(DVec3::new(x, 0.0, 0.0));
        shapes::sphere(radius).unwrap().transformed(&to).unwrap()
    }

    /// Checks a tree: every part lies in one block, which is reached once, through boxes that hold
    /// the part. Returns the number of regions, the parts per block, and whether parts are grouped.
    fn check(surfaces: &[NurbsSurface], most_scale: f64) -> (usize, f64, bool) {
        let (set, grouped) = PatchSet::new(surfaces).unwrap();
        let parts = grouped.all();
        let frame = ScaledFrame::around(&set.bounds());
        let (tree, order) = tree_over(parts, grouped.groups(), frame, most_scale);
        let mut sorted = order.clone();
        sorted.sort_unstable();
        assert!(sorted.iter().copied().eq(0..parts.len() as u32));

        let (mut reached, mut entered) = (Vec::new(), vec![0]);
        // What is met, in which region, and the boxes that hold it: each in its region's
        // coordinates.
        type Boxes = Vec<(ScaledFrame, ScaledBox)>;
        let root = tree.root().map(|root| (root, 0, Boxes::new()));
        let mut waiting: Vec<(ChildCode, u32, Boxes)> = root.into_iter().collect();
        while let Some((code, region, boxes)) = waiting.pop() {
            let frame = tree.regions[region as usize].frame;
            match code.child() {
                Child::Node(index) => {
                    let node = &tree.nodes[index as usize];
                    waiting.extend(node.filled().map(|k| {
                        let side = |side: usize| {
                            Vec3::from_array([0, 1, 2].map(|axis| node.planes[axis][side][k]))
                        };
                        let mut boxes = boxes.clone();
                        boxes.push((frame, ScaledBox { min: side(0), max: side(1) }));
                        (node.child[k], region, boxes)
                    }));
                }
                Child::Block(index) => {
                    reached.push(index);
                    let BlockLeaves { first, count } = tree.leaves(index);
                    assert!((1..=LANES).contains(&count));
                    for leaf in first..first + count as u32 {
                        assert_eq!(tree.frame_of(leaf).scale, frame.scale);
                        let bounds = &parts[order[leaf as usize] as usize].bounds;
                        for (frame, held) in &boxes {
                            let part = frame.scaled_box(bounds);
                            assert!(
                                held.min.cmple(part.min).all() && part.max.cmple(held.max).all()
                            );
                        }
                    }
                }
                Child::Region(index, way) => {
                    assert_eq!(way, Way::In, "no node holds a way back");
                    entered.push(index);
                    let inner = &tree.regions[index as usize];
                    assert_eq!(inner.around, region);
                    assert!(inner.frame.scale >= GAIN * frame.scale);
                    assert!(inner.frame.scale <= most_scale);
                    waiting.extend(inner.root.map(|root| (root, index, boxes)));
                }
            }
        }
        reached.sort_unstable();
        assert!(reached.iter().copied().eq(0..tree.starts.len() as u32 - 1));
        entered.sort_unstable();
        assert!(entered.iter().copied().eq(0..tree.regions.len() as u32));
        let fill = parts.len() as f64 / reached.len() as f64;
        (entered.len(), fill, grouped.groups().len() < parts.len())
    }

    #[test]
    fn every_leaf_has_one_place() {
        // One leaf, a block of them, several; and many surfaces in one place.
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let one = vec![plane.clone()];
        let crowd = vec![plane; 300];
        let many = vec![shapes::sphere(1.0).unwrap(), shapes::torus(2.0, 0.5).unwrap()];
        // Dense surfaces, whose neighbouring pieces are kept together; and several in one place.
        let dense = vec![sheet(64)];
        let dense_crowd = vec![sheet(48); 3];
        for surfaces in [one, crowd, many, dense, dense_crowd] {
            let (regions, fill, together) = check(&surfaces, f64::INFINITY);
            assert_eq!(regions, 1);
            let least = if together { 15.9 } else { 6.0 };
            assert!(fill > least || surfaces.len() == 1 && fill == 1.0, "{fill} leaves a block");
        }
    }

    #[test]
    fn small_things_have_coordinates_of_their_own() {
        // One in the other, to below what f32 tells apart; two small ones side by side; several
        // in one place; dense ones, whose neighbouring pieces are kept together.
        let far = |scale: f64, x: f64| {
            let to = DAffine3::from_scale_rotation_translation(
                DVec3::splat(scale),
                DQuat::IDENTITY,
                DVec3::new(x, 1.0, 0.0),
            );
            sheet(64).transformed(&to).unwrap()
        };
        let nested = vec![ball(1.0, 0.0), ball(1e-4, 0.3), ball(1e-8, 0.3)];
        let twins = vec![ball(1.0, 0.0), ball(1e-5, 0.5), ball(1e-5, 0.6)];
        let alike = [vec![ball(1.0, 0.0)], vec![ball(1e-8, 0.25); 3]].concat();
        let dense = vec![ball(1.0, 0.0), far(1e-5, 0.7), far(1e-5, -0.2)];
        for (surfaces, regions) in [(nested, 3), (twins, 3), (alike, 2), (dense, 3)] {
            // A thing may become two regions: the builder does not resolve what is that small.
            let (all, ..) = check(&surfaces, f64::INFINITY);
            assert!((regions..=regions + 2).contains(&all), "{all} instead of {regions}");
            // With coordinates that may be scaled up by no more than this, or not at all.
            let (fewer, ..) = check(&surfaces, 2f64.powi(10));
            assert!((2..=all).contains(&fewer), "{fewer} of {all}");
            assert_eq!(check(&surfaces, 2.0).0, 1);
        }
    }
}
