//! The readable specification: what a ray meets, one ray and one leaf at a time.
//!
//! In reading order: `traverse` finds the leaves whose boxes the ray meets. `leaf_search` searches
//! one leaf: by `newton` where the leaf's certificate holds for the ray, else, unless the ray
//! passes the leaf's `hull`, by the [`exact`](super::exact) solver. Of the solutions, those that
//! count ([`roots`](super::roots)) become `findings`. The fast kernels leave to this search what
//! they cannot decide.

pub(super) mod findings;
mod hull;
pub(super) mod leaf_search;
mod newton;
mod traverse;
