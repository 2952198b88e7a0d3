//! The corners of Coons patches.

use std::fmt;

/// A corner of a Coons patch: which ends of `u` and `v`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CoonsCorner {
    pub(super) u: u8,
    pub(super) v: u8,
}

impl fmt::Display for CoonsCorner {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { u, v } = self;
        write!(f, "the corner of borders u{u} and v{v}")
    }
}
