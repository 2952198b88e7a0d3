//! Hits against closed forms: where they are, and the normals there.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests, and the functions they share"
)]

mod closed;
mod double;
mod forms;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/model.rs"]
mod model;
mod octants;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/patches.rs"]
mod patches;
mod polynomial;
#[allow(dead_code, reason = "tests/robust uses the rest of it")]
#[path = "../common/random.rs"]
mod random;
#[path = "../common/rays.rs"]
mod rays;
mod truth;
