//! First and any hits of coherent rays: packets, and the scalar search for what they leave
//! undecided.

use super::PacketScratch;
use super::answer::{answer_of, border_flag};
use crate::intersect::level::{Level, dispatch};
use crate::intersect::query::StartIn;
use crate::intersect::roots::meeting::{CertainHit, Meeting};
use crate::intersect::scalar::findings::occlusion;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::{Ahead, LaneHit, Moment, PACKET, ReadAhead, trace_packet};
use crate::intersect::{Answer, HitFlags, Occlusion, Shot, Tracer};
use crate::math::bits::{has, set_bits};
use crate::math::{Ray, RayFrame};
use crate::patch::{Jet, PatchSet};

impl Tracer<'_> {
    /// First hits by packets of up to [`PACKET`] rays, appended to `answers`.
    pub(super) fn first_hits_in_packets<Q: Shot>(
        &mut self,
        level: Level,
        shots: &[Q],
        answers: &mut Vec<Answer>,
    ) {
        answers.reserve(shots.len());
        self.packets.packet.clear(0); // what was traced before must not enter the statistics
        let bvh = self.bvh;
        let is_alone = |shot: &Q| shot.start_in(&bvh.set).is_some();
        let mut rest = shots;
        let mut near = ReadAhead::default();
        while let Some(first) = rest.first() {
            // Rays that leave a root are traced one by one: the answer for a ray must not depend
            // on its neighbours.
            if is_alone(first) || bvh.leaves.is_empty() {
                answers.push(self.first_hit(first));
                rest = &rest[1..];
                continue;
            }
            near.read(rest);
            let alike = rest.iter().take(PACKET).take_while(|shot| !is_alone(shot)).count();
            let (packet, others) = rest.split_at(alike);
            near.while_tracing(others, Moment::Finish, |ahead| {
                self.trace_packet(level, packet, ahead, Wanted::First);
            });
            self.search_undecided_of_packet(packet, Wanted::First);
            let first = answers.len();
            self.answer_packet(packet, answers);
            for k in set_bits(self.packets.packet.far_off()) {
                self.findings.statistics.uncount();
                answers[first + k] = self.scalar_first(&packet[k].query());
            }
            rest = others;
        }
    }

    /// Occlusion of rays by packets, appended to `answers`.
    ///
    /// One certain hit is enough; until there is one, every leaf that may hold a hit is searched.
    /// So an answer depends neither on the order of the search nor on the other rays.
    pub(super) fn occlusions_in_packets<Q: Shot>(
        &mut self,
        level: Level,
        shots: &[Q],
        answers: &mut Vec<Occlusion>,
    ) {
        answers.reserve(shots.len());
        self.packets.packet.clear(0);
        let mut rest = shots;
        let mut near = ReadAhead::default();
        while !rest.is_empty() {
            near.read(rest);
            let (packet, others) = rest.split_at(rest.len().min(PACKET));
            near.while_tracing(others, Moment::Box, |ahead| {
                self.trace_packet(level, packet, ahead, Wanted::Any);
            });
            rest = others;
            self.search_undecided_of_packet(packet, Wanted::Any);
            let (first, met) = (answers.len(), self.packets.packet.met());
            let undecided = self.packets.work.undecided_rays & !met;
            for k in 0..packet.len() {
                answers.push(if has(undecided, k) {
                    self.judged_occlusion(k)
                } else {
                    Occlusion { occluded: has(met, k), doubtful: false }
                });
            }
            for k in set_bits(self.packets.packet.far_off()) {
                self.findings.statistics.uncount();
                answers[first + k] = self.scalar_any(&packet[k].query());
            }
        }
    }

    /// The occlusion of a ray for which only the scalar search may have found anything.
    fn judged_occlusion(&mut self, k: usize) -> Occlusion {
        let PacketScratch { meetings, doubt, .. } = &*self.packets;
        let found = meetings.iter().filter(|(ray, _)| *ray == k).map(|(_, meeting)| meeting);
        let occlusion = occlusion(found, doubt[k]);
        self.findings.statistics.count_doubt(occlusion.doubtful);
        occlusion
    }

    fn trace_packet<Q: Shot>(
        &mut self,
        level: Level,
        shots: &[Q],
        ahead: &mut Ahead<'_, Q>,
        wanted: Wanted,
    ) {
        let PacketScratch { packet, work, .. } = &mut *self.packets;
        packet.ask(wanted);
        self.findings.statistics.rays += shots.len() as u64;
        let view = &self.view;
        dispatch!(level, simd => trace_packet(simd, view, shots, ahead, packet, work));
    }

    /// Searches, ray by ray, the leaves that the packet could not decide.
    fn search_undecided_of_packet<Q: Shot>(&mut self, shots: &[Q], wanted: Wanted) {
        self.packets.meetings.clear();
        if self.packets.work.undecided.is_empty() {
            return;
        }
        self.packets.doubt = [f64::INFINITY; PACKET];
        let enough = if wanted == Wanted::Any { self.packets.packet.met() } else { 0 };
        let mut undecided = std::mem::take(&mut self.packets.work.undecided);
        let packet = &self.packets.packet;
        undecided.retain(|one| !has(enough, one.ray) && one.from <= packet.end(one.ray));
        undecided.sort_unstable_by_key(|one| (one.ray, one.leaf));
        self.packets.work.undecided_rays = 0;
        for of_ray in undecided.chunk_by(|a, b| a.ray == b.ray) {
            let k = of_ray[0].ray;
            self.packets.work.undecided_rays |= 1 << k;
            let query = shots[k].query();
            let ray = (&query, &RayFrame::new(&query.ray));
            let leaves = of_ray.iter().map(|one| one.leaf);
            self.search_undecided(ray, leaves, self.packets.packet.end(k), wanted);
            let PacketScratch { meetings, doubt, .. } = &mut *self.packets;
            meetings.extend(self.findings.meetings.iter().map(|&meeting| (k, meeting)));
            doubt[k] = self.findings.doubt;
        }
        self.packets.work.undecided = undecided;
    }

    /// Appends the answer for each ray: the nearest hit of the packet and of the scalar search.
    fn answer_packet<Q: Shot>(&mut self, shots: &[Q], answers: &mut Vec<Answer>) {
        let packet = &self.packets.packet;
        let looked_at = self.packets.work.undecided_rays | packet.needs_look();
        if packet.met() | looked_at == 0 {
            // One by one: copies of an answer would also write the bytes of its absent hit.
            answers.extend(shots.iter().map(|_| Answer::default()));
            return;
        }
        let first = answers.len();
        let set = self.bvh.set.id();
        answers.extend((0..shots.len()).map(|k| packet.plain_answer(k, set)));
        for k in set_bits(looked_at) {
            answers[first + k] = self.judged_answer(shots[k].ray(), k);
        }
    }

    /// The answer where a border, a missing normal or the scalar search must be considered.
    #[cold]
    fn judged_answer(&mut self, ray: &Ray, k: usize) -> Answer {
        let PacketScratch { packet, work, meetings, doubt } = &*self.packets;
        let set = &self.bvh.set;
        let frame = RayFrame::new(ray);
        let certain = packet.hit(k).map(|hit| meeting(set, &frame, &hit));
        let others = meetings.iter().filter(|(ray, _)| *ray == k).map(|(_, meeting)| meeting);
        let doubt = if has(work.undecided_rays, k) { doubt[k] } else { f64::INFINITY };
        let answer = answer_of(set, certain.iter().chain(others), doubt);
        self.findings.statistics.count_doubt(answer.doubtful);
        answer
    }
}

/// A lane's hit as the scalar search would have found it.
fn meeting(set: &PatchSet, frame: &RayFrame, hit: &LaneHit) -> Meeting {
    let LaneHit { piece: index, t, z_error, st, point, normal, needs_look } = *hit;
    let piece = &set.pieces()[index as usize];
    let jet = Jet { point, ..piece.patch.jet(st) };
    let (normal, flags) = if needs_look {
        (piece.normal(st, &jet), border_flag(piece, st, &jet, frame.magnitude))
    } else {
        (normal.is_finite().then_some(normal), HitFlags::NONE)
    };
    CertainHit { t, z_error, piece: index, st, jet, normal, flags }.meeting(piece, frame)
}
