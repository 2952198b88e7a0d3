//! What can be asked about: rays, and rays that leave a hit.

use super::hit::{Hit, Root, SPARE};
use crate::math::Ray;
use crate::patch::PatchSet;

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
    /// The ray should start at [`Hit::point`]. It may start where `o + t d` was rounded to, but if the
    /// ray that found the hit came from afar, that place is off the surface by as much as the ray's own
    /// rounding, and a flat ray from there may miss what one from the point would meet. A ray that
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
    /// Only that one root is left out. What the ray meets right behind it, beside a crease or across
    /// a gap, is met, or in doubt if it is no farther off than rounding.
    ///
    /// From a hit on an edge that two surfaces share, to within some roundings, the ray leaves both if
    /// it goes through both in the same sense, in or out. Where they are turned opposite ways, the
    /// answer is in doubt; where such surfaces share only a vertex, the ray may pass the other one. A
    /// ray that leaves a surface so flatly that it passes such an edge within rounding, if far away, is
    /// in doubt there.
    ///
    /// Where two surfaces coincide, as those of two solids that are cemented together, a ray that
    /// leaves one of them may meet the other at once, and a ray that leaves the other may meet the
    /// first again. So bound a loop that goes on from hit to hit. Model such an interface as one
    /// surface, or ask for [all hits](super::Tracer::all_hits).
    ///
    /// Trimmed faces are closed: beside an edge of a body, within some errors of it, a ray may meet
    /// one of both faces only, or both in the same sense, in or out. One of these hits is flagged
    /// [`TRIM_EDGE`](super::HitFlags::TRIM_EDGE).
    #[inline(always)] // else the query would be copied from where it was returned
    pub fn leaving(ray: Ray, hit: &Hit) -> Self {
        // Most start there exactly: off the true root as the point is.
        let from = if ray.origin() == hit.point {
            Some(hit.root.seen_along(&ray, hit.normal, 1.0))
        } else {
            Self::start_near(&ray, hit)
        };
        Self { ray, from }
    }

    /// The root that a ray leaves if it starts near the point of a hit, not at it.
    #[inline(never)]
    fn start_near(ray: &Ray, hit: &Hit) -> Option<Root> {
        let moved = ray.origin() - hit.point;
        let has_normal = !hit.normal.is_nan();
        let across = if has_normal { moved.dot(hit.normal).abs() } else { moved.length() };
        let is_off_surface = across > SPARE * hit.root.across();
        let starts_there = moved.length() <= SPARE * hit.root.error && !is_off_surface;
        starts_there.then(|| hit.root.seen_along(ray, hit.normal, Root::START_OFF))
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

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec3};

    use super::*;
    use crate::geometry::shapes;
    use crate::intersect::{Coherence, Kernel, Occlusion, SurfaceBvh};

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
}
