//! Other programs that find the same hits: Embree, on tessellations of rising resolution.
//!
//! A missing Embree fails these tests, with a hint how to install it. Where it cannot be had,
//! `NURBRAY_WITHOUT_EMBREE=1` leaves them out; they then say so loudly.
#![cfg(feature = "embree")]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests, and the functions they share"
)]

#[path = "references/binding.rs"]
mod binding;
#[path = "references/convergence.rs"]
mod convergence;
#[path = "references/images.rs"]
mod images;
#[path = "references/loaded.rs"]
mod loaded;
#[path = "references/models.rs"]
mod models;
#[path = "references/picture.rs"]
mod picture;
