//! The report on a comparison with triangles, as Markdown and as panels to draw.

use super::super::chart::Panel;
use super::super::race::{Measurement, Model, Rival, RivalResult};
use super::super::table::{count, short, short_bytes, significant, three_digits, time};
use super::errors::Errors;
use super::folder::files_written;
use super::markdown::plain;
use super::remarks::remarks;
use super::table::{NONE, Table, fraction};

/// The errors of the triangles of one tolerance.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings {
    /// Rays that hit triangles, among those we are certain of.
    pub(super) hits: usize,
    /// Rays for which both sides see the same place.
    pub(super) same: usize,
    /// Distances along the ray, as fractions of the diagonal.
    pub(super) along: Option<Errors>,
    /// Distances from our tangent plane, as fractions of the diagonal.
    pub(super) across: Option<Errors>,
    /// Angles of the interpolated normals, in degrees.
    pub(super) normal: Option<Errors>,
    /// Angles of the triangles' own normals, in degrees.
    pub(super) facet: Option<Errors>,
    /// Rays lost at silhouettes and in gaps.
    pub(super) lost: [usize; 2],
    /// Rays invented at silhouettes and where triangles overlap.
    pub(super) invented: [usize; 2],
}

/// The files of a report.
pub(super) const REPORT: &str = "report.md";
pub(super) const PICTURE: &str = "picture.png";
pub(super) const LEGEND: &str = "legend.svg";
pub(super) const PLOT: &str = "plot.svg";

pub(super) fn position_file(tolerance: f64) -> String {
    format!("position-{tolerance:e}.png")
}

pub(super) fn normal_file(tolerance: f64) -> String {
    format!("normal-{tolerance:e}.png")
}

/// The text after the tables.
const NOTES: &str = "\
## What the words mean

- **Scale**: Embree computes in f32, with constants made for lengths of about 1. Triangles and rays are
  handed over moved to the middle of the bounding box and scaled by a power of two, to a size
  between 1 and 2; rays that begin far away are moved along themselves to beside it, in f64: its
  best case.
- **Tolerance**: how far triangles may be from the surface, as a fraction of the diagonal of the
  model's bounding box. Every knot span is cut evenly, as often as the sampled distance demands,
  alike along each row and column of spans, so that no gaps open inside a surface. What trims keep
  of a cell is triangulated with chords as near to the trim curves.
- **Build**: from the placed surfaces to ready. For triangles: nurbray evaluates the vertices, on
  one thread and their positions only, and Embree builds its hierarchy; not the search for how
  finely to cut, which may take longer.
- **Memory**: everything tracing needs. Of the triangles, vertices and hierarchy; normals and
  (u, v), which are made for the errors below, would come on top.
- **Position error**: how far apart both hits are *along the ray* (what a depth buffer sees), and how
  far the triangle's hit is *off the tangent plane* of the surface at ours, as fractions of the diagonal.
  Where the surface bends away from that plane, that is more than how far the hit is from the surface,
  and may exceed the tolerance. For nurbray: how far the point S(u, v) is from the ray. f32 has a floor
  of its own under Embree's.
- **Normal error**: the angle between the surface's normal and the one interpolated between the exact
  normals of the triangle's corners, or the triangle's own.
- **Doubtful**: rays of which nurbray itself says that floating point could not decide. There is no
  truth to judge the triangles by; these rays are left out of all rows below that one.
- **Lost**: rays whose first hit the triangles lack; they see something behind it, or nothing.
  **Invented**: rays that hit triangles where the surface is not.
- **Silhouette pixels that differ**: rays lost or invented where another ray, beside it by no more
  than 2.2 tolerances, sees on the surface what the triangles show. The others went **through a
  gap** between triangles, or met one that juts out there.
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
    /// One for each tolerance.
    pub(super) rivals: &'a [Rival],
    /// One for each tolerance.
    pub(super) findings: &'a [Findings],
    /// Distances of our hits from their rays, as fractions of the diagonal.
    pub(super) residual: Option<Errors>,
    /// Rays that hit the surfaces for certain.
    pub(super) hits: usize,
    /// Our doubtful answers.
    pub(super) doubtful: usize,
    /// The names of all files written.
    pub(super) files: &'a [String],
}

/// A rival at one tolerance: how large, how fast, how wrong.
type Level<'a> = (&'a Rival, &'a RivalResult, &'a Findings);

impl Report<'_> {
    /// The report as Markdown.
    pub(super) fn text(&self) -> String {
        let [width, height] = self.size;
        let Self { model, rival, .. } = self;
        let kernel = self.measured.fastest().map_or("", |ours| ours.kernel.name());
        let surfaces = count(model.surfaces.len() as u64, "surface");
        let threads = count(self.threads.into(), "thread");
        let diagonal = short(model.diagonal);
        let (name, camera) = (plain(&model.name), model.camera());
        format!(
            "# {name}: the surfaces, and triangles in their place\n\n\
             {camera}, {width} x {height} pixels, one ray through the middle of each; on \
             {threads}. nurbray (kernel {kernel}) traces the {surfaces}, {rival} triangles that stay \
             within a tolerance of them. Tolerances are fractions of the diagonal of the bounding \
             box, {diagonal}.\n\n{}![the picture]({PICTURE})\n\n\
             ## What it costs\n\n{}\n![speed, memory and errors over the tolerance]({PLOT})\n\n\
             ## What it gets wrong\n\n{}\n## Where\n\n{}\n\
             ![what the colours mean]({LEGEND})\n\n{NOTES}{}",
            remarks(model, self.rivals.iter().map(|rival| rival.tolerance)),
            self.costs(),
            self.errors(),
            self.pictures(),
            files_written(self.files)
        )
    }

    fn levels(&self) -> impl Iterator<Item = Level<'_>> {
        let both = self.rivals.iter().zip(&self.measured.rivals).zip(self.findings);
        both.map(|((rival, result), findings)| (rival, result, findings))
    }

    fn table(&self) -> Table {
        let tolerances: Vec<f64> = self.rivals.iter().map(|rival| rival.tolerance).collect();
        Table::new(&tolerances)
    }

    fn costs(&self) -> String {
        let Self { model, measured, rivals, .. } = self;
        let results = &measured.rivals;
        let ours = measured.fastest();
        let rate = ours.map_or(f64::NAN, |ours| ours.speed.mrays_per_s);
        let total = ours.map_or(f64::NAN, |ours| measured.our_steps(model, ours).total());
        let mut table = self.table();
        table.row("triangles", "none", |k| rivals[k].triangles.to_string());
        table.row("build", &time(model.preparation.build), |k| time(rivals[k].build_seconds));
        table.row("memory", &short_bytes(model.world.bvh().bytes()), |k| {
            short_bytes(rivals[k].bytes)
        });
        table.row("million rays a second", &three_digits(rate), |k| {
            three_digits(results[k].speed.mrays_per_s)
        });
        table.row("from the file to the last ray", &time(total), |k| {
            time(measured.rival_steps(model, &rivals[k], &results[k]).total())
        });
        table.text()
    }

    fn errors(&self) -> String {
        let Self { residual, findings, .. } = self;
        let (mean, most) = (|errors: Errors| errors.mean, |errors: Errors| errors.most);
        let ours = [fraction(residual.map(mean)), fraction(residual.map(most))];
        let mut table = self.table();
        table.row("rays left out: doubtful", &self.doubtful.to_string(), |_| NONE.into());
        table.row("rays that hit", &self.hits.to_string(), |k| findings[k].hits.to_string());
        table.row("… and see the same place", NONE, |k| findings[k].same.to_string());
        table.row("position error along the ray, mean", &ours[0], |k| {
            fraction(findings[k].along.map(mean))
        });
        table.row("… 99.9th percentile", &ours[1], |k| fraction(findings[k].along.map(most)));
        table.row("position off the tangent plane, mean", &ours[0], |k| {
            fraction(findings[k].across.map(mean))
        });
        table.row("… 99.9th percentile", &ours[1], |k| fraction(findings[k].across.map(most)));
        table
            .row("normal error, interpolated, mean", NONE, |k| angle(findings[k].normal.map(mean)));
        table.row("… 99.9th percentile", NONE, |k| angle(findings[k].normal.map(most)));
        table.row("normal error of the triangles, mean", NONE, |k| {
            angle(findings[k].facet.map(mean))
        });
        table.row("… 99.9th percentile", NONE, |k| angle(findings[k].facet.map(most)));
        table.row("silhouette pixels that differ", "0", |k| {
            (findings[k].lost[0] + findings[k].invented[0]).to_string()
        });
        table.row("rays lost", "0", |k| with_cause(findings[k].lost, "through gaps"));
        table.row("rays invented", "0", |k| {
            with_cause(findings[k].invented, "at triangles that jut out")
        });
        table.text()
    }

    fn pictures(&self) -> String {
        let mut rows = "| tolerance | position | normal |\n|---|---|---|\n".to_owned();
        for (rival, ..) in self.levels() {
            let tolerance = rival.tolerance;
            rows += &format!(
                "| {tolerance:e} | ![position]({}) | ![normal]({}) |\n",
                position_file(tolerance),
                normal_file(tolerance)
            );
        }
        rows
    }

    /// Speed and memory above, errors below.
    pub(super) fn panels(&self) -> Vec<Vec<Panel>> {
        let curve = |name: &str, value: &dyn Fn(Level<'_>) -> f64| {
            let points = self.levels().map(|level| (level.0.tolerance, value(level)));
            (name.to_owned(), points.collect())
        };
        let panel = |title: &str, quantity| Panel {
            title: title.into(),
            quantity,
            levels: Vec::new(),
            curves: Vec::new(),
        };
        let ours = self.measured.fastest().map_or(f64::NAN, |ours| ours.speed.mrays_per_s);
        let nurbray = |value: f64| vec![("nurbray".to_owned(), value)];
        let mean = |errors: Option<Errors>| errors.map_or(0.0, |errors| errors.mean);
        let most = |errors: Option<Errors>| errors.map_or(0.0, |errors| errors.most);
        let speed = Panel {
            levels: nurbray(ours),
            curves: vec![curve(self.rival, &|level| level.1.speed.mrays_per_s)],
            ..panel("Speed", "Mrays/s")
        };
        let memory = Panel {
            levels: nurbray(self.model.world.bvh().bytes() as f64),
            curves: vec![curve(self.rival, &|level| level.0.bytes as f64)],
            ..panel("Memory", "bytes")
        };
        let position = Panel {
            curves: vec![
                curve("99.9th percentile", &|level| most(level.2.along)),
                curve("mean", &|level| mean(level.2.along)),
            ],
            ..panel("Position error along the ray", "fraction of the diagonal")
        };
        let normal = Panel {
            curves: vec![
                curve("99.9th percentile", &|level| most(level.2.normal)),
                curve("mean", &|level| mean(level.2.normal)),
            ],
            ..panel("Error of interpolated normals", "degrees")
        };
        vec![vec![speed, memory], vec![position, normal]]
    }
}

fn angle(degrees: Option<f64>) -> String {
    degrees.map_or_else(|| NONE.into(), |degrees| format!("{}°", two_digits(degrees)))
}

/// `12`, `1.2`, `0.12`, `0.0012`, …, `1.2e-5`; zero has one digit.
fn two_digits(number: f64) -> String {
    if number == 0.0 {
        return "0".into();
    }
    if number.abs() < 1e-4 {
        return format!("{number:.1e}");
    }
    significant(number, 2, -4)
}

/// Rays at silhouettes and elsewhere, added up; those elsewhere, if any, are also shown apart, with
/// what is their cause.
fn with_cause([silhouette, other]: [usize; 2], cause: &str) -> String {
    match other {
        0 => silhouette.to_string(),
        _ => format!("{} ({other} {cause})", silhouette + other),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        assert_eq!([None, Some(0.001234), Some(12.34)].map(angle), ["–", "0.0012°", "12°"]);
        assert_eq!([0.0, 1.7e-6].map(|error| angle(Some(error))), ["0°", "1.7e-6°"]);
        let lost = |rays| with_cause(rays, "through gaps");
        assert_eq!([lost([3, 0]), lost([3, 2])], ["3", "5 (2 through gaps)"]);
    }
}
