//! Arguments of `nurbray compare`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::values::{self, Size, once_each, seconds, tolerance};
use super::{help, threads};

/// Another way to trace the same camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Against {
    /// Triangles in Embree's hierarchy.
    Embree,
    /// The program POV-Ray on the scene in its own language.
    Povray,
}

/// `nurbray compare`.
#[derive(Debug, Args)]
#[command(after_help = help::COMPARE)]
pub(crate) struct CompareArguments {
    /// Scene (.toml) or bare model (.json, .obj)
    pub(crate) input: PathBuf,

    /// Whom to compare with
    #[arg(
        long,
        value_name = "RIVAL",
        required = true,
        hide_possible_values = true,
        help = "Whom to compare with: embree or povray"
    )]
    pub(crate) against: Against,

    /// How far the rival's triangles may be from the surface, as fractions of the diagonal of
    /// the model's bounding box
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = tolerance,
        default_value = "1e-3,1e-4,1e-5")]
    tolerance: Vec<f64>,

    /// Folder for the report; it is made if it is not there
    #[arg(short, long, value_name = "DIR", required = true)]
    pub(crate) output: PathBuf,

    /// Width and height of the pictures in pixels, such as 1024x768 [default: the scene's]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<Size>,

    /// Number of threads each side traces on, or all: one for each processor
    #[arg(long, value_name = "N", default_value_t = 1,
        value_parser = threads())]
    pub(crate) threads: u16,

    /// How long to measure the speed of each competitor (POV-Ray draws each picture once)
    #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = seconds)]
    pub(crate) seconds: f64,
}

impl CompareArguments {
    /// The tolerances, each once.
    pub(crate) fn tolerances(&self) -> Vec<f64> {
        once_each(&self.tolerance)
    }
}
