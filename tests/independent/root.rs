//! The truth about a place that a library calls a hit: how near the surface comes to the ray there.

use glam::{DMat2, DVec2, DVec3};
use nurbray::geometry::NurbsSurface;
use nurbray::math::Ray;

/// The number of steps. Newton's iteration doubles the digits each time; at a tangent point it
/// halves the error, and 60 halvings leave nothing of that.
const STEPS: usize = 60;

/// A place on a surface as near to a ray as can be found from a start, and its distance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    pub(crate) uv: DVec2,
    /// The parameter of the ray's point nearest to it.
    pub(crate) t: f64,
    /// The distance between both points.
    pub(crate) distance: f64,
}

/// Finds the least distance between a surface and a ray by Gauss and Newton's iteration, damped
/// (Levenberg 1944, Marquardt 1963) and kept in the closed domain. Evaluates the surface as
/// authored and shares nothing with the tracer.
pub(crate) fn nearest(surface: &NurbsSurface, ray: &Ray, start: DVec2) -> Nearest {
    let [[u0, u1], [v0, v1]] = surface.domain();
    let (low, high) = (DVec2::new(u0, v0), DVec2::new(u1, v1));
    let mut best = at(surface, ray, start.clamp(low, high));
    let mut damping = 0.0;
    for _ in 0..STEPS {
        let Some(step) = step(surface, ray, best.uv, damping, (low, high)) else { break };
        let next = at(surface, ray, (best.uv + step).clamp(low, high));
        if next.distance < best.distance {
            best = next;
            damping *= 0.1;
        } else {
            damping = f64::max(10.0 * damping, 1e-9);
        }
    }
    best
}

/// How far a place of a surface is from a ray.
pub(crate) fn at(surface: &NurbsSurface, ray: &Ray, uv: DVec2) -> Nearest {
    let along = ray.direction().normalize();
    let offset = surface.point_at(uv) - ray.origin();
    let length = offset.dot(along);
    let t = length / ray.direction().length();
    Nearest { uv, t, distance: (offset - length * along).length() }
}

/// The step that brings both together to first order. A parameter at its end stays there if
/// the step would leave the domain.
fn step(
    surface: &NurbsSurface,
    ray: &Ray,
    uv: DVec2,
    damping: f64,
    (low, high): (DVec2, DVec2),
) -> Option<DVec2> {
    let along = ray.direction().normalize();
    let (right, up) = along.any_orthonormal_pair();
    let at = surface.derivatives(uv);
    let across = |v: DVec3| DVec2::new(v.dot(right), v.dot(up));
    let gap = across(at.point - ray.origin());
    let mut columns = [across(at.du), across(at.dv)];
    for _ in 0..3 {
        let jacobian = DMat2::from_cols(columns[0], columns[1]);
        let normal = jacobian.transpose() * jacobian;
        let scale = normal.x_axis.x.max(normal.y_axis.y);
        let damped = normal + DMat2::from_diagonal(DVec2::splat((damping + 1e-16) * scale));
        let step = -(damped.inverse() * (jacobian.transpose() * gap));
        if !step.is_finite() {
            return None;
        }
        let leaves = |k: usize| {
            columns[k] != DVec2::ZERO
                && ((uv[k] <= low[k] && step[k] < 0.0) || (uv[k] >= high[k] && step[k] > 0.0))
        };
        match [leaves(0), leaves(1)] {
            [false, false] => return Some(step),
            [true, _] => columns[0] = DVec2::ZERO,
            [_, true] => columns[1] = DVec2::ZERO,
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use nurbray::geometry::shapes;

    use super::*;

    #[test]
    fn finds_roots_tangent_points_and_the_distance_of_misses() {
        let sphere = shapes::sphere(1.0).unwrap();
        let ray = |y: f64| Ray::new(DVec3::new(-5.0, y, 0.3), 2.0 * DVec3::X).unwrap();
        let start = |x: f64, y: f64, z: f64| {
            // The parameters of the nearest of many points.
            let [[u0, u1], [v0, v1]] = sphere.domain();
            let grid = (0..60).flat_map(|i| (0..60).map(move |j| (i, j))).map(|(i, j)| {
                let share = DVec2::new(f64::from(i), f64::from(j)) / 59.0;
                DVec2::new(u0, v0) + share * DVec2::new(u1 - u0, v1 - v0)
            });
            let far = |uv: &DVec2| sphere.point_at(*uv).distance(DVec3::new(x, y, z));
            grid.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap()
        };
        let reach = (1.0 - 0.09_f64).sqrt();
        let through = nearest(&sphere, &ray(0.2), start(-1.0, 0.2, 0.3));
        assert!(through.distance < 1e-15);
        assert!((through.t - 0.5 * (5.0 - (reach * reach - 0.04).sqrt())).abs() < 1e-14);
        let touching = nearest(&sphere, &ray(reach), start(0.1, reach, 0.3));
        assert!(touching.distance < 1e-14 && (touching.t - 2.5).abs() < 1e-6, "{touching:?}");
        let missing = nearest(&sphere, &ray(1.2), start(0.1, 0.9, 0.3));
        let gap = 1.44_f64.hypot(0.3).min((1.44_f64 + 0.09).sqrt()) - 1.0;
        assert!((missing.distance - gap).abs() < 1e-12, "{missing:?} {gap}");
    }
}
