//! Which hits are one crossing.
//!
//! `merge` joins the meetings of a ray that are one crossing. They must be at the `same_place` and,
//! as far as `sense` knows, go through the surface the same way; at `vertices`, the sum of the
//! angles that the `faces` cover around the ray says which way it goes through. At last the
//! `balance` of each place is checked: whether what is reported there is what the faces cover.

mod balance;
mod faces;
pub(super) mod merge;
mod same_place;
mod sense;
mod vertices;

pub(super) use same_place::APART;
