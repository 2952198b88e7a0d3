//! `nurbray compare`: the same camera another way, and what differs.

mod embree;
mod errors;
mod folder;
mod heat;
mod report;
mod sight;
mod verdict;

use std::process::ExitCode;

use nurbray::scene::World;

use super::args::{Against, CompareArguments};
use super::failure::Failure;

/// The longest side of a picture, as in `bench`: its 64 million rays and their packets take
/// about 20 GB.
const MAX_SIDE: u32 = 8192;

/// What `--help` says behind the options.
pub(crate) const HELP: &str = "\
One ray through the middle of each pixel, the same rays both ways, in the same run.

--against embree: the surfaces are cut into triangles that stay within each tolerance (see `nurbray
bench --help` for how), and Embree traces those. DIR gets
  report.md               triangles, build time, memory, rays/s and total time; errors of position and
                          normal; silhouette pixels that differ; rays lost and invented
  plot.svg                speed, memory and errors over the tolerance
  picture.png             what is looked at
  position-TOLERANCE.png  where the triangles are how far off
  normal-TOLERANCE.png    by what angle their interpolated normals are off
  legend.svg              what the colours of these mean
Everything but times, rates and memory is the same in every run.

Example:
  nurbray compare scenes/teapot.toml --against embree --tolerance 1e-3,1e-4,1e-5 -o teapot-embree";

/// Runs the subcommand.
pub(crate) fn run(arguments: &CompareArguments) -> Result<ExitCode, Failure> {
    match arguments.against {
        Against::Embree => embree::run(arguments)?,
        Against::Povray => return Err(Failure::work("povray comes next")),
    }
    Ok(ExitCode::SUCCESS)
}

/// Width and height of the pictures.
fn size(arguments: &CompareArguments, world: &World) -> Result<[u32; 2], Failure> {
    let size = match arguments.size {
        Some(size) => [size.width, size.height],
        None => world.settings.size.into(),
    };
    match size {
        [..=MAX_SIDE, ..=MAX_SIDE] => Ok(size),
        [width, height] => Err(Failure::input(format!(
            "{width} x {height} pixels: a comparison has at most {MAX_SIDE} each way"
        ))),
    }
}
