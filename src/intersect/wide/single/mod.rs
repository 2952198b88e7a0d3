//! Single rays: sixteen boxes at a time.
//!
//! In reading order: a `ray` is prepared. `traverse` takes it through the tree down to blocks of
//! sixteen leaves. There the lanes hold the coefficients of the one leaf that is searched: `search`
//! finds a start in f32, and `finish` ends in f64 on the true surface (`jet`).

mod finish;
mod jet;
pub(super) mod ray;
pub(super) mod search;
pub(super) mod traverse;
