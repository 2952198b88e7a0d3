//! Pieces are halved into parts, and cut down to what trims keep.
//!
//! A `part` is a rectangle of a piece; its `bend` says whether it must be halved, and what that is
//! worth. `tiles` keep the parts of neighbouring pieces together.

mod bend;
pub(super) mod part;
pub(super) mod tiles;
