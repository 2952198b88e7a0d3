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

/// Runs the subcommand.
pub(crate) fn run(arguments: &BenchArguments) -> Result<ExitCode, Failure> {
    let inputs: Vec<&Path> = arguments.inputs.iter().map(AsRef::as_ref).collect();
    let outputs: Vec<&Path> = arguments.plot.iter().map(AsRef::as_ref).collect();
    outputs.iter().try_for_each(|path| output::check_svg(path))?;
    outputs.iter().try_for_each(|path| output::check_not_stdout(path))?;
    output::check(&outputs, &inputs)?;
    // Errors even in the last input are reported before the first is measured.
    for input in &inputs {
        let scene = input::read_apart(input, &outputs)?;
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
    if panels.iter().all(Vec::is_empty) {
        return Err(Failure::work("nothing was measured: there are no such rays"));
    }
    if let Some(path) = &arguments.plot {
        chart::write(path, &panels).or_failed()?;
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
