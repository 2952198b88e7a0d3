//! Everything becomes Bézier pieces, and pieces become leaves.
//!
//! A surface is clamped and its knots are inserted to full multiplicity. Each rectangle between
//! neighbouring knots is then a [`TensorPatch`], a rational Bézier piece, and neighbouring pieces
//! share the control points of their common edge bit for bit. The Bézier points of dense surfaces
//! are not kept, but computed from the surface's own control points when needed. A [`Piece`] is
//! such a patch with its place: which surface, which rectangle of its knot domain, which sides are
//! borders, and which are collapsed to a point.
//!
//! A piece is halved until it is flat, which gives parts (`part`); where trims cut something off,
//! parts are cut down to what is kept, and `trim_windows` say what hits are compared with. The
//! parts of neighbouring pieces of dense surfaces are kept together (`tiles`), so that blocks of
//! the tree are full. A [`Leaf`] is what is kept of a part to search it: an approximation (`fit`)
//! and a certificate, which is the proof, made once, that every ray steep enough to the leaf's mean
//! normal meets it at most once. Bounds ([`Aabb`] and oriented boxes) are proved to hold all points
//! of the leaf. Leaves are for searching only. Points are always computed on the whole piece, in
//! one order of operations, so that neighbouring leaves agree on their common line: by Bernstein
//! functions, or, where speed counts, in power form (`powers`).
//!
//! [`Aabb`]: crate::math::Aabb

mod apexes;
mod bend;
mod bicubic;
mod certificate;
mod chart_net;
mod collapsed_side;
mod field;
mod fit;
mod fit_error;
mod frame;
mod grid;
mod keeping;
mod leaf;
mod leaves;
mod oriented_box;
mod part;
mod piece;
mod piece_net;
mod pole_normal;
mod power_nets;
mod powers;
mod rect;
mod rounded;
mod set;
mod slack;
mod spline_net;
mod tangent_pairs;
mod tangents;
mod tensor;
mod tiles;
mod trim_windows;

use glam::DVec4;
use smallvec::SmallVec;

/// The homogeneous control points of a part of a piece; those of a bicubic are stored inline.
type BezierNet = SmallVec<[DVec4; 16]>;

/// Returns a copy of a net with `change` applied to each point. The net is copied at once and
/// changed in place: collecting an iterator would push points one by one, each after a check of the
/// room left.
#[inline(always)]
fn mapped(net: &[DVec4], change: impl Fn(DVec4) -> DVec4) -> BezierNet {
    let mut mapped = BezierNet::from_slice(net);
    for point in &mut mapped {
        *point = change(*point);
    }
    mapped
}

pub(crate) use bicubic::WeightFit;
pub(crate) use certificate::{CLEAR, Certificate, SURELY};
pub use collapsed_side::CollapsedSide;
pub(crate) use fit::MOST_WEIGHT;
pub(crate) use fit_error::{FIT_DOMAIN, FitError};
pub(crate) use frame::PADDING;
pub(crate) use frame::{ScaledBox, ScaledFrame};
pub use leaf::Leaf;
pub(crate) use oriented_box::{OrientedBox, Passage};
pub(crate) use part::Part;
pub(crate) use piece::BESIDE_COLLAPSED;
pub use piece::Piece;
pub(crate) use piece_net::PieceNet;
pub(crate) use powers::{MOST_DEGREE as MOST_DEGREE_BY_POWERS, ToPowers};
pub use rect::StRect;
pub(crate) use rect::{DyadicRect, holds};
pub(crate) use set::SetId;
pub use set::{BuildError, PatchSet};
pub(crate) use slack::{BORDER_REACH, LEAF_SLACK, WIDENING};
pub(crate) use spline_net::{LONGEST, LONGEST_OF_CUBIC, NetRoom, NetSource, SplineNet};
pub use tensor::{Jet, TensorPatch};
pub(crate) use tiles::GroupedParts;
pub(crate) use tiles::MOST_TOGETHER;
pub(crate) use trim_windows::TrimWindows;
