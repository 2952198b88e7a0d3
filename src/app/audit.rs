//! `nurbray audit`: the fast path against the exact solver, on random and nasty rays.

mod check;
mod class;
mod judge;
mod outlines;
mod rays;
mod report;
mod sites;
mod tally;

use std::path::Path;
use std::process::ExitCode;
use std::time::Instant;

use nurbray::io::write_rows;
use nurbray::math::Ray;
use serde_json::json;

use super::args::AuditArguments;
use super::failure::{Failure, OrFail};
use super::progress::Progress;
use super::table::count;
use super::{console, input, output, threads};
use check::Audit;
use report::Report;

/// Runs the subcommand.
pub(crate) fn run(arguments: &AuditArguments) -> Result<ExitCode, Failure> {
    let outputs: Vec<&Path> = arguments.offenders.iter().map(AsRef::as_ref).collect();
    outputs.iter().try_for_each(|output| output::check_npy(output))?;
    outputs.iter().try_for_each(|output| output::check_not_stdout(output))?;
    output::check(&outputs, &[&arguments.input])?;
    let scene = input::read_apart(&arguments.input, &outputs)?;
    let pool = threads::pool(None)?;
    let (world, _) = pool.install(|| input::prepare(&scene, false))?;
    input::warn_of_what_is_not_shown(&arguments.input, &scene);
    let surfaces: Vec<_> =
        world.surfaces().iter().map(|instance| instance.surface.clone()).collect();

    let kernel = arguments.kernel.kernel;
    let what = Audit { bvh: world.bvh(), surfaces: &surfaces, kernel, seed: arguments.seed };
    let progress = Progress::new("auditing", arguments.rays);
    let start = Instant::now();
    let classes =
        pool.install(|| check::audit(&what, arguments.rays, &|count| progress.add_rays(count)));
    let seconds = start.elapsed().as_secs_f64();
    progress.finish();

    let offenders: Vec<Ray> =
        classes.iter().flat_map(|(_, tally)| tally.offenders()).copied().collect();
    let report = Report::new(classes);
    let threads = pool.current_num_threads();
    let printed = if arguments.json {
        let [classes, groups, total] = report.json();
        console::print_json(&json!({
            "input": arguments.input.display().to_string(),
            "rays": arguments.rays,
            "seed": arguments.seed,
            "kernel": kernel.name(),
            "threads": threads,
            "seconds": seconds,
            "classes": classes,
            "groups": groups,
            "total": total,
        }))
    } else {
        let (rays, workers) = (count(arguments.rays, "ray"), count(threads as u64, "thread"));
        let settings = format!("{rays}, seed {}, kernel {kernel}, {workers}", arguments.seed);
        console::print(&format!("{settings}\n\n{}\n{}", report.table(), report.verdict()))
    };
    // If one of the two outputs cannot be written, the other one still is.
    if let Some(path) = &arguments.offenders {
        let rows: Vec<[f64; 8]> = offenders.iter().map(row).collect();
        write_rows(path, &rows).or_failed()?;
    }
    printed?;
    match report.accusation() {
        None => Ok(ExitCode::SUCCESS),
        Some(accusation) => Err(Failure::work(accusation)),
    }
}

/// A ray as `cast` reads it: origin, direction, range.
fn row(ray: &Ray) -> [f64; 8] {
    let [x, y, z] = ray.origin().to_array();
    let [dx, dy, dz] = ray.direction().to_array();
    [x, y, z, dx, dy, dz, ray.t_min(), ray.t_max()]
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn offenders_are_written_as_rays_are_read() {
        let (origin, direction) = (DVec3::new(1.0, 2.0, 3.0), DVec3::new(4.0, 5.0, 6.0));
        let ray = Ray::with_range(origin, direction, 7.0, 8.0).unwrap();
        assert_eq!(row(&ray), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0]);
    }
}
