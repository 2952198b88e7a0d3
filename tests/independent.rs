//! An independent truth: the same rays by SISL and by OpenCASCADE, and who is right where
//! they differ.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    dead_code,
    reason = "tests, and the functions they share, of which each uses some"
)]

#[path = "independent/compare.rs"]
mod compare;
#[path = "robust/judge.rs"]
mod judge;
#[path = "common/model.rs"]
mod model;
#[path = "robust/models.rs"]
mod models;
#[path = "common/patches.rs"]
mod patches;
#[path = "independent/program.rs"]
mod program;
#[path = "common/random.rs"]
mod random;
#[path = "common/rays.rs"]
mod rays;
#[path = "independent/root.rs"]
mod root;
#[path = "independent/same_rays.rs"]
mod same_rays;
