//! How far leaves reach, in box coordinates: from −1 to 1 along the leaf's parameters.

use crate::patch::{LEAF_SLACK, WIDENING};

/// How far from its middle a leaf's certificate holds, in half sides.
pub(crate) const WIDENED: f64 = 1.0 + 2.0 * WIDENING;

/// How far from a leaf's middle roots count as the leaf's, in half sides: in its rectangle and its
/// slack.
pub(crate) const WITH_SLACK: f64 = 1.0 + 2.0 * LEAF_SLACK;

/// How far from its middle a leaf and its slack reach, in half sides.
pub(crate) const LEAF: f32 = 1.0 + 2.1 * LEAF_SLACK as f32;
