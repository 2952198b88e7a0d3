//! How far leaves reach, in box coordinates: from −1 to 1 along the leaf's parameters.

use crate::patch::{LEAF_SLACK, WIDENING};

/// How far from its middle a leaf's certificate holds, in half sides.
pub(crate) const WIDENED: f64 = 1.0 + 2.0 * WIDENING;

/// [`WIDENED`] for what is decided in f32, and narrower than that by 2e-5 half sides: far more than
/// the rounding of places, which is a few units of 6e-8.
pub(crate) const WIDENED_F32: f32 = 1.0 + 1.999 * WIDENING as f32;

/// How far from a leaf's middle roots count as the leaf's, in half sides: in its rectangle and its
/// slack.
pub(crate) const WITH_SLACK: f64 = 1.0 + 2.0 * LEAF_SLACK;

/// [`WITH_SLACK`] for proofs in f32, and wider than that by a twentieth of the slack, 1e-4 half
/// sides: so that a root on the rim of the slack is not lost to the rounding of places in f32,
/// which is a few units of 6e-8.
pub(crate) const WITH_SLACK_F32: f32 = 1.0 + 2.1 * LEAF_SLACK as f32;
