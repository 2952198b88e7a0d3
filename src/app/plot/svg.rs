//! Panels as an SVG picture.

use std::ops::Range;

use anyhow::{Error, anyhow};
use glam::DVec2;
use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint, Ranged};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::super::chart::only_xml;
use super::area::keyhole;
use super::dashes::dashed;
use super::flatten::flatten;
use super::labels::placed;
use super::panel::{GRID, INK, Item, Key, Mark, Panel, Scale, Stroke};
use super::ticks::{NUMBER_SIZE, Ticks, width};
use super::view::{LEFT, RIGHT, View};

/// Plotters counts in whole pixels. It draws a picture this many times as large, and the first
/// line of the file makes that small again.
pub(crate) const SUBPIXELS: u32 = 32;

/// Curves are drawn to within this much of a pixel: a tenth of the width of a thin line.
pub(super) const TOLERANCE: f64 = 0.1;

const TITLE: f64 = 34.0;
const NUMBERS: f64 = 24.0;
const AXIS_NAME: f64 = 16.0;
const LEGEND_LINE: f64 = 18.0;
const BOTTOM: f64 = 10.0;

/// The gap, in pixels, between the picture's border and words that begin there.
const MARGIN: f64 = 3.0;

/// The length of the line in a legend, in pixels.
const KEY_LENGTH: f64 = 18.0;

/// Sizes of letters in pixels.
const TITLE_SIZE: f64 = 15.0;
const LEAST_TITLE_SIZE: f64 = 10.0;
const TEXT_SIZE: f64 = 12.0;
const LABEL_SIZE: f64 = 11.0;

/// The approximate width of a letter, in shares of its size, for the layout of legends.
const LETTER: f64 = 0.56;

/// The size of the smallest plot that shows anything, in pixels each way.
const LEAST: f64 = 60.0;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<Axis<'a>, Axis<'a>>>;

/// An axis with our own numbers beside it.
struct Axis<'a> {
    low: f64,
    high: f64,
    ticks: &'a Ticks,
}

impl Ranged for Axis<'_> {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, (from, to): (i32, i32)) -> i32 {
        let share = (value - self.low) / (self.high - self.low);
        from + (share * f64::from(to - from)).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        if hint.weight().allow_light_points() { Vec::new() } else { self.ticks.values.clone() }
    }

    fn range(&self) -> Range<f64> {
        self.low..self.high
    }
}

/// Why panels cannot be drawn.
pub(super) enum Unable {
    /// The picture is too small: the least width and height that would do.
    TooSmall([u32; 2]),
    /// A panel, counted from 0, has nothing in it, or its extent is not finite.
    NoExtent(usize),
    /// Plotters fails.
    Drawing(Error),
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for Unable {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Self::Drawing(anyhow!("cannot draw: {error}"))
    }
}

/// The panels in rows of this many columns, as the text of an SVG file.
pub(super) fn svg(panels: &[Panel], columns: usize, size: [u32; 2]) -> Result<String, Unable> {
    let columns = columns.clamp(1, panels.len().max(1));
    let rows = panels.len().div_ceil(columns).max(1);
    let cell = DVec2::new(f64::from(size[0]) / columns as f64, f64::from(size[1]) / rows as f64);
    let needed = panels.iter().map(|panel| DVec2::splat(LEAST) + around(panel, cell.x));
    let needed = needed.fold(DVec2::ZERO, DVec2::max).ceil();
    if !cell.cmpge(needed).all() {
        let least = [needed.x as u32 * columns as u32, needed.y as u32 * rows as u32];
        return Err(Unable::TooSmall(least));
    }

    let large = size.map(|side| side * SUBPIXELS);
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, large.into()).into_drawing_area();
        root.fill(&WHITE)?;
        let cells = root.split_evenly((rows, columns));
        for (index, (panel, area)) in panels.iter().zip(&cells).enumerate() {
            let plot = cell - around(panel, cell.x);
            let view = View::of(panel, plot).ok_or(Unable::NoExtent(index))?;
            Drawing { area, panel, view, cell }.draw()?;
        }
        root.present()?;
    }
    let [width, height] = large;
    let shown = format!("<svg width=\"{}\" height=\"{}\"", size[0], size[1]);
    let text = text.replacen(&format!("<svg width=\"{width}\" height=\"{height}\""), &shown, 1);
    Ok(only_xml(text))
}

/// The width and height that a panel in a cell of this width needs around its plot.
fn around(panel: &Panel, width: f64) -> DVec2 {
    let legend = legend_lines(panel, width - LEFT - RIGHT).len() as f64 * LEGEND_LINE;
    DVec2::new(LEFT + RIGHT, TITLE + NUMBERS + AXIS_NAME + legend + BOTTOM)
}

/// A length in pixels as plotters counts it.
fn sub(pixels: f64) -> i32 {
    (pixels * f64::from(SUBPIXELS)).round() as i32
}

fn style(stroke: Stroke) -> ShapeStyle {
    stroke.color.stroke_width(sub(stroke.width).unsigned_abs())
}

fn font(size: f64, color: RGBColor, pos: Pos) -> TextStyle<'static> {
    // Plotters takes a size for the height of a line, of which letters have 1/1.24.
    let size = size * 1.24 * f64::from(SUBPIXELS);
    let mut style = TextStyle::from(("sans-serif", size).into_font()).pos(pos);
    style.color = color.to_backend_color();
    style
}

/// The entries of a legend line by line, each with the position where it begins.
fn legend_lines(panel: &Panel, width: f64) -> Vec<Vec<(f64, usize)>> {
    const KEY: f64 = 26.0;
    const BETWEEN: f64 = 16.0;
    let mut lines: Vec<Vec<(f64, usize)>> = Vec::new();
    let mut x = f64::INFINITY;
    for (index, (_, text)) in panel.legend.iter().enumerate() {
        let long = KEY + LETTER * TEXT_SIZE * text.chars().count() as f64;
        if x + long > width {
            lines.push(Vec::new());
            x = 0.0;
        }
        if let Some(line) = lines.last_mut() {
            line.push((x, index));
        }
        x += long + BETWEEN;
    }
    lines
}

/// One panel in its cell.
struct Drawing<'a, 'b> {
    area: &'a Area<'b>,
    panel: &'a Panel,
    view: View,
    cell: DVec2,
}

impl Drawing<'_, '_> {
    fn draw(&self) -> Result<(), Unable> {
        let panel = self.panel;
        let (low, high) = (self.view.low, self.view.high);
        let below = self.cell.y - TITLE - self.view.pixels.y - NUMBERS;
        let plot = self.area.margin(sub(TITLE), sub(below), 0, sub(RIGHT));
        let [x_ticks, y_ticks] = self.view.ticks(panel.scale);
        let mut chart = ChartBuilder::on(&plot)
            .x_label_area_size(sub(NUMBERS))
            .y_label_area_size(sub(LEFT))
            .build_cartesian_2d(
                Axis { low: low.x, high: high.x, ticks: &x_ticks },
                Axis { low: low.y, high: high.y, ticks: &y_ticks },
            )?;
        if panel.scale != Scale::View {
            let numbers = font(NUMBER_SIZE, INK, Pos::new(HPos::Center, VPos::Top));
            chart
                .configure_mesh()
                .bold_line_style(GRID.stroke_width(SUBPIXELS))
                .light_line_style(TRANSPARENT)
                .axis_style(INK.stroke_width(SUBPIXELS))
                .set_all_tick_mark_size(sub(4.0))
                .label_style(numbers)
                .x_label_formatter(&|&value| x_ticks.text(value))
                .y_label_formatter(&|&value| y_ticks.text(value))
                .draw()?;
        }
        for item in &panel.items {
            self.item(&mut chart, item)?;
        }
        self.labels()?;
        let [across, up] = &panel.axes;
        match panel.scale {
            Scale::View => self.words(Default::default()),
            _ => self.words([x_ticks.name(across), y_ticks.name(up)]),
        }
    }

    fn labels(&self) -> Result<(), Unable> {
        let size = |text: &str| {
            let letters = text.chars().count() as f64;
            DVec2::new(LETTER * LABEL_SIZE * letters + 2.0, 1.2 * LABEL_SIZE)
        };
        let labels = self.panel.items.iter().filter_map(|item| match item {
            Item::Label { text, color, .. } => Some((text, *color)),
            _ => None,
        });
        let places = placed(self.panel, self.view, size);
        for ((text, color), place) in labels.zip(places) {
            let [x, y] = [place.middle.x + LEFT, TITLE + self.view.pixels.y - place.middle.y];
            let middle = font(LABEL_SIZE, color, Pos::new(HPos::Center, VPos::Center));
            self.area.draw(&Text::new(text.clone(), (sub(x), sub(y)), middle))?;
        }
        Ok(())
    }

    /// Draws one item into the chart.
    fn item(&self, chart: &mut Chart<'_, '_>, item: &Item) -> Result<(), Unable> {
        match item {
            Item::Curve { path, stroke } => {
                let pixels = |t| self.view.to_pixels((path.at)(t));
                for line in flatten(pixels, &path.pieces, TOLERANCE) {
                    self.dashes(chart, &line, *stroke)?;
                }
            }
            Item::Line { points, stroke } if stroke.dashes.is_empty() => {
                let line: Vec<(f64, f64)> = points.iter().map(|&point| point.into()).collect();
                chart.draw_series([PathElement::new(line, style(*stroke))])?;
            }
            Item::Line { points, stroke } => {
                let line: Vec<DVec2> = points.iter().map(|&p| self.view.to_pixels(p)).collect();
                self.dashes(chart, &line, *stroke)?;
            }
            Item::Marks { points, mark, color } => {
                for &point in points {
                    let at = EmptyElement::at(point.into());
                    match mark {
                        Mark::Ring => chart.draw_series([at
                            + Circle::new((0, 0), sub(3.6), WHITE.filled())
                            + Circle::new(
                                (0, 0),
                                sub(3.6),
                                color.stroke_width(sub(1.3) as u32),
                            )])?,
                        Mark::Dot => chart
                            .draw_series([at + Circle::new((0, 0), sub(3.2), color.filled())])?,
                        Mark::Diamond => {
                            chart.draw_series([at + Polygon::new(diamond(), color.filled())])?
                        }
                    };
                }
            }
            Item::Area { rings, color } => {
                let pixels = |&point: &DVec2| self.view.to_pixels(point);
                let rings: Vec<Vec<DVec2>> =
                    rings.iter().map(|ring| ring.iter().map(pixels).collect()).collect();
                let outline = keyhole(&rings).into_iter();
                let outline: Vec<(f64, f64)> =
                    outline.map(|at| self.view.point_at(at).into()).collect();
                chart.draw_series([Polygon::new(outline, color.filled())])?;
            }
            Item::Arrows { steps, color } => {
                for step in steps {
                    let [from, to] = step.map(|point| self.view.to_pixels(point));
                    let along = (to - from).normalize_or(DVec2::X);
                    let at = EmptyElement::at((0.5 * (step[0] + step[1])).into());
                    let corners = arrow(along);
                    chart.draw_series([at + Polygon::new(corners, color.filled())])?;
                }
            }
            Item::Label { .. } => {} // placed when all else is drawn
        }
        Ok(())
    }

    /// Draws a line given in pixels, dashed as its stroke is.
    fn dashes(
        &self,
        chart: &mut Chart<'_, '_>,
        line: &[DVec2],
        stroke: Stroke,
    ) -> Result<(), Unable> {
        for dash in dashed(line, stroke.dashes) {
            let dash = dash.into_iter().map(|at| self.view.point_at(at).into());
            let dash: Vec<(f64, f64)> = dash.collect();
            chart.draw_series([PathElement::new(dash, style(stroke))])?;
        }
        Ok(())
    }

    /// Draws the title, the names of the axes and the legend.
    fn words(&self, [across, up]: [String; 2]) -> Result<(), Unable> {
        let (panel, plot) = (self.panel, self.view.pixels);
        let middle = LEFT + 0.5 * plot.x;
        let write = |text: &str, at: [f64; 2], style: TextStyle<'_>| {
            self.area.draw(&Text::new(text.to_owned(), (sub(at[0]), sub(at[1])), style))
        };
        // A long name of the upward axis begins at the picture's border, and the title behind it.
        let end = LEFT - 8.0;
        let long = width(&up, TEXT_SIZE);
        let (at, side) = if long <= end { (end, HPos::Right) } else { (MARGIN, HPos::Left) };
        let free = plot.x - 2.0 * (MARGIN + long + 8.0 - LEFT).max(0.0);
        let bottom = Pos::new(HPos::Center, VPos::Bottom);
        let (lines, size) = title_lines(&panel.title, free.max(0.2 * plot.x));
        let lowest = if lines.len() > 1 { TITLE - 5.0 } else { TITLE - 9.0 };
        for (index, line) in lines.iter().rev().enumerate() {
            let y = lowest - 1.2 * size * index as f64;
            write(line, [middle, y], font(size, INK, bottom))?;
        }
        write(&up, [at, TITLE - 7.0], font(TEXT_SIZE, INK, Pos::new(side, VPos::Bottom)))?;
        let below = TITLE + plot.y + NUMBERS;
        let top = Pos::new(HPos::Center, VPos::Top);
        write(&across, [middle, below], font(TEXT_SIZE, INK, top))?;

        for (row, line) in legend_lines(panel, plot.x).into_iter().enumerate() {
            let y = below + AXIS_NAME + (row as f64 + 0.6) * LEGEND_LINE;
            for (x, index) in line {
                let (key, text) = &panel.legend[index];
                self.key(*key, [LEFT + x, y])?;
                let left = Pos::new(HPos::Left, VPos::Center);
                write(text, [LEFT + x + 24.0, y], font(TEXT_SIZE, INK, left))?;
            }
        }
        Ok(())
    }

    fn key(&self, key: Key, [x, y]: [f64; 2]) -> Result<(), Unable> {
        let middle = (sub(x + 9.0), sub(y));
        match key {
            Key::Line(stroke) => {
                let ends = [0.0, KEY_LENGTH].map(|along| DVec2::new(x + along, y));
                for dash in dashed(&ends, stroke.dashes) {
                    let ends: Vec<_> = dash.into_iter().map(|at| (sub(at.x), sub(at.y))).collect();
                    self.area.draw(&PathElement::new(ends, style(stroke)))?;
                }
            }
            Key::Area(color) => {
                let corners = [(sub(x), sub(y - 6.0)), (sub(x + KEY_LENGTH), sub(y + 6.0))];
                self.area.draw(&Rectangle::new(corners, color.filled()))?;
            }
            Key::Point(Mark::Ring, color) => {
                let style = color.stroke_width(sub(1.3) as u32);
                self.area.draw(&Circle::new(middle, sub(3.6), style))?;
            }
            Key::Point(Mark::Dot, color) => {
                self.area.draw(&Circle::new(middle, sub(3.2), color.filled()))?;
            }
            Key::Point(Mark::Diamond, color) => {
                let moved = diamond().into_iter().map(|(dx, dy)| (middle.0 + dx, middle.1 + dy));
                self.area.draw(&Polygon::new(moved.collect::<Vec<_>>(), color.filled()))?;
            }
        }
        Ok(())
    }
}

/// A title as lines that fit a width, and the size of their letters: one line in smaller letters,
/// else two, else two that end with `…`.
fn title_lines(title: &str, width: f64) -> (Vec<String>, f64) {
    let letters = |line: &str| line.chars().count().max(1) as f64;
    let fitting = |line: &str| width / (LETTER * letters(line));
    if fitting(title) >= LEAST_TITLE_SIZE {
        return (vec![title.to_owned()], TITLE_SIZE.min(fitting(title)));
    }
    // Of all places between words, that with the shortest of longer lines.
    let spaces = title.match_indices(' ').map(|(at, _)| [&title[..at], &title[at + 1..]]);
    let longer = |lines: &[&str; 2]| lines.map(|line| line.chars().count()).into_iter().max();
    let lines = spaces.min_by_key(longer).map_or(vec![title], Vec::from);
    let most = (width / (LETTER * LEAST_TITLE_SIZE)).max(1.0) as usize;
    let cut = |line: &str| match line.chars().count() > most {
        true => line.chars().take(most - 1).chain(['…']).collect(),
        false => line.to_owned(),
    };
    (lines.into_iter().map(cut).collect(), LEAST_TITLE_SIZE)
}

/// The head of an arrow about its middle; plotters counts downwards.
fn arrow(along: DVec2) -> Vec<(i32, i32)> {
    let across = along.perp();
    let corners = [6.0 * along, -4.0 * along + 4.0 * across, -4.0 * along - 4.0 * across];
    corners.map(|corner| (sub(corner.x), -sub(corner.y))).to_vec()
}

fn diamond() -> Vec<(i32, i32)> {
    let r = sub(4.2);
    vec![(-r, 0), (0, -r), (r, 0), (0, r)]
}
