//! The nearest hits of sixty-four rays, number by number.

use glam::{DVec2, DVec3};

use crate::intersect::wide::PACKET;
use crate::intersect::wide::vectors::Lanes3;

/// The nearest hit so far of each ray of a packet.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct NearestHits {
    /// One bit a ray: whether it has met anything.
    pub(super) met: u64,
    /// One bit a ray: whether its nearest hit may be within rounding of a border, or its normal
    /// needs a closer look.
    pub(super) needs_look: u64,
    /// Where the hit is along the ray, in scene units; the ray's end if there is none.
    pub(super) z: [f64; PACKET],
    /// Error bound of `z`.
    pub(super) z_error: [f64; PACKET],
    /// The ray parameter.
    pub(super) t: [f64; PACKET],
    pub(super) leaf: [u32; PACKET],
    pub(super) piece: [u32; PACKET],
    pub(super) surface: [u32; PACKET],
    /// The place on the piece, and on its surface.
    pub(super) st: [[f64; PACKET]; 2],
    pub(super) uv: [[f64; PACKET]; 2],
    pub(super) point: Lanes3,
    /// `S_s × S_t`, made a unit vector.
    pub(super) normal: Lanes3,
}

impl Default for NearestHits {
    fn default() -> Self {
        Self {
            met: 0,
            needs_look: 0,
            z: [0.0; PACKET],
            z_error: [0.0; PACKET],
            t: [0.0; PACKET],
            leaf: [0; PACKET],
            piece: [0; PACKET],
            surface: [0; PACKET],
            st: [[0.0; PACKET]; 2],
            uv: [[0.0; PACKET]; 2],
            point: [[0.0; PACKET]; 3],
            normal: [[0.0; PACKET]; 3],
        }
    }
}

/// A hit as the packet holds it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneHit {
    pub piece: u32,
    /// The ray parameter, and the error bound of the place along the ray.
    pub t: f64,
    pub z_error: f64,
    pub st: DVec2,
    pub point: DVec3,
    /// NaN where there is none.
    pub normal: DVec3,
    /// Whether it may be within rounding of a border of its surface, or its normal needs a closer
    /// look.
    pub needs_look: bool,
}

#[inline]
pub(super) fn gather(lanes: &Lanes3, k: usize) -> DVec3 {
    DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k])
}

#[inline]
pub(super) fn pair(lanes: &[[f64; PACKET]; 2], k: usize) -> DVec2 {
    DVec2::new(lanes[0][k], lanes[1][k])
}
