//! `nurbray render`: a scene to pictures.

mod picture;

use std::ffi::OsString;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant, SystemTime};

use nurbray::io::{
    ExrNotes, ExrPrecision, Quoted, StagedFile, put_all_in_place, stage_exr, stage_png,
};
use nurbray::math::Shown;
use nurbray::render::{AovSet, Film, RenderSettings, render};
use nurbray::scene::{CameraSpec, IntegratorKind, Lens, RenderDefaults, Scene, World, Written};

use super::args::RenderArguments;
use super::failure::{Failure, OrFail};
use super::progress::{Progress, duration};
use super::table::count;
use super::{console, input, output, threads};
use picture::{Format, Picture};

/// Progress is counted in thousandths, since only the renderer knows the number of tiles; no bar
/// is wider.
const PROGRESS_STEPS: u64 = 1000;

/// Runs the subcommand.
pub(crate) fn run(arguments: &RenderArguments) -> Result<ExitCode, Failure> {
    // Whatever can be refused is refused before the work begins.
    let pictures = picture::pictures(&arguments.outputs)?;
    let paths: Vec<&Path> = pictures.iter().map(|picture| picture.path).collect();
    output::check(&paths, &[&arguments.input])?;
    let mut scene = input::read(&arguments.input)?;
    let settings = settings(arguments, &scene.settings, &pictures)?;
    scene.settings.size = settings.size; // a camera that nobody placed shows the model in this size
    override_camera(arguments, &mut scene.camera)?;
    warn_of_what_is_lost(arguments, &pictures);

    let pool = threads::pool(arguments.work.threads)?;
    let (world, _) = pool.install(|| input::prepare(&scene))?;
    drop(pool); // rendering has threads of its own
    input::warn_of_what_is_not_shown(&arguments.input, &scene);
    warn_of_bright_materials(&scene);

    let start = Instant::now();
    let progress = match arguments.quiet {
        true => Progress::silent(),
        false => Progress::new("rendering", PROGRESS_STEPS),
    };
    let film = render(&world, &settings, &|at| {
        progress.set(at.tiles_done as u64 * PROGRESS_STEPS / at.tiles.max(1) as u64, at.rays);
        ControlFlow::Continue(())
    });
    progress.finish();
    let (film, took) = (film.or_failed()?, start.elapsed());
    // A crop may well be meant to be empty.
    let seen = film.counters().hits + film.counters().doubtful;
    if seen == 0 && settings.crop.is_none() {
        input::warn_of_nothing_seen(&arguments.input.display().to_string());
    }
    let staged = pictures.iter().map(|picture| stage(picture, &film, &world, (arguments, took)));
    put_all_in_place(staged.collect::<Result<_, _>>()?).or_failed()?;
    if !arguments.quiet {
        console::say(&format!("{}; wrote {}", summary(&film, took), output::listed(&paths)));
    }
    Ok(ExitCode::SUCCESS)
}

/// The settings of the command line and, where it gives none, of the scene.
fn settings(
    arguments: &RenderArguments,
    scene: &RenderDefaults,
    pictures: &[Picture<'_>],
) -> Result<RenderSettings, Failure> {
    let mut settings = RenderSettings::from(scene);
    if let Some(size) = arguments.size {
        settings.size = (size.width, size.height);
    }
    if let Some(spp) = arguments.spp {
        settings.samples = 0..spp;
    }
    if let Some(range) = arguments.samples {
        if arguments.spp.is_some_and(|spp| range.end > spp) {
            let (end, spp) = (range.end, settings.samples.end);
            return Err(Failure::input(format!(
                "--samples up to {end}: --spp {spp} has the samples 0 to {} only",
                spp - 1
            )));
        }
        settings.samples = range.first..range.end;
    }
    settings.crop = arguments.crop;
    // A PNG can hold none of them.
    settings.aovs = match arguments.aov {
        Some(aovs) => aovs,
        None if picture::all(pictures, Format::Png) => AovSet::NONE,
        None => AovSet::of_hits(),
    };
    settings.integrator = arguments.integrator.unwrap_or(settings.integrator);
    settings.seed = arguments.seed.unwrap_or(settings.seed);
    settings.threads = arguments.work.threads.map_or(0, usize::from);
    settings.kernel = arguments.work.kernel.kernel;
    settings.check().or_bad_input()?;
    Ok(settings)
}

/// Moves the camera as the command line says. The new values have no place in the scene, so
/// errors will name none.
fn override_camera(arguments: &RenderArguments, camera: &mut CameraSpec) -> Result<(), Failure> {
    if let Some(look_from) = arguments.look_from {
        camera.look_from = Some(look_from.into());
        camera.look_at = None; // the centre, unless --look-at says otherwise
    }
    if let Some(look_at) = arguments.look_at {
        camera.look_at = Some(look_at.into());
    }
    if let Some(up) = arguments.up {
        camera.up = Some(up.into());
    }
    match (&mut camera.lens, arguments.fov) {
        (_, None) => Ok(()),
        (Lens::Perspective { fov }, Some(given)) => {
            *fov = Some(given.into());
            Ok(())
        }
        (Lens::Orthographic { .. }, Some(_)) => Err(Failure::input(format!(
            "--fov: the camera of {} is orthographic and has no field of view",
            Quoted(&arguments.input)
        ))),
    }
}

/// Warns of options that change nothing in any file.
fn warn_of_what_is_lost(arguments: &RenderArguments, pictures: &[Picture<'_>]) {
    let Some(first) = pictures.first().map(|picture| picture.path.display()) else { return };
    if let Some(aovs) = arguments.aov.filter(|aovs| !aovs.is_empty())
        && picture::all(pictures, Format::Png)
    {
        console::warning(&format!(
            "{first}: a PNG holds colour only, {aovs} will be in no file; -o with an .exr holds \
             them"
        ));
    }
    if arguments.exposure.is_some() && picture::all(pictures, Format::Exr) {
        console::warning(&format!(
            "{first}: an EXR holds light as it is, --exposure is for a .png and changes nothing"
        ));
    }
}

/// Warns of materials that send back more light than falls on them: likely meant to be 0 to 1.
fn warn_of_bright_materials(scene: &Scene) {
    for Written { value: material, place } in &scene.materials {
        let largest = material.largest_albedo();
        if largest > 1.0 {
            let place = if place.label().is_some() { format!("{place}: ") } else { String::new() };
            console::warning(&format!(
                "{place}material \"{}\" sends back {} times the light that falls on it; \
                 colours of things are from 0 to 1",
                material.name,
                Shown(largest)
            ));
        }
    }
}

/// Writes a picture to a file that is not yet put in its place.
fn stage(
    picture: &Picture<'_>,
    film: &Film,
    world: &World,
    (arguments, took): (&RenderArguments, Duration),
) -> Result<StagedFile, Failure> {
    match picture.format {
        Format::Exr => {
            let command = command_line(std::env::args_os());
            // The others are black where nothing is hit.
            let has_background = film.settings().integrator == IntegratorKind::Direct;
            let notes = ExrNotes {
                command: &command,
                time: SystemTime::now(),
                duration: Some(took),
                camera: world.camera(),
                background: if has_background { world.background() } else { [0.0; 3] },
            };
            stage_exr(picture.path, film, ExrPrecision::Float, &notes).or_failed()
        }
        Format::Png => {
            let exposure = arguments.exposure.unwrap_or(world.settings().exposure);
            // What a PNG leaves out was said before the work began.
            stage_png(picture.path, film, exposure).or_failed()
        }
    }
}

/// The command as it can be typed again.
fn command_line(arguments: impl Iterator<Item = OsString>) -> String {
    let plain = |c: char| c.is_alphanumeric() || "-_./,=:+@%".contains(c);
    let quoted = arguments.enumerate().map(|(index, argument)| {
        let argument = match index {
            0 => "nurbray".into(),
            _ => argument.to_string_lossy().into_owned(),
        };
        match !argument.is_empty() && argument.chars().all(plain) {
            true => argument,
            false => format!("'{}'", argument.replace('\'', r"'\''")),
        }
    });
    quoted.collect::<Vec<_>>().join(" ")
}

/// Size, samples, time, speed, doubt.
fn summary(film: &Film, took: Duration) -> String {
    let (settings, counters) = (film.settings(), film.counters());
    let (width, height) = settings.size;
    let seconds = took.as_secs_f64();
    let crop = settings.crop.map_or_else(String::new, |crop| format!(" (crop {crop})"));
    format!(
        "{width}x{height}{crop}, {} spp, {}, {:.3} Mrays/s, {} doubtful of {}",
        settings.samples.len(),
        duration(seconds),
        counters.rays as f64 / seconds.max(f64::MIN_POSITIVE) * 1e-6,
        counters.doubtful,
        count(counters.rays, "ray"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_command_line_can_be_typed_again() {
        let typed = ["/usr/bin/nurbray", "render", "my scene.toml", "-o", "a.exr", "it's", ""];
        let line = command_line(typed.into_iter().map(OsString::from));
        assert_eq!(line, r"nurbray render 'my scene.toml' -o a.exr 'it'\''s' ''");
    }
}
