//! First hits of coherent rays: packets, and the scalar search for what they leave.

use fearless_simd::{Level, dispatch};
use glam::DVec2;

use super::leaf_search::{self, Meeting, Question};
use super::tracer::{PacketScratch, answer_of};
use super::wide::{LaneHit, PACKET, trace};
use super::{Answer, HitFlags, Query, Tracer};
use crate::math::RayFrame;
use crate::patch::{Jet, LEAF_SLACK, Leaf, PatchSet, Piece};

impl Tracer<'_> {
    /// First hits by packets of up to [`PACKET`] rays, appended to `answers`.
    pub(super) fn first_hits_in_packets(
        &mut self,
        level: Level,
        queries: &[Query],
        answers: &mut Vec<Answer>,
    ) {
        // Rays that leave a root are traced one by one: what a ray is answered must not depend
        // on its neighbours.
        for alike in queries.chunk_by(|a, b| a.from.is_some() == b.from.is_some()) {
            if alike[0].from.is_some() || self.bvh.set.leaves().is_empty() {
                answers.extend(alike.iter().map(|query| self.first_hit(query)));
                continue;
            }
            for packet in alike.chunks(PACKET) {
                self.trace_packet(level, packet);
                self.search_rest(packet);
                for k in 0..packet.len() {
                    answers.push(self.packet_answer(k));
                }
            }
        }
    }

    fn trace_packet(&mut self, level: Level, queries: &[Query]) {
        let PacketScratch { packet, work, frames, .. } = &mut *self.packets;
        frames.clear();
        frames.extend(queries.iter().map(|query| RayFrame::new(&query.ray)));
        packet.load(frames, &self.bvh.hierarchy);
        let statistics = &mut self.findings.statistics;
        statistics.rays += queries.len() as u64;
        let (tree, set) = (&self.bvh.wide, &self.bvh.set);
        dispatch!(level, simd => trace(simd, tree, set, packet, work, statistics));
    }

    /// The scalar search for the rays and leaves the packet could not decide.
    fn search_rest(&mut self, queries: &[Query]) {
        let PacketScratch { packet, work, frames, meetings, doubt } = &mut *self.packets;
        meetings.clear();
        *doubt = [f64::INFINITY; PACKET];
        let set = &self.bvh.set;
        for &(k, index) in &work.rest {
            let (frame, leaf) = (&frames[k], &set.leaves()[index as usize]);
            let slack = leaf_search::error_bound(&set.pieces()[leaf.piece as usize], frame);
            let limit = packet.hit(k).map_or(frame.z_range[1], |hit| hit.z + slack);
            let Some(passage) = leaf.oriented.passage(frame, slack) else { continue };
            let ray = &queries[k].ray;
            let question =
                Question { set, ray: frame, t_range: [ray.t_min(), ray.t_max()], from: None };
            self.findings.clear();
            leaf_search::search(&question, leaf, &passage, limit, &mut self.findings);
            meetings.extend(self.findings.meetings.iter().map(|&meeting| (k, meeting)));
            doubt[k] = doubt[k].min(self.findings.doubt);
        }
    }

    /// The nearest of what the packet and the scalar search found for ray `k`.
    fn packet_answer(&mut self, k: usize) -> Answer {
        let PacketScratch { packet, frames, meetings, doubt, .. } = &*self.packets;
        let set = &self.bvh.set;
        let certain = packet.hit(k).map(|hit| meeting(set, &frames[k], &hit));
        let others = meetings.iter().filter(|(ray, _)| *ray == k).map(|(_, meeting)| meeting);
        let answer = answer_of(set, &frames[k], certain.iter().chain(others), doubt[k]);
        self.findings.statistics.doubtful += u64::from(answer.doubtful);
        answer
    }
}

/// A lane's hit as the scalar search would have found it.
fn meeting(set: &PatchSet, frame: &RayFrame, hit: &LaneHit) -> Meeting {
    let leaf = &set.leaves()[hit.leaf as usize];
    let piece = &set.pieces()[leaf.piece as usize];
    let error = leaf_search::error_bound(piece, frame);
    let length = hit.cross.length();
    let normal = hit.cross / length;
    let cosine = normal.dot(frame.axis);
    let near_border = near_border(leaf, piece, hit.st);
    let jet = if near_border {
        piece.patch.jet(hit.st)
    } else {
        Jet { point: hit.point, ds: hit.cross, dt: hit.cross }
    };
    let mut flags = HitFlags::NONE;
    if near_border && leaf_search::at_border(piece, hit.st, &jet, error) {
        flags.insert(HitFlags::BORDER);
    }
    Meeting {
        t: hit.z * frame.t_from_z,
        t_error: error / cosine.abs().max(f64::EPSILON) * frame.t_from_z,
        surface: piece.surface,
        piece: leaf.piece,
        st: hit.st,
        jet: Jet { point: hit.point, ..jet },
        normal: normal.is_finite().then_some(normal),
        flags,
        error,
        cosine,
        stretch: None,
    }
}

/// Whether a hit may lie within rounding of a border of its surface.
///
/// The leaf is certified for the ray, so rounding moves a root by less than half of the
/// leaf's slack: what is farther from the side than a few times that is not at the border.
fn near_border(leaf: &Leaf, piece: &Piece, st: DVec2) -> bool {
    let reach = leaf.rect.map(|[from, to]| 4.0 * LEAF_SLACK * (to - from));
    let distance = [st.x, 1.0 - st.x, st.y, 1.0 - st.y];
    (0..4).any(|side| piece.border[side] && distance[side] <= reach[side / 2])
}
