//! The readable specification: what a ray meets, one ray and one leaf at a time.
//!
//! In reading order: `traverse` finds the leaves whose boxes the ray meets. `meeting` holds the
//! question that the ray puts to them, and what is found. `leaf_search` searches one leaf: by
//! `newton` where the leaf's certificate holds for the ray, else, unless the ray passes the leaf's
//! `hull`, by the [`exact`](super::exact) solver. `accept` makes of each solution a meeting, a
//! doubt, or nothing. The fast kernels leave to this search what they cannot decide.

pub(super) mod accept;
mod hull;
pub(super) mod leaf_search;
pub(super) mod meeting;
pub(super) mod newton;
mod traverse;
