//! Everything becomes Bézier pieces, and pieces become leaves.
//!
//! *Pieces* (`pieces`). A surface is clamped and its knots are inserted to full multiplicity. Each
//! rectangle between neighbouring knots is then a [`TensorPatch`], a rational Bézier piece, and
//! neighbouring pieces share the control points of their common edge bit for bit. The Bézier points
//! of dense surfaces are not kept, but computed from the surface's own control points when needed.
//! A [`Piece`] is such a patch with its place: which surface, which rectangle of its knot domain,
//! which sides are borders, and which are collapsed to a point. Points are always computed on the
//! whole piece, in one order of operations, so that neighbouring leaves agree on their common line:
//! by Bernstein functions, or, where speed counts, in power form (`powers`).
//!
//! *Parts* (`parts`). A piece is halved until it is flat; where trims cut something off, parts are
//! cut down to what is kept. The parts of neighbouring pieces of dense surfaces are kept together
//! (`tiles`), so that blocks of the tree are full.
//!
//! *Leaves*. `leaves` chooses the parts of a scene that become leaves. A [`Leaf`] (`leaf`) is what
//! is kept of a part to search it, and only for that: an approximation (`fit`), bounds ([`Aabb`]
//! and `oriented_box`) that are proved to hold all points of the leaf, what hits are compared with
//! where trims pass (`trim_windows`), and a `certificate`: the proof, made once, that every ray
//! steep enough to the leaf's mean normal meets it at most once.
//!
//! A `PatchSet` (`set`) holds the pieces of all surfaces of a scene.
//!
//! [`Aabb`]: crate::math::Aabb

mod certificate;
mod frame;
mod leaf;
mod leaves;
mod oriented_box;
mod parts;
mod pieces;
mod set;
mod slack;

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

pub(crate) use certificate::{CLEAR_OF_ERROR, Certificate, SURELY};
pub(crate) use frame::PADDING;
pub(crate) use frame::{ScaledBox, ScaledFrame};
pub use leaf::Leaf;
pub(crate) use leaf::bicubic::WeightFit;
pub(crate) use leaf::fit::MOST_WEIGHT;
pub(crate) use leaf::fit_error::{FIT_DOMAIN, FitError};
pub(crate) use leaf::trim_windows::TrimWindows;
pub(crate) use oriented_box::{OrientedBox, Passage};
pub(crate) use parts::part::Part;
pub(crate) use parts::tiles::{GroupedParts, MOST_TOGETHER};
pub(crate) use pieces::piece::BESIDE_COLLAPSED;
pub use pieces::piece::Piece;
pub(crate) use pieces::piece_net::PieceNet;
pub(crate) use pieces::powers::{MOST_DEGREE as MOST_DEGREE_BY_POWERS, ToPowers};
pub use pieces::rect::StRect;
pub(crate) use pieces::rect::{DyadicRect, holds};
pub(crate) use pieces::spline_net::{LONGEST, LONGEST_OF_CUBIC, NetRoom, NetSource, SplineNet};
pub use pieces::tensor::{Jet, TensorPatch};
pub(crate) use set::SetId;
pub use set::{BuildError, PatchSet};
pub(crate) use slack::{BORDER_REACH, LEAF_SLACK, WIDENING};
