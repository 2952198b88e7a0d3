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
const HEIGHT: u32 = 288;
const LINE: u32 = 16;
/// A panel's margin, and the room for numbers on the left.
const MARGIN: u32 = 10;
const LEFT: u32 = 54;

/// Colours of flat lines, one after the other: those of Okabe and Ito (2008), which people
/// with any colour vision can tell apart.
const LEVELS: [RGBColor; 4] =
    [RGBColor(0, 114, 178), RGBColor(213, 94, 0), RGBColor(0, 158, 115), RGBColor(204, 121, 167)];

/// Shades of curves: the first is black.
const CURVES: [RGBColor; 3] = [BLACK, RGBColor(140, 140, 140), RGBColor(190, 190, 190)];

/// About the most numbers beside an axis: a panel has room for twice as many lines of text.
const LABELS: usize = 6;

/// How far the axis of tolerances reaches beyond the first and the last: room for points.
const BEYOND: f64 = 2.0;

/// One panel: positive numbers over tolerances.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    /// The text above it.
    pub(crate) title: String,
    /// What is drawn, with its unit. Panels of one quantity share a scale.
    pub(crate) quantity: &'static str,
    /// Values that do not depend on a tolerance: a flat line each.
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

    /// The colour of each flat line, and of each curve.
    fn colors(&self) -> (Vec<RGBColor>, Vec<RGBColor>) {
        let cycle =
            |colors: &[RGBColor], count| colors.iter().copied().cycle().take(count).collect();
        (cycle(&LEVELS, self.levels.len()), cycle(&CURVES, self.curves.len()))
    }

    /// Draws the names of the lines and curves, one below the other.
    fn draw_legend(&self, area: &DrawingArea<SVGBackend<'_>, Shift>) -> Result<(), Error> {
        let (levels, curves) = self.colors();
        let left = (MARGIN + LEFT) as i32;
        let middle = |line: usize| (LINE * line as u32 + LINE / 2) as i32;
        for (line, color) in levels.iter().enumerate() {
            let ends = [(left, middle(line)), (left + 16, middle(line))];
            area.draw(&PathElement::new(ends, color.stroke_width(2))).map_err(failed)?;
        }
        for (line, color) in (levels.len()..).zip(&curves) {
            area.draw(&Circle::new((left + 8, middle(line)), 3, color.filled())).map_err(failed)?;
        }
        let levels = self.levels.iter().map(|(name, _)| name);
        for (line, name) in levels.chain(self.curves.iter().map(|(name, _)| name)).enumerate() {
            let place = (left + 24, middle(line) - 4);
            area.draw(&Text::new(name.as_str(), place, ("sans-serif", 12))).map_err(failed)?;
        }
        Ok(())
    }

    /// Draws the title, a legend with room for this many lines, and below it the axes, which hold
    /// the lines and curves and nothing else.
    fn draw(
        &self,
        area: &DrawingArea<SVGBackend<'_>, Shift>,
        values: Range<f64>,
        lines: usize,
    ) -> Result<(), Error> {
        let below = area.margin(MARGIN, 0, 0, 0).titled(&self.title, ("sans-serif", 15));
        let (legend, area) = below.map_err(failed)?.split_vertically(LINE * lines as u32);
        self.draw_legend(&legend)?;

        let tolerances: Vec<f64> =
            self.curves.iter().flat_map(|(_, curve)| curve).map(|point| point.0).collect();
        let across = widened(range(&tolerances));

        let mut chart = ChartBuilder::on(&area)
            .margin(MARGIN)
            .x_label_area_size(36)
            .y_label_area_size(LEFT)
            .build_cartesian_2d(across.clone().log_scale(), values.log_scale())
            .map_err(failed)?;
        chart
            .configure_mesh()
            .x_desc("tolerance / diagonal")
            .y_desc(self.quantity)
            .y_labels(LABELS)
            .y_label_formatter(&|&value| label(value))
            .x_label_formatter(&|&tolerance| tolerance_label(tolerance))
            .light_line_style(RGBColor(240, 240, 240))
            .draw()
            .map_err(failed)?;

        let (levels, curves) = self.colors();
        for ((_, value), color) in self.levels.iter().zip(levels) {
            let line = [(across.start, *value), (across.end, *value)];
            chart.draw_series(LineSeries::new(line, color.stroke_width(2))).map_err(failed)?;
        }
        for ((_, curve), color) in self.curves.iter().zip(curves) {
            let line = LineSeries::new(Self::points(curve), color.filled()).point_size(3);
            chart.draw_series(line).map_err(failed)?;
        }
        Ok(())
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

/// The panels, row by row, as a drawing.
///
/// # Errors
/// When they cannot be drawn.
pub(crate) fn svg(rows: &[Vec<Panel>]) -> Result<String, Error> {
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
                panel.draw(area, scale(rows, panel.quantity), names)?;
            }
        }
        root.present().map_err(failed)?;
    }
    Ok(only_xml(text))
}

/// A drawing without the characters that XML 1.0 excludes (control characters, U+FFFE and U+FFFF),
/// which names of files and surfaces may have: U+FFFD stands for them.
pub(crate) fn only_xml(text: String) -> String {
    let is_xml = |c: char| matches!(c, '\t' | '\n' | '\r' | ' '..='\u{fffd}' | '\u{10000}'..);
    if text.chars().all(is_xml) { text } else { text.replace(|c| !is_xml(c), "\u{fffd}") }
}

/// The scale of all panels of one quantity.
fn scale(rows: &[Vec<Panel>], quantity: &str) -> Range<f64> {
    let alike = rows.iter().flatten().filter(|panel| panel.quantity == quantity);
    let values: Vec<f64> = alike.flat_map(Panel::values).collect();
    decades(range(&values))
}

/// A number beside an axis: powers of ten where it would be long.
fn label(value: f64) -> String {
    let value = rounded(value);
    if (1e-3..1e5).contains(&value) { format!("{value}") } else { format!("{value:e}") }
}

/// A tolerance below an axis. Over a decade or so, all of its tenths are marked: numbers have room
/// at some of them only.
fn tolerance_label(value: f64) -> String {
    let text = format!("{:e}", rounded(value));
    if ["1e", "2e", "5e"].iter().any(|first| text.starts_with(first)) {
        text
    } else {
        String::new()
    }
}

/// The number that is meant beside an axis: numbers of a logarithmic scale are products of many
/// factors, and off by a few roundings.
fn rounded(value: f64) -> f64 {
    format!("{value:.11e}").parse().unwrap_or(value)
}

/// Converts an error of plotters, which has as many error types as backends.
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
    range.start / BEYOND..range.end * BEYOND
}

/// Whole powers of ten around a range: at least one step.
fn decades(range: Range<f64>) -> Range<f64> {
    let low = range.start.log10().floor();
    let high = range.end.log10().ceil();
    10_f64.powf(low)..10_f64.powf(high.max(low + 1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_have_only_characters_of_xml() {
        assert_eq!(only_xml("a\tü\u{10ffff}\u{fffd}\n".into()), "a\tü\u{10ffff}\u{fffd}\n");
        assert_eq!(only_xml("a\u{1}b\u{fffe}c\u{ffff}".into()), "a\u{fffd}b\u{fffd}c\u{fffd}");
    }

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
        assert_eq!(scale(&rows, "Mrays/s"), 0.1..1000.0);
        // What is 0 is not on a logarithmic scale.
        assert_eq!(scale(&rows, "degrees"), 0.1..1.0);
        assert_eq!([1e-3, 5e-4, 7e-3].map(tolerance_label), ["1e-3", "5e-4", ""]);
        assert_eq!([0.001, 20.0, 1e5, 1e-4].map(label), ["0.001", "20", "1e5", "1e-4"]);
        let products = [9.999999999999999e-5, 0.0009999999999999998, 99999.99999999999];
        assert_eq!(products.map(label), ["1e-4", "0.001", "1e5"]);
    }

    /// A legend has room of its own: it neither hides what is drawn nor stretches an axis.
    #[test]
    fn legends_stand_above_the_axes() {
        let text = svg(&[vec![panel(&[(1e-3, 60.0), (1e-5, 18.0)])]]).unwrap();
        let number = |tag: &str, key: &str| -> f64 {
            let rest = tag.split(&format!(" {key}=\"")).nth(1).unwrap();
            rest.split('"').next().unwrap().parse().unwrap()
        };
        let names = ["nurbray scalar", "nurbray wide", "embree"];
        let lowest = |name: &str| {
            let tag = text.split("<text").find(|tag| tag.contains(&format!("\n{name}\n")));
            number(tag.unwrap_or_else(|| panic!("no {name}")), "y")
        };
        let legend = names.map(lowest).into_iter().fold(0.0, f64::max);
        // The first circle is the legend's; the others are points within the axes.
        let circles: Vec<f64> =
            text.split("<circle").skip(1).map(|tag| number(tag, "cy")).collect();
        assert_eq!(circles.len(), 1 + 2);
        assert!(circles[1..].iter().all(|y| *y > legend + 16.0), "{legend} {circles:?}");
        assert!(!text.contains("\n1000\n") && text.contains("\n100\n"), "{text}");
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
        assert!(svg(&[]).is_ok());
    }
}
