//! How much a surface bends.

use super::SurfaceDerivatives;

/// How much a surface bends at a point, in one over length.
///
/// Positive where it bends towards its normal `Sᵤ × Sᵥ`, negative where it bends away: a ball whose
/// normals point outwards has twice the curvature `−1 / r`. Reversing a surface changes the signs,
/// but for that of the Gaussian curvature.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceCurvature {
    /// The curvatures of the normal sections that bend least and most, `κ₁ ≤ κ₂`.
    pub principal: [f64; 2],
    /// The Gaussian curvature `K = κ₁ κ₂`, in one over length squared.
    pub gaussian: f64,
    /// The mean curvature `H = (κ₁ + κ₂) / 2`.
    pub mean: f64,
}

impl SurfaceDerivatives {
    /// The principal, Gaussian and mean curvature.
    ///
    /// They are those of the second fundamental form `h` in an orthonormal basis of the tangent
    /// plane, `e₁` along `Sᵤ` (do Carmo 1976, sections 3-2 and 3-3). With `Sᵤ = a e₁` and
    /// `Sᵥ = b e₁ + c e₂`, the derivatives along `e₁` and `e₂` are `∂ᵤ / a` and
    /// `(∂ᵥ − (b / a) ∂ᵤ) / c`; so
    ///
    /// `h₁₁ = n · Sᵤᵤ / a²`, `h₁₂ = n · (Sᵤᵥ − (b / a) Sᵤᵤ) / (a c)`,
    /// `h₂₂ = n · (Sᵥᵥ − 2 (b / a) Sᵤᵥ + (b / a)² Sᵤᵤ) / c²`.
    ///
    /// The code divides by one length at a time, so that models of any size are measured alike. The
    /// error is a few roundings of `|Sᵤᵤ| / a²` and the like, over the square of the sine of the
    /// angle between `Sᵤ` and `Sᵥ`.
    ///
    /// `None` where `Sᵤ × Sᵥ` vanishes within rounding, as at poles, even if the surface is smooth
    /// there: the curvature then depends on higher derivatives.
    pub fn curvature(&self) -> Option<SurfaceCurvature> {
        let normal = self.regular_normal()?;
        let a = self.du.length();
        let e1 = self.du / a;
        let (slope, c) = (e1.dot(self.dv) / a, normal.cross(e1).dot(self.dv));
        let [uu, uv, vv] = [self.duu, self.duv, self.dvv].map(|second| second.dot(normal));
        let across = uv - slope * uu;
        let (h11, h12) = (uu / a / a, across / a / c);
        let h22 = (vv - slope * uv - slope * across) / c / c;

        let mean = h11 / 2.0 + h22 / 2.0;
        let radius = ((h11 - h22) / 2.0).hypot(h12);
        let gaussian = h11 * h22 - h12 * h12;
        let curvature =
            SurfaceCurvature { principal: [mean - radius, mean + radius], gaussian, mean };
        (mean.is_finite() && radius.is_finite()).then_some(curvature)
    }
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DMat3, DVec2, DVec3};

    use super::*;
    use crate::geometry::{KnotVector, NurbsSurface, shapes};

    /// Asserts curvatures, up to a share of `1 / size`, at a point.
    #[track_caller]
    fn assert_bends(at: &SurfaceDerivatives, principal: [f64; 2], size: f64) {
        let found = at.curvature().unwrap();
        let [least, most] = principal;
        let error = |found: f64, known: f64| (found - known).abs() * size;
        let errors = [
            error(found.principal[0], least),
            error(found.principal[1], most),
            error(found.mean, (least + most) / 2.0),
            error(found.gaussian * size, least * most * size),
        ];
        assert!(errors.iter().all(|error| *error < 1e-12), "{found:?}, not {principal:?}");
    }

    fn inside() -> impl Iterator<Item = (f64, f64)> {
        (1..10).flat_map(|i| (1..10).map(move |j| (0.1 * f64::from(i), 0.1 * f64::from(j))))
    }

    #[test]
    fn quadrics_bend_as_their_radii_say() {
        for size in [1e-8, 1.0, 1e8] {
            let (sphere, cylinder) = (shapes::sphere(size), shapes::cylinder(size, 3.0 * size));
            let (sphere, cylinder) = (sphere.unwrap(), cylinder.unwrap());
            for (s, t) in inside() {
                let at = |surface: &NurbsSurface| {
                    let [u, v] = surface.domain();
                    surface
                        .derivatives(DVec2::new(u[0] + s * (u[1] - u[0]), v[0] + t * (v[1] - v[0])))
                };
                assert_bends(&at(&sphere), [-1.0 / size; 2], size);
                assert_bends(&at(&sphere.reversed_u()), [1.0 / size; 2], size);
                assert_bends(&at(&cylinder), [-1.0 / size, 0.0], size);
                assert_bends(&at(&cylinder.swapped()), [0.0, 1.0 / size], size);
            }
        }
    }

    /// The graph of `z = x y`, with parameters along its axes and slanting.
    #[test]
    fn saddles_bend_both_ways() {
        let line = || KnotVector::bezier(1).unwrap();
        let corners = [[0.0, 0.0], [0.0, 1.0], [1.0, 0.0], [1.0, 1.0]];
        let points = corners.map(|[x, y]| DVec3::new(x, y, x * y)).to_vec();
        let saddle = NurbsSurface::new(line(), line(), points, None).unwrap();
        for (x, y) in inside() {
            let at = saddle.derivatives(DVec2::new(x, y));
            let slope = 1.0 + x * x + y * y;
            let (gaussian, mean) = (-1.0 / (slope * slope), -x * y / slope.powf(1.5));
            let radius = (mean * mean - gaussian).sqrt();
            assert_bends(&at, [mean - radius, mean + radius], 1.0);

            // The same surface in the parameters s, t with u = 3 s + 2 t, v = s + 5 t.
            let (du, dv) = (3.0 * at.du + at.dv, 2.0 * at.du + 5.0 * at.dv);
            let [duu, duv, dvv] = [6.0 * at.duv, 17.0 * at.duv, 20.0 * at.duv];
            let slanting = SurfaceDerivatives { point: at.point, du, dv, duu, duv, dvv };
            assert_bends(&slanting, [mean - radius, mean + radius], 1.0);
        }
    }

    #[test]
    fn moving_changes_nothing_and_poles_have_no_answer() {
        let map = DAffine3::from_mat3_translation(
            DMat3::from_rotation_y(0.7) * DMat3::from_rotation_x(1.9),
            DVec3::new(3.0, -2.0, 1.0),
        );
        let moved = shapes::torus(3.0, 1.0).unwrap().transformed(&map).unwrap();
        for (s, t) in inside() {
            let [u, v] = moved.domain();
            let at =
                moved.derivatives(DVec2::new(u[0] + s * (u[1] - u[0]), v[0] + t * (v[1] - v[0])));
            // The distance from the axis decides the second curvature: n · (away from it) / it.
            let axis = map.matrix3 * DVec3::Z;
            let from_center = at.point - map.translation;
            let away = from_center - from_center.dot(axis) * axis;
            let normal = at.unit_normal(glam::DVec2::ZERO).unwrap();
            let around = -normal.dot(away) / away.length_squared();
            assert_bends(&at, [-1.0, around], 1.0);
        }
        let sphere = shapes::sphere(1.0).unwrap();
        let [u, v] = sphere.domain();
        let ends = [(u[0], v[0]), (u[0], v[1]), (u[1], v[0]), (u[1], v[1])];
        let poles = ends.map(|(u, v)| sphere.derivatives(DVec2::new(u, v)));
        assert!(poles.iter().all(|at| at.point.z.abs() < 1.0 || at.curvature().is_none()));
        assert!(poles.iter().any(|at| at.curvature().is_none()));
    }
}
