//! An independent truth: the same rays by SISL and by OpenCASCADE, and who is right where
//! they differ.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests, and the functions they share"
)]

mod compare;
#[path = "../common/judge.rs"]
mod judge;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/model.rs"]
mod model;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/models.rs"]
mod models;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/patches.rs"]
mod patches;
mod program;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/random.rs"]
mod random;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/rays.rs"]
mod rays;
mod root;
mod same_rays;
