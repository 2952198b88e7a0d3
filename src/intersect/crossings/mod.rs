//! Which roots count as hits, and which of them are one crossing.
//!
//! Does a root count? `borders` says which roots lie within the borders of their surface and the
//! edges of its trims. Two cases are harder: `grazing` judges roots that may be far off along the
//! ray, `kept_pole` those at a pole that trims have cut into.
//!
//! Which are one? `merge` joins the meetings of a ray that are one crossing. They must be at the
//! `same_place`; at `vertices`, the sum of the angles that the `faces` cover around the ray says
//! which way it goes through.

pub(super) mod borders;
mod faces;
pub(super) mod grazing;
pub(super) mod kept_pole;
pub(super) mod merge;
mod same_place;
mod vertices;
