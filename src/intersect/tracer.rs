//! Queries: first hit, any hit, all hits.
//!
//! `scalar` asks the scalar search, about rays and about what the fast kernels leave undecided.
//! These are asked in three ways: one ray at a time (`singles`), in `packets` if rays are coherent,
//! and in `streams` if they are not, and that pays off. `answer` makes answers of what is met;
//! `between` asks about the way between two places on surfaces.

mod answer;
mod between;
mod packets;
mod scalar;
mod singles;
mod streams;

use std::fmt;

use glam::DVec3;

use self::answer::hit;
use self::scalar::exactly;
use super::crossings::merge::merge;
use super::level::Level;
use super::query::{OneShot, Shots};
use super::roots::meeting::Meeting;
use super::roots::placed_leaf::PlacedLeaf;
use super::scalar::findings::Findings;
use super::tree::nodes::ChildCode;
use super::wide::{BvhView, PACKET, Packet, PacketWork, SingleWork, Stream};
use super::{Answer, Coherence, Hit, Kernel, Occlusion, Shot, Statistics, SurfaceBvh};
use crate::patch::OrientedBox;

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
    fn placed<'b>(&'b self, leaf: u32, oriented: &'b OrientedBox) -> PlacedLeaf<'b> {
        let leaf = &self.leaves[leaf as usize];
        PlacedLeaf { leaf, oriented, piece: &self.set.pieces()[leaf.piece as usize] }
    }
}

/// Scratch memory for packets.
#[derive(Debug)]
struct PacketScratch {
    packet: Packet,
    work: PacketWork,
    /// What the scalar search found, with the ray's place in the packet.
    meetings: Vec<(usize, Meeting)>,
    /// For each ray, the smallest ray parameter at which something may have been missed.
    doubt: [f64; PACKET],
}

impl Default for PacketScratch {
    fn default() -> Self {
        Self {
            packet: Packet::default(),
            work: PacketWork::default(),
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

    /// The first hit found by the exact solver alone: slow, and independent of the kernel.
    pub fn exact_first_hit<Q: Shot>(&mut self, shot: &Q) -> Answer {
        self.first_by(exactly, &shot.query())
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
            _ => self.scalar_all(&query),
        };
        self.merge(axis, hits)
    }

    /// All hits of a ray by the exact solver alone, as [`all_hits`](Self::all_hits) gives them:
    /// slow, and independent of certificates and kernels.
    #[must_use = "`true` says that the hits are in doubt"]
    pub fn exact_all_hits<Q: Shot>(&mut self, shot: &Q, hits: &mut Vec<Hit>) -> bool {
        let axis = self.all_by(exactly, &shot.query());
        self.merge(axis, hits)
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
    /// root, which are traced one by one. Incoherent rays are traced side by side in streams, with
    /// AVX-512 or in scenes of 2¹⁴ leaves and more, else one by one.
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
            Some(level) if self.kernel == Kernel::Avx512 || self.view.outgrows_caches() => {
                self.first_hits_in_streams(level, shots, answers);
            }
            _ => answers.extend(shots.iter().map(|shot| self.first_hit(shot))),
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
            Some(level) if self.view.is_worth_streams() => {
                self.occlusions_in_streams(level, shots, answers);
            }
            Some(level) => self.single_anys(level, shots, answers),
            None => answers.extend(shots.iter().map(|shot| self.occluded(shot))),
        }
    }
}
