//! Hits against closed forms: where they are, and the normals there.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    dead_code,
    reason = "tests, and the functions they share, of which each uses some"
)]

#[path = "analytic/closed.rs"]
mod closed;
#[path = "analytic/double.rs"]
mod double;
#[path = "analytic/forms.rs"]
mod forms;
#[path = "common/model.rs"]
mod model;
#[path = "analytic/octants.rs"]
mod octants;
#[path = "common/patches.rs"]
mod patches;
#[path = "analytic/polynomial.rs"]
mod polynomial;
#[path = "common/random.rs"]
mod random;
#[path = "common/rays.rs"]
mod rays;
#[path = "analytic/truth.rs"]
mod truth;
