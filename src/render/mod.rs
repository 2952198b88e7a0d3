//! Light: settings, samples, tiles, integrators and the film they fill.

mod aov;
mod driver;
mod film;
mod integrator;
mod painter;
mod pixels;
mod rect;
mod sampler;
mod settings;
mod sums;
mod tile;

pub use aov::{Aov, AovSet, Channel};
pub use driver::{Progress, RenderError, render};
pub use film::{Counters, Film, FilmError, MergeError};
pub use rect::{PixelRect, RectError};
pub use sampler::{Dimensions, Sampler};
pub use settings::{MAX_PIXELS, MAX_SIDE, MAX_THREADS, RenderSettings, SettingsError};

#[cfg(test)]
mod driver_tests;
#[cfg(test)]
mod integrator_tests;
#[cfg(test)]
mod test_worlds;
