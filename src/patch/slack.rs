//! How far leaves reach beyond what they cover, and borders beyond where they are.

/// A leaf answers for roots a little outside its rectangle, by this part of its side, so
/// that a root on the line between two leaves is not lost to rounding in both.
pub(crate) const LEAF_SLACK: f64 = 1e-3;

/// A hit is at a border if it is within this many errors of it: 1.5 for a ray that passes the border
/// at half an error and a root that is off by one, and as much again and more because distances
/// taken from parameters only approximate those in space. (Fast kernels check the hits within twice
/// as much, see [`Leaf::near_border`](super::Leaf::near_border).)
pub(crate) const BORDER_REACH: f64 = 4.0;

/// A leaf's certificate holds on its rectangle widened by this part of its sides: Newton's steps
/// may stray there. With a wider rectangle, it would hold for fewer rays.
pub(crate) const WIDENING: f64 = 0.02;
