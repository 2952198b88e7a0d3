//! Rays that are hard to answer: no unflagged miss, no wrong root, no false hit.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    dead_code,
    reason = "tests, and the functions they share, of which each uses some"
)]

#[path = "robust/bodies.rs"]
mod bodies;
#[path = "robust/corners.rs"]
mod corners;
#[path = "robust/far.rs"]
mod far;
#[path = "robust/halving.rs"]
mod halving;
#[path = "robust/hard.rs"]
mod hard;
#[path = "robust/inside.rs"]
mod inside;
#[path = "robust/judge.rs"]
mod judge;
#[path = "robust/leaving.rs"]
mod leaving;
#[path = "common/model.rs"]
mod model;
#[path = "robust/models.rs"]
mod models;
#[path = "robust/near.rs"]
mod near;
#[path = "robust/parity.rs"]
mod parity;
#[path = "common/patches.rs"]
mod patches;
#[path = "common/random.rs"]
mod random;
#[path = "robust/ranges.rs"]
mod ranges;
#[path = "common/rays.rs"]
mod rays;
#[path = "robust/same.rs"]
mod same;
#[path = "robust/survey.rs"]
mod survey;
#[path = "robust/traps.rs"]
mod traps;
#[path = "robust/uneven.rs"]
mod uneven;
#[path = "robust/ways.rs"]
mod ways;
