//! Against POV-Ray: the same camera and lamp, in its own language.

use std::time::Duration;

use nurbray::intersect::Kernel;
use nurbray::io::{
    PovrayGap, PovrayScene, PovraySkip, Quoted, StagedFile, povray_scene, put_all_in_place,
};

use super::super::args::CompareArguments;
use super::super::failure::{Failure, OrFail};
use super::super::progress::Progress;
use super::super::race::{Measurement, Model, RaySet, Rays, tiled_pixels};
use super::super::{console, input, threads};
use super::errors::Errors;
use super::folder::Folder;
use super::heat::{self, Color, Scale};
use super::povray_report::{
    Findings, LEGEND, PICTURE, REPORT, Report, difference_file, scene_file,
};
use super::povray_run::{Povray, Rendering};
use super::sight::{self, Sight, View};

/// The colours of errors of brightness: from the last of 16 bits to black against white.
const BRIGHTNESS: Scale =
    Scale { quantity: "error of brightness (cosine between ray and normal)", low: -5, high: 0 };

/// The most surfaces named of those left out for one reason: a line or two, as `--help` says.
const NAMES: usize = 12;

/// Runs the comparison and writes the report.
pub(super) fn run(arguments: &CompareArguments) -> Result<(), Failure> {
    let tolerances = arguments.tolerances();
    let files = files(&tolerances);
    let folder = Folder::new(&arguments.output, &files, &[&arguments.input])?;
    let pool = threads::pool(Some(arguments.threads))?;
    let budget = Duration::from_secs_f64(arguments.seconds);
    let wanted = super::wanted_size(arguments);
    let model = pool.install(|| Model::load(&arguments.input, wanted, budget))?;
    folder.check_apart(&model.scene)?;
    input::warn_of_what_is_not_shown(&arguments.input, &model.scene);
    let size = super::size(&model.world)?;

    let scenes = scenes(&model, size, &tolerances)?;
    let (skipped, written) =
        scenes.first().map_or((&[][..], &[][..]), |scene| (&scene.skipped, &scene.written));
    let left_out = left_out(skipped, skipped.len() + written.len());
    left_out.iter().for_each(|line| console::warning(line));
    let povray = Povray::find().or_else(|reason| {
        // The scenes can be had without POV-Ray: somebody may render them elsewhere.
        put_all_in_place(stage_scenes(&folder, (&tolerances, &scenes))?).or_failed()?;
        let place = Quoted(&arguments.output);
        Err(Failure::work(format!("{reason}; its scenes are in {place}")))
    })?;
    let model = match skipped {
        [] => model,
        _ => pool.install(|| model.keeping(written, budget))?,
    };

    let rays = Rays::new(RaySet::Primary, &model, size);
    let kernels = [Kernel::default()];
    let measured =
        pool.install(|| Measurement::new(&model, &kernels, &[], &rays, arguments.seconds));
    let ours = pixels(&model, &rays, size);
    let renderings = renderings(&povray, &scenes, size, arguments.threads)?;
    let looks = renderings.iter().map(|rendering| look(&ours, rendering));
    let (findings, pictures): (Vec<_>, Vec<_>) = looks.unzip();
    let report = Report {
        model: &model,
        size,
        threads: arguments.threads,
        rival: &povray.name,
        measured: &measured,
        tolerances: &tolerances,
        renderings: &renderings,
        findings: &findings,
        left_out: &left_out,
        files: &files,
        hits: ours.iter().filter(|pixel| matches!(pixel, Pixel::Known(Some(_)))).count(),
        doubtful: ours.iter().filter(|&&pixel| pixel == Pixel::Doubtful).count(),
    };
    super::warn_if_empty(&model, report.hits, report.doubtful);

    // The report last, so that a report has its files.
    let mut written = stage_scenes(&folder, (&tolerances, &scenes))?;
    written.extend(stage_pictures(&folder, size, &ours, (&tolerances, &pictures))?);
    written.push(folder.stage(REPORT, &report.text())?);
    put_all_in_place(written).or_failed()?;
    console::print(&format!("{}\n", folder.at(REPORT).display()))
}

/// What POV-Ray makes of each scene.
fn renderings(
    povray: &Povray,
    scenes: &[PovrayScene],
    size: [u32; 2],
    threads: u16,
) -> Result<Vec<Rendering>, Failure> {
    let progress = Progress::new("rendering", scenes.len() as u64);
    let mut renderings = Vec::new();
    for (done, scene) in (1..).zip(scenes) {
        renderings.push(povray.render(&scene.text, size, threads).or_failed()?);
        progress.set(done, 0);
    }
    progress.finish();
    Ok(renderings)
}

/// The scene for each tolerance; each leaves out the same surfaces.
fn scenes(model: &Model, size: [u32; 2], tolerances: &[f64]) -> Result<Vec<PovrayScene>, Failure> {
    let mut scenes = Vec::new();
    for &tolerance in tolerances {
        let flatness = tolerance * model.diagonal;
        let written = povray_scene(&model.scene, &model.world, size, flatness);
        check(&written, tolerance, &model.name)?;
        scenes.push(written);
    }
    Ok(scenes)
}

/// What POV-Ray reads. Makes the folder.
fn stage_scenes(
    folder: &Folder,
    (tolerances, scenes): (&[f64], &[PovrayScene]),
) -> Result<Vec<StagedFile>, Failure> {
    folder.make()?;
    let scenes = scenes.iter().zip(tolerances);
    scenes.map(|(scene, &tolerance)| folder.stage(&scene_file(tolerance), &scene.text)).collect()
}

/// Our picture, and where POV-Ray's differ from it.
fn stage_pictures(
    folder: &Folder,
    size: [u32; 2],
    ours: &[Pixel],
    (tolerances, pictures): (&[f64], &[Vec<Color>]),
) -> Result<Vec<StagedFile>, Failure> {
    let grey: Vec<Color> = ours.iter().map(|&pixel| shade(pixel)).collect();
    let mut files = vec![heat::stage(&folder.at(PICTURE), size, &grey).or_failed()?];
    for (picture, &tolerance) in pictures.iter().zip(tolerances) {
        let path = folder.at(&difference_file(tolerance));
        files.push(heat::stage(&path, size, picture).or_failed()?);
    }
    files.push(folder.stage(LEGEND, &heat::legend(&[BRIGHTNESS], &heat::WORDS))?);
    Ok(files)
}

fn files(tolerances: &[f64]) -> Vec<String> {
    let fixed = [REPORT, PICTURE, LEGEND].map(str::to_owned);
    let of_tolerances = tolerances.iter().flat_map(|&t| [scene_file(t), difference_file(t)]);
    fixed.into_iter().chain(of_tolerances).collect()
}

/// Refuses scenes that hold nothing, or leave out a surface because of the tolerance alone.
fn check(scene: &PovrayScene, tolerance: f64, name: &str) -> Result<(), Failure> {
    let fine = |reason: &PovrayGap| matches!(reason, PovrayGap::TooFine { .. });
    if let Some(skip) = scene.skipped.iter().find(|skip| fine(&skip.reason)) {
        return Err(Failure::input(format!("tolerance {tolerance:e}: {skip}")));
    }
    let left_out = left_out(&scene.skipped, scene.skipped.len() + scene.written.len());
    match scene.written.is_empty() {
        false => Ok(()),
        true => {
            let reasons = left_out.join("; ");
            Err(Failure::input(format!("{name}: nothing is left to compare; {reasons}")))
        }
    }
}

/// Describes what is left out of this many surfaces, a line for each reason.
fn left_out(skipped: &[PovraySkip], surfaces: usize) -> Vec<String> {
    let mut reasons: Vec<(PovrayGap, Vec<&PovraySkip>)> = Vec::new();
    for skip in skipped {
        match reasons.iter_mut().find(|(reason, _)| *reason == skip.reason) {
            Some((_, alike)) => alike.push(skip),
            None => reasons.push((skip.reason, vec![skip])),
        }
    }
    let line = |(reason, alike): &(PovrayGap, Vec<&PovraySkip>)| match alike.as_slice() {
        [only] => only.to_string(),
        several => {
            let names = several.iter().take(NAMES).map(|skip| format!("\"{}\"", skip.name));
            let more = match several.len().saturating_sub(NAMES) {
                0 => String::new(),
                more => format!(" and {more} more"),
            };
            let names = names.collect::<Vec<_>>().join(", ");
            let count = several.len();
            format!(
                "{count} of {surfaces} surfaces are left out ({names}{more}), each because {reason}"
            )
        }
    };
    reasons.iter().map(line).collect()
}

/// A pixel lit by the lamp at the camera.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Pixel {
    /// The cosine between ray and normal, or nothing.
    Known(Option<f64>),
    /// We could not tell.
    Doubtful,
}

/// Our pixels, row by row; a hit without a normal is black, as it is in POV-Ray.
fn pixels(model: &Model, rays: &Rays, size: [u32; 2]) -> Vec<Pixel> {
    let views = sight::exact(model.world.bvh(), rays);
    let mut pixels = vec![Pixel::Doubtful; views.len()];
    for ((view, query), [x, y]) in views.iter().zip(&rays.queries).zip(tiled_pixels(size)) {
        let cosine = |sight: &Sight| match sight.normal.is_nan() {
            true => 0.0,
            false => sight.incidence(query.ray()),
        };
        pixels[y * size[0] as usize + x] = match view {
            View::Known(sight) => Pixel::Known(sight.as_ref().map(cosine)),
            View::Doubtful => Pixel::Doubtful,
        };
    }
    pixels
}

/// Compares both pictures.
fn look(ours: &[Pixel], rendering: &Rendering) -> (Findings, Vec<Color>) {
    let mut findings = Findings::default();
    let mut errors = Vec::new();
    let colors = ours.iter().zip(&rendering.cosines).map(|pixel| match pixel {
        (Pixel::Doubtful, _) => heat::DOUBTFUL,
        (Pixel::Known(None), None) => heat::NOTHING,
        (Pixel::Known(Some(_)), None) => {
            findings.lost += 1;
            heat::LOST
        }
        (Pixel::Known(None), Some(_)) => {
            findings.hits += 1;
            findings.invented += 1;
            heat::INVENTED
        }
        (Pixel::Known(Some(ours)), Some(theirs)) => {
            findings.hits += 1;
            let error = (ours - theirs).abs();
            errors.push(error);
            BRIGHTNESS.color(error)
        }
    });
    let colors = colors.collect();
    findings.brightness = Errors::of(errors);
    (findings, colors)
}

/// The colour of a pixel on a screen: brightness as grey (a power law near that of sRGB),
/// everything else as in the pictures of errors.
fn shade(pixel: Pixel) -> Color {
    match pixel {
        Pixel::Known(Some(cosine)) => [(255.0 * cosine.powf(1.0 / 2.2)).round() as u8; 3],
        Pixel::Known(None) => heat::NOTHING,
        Pixel::Doubtful => heat::DOUBTFUL,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_out_is_counted_by_reason() {
        let skip = |number: usize| PovraySkip {
            name: format!("s{number}"),
            reason: if number == 2 { PovrayGap::Trimmed } else { PovrayGap::Rational },
        };
        let told = |names: &str, count: usize| {
            let skipped: Vec<_> = (0..=count).map(skip).collect();
            let alike = format!(
                "{count} of 19 surfaces are left out ({names}), each because it is rational, and \
                 the patches of POV-Ray are polynomial"
            );
            assert_eq!(left_out(&skipped, 19), [alike, skipped[2].to_string()]);
        };
        told("\"s0\", \"s1\", \"s3\", \"s4\", \"s5\"", 5);
        let twelve = "\"s0\", \"s1\", \"s3\", \"s4\", \"s5\", \"s6\", \"s7\", \"s8\", \"s9\", \"s10\", \"s11\", \
                      \"s12\"";
        told(twelve, 12);
        told(&format!("{twelve} and 2 more"), 14);
        assert!(left_out(&[], 9).is_empty());
    }

    #[test]
    fn pixels_are_counted_by_what_both_see() {
        let known = [None, Some(0.5), Some(1.0), None].map(Pixel::Known);
        let ours = [&known[..], &[Pixel::Doubtful; 2]].concat();
        let theirs = vec![None, Some(0.25), None, Some(0.0), None, Some(0.5)];
        let rendering = Rendering {
            cosines: theirs,
            prepare_seconds: 0.0,
            trace_seconds: 0.0,
            total_seconds: 0.0,
        };
        let (found, colors) = look(&ours, &rendering);
        assert_eq!((found.hits, found.lost, found.invented), (2, 1, 1));
        assert_eq!(found.brightness.unwrap().mean, 0.25);
        assert_eq!([colors[0], colors[2], colors[3]], [heat::NOTHING, heat::LOST, heat::INVENTED]);
        assert_eq!(colors[4..], [heat::DOUBTFUL; 2]);
        let ends = [0.0, 1.0].map(|cosine| shade(Pixel::Known(Some(cosine))));
        assert_eq!(ends, [[0; 3], [255; 3]]);
    }
}
