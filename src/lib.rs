//! Ray tracing of NURBS surfaces without tessellation: each hit is exact to f64 rounding, or is
//! flagged doubtful.
//!
//! ```text
//! file ─▶ Scene ─▶ World ───────────────────────▶ Film ─▶ EXR, PNG
//!                    │                              ▲
//!                    ▼                              │
//!         surfaces ─▶ Bézier pieces ─▶ leaves in a hierarchy ◀─ rays
//!                                            │
//!                                            ▼
//!                            Hit: t, surface, (u, v), point, normal, flags
//! ```
//!
//! # The tour
//!
//! The modules are floors of a house: each uses only those below it, and a test enforces this.
//! From the ground up:
//!
//! | floor | what it holds |
//! |---|---|
//! | [`math`] | numbers only: [`Ray`](math::Ray), boxes, Bernstein polynomials, bounds of rounding errors, numbers in words |
//! | [`geometry`] | surfaces as authored: [`KnotVector`](geometry::KnotVector), [`NurbsSurface`](geometry::NurbsSurface), refinement, exact [`shapes`](geometry::shapes), surfaces made from curves ([`construct`](geometry::construct)), and loops that trim surfaces ([`trim`](geometry::trim)) |
//! | [`patch`] | everything becomes rational Bézier pieces, and pieces become leaves with proved bounds |
//! | [`intersect`] | one ray, one answer: [`SurfaceBvh`](intersect::SurfaceBvh) is built once; a [`Tracer`](intersect::Tracer) per thread finds the first [`Hit`](intersect::Hit) of a ray, any hit, or all hits |
//! | [`scene`] | what is seen: the [`Scene`](scene::Scene) as its author wrote it, and the [`World`](scene::World), checked and ready to trace |
//! | [`render`] | light: integrators turn rays into a [`Film`](render::Film), the same for any number of threads |
//! | [`io`] | files: scenes, models and rays in, pictures and hits out |
//!
//! The program `nurbray` stands on top and is not part of this library. Without the default
//! feature `program`, nothing is built that only the program needs.
//!
//! # One example, from a surface to a picture
//!
//! ```
//! use glam::DVec3;
//! use nurbray::geometry::shapes;
//! use nurbray::intersect::{Coherence, HitFlags, Query, SurfaceBvh};
//! use nurbray::math::Ray;
//!
//! // A rational bicubic sphere, and a ray at it. Surfaces are counted from 0.
//! let bvh = SurfaceBvh::build(&[shapes::sphere(1.0)?])?;
//! let mut tracer = bvh.tracer();
//! let down = Ray::new(DVec3::new(0.6, 0.0, 5.0), DVec3::NEG_Z)?;
//!
//! // The first hit, in f64: no grid of triangles stands between ray and surface.
//! let answer = tracer.first_hit(&Query::primary(down));
//! let hit = answer.hit.ok_or("a miss")?;
//! assert!((hit.t - 4.2).abs() < 1e-14);
//! assert!(hit.normal.distance(DVec3::new(0.6, 0.0, 0.8)) < 1e-14);
//! assert!(!answer.doubtful);
//!
//! // This ray runs in the plane of the seam, and the hit says that it is on a border.
//! assert!(hit.flags.contains(HitFlags::BORDER));
//!
//! // A ray that leaves a hit does not meet it again, and needs no epsilon for that.
//! let onwards = Query::leaving(Ray::new(hit.point, DVec3::NEG_Z)?, &hit);
//! let exit = tracer.first_hit(&onwards).hit.ok_or("a miss")?;
//! assert!((exit.t - 1.6).abs() < 1e-14);
//!
//! // All hits of a ray: a closed surface is entered as often as it is left.
//! let mut hits = Vec::new();
//! let doubtful = tracer.all_hits(&down, &mut hits);
//! assert_eq!((hits.len(), doubtful), (2, false));
//!
//! // Many rays are traced faster in batches, neighbours even in packets: `Coherence` says how.
//! let beside = |k| Ray::new(DVec3::new(0.6, 1e-3 * f64::from(k), 5.0), DVec3::NEG_Z);
//! let rays = (0..64).map(beside).collect::<Result<Vec<_>, _>>()?;
//! let mut answers = Vec::new();
//! tracer.first_hits(&rays, Coherence::Coherent, &mut answers);
//! assert!(answers.iter().all(|answer| answer.hit.is_some()));
//!
//! // The same sphere as a scene, read as from a file; camera and lights are chosen for it.
//! let text = "[[object]]\nshape = { sphere = { radius = 1 } }";
//! let scene = nurbray::io::read_scene(text, "ball.toml", &mut |_, _, _| unreachable!())?;
//! let world = nurbray::scene::World::new(&scene)?;
//!
//! // And its picture: 16 × 12 pixels, four samples each. The callback may end it early.
//! use std::ops::ControlFlow;
//! use nurbray::render::{Channel, RenderSettings, render};
//! let settings = RenderSettings { size: [16, 12], samples: 0..4, ..Default::default() };
//! let film = render(&world, &settings, &|_| ControlFlow::Continue(()))?;
//! assert_eq!(film.value(Channel::A, [8, 6]), Some(1.0)); // the ball is in the middle
//! assert_eq!(film.value(Channel::A, [0, 0]), Some(0.0)); // and not in the corner
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! To read and write files instead, see [`io::load_input`], [`io::write_exr`] and
//! [`io::write_png`], or [`io::write_exr_to`] and [`io::write_png_to`] for pictures in memory; for
//! surfaces of your own, [`geometry`]; for the language of scenes, [`io::scene_toml`].
//!
//! # What may be relied on
//!
//! Let ε = 2⁻⁵³, M the largest coordinate magnitude of the ray's origin and the surface's control
//! points, and C = 4 (p + q + 4) for a surface of degrees p and q
//! ([`math::rounding::residual_factor`] says where C comes from).
//!
//! - Each crossing of each surface is reported, or the answer is flagged
//!   [doubtful](intersect::Answer::doubtful).
//! - A hit that is not doubtful is held to its ray: `|S(u, v) − (o + t d)| ≤ C ε M`, or twice that
//!   at a pole: a ray that passes the pole within that distance meets it. (`C` is not a theorem:
//!   with weights from 1e-3 to 1e3 a few hits of 220,000 were off by 3 % more, on knot lines 30
//!   of 772,000 by up to 8 %.) So near is [`Hit::point`](intersect::Hit::point); evaluated at the
//!   reported `u` and `v`, which are rounded, S is off further by as much as their rounding moves
//!   it: far, where knots are far from 0 compared with their distances, or weights very different.
//! - Domains are closed: a ray that passes within half of `C ε M` of a border meets it (a steep ray
//!   as a rule within 0.85 of `C ε M`), and the hit is marked
//!   [`BORDER`](intersect::HitFlags::BORDER).
//! - The kept part of a trimmed surface is closed, too: a root that may lie on a trim edge, as
//!   far as rounding can tell, is a hit, marked [`TRIM_EDGE`](intersect::HitFlags::TRIM_EDGE).
//!   Sides of loops along the border of a surface are borders.
//! - Answers depend only on the ray and the surfaces, except for the last digits, which the
//!   [kernel](intersect::Kernel) and the [way of asking](intersect::Coherence) may change. Pictures
//!   depend only on the scene and its settings: not on threads, tiles or crops.
//! - The library never prints or exits, and does not panic on bad input: that is an error which
//!   says what was found, what is needed and where. (The exceptions, like indexing of slices:
//!   functions panic if given a number of coefficients that does not fit the degrees, or asked for
//!   a triangle or grid that a mesh does not have; their documentation says so.)
//! - The message of an error is complete: it contains those of its causes. So it is enough to show
//!   the message, and [`source`](std::error::Error::source) adds nothing to it (for most errors it
//!   is `None`). Causes to act on are fields of the error's variants.

/// The vectors and matrices in the signatures of this library: a user's `glam` must be of the same
/// version, and this one is.
pub use glam;

pub mod geometry;
pub mod intersect;
pub mod io;
pub mod math;
pub mod patch;
pub mod render;
pub mod scene;

/// The examples of the README are doc tests too. Its text is not repeated in these pages.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
