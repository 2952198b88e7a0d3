//! Shared by the proofs about one ray and a leaf: parts of leaves, and rounding errors.

use crate::intersect::wide::reach::WITH_SLACK_F32;
use crate::patch::LEAF_SLACK;

/// Rounding error in f32 of distances whose terms add up to one: 33 units of 2⁻²⁴. A coefficient
/// takes 6 roundings (the middle's distance, a normal, three products added up), the change to a
/// smaller box 6 in each direction (5 where products are added in one rounding), the combination of
/// two distances 3, and Bernstein coefficients 4 in each direction: 29 in all. Derivatives may take
/// twice as many: a term of third degree counts threefold there, but only part of the roundings
/// above occur.
pub(crate) const DISTANCE_ROUNDING: f32 = 2e-6;

/// Below this, f32 loses digits: products of two lengths of a tiny scene may lie there.
pub(super) const UNDERFLOW: f32 = f32::MIN_POSITIVE;

/// Above this, nothing is proved: sums of products of two lengths of a huge scene would overflow
/// f32, and their differences would be NaN.
pub(crate) const LARGEST: f32 = 1e18;

/// Whether a leaf of these half sides shows despite rounding; false for NaN. If not, the errors of
/// its tangents, twice the `noise` of its distances, are as long as its shorter tangents, and so in
/// each of its parts, as both shrink alike. Then no part of it is proved to hold one root only,
/// however small, and few to hold none: its box is not much thicker than the noise, and the ray met
/// that. (In a few leaves, whose tangents are longer elsewhere than in the middle, something might
/// have been proved.)
#[inline(always)]
pub(super) fn shows(noise: f32, [x, y]: [f32; 2]) -> bool {
    noise < x.min(y)
}

/// Roots are unique in a box widened by this factor, so that one on its side is not lost.
pub(crate) const GROWN: f32 = 1.1;

/// How far Newton's step from the middle of a box may lead, in its half sides, if the box is to
/// hold a root.
pub(super) const MAY_STEP: f32 = 1.05;

/// Boxes smaller than this, in half sides of the leaf, are not halved merely because such a step
/// leads away.
pub(super) const SMALLEST: f32 = 0.1;

/// The box in which a ray's start is looked for is widened by this factor: by less than [`GROWN`].
pub(crate) const START_GROWN: f32 = 1.09;

/// The largest accepted row sum of `P`: rounding moves a root by no more than the rounding error
/// times twenty and the inverse Jacobian.
pub(super) const MOST_INVERSE: f32 = 20.0;

/// The largest accepted product of error and inverse Jacobian: times twenty, half of the leaf's
/// slack, in half sides.
pub(super) const MOST_NOISE: f32 = LEAF_SLACK as f32 / 20.0;

/// A part of a leaf, in its box coordinates.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct LeafPart {
    pub middle: [f32; 2],
    pub(super) half: [f32; 2],
}

impl LeafPart {
    /// The leaf and its slack.
    pub(super) fn whole() -> Self {
        Self { middle: [0.0; 2], half: [WITH_SLACK_F32; 2] }
    }

    /// Its two halves, cut across the longer side, for the lengths of the leaf's sides.
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

    /// The rectangle in which the part's root is the only one.
    pub(crate) fn domain(&self) -> [[f32; 2]; 2] {
        [0, 1].map(|k| {
            let (middle, reach) = (self.middle[k], GROWN * self.half[k]);
            [middle - reach, middle + reach]
        })
    }
}
