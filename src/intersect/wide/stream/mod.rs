//! Streams: many rays that have nothing in common.
//!
//! In reading order: `traverse` takes each ray (`flight`) through the boxes by itself, as a
//! [single](super::single) one, as far as the next leaf. Then sixteen pairs of a ray and a leaf are
//! searched side by side: in f32 (`pairs`), and in f64 (`finish`), in the steps of the packets.

mod finish;
mod flight;
mod pairs;
pub(super) mod traverse;
