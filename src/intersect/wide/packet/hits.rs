//! The nearest hits of sixty-four rays, number by number.

use glam::{DVec2, DVec3};

use super::rays::Packet;
use crate::intersect::wide::PACKET;
use crate::intersect::wide::vectors::Lanes3;
use crate::intersect::{Answer, Hit, HitFlags, Root};
use crate::math::bits::has;
use crate::patch::SetId;

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

impl Packet {
    /// One bit a ray: whether it has met anything.
    pub(crate) fn met(&self) -> u64 {
        self.hits.met
    }

    /// One bit a ray: whether its nearest hit needs a closer look, because it may be within
    /// rounding of a border, be near a pole, or have no normal.
    pub(crate) fn needs_look(&self) -> u64 {
        self.hits.needs_look
    }

    /// How far along a ray anything matters: to its nearest hit, or its end.
    pub(crate) fn end(&self, k: usize) -> f64 {
        self.hits.z[k]
    }

    /// The answer to a ray whose nearest hit, on the surfaces of `set`, needs no closer look.
    #[inline]
    pub(crate) fn plain_answer(&self, k: usize, set: SetId) -> Answer {
        let hits = &self.hits;
        if !has(hits.met, k) {
            return Answer::default();
        }
        let normal = gather(&hits.normal, k);
        let cosine = normal.dot(gather(&self.rays.axis, k));
        let root = Root::new(set, hits.piece[k], pair(&hits.st, k), hits.z_error[k], cosine);
        let hit = Hit {
            t: hits.t[k],
            surface: hits.surface[k],
            uv: pair(&hits.uv, k),
            point: gather(&hits.point, k),
            normal,
            flags: HitFlags::NONE,
            root,
        };
        Answer { hit: Some(hit), doubtful: false }
    }

    /// The nearest hit of a ray.
    pub(crate) fn hit(&self, k: usize) -> Option<LaneHit> {
        let hits = &self.hits;
        has(hits.met, k).then(|| LaneHit {
            piece: hits.piece[k],
            t: hits.t[k],
            z_error: hits.z_error[k],
            st: pair(&hits.st, k),
            point: gather(&hits.point, k),
            normal: gather(&hits.normal, k),
            needs_look: has(hits.needs_look, k),
        })
    }
}

#[inline]
pub(super) fn gather(lanes: &Lanes3, k: usize) -> DVec3 {
    DVec3::new(lanes[0][k], lanes[1][k], lanes[2][k])
}

#[inline]
pub(super) fn pair(lanes: &[[f64; PACKET]; 2], k: usize) -> DVec2 {
    DVec2::new(lanes[0][k], lanes[1][k])
}
