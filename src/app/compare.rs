//! `nurbray compare`: traces the same camera's rays another way and reports what differs.

mod embree;
mod errors;
mod folder;
mod heat;
mod markdown;
mod povray;
mod povray_report;
mod povray_run;
mod remarks;
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
    let size = world.settings().size;
    match size {
        [..=MAX_SIDE, ..=MAX_SIDE] => Ok(size),
        [width, height] => Err(Failure::input(format!(
            "{width} x {height} pixels: a comparison has at most {MAX_SIDE} each way"
        ))),
    }
}
