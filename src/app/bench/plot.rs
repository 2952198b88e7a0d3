//! Speed over tolerance, as a drawing: our speed knows no tolerance and is a flat line.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use anyhow::{Error, anyhow};
use nurbray::io::write_atomically;
use plotters::coord::Shift;
use plotters::prelude::*;

use super::measure::Measurement;

/// The size of a panel in pixels.
const PANEL: (u32, u32) = (400, 300);

/// Colours of our kernels, one after the other: those of Okabe and Ito (2008), which people
/// with any colour vision can tell apart. The rival is black.
const COLORS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];

/// How far the axis of tolerances reaches beyond the first and the last: room for points.
const MARGIN: f64 = 2.0;

/// One model and ray set.
#[derive(Clone, Debug)]
pub(super) struct Panel {
    title: String,
    /// Kernels and their speeds.
    kernels: Vec<(String, f64)>,
    rival: String,
    /// Tolerances and the rival's speeds, the finest first.
    points: Vec<(f64, f64)>,
}

impl Panel {
    /// The panel of a measurement.
    pub(super) fn new(model: &str, threads: u16, (rival, measured): (&str, &Measurement)) -> Self {
        let name = Path::new(model).file_name().map_or(model.into(), |name| name.to_string_lossy());
        let plural = if threads == 1 { "" } else { "s" };
        let kernels = measured.kernels.iter();
        let mut points: Vec<_> = measured
            .rivals
            .iter()
            .map(|result| (result.tolerance, result.speed.mrays_per_s))
            .collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        Self {
            title: format!("{name}, {}, {threads} thread{plural}", measured.set),
            kernels: kernels
                .map(|ours| (format!("nurbray {}", ours.kernel), ours.speed.mrays_per_s))
                .collect(),
            rival: rival.to_owned(),
            points,
        }
    }

    /// All speeds to draw.
    fn speeds(&self) -> impl Iterator<Item = f64> {
        let ours = self.kernels.iter().map(|(_, speed)| *speed);
        ours.chain(self.points.iter().map(|point| point.1))
    }

    fn draw(
        &self,
        area: &DrawingArea<SVGBackend<'_>, Shift>,
        speeds: Range<f64>,
    ) -> Result<(), Error> {
        let tolerances: Vec<f64> = self.points.iter().map(|point| point.0).collect();
        let across = widened(range(&tolerances));

        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 15))
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(48)
            .build_cartesian_2d(across.clone().log_scale(), speeds.log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .x_desc("tolerance / diagonal")
            .y_desc("Mrays/s")
            .y_label_formatter(&|speed| format!("{speed}"))
            .x_label_formatter(&|tolerance| format!("{tolerance:e}"))
            .light_line_style(RGBColor(240, 240, 240))
            .draw()
            .map_err(failed)?;

        for ((name, speed), color) in self.kernels.iter().zip(COLORS.iter().cycle()) {
            let line = [(across.start, *speed), (across.end, *speed)];
            chart
                .draw_series(LineSeries::new(line, color.stroke_width(2)))
                .map_err(failed)?
                .label(name)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2))
                });
        }
        let line = LineSeries::new(self.points.iter().copied(), BLACK.filled()).point_size(3);
        chart
            .draw_series(line)
            .map_err(failed)?
            .label(&self.rival)
            .legend(|(x, y)| Circle::new((x + 8, y), 3, BLACK.filled()));
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.8))
            .border_style(RGBColor(200, 200, 200))
            .draw()
            .map_err(failed)
    }
}

/// Writes the panels, a row of them for each model.
///
/// # Errors
/// When the file cannot be written.
pub(super) fn write(path: &Path, rows: &[Vec<Panel>]) -> Result<(), Error> {
    let text = svg(rows)?;
    Ok(write_atomically(path, |file| file.write_all(text.as_bytes()))?)
}

fn svg(rows: &[Vec<Panel>]) -> Result<String, Error> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0).max(1);
    let size = (PANEL.0 * columns as u32, PANEL.1 * rows.len().max(1) as u32);
    // One scale for all panels.
    let speeds: Vec<f64> = rows.iter().flatten().flat_map(Panel::speeds).collect();
    let names = rows.iter().flatten().map(|panel| panel.kernels.len() + 1).max().unwrap_or(0);
    let speeds = with_room(decades(range(&speeds)), names);

    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let areas = root.split_evenly((rows.len().max(1), columns));
        for (row, areas) in rows.iter().zip(areas.chunks(columns)) {
            for (panel, area) in row.iter().zip(areas) {
                panel.draw(area, speeds.clone())?;
            }
        }
        root.present().map_err(failed)?;
    }
    Ok(text)
}

/// Plotters' errors are of as many types as it has backends.
fn failed(error: impl std::fmt::Display) -> Error {
    anyhow!("cannot draw: {error}")
}

/// From the smallest to the largest of positive numbers.
fn range(numbers: &[f64]) -> Range<f64> {
    let low = numbers.iter().copied().fold(f64::INFINITY, f64::min);
    let high = numbers.iter().copied().fold(0.0, f64::max);
    if low <= high { low..high } else { 1.0..1.0 }
}

fn widened(range: Range<f64>) -> Range<f64> {
    range.start / MARGIN..range.end * MARGIN
}

/// Whole powers of ten around a range: at least one step.
fn decades(range: Range<f64>) -> Range<f64> {
    let low = range.start.log10().floor();
    let high = range.end.log10().ceil();
    10_f64.powf(low)..10_f64.powf(high.max(low + 1.0))
}

/// A range of speeds with room above it for a legend of so many lines.
fn with_room(range: Range<f64>, lines: usize) -> Range<f64> {
    // A line takes about 1/15 of the panel's height, the legend's margins as much.
    let share = (lines as f64 + 1.0) / 15.0;
    let taller = 1.0 / (1.0 - share.min(0.5));
    range.start..range.start * (range.end / range.start).powf(taller)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(points: &[(f64, f64)]) -> Panel {
        Panel {
            title: "a <model>".into(),
            kernels: vec![("nurbray scalar".into(), 0.5), ("nurbray wide".into(), 50.0)],
            rival: "embree".into(),
            points: points.to_vec(),
        }
    }

    #[test]
    fn a_drawing_holds_a_curve_a_line_and_names_for_each() {
        let three = panel(&[(1e-5, 20.0), (1e-4, 40.0), (1e-3, 70.0)]);
        let text = svg(&[vec![three.clone(), three], vec![panel(&[(1e-3, 7.0)])]]).unwrap();
        assert!(text.starts_with("<svg") && text.trim_end().ends_with("</svg>"));
        assert_eq!(text.matches("<circle").count(), 3 + 3 + 1 + 3, "points, and legends");
        assert_eq!(text.matches("nurbray wide").count(), 3);
        assert_eq!(text.matches("a &lt;model&gt;").count(), 3);
        for label in ["1e-5", "1e-3", "100", "tolerance / diagonal", "Mrays/s"] {
            assert!(text.contains(label), "{label}");
        }
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn axes_hold_what_is_drawn() {
        assert_eq!(decades(0.3..70.0), 0.1..100.0);
        assert_eq!(decades(10.0..10.0), 10.0..100.0);
        assert_eq!(widened(range(&[1e-3])), 5e-4..2e-3);
        assert_eq!(with_room(1.0..100.0, 4).end.round(), 1000.0);
        assert!(svg(&[]).is_ok());
    }
}
