//! Everything becomes Bézier pieces, and pieces become leaves.

mod leaf;
mod oriented_box;
mod piece;
mod set;
mod tangents;
mod tensor;

pub use leaf::{LEAF_SLACK, Leaf, WIDENING};
pub use oriented_box::{OrientedBox, Passage};
pub use piece::Piece;
pub use set::{PatchSet, PatchSetError};
pub use tangents::{Certificate, CollapsedSide, Pole};
pub use tensor::{Jet, TensorPatch};
