//! What the proofs about one ray and a leaf share: how far leaves reach, their parts, and what rounding leaves.

use crate::patch::{LEAF_SLACK, WIDENING};

/// How far certificates speak of a leaf, in half sides.
pub(super) const WIDENED: f64 = 1.0 + 2.0 * WIDENING;

/// How far outside a leaf's rectangle roots are its own, in half sides.
pub(super) const WITH_SLACK: f64 = 1.0 + 2.0 * LEAF_SLACK;

/// What rounding to f32 does to distances whose terms add up to one: 33 units of 2⁻²⁴. To a
/// coefficient happen 6 (the middle's distance, a normal, three products added up), on the way
/// into a smaller box 5 in each direction, in combining two distances 3, in Bernstein
/// coefficients 4 in each direction: 27 in all. To derivatives twice as much may happen: a term of
/// third degree counts threefold there, but only part of what is above.
pub(super) const DISTANCE_ROUNDING: f32 = 2e-6;

/// Below it f32 loses digits: products of two lengths of a tiny scene may lie there.
pub(super) const UNDERFLOW: f32 = f32::MIN_POSITIVE;

/// Above it nothing is proved: sums of products of two lengths of a huge scene would not be
/// numbers of f32, and their differences no numbers at all.
pub(super) const LARGEST: f32 = 1e18;

/// How far the leaf and its slack reach.
pub(super) const LEAF: f32 = 1.0 + 2.1 * LEAF_SLACK as f32;

/// Roots are unique in a box widened by this: so that one on its side is not lost.
pub(super) const GROWN: f32 = 1.1;

/// Where Newton's step from the middle of a box may lead that is to hold a root.
pub(super) const MAY_STEP: f32 = 1.05;

/// Boxes are not halved for that alone if they are smaller, in half sides of the leaf.
pub(super) const SMALLEST: f32 = 0.1;

/// A box a root starts in is widened by less.
pub(super) const START_GROWN: f32 = 1.09;

/// The largest row sum that is wanted of `P`: so that rounding moves a root by no more than its error
/// times twenty and the inverse Jacobian.
pub(super) const MOST_INVERSE: f32 = 20.0;

/// That times twenty is half of the leaf's slack, in half sides.
pub(super) const MOST_NOISE: f32 = LEAF_SLACK as f32 / 20.0;

/// A part of a leaf, in its box coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct LeafPart {
    pub(super) middle: [f32; 2],
    pub(super) half: [f32; 2],
}

impl LeafPart {
    /// The leaf and its slack.
    pub(super) fn whole() -> Self {
        Self { middle: [0.0; 2], half: [LEAF; 2] }
    }

    /// Halved across the longer side, for the lengths of the leaf's sides.
    pub(super) fn halved(&self, lengths: [f32; 2]) -> [Self; 2] {
        let k = usize::from(lengths[1] * self.half[1] > lengths[0] * self.half[0]);
        [-0.5, 0.5].map(|side| {
            let mut half = *self;
            half.half[k] *= 0.5;
            half.middle[k] += side * self.half[k];
            half
        })
    }

    pub(super) fn holds(&self, place: [f32; 2], reach: f32) -> bool {
        (0..2).all(|k| (place[k] - self.middle[k]).abs() <= reach * self.half[k])
    }

    /// Where its root is the only one.
    pub(super) fn domain(&self) -> [[f32; 2]; 2] {
        [0, 1].map(|k| {
            let (middle, reach) = (self.middle[k], GROWN * self.half[k]);
            [middle - reach, middle + reach]
        })
    }
}
