//! `nurbray compare`: traces the same camera's rays another way and reports what differs.

mod embree;
mod errors;
mod folder;
mod heat;
mod povray;
mod povray_report;
mod povray_run;
mod report;
mod sight;
mod table;
mod verdict;

use std::process::ExitCode;

use nurbray::scene::World;

use super::args::{Against, CompareArguments};
use super::failure::Failure;
use super::input;
use super::race::{MAX_SIDE, Model};

/// The text that `--help` prints after the options.
pub(crate) const HELP: &str = "\
One ray through the middle of each pixel, the same rays both ways, in the same
run.

--against embree: the surfaces are cut into triangles that stay within each
tolerance (see `nurbray bench --help` for how), and Embree traces those. DIR
gets
  report.md               triangles, build time, memory, rays/s and total time;
                          errors of position and normal; silhouette pixels that
                          differ; rays lost and invented
  plot.svg                speed, memory and errors over the tolerance
  picture.png             the surfaces as the camera sees them
  position-TOLERANCE.png  error of the triangles' positions, pixel by pixel
  normal-TOLERANCE.png    error of their interpolated normals, pixel by pixel
  legend.svg              the colours of these errors
--against povray: the scene is written for POV-Ray 3.7 with a lamp at the
camera, so that a pixel is the cosine between ray and normal; its bicubic
patches are flat to within each tolerance. The program `povray`, or the one
named by POVRAY, renders it. Surfaces POV-Ray cannot be told exactly are left
out on both sides; the first twelve for each reason are named. DIR gets
  report.md                 times; errors of brightness; pixels lost and
                            invented
  scene-TOLERANCE.pov       what POV-Ray reads
  picture.png               our picture with the same lamp
  difference-TOLERANCE.png  difference of brightness, pixel by pixel
  legend.svg                the colours of these differences

The rival is given its best case: its scene is moved to the middle of the
model's bounding box and scaled by a power of two, to a size between 1 and 2.
(Not so where many trim curves cut one cell of the tessellation: a plane with a
thousand holes gets far more triangles than it needs.)
Rays whose own answer nurbray flags as doubtful are left out and counted. The
report lists the files written with it; other files in DIR stay. All are written
at the end, the report last. Without POV-Ray the command fails, but leaves the
scenes in DIR, to be rendered elsewhere. Everything except times, rates and
memory is the same in every run.

Example:
  nurbray compare scenes/teapot.toml --against embree --tolerance 1e-3,1e-4,1e-5 -o teapot-embree";

/// Runs the subcommand.
pub(crate) fn run(arguments: &CompareArguments) -> Result<ExitCode, Failure> {
    match arguments.against {
        Against::Embree => embree::run(arguments)?,
        Against::Povray => povray::run(arguments)?,
    }
    Ok(ExitCode::SUCCESS)
}

/// Warns if there is nothing to compare.
fn warn_if_empty(model: &Model, hits: usize, doubtful: usize) {
    if hits + doubtful == 0 {
        input::warn_of_nothing_seen(&model.name);
    }
}

/// Width and height of the pictures, if the command line gives them.
fn wanted_size(arguments: &CompareArguments) -> Option<[u32; 2]> {
    arguments.size.map(|size| [size.width, size.height])
}

/// Width and height of the pictures.
fn size(world: &World) -> Result<[u32; 2], Failure> {
    let size: [u32; 2] = world.settings().size.into();
    match size {
        [..=MAX_SIDE, ..=MAX_SIDE] => Ok(size),
        [width, height] => Err(Failure::input(format!(
            "{width} x {height} pixels: a comparison has at most {MAX_SIDE} each way"
        ))),
    }
}
