//! `nurbray render`: a scene to pictures.

mod picture;
mod warnings;

use std::ffi::OsString;
use std::ops::ControlFlow;
use std::path::Path;
use std::process::ExitCode;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use nurbray::io::{ExrNotes, ExrPrecision, Quoted, WriteError, stage_png, write_exr};
use nurbray::render::{AovSet, Film, RenderSettings, render};
use nurbray::scene::{CameraSpec, IntegratorKind, Lens, Place, RenderDefaults, World};

use super::args::RenderArguments;
use super::failure::{Failure, OrFail};
use super::progress::{PATIENCE, Progress, duration};
use super::table::count;
use super::{console, input, output, threads};
use picture::{Format, Picture};
use warnings::{warn_of_bright_materials, warn_of_lost_numbers, warn_of_what_is_lost};

/// Progress is counted in thousandths, since only the renderer knows the number of tiles; no bar
/// is wider.
const PROGRESS_STEPS: u64 = 1000;

/// Runs the subcommand.
pub(crate) fn run(arguments: &RenderArguments) -> Result<ExitCode, Failure> {
    // Whatever can be refused is refused before the work begins.
    let pictures = picture::pictures(&arguments.outputs)?;
    let fixed_time = fixed_time()?;
    let paths: Vec<&Path> = pictures.iter().map(|picture| picture.path).collect();
    output::check(&paths, &[&arguments.input])?;
    let mut scene = input::read_apart(&arguments.input, &paths)?;
    let settings = settings(arguments, &scene.settings, &pictures)?;
    scene.settings.size = settings.size; // a camera that nobody placed shows the model in this size
    override_camera(arguments, &mut scene.camera)?;
    warn_of_what_is_lost(arguments, &pictures);

    let pool = threads::pool(arguments.work.threads)?;
    let (world, prepared) = pool.install(|| input::prepare(&scene, arguments.quiet))?;
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
    warn_of_lost_numbers(&film, world.camera(), &pictures);
    // With a fixed time, nothing in the file may tell one run from another.
    let when = match fixed_time {
        Some(time) => (time, None),
        None => (SystemTime::now(), Some(took)),
    };
    write_all(&pictures, |picture| write(picture, &film, &world, (arguments, when)))?;
    if !arguments.quiet {
        let took = [prepared, took];
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
        settings.size = [size.width, size.height];
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
        // An error about both is one of the command line.
        camera.place = Place::default();
        camera.look_at = camera.look_at.take().map(|at| at.value.into());
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

/// The time that `SOURCE_DATE_EPOCH` gives to all files, for builds that can be repeated
/// (reproducible-builds.org); `None` if it is not set.
///
/// # Errors
/// When it is no time that an EXR can hold: wrong use.
fn fixed_time() -> Result<Option<SystemTime>, Failure> {
    let Some(value) = std::env::var_os("SOURCE_DATE_EPOCH") else { return Ok(None) };
    let words = value.to_string_lossy();
    let time = time_of(&words).ok_or_else(|| {
        Failure::input(format!(
            "SOURCE_DATE_EPOCH is \"{}\": needed is a whole number of seconds since 1970, at most \
             {LAST_SECOND}, such as 1700000000",
            words.escape_debug()
        ))
    })?;
    Ok(Some(time))
}

/// The last second of the year 9999: dates of an EXR have years of four digits.
const LAST_SECOND: u64 = 253_402_300_799;

fn time_of(seconds: &str) -> Option<SystemTime> {
    let digits = seconds.bytes().all(|byte| byte.is_ascii_digit());
    let seconds = seconds.parse().ok().filter(|seconds| digits && *seconds <= LAST_SECOND)?;
    UNIX_EPOCH.checked_add(Duration::from_secs(seconds))
}

/// Writes each picture, even if another cannot be: rendering may have taken long.
///
/// # Errors
/// When one or more cannot be written: names them, and those that were.
fn write_all(
    pictures: &[Picture<'_>],
    write: impl Fn(&Picture<'_>) -> Result<(), WriteError>,
) -> Result<(), Failure> {
    let (mut written, mut errors) = (Vec::new(), Vec::new());
    for picture in pictures {
        match write(picture) {
            Ok(()) => written.push(picture.path),
            Err(error) => errors.push(error.to_string()),
        }
    }
    if errors.is_empty() {
        return Ok(());
    }
    if !written.is_empty() {
        errors.push(format!("wrote {}", output::listed(&written)));
    }
    Err(Failure::work(errors.join("; ")))
}

/// Writes a picture, made at a time within a duration, if that is to be told.
fn write(
    picture: &Picture<'_>,
    film: &Film,
    world: &World,
    (arguments, (time, duration)): (&RenderArguments, (SystemTime, Option<Duration>)),
) -> Result<(), WriteError> {
    match picture.format {
        Format::Exr => {
            let command = command_line(std::env::args_os());
            // The others are black where nothing is hit.
            let has_background = film.settings().integrator == IntegratorKind::Direct;
            let notes = ExrNotes {
                command: &command,
                time,
                duration,
                camera: world.camera(),
                background: if has_background { world.background() } else { [0.0; 3] },
            };
            write_exr(picture.path, film, ExrPrecision::Float, &notes)
        }
        Format::Png => {
            let exposure = arguments.exposure.unwrap_or(world.settings().exposure);
            // What a PNG leaves out was said before the work began.
            stage_png(picture.path, film, exposure)?.put_in_place()
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

/// What was drawn, in a line: size, samples, time, speed, doubt. `took` is the time of preparing and of tracing; the former is told if
/// somebody may have wondered about it.
fn summary(film: &Film, took: [Duration; 2]) -> String {
    let (settings, counters) = (film.settings(), film.counters());
    let [width, height] = settings.size;
    let [prepared, seconds] = took.map(|took| took.as_secs_f64());
    let after = if prepared < PATIENCE.as_secs_f64() {
        String::new()
    } else {
        format!(" after {} of preparing", duration(prepared))
    };
    let crop = settings.crop.map_or_else(String::new, |crop| format!(" (crop {crop})"));
    format!(
        "{width}x{height}{crop}, {} spp, {}{after}, {:.3} Mrays/s, {} doubtful of {}",
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
    fn times_are_whole_seconds_of_years_with_four_digits() {
        let at = |seconds| Some(UNIX_EPOCH + Duration::from_secs(seconds));
        assert_eq!([time_of("0"), time_of("1700000000")], [at(0), at(1_700_000_000)]);
        assert_eq!(time_of("253402300799"), at(LAST_SECOND));
        for wrong in ["", "+1", "-1", "1.5", "1e9", " 1", "253402300800", "99999999999999999999"] {
            assert_eq!(time_of(wrong), None, "{wrong}");
        }
    }

    #[test]
    fn the_command_line_can_be_typed_again() {
        let typed = ["/usr/bin/nurbray", "render", "my scene.toml", "-o", "a.exr", "it's", ""];
        let line = command_line(typed.into_iter().map(OsString::from));
        assert_eq!(line, r"nurbray render 'my scene.toml' -o a.exr 'it'\''s' ''");
    }
}
