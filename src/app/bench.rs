//! `nurbray bench`: how fast rays are traced, by us and by a rival.

mod panel;
mod report;

use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;

use nurbray::io::Embree;
use nurbray::scene::Placed;

use super::args::BenchArguments;
use super::chart::{self, Panel};
use super::failure::{Failure, OrFail};
use super::progress::Progress;
use super::race::{Measurement, Model, Rays, Rival};
use super::{console, input, output, threads};
use report::Report;

/// The text that `--help` prints after the options.
pub(crate) const HELP: &str = "\
Ray sets; N is --size:
  primary            the camera's rays through the middles of N x N pixels, in
                     packets: tiles of 64 x 64 pixels, in each a Z-order curve,
                     so that 16 rays are 4 x 4 pixels; if leaves are smaller
                     than two pixels, in batches, as pictures are traced
  single             the same rays in the same order, one call a ray; nurbray's
                     answers are dropped as they come, Embree's stay in its rays
  incoherent         N x N chords of a sphere around the model (1 % wider than
                     it), in batches
  incoherent-single  the same chords, one call a ray
  ao                 any hit of ambient-occlusion rays: from each exact hit of
                     the primary rays one ray in a random direction around the
                     normal (cosine), 1/5 of the model's diagonal long; in
                     packets if leaves are wider than 1.5 pixels, else in
                     batches
  shadow             any hit on the way from those hits to the scene's first
                     lamp, if they face it; in packets if leaves are wider than
                     two pixels, else in batches
Rays are made before the clock starts, the same for all kernels, for the rival
and in every run; they lie in memory, Embree's in the packets it wants.

Speed: the median of 5 rounds, and (largest - smallest) / median as spread.
Kernels and rival take turns in each round; before the first, each traces all
rays once. All use the same number of threads, which take 4096 rays at a time.

For several models or numbers of threads, a table at the end has a line each.

The diagonal is that of the hierarchy's bounding box, up to some 2e-3 longer than
that of the surfaces' own, which nurbray info gives.

Bytes a Bezier patch: everything that tracing needs, divided by the number of
patches that the surfaces are cut into at their knots (a triangular patch is
three of these; trims and the hierarchy count, too).

--against embree: RTC_GEOMETRY_TYPE_GRID, a grid a knot span, with flag ROBUST;
libembree4 or libembree3, or the library named by EMBREE_LIB. Every knot span is
cut evenly, as often as is needed for the sampled distance between surface and
triangles to stay within tolerance x diagonal; cells that trims cut become
trapezoids, grids of their own, along chords equally near to the trim curves.
rtcIntersect1 (rtcOccluded1) for single rays; else the fastest of 1, 8 and 16.
Triangles and rays are moved to the middle of the bounding box and scaled by a
power of two to a size between 1 and 2, which suits Embree's constants best.
tnear is 0, except for rays that leave a surface: twice the tolerance. (nurbray
needs none.) A ray differs in t if the rival's hit is farther from the tangent
plane of ours than the tolerance.

With --json one object a line, for each model, ray set, kernel and tolerance:
  model, rays (the set), count, kernel, threads, mrays_per_s, spread, hits,
  doubtful (rays), radius (ao: the rays' length)
  file_seconds    from the file to ready
  build_seconds   from the placed surfaces to ready, part of file_seconds
  total_seconds   from the file to the last ray
  bytes           everything tracing needs
  pieces          Bezier patches: bytes / pieces is the memory a patch
and with a rival:
  rival (embree), rival_version, rival_width (rays a packet), tolerance,
  rival_mrays_per_s, rival_spread, rival_hits, rival_triangles
  rival_plan_seconds
                  to find out how often to cut; part of no other figure
  rival_build_seconds
                  to make the vertices (on one thread), fill the buffers,
                  rtcCommitScene
  rival_commit_seconds
                  the last two of these
  rival_total_seconds
                  as total_seconds, with rival_build_seconds instead of
                  build_seconds
  rival_bytes     what Embree reports, vertices included; normals and (u, v) are
                  not
  rival_tnear, hit_disagreements, t_disagreements
                  (rays; the last not of those that ask for any hit)
  ratio           mrays_per_s / rival_mrays_per_s
Preparations are repeated up to 9 times; their figures are those of the run that
took the median time.

Example:
  nurbray bench scenes/teapot.json --against embree --tolerance 1e-3,1e-5
  nurbray bench scenes/octant_sphere.toml scenes/goblet.toml scenes/doo_sabin_body.toml";

/// Runs the subcommand.
pub(crate) fn run(arguments: &BenchArguments) -> Result<ExitCode, Failure> {
    let inputs: Vec<&Path> = arguments.inputs.iter().map(AsRef::as_ref).collect();
    let outputs: Vec<&Path> = arguments.plot.iter().map(AsRef::as_ref).collect();
    outputs.iter().try_for_each(|path| output::check_svg(path))?;
    outputs.iter().try_for_each(|path| output::check_not_stdout(path))?;
    output::check(&outputs, &inputs)?;
    // Errors even in the last input are reported before the first is measured.
    for input in &inputs {
        let scene = input::read(input)?;
        input::warn_of_what_is_not_shown(input, &scene);
        Placed::new(&scene).or_bad_input()?;
    }

    let (mut panels, mut rows) = (Vec::new(), Vec::new());
    for &threads in &arguments.thread_counts() {
        let embree = match &arguments.against {
            Some(_) => Some(Embree::load_with_threads(threads).or_failed()?),
            None => None,
        };
        let pool = threads::pool(Some(threads))?;
        for input in &inputs {
            let bout = Bout { arguments, threads, embree: embree.as_ref() };
            let Fought { text, panels: drawn, row } = pool.install(|| bout.fight(input))?;
            let gap = if panels.is_empty() || arguments.json { "" } else { "\n" };
            console::print(&format!("{gap}{text}"))?;
            panels.push(drawn);
            rows.push(row);
        }
    }
    if rows.len() > 1 && !arguments.json {
        let summary = report::summary(&arguments.ray_sets(), rows);
        console::print(&format!("\n{summary}"))?;
    }
    if let Some(path) = &arguments.plot {
        chart::write(path, &panels).or_failed()?;
    }
    if panels.iter().all(Vec::is_empty) {
        return Err(Failure::work("nothing was measured: there are no such rays"));
    }
    Ok(ExitCode::SUCCESS)
}

/// The results of one model on one number of threads.
struct Fought {
    /// What to print.
    text: String,
    /// What to draw.
    panels: Vec<Panel>,
    /// Its row in a table of several.
    row: Vec<String>,
}

/// One model on one number of threads.
#[derive(Clone, Copy)]
struct Bout<'a> {
    arguments: &'a BenchArguments,
    threads: u16,
    embree: Option<&'a Embree>,
}

impl Bout<'_> {
    /// Measures everything asked for.
    fn fight(self, input: &Path) -> Result<Fought, Failure> {
        let arguments = self.arguments;
        let seconds = arguments.seconds;
        let budget = Duration::from_secs_f64(seconds);
        let model = Model::load(input, Some([arguments.size; 2]), budget)?;
        let mut rivals = Vec::new();
        if let Some(embree) = self.embree {
            for tolerance in arguments.tolerances() {
                rivals.push(Rival::build(embree, &model, tolerance, budget)?.0);
            }
        }

        let sets = arguments.ray_sets();
        let progress = Progress::new("measuring", sets.len() as u64);
        let mut measurements = Vec::new();
        for (done, &set) in sets.iter().enumerate() {
            let rays = Rays::new(set, &model, [arguments.size; 2]);
            if rays.len() == 0 {
                console::warning(&format!("{}: there are no {set} rays", model.name));
                continue;
            }
            let kernels = arguments.kernels();
            measurements.push(Measurement::new(&model, &kernels, &rivals, &rays, seconds));
            progress.set(done as u64 + 1, 0);
        }
        progress.finish();

        let rival = self.rival();
        let report = Report {
            model: &model,
            threads: self.threads,
            rival: &rival,
            rivals: &rivals,
            measurements: &measurements,
        };
        let text = if arguments.json {
            report.json().iter().map(|line| format!("{line}\n")).collect()
        } else {
            report.text()
        };
        let panel = |measured| panel::speed(&model.name, self.threads, (&rival, measured));
        let panels = measurements.iter().map(panel).collect();
        Ok(Fought { text, panels, row: report.row(&sets) })
    }

    /// What the rival is called, with its version.
    fn rival(self) -> String {
        self.embree.map_or_else(String::new, |embree| {
            let [major, minor, patch] = embree.version();
            format!("embree {major}.{minor}.{patch}")
        })
    }
}
