//! One ray, one answer: what a ray meets, proved or flagged doubtful.
//!
//! [`SurfaceBvh::build`] prepares surfaces once. A [`Tracer`], one per thread, then answers
//! a ray or a [`Query`] by [`first_hit`](Tracer::first_hit), [`occluded`](Tracer::occluded) or
//! [`all_hits`](Tracer::all_hits); the first two exist for whole batches, too.
//!
//! How a ray is traced:
//!
//! 1. The hierarchy yields the leaves whose boxes the ray meets, near ones first.
//! 2. Where the leaf's certificate holds for the ray's direction, there is at most one root,
//!    and Newton's iteration on the true surface finds it, or proves that there is none, or
//!    gives up.
//! 3. Otherwise (near silhouettes, at poles, where leaves are folded) *the exact
//!    solver* finds all roots by subdivision and proof, independently of Newton.
//! 4. On a leaf that a trim curve passes through, each root is tested for its side of the curve. A
//!    root that is cut off is no hit, and the search goes on.
//! 5. Where rounding decides, as at a tangency to within the last bits, the answer is flagged:
//!    [`Answer::doubtful`].
//!
//! # What is computed, why it is certain, how it is made fast
//!
//! Beside the files of the public types there are these folders, in reading order:
//!
//! | | |
//! |---|---|
//! | *what is computed* | |
//! | `scalar` | the readable specification: the leaves a ray may meet, and its roots on one leaf |
//! | `roots` | which roots count as hits: at borders, poles, trim edges, and where the ray starts |
//! | `crossings` | which hits are one crossing |
//! | `tracer` | which kernel is asked, and what is reported of what it finds |
//! | *why it is certain* | |
//! | `patch/certificate` | made once for a leaf: which rays meet it at most once |
//! | `exact` | for any ray: all roots on a leaf, by subdivision and proof |
//! | `wide/proof` | for one ray, by a leaf's approximation: that it misses the leaf or meets it once (`one_ray`), that a root is its only one (`screen`), that it never comes back to the leaf it starts on (`departure`) |
//! | *how it is made fast* | |
//! | `tree` | the hierarchy of boxes that all kernels traverse |
//! | `wide` | the fast kernels |
//!
//! The fast kernels trace coherent batches ([`Coherence`]) in packets and search sixteen rays at a
//! time in f32. Of incoherent batches they search sixteen pairs of a ray and a leaf at a time, if
//! that pays off; else, as for one ray, they test sixteen boxes at a time. Things that are small
//! compared with the scene are searched in coordinates of their own (regions of the `tree`), since
//! f32 would not resolve them otherwise. Each hit is finished in f64 on the true surface. What no
//! certificate and no proof decides goes to the scalar search. The answer for a ray does not depend
//! on its neighbours.
//!
//! # Names
//!
//! | | |
//! |---|---|
//! | `t`, `z` | distance along a ray, as its parameter and in scene units: `t = z · t_from_z` |
//! | `u`, `v` | parameters of a surface, in its knots' domain (of charts, `chart_uv`) |
//! | `st` | parameters of a Bézier piece, from 0 to 1 (its `t` is not the ray's) |
//! | `x`, `y` | in a leaf's box, from −1 to 1; of a ray's frame, distances from its two planes |
//! | `error` | how far off a point may be across the ray; `z_error`, `t_error`: along it |
//!
//! A question has several names on its way to a leaf:
//!
//! | | |
//! |---|---|
//! | [`Query`], [`Shot`] | a ray, perhaps with the root that it leaves; what may be traced as one |
//! | `OneShot`, `Shots` | one and several, by reference, whichever of both they are |
//! | `Wanted` | what is asked for: the first hit, any, or all |
//! | `Question` | a query of one hierarchy, as the scalar search puts it to all leaves |
//! | `Problem` | what the exact solver is asked of one leaf |
//!
//! A place where a ray meets a surface has several names on its way to the caller:
//!
//! | | |
//! |---|---|
//! | `Solution` | a search of a leaf says that the ray meets it there, and how that is known |
//! | `Spot` | that place on its piece, with the surface there |
//! | `Meeting` | a solution that counts: on the piece, in the ray's range, kept by trims |
//! | `SingleHit`, `LaneHit`, `CertainHit` | one that a fast kernel is certain of |
//! | `Crossing` | meetings of several leaves or surfaces that are one |
//! | [`Hit`], [`Root`] | what is reported, and the part of it that only this library understands |
//!
//! Of how far off such a place may be, and by whose fault, [the last section](#errors-and-who-may-spend-them)
//! gives an account.
//!
//! For [`Tracer::all_hits`] the fast kernels find the hits that are certain and away from borders,
//! and the scalar search finds the others: which of those are one crossing takes more to tell.
//! [`Tracer::exact_first_hit`] and [`Tracer::exact_all_hits`] use the exact solver alone; the
//! program's `audit` compares the fast search with it.
//!
//! ```
//! use glam::DVec3;
//! use nurbray::geometry::shapes;
//! use nurbray::intersect::{HitFlags, Query, SurfaceBvh};
//! use nurbray::math::Ray;
//!
//! // Surface 0 and surface 1: a table, and a sphere above it.
//! let table = shapes::plane(4.0, 4.0)?;
//! let up = glam::DAffine3::from_translation(DVec3::new(0.0, 0.0, 2.0));
//! let ball = shapes::sphere(1.0)?.transformed(&up)?;
//! let bvh = SurfaceBvh::build(&[table, ball])?;
//! let mut tracer = bvh.tracer();
//!
//! // Down through the poles of the sphere: every pole is a border, and one hit.
//! let ray = Ray::new(DVec3::new(0.0, 0.0, 10.0), DVec3::NEG_Z)?;
//! let mut hits = Vec::new();
//! let doubtful = tracer.all_hits(&ray, &mut hits);
//! let met: Vec<_> = hits.iter().map(|hit| hit.surface).collect();
//! assert_eq!((met, doubtful), (vec![1, 1, 0], false));
//! assert!((hits[0].t - 7.0).abs() < 1e-14 && hits[0].flags.contains(HitFlags::BORDER));
//!
//! // A point of the table in the shadow of the sphere, and one in the light.
//! for (x, shadowed) in [(0.5, true), (1.5, false)] {
//!     let down = Ray::new(DVec3::new(x, 0.1, 0.5), DVec3::NEG_Z)?;
//!     let hit = tracer.first_hit(&down).hit.ok_or("a miss")?;
//!     let to_light = Query::leaving(Ray::new(hit.point, DVec3::Z)?, &hit);
//!     assert_eq!(tracer.occluded(&to_light).occluded, shadowed);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
#![doc = include_str!("errors.md")]

mod bvh;
mod coherence;
mod crossings;
mod exact;
mod f32_reach;
mod flags;
mod hit;
mod kernel;
mod level;
mod query;
mod roots;
mod scalar;
mod statistics;
mod tracer;
mod tree;
mod wanted;
mod wide;

pub use bvh::SurfaceBvh;
pub use coherence::{Coherence, Neighbours};
pub use flags::HitFlags;
pub use hit::{Answer, Hit, Occlusion, Root};
pub use kernel::{Kernel, UnknownKernel};
pub use query::{Query, Shot};
pub use statistics::Statistics;
pub use tracer::Tracer;

pub use crate::patch::BuildError;
