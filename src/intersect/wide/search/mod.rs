//! The search for roots.
//!
//! `distances` finds starts in f32, on the approximations of leaves, for sixteen rays side by side;
//! `one_ray` does so for one. From there, `newton` goes on in f64, on the true surface, lane by
//! lane. `convergence` says when all of them end.

pub(super) mod convergence;
pub(super) mod distances;
pub(super) mod newton;
pub(super) mod one_ray;
