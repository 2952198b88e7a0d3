//! Space as plots show it.

use glam::{DVec2, DVec3};
use nurbray::math::Aabb;
use nurbray::scene::Plane;

/// Things that vary in a coordinate by no more than this share of their size are flat.
const FLAT: f64 = 1e-6;

/// The projection of space onto a plot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Projection {
    pub(super) plane: Plane,
    /// A box around the things that are shown.
    pub(super) bounds: Aabb,
}

impl Projection {
    /// The plane that was asked for; of flat things, the two coordinates in which they vary most,
    /// and of others an oblique view.
    pub(super) fn new(plane: Option<Plane>, points: impl Iterator<Item = DVec3>) -> Self {
        let bounds = Aabb::around(points);
        Self { plane: plane.unwrap_or_else(|| suitable(bounds.size())), bounds }
    }

    /// Where a point is shown.
    pub(super) fn of(self, point: DVec3) -> DVec2 {
        match self.plane {
            Plane::Xy => DVec2::new(point.x, point.y),
            Plane::Xz => DVec2::new(point.x, point.z),
            Plane::Yz => DVec2::new(point.y, point.z),
            Plane::Across(_) => {
                let [right, up, _] = self.plane.directions();
                DVec2::new(right.dot(point), up.dot(point))
            }
        }
    }

    /// The direction to the viewer.
    pub(super) fn toward(self) -> DVec3 {
        let [_, _, toward] = self.plane.directions();
        toward
    }
}

/// The plane that suits things of this extent.
fn suitable(extent: DVec3) -> Plane {
    let least = extent.min_element();
    match extent {
        _ if least > FLAT * extent.max_element() => Plane::OBLIQUE,
        extent if extent.z == least => Plane::Xy,
        extent if extent.y == least => Plane::Xz,
        _ => Plane::Yz,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_hidden_that_varies() {
        let of = |extent: [f64; 3]| suitable(extent.into());
        assert_eq!(of([2.0, 1.0, 0.0]), Plane::Xy);
        assert_eq!(of([2.0, 1e-17, 1.0]), Plane::Xz);
        assert_eq!(of([0.0, 2.0, 3.0]), Plane::Yz);
        assert_eq!(of([0.0; 3]), Plane::Xy);
        assert_eq!(of([2.0, 1.0, 1e-3]), Plane::OBLIQUE);
    }

    /// Views along axes are the planes of coordinates; others keep right angles, z upwards.
    #[test]
    fn views_are_right_handed_and_upright() {
        let place = DVec3::new(3.0, -5.0, 7.0);
        let seen = |plane| Projection::new(Some(plane), [place].into_iter()).of(place);
        for (toward, plane) in
            [(DVec3::Z, Plane::Xy), (DVec3::NEG_Y, Plane::Xz), (DVec3::X, Plane::Yz)]
        {
            assert_eq!(seen(Plane::Across(2.0 * toward)), seen(plane));
        }
        for toward in [[1.0, -1.0, 1.0], [0.0, 1.0, -2.0], [-3.0, 0.1, 0.0], [1e-9, 0.0, -1e8]] {
            let plane = Plane::Across(toward.into());
            let [right, up, back] = plane.directions();
            assert!((right.cross(up) - back).length() < 1e-15);
            assert!((back.dot(DVec3::from(toward).normalize()) - 1.0).abs() < 1e-15, "{back}");
            assert!(right.z == 0.0 && up.z >= 0.0, "{right}, {up}");
            let [x, y] = seen(plane).to_array();
            let depth = Projection::new(Some(plane), [place].into_iter()).toward().dot(place);
            assert!((DVec3::new(x, y, depth).length() - place.length()).abs() < 1e-14);
        }
    }
}
