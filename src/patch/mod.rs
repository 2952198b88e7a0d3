//! Everything becomes Bézier pieces, and pieces become leaves.
//!
//! A surface is clamped and its knots are inserted to full multiplicity; what lies between
//! two neighbouring knots of each direction is then a [`TensorPatch`], a rational Bézier
//! piece, and neighbours share their edge's control points bit for bit. Of dense surfaces the Bézier
//! points are not kept, but made of the surface's own where they are wanted. A [`Piece`] is such
//! a patch with its place: which surface, which rectangle of its knot domain, which sides
//! are borders, which are collapsed to a point.
//!
//! A piece is halved until it is flat: that gives parts (`part`). Of dense surfaces those of neighbouring pieces are to
//! be kept together (`tiles`), so that blocks of the tree are full. A [`Leaf`] is what is kept of a part
//! to search it: an approximation (`fit`), and a certificate: the proof, made once, that every ray steep enough to its
//! mean normal meets it at most once. Bounds ([`Aabb`] and oriented boxes) are proved to hold all its points.
//! Leaves are for searching only. Points are always computed on the whole piece, in one order of operations, so
//! that neighbouring leaves agree on their common line: by Bernstein functions, or, where speed counts, by powers
//! (`powers`).
//!
//! [`Aabb`]: crate::math::Aabb

mod bend;
mod certificate;
mod chart_net;
mod collapsed_side;
mod field;
mod fit;
mod fit_error;
mod frame;
mod keeping;
mod leaf;
mod leaves;
mod oriented_box;
mod part;
mod piece;
mod piece_net;
mod pole_normal;
mod powers;
mod rect;
mod rounded;
mod set;
mod tangent_pairs;
mod tangents;
mod tensor;
mod tiles;
mod tips;

use glam::DVec4;
use smallvec::SmallVec;

/// The homogeneous control points of a part of a piece: those of a bicubic lie in place.
type BezierNet = SmallVec<[DVec4; 16]>;

/// A net made of another point by point. Copied at once and changed in place: collected from an
/// iterator, points would come one by one, each after a look at the room that is left.
#[inline(always)]
fn mapped(net: &[DVec4], change: impl Fn(DVec4) -> DVec4) -> BezierNet {
    let mut mapped = BezierNet::from_slice(net);
    for point in &mut mapped {
        *point = change(*point);
    }
    mapped
}

pub(crate) use certificate::Certificate;
pub use collapsed_side::CollapsedSide;
pub(crate) use fit::{MOST_WEIGHT, WeightFit};
pub(crate) use fit_error::{FIT_DOMAIN, FitError};
pub(crate) use frame::PADDING;
pub(crate) use frame::{ScaledBox, SceneFrame};
pub use leaf::Leaf;
pub(crate) use leaf::{LEAF_SLACK, WIDENING};
pub(crate) use oriented_box::{OrientedBox, Passage};
pub(crate) use part::Part;
pub(crate) use piece::BESIDE_COLLAPSED;
pub use piece::Piece;
pub(crate) use piece_net::{LONGEST, LONGEST_OF_CUBIC, NetRoom, NetSource, PieceNet, SplineNet};
pub(crate) use powers::{MOST_DEGREE as MOST_DEGREE_BY_POWERS, ToPowers};
pub use rect::DyadicRect;
pub use set::{PatchSet, PatchSetError};
pub use tensor::{Jet, TensorPatch};
pub(crate) use tiles::GroupedParts;
pub(crate) use tiles::MOST_TOGETHER;
