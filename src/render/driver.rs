//! Rendering: all threads, all tiles, one film.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

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
    /// The progress callback said [`ControlFlow::Break`].
    #[error("the render was cancelled")]
    Cancelled,
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
/// It answers whether to go on. After [`ControlFlow::Break`], or a panic, it is not called again:
/// each thread ends with the tile that it is painting, and the render with
/// [`RenderError::Cancelled`], even if that was the last tile, or with the panic.
///
/// ```
/// use std::ops::ControlFlow;
///
/// use nurbray::render::{Channel, RenderError, RenderSettings, render};
/// use nurbray::scene::{NamedShape, Object, Scene, Shape, World};
///
/// let shape = Shape::Named(NamedShape::Sphere { radius: 1.0 }, Vec::new());
/// let objects = vec![Object { parts: vec![shape.into()], ..Default::default() }];
/// let scene = Scene { objects, ..Default::default() };
/// let world = World::new(&scene)?;
///
/// let settings = RenderSettings { size: [32, 24], samples: 0..4, ..Default::default() };
/// let film = render(&world, &settings, &|_| ControlFlow::Continue(()))?;
/// assert_eq!(film.value(Channel::A, [16, 12]), Some(1.0)); // the camera frames the sphere
/// assert_eq!(film.value(Channel::A, [0, 0]), Some(0.0));
///
/// // One that gives up: after its first tile, or when a user says so.
/// let cancelled = render(&world, &settings, &|_| ControlFlow::Break(()));
/// assert_eq!(cancelled, Err(RenderError::Cancelled));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the settings are refused, memory or threads cannot be obtained, or `progress` cancels.
pub fn render(
    world: &World,
    settings: &RenderSettings,
    progress: &(dyn Fn(Progress) -> ControlFlow<()> + Sync),
) -> Result<Film, RenderError> {
    let film = Film::new(settings)?;
    let grid = TileGrid::new(film.window());
    // More threads than tiles would only wait.
    let threads = settings.threads.min(grid.count());
    let pool = ThreadPoolBuilder::new().num_threads(threads).build().map_err(|error| {
        RenderError::Threads { threads: settings.threads, reason: error.to_string() }
    })?;

    let state = Mutex::new((film, 0));
    let next = AtomicUsize::new(0);
    let stop = Stop(AtomicBool::new(false));
    let neighbours = world.neighbours(settings.size);
    pool.broadcast(|_| {
        let _panics_stop_all = StopOnPanic(&stop);
        let mut painter = Painter::new(world, settings, neighbours);
        while !stop.is_set()
            && let Some(tile) = grid.get(next.fetch_add(1, Ordering::Relaxed))
        {
            let (pixels, counters) = painter.paint(tile);
            // The lock is poisoned if `progress` panicked.
            let Ok(mut state) = state.lock() else { return };
            if stop.is_set() {
                return;
            }
            let (film, tiles_done) = &mut *state;
            film.insert(pixels, counters);
            *tiles_done += 1;
            let (tiles_done, tiles) = (*tiles_done, grid.count());
            let answer = progress(Progress { tiles_done, tiles, rays: film.counters().rays });
            if answer.is_break() {
                stop.set();
            }
        }
        let statistics = painter.statistics();
        let Ok(mut state) = state.lock() else { return };
        state.0.count(Counters { statistics, ..Counters::default() });
    });
    if stop.is_set() {
        return Err(RenderError::Cancelled);
    }
    let (film, _) = state.into_inner().unwrap_or_else(PoisonError::into_inner);
    Ok(film)
}

/// Whether all threads are to end. It guards no data: the lock of the film orders what matters.
struct Stop(AtomicBool);

impl Stop {
    fn set(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    fn is_set(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Stops the other threads when its own panics: the panic ends the render, but only after all
/// threads have ended.
struct StopOnPanic<'a>(&'a Stop);

impl Drop for StopOnPanic<'_> {
    fn drop(&mut self) {
        if thread::panicking() {
            self.0.set();
        }
    }
}
