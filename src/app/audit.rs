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

/// The largest number of rays of one audit: at least a day's work. Except for rays with faults,
/// what an audit keeps of its rays does not grow with their number.
pub(crate) const MAX_RAYS: u64 = 1_000_000_000;

/// The text that `--help` prints after the options.
pub(crate) const HELP: &str = "\
Rays are made from the model's own surfaces, by class:
  random       from around the model to points of its bounding box
  aimed        in any direction through any point of a surface
  lengths      as aimed, with directions 1e-8 to 1e8 long
  ranges       as aimed, from before or behind the point, with ranges that begin
               behind the origin or end beyond the point
  borders      through borders: seams, shared edges, free edges
  lines        through knot lines and the lines that halve pieces
  corners      through points where such lines meet
  poles        through edges collapsed to a point (if the model has any)
  seam-planes  in the plane of three points of a border
  axes         parallel to an axis, in faces of bounding boxes too
  chords       through two points of one iso-parameter line: rulings
  trim-edges   through points of the edges that trims cut (if the model has any)
  grazing-k    past a silhouette at 1 - 10^-k and 1 + 10^-k radii of curvature
  tangents     in the tangent plane of a point, through it
  origins      starting on a surface, to within rounding
  leaving      leaving a hit, as secondary rays do
  far          as aimed, from a million sizes away

A third of the rays is traced one by one, a third in packets (except rays that
leave a hit), a third in batches of incoherent rays. Each is asked for its first
hit, and for whether anything is hit.

Columns, for each class:
  rays         rays made
  hits         rays for which the fast path has a hit
  misses       there is a certain hit, but the fast path, without doubt, has no
               first hit, or says that nothing is hit
  wrong        the fast path's hit lies behind a certain hit by more than the
               bound of t (JSON: wrong_roots)
  false        the fast path's hit has a residual above the bound; or lies
               outside the ray's range, or in what trims cut off, by more than
               its error bound; or the exact solver, without doubt, has no root
               there; or the fast path says that something is hit, and nothing
               is (JSON: false_hits)
  doubtful     rays whose first hit the fast path flags. Flagged answers are not
               judged. (Doubt about whether anything is hit is counted below the
               table; JSON: doubtful_any)
  undecided    rays for which the exact solver could not decide everything; its
               certain hits still count
  error        |S(u, v) - (o + t d)| / M over the hits without doubt: 50 % and
               99 % (at most 1/256 too large), the largest (JSON: error_50,
               error_99, error_max; null without such hits)
  if doubtful  the largest such error of a doubtful hit (JSON: error_doubtful)

Bounds. M is the largest coordinate magnitude of the ray's origin and the
surface's control points. The bound of the residual, for degrees p and q and
e = 2^-53, is b = 8 (p + q + 4) e M + 2 e (|u||S_u| + |v||S_v|): twice the
promise 4 (p + q + 4) e M, for the hit and for checking it, plus the rounding of
u and v. The bound of t, in units of length, is the sum of both hits' b over
|N.d|, at most 4 sqrt(b R) with R the radius of the model. Hits between which
the ray stays within b of the surface count as one.

Certain hits are
  - hits of the exact solver without doubt; but not within the bound of an end
    of the ray's range, nor where the ray passes outside a border by more than a
    quarter of the bound, nor where it passes a trim edge in what is cut off by
    more than the promise and the curve's rounding;
  - the point a ray was aimed at, if trims do not cut it off, and |N.d| >= 0.01
    or the point lies on a border; but not a border point of a triangle or
    subdivision surface that rounding of u and v may have put beyond the border
    by more than a quarter of the promise.
What trims keep is judged by even-odd against polylines within 1/1000 of the
domain of the trim curves, which the tracer does not know. Within twice that
distance of a polyline both sides pass, except for points of class trim-edges:
these are on the curves.

Doubt is counted in three groups: random (classes random and aimed: rays as
pictures have them), nasty (the others), and apart (tangents, origins, and rays
of other classes that are exactly tangent somewhere, as far as f64 can tell, or
run inside a surface). No rounded arithmetic can decide whether a ray in a
tangent plane meets the surface, or whether a ray that starts on it meets it at
its start: doubt is the right answer there. (Rays that say which root they
leave, as secondary rays do, are in class leaving.)

The exit code is 1 if there is a miss, a wrong root or a false hit. With --json
one object: input, rays, seed, kernel, threads, seconds, classes (a list; each
has class, group and the columns), groups (a list: group, rays, doubtful), total
(the columns). RAYS.npy has a row (origin, direction, t_min, t_max) for each ray
at fault, in the order of the classes; rays of class leaving start on the hit
they leave.

Example:
  nurbray audit scenes/teapot.toml --rays 1000000 --offenders offenders.npy";

/// Runs the subcommand.
pub(crate) fn run(arguments: &AuditArguments) -> Result<ExitCode, Failure> {
    let outputs: Vec<&Path> = arguments.offenders.iter().map(AsRef::as_ref).collect();
    outputs.iter().try_for_each(|output| output::check_npy(output))?;
    outputs.iter().try_for_each(|output| output::check_not_stdout(output))?;
    output::check(&outputs, &[&arguments.input])?;
    let scene = input::read(&arguments.input)?;
    let pool = threads::pool(None)?;
    let (world, _) = pool.install(|| input::prepare(&scene))?;
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

fn row(ray: &Ray) -> [f64; 8] {
    let [x, y, z] = ray.origin().to_array();
    let [dx, dy, dz] = ray.direction().to_array();
    [x, y, z, dx, dy, dz, ray.t_min(), ray.t_max()]
}
