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
pub(crate) struct Work {
    pub(super) stack: Vec<Visit>,
    /// Rays and leaves that the scalar search must examine.
    pub undecided: Vec<(usize, u32)>,
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

impl Work {
    /// Leaves a leaf to the scalar search, for those of sixteen rays whose bit is set in `lanes`.
    #[inline(always)]
    pub(super) fn leave(&mut self, base: usize, lanes: u32, leaf: u32) {
        self.undecided_rays |= u64::from(lanes) << base;
        self.undecided.extend(set_bits(lanes).map(|lane| (base + lane, leaf)));
    }
}
