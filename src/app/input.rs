//! INPUT: a scene or a bare model, read and made ready to trace.

use std::path::Path;
use std::time::{Duration, Instant};

use nurbray::io::{Quoted, load_input};
use nurbray::scene::{Scene, World};

use super::failure::{Failure, OrFail};
use super::{console, output, progress};

/// Reads a scene or a bare model.
///
/// # Errors
/// When the file is missing, damaged or wrong: bad input.
pub(crate) fn read(path: &Path) -> Result<Scene, Failure> {
    load_input(path).or_bad_input()
}

/// Reads a scene or a bare model for a run that writes these files.
///
/// # Errors
/// As [`read`], and when one of them is a model that the scene is made of: wrong use.
pub(crate) fn read_apart(path: &Path, outputs: &[&Path]) -> Result<Scene, Failure> {
    let scene = read(path)?;
    output::check_apart(outputs, &scene)?;
    Ok(scene)
}

/// Warns of what a scene, about to be traced or drawn, does not show of its files.
pub(crate) fn warn_of_what_is_not_shown(path: &Path, scene: &Scene) {
    if let [first, others @ ..] = scene.notes.as_slice() {
        let more = match others.len() {
            0 => String::new(),
            number => format!(", and {number} more (nurbray info {} lists all)", Quoted(path)),
        };
        console::warning(&format!("not imported: {first}{more}"));
    }
}

/// Warns that no ray of the camera has hit anything.
pub(crate) fn warn_of_nothing_seen(name: &str) {
    console::warning(&format!("{name}: the camera sees nothing of the model"));
}

/// Makes a scene ready to trace and returns how long that took. If it takes long, and is not to be
/// quiet, it says that it is still at it.
///
/// # Errors
/// When the scene cannot be built as its author wrote it: bad input.
pub(crate) fn prepare(scene: &Scene, quiet: bool) -> Result<(World, Duration), Failure> {
    let start = Instant::now();
    let world = match quiet {
        true => World::new(scene),
        false => progress::patiently("preparing the surfaces ...", || World::new(scene)),
    };
    Ok((world.or_bad_input()?, start.elapsed()))
}
