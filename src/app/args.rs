//! The command-line arguments.

mod bench;
mod compare;
mod count;
mod help;
mod hints;
mod plot;
mod values;

use std::ffi::{OsStr, OsString};
use std::path::PathBuf;

use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, CommandFactory, Parser, Subcommand};
use glam::DVec3;
use nurbray::intersect::Kernel;
use nurbray::render::{AovSet, MAX_THREADS, PixelRect};
use nurbray::scene::IntegratorKind;

pub(crate) use bench::BenchArguments;
pub(crate) use compare::{Against, CompareArguments};
use count::count;
pub(crate) use plot::PlotArguments;
pub(crate) use values::{SampleRange, Size};

/// The whole command line.
#[derive(Debug, Parser)]
#[command(
    name = "nurbray",
    version,
    about = "Ray traces NURBS surfaces directly: no tessellation, exact silhouettes, f64 hits",
    arg_required_else_help = true,
    max_term_width = 100,
    after_help = "INPUT is a scene (.toml) or a bare model file (geomdl .json, cage .obj), which is framed and \
                  lit by default.\n\
                  Exit codes: 0 done, 1 failed, 2 wrong use or bad input.\n\
                  Messages number things from 0; lines and columns count from 1.\n\n\
                  Example:\n  nurbray render scenes/teapot.toml -o teapot.exr -o teapot.png"
)]
pub(crate) struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub(crate) command: Command,
}

/// The subcommands that work.
#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Render a picture
    Render(RenderArguments),
    /// Trace rays from a file and write what they hit
    Cast(CastArguments),
    /// Measure how fast rays are traced, by every kernel and by a rival
    Bench(BenchArguments),
    /// Check the fast path against the exact solver on random and nasty rays
    Audit(AuditArguments),
    /// Trace the camera's rays by Embree or POV-Ray, too, and report how the pictures differ
    Compare(CompareArguments),
    /// List what a scene or model holds, its gaps, and what was not imported
    Info(InfoArguments),
    /// Draw curves, basis functions and constructions as figures
    Plot(PlotArguments),
}

/// `nurbray render`.
#[derive(Debug, Args)]
#[command(after_help = help::RENDER)]
pub(crate) struct RenderArguments {
    /// Scene (.toml) or bare model (.json, .obj)
    pub(crate) input: PathBuf,

    /// Picture to write; may be given several times. The extension says how: .exr holds linear
    /// light and AOVs, .png the picture only (sRGB, with --exposure)
    #[arg(short, long = "output", value_name = "OUT", required = true)]
    pub(crate) outputs: Vec<PathBuf>,

    /// Width and height in pixels, such as 1024x768 [default: the scene's, else 800x600]
    #[arg(long, value_name = "WxH", value_parser = values::size)]
    pub(crate) size: Option<Size>,

    /// Samples a pixel [default: the scene's, else 16]
    #[arg(long, value_name = "N", value_parser = count::<u32>(1..=u32::MAX.into()))]
    pub(crate) spp: Option<u32>,

    /// Take only samples A to B-1 of each pixel, to split work between runs, or go on where others
    /// ended: beyond the scene's samples, too, but not beyond --spp. If a long render may be
    /// interrupted, several ranges keep what is done [default: 0..spp]
    #[arg(long, value_name = "A..B", value_parser = values::samples)]
    pub(crate) samples: Option<SampleRange>,

    /// What a pixel shows [default: the scene's, else direct]
    #[arg(long, value_name = "NAME", value_parser = integrators())]
    pub(crate) integrator: Option<IntegratorKind>,

    /// Which AOVs the .exr holds besides colour: names from Z,P,N,uv,Albedo,id,doubt, or all,
    /// or none [default: all but doubt]
    #[arg(long, value_name = "LIST")]
    pub(crate) aov: Option<AovSet>,

    /// Render only the pixels X0 <= x < X1, Y0 <= y < Y1, counted from the top left
    #[arg(long, value_name = "X0,Y0,X1,Y1", value_parser = values::crop)]
    pub(crate) crop: Option<PixelRect>,

    /// Put the camera here [default: the scene's, else where all is seen]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::point)]
    pub(crate) look_from: Option<DVec3>,

    /// Point the camera here [default: where the scene's looks, else the model's centre]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::point)]
    pub(crate) look_at: Option<DVec3>,

    /// Which way is up in the picture; not along the view [default: the scene's, else z, or y if
    /// the camera looks along z]
    #[arg(long, value_name = "X,Y,Z", value_parser = values::point)]
    pub(crate) up: Option<DVec3>,

    /// Vertical field of view in degrees [default: the scene's, else 30]
    #[arg(long, value_name = "DEG", value_parser = values::field_of_view)]
    pub(crate) fov: Option<f64>,

    /// Brightness of the .png in stops: +1 doubles the light [default: the scene's, else 0]
    #[arg(long, value_name = "EV", value_parser = values::finite)]
    pub(crate) exposure: Option<f64>,

    /// Which samples to take: pictures of different seeds have independent noise [default: the
    /// scene's, else 0]
    #[arg(long, value_name = "N", value_parser = count::<u64>(0..=u64::MAX))]
    pub(crate) seed: Option<u64>,

    /// How to use the processor.
    #[command(flatten)]
    pub(crate) work: WorkArguments,

    /// No progress, no summary: nothing on stderr but warnings and errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// How to use the processor.
#[derive(Debug, Args)]
pub(crate) struct WorkArguments {
    /// Number of threads, or all: one for each processor, as without it; it changes no result
    #[arg(long, value_name = "N", value_parser = threads())]
    pub(crate) threads: Option<u16>,

    /// How to use each thread.
    #[command(flatten)]
    pub(crate) kernel: KernelArguments,
}

/// Which code to trace with.
#[derive(Debug, Args)]
pub(crate) struct KernelArguments {
    /// Which code searches for hits; results of two of them may differ in last digits
    #[arg(long, value_name = "NAME", default_value_t, value_parser = kernels())]
    pub(crate) kernel: Kernel,
}

impl Arguments {
    /// Parses the words of a command line, the program's own name first.
    ///
    /// No option is a number. A word that looks like a negative number is the value of the option
    /// before it; `=` joins the two, so that the number is not taken for an option.
    pub(crate) fn parse_words(words: impl Iterator<Item = OsString>) -> Result<Self, clap::Error> {
        let mut joined: Vec<OsString> = Vec::new();
        for word in words {
            match joined.last_mut() {
                Some(option) if is_negative(&word) && takes_next_word(option) => {
                    option.push("=");
                    option.push(word);
                }
                _ => joined.push(word),
            }
        }
        let words = joined.clone();
        Self::try_parse_from(joined).map_err(|error| {
            let mut command = Self::command();
            command.build();
            hints::with_hint(error, &command, &words)
        })
    }
}

/// Whether a word begins as a negative number does.
fn is_negative(word: &OsStr) -> bool {
    matches!(word.as_encoded_bytes(), [b'-', b'0'..=b'9' | b'.', ..])
}

/// Whether a word is a long option without a value of its own.
fn takes_next_word(word: &OsStr) -> bool {
    let bytes = word.as_encoded_bytes();
    bytes.len() > 2 && bytes.starts_with(b"--") && !bytes.contains(&b'=')
}

/// A number of threads, or `all`: one for each processor.
fn threads() -> impl Fn(&str) -> Result<u16, String> + Clone {
    |text| match text {
        "all" => {
            let processors = std::thread::available_parallelism().map_or(1, usize::from) as u64;
            Ok(processors.min(MAX_THREADS as u64) as u16)
        }
        _ => {
            count::<u16>(1..=MAX_THREADS as u64)(text).map_err(|needed| format!("{needed}, or all"))
        }
    }
}

fn kernels() -> impl TypedValueParser<Value = Kernel> {
    let available = Kernel::ALL.iter().filter(|kernel| kernel.is_available());
    let names = available.map(|kernel| kernel.name());
    PossibleValuesParser::new(names).try_map(|name| name.parse::<Kernel>())
}

fn integrators() -> impl TypedValueParser<Value = IntegratorKind> {
    let names = IntegratorKind::ALL.iter().map(|kind| kind.name());
    PossibleValuesParser::new(names).try_map(|name| name.parse::<IntegratorKind>())
}

/// `nurbray cast`.
#[derive(Debug, Args)]
#[command(after_help = "\
RAYS.npy: float64 or float32, of shape (n, 6): origin x y z, direction x y z; or
  (n, 8) with t_min, t_max. The hit point is o + t d with d as given; t is in
  (0, inf) unless the file says otherwise. Neither t_min nor t_max belongs to the
  range: a hit there, to within rounding, may be left out, and the answer is
  doubtful. Rays that go on from hits need a small
  t_min, 1e-9 of the model's size over |d|: else most meet their surface again, or
  are in doubt.
HITS.npy: float64, shape (n, 11): t, surface, u, v, x, y, z, nx, ny, nz, flags.
  A miss is NaN in all but flags. surface counts as `nurbray info` lists them;
  (u, v) lies in the surface's own knot domain (of a cage: u - k and v in unit
  square k, counted face by face; a face of n corners has n, quads have one); the
  normal is S_u x S_v normalised, not turned towards the ray. flags, by bit: 0 doubtful (1), 1 at a
  border (2), 2 normal undefined (4), 3 at a trim edge (8), 4 the ray runs
  inside the surface (16).
With --all: shape (m, 12), the ray's number first, sorted by ray, then t. A ray
  without hits has no row, unless it is doubtful: then it has one row of NaN. A
  doubtful ray has at least one row with bit 0.
With --json one object on stdout: rays, hits, doubtful (rays), build_seconds,
  trace_seconds (no reading or writing of files), bytes (of the prepared
  surfaces), threads, kernel.

Example:
  nurbray cast scenes/teapot.json --rays rays.npy -o hits.npy --json")]
pub(crate) struct CastArguments {
    /// Scene (.toml) or bare model (.json, .obj)
    pub(crate) input: PathBuf,

    /// Rays to trace, a NumPy file
    #[arg(long, value_name = "RAYS.npy")]
    pub(crate) rays: PathBuf,

    /// Hits to write, a NumPy file (.npy)
    #[arg(short, long, value_name = "HITS.npy")]
    pub(crate) output: PathBuf,

    /// Every hit of each ray, not only the first; where surfaces meet at borders,
    /// poles or trim edges, one row for each crossing, if their normals point to the
    /// same side there (`nurbray info` tells)
    #[arg(long)]
    pub(crate) all: bool,

    /// Neighbouring rays are alike: trace them in packets (the same hits, to rounding); with
    /// --all it changes nothing
    #[arg(long)]
    pub(crate) coherent: bool,

    /// How to use the processor.
    #[command(flatten)]
    pub(crate) work: WorkArguments,

    /// Print the counts and times as one JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// No progress and no summary: nothing on stderr but warnings and errors
    #[arg(short, long)]
    pub(crate) quiet: bool,
}

/// The largest number of rays of one audit: at least a day's work. Except for rays with faults,
/// what an audit keeps of its rays does not grow with their number.
pub(crate) const MAX_RAYS: u64 = 1_000_000_000;

/// `nurbray audit`.
#[derive(Debug, Args)]
#[command(after_help = help::AUDIT)]
pub(crate) struct AuditArguments {
    /// Scene (.toml) or bare model (.json, .obj)
    pub(crate) input: PathBuf,

    /// How many rays, of all classes together
    #[arg(long, value_name = "N", default_value_t = 100_000,
        value_parser = count::<u64>(1..=MAX_RAYS))]
    pub(crate) rays: u64,

    /// Which rays: the same seed makes the same rays, on any number of threads
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = count::<u64>(0..=u64::MAX))]
    pub(crate) seed: u64,

    /// Which code to check.
    #[command(flatten)]
    pub(crate) kernel: KernelArguments,

    /// Print the classes as one JSON object
    #[arg(long)]
    pub(crate) json: bool,

    /// Write the rays at fault here, a NumPy file (.npy) of shape (n, 8) that `nurbray cast` reads
    #[arg(long, value_name = "RAYS.npy")]
    pub(crate) offenders: Option<PathBuf>,
}

/// `nurbray info`.
#[derive(Debug, Args)]
#[command(after_help = help::INFO)]
pub(crate) struct InfoArguments {
    /// Scene (.toml) or bare model (.json, .obj)
    pub(crate) input: PathBuf,

    /// Print one JSON object instead of tables
    #[arg(long)]
    pub(crate) json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clap_finds_the_arguments_consistent() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn all_threads_are_one_for_each_processor() {
        let here = std::thread::available_parallelism().map_or(1, usize::from);
        assert_eq!(threads()("all").map(usize::from), Ok(here.min(1024)));
        assert_eq!(threads()("1e1"), Ok(10));
        let message = "a whole number from 1 to 1024 is needed, such as 64, 1_000 or 1e3, or all";
        for wrong in ["0", "1025", "every", "All"] {
            assert_eq!(threads()(wrong), Err(message.to_owned()), "{wrong}");
        }
    }

    #[test]
    fn negative_coordinates_are_values_and_not_options() {
        let line = "nurbray render a.toml -o a.exr --look-from -1,-2.5,3e0 --exposure -1";
        let parse = |line: &str| Arguments::parse_words(line.split(' ').map(OsString::from));
        let Command::Render(render) = parse(line).unwrap().command else {
            panic!("render was asked for");
        };
        assert_eq!(render.look_from, Some(DVec3::new(-1.0, -2.5, 3.0)));
        assert_eq!(render.exposure, Some(-1.0));

        // Where no value may be negative, its own parser says so.
        for option in ["--size -10x20", "--spp -1", "--seed -1", "--threads -2", "--crop -1,0,2,2"]
        {
            let message = parse(&format!("nurbray render a.toml -o a.exr {option}")).unwrap_err();
            let value = option.split(' ').nth(1).unwrap();
            let expected = format!("error: invalid value '{value}' for '--");
            assert!(message.to_string().starts_with(&expected), "{message}");
        }
        // An option is not the value of the one before it.
        let message = parse("nurbray render a.toml -o a.exr --size --spp 3").unwrap_err();
        assert!(message.to_string().contains("a value is required for '--size"), "{message}");
    }

    #[test]
    fn every_subcommand_shows_an_example_that_parses() {
        for command in Arguments::command().get_subcommands() {
            let help = command.get_after_help().unwrap().to_string();
            let example = help.split("Example:\n  ").nth(1).unwrap().trim();
            Arguments::try_parse_from(example.split_whitespace()).unwrap();
        }
    }
}
