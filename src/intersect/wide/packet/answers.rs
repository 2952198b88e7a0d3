//! What a packet has found.

use super::hits::{LaneHit, gather, pair};
use super::rays::Packet;
use crate::intersect::{Answer, Hit, HitFlags, Root};
use crate::math::bits::has;
use crate::patch::SetId;

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
