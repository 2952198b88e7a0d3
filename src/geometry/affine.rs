//! Affine maps: whether they can move a surface, and what they do to points and lengths.

use glam::{DAffine3, DVec4, Vec4Swizzles};

/// The determinant of a finite map, if the map flattens space or enlarges it beyond the range of
/// f64; else `None`.
pub(crate) fn unfit_determinant(map: &DAffine3) -> Option<f64> {
    let determinant = map.matrix3.determinant();
    (!determinant.is_normal()).then_some(determinant)
}

/// A homogeneous point moved by an affine map.
pub(crate) fn moved(map: &DAffine3, point: &DVec4) -> DVec4 {
    (map.matrix3 * point.xyz() + point.w * map.translation).extend(point.w)
}

/// An upper bound of the factor by which a map lengthens distances. The square of the largest
/// singular value of `M` is the largest eigenvalue of `MᵀM`, which is no larger than the largest
/// row sum of magnitudes of that matrix. For rotations and scalings the bound is the factor itself.
pub(crate) fn stretch(map: &DAffine3) -> f64 {
    let squares = map.matrix3.transpose() * map.matrix3; // symmetric
    let sums = squares.to_cols_array_2d().map(|column| column.iter().map(|x| x.abs()).sum::<f64>());
    sums.into_iter().fold(0.0, f64::max).sqrt()
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DQuat, DVec3};

    use super::*;

    #[test]
    fn a_stretch_is_what_the_map_does_to_its_longest_vector() {
        let turned = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -1.2, 2.0);
        let scales = DVec3::new(2.0, 0.5, 1.0);
        let moved = DAffine3::from_scale_rotation_translation(scales, turned, DVec3::ONE);
        assert!((stretch(&moved) - 2.0).abs() < 1e-15);
        assert_eq!(stretch(&DAffine3::from_translation(DVec3::X)), 1.0);
        // A shear: its largest singular value is the golden ratio.
        let shear = DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z);
        let longest = 0.5 * (1.0 + 5f64.sqrt());
        let bound = stretch(&DAffine3::from_mat3(shear));
        assert!((longest..1.1 * longest).contains(&bound), "{bound}");
    }
}
