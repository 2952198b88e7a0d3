//! Axis-parallel boxes in f64.

use glam::DVec3;

use super::Ray;

/// A closed axis-parallel box; empty until something is put in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// The smallest coordinates.
    pub min: DVec3,
    /// The largest coordinates.
    pub max: DVec3,
}

impl Aabb {
    /// The box that holds nothing.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box that holds all points.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// The smallest box that holds this one and a point.
    #[must_use]
    pub fn with(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box that holds both.
    #[must_use]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box grown by `margin` on every side.
    #[must_use]
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Whether nothing is inside.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// The middle.
    pub fn center(&self) -> DVec3 {
        0.5 * self.min + 0.5 * self.max
    }

    /// The side lengths.
    pub fn size(&self) -> DVec3 {
        self.max - self.min
    }

    /// Whether a ray passes beside the box, as far as rounding tells (Kay and Kajiya 1986).
    ///
    /// It may be wrong where the ray comes nearer than a few roundings of the distances from its
    /// origin to the box's planes. No ray is beside the empty box.
    #[inline(always)]
    pub(crate) fn is_beside(&self, ray: &Ray) -> bool {
        let (origin, inverse) = (ray.origin(), ray.direction().recip());
        // Never −∞: for a ray in the plane of a side, the box's other plane must not exclude
        // anything either.
        let inverse = DVec3::select(inverse.cmplt(DVec3::MIN), DVec3::INFINITY, inverse);
        let (to_min, to_max) = ((self.min - origin) * inverse, (self.max - origin) * inverse);
        let (mut entry, mut exit) = (ray.t_min(), ray.t_max());
        for k in 0..3 {
            let (to_min, to_max) = (to_min[k], to_max[k]);
            // In this form each is one instruction, and NaN, which a ray in the plane of a side
            // gives, stays NaN and excludes nothing.
            let near = if to_max < to_min { to_max } else { to_min };
            let far = if to_min > to_max { to_min } else { to_max };
            entry = if near > entry { near } else { entry };
            exit = if far < exit { far } else { exit };
        }
        entry > exit
    }

    /// The largest absolute coordinate.
    pub fn magnitude(&self) -> f64 {
        self.min.abs().max(self.max.abs()).max_element()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn vector(range: std::ops::Range<f64>) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(range).prop_map(DVec3::from_array)
    }

    proptest! {
        /// A ray through a point of the box is not beside it; cut off before it reaches the box, it
        /// is.
        #[test]
        fn a_ray_is_beside_what_it_does_not_reach(
            corner in vector(-3.0..3.0),
            size in vector(0.01..2.0),
            place in vector(0.001..0.999),
            origin in vector(-9.0..9.0),
            scale in -30..30i32,
        ) {
            let bounds = Aabb { min: corner, max: corner + size };
            let inside = corner + place * size;
            let direction = (inside - origin) * 10f64.powi(scale);
            prop_assume!(direction.length_squared() > 0.0);
            let t = 0.1f64.powi(scale);
            let through = |t_min: f64, t_max: f64| Ray::with_range(origin, direction, t_min, t_max);
            prop_assert!(!bounds.is_beside(&through(0.0, f64::INFINITY).unwrap()));
            prop_assert!(!bounds.is_beside(&through(0.999 * t, 1.001 * t).unwrap()));
            let farthest = size.length() / inside.distance(origin);
            let before = [f64::NEG_INFINITY, t * (0.999 - farthest)];
            let behind = [t * (1.001 + farthest), f64::INFINITY];
            for [from, to] in [before, behind] {
                prop_assert!(bounds.is_beside(&through(from, to).unwrap()));
            }
            // Aimed at a point beyond a corner, along a plane that touches the box there.
            let outward = inside - bounds.center();
            let support = DVec3::select(outward.cmpge(DVec3::ZERO), bounds.max, bounds.min);
            let along = outward.any_orthogonal_vector();
            let off = Ray::new(support + 1e-6 * outward - along, along).unwrap();
            prop_assert!(bounds.is_beside(&off));
        }
    }

    #[test]
    fn rays_along_the_sides_of_a_box_are_told_from_those_beside_it() {
        let unit = Aabb { min: DVec3::ZERO, max: DVec3::ONE };
        let beside = |x: f64, z: f64| {
            let along =
                |y: f64, d: DVec3| unit.is_beside(&Ray::new(DVec3::new(x, y, z), d).unwrap());
            let there = along(-5.0, DVec3::Y);
            assert_eq!(there, along(5.0, -DVec3::Y), "back again");
            assert_eq!(
                there,
                along(5.0, DVec3::new(-1e-310, -1.0, 1e-310)),
                "all but along the sides"
            );
            there
        };
        assert!(!beside(0.5, 0.5) && !beside(1e-9, 1.0 - 1e-9));
        for (x, z) in [(0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.5, 1.0), (0.0, 0.0), (1.0, 1.0)] {
            assert!(!beside(x, z), "{x} {z}");
        }
        assert!(beside(-1e-9, 0.5) && beside(0.5, 1.0 + 1e-9) && beside(-1.0, -1.0));
        let flat = Aabb { min: DVec3::ZERO, max: DVec3::new(1.0, 1.0, 0.0) };
        assert!(!flat.is_beside(&Ray::new(DVec3::new(0.5, 0.5, 3.0), -DVec3::Z).unwrap()));
    }
}
