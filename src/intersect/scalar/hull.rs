//! The hull of a leaf's control points, as a ray sees it.

use glam::{DVec2, DVec3, DVec4, Vec3Swizzles};

use crate::math::{RayFrame, bernstein};
use crate::patch::{Leaf, Piece};

/// The control points of a leaf without its slack, in the coordinates of a ray. Since all weights
/// are positive there, their hull contains the whole leaf.
#[derive(Debug)]
pub(super) struct Hull(Vec<DVec3>);

impl Hull {
    pub(super) fn of(leaf: &Leaf, piece: &Piece, ray: &RayFrame) -> Self {
        let mut net: Vec<DVec4> = piece.patch.control().collect();
        let [s, t] = leaf.rect();
        bernstein::restrict_net(&mut net, piece.patch.degree(), s, t);
        Self(net.into_iter().map(|c| ray.coordinates(c.project())).collect())
    }

    /// Whether a plane parallel to the ray and more than `distance` from it is known to have the
    /// whole hull on its far side: only one plane is tried, across the bisector of the outermost
    /// directions in which the ray sees the hull.
    pub(super) fn is_passed_by(&self, distance: f64) -> bool {
        let across = || self.0.iter().map(|point| point.xy());
        // The outermost points on either side, as seen from the ray, if it passes the hull.
        let Some(first) = across().next() else { return true };
        let (mut left, mut right) = (first, first);
        for point in across() {
            if left.perp_dot(point) > 0.0 {
                left = point;
            }
            if right.perp_dot(point) < 0.0 {
                right = point;
            }
        }
        let between = left.normalize_or_zero() + right.normalize_or_zero();
        let normal: DVec2 = between.normalize_or_zero();
        across().all(|point| normal.dot(point) > distance)
    }

    /// The least distance of the hull's points along the ray.
    pub(super) fn nearest_z(&self) -> f64 {
        self.0.iter().map(|point| point.z).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hull(points: &[(f64, f64)]) -> Hull {
        Hull(points.iter().map(|&(x, y)| DVec3::new(x, y, 1.0 + x)).collect())
    }

    #[test]
    fn a_hull_on_one_side_is_passed_by() {
        let beside = [(1.0, -3.0), (2.0, 0.5), (1e-3, 0.0), (1.0, 4.0)];
        // Turned by any angle.
        for k in 0..24 {
            let turn = DVec2::from_angle(f64::from(k) * 0.27);
            let turned = beside.map(|(x, y)| {
                let at = turn.rotate(DVec2::new(x, y));
                (at.x, at.y)
            });
            assert!(hull(&turned).is_passed_by(1e-6), "{k}");
            assert!(!hull(&turned).is_passed_by(2e-3), "{k}");
        }
    }

    #[test]
    fn a_hull_around_the_ray_is_not() {
        for around in [
            &[(1.0, 0.0), (-1.0, 1.0), (-1.0, -1.0)][..],
            &[(1.0, 1.0), (-1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)],
            &[(1.0, 0.0), (-2.0, 0.0)],
            &[(0.0, 0.0), (1.0, 0.0)],
            &[(0.0, 0.0)],
        ] {
            assert!(!hull(around).is_passed_by(0.0), "{around:?}");
        }
    }

    #[test]
    fn the_nearest_point_is_that_of_least_z() {
        assert_eq!(hull(&[(1.0, 0.0), (-3.0, 0.0), (2.0, 0.0)]).nearest_z(), -2.0);
    }
}
