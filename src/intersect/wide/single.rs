//! One ray on its way through the boxes: the nearest certain hit, and what is left.
//!
//! # Why it is right
//! - No box is entered too late or left too early: the planes of axis-parallel boxes are moved
//!   outwards by more than rounding comes to, oriented boxes were grown when they were made.
//!   So every leaf that is met before the nearest hit is searched, in whatever order, and of
//!   the hits the least counts: the answer does not depend on the tree.
//! - A leaf is left as missed where the certificate, or the ray's own proof, leaves one root at
//!   most in the widened leaf or a part of it, and Newton's iteration on the true surface finds
//!   it outside the leaf, outside the ray's range, or to be the one the ray starts on; or where
//!   the proof leaves none.
//! - A hit is a root on the true surface, clear of the ends of the ray and of its start.
//! - Everything else is named in [`SingleWork::rest`] for the scalar search, which knows about
//!   borders, poles, tangency and the ends of rays.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};
use fearless_simd_macros::simd;

use super::single_finish::{Outcome, finish};
use super::single_proof::isolate;
use super::single_ray::{SingleHit, SingleRay};
use super::single_search::Distances;
use super::trimmed::trim_side;
use crate::geometry::trim::Side;
use crate::intersect::Statistics;
use crate::intersect::tree::{Child, ChildCode, LANES, LeafBlock, Node, Tree};
use crate::patch::{Leaf, PatchSet, WIDENING};

/// Directions along a box's side are taken for at least this part of a turn: so quotients
/// stay finite, and far larger than any distance that matters.
const LEAST_SLOPE: f32 = 1e-12;

/// Box entries and exits are compared with this to spare, in scaled coordinates: some
/// roundings of f32 at the distances a ray has inside the scene.
const SPARE: f32 = 4e-6;

/// Everything that is searched.
#[derive(Clone, Copy, Debug)]
pub(in crate::intersect) struct Scene<'a> {
    pub(in crate::intersect) tree: &'a Tree,
    pub(in crate::intersect) leaves: &'a [Leaf],
    pub(in crate::intersect) set: &'a PatchSet,
}

/// Scratch memory and results of tracing one ray.
#[derive(Debug, Default)]
pub(in crate::intersect) struct SingleWork {
    stack: Vec<(f32, ChildCode)>,
    /// The nearest certified hit: of any-hit searches the first found.
    pub(in crate::intersect) hit: Option<SingleHit>,
    /// Leaves the scalar search must look at.
    pub(in crate::intersect) rest: Vec<u32>,
    /// Newton's steps in f64 since the beginning.
    pub(in crate::intersect) steps: u64,
}

/// Finds a ray's nearest certified hit, or any if that is all it asks; `work.rest` names the
/// leaves that could not be certified or decided, which may hold nearer ones.
#[simd]
pub(in crate::intersect) fn trace_single<S: Simd>(
    simd: S,
    scene: &Scene<'_>,
    ray: &mut SingleRay<'_>,
    (work, statistics): (&mut SingleWork, &mut Statistics),
) {
    work.hit = None;
    work.rest.clear();
    work.stack.clear();
    let Some(mut next) = scene.tree.root else { return };
    loop {
        match next.child() {
            Child::Node(index) => {
                statistics.nodes += 1;
                let node = &scene.tree.nodes[index as usize];
                if let Some(nearest) = enter(simd, node, ray, &mut work.stack) {
                    next = nearest;
                    continue;
                }
            }
            Child::Block(index) => {
                search_block(simd, scene, index, ray, (work, statistics));
                if ray.is_done() {
                    return;
                }
            }
        }
        next = loop {
            match work.stack.pop() {
                None => return,
                Some((entry, child)) if entry <= ray.far => break child,
                Some(_) => {}
            }
        };
    }
}

/// The nearest child whose box the ray meets; the others go onto the stack, the nearest last.
///
/// The nearer planes are moved towards the ray's origin and the farther ones away from it, by
/// more than all rounding of origin, direction and quotients comes to: so no box is entered
/// too late or left too early.
#[simd]
fn enter<S: Simd>(
    simd: S,
    node: &Node,
    ray: &SingleRay<'_>,
    stack: &mut Vec<(f32, ChildCode)>,
) -> Option<ChildCode> {
    let mut near = f32x16::splat(simd, ray.near);
    let mut far = f32x16::splat(simd, ray.far);
    for axis in 0..3 {
        let side = ray.near_side[axis];
        let inverse = f32x16::splat(simd, ray.inverse[axis]);
        let to_near = f32x16::from_slice(simd, &node.planes[2 * axis + side])
            - f32x16::splat(simd, ray.origin_for_near[axis]);
        let to_far = f32x16::from_slice(simd, &node.planes[2 * axis + 1 - side])
            - f32x16::splat(simd, ray.origin_for_far[axis]);
        near = near.max(to_near * inverse);
        far = far.min(to_far * inverse);
    }
    let mut met = near.simd_le(far).to_bitmask() as u32;
    if met == 0 {
        return None;
    }
    let first = met.trailing_zeros() as usize;
    met &= met - 1;
    if met == 0 {
        return Some(node.child[first]);
    }
    let entries: [f32; LANES] = near.into();
    let bottom = stack.len();
    stack.push((entries[first], node.child[first]));
    while met != 0 {
        let k = met.trailing_zeros() as usize;
        met &= met - 1;
        let item = (entries[k], node.child[k]);
        let mut place = stack.len();
        stack.push(item);
        while place > bottom && stack[place - 1].0 < item.0 {
            stack[place] = stack[place - 1];
            place -= 1;
        }
        stack[place] = item;
    }
    stack.pop().map(|(_, child)| child)
}

/// Which of sixteen leaves' boxes a ray meets, where it enters them, and where it crosses
/// their middles.
struct Crossings {
    met: u32,
    entry: [f32; LANES],
    x: [f32; LANES],
    y: [f32; LANES],
    /// What each row says of the direction.
    slopes: [[f32; LANES]; 3],
}

/// The slab test of sixteen oriented boxes.
#[simd]
fn cross_boxes<S: Simd>(simd: S, block: &LeafBlock, ray: &SingleRay<'_>) -> Crossings {
    let (one, least) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, LEAST_SLOPE));
    let mut entry = f32x16::splat(simd, f32::MIN);
    let mut exit = f32x16::splat(simd, f32::MAX);
    let mut at = [one; 3];
    let mut along = [one; 3];
    let mut inverse = one;
    for k in 0..3 {
        let rx = f32x16::from_slice(simd, &block.rows[4 * k]);
        let ry = f32x16::from_slice(simd, &block.rows[4 * k + 1]);
        let rz = f32x16::from_slice(simd, &block.rows[4 * k + 2]);
        let offset = f32x16::from_slice(simd, &block.rows[4 * k + 3]);
        let [ox, oy, oz] = ray.origin;
        let from = rz.mul_add(f32x16::splat(simd, oz), -offset);
        let from = ry.mul_add(f32x16::splat(simd, oy), from);
        at[k] = rx.mul_add(f32x16::splat(simd, ox), from);
        let [dx, dy, dz] = ray.axis;
        let slope = ry.mul_add(f32x16::splat(simd, dy), rz * f32x16::splat(simd, dz));
        let slope = rx.mul_add(f32x16::splat(simd, dx), slope);
        let steep = slope.abs().simd_gt(least);
        along[k] = steep.select(slope, least.copysign(slope));
        inverse = one / along[k];
        let middle = -at[k] * inverse;
        let half = inverse.abs();
        entry = entry.max(middle - half);
        exit = exit.min(middle + half);
    }
    let (near, far) = (f32x16::splat(simd, ray.near), f32x16::splat(simd, ray.far));
    let met = entry.max(near).simd_le(exit.min(far) + f32x16::splat(simd, SPARE));

    // The middle plane, if it is crossed inside the box. What is known of the ray's end must
    // have no say in it: the start would depend on what was searched before.
    let z = (-at[2] * inverse).max(entry).min(exit);
    let x = z.mul_add(along[0], at[0]).max(-one).min(one);
    let y = z.mul_add(along[1], at[1]).max(-one).min(one);
    let met = met.to_bitmask() as u32;
    Crossings {
        met,
        entry: entry.into(),
        x: x.into(),
        y: y.into(),
        slopes: [along[0].into(), along[1].into(), along[2].into()],
    }
}

/// The leaves of a block, near ones first.
#[simd]
fn search_block<S: Simd>(
    simd: S,
    scene: &Scene<'_>,
    index: u32,
    ray: &mut SingleRay<'_>,
    (work, statistics): (&mut SingleWork, &mut Statistics),
) {
    let block = &scene.tree.blocks[index as usize];
    let (first, count) = scene.tree.leaves(index);
    let crossings = cross_boxes(simd, block, ray);
    let mut met = crossings.met & ((1 << count) - 1);
    while met != 0 {
        let mut nearest = met.trailing_zeros() as usize;
        let mut others = met & (met - 1);
        while others != 0 {
            let k = others.trailing_zeros() as usize;
            if crossings.entry[k] < crossings.entry[nearest] {
                nearest = k;
            }
            others &= others - 1;
        }
        met &= !(1 << nearest);
        if crossings.entry[nearest] > ray.far + SPARE {
            return;
        }
        let start = [crossings.x[nearest], crossings.y[nearest]];
        statistics.leaf_tests += 1;
        let leaf = first + nearest as u32;
        let slopes = crossings.slopes.map(|slopes| slopes[nearest]);
        search_leaf(simd, scene, leaf, (start, slopes), (&mut *ray, &mut *work));
        if ray.is_done() {
            return;
        }
    }
}

/// One leaf against one ray, from a start in box coordinates and with what the box's rows say of
/// the direction.
#[simd]
fn search_leaf<S: Simd>(
    simd: S,
    scene: &Scene<'_>,
    index: u32,
    (start, slopes): ([f32; 2], [f32; 3]),
    (ray, work): (&mut SingleRay<'_>, &mut SingleWork),
) {
    let leaf = &scene.leaves[index as usize];
    let piece = &scene.set.pieces()[leaf.piece as usize];
    let error = piece.patch.residual_factor() * piece.patch.magnitude().max(ray.magnitude());
    let certified = is_certified(leaf, slopes, error);
    if certified && ray.starts_in(leaf) {
        return; // the one root is the one the ray starts on
    }
    if !certified && ray.departs_from(simd, (leaf, &piece.patch), error) {
        return;
    }
    let distances = Distances::new(simd, leaf, ray);
    if certified {
        let near = distances.newton(simd, start);
        // A start outside leads to a root outside, as a rule: the proof knows sooner.
        if near[0].abs().max(near[1].abs()) <= WIDENED[0][1] as f32 {
            let (outcome, steps) = finish(simd, leaf, &piece.patch, ray, (near, WIDENED, error));
            work.steps += steps;
            match outcome {
                Outcome::Missed => return,
                Outcome::Hit(found) => {
                    return keep(SingleHit { leaf: index, ..found }, ray, scene, work);
                }
                Outcome::Undecided => return work.rest.push(index),
                Outcome::NotFound => {}
            }
        }
    }
    // Too flat an angle, or the one root is outside: the ray's own proof.
    let Some(parts) = isolate(simd, distances, leaf, ray, error) else {
        work.rest.push(index);
        return;
    };
    for part in parts.iter() {
        let near = distances.newton(simd, part.middle);
        let domain = part.domain().map(|range| range.map(f64::from));
        let (outcome, steps) = finish(simd, leaf, &piece.patch, ray, (near, domain, error));
        work.steps += steps;
        match outcome {
            Outcome::Missed => {}
            Outcome::Hit(found) => keep(SingleHit { leaf: index, ..found }, ray, scene, work),
            Outcome::Undecided | Outcome::NotFound => {
                work.rest.push(index);
                return;
            }
        }
    }
}

/// The rectangle that certificates speak of, in box coordinates.
const WIDENED: [[f64; 2]; 2] = [[-1.0 - 2.0 * WIDENING, 1.0 + 2.0 * WIDENING]; 2];

/// Keeps a hit if it is the nearest so far, and trims keep it. Near an edge of the trims the
/// scalar search must judge it.
///
/// Of hits at the same place the piece that comes first counts, and its first part, whichever was
/// searched first: so the order of the search does not matter.
fn keep(found: SingleHit, ray: &mut SingleRay<'_>, scene: &Scene<'_>, work: &mut SingleWork) {
    let leaf = &scene.leaves[found.leaf as usize];
    // What is not nearer than the nearest by more than it may be off need not be judged.
    let beyond = |known: &SingleHit| found.z > known.z + 2.0 * found.z_error;
    if leaf.is_trimmed() && !work.hit.as_ref().is_some_and(beyond) {
        let piece = &scene.set.pieces()[leaf.piece as usize];
        match trim_side(piece, found.st, found.z_error) {
            Side::Inside => {}
            Side::Outside => return,
            Side::Edge { .. } => return work.rest.push(found.leaf),
        }
    }
    let nearer = work.hit.as_ref().is_none_or(|known| {
        found.z < known.z
            || (found.z == known.z && comes_first(scene.leaves, found.leaf, known.leaf))
    });
    if nearer {
        ray.shorten(found.z);
        work.hit = Some(found);
    }
}

/// Whether a leaf comes before another one in the order of pieces and their parts.
pub(super) fn comes_first(leaves: &[Leaf], leaf: u32, other: u32) -> bool {
    let order = |leaf: u32| {
        let leaf = &leaves[leaf as usize];
        (leaf.piece, leaf.place())
    };
    order(leaf) < order(other)
}

/// Whether a leaf's certificate speaks of a ray with these slopes, and rounding is small against
/// it.
#[inline(always)]
fn is_certified(leaf: &Leaf, [a, b, c]: [f32; 3], error: f64) -> bool {
    let certificate = &leaf.certificate;
    let [by_a, by_b, rounding] = certificate.turning();
    !leaf.has_pole()
        && c.abs() > by_a * a.abs() + by_b * b.abs() + rounding
        && f64::from(c.abs()) > f64::from(certificate.steep_per_error()) * error
}
