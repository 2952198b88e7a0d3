//! One ray against boxes, in f32, sixteen boxes at a time.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, SimdMask, f32x16};
use fearless_simd_macros::simd;

use crate::intersect::tree::nodes::{ChildCode, LANES, LeafBlock, Node};
use crate::math::bits::set_bits;
use crate::patch::OrientedBox;

/// Error bound, in scaled coordinates, of the f32 ray where it meets the scene (or the small part
/// of the scene whose coordinates these are) and of box entries along it, apart from what boxes
/// were grown by when they were made: coordinates of up to 5 and distances of up to 8, and four
/// roundings of each.
pub(crate) const BLUR: f32 = 4e-6;

/// Components of directions are taken to be at least this large: this moves the ray by far less
/// than [`BLUR`], and quotients stay finite.
pub(super) const LEAST_DIRECTION: f32 = 1e-12;

/// Slopes of directions along a box's side are taken to be at least this large: quotients stay
/// finite, and far larger than any distance that matters.
pub(super) const LEAST_SLOPE: f32 = 1e-12;

/// Slack, in scaled coordinates, when box entries and exits are compared: some roundings of f32 at
/// the distances a ray has inside the scene.
pub(crate) const BOX_SPARE: f32 = 4e-6;

// `OrientedBox::farthest_from`, which bounds how far rays that meet a box pass, allows for no more
// slack.
const _: () = assert!(BOX_SPARE as f64 <= OrientedBox::GROWTH);

/// Boxes still to be entered, and where the ray enters them.
pub(super) type Stack = Vec<(f32, ChildCode)>;

/// A ray in scaled coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct BoxRay {
    /// The origin, moved along the ray to be near the scene, and the unit direction.
    pub(super) origin: [f32; 3],
    pub(super) axis: [f32; 3],
    /// One over the direction; whether the upper plane of a box comes first; and the origin moved
    /// by [`BLUR`] for the nearer and the farther plane.
    inverse: [f32; 3],
    upper_first: [bool; 3],
    origin_for_near: [f32; 3],
    origin_for_far: [f32; 3],
    /// The part of the ray that is still searched.
    pub(super) near: f32,
    pub(super) far: f32,
}

impl BoxRay {
    /// A ray: its origin, its unit direction, one over that, and the part to be searched.
    #[inline(always)]
    pub(super) fn new(
        origin: [f32; 3],
        axis: [f32; 3],
        inverse: [f32; 3],
        [near, far]: [f32; 2],
    ) -> Self {
        let mut ray = Self { origin, axis, near, far, ..Self::default() };
        for k in 0..3 {
            // No larger than that, so that infinite ones become finite.
            let inverse = inverse[k].abs().min(1.0 / LEAST_DIRECTION).copysign(inverse[k]);
            let blur = BLUR.copysign(inverse);
            ray.inverse[k] = inverse;
            ray.upper_first[k] = inverse < 0.0;
            ray.origin_for_near[k] = origin[k] + blur;
            ray.origin_for_far[k] = origin[k] - blur;
        }
        ray
    }

    /// Returns where the ray enters each of a node's boxes, and which boxes it meets.
    ///
    /// The nearer planes are moved towards the ray's origin and the farther ones away from it, by
    /// more than the rounding errors of origin, direction and quotients together: so no box is
    /// entered too late or left too early.
    #[inline(always)] // a call would cost as much as what is done here
    pub(super) fn entries<S: Simd>(&self, simd: S, node: &Node) -> (f32x16<S>, u32) {
        let mut entries = [f32x16::splat(simd, 0.0); 3];
        let mut exits = entries;
        for axis in 0..3 {
            let (planes, upper_first) = (&node.planes[axis], self.upper_first[axis]);
            let inverse = f32x16::splat(simd, self.inverse[axis]);
            let to_near = f32x16::from_slice(simd, &planes[usize::from(upper_first)])
                - f32x16::splat(simd, self.origin_for_near[axis]);
            let to_far = f32x16::from_slice(simd, &planes[usize::from(!upper_first)])
                - f32x16::splat(simd, self.origin_for_far[axis]);
            (entries[axis], exits[axis]) = (to_near * inverse, to_far * inverse);
        }
        // In pairs: of four operations, two wait for each other.
        let near = f32x16::splat(simd, self.near).max(entries[0]).max(entries[1].max(entries[2]));
        let far = f32x16::splat(simd, self.far).min(exits[0]).min(exits[1].min(exits[2]));
        (near, near.simd_le(far).to_bitmask() as u32)
    }

    /// Returns the nearest child whose box the ray meets; pushes the others onto the stack, the
    /// nearest last.
    #[inline(always)]
    pub(super) fn enter<S: Simd>(
        &self,
        simd: S,
        node: &Node,
        stack: &mut Stack,
    ) -> Option<ChildCode> {
        let mut entries = BoxEntries::NONE;
        let met = self.entries_into(simd, node, &mut entries);
        nearest_of(simd, stack, &entries.0, met, node)
    }

    /// Stores where the ray enters each of a node's boxes; returns which boxes it meets.
    // Inlined, the ray would be spread over lanes before the loop over nodes, and kept so in
    // memory.
    #[inline(never)]
    #[simd]
    fn entries_into<S: Simd>(&self, simd: S, node: &Node, entries: &mut BoxEntries) -> u32 {
        let (near, met) = self.entries(simd, node);
        near.store_slice(&mut entries.0);
        met
    }

    /// The slab test of sixteen oriented boxes.
    #[simd]
    pub(super) fn pass<S: Simd>(&self, simd: S, block: &LeafBlock, passages: &mut Passages) {
        let one = f32x16::splat(simd, 1.0);
        let slabs = Slabs::new(simd, block, self.origin, self.axis);
        passages.met = slabs.met(simd, [self.near, self.far]);

        // Where the middle plane is crossed, if inside the box. What is known of the ray's end must
        // not influence this: the start would depend on what was searched before.
        let Slabs { entry, exit, at, along, last_inverse } = slabs;
        let z = (-at[2] * last_inverse).max(entry).min(exit);
        let x = z.mul_add(along[0], at[0]).max(-one).min(one);
        let y = z.mul_add(along[1], at[1]).max(-one).min(one);
        entry.store_slice(&mut passages.entry);
        x.store_slice(&mut passages.x);
        y.store_slice(&mut passages.y);
        for k in 0..3 {
            along[k].store_slice(&mut passages.slopes[k]);
        }
    }
}

/// A ray in the coordinates of sixteen oriented boxes.
pub(super) struct Slabs<S: Simd> {
    /// Where the ray enters and leaves the boxes.
    entry: f32x16<S>,
    exit: f32x16<S>,
    /// The coordinates of the ray's origin, and how they change along the ray.
    at: [f32x16<S>; 3],
    along: [f32x16<S>; 3],
    /// One over the last of these changes.
    last_inverse: f32x16<S>,
}

impl<S: Simd> Slabs<S> {
    #[inline(always)] // so that a block's rows are read once for many rays
    pub(super) fn new(simd: S, block: &LeafBlock, origin: [f32; 3], axis: [f32; 3]) -> Self {
        let (one, least) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, LEAST_SLOPE));
        let mut slabs = Self {
            entry: f32x16::splat(simd, f32::MIN),
            exit: f32x16::splat(simd, f32::MAX),
            at: [one; 3],
            along: [one; 3],
            last_inverse: one,
        };
        for k in 0..3 {
            let rx = f32x16::from_slice(simd, &block.rows[4 * k]);
            let ry = f32x16::from_slice(simd, &block.rows[4 * k + 1]);
            let rz = f32x16::from_slice(simd, &block.rows[4 * k + 2]);
            let offset = f32x16::from_slice(simd, &block.rows[4 * k + 3]);
            let [ox, oy, oz] = origin;
            let from = rz.mul_add(f32x16::splat(simd, oz), -offset);
            let from = ry.mul_add(f32x16::splat(simd, oy), from);
            let at = rx.mul_add(f32x16::splat(simd, ox), from);
            let [dx, dy, dz] = axis;
            let slope = ry.mul_add(f32x16::splat(simd, dy), rz * f32x16::splat(simd, dz));
            let slope = rx.mul_add(f32x16::splat(simd, dx), slope);
            let steep = slope.abs().simd_gt(least);
            let along = steep.select(slope, least.copysign(slope));
            let inverse = one / along;
            let (middle, half) = (-at * inverse, inverse.abs());
            slabs.entry = slabs.entry.max(middle - half);
            slabs.exit = slabs.exit.min(middle + half);
            (slabs.at[k], slabs.along[k], slabs.last_inverse) = (at, along, inverse);
        }
        slabs
    }

    /// The boxes that the ray meets between two places along it, a bit each.
    #[inline(always)]
    pub(super) fn met(&self, simd: S, [near, far]: [f32; 2]) -> u32 {
        let (near, far) = (f32x16::splat(simd, near), f32x16::splat(simd, far));
        let spare = f32x16::splat(simd, BOX_SPARE);
        self.entry.max(near).simd_le(self.exit.min(far) + spare).to_bitmask() as u32
    }
}

/// Where a ray enters sixteen boxes.
#[repr(align(64))]
struct BoxEntries([f32; LANES]);

impl BoxEntries {
    const NONE: Self = Self([0.0; LANES]);
}

/// Returns the nearest of the children that are met, and pushes the others onto the stack, the
/// nearest last.
///
/// More than two are ordered without a branch for which is nearer: measured on a Xeon, incoherent
/// rays are traced 1.00 to 1.05 times as fast as with sorting by branches, rays of a picture 0.94 to
/// 0.99 times; these are better traced in packets.
#[inline(always)]
fn nearest_of<S: Simd>(
    simd: S,
    stack: &mut Stack,
    entries: &[f32; LANES],
    met: u32,
    node: &Node,
) -> Option<ChildCode> {
    let without_first = met & met.wrapping_sub(1);
    if without_first == 0 {
        return (met != 0).then(|| node.child[met.trailing_zeros() as usize]);
    }
    if without_first & (without_first - 1) == 0 {
        // The nearer of two need not go through the stack.
        let [first, last] = [met, without_first].map(|bits| bits.trailing_zeros() as usize);
        let last_is_nearer = entries[last] <= entries[first];
        let (near, far) = if last_is_nearer { (last, first) } else { (first, last) };
        stack.push((entries[far], node.child[far]));
        return Some(node.child[near]);
    }
    push_met(simd, stack, entries, met, node);
    stack.pop().map(|(_, child)| child)
}

/// Pushes all children that are met onto the stack, the nearest last.
#[inline(always)]
pub(super) fn push_met<S: Simd>(
    simd: S,
    stack: &mut Stack,
    entries: &[f32; LANES],
    met: u32,
    node: &Node,
) {
    push_in_order(simd, stack, entries, met, |k| (entries[k], node.child[k]));
}

/// Pushes `made(k)` onto a stack for each box `k` that is met, that of the nearest box last.
///
/// For each box, the boxes that come before it are counted, in all lanes at once: no branch depends
/// on which box is nearer, since that could not be predicted, and nothing is moved once it is
/// written. The entries must not be NaN: else two boxes would have one place.
#[inline(always)]
pub(super) fn push_in_order<S: Simd, T: Copy + Default>(
    simd: S,
    stack: &mut Vec<T>,
    entries: &[f32; LANES],
    met: u32,
    made: impl Fn(usize) -> T,
) {
    debug_assert!(set_bits(met).all(|k| !entries[k].is_nan()));
    let near = f32x16::from_slice(simd, entries);
    let bottom = stack.len();
    // Room for sixteen: with a constant number no call is needed.
    stack.extend_from_slice(&[T::default(); LANES]);
    stack.truncate(bottom + met.count_ones() as usize);
    let places = &mut stack[bottom..];
    for k in set_bits(met) {
        let entry = f32x16::splat(simd, entries[k]);
        let farther = near.simd_gt(entry).to_bitmask() as u32;
        // Of boxes entered at the same place the last comes first.
        let as_far = near.simd_ge(entry).to_bitmask() as u32 & ((1 << k) - 1);
        let before = met & (farther | as_far);
        places[before.count_ones() as usize] = made(k);
    }
}

/// Which of sixteen leaves' boxes a ray meets, where it enters them, where it crosses their
/// middles, and its slopes.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
pub(super) struct Passages {
    pub(super) met: u32,
    pub(super) entry: [f32; LANES],
    pub(super) x: [f32; LANES],
    pub(super) y: [f32; LANES],
    /// The slope of the direction by each row.
    pub(super) slopes: [[f32; LANES]; 3],
}

impl Passages {
    /// No box.
    pub(super) const NONE: Self = Self {
        met: 0,
        entry: [0.0; LANES],
        x: [0.0; LANES],
        y: [0.0; LANES],
        slopes: [[0.0; LANES]; 3],
    };

    /// Where the ray crosses a leaf's middle.
    #[inline(always)]
    pub(super) fn place_of(&self, k: usize) -> [f32; 2] {
        [self.x[k], self.y[k]]
    }

    /// The slopes of the direction by a leaf's rows.
    #[inline(always)]
    pub(super) fn slopes_of(&self, k: usize) -> [f32; 3] {
        // Lane by lane: `map` would copy the lanes first.
        [self.slopes[0][k], self.slopes[1][k], self.slopes[2][k]]
    }
}

/// The box that is entered first, of those whose bit is set in `met`, which is not zero.
#[inline(always)]
pub(super) fn first_entered(entry: &[f32; LANES], met: u32) -> usize {
    let mut first = met.trailing_zeros() as usize;
    for k in set_bits(met & (met - 1)) {
        if entry[k] < entry[first] {
            first = k;
        }
    }
    first
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::intersect::Kernel;
    use crate::intersect::level::dispatch;
    use crate::intersect::tree::nodes::Child;

    #[test]
    fn infinite_inverses_become_finite_and_keep_their_signs() {
        let inverse = [f32::INFINITY, f32::NEG_INFINITY, -1.0];
        let ray = BoxRay::new([0.0; 3], [0.0, -0.0, -1.0], inverse, [0.0, 1.0]);
        assert_eq!(ray.inverse, [1.0 / LEAST_DIRECTION, -1.0 / LEAST_DIRECTION, -1.0]);
        assert_eq!(ray.upper_first, [false, true, true]);
    }

    proptest! {
        #[test]
        fn children_are_put_down_in_order(
            entries in prop::array::uniform16(prop_oneof![-2.0..2.0f32, Just(-1.0f32), Just(0.5f32)]),
            met in prop_oneof![
                0u32..1 << LANES,
                (0..LANES, 0..LANES).prop_map(|(a, b)| 1 << a | 1 << b),
            ],
        ) {
            let mut node = Node::empty();
            for k in 0..LANES {
                node.child[k] = ChildCode::new(Child::Block(k as u32));
            }
            let before = (7.0, ChildCode::new(Child::Node(3)));
            let (mut stack, mut rest) = (vec![before], vec![before]);
            let nearest = dispatch!(Kernel::best_level(), simd => {
                push_met(simd, &mut stack, &entries, met, &node);
                nearest_of(simd, &mut rest, &entries, met, &node)
            });
            let mut sorted: Vec<_> = set_bits(met).map(|k| (entries[k], node.child[k])).collect();
            sorted.sort_by(|a, b| b.0.total_cmp(&a.0)); // stable
            sorted.insert(0, before);
            let told = |stack: &Stack| -> Vec<_> {
                stack.iter().map(|&(entry, code)| (entry, code.child())).collect()
            };
            prop_assert_eq!(told(&stack), told(&sorted));
            let last = if met == 0 { None } else { sorted.pop() };
            let code = |child: Option<ChildCode>| child.map(ChildCode::child);
            prop_assert_eq!(code(nearest), code(last.map(|(_, child)| child)));
            prop_assert_eq!(told(&rest), told(&sorted));
        }
    }
}
