//! What a ray meets: hits, their flags, and queries for them.

use std::fmt;
use std::ops::{BitOr, BitOrAssign};

use glam::{DVec2, DVec3};

use crate::math::Ray;
use crate::math::bits::has;
use crate::patch::{PatchSet, SetId};

/// One meeting of a ray and a surface, in f64.
///
/// Hits are equal if all of their numbers are. A hit without a normal equals nothing, not even
/// itself, since its normal is NaN.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)] // see `Answer`
pub struct Hit {
    /// The ray parameter: the hit lies at `o + t d`, with `d` as the caller gave it.
    pub t: f64,
    /// Which surface is met: its index in the slice that
    /// [`SurfaceBvh::build`](super::SurfaceBvh::build) was given, and no more than that, since the
    /// hierarchy does not keep the surfaces. In a scene it is an index into
    /// [`World::surfaces`](crate::scene::World::surfaces).
    pub surface: u32,
    /// What else is known about the hit.
    pub flags: HitFlags,
    /// The surface parameters, in the surface's own knot domain.
    pub uv: DVec2,
    /// The point on the surface, `S(u, v)`.
    pub point: DVec3,
    /// The unit normal `S_u × S_v / |S_u × S_v|`, not turned towards the ray; NaN where it is
    /// undefined (then [`HitFlags::NO_NORMAL`] is set). It is the normal at `(u, v)` to within a
    /// few roundings (in packets to 5e-12), beside poles too. Only half of its digits are sure
    /// beside collapsed sides that meet, or where all paths from a pole start in one direction.
    pub normal: DVec3,
    /// The root that secondary rays leaving this hit start on.
    pub root: Root,
}

/// A root a secondary ray may leave: opaque to the caller, taken from [`Hit::root`].
#[derive(Clone, Copy, Debug)]
#[repr(C)] // see `Answer`
pub struct Root {
    /// Its parameters in the unit square of its piece.
    pub(crate) st: DVec2,
    /// How far along the ray the true root may be from the surface's point at `st`, in scene units.
    /// Where the ray may run along the surface, this may be more than the surface's size.
    pub(crate) error: f64,
    /// The Bézier piece it was found on.
    pub(crate) piece: u32,
    /// The part of `error` that is across the surface: the cosine of the angle between ray and
    /// normal; 0 without a normal.
    pub(crate) cosine: f32,
    /// The surfaces it was found on; zero in place of an absent root.
    pub(crate) set: SetId,
}

/// Roots are equal if all of their numbers are, in whatever hierarchy they were found.
impl PartialEq for Root {
    fn eq(&self, other: &Self) -> bool {
        let Self { set: _, piece, cosine, st, error } = *self;
        (piece, cosine, st, error) == (other.piece, other.cosine, other.st, other.error)
    }
}

impl Root {
    /// The root at a place of a piece. `cosine` is that of the angle between ray and normal, or 0
    /// without a normal; of either sign.
    #[inline(always)]
    pub(super) fn new(set: SetId, piece: u32, st: DVec2, error: f64, cosine: f64) -> Self {
        // Rounded up by about a unit, in one multiplication, since this is done for every hit.
        let cosine = ((1.0 + f64::from(f32::EPSILON)) * cosine.abs()) as f32;
        Self { st, error, cosine, piece, set }
    }

    /// How far across the surface the true root may be from that point, in scene units; without a
    /// normal, in any direction.
    pub(super) fn across(&self) -> f64 {
        if self.cosine == 0.0 { self.error } else { self.error * f64::from(self.cosine) }
    }
}

/// Facts about a hit, one bit each; the numbers are the `flags` column of `cast`.
#[derive(Clone, Copy, Default, PartialEq, Eq, Hash)]
pub struct HitFlags(u8);

impl HitFlags {
    /// No facts.
    pub const NONE: Self = Self(0);
    /// Floating point could not decide the answer.
    pub const DOUBTFUL: Self = Self(1);
    /// The hit lies on the border of the surface's domain, to within rounding.
    pub const BORDER: Self = Self(2);
    /// The surface has no normal here.
    pub const NO_NORMAL: Self = Self(4);
    /// The hit lies on a trim edge, to within rounding. Sides of loops along the border or the seam
    /// of a surface are only [`BORDER`](Self::BORDER)s.
    pub const TRIM_EDGE: Self = Self(8);
    /// The ray runs inside the surface; the hit is an end of that stretch.
    pub const INSIDE: Self = Self(16);

    /// The names of the bits, the lowest first.
    const NAMES: [&str; 5] = ["DOUBTFUL", "BORDER", "NO_NORMAL", "TRIM_EDGE", "INSIDE"];

    /// Whether every bit of `other` is set.
    pub fn contains(self, other: Self) -> bool {
        self.0 & other.0 == other.0
    }

    /// These bits and those of `other`.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// These bits except those of `other`.
    #[must_use]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Sets the bits of `other`.
    pub fn insert(&mut self, other: Self) {
        self.0 |= other.0;
    }

    /// The bits as a number.
    pub fn bits(self) -> u8 {
        self.0
    }

    /// The flags with these bits; `None` if one of them has no meaning.
    pub fn from_bits(bits: u8) -> Option<Self> {
        (bits >> Self::NAMES.len() == 0).then_some(Self(bits))
    }

    /// Whether no bit is set.
    pub fn is_empty(self) -> bool {
        self.0 == 0
    }
}

impl BitOr for HitFlags {
    type Output = Self;

    /// As [`HitFlags::with`].
    fn bitor(self, other: Self) -> Self {
        self.with(other)
    }
}

impl BitOrAssign for HitFlags {
    /// As [`HitFlags::insert`].
    fn bitor_assign(&mut self, other: Self) {
        self.insert(other);
    }
}

/// The names of the bits, as `BORDER | TRIM_EDGE`, or `NONE`.
impl fmt::Display for HitFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let set = Self::NAMES.iter().enumerate().filter(|&(bit, _)| has(self.0, bit));
        let names: Vec<_> = set.map(|(_, name)| *name).collect();
        f.pad(&if names.is_empty() { "NONE".into() } else { names.join(" | ") })
    }
}

impl fmt::Debug for HitFlags {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "HitFlags({self})")
    }
}

/// A ray to trace and, if it is a secondary ray, the root it leaves.
///
/// That root is not reported again and, where it is the only root there may be, not even searched
/// for. So only [`Query::leaving`] sets it, after checking that the ray starts there.
///
/// Queries are equal if all of their numbers are, in whatever hierarchy their roots were found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    pub(super) ray: Ray,
    pub(super) from: Option<Root>,
}

impl Query {
    /// A ray that starts nowhere in particular.
    pub fn primary(ray: Ray) -> Self {
        Self { ray, from: None }
    }

    /// A ray that leaves a hit: the hit itself is not met again.
    ///
    /// The ray should start at [`Hit::point`], or as near as `o + t d` comes to it. A ray that
    /// starts elsewhere, for instance because its origin was moved along the normal to be on the
    /// safe side, does not leave the hit: it is traced like any other ray, and
    /// [`start_root`](Self::start_root) is `None`. The hit must be unchanged: only its point and
    /// normal are checked.
    ///
    /// To other hierarchies than the one that found the hit, if only built again of the same
    /// surfaces, the ray is like any other, as it starts on none of their surfaces.
    ///
    /// A plain ray from [`Hit::point`], or [`Query::primary`], is no substitute. Rounding decides
    /// on which side of the surface it starts: many such answers are doubtful, and some report the
    /// surface itself again.
    ///
    /// A ray that ends on another hit is in doubt there: whether two hits see each other,
    /// [`Tracer::occluded_between`](super::Tracer::occluded_between) says.
    ///
    /// Only that one root is left out. Where two surfaces coincide, as those of two solids that are
    /// cemented together, a ray that leaves one of them may meet the other at once, and a ray that
    /// leaves the other may meet the first again. So bound a loop that goes on from hit to hit.
    /// Model such an interface as one surface, or ask for [all hits](super::Tracer::all_hits).
    ///
    /// Trimmed faces are closed: beside an edge of a body, within some errors of it, a ray may meet
    /// one of both faces only, or both in the same sense, in or out. One of these hits is flagged
    /// [`TRIM_EDGE`](HitFlags::TRIM_EDGE).
    pub fn leaving(ray: Ray, hit: &Hit) -> Self {
        // Most start there exactly.
        if ray.origin() == hit.point {
            return Self { ray, from: Some(hit.root) };
        }
        let moved = ray.origin() - hit.point;
        let has_normal = !hit.normal.is_nan();
        let across = if has_normal { moved.dot(hit.normal).abs() } else { moved.length() };
        let is_off_surface = across > 2.0 * hit.root.across();
        let starts_there = moved.length() <= 2.0 * hit.root.error && !is_off_surface;
        Self { ray, from: starts_there.then_some(hit.root) }
    }

    /// The ray.
    pub fn ray(&self) -> &Ray {
        &self.ray
    }

    /// The root the ray starts on, to within its error; `None` if it leaves no hit.
    pub fn start_root(&self) -> Option<&Root> {
        self.from.as_ref()
    }
}

impl From<Ray> for Query {
    /// As [`Query::primary`].
    fn from(ray: Ray) -> Self {
        Self::primary(ray)
    }
}

/// What can be asked about: a [`Ray`], which starts nowhere in particular, or a [`Query`]. In
/// batches, rays alone take less memory to read.
pub trait Shot: sealed::Sealed {
    /// The ray.
    fn ray(&self) -> &Ray;
    /// The root the ray starts on.
    fn start_root(&self) -> Option<&Root>;
    /// Both.
    fn query(&self) -> Query {
        Query { ray: *self.ray(), from: self.start_root().copied() }
    }
}

/// The root of these surfaces that a ray starts on: a root of other surfaces is none.
pub(crate) trait StartIn: Shot {
    /// See [`StartIn`].
    #[inline(always)]
    fn start_in(&self, set: &PatchSet) -> Option<&Root> {
        OneShot::of(self).start_in(set)
    }
}

impl<Q: Shot> StartIn for Q {}

impl Shot for Ray {
    fn ray(&self) -> &Ray {
        self
    }

    fn start_root(&self) -> Option<&Root> {
        None
    }
}

impl Shot for Query {
    fn ray(&self) -> &Ray {
        &self.ray
    }

    fn start_root(&self) -> Option<&Root> {
        self.from.as_ref()
    }
}

/// One shot, of either kind.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OneShot<'a> {
    pub ray: &'a Ray,
    start: Option<&'a Root>,
}

impl<'a> OneShot<'a> {
    #[inline(always)]
    pub(crate) fn of<Q: Shot>(shot: &'a Q) -> Self {
        Self { ray: shot.ray(), start: shot.start_root() }
    }

    /// The root of these surfaces that the ray starts on.
    #[inline(always)]
    pub(crate) fn start_in(&self, set: &PatchSet) -> Option<&'a Root> {
        self.start.filter(|root| root.set == set.id())
    }

    pub(crate) fn query(&self) -> Query {
        Query { ray: *self.ray, from: self.start.copied() }
    }
}

mod sealed {
    use super::{Query, Ray};

    /// Only the two kinds of shot there are.
    pub trait Sealed: Sized {
        /// Tells which kind these are.
        fn shots(all: &[Self]) -> Shots<'_>;
    }

    /// Shots of either kind.
    ///
    /// What takes these is not generic: it is compiled once, in this library, and not again in
    /// every crate that traces rays, as optimised generic functions are.
    #[derive(Clone, Copy, Debug)]
    pub enum Shots<'a> {
        Rays(&'a [Ray]),
        Queries(&'a [Query]),
    }

    impl Sealed for Ray {
        fn shots(all: &[Self]) -> Shots<'_> {
            Shots::Rays(all)
        }
    }

    impl Sealed for Query {
        fn shots(all: &[Self]) -> Shots<'_> {
            Shots::Queries(all)
        }
    }
}

pub(crate) use sealed::Shots;

/// The first hit, or a proved miss (the default), or a doubtful answer. Answers compare as [`Hit`]s
/// do: one with a hit that has no normal equals nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[must_use = "it may be doubtful"]
// All that is written of a miss are the set of an absent root, and what follows it: these should be
// in one cache line. Measured: a sheet's pictures are traced 1.04 times as fast.
#[repr(C)]
pub struct Answer {
    /// The hit with the smallest `t`.
    pub hit: Option<Hit>,
    /// Whether floating point could not decide some part of the answer. If there is a hit, it is
    /// flagged [`DOUBTFUL`](HitFlags::DOUBTFUL) if and only if the answer is.
    pub doubtful: bool,
}

/// Whether anything lies on the ray.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[must_use = "it may be doubtful"]
pub struct Occlusion {
    /// Whether some surface is met: for certain, unless the answer is `doubtful`.
    pub occluded: bool,
    /// Whether floating point could not decide: all that was met is itself in doubt (`occluded`),
    /// or nothing was met, but something may have been missed.
    pub doubtful: bool,
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use glam::DAffine3;

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::{Coherence, Kernel, SurfaceBvh};

    #[test]
    fn flags_are_shown_by_name() {
        let shown = |flags: HitFlags| format!("{flags:?}");
        assert_eq!(shown(HitFlags::NONE), "HitFlags(NONE)");
        assert_eq!(shown(HitFlags::BORDER), "HitFlags(BORDER)");
        assert_eq!(shown(HitFlags::NO_NORMAL), "HitFlags(NO_NORMAL)");
        assert_eq!(shown(HitFlags::INSIDE), "HitFlags(INSIDE)");
        let both = HitFlags::TRIM_EDGE.with(HitFlags::DOUBTFUL);
        assert_eq!(shown(both), "HitFlags(DOUBTFUL | TRIM_EDGE)");
        let all = [HitFlags::BORDER, HitFlags::NO_NORMAL, HitFlags::INSIDE].into_iter();
        assert_eq!(shown(all.fold(both, HitFlags::with)).matches('|').count(), 4);
        assert_eq!(both.to_string(), "DOUBTFUL | TRIM_EDGE");
        assert_eq!(format!("{:>6}|", HitFlags::NONE), "  NONE|");
    }

    #[test]
    fn flags_are_their_bits() {
        for bits in 0..32 {
            assert_eq!(HitFlags::from_bits(bits).unwrap().bits(), bits);
        }
        assert_eq!(HitFlags::from_bits(32), None);
        assert_eq!(HitFlags::from_bits(129), None);
        let mut flags = HitFlags::BORDER | HitFlags::INSIDE;
        assert_eq!(flags.bits(), 18);
        flags |= HitFlags::DOUBTFUL;
        assert_eq!(flags.bits(), 19);
    }

    #[test]
    fn a_ray_is_asked_about_as_its_query_is() {
        let bvh = SurfaceBvh::build(&[shapes::sphere(1.0).unwrap()]).unwrap();
        let down = |k| Ray::new(DVec3::new(0.015 * f64::from(k), 0.1, 3.0), DVec3::NEG_Z).unwrap();
        let rays: Vec<Ray> = (0..100).map(down).collect();
        let queries: Vec<Query> = rays.iter().copied().map(Query::from).collect();
        assert!(queries.iter().zip(&rays).all(|(query, ray)| *query == Query::primary(*ray)));
        for kernel in [Kernel::Scalar, Kernel::default()] {
            let mut tracer = bvh.tracer_with(kernel);
            for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                let (mut some, mut same) = (Vec::new(), Vec::new());
                tracer.occlusions(&rays, coherence, &mut some);
                tracer.occlusions(&queries, coherence, &mut same);
                assert_eq!(some, same);
                assert!(
                    some.iter().any(|one| one.occluded) && !some.iter().all(|one| one.occluded)
                );
            }
            let (mut hits, mut same) = (Vec::new(), Vec::new());
            for (ray, query) in rays.iter().zip(&queries) {
                assert_eq!(tracer.occluded(ray), tracer.occluded(query));
                assert_eq!(tracer.exact_first_hit(ray), tracer.exact_first_hit(query));
                // The hits of other rays do not stay.
                let doubtful = [tracer.all_hits(ray, &mut hits), tracer.all_hits(query, &mut same)];
                assert_eq!((&hits, doubtful), (&same, [false; 2]));
                assert_eq!(hits.len(), if tracer.occluded(ray).occluded { 2 } else { 0 });
            }
        }
    }

    #[test]
    fn answers_are_small_and_misses_are_written_in_one_place() {
        assert_eq!(size_of::<Option<Root>>(), size_of::<Root>());
        assert_eq!(size_of::<Answer>(), 128);
        let set = offset_of!(Answer, hit) + offset_of!(Hit, root) + offset_of!(Root, set);
        assert_eq!(set + size_of::<f64>(), offset_of!(Answer, doubtful));
    }

    #[test]
    fn a_hit_of_another_hierarchy_is_none_to_leave() {
        // A wall, and another behind it in a hierarchy of its own.
        let wall = || shapes::plane(2.0, 2.0).unwrap();
        let behind = wall().transformed(&DAffine3::from_translation(DVec3::Z)).unwrap();
        let [first, second] = [wall(), behind].map(|one| SurfaceBvh::build(&[one]).unwrap());
        let again = SurfaceBvh::build(&[wall()]).unwrap();
        for kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut near = first.tracer_with(*kernel);
            let ray = |k: i32| {
                let at = DVec3::new(0.01 * f64::from(k) - 0.9, 0.3, -1.0);
                Ray::new(at, DVec3::new(0.1, 0.2, 1.0)).unwrap()
            };
            let hits: Vec<Hit> = (0..150).map(|k| near.first_hit(&ray(k)).hit.unwrap()).collect();
            let onwards: Vec<Query> = hits
                .iter()
                .map(|hit| Query::leaving(Ray::new(hit.point, DVec3::Z).unwrap(), hit))
                .collect();
            assert!(onwards.iter().all(|query| query.start_root().is_some()));
            assert!(onwards.iter().all(|query| *query != Query::primary(*query.ray())));
            for (bvh, is_met) in [(&first, false), (&first.clone(), false), (&second, true)] {
                let mut tracer = bvh.tracer_with(*kernel);
                let (mut answers, mut occlusions, mut all) = Default::default();
                for coherence in [Coherence::Coherent, Coherence::Incoherent] {
                    tracer.first_hits(&onwards, coherence, &mut answers);
                    tracer.occlusions(&onwards, coherence, &mut occlusions);
                    for (k, query) in onwards.iter().enumerate() {
                        let doubtful = tracer.all_hits(query, &mut all);
                        assert_eq!((all.len(), doubtful), (usize::from(is_met), false));
                        assert_eq!(answers[k].hit.is_some(), is_met, "{kernel} {coherence:?}");
                        assert_eq!(occlusions[k], Occlusion { occluded: is_met, doubtful: false });
                    }
                }
            }
            // To the same surfaces built again, a ray through the wall starts beside it.
            let back = Ray::with_range(hits[9].point, DVec3::Z, -1.0, 1.0).unwrap();
            let query = Query::leaving(back, &hits[9]);
            assert!(near.first_hit(&query).hit.is_none());
            assert!(again.tracer_with(*kernel).first_hit(&query).hit.is_some());
        }
    }

    #[test]
    fn a_hit_without_a_normal_equals_nothing() {
        let set = SetId::unique();
        let root = Root { set, piece: 0, cosine: 1.0, st: DVec2::ZERO, error: 0.0 };
        let hit = Hit {
            t: 1.0,
            surface: 0,
            uv: DVec2::ZERO,
            point: DVec3::Z,
            normal: DVec3::Z,
            flags: HitFlags::NONE,
            root,
        };
        let answer = |hit| Answer { hit: Some(hit), doubtful: false };
        assert_eq!(answer(hit), answer(hit));
        assert_ne!(answer(hit), answer(Hit { t: 2.0, ..hit }));
        assert_ne!(hit, Hit { root: Root { piece: 1, ..root }, ..hit });
        assert_eq!(hit, Hit { root: Root { set: SetId::unique(), ..root }, ..hit });
        let pole = Hit { normal: DVec3::NAN, flags: HitFlags::NO_NORMAL, ..hit };
        assert_ne!(answer(pole), answer(pole));
        assert_eq!(Answer::default(), Answer::default());
    }
}
