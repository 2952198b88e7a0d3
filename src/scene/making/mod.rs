//! From what is written to surfaces in their places: shapes and constructions are made, other
//! objects' nets and lines are drawn, trims are cut, and each object's transform is applied. This
//! knows what is written and why it may fail; the world and the plots, which both are made of
//! these surfaces, are not known here.

mod drawn;
#[cfg(test)]
mod drawn_tests;
mod made;
mod placing;
mod trims;
mod workshop;

pub(in crate::scene) use made::Made;
pub(in crate::scene) use placing::Placer;
