//! Separates the rays of a packet where they are too different to be treated as one.
//!
//! Bounds shared by all rays of the packet are enough as long as the rays are close together and
//! point alike. Rays that leave several bodies, some behind others, or a floor on which a small
//! body stands, have bounds that contain everything in between: of the leaves that these bounds
//! meet, ninety in a hundred and more are met by no ray. The bounds of rays that point anywhere
//! meet everything around them.
//!
//! So each ray is tested by itself against the boxes that are small compared with how far apart the
//! rays are there. A node's boxes are tested against sixteen rays at a time or, if few rays have
//! come to the node, the rays against sixteen boxes at a time. The leaves of a block are told apart
//! where that is less work than searching them all: for each ray, or for each sixteen rays by
//! bounds of their own.

use fearless_simd::{Select, Simd, SimdBase, SimdFloat, f32x16};
use fearless_simd_macros::simd;

use super::load::bounds;
use super::rays::Packet;
use super::shared_bounds::enter_block;
use crate::intersect::tree::nodes::{LANES, LeafBlock, Node};
use crate::intersect::wide::PACKET;
use crate::intersect::wide::box_ray::{BLUR, BoxRay, LEAST_DIRECTION, Slabs};
use crate::intersect::wide::lane_rays::{PacketBounds, ScaledRays};
use crate::intersect::wide::vectors::{Lanes3f, lane_bits, load3};
use crate::math::bits::set_bits;

/// Rays that are farther apart than this part of a box's width where they enter it are tested one
/// by one. Measured: when one decision was taken for a packet, shadow rays of a teapot on a table
/// took twice as long, those of models of many parts up to 1.25 times. With a quarter, rates are
/// the same; with one and two, shadow rays are traced at 0.98 and 0.9 of them.
const FAR_APART: f32 = 0.5;

/// A test of one ray against a node's sixteen boxes counts as this many tests of sixteen rays
/// against one of them. Measured against 1: ambient occlusion is 1.0 to 1.05 times as fast; 4 is as
/// good.
const RAY_AGAINST_NODE: u32 = 2;

/// A search of one leaf for sixteen rays counts as this many tests of one ray against a block.
/// Measured against 1: shadow rays are 1.0 to 1.07 times as fast; 4 is as good.
const SEARCH_AGAINST_RAY: u32 = 2;

/// More rays than this are tested against a block sixteen by sixteen, by bounds that the sixteen
/// share, unless they point anywhere. Measured against 16: shadow rays are 1.02 times as fast; if
/// all rays are tested one by one, those of pictures of sheets slow down to 0.96.
const MANY: u32 = 32;

/// Rays of which a coordinate of the unit directions differs by more than this point anywhere: what
/// bounds that they share say of a block's leaves is not worth its cost. Measured: 0.5 and 1.5 are as
/// good.
const ANYWHERE: f32 = 1.0;

/// What is known of a packet's rays beyond their shared bounds.
#[derive(Debug, Default)]
pub(super) struct Apart {
    /// The bounds of each sixteen rays, once they have been asked for.
    groups: Option<[PacketBounds; PACKET / LANES]>,
    /// Whether the shared bounds say next to nothing of a node's boxes.
    blind: bool,
    /// How far apart the rays start, at most.
    spread: f32,
    /// How much farther apart they are after each unit of length, at most.
    fan: f32,
    /// One over the directions, once they have been asked for.
    inverse: Inverse,
}

/// One over the directions of a packet's rays. The memory is kept from packet to packet.
#[derive(Debug)]
#[repr(align(64))]
struct Inverse {
    of: Lanes3f,
    is_known: bool,
}

impl Default for Inverse {
    fn default() -> Self {
        Self { of: [[0.0; PACKET]; 3], is_known: false }
    }
}

impl Inverse {
    /// The inverses, computed if they are not known yet.
    #[simd]
    fn find<S: Simd>(&mut self, simd: S, packet: &Packet) -> &Lanes3f {
        if !self.is_known {
            let (one, least) = (f32x16::splat(simd, 1.0), f32x16::splat(simd, LEAST_DIRECTION));
            for base in (0..PACKET).step_by(LANES) {
                let axis = load3(simd, &packet.scaled.axis, base);
                for i in 0..3 {
                    let along =
                        axis[i].abs().simd_lt(least).select(least.copysign(axis[i]), axis[i]);
                    (one / along).store_slice(&mut self.of[i][base..base + LANES]);
                }
            }
            self.is_known = true;
        }
        &self.of
    }
}

impl Apart {
    /// Prepares for a packet's rays in their present scaled coordinates.
    pub(super) fn set(&mut self, packet: &Packet) {
        self.groups = None;
        self.inverse.is_known = false;
        let bounds = &packet.scaled.bounds;
        // Coordinates in which the directions differ in sign decide nothing at a node.
        self.blind = bounds.sign.iter().filter(|&&sign| sign == 0).count() > 1;
        self.spread = (bounds.origin_max - bounds.origin_min).max_element();
        self.fan = (bounds.axis_max - bounds.axis_min).max_element();
    }

    /// Whether the rays point anywhere: see [`ANYWHERE`].
    #[inline(always)]
    pub(super) fn point_anywhere(&self) -> bool {
        self.fan > ANYWHERE
    }

    /// Returns, for each child of a node, which of `rays` may meet its box, one bit a ray: all of
    /// them where the box is so large that they are alike for it. Only children whose bit is set in
    /// `met` count, which must exist; the packet enters their boxes no earlier than at `entries`.
    #[inline(always)]
    pub(super) fn meeting<S: Simd>(
        &mut self,
        simd: S,
        packet: &Packet,
        node: &Node,
        (entries, met): (&[f32; LANES], u32),
        rays: u64,
    ) -> [u64; LANES] {
        let small = if self.blind {
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
        let inverse = self.inverse.find(simd, packet);
        OneByOne { scaled: &packet.scaled, inverse, node, children: small, rays }.meeting(simd)
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
        let sixteens = groups(rays);
        let searches = sixteens.count_ones() * met.count_ones();
        if rays.count_ones() > SEARCH_AGAINST_RAY * searches {
            return u64::from(met) * sixteens;
        }
        if rays.count_ones() <= MANY || self.point_anywhere() {
            return leaves_of_rays(simd, block, met, packet, rays);
        }
        let groups = self.groups.get_or_insert_with(|| {
            std::array::from_fn(|k| bounds(simd, packet, LANES * k..LANES * (k + 1)))
        });
        let mut apart = 0;
        for (k, bounds) in groups.iter().enumerate() {
            if sixteens >> (LANES * k) & 1 != 0 {
                let of_group = met & enter_block(simd, block, bounds, packet.scaled.farthest).1;
                apart |= u64::from(of_group) << (LANES * k);
            }
        }
        apart
    }
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

/// Which of some rays meet which of a node's boxes?
struct OneByOne<'a> {
    scaled: &'a ScaledRays,
    /// One over the rays' directions.
    inverse: &'a Lanes3f,
    node: &'a Node,
    children: u32,
    rays: u64,
}

impl OneByOne<'_> {
    /// See [`Apart::meeting`].
    #[simd]
    fn meeting<S: Simd>(&self, simd: S) -> [u64; LANES] {
        let mut meeting = [self.rays; LANES];
        for child in set_bits(self.children) {
            meeting[child] = 0;
        }
        let by_sixteens = groups(self.rays).count_ones() * self.children.count_ones();
        if RAY_AGAINST_NODE * self.rays.count_ones() < by_sixteens {
            self.add_ray_by_ray(simd, &mut meeting);
        } else {
            self.add_box_by_box(simd, &mut meeting);
        }
        meeting
    }

    /// Adds the rays that meet the boxes, each ray against all boxes of the node.
    #[inline(always)]
    fn add_ray_by_ray<S: Simd>(&self, simd: S, meeting: &mut [u64; LANES]) {
        let Self { scaled, inverse, node, .. } = self;
        for k in set_bits(self.rays) {
            let of = |lanes: &Lanes3f| [lanes[0][k], lanes[1][k], lanes[2][k]];
            let range = [scaled.near[k], scaled.far[k]];
            let ray = BoxRay::new(of(&scaled.origin), of(&scaled.axis), of(inverse), range);
            let (_, entered) = ray.entries(simd, node);
            for child in set_bits(entered & self.children) {
                meeting[child] |= 1 << k;
            }
        }
    }

    /// Does the same with each box against sixteen rays. The planes are moved outwards by more than
    /// the rounding error, as in [`BoxRay`].
    #[inline(always)]
    fn add_box_by_box<S: Simd>(&self, simd: S, meeting: &mut [u64; LANES]) {
        let Self { scaled, node, .. } = self;
        for base in (0..PACKET).step_by(LANES) {
            let some = (self.rays >> base) as u32 & 0xffff;
            if some == 0 {
                continue;
            }
            let near_f = f32x16::from_slice(simd, &scaled.near[base..base + LANES]);
            let far_f = f32x16::from_slice(simd, &scaled.far[base..base + LANES]);
            let inverse = load3(simd, self.inverse, base);
            let blur = f32x16::splat(simd, BLUR);
            let mut for_low = load3(simd, &scaled.origin, base);
            let mut for_high = for_low;
            for axis in 0..3 {
                for_low[axis] += blur;
                for_high[axis] -= blur;
            }
            for child in set_bits(self.children) {
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
}

/// See [`Apart::leaves`]: each ray is tested by itself.
#[simd]
fn leaves_of_rays<S: Simd>(
    simd: S,
    block: &LeafBlock,
    met: u32,
    packet: &Packet,
    rays: u64,
) -> u64 {
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
    use std::cell::{Cell, RefCell};

    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::level::dispatch;
    use crate::intersect::wide::packet::load::load;
    use crate::intersect::wide::packet::shared_bounds::enter;
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
                let for_all = u64::from(met) * groups(rays);
                prop_assert_eq!(sixteen(for_all, k), if sixteen(rays, k) != 0 { met } else { 0 });
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
    /// axes. Where some rays of a packet are left out, nearly all others meet the box.
    #[test]
    fn no_ray_that_meets_a_box_is_left_out() {
        let bvh = SurfaceBvh::build(&[shapes::torus(1.0, 0.4).unwrap()]).unwrap();
        let view = bvh.view();
        let (told, alike) = (Cell::new((0, 0)), Cell::new(0));
        // Both are used again and again, as they are for one packet after another.
        let reused = RefCell::new((Packet::default(), Apart::default()));
        let point = || [-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64].prop_map(DVec3::from_array);
        let axis = prop_oneof![point(), Just(DVec3::X), Just(-DVec3::Y), Just(DVec3::Z)];
        let size = || prop_oneof![Just(0.0), (-4.0..0.5f64).prop_map(|power| 10f64.powf(power))];
        let range = prop_oneof![Just([0.0, f64::INFINITY]), Just([-1.0, 2.0]), Just([0.5, 1.5])];
        let lines = (point(), axis, size(), size(), range);
        let asides = prop::collection::vec((point(), point()), 1..=PACKET);
        let some = prop::collection::vec(any::<u64>(), 0..6);
        let config = same_cases(8_000);
        proptest!(config, |(
            (origin, axis, spread, fan, [from, to]) in lines,
            asides in asides,
            some in some,
            asked in any::<u32>(),
        )| {
            let queries: Vec<Query> = asides
                .iter()
                .map(|&(aside, turn)| {
                    let along = (axis + fan * turn).normalize_or(DVec3::Z);
                    let ray = Ray::with_range(2.0 * origin + spread * aside, along, from, to);
                    Query::primary(ray.unwrap())
                })
                .collect();
            let rays = some.iter().fold(u64::MAX, |rays, some| rays & some);
            let (packet, apart) = &mut *reused.borrow_mut();
            dispatch!(Kernel::best_level(), simd => load(simd, packet, &queries, &view));
            apart.set(packet);
            let rays = rays & packet.open();
            for node in &view.tree.nodes {
                let (meeting, asked) = dispatch!(Kernel::best_level(), simd => {
                    let (entries, met) = enter(simd, node, &packet.scaled.bounds, f32::MAX);
                    let asked = met & asked;
                    (apart.meeting(simd, packet, node, (&entries, asked), rays), asked)
                });
                for child in set_bits(asked) {
                    let kept = meeting[child];
                    prop_assert_eq!(kept & !rays, 0);
                    let meets = |&k: &usize| meets(packet, k, node, child);
                    let met = set_bits(rays).filter(meets).fold(0, |bits, k| bits | 1 << k);
                    prop_assert_eq!(met & !kept, 0, "child {}: {:b}, but {:b}", child, met, kept);
                    if kept == rays {
                        alike.set(alike.get() + 1);
                    } else {
                        let (all_met, all_kept) = told.get();
                        told.set((all_met + met.count_ones(), all_kept + kept.count_ones()));
                    }
                }
            }
        });
        let ((met, kept), alike) = (told.get(), alike.get());
        assert!(met > 10_000 && kept < met + met / 20 && alike > 1_000, "{met} {kept} {alike}");
    }
}
