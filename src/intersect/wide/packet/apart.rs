//! Separates the rays of a packet where they are too different to be treated as one.
//!
//! Bounds shared by all rays of the packet are enough as long as the rays are close together and
//! point alike. Rays that leave several bodies, some behind others, or a floor on which a small body
//! stands, have bounds that contain everything in between: of the leaves that these bounds meet,
//! ninety in a hundred and more are met by no ray. The bounds of rays that point anywhere meet
//! everything around them. So such rays are tested one by one where boxes are small compared with
//! their distances: at a node, sixteen rays or sixteen boxes at a time; also at a block of leaves
//! that not all rays come to, if that is less work than testing each leaf.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;

use super::load::bounds;
use super::rays::Packet;
use super::shared_bounds::enter_block;
use crate::intersect::tree::nodes::{LANES, LeafBlock, Node};
use crate::intersect::wide::PACKET;
use crate::intersect::wide::box_ray::{BLUR, BoxRay, LEAST_DIRECTION, Slabs};
use crate::intersect::wide::lane_rays::PacketBounds;
use crate::intersect::wide::vectors::{Lanes3f, lane_bits, load3};
use crate::math::bits::set_bits;

/// All rays.
pub(super) const ALL: u64 = u64::MAX;

/// Rays that are farther apart than this part of a box's width where they enter it are tested one
/// by one. Measured against one decision for a packet, by where its rays start and how wide the
/// scene's leaves are: shadow rays of a teapot on a table are 2 times as fast, of bodies on a floor
/// 1.4 times, of models of many parts 1.0 to 1.25 times; rays of pictures 1.0 to 1.06 times. A half
/// of this value is as good; of twice and four times the value, shadow rays are 0.98 and 0.9 times
/// as fast.
const FAR_APART: f32 = 0.5;

/// If more leaves of a block than this are met, each sixteen rays of a packet are tested by
/// themselves: the leaves are then small compared with the packet, and most would be tested for
/// nothing by other sixteens.
const FEW: u32 = 4;

/// A test of one ray against a node's sixteen boxes counts as this many tests of sixteen rays
/// against one of them. Measured against 1: ambient occlusion is 1.0 to 1.05 times as fast; 4 is as
/// good.
const RAY_AGAINST_NODE: u32 = 2;

/// A search of one leaf for sixteen rays counts as this many tests of one ray against a block.
/// Measured against 1: shadow rays are 1.0 to 1.07 times as fast; 4 is as good.
const SEARCH_AGAINST_RAY: u32 = 2;

/// What is known of a packet's rays beyond their shared bounds.
#[derive(Debug, Default)]
pub(super) struct Apart {
    /// The bounds of each sixteen rays, once they have been asked for.
    groups: Option<[PacketBounds; PACKET / LANES]>,
    /// How far apart the rays start; infinite where their directions have nothing in common.
    spread: f32,
    /// How much farther apart they are after each unit of length.
    fan: f32,
    /// One over the directions, once they have been asked for.
    inverse: Box<Inverse>,
}

/// One over the directions of a packet's rays.
#[derive(Debug)]
struct Inverse {
    is_known: bool,
    axis: Lanes3f,
}

impl Default for Inverse {
    fn default() -> Self {
        Self { is_known: false, axis: [[0.0; PACKET]; 3] }
    }
}

impl Inverse {
    /// The inverses, computed if they are not known yet.
    #[simd]
    fn of<S: Simd>(&mut self, simd: S, packet: &Packet) -> &Lanes3f {
        if !self.is_known {
            let (one, least) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, LEAST_DIRECTION));
            for base in (0..PACKET).step_by(LANES) {
                let axis = load3(simd, &packet.scaled.axis, base);
                for i in 0..3 {
                    let along =
                        axis[i].abs().simd_lt(least).select(least.copysign(axis[i]), axis[i]);
                    (one / along).store_slice(&mut self.axis[i][base..base + LANES]);
                }
            }
            self.is_known = true;
        }
        &self.axis
    }
}

impl Apart {
    /// Prepares for a packet's rays in their present scaled coordinates.
    pub(super) fn set(&mut self, packet: &Packet) {
        self.groups = None;
        self.inverse.is_known = false;
        let bounds = &packet.scaled.bounds;
        // Where the directions differ in sign in two coordinates, the bounds say next to nothing.
        let mixed = bounds.sign.iter().filter(|&&sign| sign == 0).count();
        let spread = (bounds.origin_max - bounds.origin_min).max_element();
        self.spread = if mixed > 1 { f32::INFINITY } else { spread };
        self.fan = (bounds.axis_max - bounds.axis_min).max_element();
    }

    /// Whether the directions have nothing in common, so that shared bounds say next to nothing.
    #[inline(always)]
    pub(super) fn are_mixed(&self) -> bool {
        self.spread == f32::INFINITY
    }

    /// Returns, for each child of a node, which of `rays` may meet its box, one bit a ray: all of
    /// them where the box is so large that they are alike for it. Only children whose bit is set in
    /// `met` count; `entries` bound where the packet enters their boxes.
    #[inline(always)]
    pub(super) fn meeting<S: Simd>(
        &mut self,
        simd: S,
        packet: &Packet,
        node: &Node,
        (entries, met): (&[f32; LANES], u32),
        rays: u64,
    ) -> [u64; LANES] {
        let small = if self.are_mixed() {
            met
        } else {
            let entry = f32x16::from_slice(simd, entries).max(f32x16::splat(simd, 0.0));
            let spread =
                entry.mul_add(f32x16::splat(simd, self.fan), f32x16::splat(simd, self.spread));
            met & narrower(simd, node, spread * f32x16::splat(simd, 1.0 / FAR_APART))
        };
        if small == 0 {
            return [rays; LANES];
        }
        let inverse = self.inverse.of(simd, packet);
        meeting_one_by_one(simd, packet, inverse, node, small, rays)
    }

    /// Returns, for every sixteen rays, which leaves of a block those of `rays` may meet, of the
    /// leaves whose bit is set in `met`: sixteen bits for the first rays, sixteen for the next.
    #[simd]
    pub(super) fn leaves<S: Simd>(
        &mut self,
        simd: S,
        block: &LeafBlock,
        met: u32,
        packet: &Packet,
        rays: u64,
    ) -> u64 {
        if rays != ALL || self.are_mixed() {
            return leaves_of_rays(simd, block, met, packet, rays);
        }
        if met.count_ones() <= FEW {
            return for_all(met);
        }
        let groups = self.groups.get_or_insert_with(|| {
            std::array::from_fn(|k| bounds(simd, packet, LANES * k..LANES * (k + 1)))
        });
        let mut apart = 0;
        for (k, bounds) in groups.iter().enumerate() {
            let of_group = met & enter_block(simd, block, bounds, packet.scaled.farthest).1;
            apart |= u64::from(of_group) << (LANES * k);
        }
        apart
    }
}

/// Repeats the same leaves for every sixteen rays.
#[inline(always)]
fn for_all(met: u32) -> u64 {
    u64::from(met) * EVERY_SIXTEEN
}

/// The first bit of every sixteen.
const EVERY_SIXTEEN: u64 = 0x0001_0001_0001_0001;
const _: () = assert!(PACKET == u64::BITS as usize && LANES == 16);

/// The first bit of every sixteen bits of which any is set.
fn groups(rays: u64) -> u64 {
    let mut any = rays;
    for shift in [8, 4, 2, 1] {
        any |= any >> shift;
    }
    any & EVERY_SIXTEEN
}

/// The boxes that are nowhere wider than `width`, a bit each.
#[inline(always)]
fn narrower<S: Simd>(simd: S, node: &Node, width: f32x16<S>) -> u32 {
    let mut widest = f32x16::splat(simd, 0.0);
    for [low, high] in &node.planes {
        widest = widest.max(f32x16::from_slice(simd, high) - f32x16::from_slice(simd, low));
    }
    lane_bits(widest.simd_le(width))
}

/// See [`Apart::meeting`]; only `children` are tested.
#[simd]
fn meeting_one_by_one<S: Simd>(
    simd: S,
    packet: &Packet,
    inverse: &Lanes3f,
    node: &Node,
    children: u32,
    rays: u64,
) -> [u64; LANES] {
    let mut meeting = [rays; LANES];
    for child in set_bits(children) {
        meeting[child] = 0;
    }
    let by_sixteens = groups(rays).count_ones() * children.count_ones();
    if RAY_AGAINST_NODE * rays.count_ones() < by_sixteens {
        add_ray_by_ray(simd, packet, inverse, node, children, rays, &mut meeting);
    } else {
        add_box_by_box(simd, packet, inverse, node, children, rays, &mut meeting);
    }
    meeting
}

/// Adds those of `rays` that meet the boxes of `children`, each ray against all boxes of the node.
#[inline(always)]
fn add_ray_by_ray<S: Simd>(
    simd: S,
    Packet { scaled, .. }: &Packet,
    inverse: &Lanes3f,
    node: &Node,
    children: u32,
    rays: u64,
    meeting: &mut [u64; LANES],
) {
    for k in set_bits(rays) {
        let of = |lanes: &Lanes3f| [lanes[0][k], lanes[1][k], lanes[2][k]];
        let range = [scaled.near[k], scaled.far[k]];
        let ray = BoxRay::new(of(&scaled.origin), of(&scaled.axis), of(inverse), range);
        let (_, entered) = ray.entries(simd, node);
        for child in set_bits(entered & children) {
            meeting[child] |= 1 << k;
        }
    }
}

/// The same, each box against sixteen rays. The planes are moved outwards by more than the rounding
/// error, as in [`BoxRay`].
#[inline(always)]
fn add_box_by_box<S: Simd>(
    simd: S,
    Packet { scaled, .. }: &Packet,
    inverse: &Lanes3f,
    node: &Node,
    children: u32,
    rays: u64,
    meeting: &mut [u64; LANES],
) {
    for base in (0..PACKET).step_by(LANES) {
        let some = (rays >> base) as u32 & 0xffff;
        if some == 0 {
            continue;
        }
        let near_f = f32x16::from_slice(simd, &scaled.near[base..base + LANES]);
        let far_f = f32x16::from_slice(simd, &scaled.far[base..base + LANES]);
        let inverse = load3(simd, inverse, base);
        let (mut for_low, blur) = (load3(simd, &scaled.origin, base), f32x16::splat(simd, BLUR));
        let mut for_high = for_low;
        for axis in 0..3 {
            for_low[axis] += blur;
            for_high[axis] -= blur;
        }
        for child in set_bits(children) {
            let (mut near, mut far) = (near_f, far_f);
            for axis in 0..3 {
                let low = f32x16::splat(simd, node.planes[axis][0][child]);
                let high = f32x16::splat(simd, node.planes[axis][1][child]);
                let a = (low - for_low[axis]) * inverse[axis];
                let b = (high - for_high[axis]) * inverse[axis];
                near = near.max(a.min(b));
                far = far.min(a.max(b));
            }
            meeting[child] |= u64::from(some & lane_bits(near.simd_le(far))) << base;
        }
    }
}

/// The leaves that rays meet, tested one by one; or all of `met` for each sixteen that have a ray,
/// if that leaves fewer to test.
#[simd]
fn leaves_of_rays<S: Simd>(
    simd: S,
    block: &LeafBlock,
    met: u32,
    packet: &Packet,
    rays: u64,
) -> u64 {
    let groups = groups(rays);
    let searches = groups.count_ones() * met.count_ones();
    if rays.count_ones() > SEARCH_AGAINST_RAY * searches {
        return u64::from(met) * groups;
    }
    let mut apart = 0;
    let ([x, y, z], [dx, dy, dz]) = (&packet.scaled.origin, &packet.scaled.axis);
    for k in set_bits(rays) {
        let slabs = Slabs::new(simd, block, [x[k], y[k], z[k]], [dx[k], dy[k], dz[k]]);
        let of_ray = met & slabs.met(simd, [packet.scaled.near[k], packet.scaled.far[k]]);
        apart |= u64::from(of_ray) << (k / LANES * LANES);
    }
    apart
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::level::dispatch;
    use crate::intersect::wide::packet::load::load;
    use crate::intersect::{Kernel, Query, SurfaceBvh};
    use crate::math::Ray;
    use crate::math::testing::same_cases;

    proptest! {
        #[test]
        fn bits_of_sixteens_are_where_their_rays_are(
            rays in any::<u64>(),
            kept in any::<[bool; PACKET / LANES]>(),
            met in 0u32..1 << LANES,
        ) {
            let sixteen = |bits: u64, k: usize| (bits >> (LANES * k)) as u32 & 0xffff;
            let rays = (0..PACKET / LANES).filter(|&k| kept[k]).fold(0, |all, k| {
                all | u64::from(sixteen(rays, k)) << (LANES * k)
            });
            for k in 0..PACKET / LANES {
                prop_assert_eq!(sixteen(groups(rays), k), u32::from(sixteen(rays, k) != 0));
                prop_assert_eq!(sixteen(for_all(met), k), met);
            }
        }
    }

    /// Whether a ray meets a box, by slabs in f64.
    fn meets(packet: &Packet, k: usize, node: &Node, child: usize) -> bool {
        let of = |lanes: &Lanes3f, axis: usize| f64::from(lanes[axis][k]);
        let mut range = [packet.scaled.near[k], packet.scaled.far[k]].map(f64::from);
        for axis in 0..3 {
            let (from, along) = (of(&packet.scaled.origin, axis), of(&packet.scaled.axis, axis));
            let planes = [0, 1].map(|end| f64::from(node.planes[axis][end][child]));
            if along == 0.0 {
                if from < planes[0] || from > planes[1] {
                    return false;
                }
                continue;
            }
            let [a, b] = planes.map(|plane| (plane - from) / along);
            range = [range[0].max(a.min(b)), range[1].min(a.max(b))];
        }
        range[0] <= range[1]
    }

    /// No ray that meets a box is left out: of rays that leave one place in all directions, that
    /// run side by side, near to each other or not, or that fan out from an eye; some along the
    /// axes. Where some are, the others meet the box, but for one in twenty.
    #[test]
    fn no_ray_that_meets_a_box_is_left_out() {
        let bvh = SurfaceBvh::build(&[shapes::torus(1.0, 0.4).unwrap()]).unwrap();
        let view = bvh.view();
        let (met_in_all, told) = (Cell::new(0), Cell::new((0, 0)));
        let point = || [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64].prop_map(DVec3::from_array);
        let axis = prop_oneof![point(), Just(DVec3::X), Just(-DVec3::Y), Just(DVec3::Z)];
        let rays = (point(), axis, -4.0..0.5f64, -4.0..0.5f64, 0u32..4);
        let offsets = prop::collection::vec((point(), point()), PACKET);
        let masks = (any::<u64>(), any::<u64>(), any::<u64>(), any::<u32>());
        let config = same_cases(2_000);
        proptest!(config, |(
            (origin, axis, apart, fan, which) in rays,
            offsets in offsets,
            (a, b, c, met_bits) in masks,
        )| {
            let queries: Vec<Query> = offsets
                .iter()
                .map(|&(from, along)| {
                    let origin = 2.0 * origin + 10f64.powf(apart) * from;
                    let axis = axis + if which & 1 == 0 { DVec3::ZERO } else { 10f64.powf(fan) * along };
                    Query::primary(Ray::new(origin, axis.normalize_or(DVec3::Z)).unwrap())
                })
                .collect();
            let rays = match which { 0 => ALL, 1 => a, 2 => a & b, _ => a & b & c };
            let mut packet = Packet::default();
            for node in &view.tree.nodes {
                let filled = node.filled().fold(0, |bits, k| bits | 1 << k);
                let asked = filled & if which == 0 { u32::MAX } else { met_bits };
                let meeting = dispatch!(Kernel::best_level(), simd => {
                    load(simd, &mut packet, &queries, &view);
                    let mut apart = Apart::default();
                    apart.set(&packet);
                    apart.meeting(simd, &packet, node, (&[0.0; LANES], asked), rays)
                });
                for child in set_bits(asked) {
                    let kept = meeting[child];
                    prop_assert_eq!(kept & !rays, 0);
                    let meets = |&k: &usize| meets(&packet, k, node, child);
                    let met = set_bits(rays).filter(meets).fold(0, |bits, k| bits | 1 << k);
                    prop_assert_eq!(met & !kept, 0, "child {}: {:b}, but {:b}", child, met, kept);
                    met_in_all.set(met_in_all.get() + met.count_ones());
                    if kept != rays {
                        let [met, kept] = [met, kept].map(u64::count_ones);
                        told.set((told.get().0 + met, told.get().1 + kept));
                    }
                }
            }
        });
        let (met, kept) = told.get();
        assert!(met > 10_000 && kept < met + met / 20, "{met} {kept} {met_in_all:?}");
    }
}
