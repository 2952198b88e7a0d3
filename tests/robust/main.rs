//! Rays that are hard to answer: no unflagged miss, no wrong root, no false hit.
//!
//! Uses all of `tests/common`, so that the compiler finds here what nobody uses there.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests, and the functions they share"
)]

mod beside;
mod bodies;
mod corners;
mod creases;
mod edges;
mod far;
mod from_afar;
mod halving;
mod hard;
mod inside;
#[path = "../common/judge.rs"]
mod judge;
mod leaving;
#[path = "../common/model.rs"]
mod model;
#[path = "../common/models.rs"]
mod models;
mod near;
mod parity;
#[path = "../common/patches.rs"]
mod patches;
#[path = "../common/random.rs"]
mod random;
mod ranges;
#[path = "../common/rays.rs"]
mod rays;
mod same;
mod survey;
mod tips;
mod traps;
mod uneven;
mod ways;
