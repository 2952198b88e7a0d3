//! Single rays: sixteen boxes at a time.
//!
//! In reading order: a `ray` is prepared. `traverse` takes it through the tree down to blocks of
//! sixteen leaves. There the lanes hold the coefficients of the one leaf that is searched: a start
//! is found in f32 ([`one_ray`](super::search::one_ray)), and `finish` ends in f64 on the true
//! surface (`jet`).

mod finish;
mod jet;
pub(super) mod ray;
pub(super) mod traverse;
