//! From what is written to surfaces in their places: shapes and constructions are made, the nets,
//! edges and lines of other objects drawn, trims cut, and each object's transform is applied. What
//! is written is known here, and the errors; the world and the plots, both of which show these
//! surfaces, are not.

mod drawn;
#[cfg(test)]
mod drawn_tests;
mod made;
mod placing;
mod trims;
mod workshop;

pub(in crate::scene) use made::Made;
pub(in crate::scene) use placing::Placer;
pub(in crate::scene) use trims::{loop_curve, trim_curve_error};
