//! How it is made fast: many boxes, and many rays, at a time.
//!
//! The scalar kernel says what is computed, the certificate why it is certain; one proof is added
//! here, of a single ray on a leaf's approximation (`single_proof`). Sixteen boxes are tested at
//! once against a packet of rays, sixteen rays at once against a leaf. A search in f32 on an approximation of the leaf gives Newton's
//! iteration a start from which one or two steps on the true surface, in f64, reach the
//! promised accuracy. Whatever is not certified is searched ray by ray, with a proof of its own
//! (`single_proof`), and at last goes to the scalar search.
//!
//! What becomes of a ray and a leaf is computed lane by lane, so it does not depend on the
//! other rays of the packet.
//!
//! A ray that comes alone (`single`) goes through the same tree, sixteen boxes at a time, down to
//! blocks of sixteen leaves; then the lanes hold the coefficients of the one leaf that is searched. Where the certificate does not speak of the ray, and before the exact
//! solver is called, the leaf's approximation is asked what it can prove (`single_proof`).

mod distances;
mod finish;
mod jets;
mod lane_proof;
mod load;
mod packet;
mod search;
mod single;
mod single_finish;
mod single_proof;
mod single_ray;
mod single_search;
mod traverse;
mod trimmed;

pub(super) use packet::{LaneHit, Packet};
pub(super) use single::{Scene, SingleWork, trace_single};
pub(super) use single_ray::{SingleHit, SingleRay, Wanted};
pub(super) use traverse::{Work, trace};

/// Rays in a packet: a square of 8 × 8 pixels.
pub(super) const PACKET: usize = 64;

use super::tree::LANES;
