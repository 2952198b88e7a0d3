//! What a ray meets: hits, and answers that may hold one.

use glam::{DVec2, DVec3};

use super::flags::HitFlags;
use crate::math::{PLAIN_SQUARES, Ray};
use crate::patch::SetId;

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
    /// The point on the surface: `S(u, v)` for the parameters before they were rounded to
    /// [`uv`](Self::uv).
    pub point: DVec3,
    /// The unit normal `S_u × S_v / |S_u × S_v|`, not turned towards the ray; NaN where it is
    /// undefined (then [`HitFlags::NO_NORMAL`] is set). It is the normal at `(u, v)` to within a
    /// few roundings (in packets to 5e-12), beside poles too; on a crease it is that of either side.
    /// Only half of its digits are sure beside collapsed sides that meet, or where all paths from a
    /// pole start in one direction.
    pub normal: DVec3,
    /// The root that secondary rays leaving this hit start on.
    pub root: Root,
}

/// A root has passed for one on the ray by its computed distance, and so may be a little farther off
/// than its error bound. Within this many times that it may be at an end of the ray, be the root
/// that the ray starts on, or be nearer than another one.
pub(crate) const SPARE: f64 = 2.0;

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
    /// The part of `error` that is across the surface: as a rule the cosine of the angle between ray
    /// and normal; 0 without a normal.
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

    /// A ray may start as far across the surface as twice the root's error there (see
    /// [`Query::leaving`](super::Query::leaving)), and the point is off by once that.
    pub(super) const START_OFF: f64 = 3.0;

    /// The root for a ray that leaves it, and starts as far across the surface from the true root,
    /// at most, as so many times the root's error there. If the ray is flatter than the one that
    /// found the root, the root may be farther off along it; without a normal that is not known.
    #[inline(always)]
    pub(super) fn seen_along(&self, ray: &Ray, normal: DVec3, times: f64) -> Self {
        let share = f64::from(if self.cosine == 0.0 { 1.0 } else { self.cosine });
        let cosine = cosine(normal, ray.direction());
        let longer = times * share / cosine.abs();
        let seen = Self::new(self.set, self.piece, self.st, self.error * longer, cosine / times);
        // By selections, not a branch: which rays are flatter cannot be predicted. False for NaN.
        let is_flatter = longer > 1.0;
        // In the plane of the surface, anywhere: the share across is then 0, as without a normal, and
        // who asks must know better how far across the root is.
        let error = if is_flatter { seen.error.min(f64::MAX) } else { self.error };
        Self { error, cosine: if is_flatter { seen.cosine } else { self.cosine }, ..*self }
    }

    /// How far across the surface the true root may be from that point, in scene units; without a
    /// normal, in any direction.
    pub(super) fn across(&self) -> f64 {
        if self.cosine == 0.0 { self.error } else { self.error * f64::from(self.cosine) }
    }
}

/// The cosine between a unit vector and another one.
#[inline(always)]
fn cosine(unit: DVec3, other: DVec3) -> f64 {
    let squared = other.length_squared();
    if PLAIN_SQUARES.contains(&squared) {
        return unit.dot(other) / squared.sqrt();
    }
    let other = other / other.abs().max_element();
    unit.dot(other) / other.length()
}

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

    use super::*;

    #[test]
    fn answers_are_small_and_misses_are_written_in_one_place() {
        assert_eq!(size_of::<Option<Root>>(), size_of::<Root>());
        assert_eq!(size_of::<Answer>(), 128);
        let set = offset_of!(Answer, hit) + offset_of!(Hit, root) + offset_of!(Root, set);
        assert_eq!(set + size_of::<f64>(), offset_of!(Answer, doubtful));
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
