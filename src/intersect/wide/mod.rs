//! How it is made fast: many boxes, and many rays, at a time.
//!
//! The scalar kernel says what is computed, the certificate why it is certain. Sixteen boxes are
//! tested at once against a packet of rays (`traverse`), or sixteen of its rays against a box where they
//! have little in common (`apart`); sixteen rays at once against a leaf
//! (`leaf`, `box_crossing`). A search in f32 on an approximation of the leaf (`distances`) gives Newton's
//! iteration a start from which one step on the true surface, in f64, as a rule reaches the
//! promised accuracy (`finish`); often it is enough to prove that the root is not on the leaf, or, if any
//! hit will do, that it is (`screen`).
//!
//! Screening is one of three proofs that are added here: it is about the one root that the certificate leaves. The
//! others are about a ray and a leaf that it does not speak of: what the leaf's approximation says of that ray's
//! roots (`single_proof`), for sixteen rays and leaves at a time in `lane_proof`, where packets put them together
//! (`doubts`); and that a ray which leaves a leaf does not come back to it (`departure`, asked in `start`). What is
//! not proved goes to the scalar search at last.
//!
//! What is small against the scene is searched in coordinates of its own (see
//! [`regions`](super::regions)): all three ways lead rays there and back.
//!
//! What becomes of a ray and a leaf is computed lane by lane, so it does not depend on the
//! other rays of the packet.
//!
//! A ray that comes alone (`single`) goes through the same tree, sixteen boxes at a time, down to
//! blocks of sixteen leaves; then the lanes hold the coefficients of the one leaf that is searched.
//!
//! Of many rays that have nothing in common (`stream`) each goes through the boxes like that; then
//! sixteen pairs of a ray and a leaf are searched side by side (`pairs`), in the steps of the packets
//! (`newton`).
//!
//! The files, in the order to read them in:
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
//! All stand on vectors in lanes (`vectors`), on how far leaves reach and what rounding leaves (`proof`), on the
//! surface in lanes (`jets`, or `power_sums` where it is well conditioned, as the `form` of a piece says; for leaves of
//! one patch by `target`, of many by `lane_net`, their nets made there or by `spline_net`, both by `power_lines`, if
//! they are not kept), on bicubic polynomials (`cubic`), on what becomes of a ray that leaves a root (`start`,
//! `departure`), and on what trims say of a hit (`trimmed`).

mod apart;
mod box_crossing;
mod box_ray;
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
mod searched;
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
mod wanted;

pub(super) use box_ray::BLUR;
pub(super) use packet::{LaneHit, Packet};
pub(super) use searched::Searched;
pub(super) use single::{SingleWork, trace_single};
pub(super) use single_ray::{SingleHit, SingleRay};
pub(super) use stream::{FLIGHTS, Stream, trace_stream};
pub(super) use traverse::{Work, trace};
pub(super) use wanted::Wanted;

use super::tree::LANES;

/// Rays in a packet: a square of 8 × 8 pixels.
pub(super) const PACKET: usize = 64;

/// A bicubic sheet of hills whose weights differ from point to point.
#[cfg(test)]
fn weighted_hills() -> crate::geometry::NurbsSurface {
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
