//! What shines.

use glam::DVec3;

use crate::math::unit;

/// A colour or an amount of light: linear red, green, blue with Rec. 709 primaries.
pub type Rgb = [f64; 3];

/// A light. A diffuse surface of albedo `a` lit by the irradiance `E` (already times the
/// cosine) sends out the radiance `a E / π`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A point that shines alike in all directions: irradiance `intensity · cos θ / r²`.
    Point {
        /// Where it is.
        position: DVec3,
        /// The radiant intensity.
        intensity: Rgb,
    },
    /// A light so far away that its rays are parallel: irradiance `irradiance · cos θ`.
    Directional {
        /// The unit direction from any surface to the light.
        to_light: DVec3,
        /// The irradiance of a surface that faces it.
        irradiance: Rgb,
    },
    /// The same radiance from everywhere, never shadowed: a diffuse surface of albedo `a`
    /// sends out `a · radiance`. It keeps shadows from being black, no more than that.
    Ambient {
        /// The radiance from every direction.
        radiance: Rgb,
    },
}

impl Light {
    /// A directional light whose rays come from the side of `from`, any length.
    ///
    /// `None` when `from` is zero or not finite.
    pub fn directional(from: DVec3, irradiance: Rgb) -> Option<Self> {
        unit(from).map(|to_light| Self::Directional { to_light, irradiance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_of_any_length() {
        for size in [1e-300, 1.0, 1e300] {
            let light = Light::directional(DVec3::new(3.0, 0.0, 4.0) * size, [1.0; 3]).unwrap();
            let Light::Directional { to_light, .. } = light else { panic!("{light:?}") };
            assert!((to_light - DVec3::new(0.6, 0.0, 0.8)).length() < 1e-15, "size {size}");
        }
        assert_eq!(Light::directional(DVec3::ZERO, [1.0; 3]), None);
        assert_eq!(Light::directional(DVec3::new(1.0, f64::NAN, 0.0), [1.0; 3]), None);
        assert_eq!(Light::directional(DVec3::INFINITY, [1.0; 3]), None);
    }
}
