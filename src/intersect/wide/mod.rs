//! SIMD kernels: many boxes, and many rays, at a time.
//!
//! The scalar kernel specifies what is computed; the certificate says why it is certain. There are
//! three ways to trace rays fast, a folder each:
//!
//! - `packet`: many rays that have much in common. Sixteen boxes are tested at once against all of
//!   them, then sixteen rays against a leaf.
//! - `single`: one ray, against sixteen boxes at a time.
//! - `stream`: many rays that have nothing in common. Each goes through the boxes as a single ray;
//!   then sixteen pairs of a ray and a leaf are searched side by side.
//!
//! On a leaf, a search in f32 on its approximation gives Newton's iteration a start from which, as
//! a rule, one step on the true surface, in f64, reaches the promised accuracy. Proofs beside that
//! of the certificate (`proof`) save many of these steps, and most calls of the scalar search. What
//! is not proved is left to the scalar search.
//!
//! Parts that are small compared with the scene are searched in coordinates of their own (see
//! [`regions`](super::tree::regions)); all three ways take rays into these coordinates and back.
//!
//! The result for a ray and a leaf is computed lane by lane, so it does not depend on the other
//! rays.
//!
//! # Names
//! A leaf and a ray are called by what of them has been read so far, and by how many are searched
//! together:
//!
//! | leaves | |
//! |---|---|
//! | `BlockLeaf`, `Target`, `Opened` | of packets: only its box, with its piece, and with numbers that a search needs |
//! | `Fitted` | with its weight, for the search in f32 |
//! | `TrueLeaf`, `NetLeaf` | with its net, for f64: of packets, and of single rays |
//! | `OneLeaf`, `EightLeaves` | for some rays in f64: of packets one leaf, of streams one each |
//! | `PlacedLeaf` | for the scalar search |
//!
//! | rays | |
//! |---|---|
//! | `SingleRay`, `Flight` | a ray traced by itself, and one of a stream |
//! | `BoxRay` | a ray in f32, for boxes |
//! | `LaneRays`, `ScaledRays` | those of a packet, in f64 and in f32 |
//! | `EightRays`, `ScaledSixteen` | some of these, in lanes |
//!
//! # Where things are
//! The ways share, in reading order:
//!
//! | | |
//! |---|---|
//! | `view`, `wanted` | what is searched, and how far along a ray |
//! | `reach`, `hit_place` | how far leaves reach, and where a hit is |
//! | `vectors`, `frames`, `lane_rays` | vectors in lanes, and rays in lanes |
//! | `box_ray` | one ray against sixteen boxes |
//! | `surface` | the true surface in lanes, in f64 |
//! | `search` | starts in f32, Newton's iteration in f64, and when both end |
//! | `proof` | what is proved, and the rounding errors allowed for |
//! | `start` | the root that a ray leaves, and the leaves that need not be searched because of it |
//! | `nearest`, `trimmed` | which of two hits counts, and what the trims decide |
//!
//! The steps of each way, and the files in its folder that take them:
//!
//! | | `packet` | `single` | `stream` |
//! |---|---|---|---|
//! | rays | `read_ahead`, `outline`, `load`, `rays` | `ray` | `traverse` |
//! | the tree | `traverse`, `shared_bounds`, `apart` | `traverse` | `traverse` |
//! | a leaf: box, certificate | `leaf`, `box_passage` | `traverse` | `traverse` |
//! | its start in f32 | `leaf` by `search::distances`, `screening` | by `search::one_ray` | `pairs` |
//! | a proof of its own | `doubts`, by `proof::lanes` | by `proof::one_ray` | by either |
//! | the end in f64 | `target`, `finish` | `jet`, `finish` | `finish` |

mod box_ray;
mod frames;
mod hit_place;
mod lane_rays;
mod nearest;
mod packet;
mod proof;
mod reach;
mod search;
mod single;
mod start;
mod stream;
mod surface;
#[cfg(test)]
pub(super) mod testing;
mod trimmed;
mod vectors;
mod view;
mod wanted;

pub(super) use box_ray::{BLUR, BOX_SPARE};
pub(super) use frames::NEAR;
pub(super) use hit_place::HitPlace;
pub(super) use packet::hits::LaneHit;
pub(super) use packet::rays::Packet;
pub(super) use packet::read_ahead::{Ahead, Moment, ReadAhead};
pub(super) use packet::traverse::trace_packet;
pub(super) use packet::work::PacketWork;
pub(super) use single::ray::{SingleHit, SingleRay};
pub(super) use single::traverse::{SingleWork, trace_single};
pub(super) use stream::traverse::{FLIGHTS, Stream, trace_stream};
pub(super) use view::BvhView;

/// Rays in a packet: a square of 8 × 8 pixels.
pub(super) const PACKET: usize = 64;
