//! Transforms that place objects.

use glam::{DAffine3, DMat3, DVec3};
use thiserror::Error;

use super::{Place, Written};
use crate::math::angle::sin_cos_degrees;
use crate::math::{ShownVector, unit};

/// One step in placing an object.
///
/// A mirror (a negative scale, say) turns surfaces inside out: `(u, v)` stay as authored, and
/// S_u × S_v, which pointed out of a body, points into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transform {
    /// Moves by a vector.
    Translate(DVec3),
    /// Turns about an axis through the origin, counter-clockwise as seen from its tip.
    Rotate {
        /// The axis, any length.
        axis: DVec3,
        /// The angle.
        degrees: f64,
    },
    /// Stretches along x, y and z, from the origin.
    Scale(DVec3),
    /// Maps `(x, y, z)` to the three rows' dot products with `(x, y, z, 1)`.
    Matrix([[f64; 4]; 3]),
}

/// Why a step is not a transform of space.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum TransformError {
    /// A number is NaN or infinite.
    #[error("a transform needs finite numbers")]
    NotFinite,
    /// The rotation has no axis.
    #[error("rotate: the axis (0, 0, 0) has no direction")]
    NoAxis,
    /// The scale is zero along an axis.
    #[error("scale {} flattens space: no factor may be 0", ShownVector(*.0))]
    NoScale(DVec3),
    /// The matrix is singular.
    #[error("the matrix flattens space: its determinant is 0 within rounding")]
    Singular,
}

/// The determinant of three unit columns is computed with a few rounding errors: a value no
/// larger than this cannot be told from zero.
const SINGULAR: f64 = 16.0 * f64::EPSILON;

/// All steps of a transform, the first one first, as one map.
///
/// # Errors
/// When a step is not a transform of space; the error is that of the first such step, with its
/// place.
pub(crate) fn placed(steps: &[Written<Transform>]) -> Result<DAffine3, (&Place, TransformError)> {
    steps.iter().try_fold(DAffine3::IDENTITY, |before, step| {
        Ok(step.value.affine().map_err(|error| (&step.place, error))? * before)
    })
}

impl Transform {
    /// The affine map, target from source.
    ///
    /// # Errors
    /// When it is not invertible or not finite.
    pub fn affine(&self) -> Result<DAffine3, TransformError> {
        let affine = match *self {
            Self::Translate(by) => DAffine3::from_translation(by),
            Self::Rotate { axis, degrees } => {
                if axis == DVec3::ZERO {
                    return Err(TransformError::NoAxis);
                }
                let axis = unit(axis).ok_or(TransformError::NotFinite)?;
                DAffine3::from_mat3(rotation(axis, degrees))
            }
            Self::Scale(by) => {
                if by.to_array().contains(&0.0) {
                    return Err(TransformError::NoScale(by));
                }
                DAffine3::from_scale(by)
            }
            Self::Matrix(rows) => {
                let column = |k: usize| DVec3::new(rows[0][k], rows[1][k], rows[2][k]);
                let linear = DMat3::from_cols(column(0), column(1), column(2));
                DAffine3::from_mat3_translation(linear, column(3))
            }
        };
        if !affine.is_finite() {
            return Err(TransformError::NotFinite);
        }
        if singular(&affine.matrix3) { Err(TransformError::Singular) } else { Ok(affine) }
    }
}

/// Whether a matrix flattens space, whatever the lengths of its columns.
fn singular(m: &DMat3) -> bool {
    let columns = [m.x_axis, m.y_axis, m.z_axis].map(|column| unit(column).unwrap_or_default());
    let [x, y, z] = columns;
    DMat3::from_cols(x, y, z).determinant().abs() <= SINGULAR
}

/// Rotation about a unit axis (Rodrigues), exact for multiples of 90° about x, y and z.
fn rotation(axis: DVec3, degrees: f64) -> DMat3 {
    let (sin, cos) = sin_cos_degrees(degrees);
    let [x, y, z] = axis.to_array();
    let cross = DMat3::from_cols_array(&[0.0, z, -y, -z, 0.0, x, y, -x, 0.0]);
    let outer = DMat3::from_cols(axis * x, axis * y, axis * z);
    DMat3::IDENTITY * cos + cross * sin + outer * (1.0 - cos)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn right_angles_are_exact() {
        let turn = |axis, degrees| Transform::Rotate { axis, degrees }.affine().unwrap();
        assert_eq!(turn(DVec3::Z * 7.0, 90.0).transform_vector3(DVec3::X), DVec3::Y);
        assert_eq!(turn(DVec3::X, 450.0).transform_vector3(DVec3::Y), DVec3::Z);
        assert_eq!(turn(DVec3::Y, -90.0).transform_vector3(DVec3::X), DVec3::Z);
        assert_eq!(turn(DVec3::Z, 180.0).transform_vector3(DVec3::X), -DVec3::X);
        assert_eq!(turn(DVec3::Z, 270.0).transform_vector3(DVec3::X), -DVec3::Y);
    }

    #[test]
    fn rotations_agree_with_glam_for_any_angle() {
        for degrees in [-1000.0, -133.7, -45.0, 1e-9, 30.0, 89.999, 200.0, 1e6] {
            let axis = DVec3::new(1.0, -2.0, 0.5);
            let ours = Transform::Rotate { axis, degrees }.affine().unwrap().matrix3;
            let reduced = (degrees % 360.0_f64).to_radians();
            let theirs = DMat3::from_axis_angle(axis.normalize(), reduced);
            assert!(ours.abs_diff_eq(theirs, 4e-15), "{degrees}: {ours} {theirs}");
        }
    }

    #[test]
    fn a_matrix_is_written_by_rows() {
        let rows = [[0.0, -2.0, 0.0, 5.0], [1.0, 0.0, 0.0, 6.0], [0.0, 0.0, 1.0, 7.0]];
        let affine = Transform::Matrix(rows).affine().unwrap();
        assert_eq!(affine.transform_point3(DVec3::new(1.0, 1.0, 1.0)), DVec3::new(3.0, 7.0, 8.0));
    }

    #[test]
    fn small_and_lopsided_is_not_singular_but_flat_is() {
        for size in [1e-100, 1e-8, 1.0, 1e8, 1e100] {
            assert!(Transform::Scale(DVec3::splat(size)).affine().is_ok(), "{size}");
            assert!(Transform::Scale(DVec3::new(size, 1.0, -1.0)).affine().is_ok(), "{size}");
            let flat = [[1.0, 2.0, 3.0, 0.0], [4.0, 5.0, 6.0, 0.0], [7.0, 8.0, 9.0, 0.0]];
            let flat = flat.map(|row| row.map(|x| x * size));
            assert_eq!(Transform::Matrix(flat).affine(), Err(TransformError::Singular), "{size}");
        }
    }

    #[test]
    fn messages() {
        let message = |transform: Transform| transform.affine().unwrap_err().to_string();
        assert_eq!(
            message(Transform::Scale(DVec3::new(1.0, 0.0, 2.0))),
            "scale (1, 0, 2) flattens space: no factor may be 0"
        );
        assert_eq!(
            message(Transform::Rotate { axis: DVec3::ZERO, degrees: 3.0 }),
            "rotate: the axis (0, 0, 0) has no direction"
        );
        assert_eq!(
            message(Transform::Matrix([[0.0; 4]; 3])),
            "the matrix flattens space: its determinant is 0 within rounding"
        );
        assert_eq!(message(Transform::Translate(DVec3::NAN)), "a transform needs finite numbers");
    }
}
