//! Patches in matrix form.

use glam::DVec3;

use super::{NurbsSurface, SurfaceError};
use crate::geometry::knots::unit_knots;
use crate::geometry::{Direction, MatrixForm};

/// A polynomial surface piece in matrix form, `S(s, t) = [s³ s² s 1] M G Mᵀ [t³ t² t 1]ᵀ`, as
/// a bicubic Bézier patch on the unit square; `u` is `s` and runs over the rows of `G`.
///
/// # Errors
/// When a coordinate is not finite, or all points are on one line.
pub fn matrix_patch(
    form: MatrixForm,
    geometry: [[DVec3; 4]; 4],
) -> Result<NurbsSurface, SurfaceError> {
    matrix_surface(form, &geometry.map(Vec::from))
}

/// A polynomial surface piece in matrix form, `S(u, v) = [uᵐ … u 1] M G Mᵀ [vⁿ … v 1]ᵀ`, as a
/// Bézier patch on the unit square, for any of the form's [degrees](MatrixForm::degrees): `u` runs
/// over the rows of `G`, which are as long as each other.
///
/// The matrix of a Hermite patch is that of its corners `S`, its derivatives there, and its twists:
/// the rows are `S` at `u = 0` and `u = 1`, then `Sᵤ` there; the columns are the same for `v`.
///
/// # Errors
/// When the form has no segments with as many vectors as there are rows, or columns; when rows
/// differ in length, a coordinate is not finite, or all points are on one line.
pub fn matrix_surface(
    form: MatrixForm,
    geometry: &[Vec<DVec3>],
) -> Result<NurbsSurface, SurfaceError> {
    let columns = geometry.first().map_or(0, Vec::len);
    let ragged = geometry.iter().position(|row| row.len() != columns);
    if let Some(row) = ragged {
        let found = geometry[row].len();
        return Err(SurfaceError::GeometryRow { row, found, first: columns });
    }
    let along = |direction: Direction, vectors: &[DVec3]| {
        form.bezier_points(vectors).ok_or(SurfaceError::GeometryCount {
            direction,
            form: form.name(),
            found: vectors.len(),
            needed: form.vector_counts(),
        })
    };
    let size = [geometry.len(), columns];
    let rows: Vec<Vec<DVec3>> =
        geometry.iter().map(|row| along(Direction::V, row)).collect::<Result<_, _>>()?;
    let column = |j: usize| {
        let vectors: Vec<DVec3> = rows.iter().map(|row| row[j]).collect();
        along(Direction::U, &vectors)
    };
    if rows.is_empty() {
        along(Direction::U, &[])?;
    }
    let columns: Vec<Vec<DVec3>> = (0..size[1]).map(column).collect::<Result<_, _>>()?;
    let net = (0..size[0]).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
    let [knots_u, knots_v] = size.map(|count| unit_knots(count - 1));
    NurbsSurface::new(knots_u, knots_v, net, None)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;
    use crate::geometry::KnotVector;

    fn blended(form: MatrixForm, g: [DVec3; 4], t: f64) -> DVec3 {
        g.iter().zip(form.blending(t)).map(|(&point, weight)| weight * point).sum()
    }

    /// The transposition matters: `S M G Mᵀ Tᵀ`, tested where `M` is not symmetric.
    #[test]
    fn patches_blend_rows_and_columns() {
        let net = [0, 1, 2, 3].map(|i| {
            [0, 1, 2, 3]
                .map(|j| DVec3::new(f64::from(i), f64::from(j), f64::from((i * i + 2 * j) % 5)))
        });
        for form in MatrixForm::ALL {
            let patch = matrix_patch(form, net).unwrap();
            for (s, t) in [(0.0, 0.0), (0.3, 0.8), (1.0, 0.5), (0.25, 1.0)] {
                let rows = net.map(|row| blended(form, row, t));
                let off = patch.point_at(DVec2::new(s, t)).distance(blended(form, rows, s));
                assert!(off < 1e-14, "{form:?} at ({s}, {t}): off by {off:e}");
            }
        }
    }

    /// A Hermite patch has the corners, derivatives and twists of its matrix.
    #[test]
    fn hermite_patches_have_what_their_matrix_says() {
        let vector = |i: usize, j: usize| {
            let [i, j] = [i, j].map(|k| k as f64);
            DVec3::new(3.0 * i + j, 2.0 * j - i, 1.0 + i * i - 2.0 * i * j)
        };
        let rows: Vec<Vec<DVec3>> =
            (0..4).map(|i| (0..4).map(|j| vector(i, j)).collect()).collect();
        let patch = matrix_surface(MatrixForm::Hermite, &rows).unwrap();
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let at = patch.derivatives(DVec2::new(i as f64, j as f64));
            for (found, (i, j)) in [at.point, at.du, at.dv, at.duv].into_iter().zip([
                (i, j),
                (i + 2, j),
                (i, j + 2),
                (i + 2, j + 2),
            ]) {
                assert!(found.distance(rows[i][j]) < 1e-13, "({i}, {j}): {found}");
            }
        }
    }

    /// Patches of degrees 1 to 3 are those of the uniform B-spline, and Bézier patches.
    #[test]
    fn degrees_may_be_lower_and_differ() {
        let vector = |i: usize, j: usize| {
            let [i, j] = [i, j].map(|k| k as f64);
            DVec3::new(i, j + 0.1 * i * i, (i * 2.0 + j * 3.0) % 4.0)
        };
        for (m, n) in [(1, 1), (1, 2), (2, 1), (2, 2), (2, 3), (3, 1), (3, 3)] {
            let rows: Vec<Vec<DVec3>> =
                (0..=m).map(|i| (0..=n).map(|j| vector(i, j)).collect()).collect();
            let points = rows.concat();
            let knots = |degree| KnotVector::uniform(degree, degree + 1).unwrap();
            let spline = NurbsSurface::new(knots(m), knots(n), points.clone(), None).unwrap();
            let patch = matrix_surface(MatrixForm::BSpline, &rows).unwrap();
            assert_eq!(patch.degree(), [m, n]);
            for k in 0..25 {
                let uv = DVec2::new(f64::from(k % 5) / 4.0, f64::from(k / 5) / 4.0);
                let there = spline.point_at(uv + DVec2::new(m as f64, n as f64));
                assert!(patch.point_at(uv).distance(there) < 1e-14, "{m} × {n} at {uv}");
            }
            let bezier = NurbsSurface::new(unit_knots(m), unit_knots(n), points, None).unwrap();
            assert_eq!(matrix_surface(MatrixForm::Bezier, &rows).unwrap(), bezier);
        }
    }

    #[test]
    fn what_is_no_geometry_matrix_is_told() {
        let rows = |m: usize, n: usize| vec![vec![DVec3::ZERO; n]; m];
        let failed =
            |form, rows: &[Vec<DVec3>]| matrix_surface(form, rows).unwrap_err().to_string();
        assert_eq!(
            failed(MatrixForm::Hermite, &rows(3, 4)),
            "the geometry matrix has 3 vectors along u: the form hermite takes 4"
        );
        assert_eq!(
            failed(MatrixForm::BSpline, &rows(4, 5)),
            "the geometry matrix has 5 vectors along v: the form bspline takes 2, 3 or 4"
        );
        assert!(failed(MatrixForm::Bezier, &[]).contains("0 vectors along u"));
        assert!(failed(MatrixForm::Bezier, &rows(2, 0)).contains("0 vectors along v"));
        let mut ragged = rows(3, 3);
        ragged[2].pop();
        assert_eq!(
            failed(MatrixForm::Bezier, &ragged),
            "row 2 of the geometry matrix has 2 vectors, but row 0 has 3"
        );
        assert!(failed(MatrixForm::Bezier, &rows(2, 2)).contains("no extent"));
    }
}
