//! The curvature of curves, as far as rounding lets it be known.

use glam::DVec3;
use nurbray::geometry::NurbsCurve;
use nurbray::math::Aabb;

/// A curve, and how well its curvature must be known.
#[derive(Clone, Debug)]
pub(super) struct Bending {
    curve: NurbsCurve,
    /// A curvature no larger than its error bound counts as 0 if the bound is at most this, and as
    /// unknown if not.
    coarsest: f64,
}

/// The error allowed for curvatures, as a share of 1 over the curve's size.
const COARSEST: f64 = 1e-3;

impl Bending {
    pub(super) fn of(curve: &NurbsCurve) -> Self {
        let points = curve.points();
        let coarsest = COARSEST / Aabb::around(points).size().length();
        Self { curve: curve.clone(), coarsest }
    }

    /// The curve's point at `t` and its curvature vector there, which is zero where it is no more
    /// than rounding. `None` where the derivative vanishes, or is so small that rounding leaves
    /// nothing of the curvature.
    pub(super) fn at(&self, t: f64) -> Option<(DVec3, DVec3)> {
        let at = self.curve.derivatives(t);
        let bend = at.curvature_vector()?;
        let error = self.curve.curvature_error(t);
        if bend.length() > error {
            Some((at.point, bend))
        } else {
            (error <= self.coarsest).then_some((at.point, DVec3::ZERO))
        }
    }
}

#[cfg(test)]
mod tests {
    use nurbray::geometry::KnotVector;

    use super::*;

    #[test]
    fn straight_curves_are_straight_and_what_rests_is_unknown_or_right() {
        let points =
            [[0.0, 0.0], [1.0, 0.3], [3.0, 0.9], [4.0, 1.2]].map(|[x, y]| DVec3::new(x, y, 0.0));
        let line = Bending::of(&NurbsCurve::bezier(&points).unwrap());
        assert!((0..=100).all(|k| line.at(f64::from(k) / 100.0).unwrap().1 == DVec3::ZERO));

        // One point is so heavy that the curve all but rests there: a bend like any other.
        let points = [[0.0, 0.0], [1.0, 1.0], [2.0, -1.0], [3.0, 0.0]];
        let points = points.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let knots = KnotVector::bezier(3).unwrap();
        let heavy = NurbsCurve::new(knots, points, Some(vec![1.0, 1.0, 1e4, 1.0])).unwrap();
        let heavy = Bending::of(&heavy);
        let known = (1..1000).map(|k| heavy.at(f64::from(k) / 1000.0));
        assert!(known.clone().all(|bend| bend.is_some()));
        let most = known.flatten().map(|(_, bend)| bend.length()).fold(0.0, f64::max);
        assert!((8000.0..9000.0).contains(&most), "{most}");

        // A B-spline that comes to rest in its last point, which is there three times: it ends
        // straight.
        let points = [[0.1, 0.0], [1.0, 2.3], [3.0, 1.1], [4.2, 0.7], [4.2, 0.7], [4.2, 0.7]];
        let turned = |[x, y]: [f64; 2]| DVec3::new(0.94 * x - 0.34 * y, 0.34 * x + 0.94 * y, 0.0);
        let knots = KnotVector::uniform(3, points.len()).unwrap();
        let curve = NurbsCurve::new(knots, points.map(turned).to_vec(), None).unwrap();
        let (bending, [_, end]) = (Bending::of(&curve), curve.domain());
        let bends = (0..=1000).filter_map(|k| bending.at(end - 1e-3 * f64::from(k)));
        let bends: Vec<f64> = bends.map(|(_, bend)| bend.length()).collect();
        assert!(bends.len() > 950, "{}", bends.len());
        assert!(bends.iter().all(|&bend| bend < 1e-3), "{bends:?}");
    }
}
