//! Which roots count as hits.
//!
//! A `question` is what a ray asks of the leaves it may meet. Each solution that a search finds on
//! a leaf is a `spot` on the surface; `accept` makes of it a `meeting`, a doubt, or nothing.
//! `borders` says which roots lie within the borders of their surface, `trim_side` on which side
//! of its trims. Three cases are harder: `grazing` judges roots that may be far off along the ray,
//! `kept_pole` those at a pole that trims have cut into, and `pole_side` those beside poles and at
//! corners where tangents vanish.

pub(super) mod accept;
pub(super) mod borders;
mod grazing;
mod kept_pole;
pub(super) mod meeting;
mod pole_side;
pub(super) mod question;
pub(super) mod spot;
mod trim_side;
