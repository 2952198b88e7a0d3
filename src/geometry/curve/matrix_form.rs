//! Segments in matrix form, most of them cubic, `C(t) = [t³ t² t 1] M G`, and the splines made of
//! them.
//!
//! A surface is `S M G Mᵀ Tᵀ`, and the blending functions `B = Mᵀ Tᵀ` are B₀ to B₃.

use std::ops::RangeInclusive;

use glam::{DVec3, DVec4};

use super::{CurveError, NurbsCurve};
use crate::geometry::KnotVector;

/// The meaning of the vectors `G` that define a segment: four for a cubic one. Bézier and B-spline
/// segments may also have the degrees 1 and 2, with two and three control points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MatrixForm {
    /// Four control points.
    Bezier,
    /// Four control points of a uniform B-spline; the segment need not meet any of them.
    BSpline,
    /// The two end points, then the derivatives there.
    Hermite,
    /// Four points; the segment runs from the second to the third, with the derivatives
    /// `(P₂ − P₀)/2` and `(P₃ − P₁)/2`.
    CatmullRom,
}

impl MatrixForm {
    /// All four forms.
    pub const ALL: [Self; 4] = [Self::Bezier, Self::BSpline, Self::Hermite, Self::CatmullRom];

    /// The matrix `M`: rows for `t³`, `t²`, `t`, 1, columns for the four vectors.
    pub fn matrix(self) -> [[f64; 4]; 4] {
        let (whole, over) = match self {
            Self::Bezier => ([[-1, 3, -3, 1], [3, -6, 3, 0], [-3, 3, 0, 0], [1, 0, 0, 0]], 1.0),
            Self::BSpline => ([[-1, 3, -3, 1], [3, -6, 3, 0], [-3, 0, 3, 0], [1, 4, 1, 0]], 6.0),
            Self::Hermite => ([[2, -2, 1, 1], [-3, 3, -2, -1], [0, 0, 1, 0], [1, 0, 0, 0]], 1.0),
            Self::CatmullRom => {
                ([[-1, 3, -3, 1], [2, -5, 4, -1], [-1, 0, 1, 0], [0, 2, 0, 0]], 2.0)
            }
        };
        whole.map(|row: [i32; 4]| row.map(|entry| f64::from(entry) / over))
    }

    /// Its name, as scenes write it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bezier => "bezier",
            Self::BSpline => "bspline",
            Self::Hermite => "hermite",
            Self::CatmullRom => "catmull_rom",
        }
    }

    /// The degrees that its segments may have. One of degree `n` is defined by `n + 1` vectors.
    pub fn degrees(self) -> RangeInclusive<usize> {
        match self {
            Self::Bezier | Self::BSpline => 1..=3,
            Self::Hermite | Self::CatmullRom => 3..=3,
        }
    }

    /// The matrix `M` of a degree: rows for the powers of `t`, the highest first, columns for the
    /// vectors. `None` if the form has no segments of that degree.
    pub fn matrix_of_degree(self, degree: usize) -> Option<Vec<Vec<f64>>> {
        let (rows, over): (&[&[f64]], f64) = match (self, degree) {
            (Self::Bezier | Self::BSpline, 1) => (&[&[-1.0, 1.0], &[1.0, 0.0]], 1.0),
            (Self::Bezier, 2) => (&[&[1.0, -2.0, 1.0], &[-2.0, 2.0, 0.0], &[1.0, 0.0, 0.0]], 1.0),
            (Self::BSpline, 2) => (&[&[1.0, -2.0, 1.0], &[-2.0, 2.0, 0.0], &[1.0, 1.0, 0.0]], 2.0),
            (_, 3) => return Some(self.matrix().map(Vec::from).into()),
            _ => return None,
        };
        Some(rows.iter().map(|row| row.iter().map(|entry| entry / over).collect()).collect())
    }

    /// The four blending functions at `t`, `[t³ t² t 1] M`.
    pub fn blending(self, t: f64) -> [f64; 4] {
        let m = self.matrix();
        [0, 1, 2, 3].map(|k| ((m[0][k] * t + m[1][k]) * t + m[2][k]) * t + m[3][k])
    }

    /// The Bézier points of a segment.
    pub(crate) fn to_bezier(self, [a, b, c, d]: [DVec3; 4]) -> [DVec3; 4] {
        match self {
            Self::Bezier => [a, b, c, d],
            Self::BSpline => {
                let [left, right] = [(2.0 * b + c) / 3.0, (b + 2.0 * c) / 3.0];
                [(a + 4.0 * b + c) / 6.0, left, right, (b + 4.0 * c + d) / 6.0]
            }
            Self::Hermite => [a, a + c / 3.0, b - d / 3.0, b],
            Self::CatmullRom => [b, b + (c - a) / 6.0, c - (d - b) / 6.0, c],
        }
    }

    /// The Bézier points of a segment of any of the form's degrees; `None` if it has none with as
    /// many vectors.
    pub(crate) fn bezier_points(self, geometry: &[DVec3]) -> Option<Vec<DVec3>> {
        match (self, geometry) {
            (Self::Bezier | Self::BSpline, [_, _]) | (Self::Bezier, [_, _, _]) => {
                Some(geometry.to_vec())
            }
            (Self::BSpline, &[a, b, c]) => Some(vec![0.5 * (a + b), b, 0.5 * (b + c)]),
            (_, &[a, b, c, d]) => Some(self.to_bezier([a, b, c, d]).into()),
            _ => None,
        }
    }

    /// How many vectors define a segment, in words.
    pub(crate) fn vector_counts(self) -> &'static str {
        match self {
            Self::Bezier | Self::BSpline => "2, 3 or 4",
            Self::Hermite | Self::CatmullRom => "4",
        }
    }

    /// The four vectors that define, in this form, the segment with these Bézier points.
    fn given_by_bezier(self, [a, b, c, d]: [DVec3; 4]) -> [DVec3; 4] {
        match self {
            Self::Bezier => [a, b, c, d],
            Self::BSpline => {
                [6.0 * a - 7.0 * b + 2.0 * c, 2.0 * b - c, 2.0 * c - b, 2.0 * b - 7.0 * c + 6.0 * d]
            }
            Self::Hermite => [a, d, 3.0 * (b - a), 3.0 * (d - c)],
            Self::CatmullRom => [d - 6.0 * (b - a), a, d, a + 6.0 * (d - c)],
        }
    }

    /// The segment as a curve on `[0, 1]`: its Bézier form.
    ///
    /// # Errors
    /// When a coordinate is not finite.
    pub fn segment(self, geometry: [DVec3; 4]) -> Result<NurbsCurve, CurveError> {
        NurbsCurve::bezier(&self.to_bezier(geometry))
    }

    /// The segment of any of the form's degrees as a curve on `[0, 1]`: its Bézier form.
    ///
    /// # Errors
    /// When the form has no segments with as many vectors, or a coordinate is not finite.
    pub fn segment_of(self, geometry: &[DVec3]) -> Result<NurbsCurve, CurveError> {
        let points = self.bezier_points(geometry).ok_or(CurveError::GeometryCount {
            form: self.name(),
            found: geometry.len(),
            needed: self.vector_counts(),
        })?;
        NurbsCurve::bezier(&points)
    }

    /// The four vectors that define `segment`, a curve of one cubic, polynomial piece.
    ///
    /// # Errors
    /// When the curve has another degree, several pieces, or different weights.
    pub fn geometry(self, segment: &NurbsCurve) -> Result<[DVec3; 4], CurveError> {
        let clamped = segment.clamped();
        let fits = clamped.knots().degree() == 3
            && clamped.knots().point_count() == 4
            && !clamped.is_rational();
        if !fits {
            return Err(CurveError::NotOneCubic {
                degree: segment.knots().degree(),
                pieces: segment.knots().spans().count(),
                rational: segment.is_rational(),
            });
        }
        Ok(self.given_by_bezier([0, 1, 2, 3].map(|k| clamped.vertex(k))))
    }

    /// The four vectors that define in the form `to` the segment that `geometry` defines in this
    /// one.
    pub fn converted(self, geometry: [DVec3; 4], to: Self) -> [DVec3; 4] {
        to.given_by_bezier(self.to_bezier(geometry))
    }

    /// The chain of the segments of four consecutive vectors each, whose first vectors are
    /// `advance` apart; each is one parameter unit long and begins where the one before it ends.
    /// Catmull–Rom segments advance by one point, Hermite segments by their own four vectors; both
    /// chains are smooth to the first derivative.
    fn chain(self, points: &[DVec3], advance: usize) -> Result<NurbsCurve, CurveError> {
        let mut control: Vec<DVec4> = Vec::new();
        let mut pieces = 0;
        for window in points.windows(4).step_by(advance) {
            let bezier = self.to_bezier([window[0], window[1], window[2], window[3]]);
            let shared = usize::from(pieces > 0);
            control.extend(bezier[shared..].iter().map(|point| point.extend(1.0)));
            pieces += 1;
        }
        let mut knots = vec![0.0];
        knots.extend((0..=pieces).flat_map(|t| [t as f64; 3]));
        knots.push(pieces as f64);
        NurbsCurve::from_homogeneous(KnotVector::for_points(3, knots, control.len())?, control)
    }
}

impl NurbsCurve {
    /// The Catmull–Rom spline through these points, from the second to the last but one; its
    /// parameter grows by 1 from point to point.
    ///
    /// # Errors
    /// When there are fewer than four points, or one is not finite.
    pub fn catmull_rom(points: &[DVec3]) -> Result<Self, CurveError> {
        check_count(points.len(), 4)?;
        MatrixForm::CatmullRom.chain(points, 1)
    }

    /// The closed Catmull–Rom spline through all of these points.
    ///
    /// # Errors
    /// When there are fewer than three points, or one is not finite.
    pub fn closed_catmull_rom(points: &[DVec3]) -> Result<Self, CurveError> {
        check_count(points.len(), 3)?;
        let around: Vec<DVec3> =
            (0..points.len() + 3).map(|k| points[(k + points.len() - 1) % points.len()]).collect();
        MatrixForm::CatmullRom.chain(&around, 1)
    }

    /// The Hermite spline through points with these derivatives; its parameter grows by 1
    /// from point to point.
    ///
    /// # Errors
    /// When there are fewer than two points, not as many derivatives, or one is not finite.
    pub fn hermite(points: &[DVec3], derivatives: &[DVec3]) -> Result<Self, CurveError> {
        check_count(points.len(), 2)?;
        if derivatives.len() != points.len() {
            let (derivatives, points) = (derivatives.len(), points.len());
            return Err(CurveError::DerivativeCount { derivatives, points });
        }
        let ends = |k: usize| [points[k], points[k + 1], derivatives[k], derivatives[k + 1]];
        let all: Vec<DVec3> = (0..points.len() - 1).flat_map(ends).collect();
        MatrixForm::Hermite.chain(&all, 4)
    }
}

pub(super) fn check_count(found: usize, needed: usize) -> Result<(), CurveError> {
    if found < needed { Err(CurveError::TooFewPoints { found, needed }) } else { Ok(()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const G: [DVec3; 4] = [
        DVec3::new(2.0, 1.0, 0.0),
        DVec3::new(5.0, 2.0, -1.0),
        DVec3::new(6.0, 5.0, 3.0),
        DVec3::new(8.0, 6.0, 0.5),
    ];

    fn blended(form: MatrixForm, g: [DVec3; 4], t: f64) -> DVec3 {
        g.iter().zip(form.blending(t)).map(|(&point, weight)| weight * point).sum()
    }

    #[test]
    fn segments_are_what_their_matrices_say() {
        for form in MatrixForm::ALL {
            for size in [1e-8, 1.0, 1e8] {
                let g = G.map(|point| size * point);
                let curve = form.segment(g).unwrap();
                for k in 0..=20 {
                    let t = f64::from(k) / 20.0;
                    let off = curve.point_at(t).distance(blended(form, g, t));
                    assert!(off < 2e-14 * size, "{form:?} at {t}: off by {off:e}");
                }
            }
        }
    }

    /// `[tⁿ … t 1] M G` for every degree that a form has, and the matrices that documents print.
    #[test]
    fn segments_of_lower_degrees_are_what_their_matrices_say() {
        for form in MatrixForm::ALL {
            for count in 0..=5 {
                let geometry: Vec<DVec3> = G.into_iter().chain([DVec3::ONE]).take(count).collect();
                let degree = count.wrapping_sub(1);
                let matrix = form.matrix_of_degree(degree);
                assert_eq!(matrix.is_some(), form.degrees().contains(&degree), "{form:?} {count}");
                let Some(matrix) = matrix else {
                    let error = form.segment_of(&geometry).unwrap_err();
                    assert!(matches!(error, CurveError::GeometryCount { .. }), "{error}");
                    continue;
                };
                let curve = form.segment_of(&geometry).unwrap();
                assert_eq!((curve.degree(), curve.domain()), (degree, [0.0, 1.0]));
                for k in 0..=8 {
                    let t = f64::from(k) / 8.0;
                    let mut expected = DVec3::ZERO;
                    for (row, power) in matrix.iter().zip((0..=degree as i32).rev()) {
                        for (entry, vector) in row.iter().zip(&geometry) {
                            expected += t.powi(power) * entry * *vector;
                        }
                    }
                    assert!(curve.point_at(t).distance(expected) < 2e-14, "{form:?} at {t}");
                }
            }
        }
        let linear = MatrixForm::Bezier.matrix_of_degree(1).unwrap();
        assert_eq!(linear, [[-1.0, 1.0], [1.0, 0.0]]);
        let quadratic = MatrixForm::Bezier.matrix_of_degree(2).unwrap();
        assert_eq!(quadratic, [[1.0, -2.0, 1.0], [-2.0, 2.0, 0.0], [1.0, 0.0, 0.0]]);
        assert_eq!(
            MatrixForm::Hermite.segment_of(&G[..3]).unwrap_err().to_string(),
            "3 vectors in the geometry of a segment: the form hermite takes 4"
        );
    }

    /// B-spline segments of each degree are the pieces of the uniform B-spline, shifted to [0, 1].
    #[test]
    fn b_spline_segments_are_pieces_of_the_uniform_b_spline() {
        for degree in MatrixForm::BSpline.degrees() {
            let spline = NurbsCurve::uniform_bspline(degree, &G).unwrap();
            for (first, window) in G.windows(degree + 1).enumerate() {
                let segment = MatrixForm::BSpline.segment_of(window).unwrap();
                for k in 0..=8 {
                    let t = f64::from(k) / 8.0;
                    let there = spline.point_at((degree + first) as f64 + t);
                    assert!(segment.point_at(t).distance(there) < 1e-14, "{degree} at {t}");
                }
            }
        }
    }

    #[test]
    fn every_form_becomes_every_other_and_comes_back() {
        for from in MatrixForm::ALL {
            for to in MatrixForm::ALL {
                let other = from.converted(G, to);
                for k in 0..=8 {
                    let t = f64::from(k) / 8.0;
                    let off = blended(from, G, t).distance(blended(to, other, t));
                    assert!(off < 2e-13, "{from:?} to {to:?}: off by {off:e}");
                }
                let back = to.converted(other, from);
                assert!(back.iter().zip(G).all(|(a, b)| a.distance(b) < 2e-12));
            }
            let read = from.geometry(&from.segment(G).unwrap()).unwrap();
            assert!(read.iter().zip(G).all(|(a, b)| a.distance(b) < 1e-13), "{from:?}");
        }
        let two = NurbsCurve::catmull_rom(&[G[0], G[1], G[2], G[3], G[0]]).unwrap();
        assert_eq!(
            MatrixForm::Bezier.geometry(&two).unwrap_err().to_string(),
            "needed is one cubic, polynomial piece; this has degree 3 and 2 pieces"
        );
    }

    #[test]
    fn the_lecture_s_blending_functions() {
        for k in 0..=10 {
            let t = f64::from(k) / 10.0;
            let b = MatrixForm::BSpline.blending(t);
            let s = 1.0 - t;
            let printed = [
                s * s * s / 6.0,
                (3.0 * t * t * t - 6.0 * t * t + 4.0) / 6.0,
                (-3.0 * t * t * t + 3.0 * t * t + 3.0 * t + 1.0) / 6.0,
                t * t * t / 6.0,
            ];
            assert!(b.iter().zip(printed).all(|(x, y)| (x - y).abs() < 1e-15), "{t}: {b:?}");
        }
    }

    /// The B-spline segments of every four consecutive points are the uniform B-spline of all
    /// points.
    #[test]
    fn the_lecture_s_b_spline_is_the_one_over_uniform_knots() {
        let corners = [[2, 1], [5, 2], [6, 5], [8, 6], [5, 9], [4, 7], [1, 5]];
        let points = corners.map(|[x, y]| DVec3::new(f64::from(x), f64::from(y), 0.0));
        let spline = NurbsCurve::uniform_bspline(3, &points).unwrap();
        for (first, window) in points.windows(4).enumerate() {
            let g = [window[0], window[1], window[2], window[3]];
            for k in 0..=8 {
                let t = f64::from(k) / 8.0;
                let off = spline.point_at(3.0 + first as f64 + t).distance(blended(
                    MatrixForm::BSpline,
                    g,
                    t,
                ));
                assert!(off < 1e-14, "segment {first} at {t}: off by {off:e}");
            }
        }
        // The first segment's middle, from the polynomials of the lecture's example.
        let middle = spline.point_at(3.5);
        assert!(middle.distance(DVec3::new(263.0 / 48.0, 3.5, 0.0)) < 1e-15);
    }

    #[test]
    fn catmull_rom_and_hermite_meet_their_points_smoothly() {
        let spline = NurbsCurve::catmull_rom(&[G[0], G[1], G[2], G[3], DVec3::ZERO]).unwrap();
        assert_eq!(spline.domain(), [0.0, 2.0]);
        let knot = spline.derivatives(1.0);
        assert_eq!(knot.point, G[2]);
        let expected = 0.5 * (G[3] - G[1]);
        assert!(knot.first.distance(expected) < 1e-14);
        assert!(spline.derivatives(1.0 - 1e-9).first.distance(expected) < 1e-7);

        let around = NurbsCurve::closed_catmull_rom(&G).unwrap();
        assert_eq!((around.point_at(0.0), around.point_at(3.0)), (G[0], G[3]));
        assert_eq!(around.point_at(4.0), G[0]);
        let seam = [0.0, 4.0].map(|t| around.derivatives(t).first);
        assert!(seam[0].distance(seam[1]) < 1e-14);

        let tangents = [DVec3::X, DVec3::Y, DVec3::Z];
        let hermite = NurbsCurve::hermite(&G[..3], &tangents).unwrap();
        for k in 0..3 {
            let at = hermite.derivatives(k as f64);
            assert_eq!(at.point, G[k]);
            assert!(at.first.distance(tangents[k]) < 1e-14);
        }
        assert_eq!(
            NurbsCurve::hermite(&G, &tangents).unwrap_err().to_string(),
            "3 derivatives for 4 points: each needs one"
        );
        assert_eq!(
            NurbsCurve::catmull_rom(&G[..3]).unwrap_err().to_string(),
            "3 points: at least 4 are needed"
        );
    }
}
