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

/// See [`Apart::meeting`]; only `children` are tested. The planes are moved outwards by more than
/// the rounding error, as in [`BoxRay`].
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
    let groups = groups(rays);
    if rays.count_ones() < groups.count_ones() * children.count_ones() {
        let scaled = &packet.scaled;
        for k in set_bits(rays) {
            let of = |lanes: &Lanes3f| [lanes[0][k], lanes[1][k], lanes[2][k]];
            let range = [scaled.near[k], scaled.far[k]];
            let ray = BoxRay::new(of(&scaled.origin), of(&scaled.axis), of(inverse), range);
            let (_, entered) = ray.entries(simd, node);
            for child in set_bits(entered & children) {
                meeting[child] |= 1 << k;
            }
        }
        return meeting;
    }
    for base in (0..PACKET).step_by(LANES) {
        let some = (rays >> base) as u32 & 0xffff;
        if some == 0 {
            continue;
        }
        let near_f = f32x16::from_slice(simd, &packet.scaled.near[base..base + LANES]);
        let far_f = f32x16::from_slice(simd, &packet.scaled.far[base..base + LANES]);
        let inverse = load3(simd, inverse, base);
        let (mut for_low, blur) =
            (load3(simd, &packet.scaled.origin, base), f32x16::splat(simd, BLUR));
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
    meeting
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
    if rays.count_ones() > groups.count_ones() * met.count_ones() {
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
    use proptest::prelude::*;

    use super::*;

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
}
