//! The report on a comparison with POV-Ray, as Markdown.

use super::super::race::{Measurement, Model};
use super::super::table::{count, short, three_digits, time};
use super::errors::Errors;
use super::folder::files_written;
use super::markdown::plain;
use super::povray_run::Rendering;
use super::table::{NONE, Table, fraction};

/// The errors of one of POV-Ray's pictures.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Findings {
    /// Pixels that POV-Ray hits, among those we are certain of.
    pub(super) hits: usize,
    /// Errors of brightness where both hit.
    pub(super) brightness: Option<Errors>,
    /// Pixels we hit and POV-Ray does not.
    pub(super) lost: usize,
    /// Pixels POV-Ray hits and we do not.
    pub(super) invented: usize,
}

/// The files of a report.
pub(super) const REPORT: &str = "report.md";
pub(super) const PICTURE: &str = "picture.png";
pub(super) const LEGEND: &str = "legend.svg";

pub(super) fn scene_file(tolerance: f64) -> String {
    format!("scene-{tolerance:e}.pov")
}

pub(super) fn difference_file(tolerance: f64) -> String {
    format!("difference-{tolerance:e}.png")
}

/// The text after the tables.
const NOTES: &str = "\
## What the words mean

- **Scene**: camera and shapes are ours; light and colour are not. A lamp at the camera, without
  shadows, makes each pixel the cosine of the angle between ray and normal. POV-Ray writes 16 bits.
- **Scale**: POV-Ray has constants made for lengths of about 1. Its scene is moved to the middle of the
  bounding box and scaled by a power of two, to a size between 1 and 2, or larger if small surfaces
  would be lost: its best case.
- **Tolerance**: how flat POV-Ray makes the triangles it cuts its bicubic patches into (`flatness`),
  as a fraction of the diagonal of the model's bounding box. Spheres, cones, cylinders, disks and tori
  are not cut.
- **Prepare**: from the file to ready; of POV-Ray, its parse and bounding times. **Trace**: POV-Ray's
  own figure includes light and colour; it draws each picture once, and its clock counts whole
  milliseconds: of small pictures it says little. **From start to end**: of nurbray, from the file to
  the last ray; of POV-Ray, the whole run of the program, half a second of starting it and the writing
  of the picture among it.
- **Doubtful**: pixels of which nurbray itself says that floating point could not decide. There is no
  truth to judge POV-Ray by; they are left out of all rows below that one.
- **Error of brightness**: the difference of both cosines where both hit. **Lost** are pixels where
  only nurbray sees the model, **invented** those where only POV-Ray does.
";

/// The contents of a report.
#[derive(Clone, Copy, Debug)]
pub(super) struct Report<'a> {
    pub(super) model: &'a Model,
    pub(super) size: [u32; 2],
    pub(super) threads: u16,
    /// The rival's name and version.
    pub(super) rival: &'a str,
    pub(super) measured: &'a Measurement,
    pub(super) tolerances: &'a [f64],
    /// One for each tolerance.
    pub(super) renderings: &'a [Rendering],
    /// One for each tolerance.
    pub(super) findings: &'a [Findings],
    /// What was left out, line by line.
    pub(super) left_out: &'a [String],
    /// The names of all files written.
    pub(super) files: &'a [String],
    /// Pixels that hit the surfaces for certain.
    pub(super) hits: usize,
    /// Our doubtful answers.
    pub(super) doubtful: usize,
}

impl Report<'_> {
    /// The report as Markdown.
    pub(super) fn text(&self) -> String {
        let [width, height] = self.size;
        let Self { model, rival, .. } = self;
        let kernel = self.measured.fastest().map_or("", |ours| ours.kernel.name());
        let threads = count(self.threads.into(), "thread");
        let (name, camera, diagonal) = (plain(&model.name), model.camera(), short(model.diagonal));
        format!(
            "# {name}: nurbray and POV-Ray\n\n\
             {camera}, {width} x {height} pixels, one ray through the middle of each; on \
             {threads}. nurbray (kernel {kernel}), and {rival}. Tolerances are fractions of the \
             diagonal of the bounding box, {diagonal}.\n\n\
             ![the picture]({PICTURE})\n\n{}## Times and errors\n\n{}\n## Where\n\n{}\n\
             ![what the colours mean]({LEGEND})\n\n{NOTES}{}",
            self.left_out(),
            self.table(),
            self.pictures(),
            files_written(self.files)
        )
    }

    fn left_out(&self) -> String {
        if self.left_out.is_empty() {
            return String::new();
        }
        let lines: String =
            self.left_out.iter().map(|line| format!("- {}.\n", plain(line))).collect();
        format!("## Left out on both sides\n\n{lines}\n")
    }

    fn table(&self) -> String {
        let Self { model, measured, renderings, findings, .. } = self;
        let ours = measured.fastest();
        let rate = ours.map_or(f64::NAN, |ours| ours.speed.mrays_per_s);
        let total = ours.map_or(f64::NAN, |ours| measured.our_steps(model, ours).total());
        let trace = 1e-6 * measured.count as f64 / rate;
        let their_rate = |r: &Rendering| match r.trace_seconds > 0.0 {
            true => three_digits(1e-6 * measured.count as f64 / r.trace_seconds),
            false => NONE.into(),
        };
        let mut table = Table::new(self.tolerances);
        table.row("prepare", &time(model.preparation.total()), |k| {
            told(renderings[k].prepare_seconds)
        });
        table.row("trace", &time(trace), |k| told(renderings[k].trace_seconds));
        table.row("million rays a second", &three_digits(rate), |k| their_rate(&renderings[k]));
        table.row("from start to end", &time(total), |k| time(renderings[k].total_seconds));
        table.row("pixels left out: doubtful", &self.doubtful.to_string(), |_| NONE.into());
        table.row("pixels that hit", &self.hits.to_string(), |k| findings[k].hits.to_string());
        let brightness = |k: usize| findings[k].brightness;
        table.row("error of brightness, mean", NONE, |k| fraction(brightness(k).map(|e| e.mean)));
        table.row("… 99.9th percentile", NONE, |k| fraction(brightness(k).map(|e| e.most)));
        table.row("… largest", NONE, |k| fraction(brightness(k).map(|e| e.largest)));
        table.row("pixels lost", "0", |k| findings[k].lost.to_string());
        table.row("pixels invented", "0", |k| findings[k].invented.to_string());
        table.text()
    }

    fn pictures(&self) -> String {
        let mut rows = "| tolerance | difference | scene |\n|---|---|---|\n".to_owned();
        for &tolerance in self.tolerances {
            let (picture, scene) = (difference_file(tolerance), scene_file(tolerance));
            rows += &format!("| {tolerance:e} | ![difference]({picture}) | [{scene}]({scene}) |\n");
        }
        rows
    }
}

/// A time as POV-Ray reports it, in whole milliseconds.
fn told(seconds: f64) -> String {
    if seconds < 1e-3 { "under 1 ms".into() } else { time(seconds) }
}
