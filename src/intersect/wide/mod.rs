//! SIMD kernels: many boxes, and many rays, at a time.
//!
//! The scalar kernel specifies what is computed; the certificate says why it is certain. Sixteen
//! boxes are tested at once against a packet of rays (`traverse`) or, where the rays of the packet
//! have little in common, sixteen of its rays against a box (`apart`). Sixteen rays at once are
//! tested against a leaf (`leaf`, `box_crossing`). A search in f32 on an approximation of the leaf
//! (`distances`) gives Newton's iteration a start from which, as a rule, one step on the true
//! surface, in f64, reaches the promised accuracy (`finish`). Often it is enough to prove that the
//! root is not on the leaf or, if any hit will do, that it is (`screen`).
//!
//! Screening is one of three proofs added here: it concerns the one root that the certificate
//! leaves. The other two concern a ray and a leaf for which the certificate does not hold: what the
//! leaf's approximation says of that ray's roots (`single_proof`; `lane_proof` does this for
//! sixteen rays and leaves at a time, which packets collect in `doubts`), and that a ray which
//! leaves a leaf does not come back to it (`departure`, used in `start` and `packet`). What is not
//! proved is left to the scalar search.
//!
//! Parts that are small compared with the scene are searched in coordinates of their own (see
//! [`regions`](super::tree::regions)); all three ways take rays into these coordinates and back.
//!
//! The result for a ray and a leaf is computed lane by lane, so it does not depend on the other
//! rays of the packet.
//!
//! A single ray (`single`) traverses the same tree, sixteen boxes at a time, down to blocks of
//! sixteen leaves; there the lanes hold the coefficients of the one leaf that is searched.
//!
//! Many rays that have nothing in common (`stream`) each traverse the boxes in this way; then
//! sixteen pairs of a ray and a leaf are searched side by side (`pairs`), in the steps of the
//! packets (`newton`).
//!
//! The files, in reading order:
//!
//! | | packets: many rays, one leaf | single: one ray, many boxes | streams: many pairs |
//! |---|---|---|---|
//! | rays | `frames`, `load`, `packet`, `outline` | `single_ray`, `box_ray` | `frames`, `box_ray` |
//! | the tree | `traverse`, `apart` | `single` | `stream` |
//! | a leaf: box, certificate | `leaf`, `box_crossing` | `single` | `stream` |
//! | its start in f32 | `distances`, `screen` | `single_search` | `pairs` |
//! | its own proof | `doubts`, `lane_proof`, `lane_parts` | `single_proof` | as a single ray |
//! | the end in f64 | `finish`, `newton` | `single_finish` | `pair_finish`, `newton` |
//!
//! All of them use vectors in lanes (`vectors`); the reach of leaves and the rounding errors
//! (`proof`); the steps that searches take, and their ends (`convergence`); the surface in lanes
//! (`jets`, or `power_sums` where the piece is well conditioned, as its `form` says; `target`
//! serves leaves of one patch, `lane_net` those of many; nets that are not kept are made in
//! `lane_net` or `spline_net`, both by `power_lines`); bicubic polynomials (`cubic`); the treatment
//! of a ray that leaves a root (`start`, `departure`); and the decision of the trims on a hit
//! (`trimmed`).

mod apart;
mod box_crossing;
mod box_ray;
mod convergence;
mod cubic;
mod departure;
mod distances;
mod doubts;
mod finish;
mod form;
mod frames;
mod jets;
mod lane_net;
mod lane_parts;
mod lane_proof;
mod leaf;
mod load;
mod nearest;
mod newton;
mod outline;
mod packet;
mod pair_finish;
mod pairs;
mod power_lines;
mod power_sums;
mod proof;
mod screen;
mod single;
mod single_finish;
mod single_jet;
mod single_proof;
mod single_ray;
mod single_search;
mod spline_net;
mod start;
mod stream;
mod target;
mod traverse;
mod trimmed;
mod vectors;
mod view;
mod wanted;

pub(super) use box_ray::BLUR;
pub(super) use packet::{LaneHit, Packet};
pub(super) use single::{SingleWork, trace_single};
pub(super) use single_ray::{SingleHit, SingleRay};
pub(super) use stream::{FLIGHTS, Stream, trace_stream};
pub(super) use traverse::{Work, trace};
pub(super) use view::BvhView;
pub(super) use wanted::Wanted;

/// Rays in a packet: a square of 8 × 8 pixels.
pub(super) const PACKET: usize = 64;

/// A bicubic sheet of hills whose weights differ from point to point.
#[cfg(test)]
pub(in crate::intersect) fn weighted_hills() -> crate::geometry::NurbsSurface {
    use glam::DVec4;

    let knots = crate::geometry::KnotVector::clamped_uniform(3, 12).unwrap();
    let number = |k: usize| (k as f64 * 0.618_033_988_75).fract();
    let control = (0..144).map(|k| {
        let (x, y) = ((k / 12) as f64, (k % 12) as f64);
        let weight = 0.5 + 1.5 * number(k);
        weight * DVec4::new(x, y, (1.3 * x).sin() * y.cos(), 1.0)
    });
    crate::geometry::NurbsSurface::from_homogeneous(knots.clone(), knots, control.collect())
        .unwrap()
}
