//! Directions of vectors.

use glam::DVec3;

/// The unit vector along a vector of any length, exact along the coordinate axes; `None` for zero
/// and for vectors that are not finite.
pub(crate) fn unit(vector: DVec3) -> Option<DVec3> {
    let largest = vector.abs().max_element();
    let usable = largest > 0.0 && vector.is_finite();
    usable.then(|| (vector / largest).normalize())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_of_any_length_have_directions() {
        for size in [f64::MIN_POSITIVE, 1e-300, 1.0, 1e300] {
            let along = unit(DVec3::new(3.0, 0.0, -4.0) * size).unwrap();
            assert!((along - DVec3::new(0.6, 0.0, -0.8)).length() < 1e-15, "{size:e}");
            assert_eq!(unit(DVec3::NEG_Y * size), Some(DVec3::NEG_Y));
        }
        for none in [DVec3::ZERO, DVec3::NAN, DVec3::INFINITY, DVec3::new(1.0, f64::NAN, 0.0)] {
            assert_eq!(unit(none), None);
        }
    }
}
