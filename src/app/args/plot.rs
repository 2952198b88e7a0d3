//! Arguments of `nurbray plot`.

use std::path::PathBuf;

use clap::Args;

use super::help;
use super::values::{self, Size};

/// `nurbray plot`.
#[derive(Debug, Args)]
#[command(after_help = help::PLOT)]
pub(crate) struct PlotArguments {
    /// Scene (.toml) or bare model (.json, .obj)
    pub(crate) input: PathBuf,

    /// Picture to write: .svg or .png; may be given several times
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub(crate) outputs: Vec<PathBuf>,

    /// Width and height of the whole picture in pixels, such as 1024x768 [default: the scene's,
    /// else 480x400 a plot]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<Size>,

    /// No summary: nothing on stderr but warnings and errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}
