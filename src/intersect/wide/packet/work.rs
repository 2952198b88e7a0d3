//! Scratch memory and results of tracing packets.

use super::apart::Apart;
use super::doubts::Doubts;
use crate::intersect::Statistics;
use crate::intersect::tree::nodes::ChildCode;
use crate::intersect::wide::proof::lanes::Parts;
use crate::intersect::wide::search::distances::LaneDistances;
use crate::intersect::wide::surface::spline_net::RecentNets;
use crate::math::bits::set_bits;

/// Where the first ray may enter a child, the child, and the rays that may enter it.
pub(super) type Visit = (f32, ChildCode, u64);

/// Scratch memory and results of tracing packets.
#[derive(Debug, Default)]
pub(crate) struct PacketWork {
    pub(super) stack: Vec<Visit>,
    /// Rays and leaves that the scalar search must examine.
    pub undecided: Vec<Undecided>,
    pub(super) apart: Apart,
    /// The distances of sixteen rays from the leaf that is searched.
    pub(super) distances: LaneDistances,
    /// Rays and leaves that need a closer look, and parts of such leaves.
    pub(super) doubts: Box<Doubts>,
    pub(super) parts: Parts,
    pub(super) nets: RecentNets,
    /// One bit for each ray that has leaves left.
    pub undecided_rays: u64,
    pub statistics: Statistics,
}

/// A ray of the packet and a leaf that the scalar search must examine.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Undecided {
    pub ray: usize,
    pub leaf: u32,
    /// It need not if the ray's nearest hit turns out to be nearer than this. (Whether that is known
    /// when the leaf is searched depends on the other rays.)
    pub from: f64,
}

impl PacketWork {
    /// Leaves a leaf to the scalar search, for those of sixteen rays whose bit is set in `lanes`.
    #[inline(always)]
    pub(super) fn leave(&mut self, base: usize, lanes: u32, leaf: u32) {
        for lane in set_bits(lanes) {
            self.leave_one(Undecided { ray: base + lane, leaf, from: f64::NEG_INFINITY });
        }
    }

    /// Leaves a leaf to the scalar search for one ray.
    pub(super) fn leave_one(&mut self, one: Undecided) {
        self.undecided_rays |= 1 << one.ray;
        self.undecided.push(one);
    }
}
