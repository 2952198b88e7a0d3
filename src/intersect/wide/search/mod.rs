//! The search for roots, side by side in lanes.
//!
//! `distances` finds starts in f32, on the approximations of leaves. From there, `newton` goes on
//! in f64, on the true surface. `convergence` says when both end, for single rays, too.

pub(super) mod convergence;
pub(super) mod distances;
pub(super) mod newton;
