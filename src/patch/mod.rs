//! Everything becomes Bézier pieces, and pieces become leaves.
//!
//! A surface is clamped and its knots are inserted to full multiplicity; what lies between
//! two neighbouring knots of each direction is then a [`TensorPatch`], a rational Bézier
//! piece, and neighbours share their edge's control points bit for bit. A [`Piece`] is such
//! a patch with its place: which surface, which rectangle of its knot domain, which sides
//! are borders, which are collapsed to a point.
//!
//! A [`Leaf`] is a part of a piece, halved until it is flat. It holds bounds ([`Aabb`] and
//! [`OrientedBox`]) proved to hold all its points, and a [`Certificate`]: the proof, made
//! once, that every ray steep enough to its mean normal meets it at most once. Leaves are
//! for searching only. Points are always computed on the whole piece, in one order of
//! operations, so that neighbouring leaves agree on their common line.
//!
//! [`Aabb`]: crate::math::Aabb

mod leaf;
mod oriented_box;
mod piece;
mod set;
mod tangents;
mod tensor;

use glam::DVec4;
use smallvec::SmallVec;

/// The homogeneous control points of a part of a piece: those of a bicubic lie in place.
type ControlNet = SmallVec<[DVec4; 16]>;

pub use leaf::{LEAF_SLACK, Leaf, WIDENING};
pub use oriented_box::{OrientedBox, Passage};
pub use piece::Piece;
pub use set::{PatchSet, PatchSetError};
pub use tangents::{Certificate, CollapsedSide, Pole};
pub use tensor::{Jet, TensorPatch};
