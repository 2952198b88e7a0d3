//! Queries: first hit, any hit, all hits.
//!
//! The scalar search is asked here. The fast kernels are asked in three ways, and the scalar search
//! about what they leave undecided: one ray at a time (`singles`), in `packets` if rays are
//! coherent, and else in `streams`.

mod between;
mod looks;
mod packets;
mod singles;
mod streams;

use std::fmt;

use glam::DVec3;

use self::looks::reported_normal;
use super::crossings::merge::merge;
use super::level::Level;
use super::query::{OneShot, Shots};
use super::roots::accept::AROUND;
use super::roots::meeting::Meeting;
use super::roots::question::{PlacedLeaf, Question};
use super::scalar::findings::Findings;
use super::scalar::leaf_search;
use super::tree::nodes::ChildCode;
use super::wide::{BvhView, PACKET, Packet, SingleWork, Stream, Work};
use super::{
    Answer, Coherence, Hit, HitFlags, Kernel, Occlusion, Query, Root, Shot, Statistics, SurfaceBvh,
};
use crate::math::RayFrame;
use crate::patch::{OrientedBox, Passage, PatchSet};

/// Answers queries on one thread; holds the scratch memory and the counts.
///
/// Answers depend on the ray, the surfaces, the kernel and the way of asking, never on other rays
/// or on earlier queries.
pub struct Tracer<'a> {
    bvh: &'a SurfaceBvh,
    /// What the fast kernels search of it, put together once and not for every ray.
    view: BvhView<'a>,
    kernel: Kernel,
    /// The kernel's instructions, kept because detecting them takes longer than some rays.
    level: Option<Level>,
    findings: Findings,
    stack: Vec<(f64, ChildCode)>,
    packets: Box<PacketScratch>,
    single: SingleWork,
    stream: Stream,
}

impl SurfaceBvh {
    /// Returns a tracer for this thread, with the default kernel.
    ///
    /// A tracer takes longer to make than a ray to trace: memory is allocated, and the processor's
    /// instructions are detected. Keep one for each thread, or for each large batch:
    ///
    /// ```
    /// use glam::DVec3;
    /// use nurbray::geometry::shapes;
    /// use nurbray::intersect::{Coherence, SurfaceBvh};
    /// use nurbray::math::Ray;
    /// use rayon::prelude::*;
    ///
    /// let bvh = SurfaceBvh::build(&[shapes::sphere(1.0)?])?;
    /// let down = |k| Ray::new(DVec3::new(1e-4 * f64::from(k), 0.1, 2.0), DVec3::NEG_Z);
    /// let rays = (0..20_000).map(down).collect::<Result<Vec<_>, _>>()?;
    ///
    /// let hits: usize = rays
    ///     .par_chunks(2048)
    ///     .map_init(
    ///         || (bvh.tracer(), Vec::new()),
    ///         |(tracer, answers), rays| {
    ///             tracer.first_hits(rays, Coherence::Coherent, answers);
    ///             answers.iter().filter(|answer| answer.hit.is_some()).count()
    ///         },
    ///     )
    ///     .sum();
    /// assert_eq!(hits, 9950);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn tracer(&self) -> Tracer<'_> {
        self.tracer_with(Kernel::default())
    }

    /// Returns a tracer for this thread with the given kernel, or with the scalar one if this
    /// processor cannot run it ([`Kernel::is_available`]); [`Tracer::kernel`] says which it is.
    pub fn tracer_with(&self, kernel: Kernel) -> Tracer<'_> {
        Tracer::new(self, kernel)
    }

    /// A leaf with its piece and the given box, for a search.
    fn place<'b>(&'b self, leaf: u32, oriented: &'b OrientedBox) -> PlacedLeaf<'b> {
        let leaf = &self.leaves[leaf as usize];
        PlacedLeaf { leaf, oriented, piece: &self.set.pieces()[leaf.piece as usize] }
    }
}

/// Scratch memory for packets.
#[derive(Debug)]
struct PacketScratch {
    packet: Packet,
    work: Work,
    /// What the scalar search found, with the ray's place in the packet.
    meetings: Vec<(usize, Meeting)>,
    /// For each ray, the smallest ray parameter at which something may have been missed.
    doubt: [f64; PACKET],
}

impl Default for PacketScratch {
    fn default() -> Self {
        Self {
            packet: Packet::default(),
            work: Work::default(),
            meetings: Vec::new(),
            doubt: [f64::INFINITY; PACKET],
        }
    }
}

/// Not the surfaces, nor the scratch memory: these would be megabytes of text.
impl fmt::Debug for Tracer<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Tracer")
            .field("kernel", &self.kernel)
            .field("bvh", self.bvh)
            .field("statistics", &self.statistics())
            .finish_non_exhaustive()
    }
}

/// How a leaf is searched.
type Search = fn(&Question<'_>, &PlacedLeaf<'_>, &Passage, f64, &mut Findings);

impl<'a> Tracer<'a> {
    fn new(bvh: &'a SurfaceBvh, kernel: Kernel) -> Self {
        let level = kernel.level();
        Self {
            bvh,
            view: bvh.view(),
            kernel: if level.is_some() { kernel } else { Kernel::Scalar },
            level,
            findings: Findings::default(),
            stack: Vec::new(),
            packets: Box::default(),
            single: SingleWork::default(),
            stream: Stream::default(),
        }
    }

    /// The kernel that searches.
    pub fn kernel(&self) -> Kernel {
        self.kernel
    }

    /// The first hit of a ray: the one with the smallest `t` in its range; of hits with the
    /// same `t` the one on the surface, then the piece, that was given first.
    #[inline]
    pub fn first_hit<Q: Shot>(&mut self, shot: &Q) -> Answer {
        self.first_hit_of(OneShot::of(shot))
    }

    fn first_hit_of(&mut self, shot: OneShot<'_>) -> Answer {
        match self.level {
            Some(level) => self.single_first(level, shot),
            None => self.scalar_first(&shot.query()),
        }
    }

    /// The first hit of a ray by the scalar kernel.
    fn scalar_first(&mut self, query: &Query) -> Answer {
        self.first(query, leaf_search::search)
    }

    /// The first hit found by the exact solver alone: slow, and independent of the kernel.
    pub fn exact_first_hit<Q: Shot>(&mut self, shot: &Q) -> Answer {
        self.first(&shot.query(), exactly)
    }

    /// Whether anything lies on a ray within its range.
    pub fn occluded<Q: Shot>(&mut self, shot: &Q) -> Occlusion {
        self.occluded_of(OneShot::of(shot))
    }

    fn occluded_of(&mut self, shot: OneShot<'_>) -> Occlusion {
        match self.level {
            Some(level) => self.single_any(level, shot),
            None => self.scalar_any(&shot.query()),
        }
    }

    /// Whether anything lies on a ray, by the scalar kernel.
    fn scalar_any(&mut self, query: &Query) -> Occlusion {
        let frame = RayFrame::new(&query.ray);
        let question = Question::new(&self.bvh.set, query, &frame);
        self.collect(&question, leaf_search::search, |meetings| {
            // One certain hit is enough; a doubtful one keeps the search going.
            if meetings.iter().any(Meeting::is_certain) { f64::NEG_INFINITY } else { f64::INFINITY }
        });
        self.findings.occlusion()
    }

    /// All hits of a ray, by increasing `t`; `hits` is cleared and filled. Returns whether the
    /// answer is doubtful.
    ///
    /// Hits of adjoining pieces, or of surfaces whose borders meet, are one crossing and reported
    /// once if they are at the same place and have the same sign of `N · d`. All kernels find the
    /// same hits, to within rounding: the fast ones search the leaves that are certified for the
    /// ray, and leave hits at borders and the other leaves to the scalar search.
    ///
    /// Hits at one place come in either order, as rounding orders their `t`: where a ray touches a
    /// convex edge of a closed body, it may leave, by the sign of `N · d`, before it enters. Code
    /// that counts whether it is inside should take hits together whose `t` are equal, or nearly.
    #[must_use = "`true` says that the hits are in doubt"]
    pub fn all_hits<Q: Shot>(&mut self, shot: &Q, hits: &mut Vec<Hit>) -> bool {
        let query = shot.query();
        let axis = match self.level {
            Some(level) if !self.is_beyond_f32(&query.ray) => self.single_all(level, &query),
            _ => self.collect_all(&query, leaf_search::search),
        };
        self.merge(axis, hits)
    }

    /// All hits of a ray by the exact solver alone, as [`all_hits`](Self::all_hits) gives them:
    /// slow, and independent of certificates and kernels.
    #[must_use = "`true` says that the hits are in doubt"]
    pub fn exact_all_hits<Q: Shot>(&mut self, shot: &Q, hits: &mut Vec<Hit>) -> bool {
        let axis = self.collect_all(&shot.query(), exactly);
        self.merge(axis, hits)
    }

    /// Puts the meetings with all leaves into the findings; returns the ray's unit direction.
    fn collect_all(&mut self, query: &Query, search: Search) -> DVec3 {
        let frame = RayFrame::new(&query.ray);
        let question = Question { all_hits: true, ..Question::new(&self.bvh.set, query, &frame) };
        self.collect(&question, search, |_| f64::INFINITY);
        frame.axis
    }

    /// Makes hits of the meetings found with a ray of this unit direction; returns whether they are
    /// in doubt.
    fn merge(&mut self, axis: DVec3, hits: &mut Vec<Hit>) -> bool {
        let set = &self.bvh.set;
        merge(&mut self.findings.meetings, set.pieces(), axis);
        hits.clear();
        hits.extend(self.findings.meetings.iter().map(|meeting| hit(set, meeting)));
        let certain = self.findings.meetings.iter().all(Meeting::is_certain);
        let doubtful = !certain || self.findings.doubt < f64::INFINITY;
        self.findings.statistics.count_doubt(doubtful);
        doubtful
    }

    /// First hits of many rays; `answers` is cleared and filled in the same order.
    ///
    /// If the kernel supports it, coherent rays are traced in packets, except those that leave a
    /// root, which are traced one by one; incoherent rays are traced side by side in streams.
    ///
    /// The order of coherent rays matters for speed: 64 consecutive ones make a packet.
    /// [`Coherence`] says how to order them, and how many to give at a time.
    pub fn first_hits<Q: Shot>(
        &mut self,
        shots: &[Q],
        coherence: Coherence,
        answers: &mut Vec<Answer>,
    ) {
        answers.clear();
        self.first_hits_of(Q::shots(shots), coherence, answers);
    }

    /// Occlusion of many rays; `answers` is cleared and filled in the same order.
    ///
    /// If the kernel supports it, coherent rays are traced in packets. Incoherent rays are traced
    /// one by one or, in scenes of 2¹⁷ leaves and more, side by side in streams.
    pub fn occlusions<Q: Shot>(
        &mut self,
        shots: &[Q],
        coherence: Coherence,
        answers: &mut Vec<Occlusion>,
    ) {
        answers.clear();
        self.occlusions_of(Q::shots(shots), coherence, answers);
    }

    /// Counts of the work done so far.
    pub fn statistics(&self) -> Statistics {
        let mut all = self.findings.statistics;
        all += self.packets.work.statistics;
        all += self.single.statistics;
        all += self.stream.statistics();
        all
    }

    fn first_hits_of(&mut self, shots: Shots<'_>, coherence: Coherence, answers: &mut Vec<Answer>) {
        match shots {
            Shots::Rays(rays) => self.add_first_hits(rays, coherence, answers),
            Shots::Queries(queries) => self.add_first_hits(queries, coherence, answers),
        }
    }

    fn add_first_hits<Q: Shot>(
        &mut self,
        shots: &[Q],
        coherence: Coherence,
        answers: &mut Vec<Answer>,
    ) {
        match self.level {
            Some(level) if coherence == Coherence::Coherent => {
                self.first_hits_in_packets(level, shots, answers);
            }
            Some(level) => self.first_hits_in_streams(level, shots, answers),
            None => answers.extend(shots.iter().map(|shot| self.first_hit(shot))),
        }
    }

    fn occlusions_of(
        &mut self,
        shots: Shots<'_>,
        coherence: Coherence,
        answers: &mut Vec<Occlusion>,
    ) {
        match shots {
            Shots::Rays(rays) => self.add_occlusions(rays, coherence, answers),
            Shots::Queries(queries) => self.add_occlusions(queries, coherence, answers),
        }
    }

    fn add_occlusions<Q: Shot>(
        &mut self,
        shots: &[Q],
        coherence: Coherence,
        answers: &mut Vec<Occlusion>,
    ) {
        match self.level {
            Some(level) if coherence == Coherence::Coherent => {
                self.occlusions_in_packets(level, shots, answers);
            }
            Some(level) if self.view.is_vast() => {
                self.occlusions_in_streams(level, shots, answers);
            }
            Some(level) => self.single_anys(level, shots, answers),
            None => answers.extend(shots.iter().map(|shot| self.occluded(shot))),
        }
    }

    fn first(&mut self, query: &Query, search: Search) -> Answer {
        let frame = RayFrame::new(&query.ray);
        let to_z = 1.0 / frame.t_from_z;
        let question = Question::new(&self.bvh.set, query, &frame);
        self.collect(&question, search, |meetings| {
            // Up to the nearest meeting, plus its error bound.
            meetings.iter().map(|m| m.t + m.t_error).fold(f64::INFINITY, f64::min) * to_z
        });
        let findings = &mut self.findings;
        let answer = answer_of(&self.bvh.set, findings.meetings.iter(), findings.doubt);
        findings.statistics.count_doubt(answer.doubtful);
        answer
    }

    /// Searches all leaves the ray may meet before the limit that `enough` derives from the
    /// meetings found so far.
    fn collect(
        &mut self,
        question: &Question<'_>,
        search: Search,
        enough: impl Fn(&[Meeting]) -> f64,
    ) {
        let (bvh, ray) = (self.bvh, question.ray);
        let findings = &mut self.findings;
        findings.clear();
        findings.statistics.rays += 1;
        let mut limit = ray.z_range[1];
        let nodes = bvh.tree.traverse(ray, &mut self.stack, |index, (oriented, region)| {
            let place = bvh.place(index, oriented);
            let passage = place.passage(ray, region, limit);
            let Some(passage) = passage else { return limit };
            let before = findings.meetings.len();
            search(question, &place, &passage, limit, findings);
            if findings.meetings.len() > before {
                limit = limit.min(enough(&findings.meetings));
            }
            limit
        });
        findings.statistics.nodes += nodes;
    }
}

/// The exact solver as a way to search a leaf.
fn exactly(
    question: &Question<'_>,
    place: &PlacedLeaf<'_>,
    passage: &Passage,
    limit: f64,
    findings: &mut Findings,
) {
    findings.statistics.leaf_tests += 1;
    let from = leaf_search::met_from(place, passage, question.ray);
    leaf_search::search_exactly(question, place, from, limit, findings);
}

/// Two points of a surface count as one place if they are closer than this many times the sum of
/// their error bounds.
const SAME_PLACE: f64 = 4.0;

/// The first of some meetings, and whether something doubtful could come before it.
fn answer_of<'m>(
    set: &PatchSet,
    meetings: impl Iterator<Item = &'m Meeting> + Clone,
    doubt: f64,
) -> Answer {
    // A hit so far away that `t` is infinite lies beyond every range.
    let reachable = meetings.filter(|meeting| meeting.t < f64::INFINITY);
    let first = reachable.clone().min_by(|a, b| a.order(b));
    // A doubtful meeting may lie before where it was found, by as much as its error bound. But one
    // at the place of the first meeting is the first itself if it is known as well as that, as the
    // ends of stretches are.
    let before = |first: &Meeting, meeting: &Meeting| {
        let reach = SAME_PLACE * (first.error + meeting.error);
        let earlier = first.t - (meeting.t - meeting.t_error);
        let is_first = meeting.jet.point.distance(first.jet.point) <= reach
            && (meeting.stretch.is_some() || earlier <= SAME_PLACE * first.t_error);
        !meeting.is_certain() && earlier >= 0.0 && !is_first
    };
    let is_before = |first| reachable.clone().any(|meeting| before(first, meeting));
    let open = doubt < f64::INFINITY && first.is_none_or(|first| doubt <= first.t);
    let open = open || first.is_some_and(is_before);
    let mut hit = first.map(|meeting| hit(set, meeting));
    let flagged = hit.is_some_and(|hit| hit.flags.contains(HitFlags::DOUBTFUL));
    let doubtful = flagged || open;
    if let Some(hit) = hit.as_mut().filter(|_| doubtful) {
        hit.flags.insert(HitFlags::DOUBTFUL);
    }
    Answer { hit, doubtful }
}

/// The hit to report for a meeting.
fn hit(set: &PatchSet, meeting: &Meeting) -> Hit {
    let piece = &set.pieces()[meeting.piece as usize];
    let mut flags = meeting.flags;
    let normal = reported_normal(piece, meeting.jet.point, meeting.normal);
    let normal = normal.unwrap_or_else(|| {
        flags.insert(HitFlags::NO_NORMAL);
        DVec3::NAN
    });
    // A doubtful meeting may be off along the ray by more than its angle implies.
    let least = if meeting.is_certain() { 0.0 } else { AROUND * meeting.error / meeting.z_error };
    let cosine = if flags.contains(HitFlags::NO_NORMAL) { 0.0 } else { meeting.cosine.abs() };
    let cosine = cosine.max(least).min(1.0);
    let root = Root::new(set.id(), meeting.piece, meeting.st, meeting.z_error, cosine);
    Hit {
        t: meeting.t,
        surface: meeting.surface,
        uv: piece.uv(meeting.st),
        point: meeting.jet.point,
        normal,
        flags,
        root,
    }
}
