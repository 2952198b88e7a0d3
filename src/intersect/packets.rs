//! First hits of coherent rays: packets, and the scalar search for what they leave.

use super::leaf_search::{self, Meeting};
use super::tracer::{PacketScratch, answer_of};
use super::wide::{LaneHit, PACKET, trace};
use super::{Answer, HitFlags, Shot, Tracer};
use crate::math::{Ray, RayFrame};
use crate::patch::{Jet, PatchSet};
use fearless_simd::{Level, dispatch};

impl Tracer<'_> {
    /// First hits by packets of up to [`PACKET`] rays, appended to `answers`.
    pub(super) fn first_hits_in_packets<Q: Shot>(
        &mut self,
        level: Level,
        shots: &[Q],
        answers: &mut Vec<Answer>,
    ) {
        answers.reserve(shots.len());
        let mut rest = shots;
        while let Some(first) = rest.first() {
            // Rays that leave a root are traced one by one: what a ray is answered must not
            // depend on its neighbours.
            if first.from().is_some() || self.bvh.leaves.is_empty() {
                answers.push(self.first_hit(&first.query()));
                rest = &rest[1..];
                continue;
            }
            let alike = rest.iter().take(PACKET).take_while(|shot| shot.from().is_none()).count();
            let (packet, others) = rest.split_at(alike);
            self.trace_packet(level, packet);
            self.search_rest(level, packet);
            self.answer_packet(packet, answers);
            rest = others;
        }
    }

    fn trace_packet<Q: Shot>(&mut self, level: Level, shots: &[Q]) {
        let PacketScratch { packet, work, .. } = &mut *self.packets;
        packet.load(shots);
        let statistics = &mut self.findings.statistics;
        statistics.rays += shots.len() as u64;
        let scene = self.bvh.scene();
        dispatch!(level, simd => trace(simd, &scene, packet, work, statistics));
    }

    /// The search ray by ray for the rays and leaves the packet could not decide.
    fn search_rest<Q: Shot>(&mut self, level: Level, shots: &[Q]) {
        self.packets.meetings.clear();
        if self.packets.work.rest.is_empty() {
            return;
        }
        self.packets.doubt = [f64::INFINITY; PACKET];
        for at in 0..self.packets.work.rest.len() {
            let (k, leaf) = self.packets.work.rest[at];
            let limit = self.packets.packet.end(k);
            self.search_leaf(level, shots[k].ray(), leaf, limit);
            let PacketScratch { meetings, doubt, .. } = &mut *self.packets;
            meetings.extend(self.findings.meetings.iter().map(|&meeting| (k, meeting)));
            doubt[k] = doubt[k].min(self.findings.doubt);
        }
    }

    /// The nearest of what the packet and the scalar search found for each ray.
    fn answer_packet<Q: Shot>(&mut self, shots: &[Q], answers: &mut Vec<Answer>) {
        let looked_at = self.packets.work.rest_rays | self.packets.packet.near_border();
        for (k, shot) in shots.iter().enumerate() {
            // Three ways to fill the place, each for itself: so that none is filled by copying.
            let packet = &self.packets.packet;
            if looked_at >> k & 1 != 0 {
                answers.push(self.judged_answer(shot.ray(), k));
            } else if packet.has_hit(k) {
                let hit = packet.plain_hit(self.bvh.set.pieces(), k);
                answers.push(Answer { hit: Some(hit), doubtful: false });
            } else {
                answers.push(Answer { hit: None, doubtful: false });
            }
        }
    }

    /// The answer where borders, a missing normal or the scalar search have a say.
    #[cold]
    fn judged_answer(&mut self, ray: &Ray, k: usize) -> Answer {
        let PacketScratch { packet, work, meetings, doubt } = &*self.packets;
        let set = &self.bvh.set;
        let frame = RayFrame::new(ray);
        let certain = packet.hit(k).map(|hit| meeting(set, &frame, &hit));
        let others = meetings.iter().filter(|(ray, _)| *ray == k).map(|(_, meeting)| meeting);
        let doubt = if work.rest_rays >> k & 1 == 0 { f64::INFINITY } else { doubt[k] };
        let answer = answer_of(set, &frame, certain.iter().chain(others), doubt);
        self.findings.statistics.doubtful += u64::from(answer.doubtful);
        answer
    }
}

/// A lane's hit as the scalar search would have found it.
fn meeting(set: &PatchSet, frame: &RayFrame, hit: &LaneHit) -> Meeting {
    let piece = &set.pieces()[hit.piece as usize];
    let error = leaf_search::error_bound(piece, frame);
    let mut flags = HitFlags::NONE;
    let mut jet = Jet { point: hit.point, ds: hit.normal, dt: hit.normal };
    let mut normal = hit.normal.is_finite().then_some(hit.normal);
    if hit.near_border {
        jet = Jet { point: hit.point, ..piece.patch.jet(hit.st) };
        normal = piece.normal(hit.st, &jet);
        if leaf_search::at_border(piece, hit.st, &jet, error) {
            flags.insert(HitFlags::BORDER);
        }
    }
    let cosine = normal.map_or(0.0, |normal| normal.dot(frame.axis));
    Meeting {
        t: hit.t,
        t_error: hit.z_error * frame.t_from_z,
        surface: piece.surface,
        piece: hit.piece,
        st: hit.st,
        jet,
        normal,
        flags,
        error,
        cosine,
        stretch: None,
    }
}
