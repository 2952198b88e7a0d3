//! Light: settings, samples, tiles, integrators and the film they fill.
//!
//! [`render`](fn@render) takes a [`World`](crate::scene::World) and [`RenderSettings`] and
//! returns a [`Film`]: sums of samples, colour and the data asked for ([`AovSet`]). What a
//! pixel shows is up to the integrator ([`IntegratorKind`](crate::scene::IntegratorKind)):
//!
//! | integrator | shows |
//! |---|---|
//! | `direct` | diffuse surfaces in the light of all lights, with shadows |
//! | `normal` | the normal `n` as the surface orients it, as the colour `(n + 1) / 2` |
//! | `uv` | `u` as red, `v` as green, from 0 to 1 over the surface's domain |
//! | `depth` | the distance along the ray, from white to dark grey over the model |
//! | `id` | a colour for each surface |
//! | `iterations` | the work of each ray, from black over red and yellow to white |
//!
//! All but `direct` are black where nothing is hit (`iterations`: where nothing was done).
//!
//! Samples are functions of seed, pixel, sample number and dimension ([`Sampler`]), and a
//! pixel depends on nothing else. So a picture can be made by any number of threads or machines,
//! and is the same to the last bit: crops have the pixels of the whole picture, and are
//! [pasted](Film::paste) into one film; a film of the samples A to B, too, is that of the whole
//! once it is [merged](Film::merge) with that of B to C. All machines must use one
//! [kernel](RenderSettings::kernel), as others may round the last digits differently: name it, for
//! the default is the fastest of the processor at hand.

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

pub use aov::{Aov, AovListError, AovSet, Channel};
pub use driver::{Progress, RenderError, render};
pub use film::{Counters, Film, FilmError, MergeError, PasteError};
pub use rect::{PixelRect, RectError};
pub use sampler::{Dimensions, Sampler};
pub use settings::{MAX_PIXELS, MAX_THREADS, RenderSettings, SettingsError};

#[cfg(test)]
mod driver_tests;
#[cfg(test)]
mod integrator_tests;
#[cfg(test)]
mod test_worlds;
