//! Lights.

use glam::DVec3;
use thiserror::Error;

use crate::math::{Shown, ShownVector, unit};

/// A colour or an amount of light: linear red, green, blue with Rec. 709 primaries.
pub type Rgb = [f64; 3];

/// A light. A diffuse surface of albedo `a` lit by the irradiance `E` (already times the
/// cosine) sends out the radiance `a E / π`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// A point that shines alike in all directions: irradiance `intensity · cos θ / r²`. Where it
    /// lies on a surface, this is not in its way: it shines on both sides.
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

/// Why numbers are not a light, or not a colour.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LightError {
    /// A colour or an amount of light is negative, NaN, infinite, or beyond what pictures hold.
    #[error(
        "{what} {}: red, green and blue must be finite numbers from 0 to {}",
        ShownVector(DVec3::from_array(*amount)), Shown(*most)
    )]
    Amount {
        /// What the amount is of.
        what: &'static str,
        /// The numbers as given.
        amount: Rgb,
        /// The largest such number.
        most: f64,
    },
    /// The position of a point light is not finite.
    #[error("position {}: coordinates must be finite", ShownVector(*.position))]
    Position {
        /// The position as given.
        position: DVec3,
    },
    /// The direction of a directional light is not a unit vector.
    #[error("to_light {}: a unit direction is needed", ShownVector(*.to_light))]
    Direction {
        /// The direction as given.
        to_light: DVec3,
    },
    /// The width of lines is not a share of their cells.
    #[error("width {}: a share of a cell, from 0 to 1, is needed", Shown(*.width))]
    Width {
        /// The width as given.
        width: f64,
    },
}

/// The largest number of a colour, a radiance or an irradiance: nearly the largest that the 32 bits
/// of pictures hold.
pub(crate) const MAX_LIGHT: f64 = 3.4e38;

/// The largest radiant intensity: that which brings [`MAX_LIGHT`] as far as surfaces reach, 1e70.
pub(crate) const MAX_INTENSITY: f64 = 3.4e178;

/// Refuses numbers that are not a colour or an amount of light that pictures hold.
pub(in crate::scene) fn check_amount(what: &'static str, amount: Rgb) -> Result<(), LightError> {
    check_up_to(MAX_LIGHT, what, amount)
}

fn check_up_to(most: f64, what: &'static str, amount: Rgb) -> Result<(), LightError> {
    let is_light = amount.iter().all(|share| (0.0..=most).contains(share));
    if is_light { Ok(()) } else { Err(LightError::Amount { what, amount, most }) }
}

impl Light {
    /// Refuses numbers that are not a light.
    ///
    /// # Errors
    /// When an amount of light is negative, not finite or beyond the 32 bits of pictures (an
    /// intensity: at any distance), a position is not finite, or a direction is not of length 1 to
    /// within 1e-9.
    pub fn check(&self) -> Result<(), LightError> {
        match *self {
            Self::Point { position, intensity } => {
                if !position.is_finite() {
                    return Err(LightError::Position { position });
                }
                check_up_to(MAX_INTENSITY, "intensity", intensity)
            }
            Self::Directional { to_light, irradiance } => {
                let is_unit = (to_light.length() - 1.0).abs() <= 1e-9; // false for NaN
                if !is_unit {
                    return Err(LightError::Direction { to_light });
                }
                check_amount("irradiance", irradiance)
            }
            Self::Ambient { radiance } => check_amount("radiance", radiance),
        }
    }

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

    #[test]
    fn what_is_no_light_is_refused() {
        let to_light = DVec3::new(0.6, 0.0, 0.8);
        assert_eq!(
            Light::Directional { to_light, irradiance: [0.0, 1.0, MAX_LIGHT] }.check(),
            Ok(())
        );
        for (light, expected) in [
            (
                Light::Ambient { radiance: [0.5, f64::NAN, 0.5] },
                "radiance (0.5, NaN, 0.5): red, green and blue must be finite numbers from 0 to \
                 3.4e38",
            ),
            (
                Light::Directional { to_light, irradiance: [0.0, 1.0, 1e39] },
                "irradiance (0, 1, 1e39): red, green and blue must be finite numbers from 0 to \
                 3.4e38",
            ),
            (
                Light::Point { position: DVec3::ZERO, intensity: [1e300; 3] },
                "intensity (1e300, 1e300, 1e300): red, green and blue must be finite numbers from 0 \
                 to 3.4e178",
            ),
            (
                Light::Point { position: DVec3::ZERO, intensity: [1.0, 1.0, -0.5] },
                "intensity (1, 1, -0.5): red, green and blue must be finite numbers from 0 to \
                 3.4e178",
            ),
            (
                Light::Point { position: DVec3::INFINITY, intensity: [1.0; 3] },
                "position (inf, inf, inf): coordinates must be finite",
            ),
            (
                Light::Directional { to_light: 2.0 * DVec3::X, irradiance: [1.0; 3] },
                "to_light (2, 0, 0): a unit direction is needed",
            ),
        ] {
            assert_eq!(light.check().unwrap_err().to_string(), expected);
        }
    }
}
