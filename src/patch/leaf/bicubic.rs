//! Bicubic polynomials: the coefficients by which leaves are approximated.

use std::ops::{AddAssign, Mul};

use glam::{DVec3, DVec4};

/// Coefficients of `xⁱ yʲ`, at `4 i + j`, coordinate by coordinate.
pub(crate) type Fit = [[f32; 16]; 3];

/// Coefficients of the weight that a [`Fit`] is divided by, at the same places: the first is 1.
pub(crate) type WeightFit = [f32; 16];

/// The weight of an approximation that is not divided: 1.
pub(super) const NO_WEIGHT: WeightFit = {
    let mut weight = [0.0; 16];
    weight[0] = 1.0;
    weight
};

/// Whether all terms of degree three in `x` or `y` are zero.
pub(super) fn is_biquadratic(fit: &Fit, weight: &WeightFit) -> bool {
    let rows = fit.iter().chain([weight]).flat_map(|of| of.iter().enumerate());
    rows.filter(|(m, _)| m / 4 == 3 || m % 4 == 3).all(|(_, &term)| term == 0.0)
}

/// The second derivatives of a quotient in the middle, where its numerators are zero and its weight
/// is 1: by `xx`, `xy` and `yy`, from the coefficients of these and of `x` and `y`.
#[inline(always)]
pub(super) fn second_derivatives([x, y]: [DVec4; 2], [xx, xy, yy]: [DVec4; 3]) -> [DVec3; 3] {
    let (s_x, s_y) = (x.truncate(), y.truncate());
    [
        2.0 * xx.truncate() - 2.0 * x.w * s_x,
        xy.truncate() - x.w * s_y - y.w * s_x,
        2.0 * yy.truncate() - 2.0 * y.w * s_y,
    ]
}

/// A linear map of four numbers applied to the columns of a net, then to its rows.
pub(super) fn in_both_directions<V>(matrix: &[[f64; 4]; 4], net: &[[V; 4]; 4]) -> [[V; 4]; 4]
where
    V: Copy + Default + AddAssign,
    f64: Mul<V, Output = V>,
{
    let mut columns = [[V::default(); 4]; 4];
    let mut both = columns;
    for i in 0..4 {
        for a in 0..4 {
            for b in 0..4 {
                columns[i][b] += matrix[i][a] * net[a][b];
            }
        }
        for j in 0..4 {
            for b in 0..4 {
                both[i][j] += matrix[j][b] * columns[i][b];
            }
        }
    }
    both
}
