//! The true surface in lanes, in f64.
//!
//! `jets` evaluates it at eight places at a time: by `power_sums` where the piece is well
//! conditioned, as its `form` says, else by Bernstein functions. The places are on one piece or on
//! eight, whose nets `lane_net` has side by side. Nets that are not kept are made in `lane_net` or,
//! from a B-spline's control points, in `spline_net`, both by `power_lines`.

pub(super) mod form;
pub(super) mod jets;
pub(super) mod lane_net;
pub(super) mod power_lines;
mod power_sums;
pub(super) mod spline_net;
pub(super) mod sums;
