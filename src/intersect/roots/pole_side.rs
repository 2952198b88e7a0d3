//! Corners at which tangents say little: poles that a ray passes at a little distance, and corners
//! from which a side starts with a tangent that vanishes.

use glam::{DVec2, DVec3};

use super::spot::{BESIDE_CORNER, Spot};
use crate::geometry::{Direction, RectSide};
use crate::math::RayFrame;

impl Spot<'_> {
    /// Whether a ray that meets the piece at a pole, within rounding, is not known to meet it
    /// beside the pole: as seen along the ray, it passes outside the sector that the piece covers
    /// there, or near an end of the sector: nearer than a margin `at_border`, if the surface has a
    /// border there, or `inside`, if it goes on in another piece. Negative margins widen the
    /// sector.
    ///
    /// `None` where the directions away from the pole do not tell what sector they cover.
    pub(crate) fn is_passed_outside_at_pole(
        &self,
        ray: &RayFrame,
        [at_border, inside]: [f64; 2],
    ) -> Option<bool> {
        let Self { piece, st, .. } = *self;
        let at = |side: RectSide| st[side.fixed()] == side.value();
        let poles = piece.collapsed_sides().filter(|(side, _)| at(*side));
        let outside = poles.map(|(side, pole)| {
            let passes = -ray.coordinates(pole).truncate();
            let ends = RectSide::ends_of(side.along()).map(|end| piece.is_border(end));
            let margins = ends.map(|is_border| if is_border { at_border } else { inside });
            let away = piece.away_from_pole(side, pole);
            let away: Vec<DVec2> = away.into_iter().map(|way| ray.across(way)).collect();
            is_outside(&away, passes, margins)
        });
        let either = |a: Option<bool>, b: Option<bool>| match (a, b) {
            (Some(true), _) | (_, Some(true)) => Some(true),
            (Some(false), Some(false)) => Some(false),
            _ => None,
        };
        outside.reduce(either)?
    }
}

/// Whether a place in the plane is outside the sector that a Bézier curve of directions sweeps
/// about the origin, or within these margins of its ends, of which negative ones widen it. The
/// sector is that of the control polygon, if this always turns the same way, by less than half a
/// turn from one of its points to the next.
fn is_outside(away: &[DVec2], place: DVec2, margins: [f64; 2]) -> Option<bool> {
    let turns = || away.windows(2).map(|pair| pair[0].perp_dot(pair[1]));
    let sign = turns().sum::<f64>().signum();
    let is_known = turns().all(|turn| turn * sign > 0.0); // false for NaN
    let last = away.len().saturating_sub(2);
    let holds = |(k, pair): (usize, &[DVec2])| {
        let from = if k == 0 { margins[0] * pair[0].length() } else { 0.0 };
        let to = if k == last { margins[1] * pair[1].length() } else { 0.0 };
        sign * pair[0].perp_dot(place) >= from && sign * place.perp_dot(pair[1]) >= to
    };
    is_known.then(|| !away.windows(2).enumerate().any(holds))
}

/// A tangent counts as vanishing where its square is less than this many times the error of points
/// times the length of the side: as at sixteen errors from a corner from which the side starts like
/// a parabola in its own axis, whose tangent is `2 √(distance · length)`.
const STANDS_STILL: f64 = 64.0;

/// Whether a side of the piece starts from the corner nearby with a tangent that vanishes, to
/// within the rounding of the place: the tangents there do not tell which directions the piece
/// covers. A collapsed side is no such side.
pub(super) fn stands_still(spot: &Spot<'_>, error: f64) -> bool {
    let Spot { piece, st, ref jet, .. } = *spot;
    let corner = st.round();
    if (st - corner).abs().max_element() > BESIDE_CORNER {
        return false;
    }
    let degree = piece.patch.degree();
    // The sides that leave the corner.
    Direction::BOTH.into_iter().any(|fixed| {
        let side = RectSide::ends_of(fixed)[corner[fixed] as usize];
        let at = |k: usize| {
            let [i, j] = side.control_point(degree, k);
            piece.patch.control_point(i, j).project()
        };
        let points: Vec<DVec3> = (0..=degree[side.along()]).map(at).collect();
        let length = points.windows(2).map(|pair| pair[0].distance(pair[1])).sum::<f64>();
        let tangent = [jet.ds, jet.dt][side.along()];
        !piece.is_collapsed(side) && tangent.length_squared() < STANDS_STILL * error * length
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sectors_hold_what_lies_between_their_ends() {
        let ways = |angles: &[f64]| -> Vec<DVec2> {
            angles.iter().map(|&angle| 3.0 * DVec2::from_angle(angle)).collect()
        };
        // A quarter, more than half a turn, and the quarter the other way round.
        for (angles, inside, outside) in [
            (&[0.0, 0.8, 1.5][..], &[0.1, 0.8, 1.4][..], &[-0.1, 1.6, 3.0, -2.0][..]),
            (&[0.0, 1.5, 3.0, 4.5], &[0.1, 2.0, 4.4], &[-0.1, 4.6, 5.5]),
            (&[1.5, 0.7, 0.0], &[0.1, 0.8, 1.4], &[-0.1, 1.6, 3.0]),
        ] {
            let away = ways(angles);
            let outside_at =
                |angle: f64| is_outside(&away, DVec2::from_angle(angle), [0.01; 2]).unwrap();
            assert!(inside.iter().all(|&angle| !outside_at(angle)), "{angles:?}");
            assert!(outside.iter().all(|&angle| outside_at(angle)), "{angles:?}");
            // Within the margin of an end.
            assert!(
                outside_at(angles[0])
                    && is_outside(&away, DVec2::from_angle(0.7), [0.0; 2]) == Some(false)
            );
        }
        // Nothing is known of directions on one line, or that turn back.
        assert_eq!(is_outside(&ways(&[0.0, 0.0]), DVec2::Y, [0.0; 2]), None);
        assert_eq!(is_outside(&ways(&[0.0, 1.0, 0.5]), DVec2::NEG_Y, [0.0; 2]), None);
    }
}
