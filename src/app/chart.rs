//! Drawings of what depends on a rival's tolerance: logarithmic panels side by side.

use std::io::Write;
use std::ops::Range;
use std::path::Path;

use anyhow::{Error, anyhow};
use nurbray::io::write_atomically;
use plotters::coord::Shift;
use plotters::prelude::*;

/// The width of a panel, its height without a legend, and that of a legend's lines, in pixels.
const WIDTH: u32 = 400;
const HEIGHT: u32 = 268;
const LINE: u32 = 16;
/// What title and axis take of the height, and a legend's margins.
const AROUND: u32 = 80;
const MARGINS: u32 = 24;

/// Colours of flat lines, one after the other: those of Okabe and Ito (2008), which people
/// with any colour vision can tell apart.
const LEVELS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];

/// Shades of curves: the first is black.
const CURVES: [RGBColor; 3] = [BLACK, RGBColor(140, 140, 140), RGBColor(190, 190, 190)];

/// About the most numbers beside an axis: a panel has room for twice as many lines of text.
const LABELS: usize = 6;

/// How far the axis of tolerances reaches beyond the first and the last: room for points.
const MARGIN: f64 = 2.0;

/// One panel: positive numbers over tolerances.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    /// What stands above it.
    pub(crate) title: String,
    /// What is drawn, with its unit. Panels of one quantity share a scale.
    pub(crate) quantity: &'static str,
    /// What knows no tolerance: a flat line each.
    pub(crate) levels: Vec<(String, f64)>,
    /// Names, and points `(tolerance, value)` in any order. Values that are not positive
    /// are not drawn.
    pub(crate) curves: Vec<(String, Vec<(f64, f64)>)>,
}

impl Panel {
    /// A curve's points with positive values, the finest tolerance first.
    fn points(curve: &[(f64, f64)]) -> Vec<(f64, f64)> {
        let mut points: Vec<_> = curve.iter().copied().filter(|point| point.1 > 0.0).collect();
        points.sort_by(|a, b| a.0.total_cmp(&b.0));
        points
    }

    /// All values to draw.
    fn values(&self) -> impl Iterator<Item = f64> {
        let levels = self.levels.iter().map(|(_, value)| *value);
        let curves = self.curves.iter().flat_map(|(_, curve)| Self::points(curve));
        levels.chain(curves.map(|point| point.1))
    }

    /// The number of lines of its legend.
    fn names(&self) -> usize {
        self.levels.len() + self.curves.len()
    }

    fn draw(
        &self,
        area: &DrawingArea<SVGBackend<'_>, Shift>,
        values: Range<f64>,
    ) -> Result<(), Error> {
        let tolerances: Vec<f64> =
            self.curves.iter().flat_map(|(_, curve)| curve).map(|point| point.0).collect();
        let across = widened(range(&tolerances));

        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 15))
            .margin(10)
            .x_label_area_size(36)
            .y_label_area_size(54)
            .build_cartesian_2d(across.clone().log_scale(), values.log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .x_desc("tolerance / diagonal")
            .y_desc(self.quantity)
            .y_labels(LABELS)
            .y_label_formatter(&|&value| label(value))
            .x_label_formatter(&|&tolerance| format!("{:e}", rounded(tolerance)))
            .light_line_style(RGBColor(240, 240, 240))
            .draw()
            .map_err(failed)?;

        for ((name, value), color) in self.levels.iter().zip(LEVELS.iter().cycle()) {
            let line = [(across.start, *value), (across.end, *value)];
            chart
                .draw_series(LineSeries::new(line, color.stroke_width(2)))
                .map_err(failed)?
                .label(name)
                .legend(move |(x, y)| {
                    PathElement::new([(x, y), (x + 16, y)], color.stroke_width(2))
                });
        }
        for ((name, curve), color) in self.curves.iter().zip(CURVES.iter().cycle()) {
            let line = LineSeries::new(Self::points(curve), color.filled()).point_size(3);
            chart
                .draw_series(line)
                .map_err(failed)?
                .label(name)
                .legend(move |(x, y)| Circle::new((x + 8, y), 3, color.filled()));
        }
        chart
            .configure_series_labels()
            .position(SeriesLabelPosition::UpperLeft)
            .background_style(WHITE.mix(0.8))
            .border_style(RGBColor(200, 200, 200))
            .draw()
            .map_err(failed)
    }
}

/// Writes the panels, row by row.
///
/// # Errors
/// When the file cannot be written.
pub(crate) fn write(path: &Path, rows: &[Vec<Panel>]) -> Result<(), Error> {
    let text = svg(rows)?;
    Ok(write_atomically(path, |file| file.write_all(text.as_bytes()))?)
}

fn svg(rows: &[Vec<Panel>]) -> Result<String, Error> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0).max(1);
    let names = rows.iter().flatten().map(Panel::names).max().unwrap_or(0);
    let height = HEIGHT + LINE * names as u32;
    let size = (WIDTH * columns as u32, height * rows.len().max(1) as u32);
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, size).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let areas = root.split_evenly((rows.len().max(1), columns));
        for (row, areas) in rows.iter().zip(areas.chunks(columns)) {
            for (panel, area) in row.iter().zip(areas) {
                panel.draw(area, scale(rows, panel.quantity))?;
            }
        }
        root.present().map_err(failed)?;
    }
    Ok(text)
}

/// The scale of all panels of one quantity.
fn scale(rows: &[Vec<Panel>], quantity: &str) -> Range<f64> {
    let alike = || rows.iter().flatten().filter(|panel| panel.quantity == quantity);
    let values: Vec<f64> = alike().flat_map(Panel::values).collect();
    let names = alike().map(Panel::names).max().unwrap_or(0);
    let most = rows.iter().flatten().map(Panel::names).max().unwrap_or(0);
    let room = LINE * names as u32 + MARGINS;
    let height = HEIGHT + LINE * most as u32 - AROUND;
    with_room(decades(range(&values)), f64::from(room) / f64::from(height))
}

/// A number beside an axis: powers of ten where it would be long.
fn label(value: f64) -> String {
    let value = rounded(value);
    if (1e-3..1e5).contains(&value) { format!("{value}") } else { format!("{value:e}") }
}

/// What a number beside an axis is meant to be: those of a logarithmic scale are products of
/// many factors, and off by a few roundings.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
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

/// A range with room above it: this share of the whole, for a legend.
fn with_room(range: Range<f64>, share: f64) -> Range<f64> {
    let taller = 1.0 / (1.0 - share.min(0.5));
    range.start..range.start * (range.end / range.start).powf(taller)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn panel(points: &[(f64, f64)]) -> Panel {
        Panel {
            title: "a <model>".into(),
            quantity: "Mrays/s",
            levels: vec![("nurbray scalar".into(), 0.5), ("nurbray wide".into(), 50.0)],
            curves: vec![("embree".into(), points.to_vec())],
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
    fn panels_of_one_quantity_share_a_scale_and_others_have_their_own() {
        let speeds = panel(&[(1e-3, 7.0)]);
        let errors = Panel {
            quantity: "degrees",
            levels: vec![],
            curves: vec![("mean".into(), vec![(1e-3, 0.2), (1e-5, 0.0)])],
            ..speeds.clone()
        };
        let rows = [vec![speeds.clone(), errors], vec![panel(&[(1e-3, 700.0)]), speeds]];
        assert_eq!(scale(&rows, "Mrays/s").start, 0.1);
        assert!(scale(&rows, "Mrays/s").end > 1000.0);
        // One line in the legend, 40 of 188 + 3 × 16 pixels; what is 0 is not on a logarithmic
        // scale.
        assert!((scale(&rows, "degrees").end / 0.1 - 10_f64.powf(236.0 / 196.0)).abs() < 1e-9);
        assert_eq!([0.001, 20.0, 1e5, 1e-4].map(label), ["0.001", "20", "1e5", "1e-4"]);
        let products = [9.999999999999999e-5, 0.0009999999999999998, 99999.99999999999];
        assert_eq!(products.map(label), ["1e-4", "0.001", "1e5"]);
    }

    #[test]
    fn numbers_beside_an_axis_are_few() {
        // One decade: 20, 30, … 90 would fit the axis, and not beside it.
        let levels = vec![("nurbray".into(), 15.0)];
        let decade = Panel { levels, ..panel(&[(1e-3, 60.0), (1e-5, 18.0)]) };
        let text = svg(&[vec![decade]]).unwrap();
        assert!(text.contains("\n10\n") && text.contains("\n100\n"), "{text}");
        assert!(!text.contains("\n90\n"));
    }

    #[test]
    fn axes_hold_what_is_drawn() {
        assert_eq!(decades(0.3..70.0), 0.1..100.0);
        assert_eq!(decades(10.0..10.0), 10.0..100.0);
        assert_eq!(widened(range(&[1e-3])), 5e-4..2e-3);
        assert!((with_room(1.0..100.0, 0.4).end.log10() - 2.0 / 0.6).abs() < 1e-9);
        assert!(svg(&[]).is_ok());
    }
}
