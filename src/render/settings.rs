//! What picture to render, and how.

use std::ops::Range;

use thiserror::Error;

use super::{AovSet, PixelRect};
use crate::intersect::Kernel;
use crate::scene::{IntegratorKind, PictureError, RenderDefaults};

/// The most pixels rendered at once: at about 100 bytes each with all data, 27 GB. (So it is for
/// ranges of samples like `0..16`. Sums of other ranges are held in several blocks, of 45 bytes a
/// pixel each: those of `0..15` in four.) A larger picture can be rendered in crops.
pub const MAX_PIXELS: u64 = 1 << 28;

/// The most threads: far more than processors have, few enough for their stacks.
pub const MAX_THREADS: usize = 1024;

/// What picture to render, and how. The defaults are those of a scene that says nothing.
///
/// ```
/// use nurbray::render::{AovSet, RenderSettings};
///
/// let settings = RenderSettings { size: [320, 240], samples: 0..4, ..Default::default() };
/// assert!(settings.check().is_ok());
/// let settings = RenderSettings { size: [0, 240], ..settings };
/// let error = settings.check().unwrap_err();
/// assert_eq!(error.to_string(), "size 0x240: a picture needs at least one pixel each way");
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct RenderSettings {
    /// Width and height of the whole picture, in pixels.
    pub size: [u32; 2],
    /// Which samples of each pixel to take: `0..n` for `n` samples a pixel. Films of
    /// neighbouring ranges can be joined by [`Film::merge`](super::Film::merge).
    pub samples: Range<u32>,
    /// How radiance is found.
    pub integrator: IntegratorKind,
    /// The data to keep besides colour.
    pub aovs: AovSet,
    /// The part of the picture to render; all of it by default.
    pub crop: Option<PixelRect>,
    /// Another seed gives other samples of the same picture.
    pub seed: u64,
    /// How many threads work; 0 for as many as there are processors.
    pub threads: usize,
    /// Which code searches for hits.
    pub kernel: Kernel,
}

/// Why a picture cannot be rendered with these settings.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum SettingsError {
    /// There can be no such picture, however it is rendered.
    #[error(transparent)]
    Picture(#[from] PictureError),
    /// There are too many pixels for one film.
    #[error(
        "{pixels} pixels at once: at most {MAX_PIXELS} can be; a larger picture can be rendered in crops"
    )]
    TooManyPixels {
        /// How many were asked for.
        pixels: u64,
    },
    /// The crop reaches beyond the picture.
    #[error("crop {crop} reaches beyond the picture of size {width}x{height}")]
    CropOutside {
        /// The crop as given.
        crop: PixelRect,
        /// The picture's width.
        width: u32,
        /// The picture's height.
        height: u32,
    },
    /// The range of samples is empty.
    #[error("samples {start}..{end}: at least one sample is needed, as in 0..16")]
    NoSamples {
        /// The first sample.
        start: u32,
        /// The sample after the last.
        end: u32,
    },
    /// More threads than are allowed.
    #[error("{threads} threads: at most {MAX_THREADS} can be; 0 takes one for each processor")]
    TooManyThreads {
        /// How many were asked for.
        threads: usize,
    },
    /// The processor lacks the kernel's instructions.
    #[error("this processor cannot run the {kernel} kernel; it can run {}", available())]
    Kernel {
        /// The kernel asked for.
        kernel: Kernel,
    },
}

/// The kernels this processor can run.
fn available() -> String {
    let kernels = Kernel::ALL.iter().filter(|kernel| kernel.is_available());
    kernels.map(|kernel| kernel.name()).collect::<Vec<_>>().join(", ")
}

impl Default for RenderSettings {
    fn default() -> Self {
        Self::from(&RenderDefaults::default())
    }
}

/// The settings a scene asks for.
impl From<&RenderDefaults> for RenderSettings {
    fn from(scene: &RenderDefaults) -> Self {
        Self {
            size: scene.size,
            samples: 0..scene.spp,
            integrator: scene.integrator,
            aovs: AovSet::NONE,
            crop: None,
            seed: scene.seed,
            threads: 0,
            kernel: Kernel::default(),
        }
    }
}

impl RenderSettings {
    /// Whether there can be such a picture. Nothing is allocated; rendering checks it first.
    ///
    /// # Errors
    /// When the size, the range of samples or the number of threads is empty or too large,
    /// or the crop reaches beyond the picture.
    pub fn check(&self) -> Result<(), SettingsError> {
        self.window()?;
        let Range { start, end } = self.samples;
        if start >= end {
            return Err(SettingsError::NoSamples { start, end });
        }
        if self.threads > MAX_THREADS {
            return Err(SettingsError::TooManyThreads { threads: self.threads });
        }
        if !self.kernel.is_available() {
            return Err(SettingsError::Kernel { kernel: self.kernel });
        }
        Ok(())
    }

    /// The pixels to render: the crop, or the whole picture.
    ///
    /// # Errors
    /// When the size is empty or too large, or the crop reaches beyond it.
    pub fn window(&self) -> Result<PixelRect, SettingsError> {
        let [width, height] = self.size;
        RenderDefaults::check_size(self.size)?;
        let picture = PixelRect::new([0, 0], [width, height])
            .map_err(|_| PictureError::NoPixels { width, height })?;
        let window = self.crop.unwrap_or(picture);
        if picture.intersection(&window) != Some(window) {
            return Err(SettingsError::CropOutside { crop: window, width, height });
        }
        if window.area() > MAX_PIXELS {
            return Err(SettingsError::TooManyPixels { pixels: window.area() });
        }
        Ok(window)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(settings: RenderSettings) -> String {
        settings.check().unwrap_err().to_string()
    }

    #[test]
    fn refuses_what_is_no_picture_before_any_allocation() {
        let base = RenderSettings::default();
        assert_eq!(base.check(), Ok(()));
        let sized = |size| RenderSettings { size, ..base.clone() };
        assert_eq!(
            message(sized([64, 0])),
            "size 64x0: a picture needs at least one pixel each way"
        );
        assert_eq!(
            message(sized([u32::MAX, 2])),
            "size 4294967295x2: a side of a picture has at most 65536 pixels"
        );
        assert_eq!(
            message(sized([65_536, 65_536])),
            "4294967296 pixels at once: at most 268435456 can be; \
             a larger picture can be rendered in crops"
        );
        assert_eq!(
            message(RenderSettings { samples: 4..4, ..base.clone() }),
            "samples 4..4: at least one sample is needed, as in 0..16"
        );
        assert_eq!(
            message(RenderSettings { threads: 5000, ..base.clone() }),
            "5000 threads: at most 1024 can be; 0 takes one for each processor"
        );
    }

    #[test]
    fn refuses_kernels_that_the_processor_lacks() {
        for &kernel in Kernel::ALL {
            let settings = RenderSettings { kernel, ..RenderSettings::default() };
            let refused = SettingsError::Kernel { kernel };
            let expected = if kernel.is_available() { Ok(()) } else { Err(refused.clone()) };
            assert_eq!(settings.check(), expected);
            let start = format!("this processor cannot run the {kernel} kernel; it can run scalar");
            assert!(refused.to_string().starts_with(&start), "{refused}");
        }
    }

    #[test]
    fn crops_lie_inside_the_picture() {
        let crop = PixelRect::new([60, 0], [65, 10]).unwrap();
        let settings =
            RenderSettings { size: [64, 48], crop: Some(crop), ..RenderSettings::default() };
        assert_eq!(
            message(settings.clone()),
            "crop 60,0,65,10 reaches beyond the picture of size 64x48"
        );
        // A crop of a picture too large to be rendered at once is fine.
        let settings = RenderSettings { size: [65_536, 65_536], ..settings };
        assert_eq!(settings.window(), Ok(crop));
    }
}
