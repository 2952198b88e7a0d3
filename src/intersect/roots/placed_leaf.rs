//! A leaf and what belongs to it.

use crate::math::RayFrame;
use crate::patch::{Leaf, OrientedBox, Passage, Piece, ScaledFrame};

/// A leaf, with its box and its piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct PlacedLeaf<'a> {
    pub leaf: &'a Leaf,
    pub oriented: &'a OrientedBox,
    pub piece: &'a Piece,
}

impl PlacedLeaf<'_> {
    /// The ray's passage through the leaf's box, if the ray may meet the leaf, to within rounding,
    /// between the start of its range and `limit`, both in scene units along the ray.
    pub(crate) fn passage(
        &self,
        ray: &RayFrame,
        scaled: &ScaledFrame,
        limit: f64,
    ) -> Option<Passage> {
        let slack = self.piece.patch.error_bound(ray.magnitude);
        let passage = self.oriented.passage(ray, scaled, slack)?;
        let apart = passage.entry > limit + slack || passage.exit < ray.z_range[0] - slack;
        (!apart).then_some(passage)
    }
}
