//! Hits at a pole where trims have cut off some of the parameters that lead there.
//!
//! All parameters of a collapsed side are one point. That point is kept if any of them is kept. The
//! hit is given a kept parameter, so that its parameters, and the normal that goes with them,
//! belong to a part that is kept.

use super::spot::Spot;
use crate::geometry::RectSide;
use crate::math::RayFrame;
use crate::patch::{PatchSet, Piece};

impl<'a> Spot<'a> {
    /// The nearest place along a collapsed side that trims keep, perhaps on another piece that ends
    /// in the same pole; `None` if there is none, or if it is farther than `allowed` from the ray.
    pub(crate) fn kept(
        &self,
        set: &'a PatchSet,
        side: RectSide,
        (ray, allowed): (&RayFrame, f64),
    ) -> Option<Self> {
        let (fixed, along) = (side.fixed(), side.along());
        let trims = self.piece.trims()?;
        let own = self.piece.domain();
        let at = within(own[fixed], self.st[fixed]);
        let free = within(own[along], self.st[along]);
        let stretches = trims.kept_along(fixed, at);
        // A little inside the edge, if there is room: kept without doubt.
        let little = INSIDE * (own[along][1] - own[along][0]);
        let nearest = |stretch: [f64; 2]| nearest_inside(stretch, little, free);
        let near = |a: &f64, b: &f64| (a - free).abs().total_cmp(&(b - free).abs());
        let to = stretches.into_iter().map(nearest).min_by(near)?;

        let holds = |piece: &Piece| {
            let domain = piece.domain();
            domain[fixed] == own[fixed]
                && (domain[along][0]..=domain[along][1]).contains(&to)
                && piece.is_collapsed(side)
                && piece.trims().is_some_and(|theirs| std::ptr::eq(theirs, trims))
        };
        let (index, piece) = if holds(self.piece) {
            (self.index, self.piece)
        } else {
            let mut pieces = set.pieces_of(self.piece.surface as usize);
            let index = pieces.find(|&index| holds(&set.pieces()[index]))?;
            (index as u32, &set.pieces()[index])
        };
        let [start, end] = piece.domain()[along];
        let mut st = self.st;
        st[along] = ((to - start) / (end - start)).clamp(0.0, 1.0);
        let jet = piece.patch.jet(st);
        let residual = ray.distance(jet.point);
        (residual <= allowed).then_some(Self { index, piece, st, jet })
    }
}

/// How far inside a trim edge a freely chosen place is put, as a part of the piece: far above the
/// rounding of parameters, and far below what matters.
const INSIDE: f64 = 1e-9;

fn within([from, to]: [f64; 2], share: f64) -> f64 {
    if share == 1.0 { to } else { from + share * (to - from) }
}

/// The point of a stretch nearest to `place`, at least `little` inside its ends; the middle of too
/// short a stretch.
fn nearest_inside([from, to]: [f64; 2], little: f64, place: f64) -> f64 {
    let [first, last] = [from + little, to - little];
    if first < last { place.clamp(first, last) } else { 0.5 * (from + to) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_inside_of_stretches_of_any_length() {
        assert_eq!(nearest_inside([0.0, 1.0], 0.1, 0.5), 0.5);
        assert_eq!(nearest_inside([0.0, 1.0], 0.1, 2.0), 0.9);
        assert_eq!(nearest_inside([0.0, 1.0], 0.1, 0.05), 0.1);
        assert_eq!(nearest_inside([0.0, 0.2], 0.1, 7.0), 0.1);
        // Shorter than the margins at both ends, by rounding alone and by far.
        for stretch in [[-6.9e-10, 1.9e-10], [0.3, 0.3], [0.3, 0.3f64.next_up()]] {
            let half = 0.5 * (stretch[1] - stretch[0]);
            for little in [half, half.next_up(), 1e-9] {
                let place = nearest_inside(stretch, little, 0.25);
                assert!(stretch[0] <= place && place <= stretch[1], "{place}");
            }
        }
    }
}
