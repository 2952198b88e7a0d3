//! What the f32 search knows of a leaf.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::fit_error::FitError;
use crate::intersect::hierarchy::Hierarchy;
use crate::math::rounding;
use crate::patch::{LEAF_SLACK, Leaf, PatchSet, Piece};

/// Oriented boxes are grown by this length in scaled coordinates: it covers the rounding
/// of origin and direction to f32 over the distances a ray has inside the scene.
const GROWTH: f64 = 4e-6;

/// A leaf in the common form that all leaves are searched in, whatever their degree.
///
/// Box coordinates run from −1 to 1; `x` and `y` follow `s` and `t` from one end of the
/// leaf to the other. The surface is approximated by a bicubic polynomial in `x` and `y`,
/// relative to the leaf's middle, in scene units. It gives Newton's iteration a start; and since
/// its distance from the surface is bounded ([`FitError`]), it can prove of one ray that a part
/// of the leaf holds one root at most, or none (`single_proof`).
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(in crate::intersect) struct SearchRecord {
    /// Box coordinate `k` of a point `P` in scaled coordinates is `row_k · P − offset_k`.
    pub(super) rows: [[f32; 4]; 3],
    /// Coefficients of `xⁱ yʲ`, at `4 i + j`, coordinate by coordinate.
    pub(super) fit: [[f32; 16]; 3],
    /// The unit normal of the certificate.
    pub(super) normal: [f32; 3],
    /// The certificate's turning vectors.
    pub(super) turning: [[f32; 3]; 2],
    /// The smallest cosine, for an error of one scene unit, for which rounding is small
    /// against the leaf.
    pub(super) cosine_per_error: f32,
    /// The middle of the leaf.
    pub(super) middle: DVec3,
    /// The leaf's rectangle: binary fractions of few digits.
    rect: [[f32; 2]; 2],
    /// Bounds of the approximation, rounded up: see [`FitError`].
    pub(super) fit_error: f32,
    pub(super) slope_error: f32,
    pub(super) bend: f32,
    /// The leaf's piece.
    pub(super) piece: u32,
    /// Whether the leaf ends in a pole.
    has_pole: bool,
}

impl SearchRecord {
    pub(super) fn all(set: &PatchSet, hierarchy: &Hierarchy) -> Vec<Self> {
        let pieces = set.pieces();
        let leaves = set.leaves().par_iter();
        leaves.map(|leaf| Self::new(leaf, &pieces[leaf.piece as usize], hierarchy)).collect()
    }

    fn new(leaf: &Leaf, piece: &Piece, hierarchy: &Hierarchy) -> Self {
        let [s, t] = leaf.rect;
        let place = |x: f64, y: f64| {
            let at = |[from, to]: [f64; 2], x: f64| 0.5 * ((from + to) + x * (to - from));
            DVec2::new(at(s, x), at(t, y))
        };
        let middle = piece.patch.point(place(0.0, 0.0));
        let fit = fit(|x, y| piece.patch.point(place(x, y)) - middle);

        let error = FitError::new(leaf, piece, middle, &fit);

        let (center, rows) = leaf.oriented.rows();
        let (scene_center, scale) = hierarchy.frame();
        let rows = rows.map(|row| {
            // In scaled coordinates lengths are larger by `scale`, rows smaller; then grown.
            let row = row / scale;
            let row = row / (1.0 + GROWTH * row.length());
            let offset = row.dot((center - scene_center) * scale);
            [row.x as f32, row.y as f32, row.z as f32, offset as f32]
        });

        let certificate = &leaf.certificate;
        let cosine_per_error = (certificate.spread / (0.5 * LEAF_SLACK)) as f32 * 1.001;
        let turning = certificate.turning.map(|turning| turning.as_vec3().to_array());
        let normal = certificate.normal.as_vec3().to_array();
        // Halved at most `MOST_HALVINGS` times, the ends are numbers of f32.
        let rect = leaf.rect.map(|range| range.map(|end| end as f32));
        let piece = leaf.piece;
        Self {
            rows,
            fit,
            normal,
            turning,
            cosine_per_error,
            middle,
            rect,
            fit_error: rounding::f32_above(error.value),
            slope_error: rounding::f32_above(error.slope),
            bend: rounding::f32_above(error.bend),
            piece,
            has_pole: certificate.pole.is_some(),
        }
    }

    /// The lengths, about, of the half sides in `x` and `y`.
    pub(super) fn side_lengths(&self) -> [f32; 2] {
        [4, 1].map(|k| {
            let [x, y, z] = [self.fit[0][k], self.fit[1][k], self.fit[2][k]];
            (x * x + y * y + z * z).sqrt()
        })
    }

    /// Whether the leaf ends in a pole, near which its certificate has conditions of its own.
    pub(in crate::intersect) fn has_pole(&self) -> bool {
        self.has_pole
    }

    /// The leaf's piece.
    pub(in crate::intersect) fn piece(&self) -> u32 {
        self.piece
    }

    /// The part of the piece's unit square: from and to in `s`, then in `t`.
    pub(super) fn rect(&self) -> [[f64; 2]; 2] {
        self.rect.map(|range| range.map(f64::from))
    }
}

/// The bicubic polynomial through a map's values at 4 × 4 Chebyshev points of `[−1, 1]²`,
/// near the best approximation there is (Trefethen 2013, ch. 16).
fn fit(map: impl Fn(f64, f64) -> DVec3) -> [[f32; 16]; 3] {
    let nodes = [1.0, 3.0, 5.0, 7.0].map(|k: f64| (k * std::f64::consts::PI / 8.0).cos());
    let inverse = interpolation(nodes);
    let values: [[DVec3; 4]; 4] = nodes.map(|x| nodes.map(|y| map(x, y)));
    let mut fit = [[0.0; 16]; 3];
    for i in 0..4 {
        for j in 0..4 {
            let mut coefficient = DVec3::ZERO;
            for a in 0..4 {
                for b in 0..4 {
                    coefficient += inverse[i][a] * inverse[j][b] * values[a][b];
                }
            }
            for axis in 0..3 {
                fit[axis][4 * i + j] = coefficient[axis] as f32;
            }
        }
    }
    fit
}

/// The matrix that takes values at four nodes to power coefficients: column `a` holds the
/// coefficients of the Lagrange polynomial that is 1 at node `a`.
fn interpolation(nodes: [f64; 4]) -> [[f64; 4]; 4] {
    let mut matrix = [[0.0; 4]; 4];
    for a in 0..4 {
        let mut polynomial = [1.0, 0.0, 0.0, 0.0];
        let mut degree = 0;
        for b in (0..4).filter(|&b| b != a) {
            let scale = 1.0 / (nodes[a] - nodes[b]);
            degree += 1;
            for k in (0..=degree).rev() {
                let lower = if k > 0 { polynomial[k - 1] } else { 0.0 };
                polynomial[k] = (lower - nodes[b] * polynomial[k]) * scale;
            }
        }
        for k in 0..4 {
            matrix[k][a] = polynomial[k];
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bicubic_maps_are_fitted_exactly() {
        let map = |x: f64, y: f64| DVec3::new(x * x * x * y, 1.0 - y * y * y, x - 2.0 * x * x * y);
        let fit = fit(map);
        let expected = [(0, 13, 1.0), (1, 0, 1.0), (1, 3, -1.0), (2, 4, 1.0), (2, 9, -2.0)];
        for axis in 0..3 {
            for k in 0..16 {
                let wanted = expected.iter().find(|e| (e.0, e.1) == (axis, k)).map_or(0.0, |e| e.2);
                assert!((fit[axis][k] - wanted).abs() < 1e-6, "{axis} {k}");
            }
        }
    }
}
