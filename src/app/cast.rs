//! `nurbray cast`: rays from a file, hits into a file.

mod table;
mod trace;

use std::process::ExitCode;
use std::time::Instant;

use nurbray::intersect::Coherence;
use nurbray::io::{read_rays, write_parts};
use nurbray::math::Ray;
use serde_json::json;

use super::args::CastArguments;
use super::failure::{Failure, OrFail};
use super::progress::Progress;
use super::table::count;
use super::{console, input, output, threads};
use trace::{Traced, Tracing};

/// Runs the subcommand.
pub(crate) fn run(arguments: &CastArguments) -> Result<ExitCode, Failure> {
    output::check_npy(&arguments.output)?;
    if arguments.json {
        output::check_not_stdout(&arguments.output)?;
    }
    output::check(&[&arguments.output], &[&arguments.input, &arguments.rays])?;
    let rays = read_rays(&arguments.rays).or_bad_input()?;
    let scene = input::read_apart(&arguments.input, &[&arguments.output])?;
    let pool = threads::pool(arguments.work.threads)?;
    let (world, build) = pool.install(|| input::prepare(&scene, arguments.quiet))?;
    input::warn_of_what_is_not_shown(&arguments.input, &scene);

    let tracing = Tracing {
        bvh: world.bvh(),
        kernel: arguments.work.kernel.kernel,
        coherence: if arguments.coherent { Coherence::Coherent } else { Coherence::Incoherent },
    };
    let (counts, seconds) = if arguments.all {
        cast(arguments, &rays, |rays, progress| {
            pool.install(|| trace::all_hits(&tracing, rays, progress))
        })?
    } else {
        cast(arguments, &rays, |rays, progress| {
            pool.install(|| trace::first_hits(&tracing, rays, progress))
        })?
    };

    let bytes = world.bvh().bytes();
    let threads = pool.current_num_threads();
    if arguments.json {
        console::print_json(&json!({
            "rays": rays.len(),
            "hits": counts.hits,
            "doubtful": counts.doubtful,
            "build_seconds": build.as_secs_f64(),
            "trace_seconds": seconds,
            "bytes": bytes,
            "threads": threads,
            "kernel": tracing.kernel.name(),
        }))?;
    } else if !arguments.quiet {
        let rate = rays.len() as f64 / seconds.max(f64::MIN_POSITIVE) * 1e-6;
        let summary = format!(
            "{}, {}, {} doubtful; {seconds:.3} s on {} ({rate:.3} Mrays/s, kernel {}); wrote {}",
            count(rays.len() as u64, "ray"),
            count(counts.hits, "hit"),
            counts.doubtful,
            count(threads as u64, "thread"),
            tracing.kernel,
            arguments.output.display(),
        );
        match output::is_stdout(&arguments.output) {
            true => console::say(&summary),
            false => console::print(&format!("{summary}\n"))?,
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Hits and doubtful rays.
#[derive(Clone, Copy, Debug)]
struct Counts {
    hits: u64,
    doubtful: u64,
}

/// Traces and writes; returns the counts and the seconds that tracing took.
fn cast<const N: usize>(
    arguments: &CastArguments,
    rays: &[Ray],
    trace: impl FnOnce(&[Ray], &Progress) -> Traced<N>,
) -> Result<(Counts, f64), Failure> {
    let progress = match arguments.quiet {
        true => Progress::silent(),
        false => Progress::new("casting", rays.len() as u64),
    };
    let start = Instant::now();
    let traced = trace(rays, &progress);
    let seconds = start.elapsed().as_secs_f64();
    progress.finish();
    write_parts(&arguments.output, &traced.rows).or_failed()?;
    Ok((Counts { hits: traced.hits, doubtful: traced.doubtful }, seconds))
}
