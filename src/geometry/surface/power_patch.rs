//! Surfaces given by the coefficients of powers of their parameters.

use glam::DVec3;

use super::{NurbsSurface, SurfaceError};
use crate::geometry::curve::{PowerShares, power_coefficient, rounded_powers};
use crate::geometry::{Direction, KnotVector};

impl NurbsSurface {
    /// The surface `S(u, v) = Σ aᵢⱼ uⁱ vʲ / Σ dᵢⱼ uⁱ vʲ` on a domain, from the coefficients `aᵢⱼ`
    /// of its numerator and `dᵢⱼ` of its denominator, `&[vec![1.0]]` for a polynomial. A row `i`
    /// holds the coefficients of `uⁱ`, those of `v⁰` first; rows may have different lengths, and
    /// what is not given is zero. The longest list and the longest row have one entry more than the
    /// degrees.
    ///
    /// It is one Bézier patch, whose homogeneous control points are rounded once: see
    /// [`NurbsCurve::from_powers`](crate::geometry::NurbsCurve::from_powers).
    ///
    /// # Errors
    /// When a degree is not from 1 to [`MAX_DEGREE`](crate::geometry::MAX_DEGREE), a domain is
    /// empty or not finite, a coefficient is not finite or too large, a Bézier coefficient of the
    /// denominator is zero or has another sign than the first, or the surface has no area.
    pub fn from_powers(
        numerator: &[Vec<DVec3>],
        denominator: &[Vec<f64>],
        domain: [[f64; 2]; 2],
    ) -> Result<Self, SurfaceError> {
        let lengths = numerator.iter().map(Vec::len).chain(denominator.iter().map(Vec::len));
        let size = [numerator.len().max(denominator.len()), lengths.max().unwrap_or(0)];
        let degree = size.map(|count| count.saturating_sub(1));
        let knots = |direction: Direction| {
            let [start, end] = domain[direction];
            let knots = KnotVector::bezier(degree[direction]);
            let knots = knots.and_then(|knots| knots.on_domain(start, end));
            knots.map_err(|error| SurfaceError::Knots { direction, error })
        };
        let (knots_u, knots_v) = (knots(Direction::U)?, knots(Direction::V)?);

        // Along v, then along u; rounded at the end only.
        let along = Direction::BOTH.map(|k| PowerShares::new(degree[k], domain[k]));
        let coefficient = |i: usize, j: usize| {
            let numerator = numerator.get(i).and_then(|row| row.get(j)).copied();
            let denominator = denominator.get(i).and_then(|row| row.get(j)).copied();
            power_coefficient(numerator.unwrap_or_default(), denominator.unwrap_or_default())
        };
        let row = |i: usize| (0..size[1]).map(|j| coefficient(i, j)).collect::<Vec<_>>();
        let rows: Vec<_> = (0..size[0]).map(|i| along[1].apply(&row(i))).collect();
        let column = |j: usize| rows.iter().map(|row| row[j]).collect::<Vec<_>>();
        let columns: Vec<_> = (0..size[1]).map(|j| along[0].apply(&column(j))).collect();
        let net: Vec<_> =
            (0..size[0]).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
        let net = rounded_powers(&net).map_err(|(index, coefficient)| {
            let (i, j) = (index / size[1], index % size[1]);
            SurfaceError::Denominator { i, j, coefficient }
        })?;
        Self::from_homogeneous(knots_u, knots_v, net)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::geometry::shapes;

    /// The first patch of the lecture on bicubic surfaces by its polynomials, which are exact:
    /// `x = 3t`, `y = 3s`, and z in powers of s, the first parameter.
    fn lecture() -> NurbsSurface {
        let z = [
            [5.0, 3.0, -12.0, 9.0],
            [-6.0, 9.0, 27.0, -36.0],
            [9.0, -36.0, 9.0, 33.0],
            [-3.0, 21.0, -24.0, -3.0],
        ];
        let mut rows = z.map(|row| row.map(|z| z * DVec3::Z).to_vec());
        rows[0][1].x = 3.0;
        rows[1][0].y = 3.0;
        NurbsSurface::from_powers(&rows, &[vec![1.0]], [[0.0, 1.0]; 2]).unwrap()
    }

    #[test]
    fn the_lecture_s_polynomials_make_its_control_points() {
        let (made, net) = (lecture(), shapes::bicubic_graph());
        assert_eq!(made.size(), [4, 4]);
        for (made, point) in made.points().zip(net.points()) {
            assert!(made.distance(point) < 1e-15, "{made} is not {point}");
        }
    }

    /// `((1−u²)(1−v²), (1−u²) 2v, 2u (1+v²)) / ((1+u²)(1+v²))`: Eberly's octant.
    #[test]
    fn the_octant_by_its_formula_is_the_known_one() {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        let numerator = [vec![x, 2.0 * y, -x], vec![2.0 * z, DVec3::ZERO, 2.0 * z]]
            .into_iter()
            .chain([vec![-x, -2.0 * y, x]])
            .collect::<Vec<_>>();
        let denominator = [vec![1.0, 0.0, 1.0], vec![], vec![1.0, 0.0, 1.0]];
        let made = NurbsSurface::from_powers(&numerator, &denominator, [[0.0, 1.0]; 2]).unwrap();
        assert_eq!(made, shapes::octant_biquadratic_inward(1.0).unwrap());
        // A part of it is a part of the same sphere, in the same parameters.
        let domain = [[-0.5, 0.25], [0.5, 2.0]];
        let part = NurbsSurface::from_powers(&numerator, &denominator, domain).unwrap();
        assert_eq!(part.domain(), domain);
        for k in 0..=24 {
            let at = |[a, b]: [f64; 2], k: i32| a + (b - a) * f64::from(k) / 4.0;
            let uv = DVec2::new(at(domain[0], k % 5), at(domain[1], k / 5));
            assert!((part.point_at(uv).length() - 1.0).abs() < 1e-15);
            if uv.cmpge(DVec2::ZERO).all() && uv.cmple(DVec2::ONE).all() {
                assert!(part.point_at(uv).distance(made.point_at(uv)) < 1e-15);
            }
        }
    }

    #[test]
    fn rows_may_be_short_and_degrees_high() {
        // z = (1 − u)³² v: the coefficients go up to 6e8 and leave one control point.
        let mut rows: Vec<Vec<DVec3>> = vec![Vec::new(); 33];
        for (i, row) in rows.iter_mut().enumerate() {
            let sign = if i % 2 == 0 { 1.0 } else { -1.0 };
            *row = vec![DVec3::ZERO, sign * crate::math::bernstein::binomial(32, i) * DVec3::Z];
        }
        rows[0] = vec![DVec3::ZERO, DVec3::new(0.0, 1.0, 1.0)];
        rows[1][0] = DVec3::X;
        let made = NurbsSurface::from_powers(&rows, &[vec![1.0]], [[0.0, 1.0]; 2]).unwrap();
        assert_eq!(made.degree(), [32, 1]);
        for (k, point) in made.points().enumerate() {
            let expected = [(k / 2) as f64 / 32.0, (k % 2) as f64, if k == 1 { 1.0 } else { 0.0 }];
            assert!(point.distance(expected.into()) < 1e-15, "{k}: {point}");
        }
    }

    #[test]
    fn what_is_no_surface_is_told() {
        let flat = [vec![DVec3::ZERO, DVec3::Y], vec![DVec3::X]];
        let failed = |numerator: &[Vec<DVec3>], denominator: &[Vec<f64>], domain| {
            NurbsSurface::from_powers(numerator, denominator, domain).unwrap_err().to_string()
        };
        let unit = [[0.0, 1.0]; 2];
        let denominator = [vec![1.0], vec![-3.0], vec![3.0]];
        assert_eq!(
            failed(&flat, &denominator, unit),
            "the denominator's Bézier coefficient (1, 0) is -0.5: all must be positive, or all \
             negative; they may be so on a smaller domain"
        );
        let one = [vec![1.0]];
        assert!(failed(&flat[..1], &one, unit).starts_with("direction u: "));
        assert!(failed(&[vec![DVec3::X], vec![DVec3::Y]], &one, unit).starts_with("direction v: "));
        assert!(failed(&[], &[], unit).starts_with("direction u: "));
        assert!(failed(&flat, &one, [[0.0, 1.0], [2.0, 2.0]]).starts_with("direction v: "));
        let line = [vec![DVec3::ZERO, DVec3::X], vec![DVec3::X]];
        assert!(failed(&line, &one, unit).contains("no area"));
    }
}
