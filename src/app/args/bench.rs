//! Arguments of `nurbray bench`.

use std::path::PathBuf;

use clap::Args;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use nurbray::intersect::Kernel;

use super::super::race::{MAX_SIDE, RaySet};
use super::values::{once_each, seconds, tolerance};
use super::{count, help, kernels, threads};

/// `nurbray bench`.
#[derive(Debug, Args)]
#[command(after_help = help::BENCH, override_usage = "nurbray bench [OPTIONS] <INPUT>...")]
pub(crate) struct BenchArguments {
    /// Scenes (.toml) or bare models (.json, .obj)
    #[arg(value_name = "INPUT", required = true)]
    pub(crate) inputs: Vec<PathBuf>,

    /// Which rays: names from primary, single, incoherent, incoherent-single, ao, shadow
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = ray_sets(),
        hide_possible_values = true, default_value = RaySet::DEFAULT)]
    pub(crate) rays: Vec<RaySet>,

    /// Trace the same rays in the same run with a rival, on a tessellation
    #[arg(long, value_name = "RIVAL", value_parser = ["embree"])]
    pub(crate) against: Option<String>,

    /// How far the rival's triangles may be from the surface, as fractions of the diagonal of
    /// the model's bounding box; needs --against [default: 1e-3,1e-5]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = tolerance,
        requires = "against")]
    pub(crate) tolerance: Vec<f64>,

    /// Numbers of threads, all being one for each processor; several are measured one after the
    /// other
    #[arg(long, value_name = "LIST", value_delimiter = ',', default_value = "1",
        value_parser = threads())]
    pub(crate) threads: Vec<u16>,

    /// Which code searches for hits; may name several [default: all, side by side]
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = kernels())]
    pub(crate) kernel: Vec<Kernel>,

    /// Pixels along each side of the picture: N x N primary rays, as many incoherent ones
    #[arg(long, value_name = "N", default_value_t = 1024,
        value_parser = count::<u32>(1..=MAX_SIDE.into()))]
    pub(crate) size: u32,

    /// How long to measure each competitor on each ray set. Slow ones take longer: each
    /// traces all rays six times at least
    #[arg(long, value_name = "S", default_value_t = 2.0, value_parser = seconds)]
    pub(crate) seconds: f64,

    /// Print one JSON object a line instead of tables
    #[arg(long)]
    pub(crate) json: bool,

    /// Draw speed over tolerance, a panel for each model and ray set; needs --against, as only
    /// the rival has tolerances
    #[arg(long, value_name = "OUT.svg", requires = "against")]
    pub(crate) plot: Option<PathBuf>,
}

impl BenchArguments {
    /// The kernels to measure, each once.
    pub(crate) fn kernels(&self) -> Vec<Kernel> {
        if self.kernel.is_empty() {
            Kernel::ALL.iter().copied().filter(|kernel| kernel.is_available()).collect()
        } else {
            once_each(&self.kernel)
        }
    }

    /// The ray sets to measure, each once.
    pub(crate) fn ray_sets(&self) -> Vec<RaySet> {
        once_each(&self.rays)
    }

    /// The numbers of threads to measure with, each once.
    pub(crate) fn thread_counts(&self) -> Vec<u16> {
        once_each(&self.threads)
    }

    /// The rival's tolerances, each once; none without a rival.
    pub(crate) fn tolerances(&self) -> Vec<f64> {
        match &self.against {
            None => Vec::new(),
            Some(_) if self.tolerance.is_empty() => vec![1e-3, 1e-5],
            Some(_) => once_each(&self.tolerance),
        }
    }
}

fn ray_sets() -> impl TypedValueParser<Value = RaySet> {
    let names = RaySet::ALL.iter().map(|set| set.name());
    // Only names of ray sets come this far.
    PossibleValuesParser::new(names).map(|name| RaySet::named(&name).unwrap_or(RaySet::Primary))
}
