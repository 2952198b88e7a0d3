//! A ray as the meeting of two planes.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::Ray;

/// Coordinates in which a ray is the third axis.
///
/// `x` and `y` are the distances from two perpendicular planes that meet in the ray, `z`
/// the distance along it in scene units: a point lies on the ray's line where
/// `x = y = 0`, and its ray parameter is `t = z / |d|` (Kajiya 1982).
#[derive(Clone, Copy, Debug)]
pub struct RayFrame {
    /// The ray's origin.
    pub origin: DVec3,
    /// The unit direction.
    pub axis: DVec3,
    /// One over each component of the unit direction, with its sign; infinite where that is zero or
    /// next to zero.
    pub inverse_axis: DVec3,
    /// The unit normals of the two planes.
    pub normals: [DVec3; 2],
    /// `1 / |d|`: converts a distance to the ray parameter.
    pub t_from_z: f64,
    /// The range of `z`, from the ray's range of `t`.
    pub z_range: [f64; 2],
    /// The largest coordinate magnitude of the origin.
    pub magnitude: f64,
}

impl RayFrame {
    /// The frame of a ray, whatever the length of its direction.
    #[inline(always)] // else numbers stored one by one are read as vectors, which stalls
    pub fn new(ray: &Ray) -> Self {
        let Unit { axis, inverse_axis, length } = Unit::of(ray.direction());
        let normals = perpendicular(axis);
        let z_range = [ray.t_min() * length, ray.t_max() * length];
        let origin = ray.origin();
        let magnitude = origin.abs().max_element();
        let t_from_z = 1.0 / length;
        Self { origin, axis, inverse_axis, normals, t_from_z, z_range, magnitude }
    }

    /// The point's distances from the two planes and along the ray.
    pub fn coordinates(&self, point: DVec3) -> DVec3 {
        self.along_axes(point - self.origin)
    }

    /// A vector's components along the planes' normals and along the ray.
    pub fn along_axes(&self, v: DVec3) -> DVec3 {
        DVec3::new(self.normals[0].dot(v), self.normals[1].dot(v), self.axis.dot(v))
    }

    /// A vector's components along the planes' normals.
    pub fn across(&self, v: DVec3) -> DVec2 {
        DVec2::new(self.normals[0].dot(v), self.normals[1].dot(v))
    }

    /// The point's distance from the ray's line.
    pub fn distance(&self, point: DVec3) -> f64 {
        self.coordinates(point).truncate().length()
    }
}

/// Squares of lengths in this range are far from where digits are lost.
pub(crate) const PLAIN_SQUARES: Range<f64> = 1e-100..1e100;

/// A vector's direction and length.
struct Unit {
    axis: DVec3,
    inverse_axis: DVec3,
    length: f64,
}

impl Unit {
    #[inline(always)]
    fn of(v: DVec3) -> Self {
        let square = v.length_squared();
        if !PLAIN_SQUARES.contains(&square) {
            return Self::of_extreme(v);
        }
        let length = square.sqrt();
        // The quotients do not wait for the length.
        Self { axis: v * (1.0 / length), inverse_axis: v.recip() * length, length }
    }

    /// [`Self::of`], scaled first: the squares of tiny or huge components would be lost.
    #[cold]
    #[inline(never)] // else both cases would meet in memory, written as numbers and read as vectors
    fn of_extreme(v: DVec3) -> Self {
        let largest = v.abs().max_element();
        let scaled = v / largest;
        let length = scaled.length();
        let axis = scaled / length;
        Self { axis, inverse_axis: axis.recip(), length: largest * length }
    }
}

/// Two unit vectors perpendicular to a unit vector and to each other, without a branch
/// on its direction (Duff et al., "Building an orthonormal basis, revisited", 2017).
fn perpendicular(axis: DVec3) -> [DVec3; 2] {
    let sign = 1f64.copysign(axis.z);
    let a = -1.0 / (sign + axis.z);
    let b = axis.x * axis.y * a;
    [
        DVec3::new(1.0 + sign * axis.x * axis.x * a, sign * b, -sign * axis.x),
        DVec3::new(b, sign + axis.y * axis.y * a, -axis.y),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_orthonormal_for_any_direction_and_length() {
        let directions = [
            DVec3::X,
            -DVec3::Z,
            DVec3::new(1.0, -2.0, 3.0),
            DVec3::new(1e-150, 2e-150, -1e-150),
            DVec3::new(1e150, 1e150, 0.0),
            DVec3::new(1e-9, 1e-9, -1.0),
        ];
        for d in directions {
            // With the longest and the shortest directions only one term of a sum would be left.
            let origin = if (1e-9..1e9).contains(&d.length()) { DVec3::ONE } else { DVec3::ZERO };
            let frame = RayFrame::new(&Ray::new(origin, d).unwrap());
            let [x, y, z] = [frame.normals[0], frame.normals[1], frame.axis];
            for (a, b, expected) in
                [(x, x, 1.0), (y, y, 1.0), (z, z, 1.0), (x, y, 0.0), (y, z, 0.0), (z, x, 0.0)]
            {
                assert!((a.dot(b) - expected).abs() < 1e-15, "{d}");
            }
            let t = 7.0;
            let z = frame.coordinates(origin + t * d).z;
            assert!((z * frame.t_from_z - t).abs() < 1e-14 * t, "{d}");
        }
    }

    #[test]
    fn inverses_have_the_signs_of_the_direction_and_are_accurate_or_infinite() {
        for length in [1e-150, 1e-50, 1e-30, 1.0, 1e49, 1e51, 1e150] {
            for small in [0.0, -0.0, 1e-12, -1e-12, 1e-140, -1e-140, 1e-310] {
                let direction = length * DVec3::new(-1.0, small, 0.5);
                let RayFrame { axis, inverse_axis, .. } =
                    RayFrame::new(&Ray::new(DVec3::ZERO, direction).unwrap());
                for k in 0..3 {
                    let (inverse, expected) = (inverse_axis[k], 1.0 / axis[k]);
                    assert_eq!(inverse.is_sign_negative(), direction[k].is_sign_negative());
                    let close = (inverse / expected - 1.0).abs() < 1e-15;
                    assert!(close || inverse == expected, "{direction}: {inverse_axis}");
                }
            }
        }
    }
}
