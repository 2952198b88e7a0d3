//! Bicubic patches in matrix form.

use glam::DVec3;

use super::{NurbsSurface, SurfaceError};
use crate::geometry::MatrixForm;
use crate::geometry::knots::unit_knots;

/// A polynomial surface piece in matrix form, `S(s, t) = [s³ s² s 1] M G Mᵀ [t³ t² t 1]ᵀ`, as
/// a bicubic Bézier patch on the unit square; `u` is `s` and runs over the rows of `G`.
///
/// # Errors
/// When a coordinate is not finite, or all points are on one line.
pub fn matrix_patch(
    form: MatrixForm,
    geometry: [[DVec3; 4]; 4],
) -> Result<NurbsSurface, SurfaceError> {
    let rows = geometry.map(|row| form.to_bezier(row));
    let columns = [0, 1, 2, 3].map(|j| form.to_bezier(rows.map(|row| row[j])));
    let net = (0..4).flat_map(|i| columns.map(|column| column[i])).collect();
    NurbsSurface::new(unit_knots(3), unit_knots(3), net, None)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

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
}
