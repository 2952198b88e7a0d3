//! INPUT: a scene or a bare model, read and made ready to trace.

use std::path::Path;
use std::time::{Duration, Instant};

use nurbray::io::load_input;
use nurbray::scene::{Scene, World};

use super::failure::{Failure, OrFail};

/// Reads a scene or a bare model.
///
/// # Errors
/// When the file is missing, damaged or wrong: bad input.
pub(crate) fn read(path: &Path) -> Result<Scene, Failure> {
    load_input(path).or_bad_input()
}

/// Makes a scene ready to trace and says how long that took.
///
/// # Errors
/// When the scene cannot be built as its author wrote it: bad input.
pub(crate) fn prepare(scene: &Scene) -> Result<(World, Duration), Failure> {
    let start = Instant::now();
    let world = World::new(scene).or_bad_input()?;
    Ok((world, start.elapsed()))
}
