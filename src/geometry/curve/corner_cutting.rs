//! Curves by cutting corners: Chaikin's scheme, and the cubic one, with their limits.
//!
//! They are to curves what Doo and Sabin's rules and Catmull and Clark's are to surfaces.

use glam::DVec3;

use super::matrix_form::check_count;
use super::{CurveError, NurbsCurve};

/// A rule that cuts the corners of a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerCutting {
    /// Chaikin 1974: each edge keeps its points at 1/4 and 3/4. The limit is the uniform
    /// quadratic B-spline.
    Chaikin,
    /// Each edge adds its midpoint; each corner moves to the mean of it and its neighbours with
    /// the weights (1, 6, 1)/8. The limit is the uniform cubic B-spline (Lane & Riesenfeld 1980).
    Cubic,
}

/// Whether the last corner of a polygon is joined to the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PolygonEnds {
    /// Not joined. The curve then ends where the rule, which needs neighbours, ends.
    Open,
    /// Joined; the first corner is not listed again.
    Closed,
}

impl CornerCutting {
    /// The degree of the limit curve.
    pub fn degree(self) -> usize {
        match self {
            Self::Chaikin => 2,
            Self::Cubic => 3,
        }
    }

    /// The polygon with its corners cut once. A closed polygon of `n` corners gets `2n`, an open
    /// one `2n − 2` (Chaikin) or `2n − 3` (cubic).
    ///
    /// # Errors
    /// When an open polygon has fewer than `degree + 1` corners, or a closed one fewer than 3.
    pub fn cut(self, polygon: &[DVec3], ends: PolygonEnds) -> Result<Vec<DVec3>, CurveError> {
        self.check(polygon, ends)?;
        let n = polygon.len();
        let edges = match ends {
            PolygonEnds::Open => n - 1,
            PolygonEnds::Closed => n,
        };
        let corner = |k: usize| polygon[k % n];
        let mut cut = Vec::with_capacity(2 * n);
        for k in 0..edges {
            let (a, b) = (corner(k), corner(k + 1));
            match self {
                Self::Chaikin => cut.extend([0.75 * a + 0.25 * b, 0.25 * a + 0.75 * b]),
                Self::Cubic => {
                    cut.push(0.5 * (a + b));
                    if ends == PolygonEnds::Closed || k + 2 < n {
                        cut.push(0.125 * a + 0.75 * b + 0.125 * corner(k + 2));
                    }
                }
            }
        }
        Ok(cut)
    }

    /// The limit curve of the polygon when its corners are cut again and again.
    ///
    /// # Errors
    /// As [`CornerCutting::cut`], and when a corner is not finite.
    pub fn limit(self, polygon: &[DVec3], ends: PolygonEnds) -> Result<NurbsCurve, CurveError> {
        self.check(polygon, ends)?;
        match ends {
            PolygonEnds::Open => NurbsCurve::uniform_bspline(self.degree(), polygon),
            PolygonEnds::Closed => NurbsCurve::closed_bspline(self.degree(), polygon),
        }
    }

    fn check(self, polygon: &[DVec3], ends: PolygonEnds) -> Result<(), CurveError> {
        let needed = match ends {
            PolygonEnds::Open => self.degree() + 1,
            PolygonEnds::Closed => 3,
        };
        check_count(polygon.len(), needed)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [CornerCutting; 2] = [CornerCutting::Chaikin, CornerCutting::Cubic];

    fn polygon(size: f64) -> Vec<DVec3> {
        let corners =
            [[0.0, 0.0, 0.0], [1.0, 3.0, 0.5], [4.0, 2.0, 1.0], [5.0, -1.0, 0.0], [2.0, -2.0, 2.0]];
        corners.map(|corner| size * DVec3::from(corner)).to_vec()
    }

    /// A cut polygon controls the same spline, with a knot inserted halfway in every span.
    #[test]
    fn a_cut_is_an_insertion_of_knots() {
        for scheme in BOTH {
            for size in [1e-8, 1.0, 1e8] {
                let polygon = polygon(size);
                let limit = scheme.limit(&polygon, PolygonEnds::Open).unwrap();
                let cut = scheme.cut(&polygon, PolygonEnds::Open).unwrap();
                let again = NurbsCurve::uniform_bspline(scheme.degree(), &cut).unwrap();
                let [a, b] = limit.domain();
                let again = again.on_domain(a, b).unwrap();
                for k in 0..=60 {
                    let t = a + (b - a) * f64::from(k) / 60.0;
                    let off = limit.point_at(t).distance(again.point_at(t));
                    assert!(off < 5e-15 * 5.0 * size, "{scheme:?} at {t}: off by {off:e}");
                }
            }
        }
    }

    /// The deck: the limit meets the midpoints of Chaikin's edges, and is tangent to them there.
    #[test]
    fn chaikin_s_limit_touches_every_edge_at_its_middle() {
        let polygon = polygon(1.0);
        let limit = CornerCutting::Chaikin.limit(&polygon, PolygonEnds::Closed).unwrap();
        let start = limit.domain()[0];
        for k in 0..5 {
            let edge = polygon[(k + 1) % 5] - polygon[k];
            let at = limit.derivatives(start + k as f64);
            assert!(at.point.distance(polygon[k] + 0.5 * edge) < 1e-15 * 5.0);
            assert!(at.first.cross(edge).length() < 1e-14 * edge.length_squared());
        }
    }

    #[test]
    fn polygons_converge_by_a_quarter_of_the_error_a_cut() {
        for scheme in BOTH {
            for ends in [PolygonEnds::Open, PolygonEnds::Closed] {
                let mut polygon = polygon(1.0);
                let limit = scheme.limit(&polygon, ends).unwrap();
                let [a, b] = limit.domain();
                let samples: Vec<DVec3> = (0..=20000)
                    .map(|k| limit.point_at(a + (b - a) * f64::from(k) / 20000.0))
                    .collect();
                let mut errors = Vec::new();
                for _ in 0..4 {
                    polygon = scheme.cut(&polygon, ends).unwrap();
                    // Inner corners only: the ends are off by half an edge.
                    let inner = &polygon[2..polygon.len() - 2];
                    let off = |corner: &DVec3| {
                        samples.iter().map(|s| s.distance(*corner)).fold(f64::INFINITY, f64::min)
                    };
                    errors.push(inner.iter().map(off).fold(0.0, f64::max));
                }
                let rate = errors[0] / errors[3];
                assert!((40.0..100.0).contains(&rate), "{scheme:?} {ends:?}: {errors:?}");
            }
        }
    }

    #[test]
    fn counts_and_too_few_corners() {
        let polygon = polygon(1.0);
        let count = |scheme: CornerCutting, ends| scheme.cut(&polygon, ends).unwrap().len();
        assert_eq!(count(CornerCutting::Chaikin, PolygonEnds::Open), 8);
        assert_eq!(count(CornerCutting::Chaikin, PolygonEnds::Closed), 10);
        assert_eq!(count(CornerCutting::Cubic, PolygonEnds::Open), 7);
        assert_eq!(count(CornerCutting::Cubic, PolygonEnds::Closed), 10);
        let cubic = CornerCutting::Cubic;
        assert_eq!(
            cubic.cut(&polygon[..3], PolygonEnds::Open).unwrap_err().to_string(),
            "3 points: at least 4 are needed"
        );
        assert!(cubic.limit(&polygon[..3], PolygonEnds::Closed).is_ok());
        assert!(cubic.limit(&polygon[..2], PolygonEnds::Closed).is_err());
    }
}
