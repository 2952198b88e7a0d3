//! B-splines over uniform and standard knots, open, closed, or with repeated control points.

use glam::DVec3;

use super::matrix_form::check_count;
use super::{CurveError, NurbsCurve};
use crate::geometry::{KnotVector, MAX_DEGREE};

/// How often an end point may occur. A curve of degree p meets one that occurs p times, and stands
/// still there for a whole span if it occurs p + 1 times; more changes nothing.
pub const MAX_REPEATED: usize = MAX_DEGREE + 1;

impl NurbsCurve {
    /// The B-spline over the knots 0, 1, 2, …: it does not reach its outermost control points.
    ///
    /// # Errors
    /// When the degree is not supported, there are too few points, or one is not finite.
    pub fn uniform_bspline(degree: usize, points: &[DVec3]) -> Result<Self, CurveError> {
        Self::new(KnotVector::uniform(degree, points.len())?, points.to_vec(), None)
    }

    /// The B-spline over the standard knots: clamped, 0, 1, 2, … inside. It begins and ends
    /// at its outermost control points.
    ///
    /// # Errors
    /// When the degree is not supported, there are too few points, or one is not finite.
    pub fn standard_bspline(degree: usize, points: &[DVec3]) -> Result<Self, CurveError> {
        Self::new(KnotVector::standard(degree, points.len())?, points.to_vec(), None)
    }

    /// The closed B-spline around these control points, as smooth at its seam as elsewhere:
    /// over uniform knots, with the first `degree` points repeated at the end.
    ///
    /// # Errors
    /// When the degree is not supported, there are fewer than three points, or one is not
    /// finite.
    pub fn closed_bspline(degree: usize, points: &[DVec3]) -> Result<Self, CurveError> {
        check_count(points.len(), 3)?;
        // Knots first: this refuses a degree before that many points are made.
        let count = points.len().saturating_add(degree);
        let knots = KnotVector::uniform(degree, count)?;
        let around = (0..count).map(|k| points[k % points.len()]).collect();
        Self::new(knots, around, None)
    }
}

/// The control points with the first and the last repeated to occur `first` and `last` times. A
/// uniform spline of degree `p` meets an end point that occurs `p` times.
///
/// # Errors
/// When there are no points, or a number is not from 1 to [`MAX_REPEATED`].
pub fn with_repeated_ends(
    points: &[DVec3],
    [first, last]: [usize; 2],
) -> Result<Vec<DVec3>, CurveError> {
    for times in [first, last] {
        if !(1..=MAX_REPEATED).contains(&times) {
            return Err(CurveError::Repeated { times, most: MAX_REPEATED });
        }
    }
    let (Some(start), Some(end)) = (points.first(), points.last()) else {
        return Err(CurveError::TooFewPoints { found: 0, needed: 1 });
    };
    let mut all = vec![*start; first - 1];
    all.extend_from_slice(points);
    all.extend(std::iter::repeat_n(*end, last - 1));
    Ok(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points() -> Vec<DVec3> {
        let corners =
            [[200, 100], [500, 200], [600, 500], [800, 600], [500, 900], [400, 700], [100, 500]];
        corners.map(|[x, y]| DVec3::new(f64::from(x), f64::from(y), 0.0)).to_vec()
    }

    /// Where a uniform cubic begins if its end point occurs one to four times.
    #[test]
    fn repeated_ends_draw_the_curve_to_them() {
        let p = points();
        let starts = [(p[0] + 4.0 * p[1] + p[2]) / 6.0, (5.0 * p[0] + p[1]) / 6.0, p[0], p[0]];
        for (times, start) in (1..=4).zip(starts) {
            let all = with_repeated_ends(&p, [times, times]).unwrap();
            let curve = NurbsCurve::uniform_bspline(3, &all).unwrap();
            let [a, b] = curve.ends();
            assert!(a.distance(start) < 1e-12, "{times} times: {a}");
            let met = times >= 3;
            assert_eq!(b.distance(p[6]) < 1e-12, met, "{times} times: {b}");
        }
        // Threefold: the lecture's slide.
        let all = with_repeated_ends(&p, [3, 3]).unwrap();
        let curve = NurbsCurve::uniform_bspline(3, &all).unwrap();
        assert_eq!(curve.knots().spans().count(), 8);
        let middle = |segment: f64| curve.point_at(3.0 + segment + 0.5);
        assert!(middle(0.0).distance(DVec3::new(825.0 / 4.0, 1225.0 / 12.0, 0.0)) < 1e-12);
        assert!(middle(3.0).distance(DVec3::new(2075.0 / 3.0, 550.0, 0.0)) < 1e-12);
        // Fourfold: the curve stands still for a span.
        let all = with_repeated_ends(&p, [4, 1]).unwrap();
        let curve = NurbsCurve::uniform_bspline(3, &all).unwrap();
        assert!((0..=10).all(|k| curve.point_at(3.0 + f64::from(k) / 10.0).distance(p[0]) < 1e-12));
        assert_eq!(
            with_repeated_ends(&p, [34, 1]).unwrap_err().to_string(),
            "an end point 34 times: from 1 to 33 times are possible"
        );
        // Any degree: p times.
        for degree in 1..=6 {
            let meets = |times: usize| {
                let all = with_repeated_ends(&p, [times, 1]).unwrap();
                let curve = NurbsCurve::uniform_bspline(degree, &all).unwrap();
                curve.ends()[0].distance(p[0]) < 1e-12
            };
            assert!(meets(degree) && (degree == 1 || !meets(degree - 1)), "{degree}");
        }
    }

    /// A standard cubic meets its outermost points; a uniform cubic keeps its shape when it is
    /// clamped.
    #[test]
    fn standard_and_uniform_knots_agree_away_from_the_ends() {
        let points = points();
        let [uniform, standard] = [NurbsCurve::uniform_bspline, NurbsCurve::standard_bspline]
            .map(|kind| kind(3, &points).unwrap());
        assert_eq!(standard.ends(), [points[0], points[6]]);
        assert_eq!(standard.knots().values(), [0., 0., 0., 0., 1., 2., 3., 4., 4., 4., 4.]);
        // Clamped at the ends of its domain [3, 7], the uniform cubic keeps its shape.
        let clamped = uniform.clamped();
        assert_eq!(clamped.knots().values(), [3., 3., 3., 3., 4., 5., 6., 7., 7., 7., 7.]);
        for k in 0..=40 {
            let t = 3.0 + f64::from(k) / 10.0;
            assert!(clamped.point_at(t).distance(uniform.point_at(t)) < 1e-12);
        }
    }

    #[test]
    fn degrees_are_refused_before_points_are_made() {
        for degree in [0, 33, usize::MAX / 2, usize::MAX] {
            assert!(NurbsCurve::closed_bspline(degree, &points()).is_err(), "{degree}");
        }
        assert!(KnotVector::bezier(usize::MAX).is_err());
    }

    #[test]
    fn ends_of_nothing_cannot_be_repeated() {
        assert_eq!(
            with_repeated_ends(&[], [1, 1]).unwrap_err().to_string(),
            "0 points: at least 1 is needed"
        );
    }

    #[test]
    fn closed_splines_are_smooth_at_their_seam() {
        for degree in 1..=5 {
            let curve = NurbsCurve::closed_bspline(degree, &points()).unwrap();
            let [a, b] = curve.domain();
            assert_eq!(b - a, 7.0);
            let [start, end] = [a, b].map(|t| curve.derivatives(t));
            assert!(start.point.distance(end.point) < 1e-11);
            if degree >= 2 {
                assert!(start.first.distance(end.first) < 1e-10, "degree {degree}");
            }
            if degree >= 3 {
                assert!(start.second.distance(end.second) < 1e-9, "degree {degree}");
            }
        }
        assert_eq!(
            NurbsCurve::closed_bspline(3, &points()[..2]).unwrap_err().to_string(),
            "2 points: at least 3 are needed"
        );
    }
}
