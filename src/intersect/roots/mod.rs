//! Which roots count as hits.
//!
//! A `question` is what a ray asks of each `placed_leaf` it may meet. Each solution that a search
//! finds there is a `spot` on the surface; `accept` makes of it a `meeting`, a doubt, or nothing.
//! `borders` says which roots lie within the borders of their surface, `trim_side` on which side
//! of its trims, `start` which are the root that the ray leaves, and `reach` how far off roots may
//! be. Three cases are harder: `grazing` judges roots that may be far off along the ray,
//! `kept_pole` those at a pole that trims have cut into, and `pole_side` those beside poles and at
//! corners where tangents vanish. `around` says which edges lead away from a place.

pub(super) mod accept;
pub(super) mod around;
pub(super) mod borders;
mod grazing;
mod kept_pole;
pub(super) mod meeting;
pub(super) mod placed_leaf;
mod pole_side;
pub(super) mod question;
pub(super) mod reach;
pub(super) mod spot;
mod start;
mod trim_side;
