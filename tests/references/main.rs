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

mod binding;
mod convergence;
mod images;
mod loaded;
mod models;
mod picture;
