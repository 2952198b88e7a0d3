//! An octant of a sphere as one quartic triangle.

use std::f64::consts::SQRT_2;

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::{ShapeError, check_length};
use crate::geometry::TrianglePatch;
use crate::math::bernstein::binomial;

/// The constants of a quartic triangle, symmetric in its three parameters, that is an octant of
/// the unit sphere: coordinates `a₀, a₁, a₂` and weights `b₀ … b₃` (those of the corners, next
/// to the corners, in the middle of the sides, inside).
///
/// The control points with exponents (4, 0, 0), (3, 1, 0), (2, 2, 0), (2, 1, 1) are `(1, 0, 0)`,
/// `(1, a₀, 0)`, `(a₁, a₁, 0)`, `(1, a₂, a₂)`; the others follow by symmetry.
///
/// # Invariant, checked once on construction
/// All constants are positive. The polynomial `x² + y² + z² − w²` of the homogeneous coordinates,
/// of degree 8, is zero to rounding. All `b` may have a common factor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OctantConstants {
    a: [f64; 3],
    b: [f64; 4],
}

/// The polynomial counts as zero if its Bernstein coefficients are no more than this share of their
/// terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// The exponents of a quartic triangle, which add up to 4, in the order of [`TrianglePatch`].
fn exponents() -> impl Iterator<Item = [usize; 3]> {
    (0..=4).flat_map(|i| (0..=4 - i).map(move |j| [i, j, 4 - i - j]))
}

/// `n! / (i! j! k!)` with `n = i + j + k`.
fn trinomial([i, j, k]: [usize; 3]) -> f64 {
    binomial(i + j + k, i) * binomial(j + k, j)
}

impl OctantConstants {
    /// The constants of G. Farin, "Curves and Surfaces for Computer Aided Geometric Design", 2nd
    /// edition, 1990, as in D. Eberly, "Representing a Circle or a Sphere with NURBS", 3.1.2.
    pub fn farin() -> Self {
        let root = 3.0_f64.sqrt();
        let a0 = (root - 1.0) / root;
        let a1 = (root + 1.0) / (2.0 * root);
        let a2 = 1.0 - (5.0 - SQRT_2) * (7.0 - root) / 46.0;
        let b0 = 4.0 * root * (root - 1.0);
        let b1 = 3.0 * SQRT_2;
        let b2 = 4.0;
        let b3 = SQRT_2 * (3.0 + 2.0 * SQRT_2 - root) / root;
        Self { a: [a0, a1, a2], b: [b0, b1, b2, b3] }
    }

    /// The constants `a₀ … a₂` and `b₀ … b₃`, if they make an octant.
    ///
    /// # Errors
    /// When one is not from 1e-70 to 1e70, or the patch is not on the sphere; the error says by
    /// how much, and where.
    pub fn new(a: [f64; 3], b: [f64; 4]) -> Result<Self, ShapeError> {
        const NAMES: [&str; 7] = ["a0", "a1", "a2", "b0", "b1", "b2", "b3"];
        for (name, value) in NAMES.into_iter().zip(a.into_iter().chain(b)) {
            check_length(name, value)?;
        }
        let constants = Self { a, b };
        let (exponents, residual) = constants.residual();
        // A common factor of the weights changes nothing.
        let tolerance = ROUNDING;
        if residual.abs() > tolerance {
            return Err(ShapeError::Octant { a, b, exponents, residual, tolerance });
        }
        Ok(constants)
    }

    /// `a₀, a₁, a₂`.
    pub fn a(&self) -> [f64; 3] {
        self.a
    }

    /// `b₀, b₁, b₂, b₃`.
    pub fn b(&self) -> [f64; 4] {
        self.b
    }

    /// The control points `(w x, w y, w z, w)` on the unit sphere.
    ///
    /// The weight depends on the largest exponent and on whether the point is inside the triangle;
    /// a coordinate depends on these and on its own exponent.
    fn control(&self) -> impl Iterator<Item = DVec4> {
        let Self { a: [a0, a1, a2], b: [b0, b1, b2, b3] } = *self;
        exponents().map(move |[i, j, k]| {
            let largest = i.max(j).max(k);
            let inner = i.min(j).min(k) > 0;
            let coordinate = |exponent: usize| match (exponent, largest) {
                (0, _) => 0.0,
                (2, 2) if !inner => a1,
                (exponent, largest) if exponent == largest => 1.0,
                (_, 3) => a0,
                (_, _) => a2,
            };
            let weight = match largest {
                4 => b0,
                3 => b1,
                _ if !inner => b2,
                _ => b3,
            };
            let point = DVec3::new(coordinate(i), coordinate(j), coordinate(k));
            (weight * point).extend(weight)
        })
    }

    /// The exponents of the Bernstein coefficient of `x² + y² + z² − w²` that is the largest share
    /// of its terms, and that share.
    fn residual(&self) -> ([usize; 3], f64) {
        let control: Vec<([usize; 3], DVec4)> = exponents().zip(self.control()).collect();
        let mut sums = [[(0.0, 0.0); 9]; 9];
        for &(m, p) in &control {
            for &(n, q) in &control {
                let sum = [m[0] + n[0], m[1] + n[1], m[2] + n[2]];
                // B_m B_n is `share` times B_{m+n}.
                let share = trinomial(m) * trinomial(n) / trinomial(sum);
                let (value, size) = &mut sums[sum[0]][sum[1]];
                *value += share * (p.xyz().dot(q.xyz()) - p.w * q.w);
                *size += share * (p.xyz().dot(q.xyz()) + p.w * q.w);
            }
        }
        let all = (0..=8).flat_map(|i| (0..=8 - i).map(move |j| [i, j, 8 - i - j]));
        let shares = all.map(|[i, j, k]| ([i, j, k], sums[i][j].0 / sums[i][j].1));
        shares.fold(
            ([0; 3], 0.0),
            |most, next| {
                if next.1.abs() > most.1.abs() { next } else { most }
            },
        )
    }

    /// The octant `x, y, z ≥ 0` of a sphere of this radius around the origin, facing outward.
    ///
    /// The corner `u = 1` is on the x axis, `v = 1` on the y axis, `w = 1 − u − v = 1` on the z
    /// axis. Its sides are quarter circles of degree 4, those of
    /// [`QuarticConstants`](super::QuarticConstants) with `w₁ = b₁/b₀`.
    ///
    /// # Errors
    /// When the radius is not from 1e-70 to 1e70.
    pub fn octant(&self, radius: f64) -> Result<TrianglePatch, ShapeError> {
        check_length("radius", radius)?;
        let control = self.control().map(|point| (radius * point.xyz()).extend(point.w));
        // The constants are valid: only the radius can make this fail.
        TrianglePatch::from_homogeneous(4, control.collect())
            .map_err(|_| ShapeError::Length { measure: "radius", value: radius })
    }
}

/// The octant `x, y, z ≥ 0` of a sphere around the origin as a rational quartic triangle,
/// symmetric in its three parameters, facing outward: [`OctantConstants::octant`] with Farin's
/// constants.
///
/// # Errors
/// When the radius is not from 1e-70 to 1e70.
pub fn octant_quartic(radius: f64) -> Result<TrianglePatch, ShapeError> {
    OctantConstants::farin().octant(radius)
}

#[cfg(test)]
mod tests {
    use glam::DVec2;

    use super::*;

    #[test]
    fn farin_s_constants_satisfy_the_constraint_at_any_scale_of_the_weights() {
        let farin = OctantConstants::farin();
        for factor in [1e-8, 0.3, 1.0, 7.0, 1e8] {
            let scaled = OctantConstants::new(farin.a, farin.b.map(|b| factor * b)).unwrap();
            let (a, b) = (scaled.octant(2.0).unwrap(), octant_quartic(2.0).unwrap());
            for (u, v) in [(0.0, 0.0), (0.2, 0.3), (0.5, 0.5), (0.1, 0.9)] {
                assert!(
                    a.point_at(DVec2::new(u, v)).distance(b.point_at(DVec2::new(u, v))) < 2e-15
                );
            }
        }
    }

    /// Each constant matters, and the residual of refused constants is about as large as the
    /// change.
    #[test]
    fn constants_that_make_no_sphere_are_refused() {
        let farin = OctantConstants::farin();
        for index in 0..7 {
            let (mut a, mut b) = (farin.a, farin.b);
            for step in [1e-11, 1e-3] {
                let value = if index < 3 { &mut a[index] } else { &mut b[index - 3] };
                *value *= 1.0 + step;
                let Err(ShapeError::Octant { residual, .. }) = OctantConstants::new(a, b) else {
                    panic!("constant {index} by {step:e}")
                };
                let size = residual.abs() / step;
                assert!((0.01..4.0).contains(&size), "constant {index}: {residual:e}");
            }
        }
        let message = |a, b| OctantConstants::new(a, b).unwrap_err().to_string();
        assert_eq!(
            message([0.4, farin.a[1], farin.a[2]], farin.b),
            "the constants a = [0.4, 0.7886751345948129, 0.5893534615581059], \
             b = [5.0717967697244895, 4.242640687119286, 4, 3.3446772571685868] make no sphere: of x² + y² + z² - w², a polynomial of degree 8 that must be 0, the coefficient \
             at (0, 4, 4) is -0.0109595 of its terms, more than 1.4e-14; Farin's (1990) are \
             a = [0.4226497308103742, 0.7886751345948129, 0.5893534615581059], \
             b = [5.0717967697244895, 4.242640687119286, 4, 3.3446772571685868]"
        );
        assert_eq!(
            message(farin.a, [farin.b[0], 0.0, farin.b[2], farin.b[3]]),
            "b1 0: it must be positive and finite (from 1e-70 to 1e70)"
        );
        assert!(OctantConstants::new([f64::NAN; 3], farin.b).is_err());
    }
}
