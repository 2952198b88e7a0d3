//! Rendering: all threads, all tiles, one film.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

use rayon::ThreadPoolBuilder;
use thiserror::Error;

use super::painter::Painter;
use super::tile::TileGrid;
use super::{Counters, Film, FilmError, RenderSettings};
use crate::math::Counted;
use crate::scene::World;

/// How far a render has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// Tiles that are finished.
    pub tiles_done: usize,
    /// Tiles in all.
    pub tiles: usize,
    /// Rays traced so far, in finished tiles.
    pub rays: u64,
}

/// Why there is no picture.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// There can be no such film.
    #[error(transparent)]
    Film(#[from] FilmError),
    /// The system gives no threads.
    #[error("cannot start {}: {reason}", named(*.threads))]
    Threads {
        /// How many were asked for; 0 for one for each processor.
        threads: usize,
        /// What the system says.
        reason: String,
    },
}

/// How an error calls this many threads.
fn named(threads: usize) -> String {
    if threads == 0 { "the threads".into() } else { Counted(threads, "thread").to_string() }
}

/// Renders a world, with threads of its own: [`RenderSettings::threads`] of them.
///
/// The picture depends on the world and the settings only, not on the number of threads nor
/// on which finishes first: each tile is painted for itself, from samples that are
/// functions of (seed, pixel, sample, dimension). Nor does a pixel depend on the crop.
///
/// `progress` is called after every tile, by whichever thread painted it, but never by two
/// at once and always with rising numbers. It should be quick: the others may have to wait.
///
/// ```
/// use nurbray::render::{Channel, RenderSettings, render};
/// use nurbray::scene::{NamedShape, Object, Part, Scene, Shape, World};
///
/// let shape = Shape::Named(NamedShape::Sphere { radius: 1.0 }, Vec::new());
/// let part = Part { name: String::new(), place: Default::default(), shape, trims: None };
/// let objects = vec![Object { parts: vec![part], ..Default::default() }];
/// let scene = Scene { objects, ..Default::default() };
/// let world = World::new(&scene)?;
///
/// let settings = RenderSettings { size: (32, 24), samples: 0..4, ..Default::default() };
/// let film = render(&world, &settings, &|_| {})?;
/// assert_eq!(film.value(Channel::A, [16, 12]), Some(1.0)); // the camera frames the sphere
/// assert_eq!(film.value(Channel::A, [0, 0]), Some(0.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the settings are refused, or memory or threads cannot be obtained.
pub fn render(
    world: &World,
    settings: &RenderSettings,
    progress: &(dyn Fn(Progress) + Sync),
) -> Result<Film, RenderError> {
    let film = Film::new(settings)?;
    let grid = TileGrid::new(film.window());
    let pool = ThreadPoolBuilder::new().num_threads(settings.threads).build().map_err(|error| {
        RenderError::Threads { threads: settings.threads, reason: error.to_string() }
    })?;

    let state = Mutex::new((film, 0));
    let next = AtomicUsize::new(0);
    let neighbours = world.neighbours(settings.size.into());
    pool.broadcast(|_| {
        let mut painter = Painter::new(world, settings, neighbours);
        while let Some(tile) = grid.get(next.fetch_add(1, Ordering::Relaxed)) {
            let (pixels, counters) = painter.paint(tile);
            let mut state = lock(&state);
            let (film, tiles_done) = &mut *state;
            film.insert(pixels, counters);
            *tiles_done += 1;
            let (tiles_done, tiles) = (*tiles_done, grid.count());
            progress(Progress { tiles_done, tiles, rays: film.counters().rays });
        }
        let statistics = painter.statistics();
        lock(&state).0.count(Counters { statistics, ..Counters::default() });
    });
    let (film, _) = state.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(film)
}

/// The lock; should a thread have panicked, its panic will end the render anyway.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
