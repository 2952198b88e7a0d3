//! Light: settings, samples, tiles, integrators and the film they fill.

mod aov;
mod film;
mod integrator;
mod painter;
mod pixels;
mod rect;
mod render;
mod sampler;
mod settings;
mod sums;
mod tile;

pub use aov::{Aov, AovSet, Channel};
pub use film::{Counters, Film, FilmError, MergeError};
pub use rect::{PixelRect, RectError};
pub use render::{Progress, RenderError, render};
pub use sampler::{Dimensions, Sampler};
pub use settings::{MAX_PIXELS, MAX_SIDE, MAX_THREADS, RenderSettings, SettingsError};
