//! Rays one at a time: the fast search, and the scalar one for what it leaves undecided.

use fearless_simd::Simd;
use fearless_simd_macros::simd;
use glam::{DVec2, DVec3};

use super::answer::{answer_of, border_flag, reported_normal};
use crate::geometry::RectSide;
use crate::intersect::level::{Level, dispatch};
use crate::intersect::query::{OneShot, StartIn};
use crate::intersect::roots::meeting::{CertainHit, Meeting};
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::{BvhView, HitPlace, SingleHit, SingleRay, SingleWork, trace_single};
use crate::intersect::{Answer, Hit, HitFlags, Occlusion, Query, Root, Shot, Tracer};
use crate::math::{Ray, RayFrame};
use crate::patch::{Jet, Leaf, Piece, SetId};

impl Tracer<'_> {
    /// The first hit of one ray.
    pub(super) fn single_first(&mut self, level: Level, shot: OneShot<'_>) -> Answer {
        if self.is_beyond_f32(shot.ray) {
            return self.scalar_first(&shot.query());
        }
        if self.bvh.surroundings.is_beside(shot.ray) {
            self.findings.statistics.rays += 1;
            return Answer::default();
        }
        dispatch!(level, simd => trace_first(simd, self, shot))
    }

    /// Whether anything lies on one ray.
    pub(super) fn single_any(&mut self, level: Level, shot: OneShot<'_>) -> Occlusion {
        dispatch!(level, simd => trace_any(simd, self, shot))
    }

    /// Puts the meetings of one ray with all leaves it may meet into the findings; returns the
    /// ray's unit direction.
    pub(super) fn single_all(&mut self, level: Level, query: &Query) -> DVec3 {
        let ray = (&query.ray, query.start_in(&self.bvh.set));
        let frame = dispatch!(level, simd => fast_search(simd, self, ray, Wanted::All));
        let view = self.view;
        // At borders, which hits are one crossing depends on more than where they are.
        let SingleWork { all, undecided, .. } = &mut self.single;
        all.retain(|hit| {
            let leaf = &view.leaves[hit.place.leaf as usize];
            let st = hit.place.st;
            let near = leaf.is_at_border() && near_border(leaf, view.piece_of(hit.place.leaf), st);
            if near {
                undecided.push(hit.place.leaf);
            }
            !near
        });
        self.search_undecided_of_single((query, &frame), frame.z_range[1], Wanted::All);
        let meeting = |hit| Certain::new(&view, &query.ray, hit).meeting(&frame);
        self.findings.meetings.extend(self.single.all.iter().map(meeting));
        frame.axis
    }

    /// Whether the ray comes from too far away for the fast search.
    #[inline(always)]
    pub(super) fn is_beyond_f32(&self, ray: &Ray) -> bool {
        self.view.is_beyond_f32(ray.origin().abs().max_element())
    }

    /// Whether anything lies on each of many rays, appended to `answers`.
    pub(super) fn single_anys<Q: Shot>(
        &mut self,
        level: Level,
        shots: &[Q],
        answers: &mut Vec<Occlusion>,
    ) {
        dispatch!(level, simd => trace_any_each(simd, self, shots, answers));
    }

    /// Runs the scalar search on the leaves that the search of a single ray could not decide: see
    /// [`search_undecided`](Self::search_undecided).
    fn search_undecided_of_single(&mut self, ray: (&Query, &RayFrame), limit: f64, wanted: Wanted) {
        let undecided = std::mem::take(&mut self.single.undecided);
        self.search_undecided(ray, undecided.iter().copied(), limit, wanted);
        self.single.undecided = undecided;
    }

    /// The first of the fast search's hit and what the scalar search finds in the leaves left
    /// undecided.
    fn with_scalar_search(&mut self, query: &Query, frame: &RayFrame) -> Answer {
        let known = self.single.hit().copied();
        let limit = known.map_or(frame.z_range[1], |hit| hit.place.z);
        self.search_undecided_of_single((query, frame), limit, Wanted::First);
        let certain = known.map(|hit| Certain::new(&self.view, &query.ray, &hit).meeting(frame));
        let meetings = certain.iter().chain(&self.findings.meetings);
        let answer = answer_of(&self.bvh.set, meetings, self.findings.doubt);
        self.findings.statistics.count_doubt(answer.doubtful);
        answer
    }
}

#[simd]
fn trace_first<S: Simd>(simd: S, tracer: &mut Tracer<'_>, shot: OneShot<'_>) -> Answer {
    let frame =
        fast_search(simd, tracer, (shot.ray, shot.start_in(&tracer.bvh.set)), Wanted::First);
    if !tracer.single.undecided.is_empty() {
        return tracer.with_scalar_search(&shot.query(), &frame);
    }
    let Some(hit) = tracer.single.hit() else { return Answer::default() };
    Certain::new(&tracer.view, shot.ray, hit).answer(shot.ray, frame.t_from_z)
}

#[simd]
fn trace_any_each<S: Simd, Q: Shot>(
    simd: S,
    tracer: &mut Tracer<'_>,
    shots: &[Q],
    answers: &mut Vec<Occlusion>,
) {
    answers.reserve(shots.len());
    for shot in shots {
        answers.push(trace_any(simd, tracer, OneShot::of(shot)));
    }
}

#[simd]
fn trace_any<S: Simd>(simd: S, tracer: &mut Tracer<'_>, shot: OneShot<'_>) -> Occlusion {
    if tracer.is_beyond_f32(shot.ray) {
        return tracer.scalar_any(&shot.query());
    }
    // Unlike for first hits, nobody asks first whether the ray passes beside everything: most of
    // these rays start on a surface.
    let frame = fast_search(simd, tracer, (shot.ray, shot.start_in(&tracer.bvh.set)), Wanted::Any);
    if tracer.single.hit().is_some() {
        return Occlusion { occluded: true, doubtful: false };
    }
    if tracer.single.undecided.is_empty() {
        return Occlusion::default();
    }
    tracer.search_undecided_of_single((&shot.query(), &frame), frame.z_range[1], Wanted::Any);
    tracer.findings.occlusion()
}

/// Runs the fast search; also makes the ray's frame, and returns it for later use.
#[simd]
fn fast_search<S: Simd>(
    simd: S,
    tracer: &mut Tracer<'_>,
    (ray, from): (&Ray, Option<&Root>),
    wanted: Wanted,
) -> RayFrame {
    let bvh = tracer.bvh;
    let frame = RayFrame::new(ray);
    let mut single = SingleRay::new(&frame, from, wanted, bvh.tree.frame());
    tracer.findings.statistics.rays += 1;
    trace_single(simd, &tracer.view, &mut single, &mut tracer.single);
    frame
}

/// A certified hit with its piece, normal and flags.
pub(super) struct Certain<'a> {
    set: SetId,
    piece: &'a Piece,
    index: u32,
    hit: &'a SingleHit,
    normal: DVec3,
    flags: HitFlags,
}

impl<'a> Certain<'a> {
    #[inline(always)]
    pub(super) fn new(view: &BvhView<'a>, ray: &Ray, hit: &'a SingleHit) -> Self {
        let leaf = &view.leaves[hit.place.leaf as usize];
        let (index, piece) = (leaf.piece, view.piece_of(hit.place.leaf));
        let st = hit.place.st;
        let mut normal = hit.normal();
        let mut flags = HitFlags::NONE;
        // Near a pole the normal is a limit, and its digits are lost in short tangents.
        if leaf.has_short_tangents() {
            let limit = piece.normal(st, &piece.patch.jet(st));
            normal = reported_normal(piece, hit.point, limit).unwrap_or(DVec3::NAN);
        }
        if leaf.is_at_border() && near_border(leaf, piece, st) {
            let magnitude = ray.origin().abs().max_element();
            flags = border_flag(piece, st, &piece.patch.jet(st), magnitude);
        }
        if !normal.is_finite() {
            flags.insert(HitFlags::NO_NORMAL);
        }
        Self { set: view.set.id(), piece, index, hit, normal, flags }
    }

    /// The hit as an answer.
    #[inline(always)]
    pub(super) fn answer(&self, ray: &Ray, t_from_z: f64) -> Answer {
        let HitPlace { z, z_error, st, .. } = self.hit.place;
        let point = self.hit.point;
        let t = z * t_from_z;
        // A hit so far away that `t` is infinite lies beyond every range.
        let within = t < f64::INFINITY;
        if !within {
            return Answer::default();
        }
        // 0 without a normal: `max` of NaN and a number is the number.
        let cosine = (self.normal.dot(ray.direction()) * t_from_z).abs().max(0.0);
        let root = Root::new(self.set, self.index, st, z_error, cosine);
        let (surface, uv) = (self.piece.surface, self.piece.uv(st));
        let (normal, flags) = (self.normal, self.flags);
        let hit = Some(Hit { t, surface, uv, point, normal, flags, root });
        Answer { hit, doubtful: false }
    }

    /// The hit as the scalar search would have found it.
    fn meeting(&self, frame: &RayFrame) -> Meeting {
        let HitPlace { z, z_error, st, .. } = self.hit.place;
        let point = self.hit.point;
        let hit = CertainHit {
            t: z * frame.t_from_z,
            z_error,
            piece: self.index,
            st,
            jet: Jet { point, ..self.piece.patch.jet(st) },
            normal: self.normal.is_finite().then_some(self.normal),
            flags: self.flags.without(HitFlags::NO_NORMAL),
        };
        hit.meeting(self.piece, frame)
    }
}

/// Whether a hit may lie within rounding of a border of its surface.
fn near_border(leaf: &Leaf, piece: &Piece, st: DVec2) -> bool {
    let distances = RectSide::distances(st);
    let is_near =
        |side| leaf.near_border(piece, side).is_some_and(|reach| distances[side] <= reach);
    RectSide::ALL.into_iter().any(is_near)
}
