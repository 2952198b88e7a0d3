//! The settings a scene gives for its picture; the command line may override them.

use std::fmt;
use std::str::FromStr;

use thiserror::Error;

/// How radiance is found, by name; the render layer gives each name its meaning.
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
    /// The distance along the ray.
    Depth,
    /// A colour for each surface.
    Id,
    /// How much work the ray was, whether it hit anything or not.
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
    pub size: [u32; 2],
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
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PictureError {
    /// A side of the picture is 0.
    #[error("size {width}x{height}: a picture needs at least one pixel each way")]
    NoPixels {
        /// The width as given.
        width: u32,
        /// The height as given.
        height: u32,
    },
    /// A side of the picture is too long.
    #[error(
        "size {width}x{height}: a side of a picture has at most {} pixels",
        RenderDefaults::MAX_SIDE
    )]
    TooLong {
        /// The width as given.
        width: u32,
        /// The height as given.
        height: u32,
    },
    /// No samples are taken.
    #[error("spp 0: a picture needs at least one sample a pixel")]
    NoSamples,
    /// The exposure is NaN or infinite.
    #[error("exposure {exposure}: stops must be finite")]
    Exposure {
        /// The exposure as given.
        exposure: f64,
    },
}

impl RenderDefaults {
    /// The most pixels in a row or a column. Beyond it, image programs begin to fail, and a
    /// mistyped size is likelier than a wish.
    pub const MAX_SIDE: u32 = 1 << 16;

    /// Refuses pictures that cannot be made. Only the renderer, which can make a picture in parts,
    /// knows how much of one fits in memory.
    ///
    /// # Errors
    /// When a side has no pixels, or absurdly many, there are no samples, or the exposure is not
    /// finite.
    pub fn check(&self) -> Result<(), PictureError> {
        Self::check_size(self.size)?;
        if self.spp == 0 {
            return Err(PictureError::NoSamples);
        }
        let exposure = self.exposure;
        if exposure.is_finite() { Ok(()) } else { Err(PictureError::Exposure { exposure }) }
    }

    /// Refuses widths and heights that no picture has.
    ///
    /// # Errors
    /// When a side has no pixels, or absurdly many.
    pub fn check_size([width, height]: [u32; 2]) -> Result<(), PictureError> {
        if width == 0 || height == 0 {
            return Err(PictureError::NoPixels { width, height });
        }
        if width > Self::MAX_SIDE || height > Self::MAX_SIDE {
            return Err(PictureError::TooLong { width, height });
        }
        Ok(())
    }
}

impl Default for RenderDefaults {
    fn default() -> Self {
        Self {
            size: [800, 600],
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
        assert_eq!(check([65_536, 65_536], 1), Ok(())); // in parts
        let message = |size, spp| check(size, spp).unwrap_err().to_string();
        assert_eq!(message([0, 600], 1), "size 0x600: a picture needs at least one pixel each way");
        assert_eq!(
            message([u32::MAX, 1], 1),
            "size 4294967295x1: a side of a picture has at most 65536 pixels"
        );
        assert_eq!(message([1, 1], 0), "spp 0: a picture needs at least one sample a pixel");
        let dark = RenderDefaults { exposure: f64::NEG_INFINITY, ..RenderDefaults::default() };
        assert_eq!(dark.check().unwrap_err().to_string(), "exposure -inf: stops must be finite");
    }

    #[test]
    fn unknown_names_get_the_nearest() {
        assert_eq!(
            "normals".parse::<IntegratorKind>().unwrap_err().to_string(),
            "unknown integrator \"normals\"; did you mean \"normal\"?"
        );
    }
}
