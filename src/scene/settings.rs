//! What a scene says about its picture; the command line may say otherwise.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// How radiance is found, by name; the render floor gives each its meaning.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum IntegratorKind {
    /// Lights, shadows and materials.
    #[default]
    Direct,
    /// The normal as a colour.
    Normal,
    /// The surface's (u, v) as a colour.
    Uv,
    /// The distance along the view.
    Depth,
    /// A colour for each surface.
    Id,
    /// How much work the hit took.
    Iterations,
}

impl IntegratorKind {
    /// Every integrator, in the order to list them.
    pub const ALL: &'static [Self] =
        &[Self::Direct, Self::Normal, Self::Uv, Self::Depth, Self::Id, Self::Iterations];

    /// Its name in scenes and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::Normal => "normal",
            Self::Uv => "uv",
            Self::Depth => "depth",
            Self::Id => "id",
            Self::Iterations => "iterations",
        }
    }
}

impl fmt::Display for IntegratorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for IntegratorKind {
    type Err = super::UnknownName;

    fn from_str(name: &str) -> Result<Self, super::UnknownName> {
        let known: Vec<_> = Self::ALL.iter().map(|kind| kind.name()).collect();
        Self::ALL
            .iter()
            .copied()
            .find(|kind| kind.name() == name)
            .ok_or_else(|| super::UnknownName::new("integrator", name, &known))
    }
}

/// The picture a scene asks for.
#[derive(Clone, Debug, PartialEq)]
pub struct RenderDefaults {
    /// Width and height in pixels.
    pub size: (u32, u32),
    /// Samples a pixel.
    pub spp: u32,
    /// How radiance is found.
    pub integrator: IntegratorKind,
    /// The seed of every sample.
    pub seed: u64,
    /// Exposure of the PNG, in stops: radiance is multiplied by `2^exposure`.
    pub exposure: f64,
}

/// Why a picture cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// It has no pixels, or absurdly many.
    #[error(
        "a picture of {width} × {height} pixels: needed are 1 to {} each way, at most {} in all",
        RenderDefaults::MAX_SIDE,
        RenderDefaults::MAX_PIXELS
    )]
    Size {
        /// Its width.
        width: u32,
        /// Its height.
        height: u32,
    },
    /// No samples are taken.
    #[error("spp is 0: needed is at least 1 sample a pixel")]
    NoSamples,
}

impl RenderDefaults {
    /// The most pixels in a row or a column: what viewers and PNG encoders still cope with.
    pub const MAX_SIDE: u32 = 1 << 16;

    /// The most pixels in all: 2²⁸, or 4 GiB for each four channels of the film.
    pub const MAX_PIXELS: u64 = 1 << 28;

    /// Refuses pictures that cannot be made, before memory is taken for them.
    ///
    /// # Errors
    /// When there are no pixels, absurdly many, or no samples.
    pub fn check(&self) -> Result<(), SettingsError> {
        let (width, height) = self.size;
        let sides = 1..=Self::MAX_SIDE;
        let pixels = u64::from(width) * u64::from(height);
        if !sides.contains(&width) || !sides.contains(&height) || pixels > Self::MAX_PIXELS {
            return Err(SettingsError::Size { width, height });
        }
        if self.spp == 0 { Err(SettingsError::NoSamples) } else { Ok(()) }
    }
}

impl Default for RenderDefaults {
    fn default() -> Self {
        Self {
            size: (800, 600),
            spp: 16,
            integrator: IntegratorKind::default(),
            seed: 0,
            exposure: 0.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_come_back() {
        for &kind in IntegratorKind::ALL {
            assert_eq!(kind.to_string().parse(), Ok(kind));
        }
    }

    #[test]
    fn absurd_pictures_are_refused() {
        let check = |size, spp| RenderDefaults { size, spp, ..RenderDefaults::default() }.check();
        assert_eq!(check((1, 65_536), 1), Ok(()));
        assert_eq!(
            check((0, 600), 1).unwrap_err().to_string(),
            "a picture of 0 × 600 pixels: needed are 1 to 65536 each way, at most 268435456 in all"
        );
        assert!(check((65_536, 65_536), 1).is_err());
        assert!(check((u32::MAX, 1), 1).is_err());
        assert_eq!(
            check((1, 1), 0).unwrap_err().to_string(),
            "spp is 0: needed is at least 1 sample a pixel"
        );
    }

    #[test]
    fn unknown_names_get_the_nearest() {
        assert_eq!(
            "normals".parse::<IntegratorKind>().unwrap_err().to_string(),
            "unknown integrator \"normals\"; did you mean \"normal\"?"
        );
    }
}
