//! `nurbray plot`: curves, functions and constructions as figures.

mod area;
mod bending;
mod box_axes;
mod dashes;
mod defaults;
mod flatten;
mod functions;
mod hodograph;
mod labels;
mod panel;
mod peaks;
mod png;
mod projection;
mod space;
mod space_panel;
mod spline_data;
mod steps;
mod surfaces;
mod svg;
mod ticks;
mod trims;
mod view;

use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

use anyhow::anyhow;
use nurbray::geometry::NurbsCurve;
use nurbray::geometry::trim::TrimError;
use nurbray::io::{put_all_in_place, stage};
use nurbray::scene::{Plot, PlotKind, PlottedCurve, Scene};

use super::args::PlotArguments;
use super::failure::{Failure, OrFail};
use super::table::count;
use super::{console, input, output};
use panel::Panel;
use svg::Unable;

/// The longest side of a picture in pixels: what image programs open, and what fits in memory.
const MAX_SIDE: u32 = 8192;

/// The most plots that are chosen for a scene which asks for none.
const MOST_CHOSEN: usize = 24;

/// The size of one plot in pixels, if neither the command line nor the scene gives a size.
const PLOT_SIZE: [u32; 2] = [480, 400];

/// Runs the subcommand.
pub(crate) fn run(arguments: &PlotArguments) -> Result<ExitCode, Failure> {
    let paths: Vec<&Path> = arguments.outputs.iter().map(AsRef::as_ref).collect();
    let formats = paths.iter().map(|path| output::format(path, &["svg", "png"]));
    let formats = formats.collect::<Result<Vec<_>, _>>()?;
    output::check(&paths, &[&arguments.input])?;
    let scene = input::read_apart(&arguments.input, &paths)?;

    let plots = plots(&scene)?;
    input::warn_of_what_is_not_shown(&arguments.input, &scene);
    let places = (0..plots.len()).map(|index| place(arguments, &scene, index));
    let panels = plots.into_iter().zip(places).map(|(plot, place)| panel(plot, &place));
    let panels = panels.collect::<Result<Vec<_>, _>>()?;
    let columns = match &scene.figure.columns {
        Some(columns) => columns.value.min(panels.len()),
        None => (1..).find(|side| side * side >= panels.len()).unwrap_or(1),
    };
    let (size, place_of_size) = size(arguments, &scene, [columns, panels.len().div_ceil(columns)])?;
    let text = svg::svg(&panels, columns, size).map_err(|unable| match unable {
        Unable::TooSmall([width, height]) => Failure::input(format!(
            "{place_of_size}{} x {} pixels are too few for {}: at least {width}x{height} are needed",
            size[0],
            size[1],
            count(panels.len() as u64, "plot"),
        )),
        Unable::NoExtent(index) => Failure::input(format!(
            "{}: plot \"{}\": it has no finite extent that could be drawn",
            place(arguments, &scene, index),
            panels[index].title
        )),
        Unable::Drawing(error) => Failure::Work(error),
    })?;

    let staged = paths.iter().zip(formats).map(|(path, format)| match format {
        "png" => png::stage(path, &text, size).or_failed(),
        _ => stage(path, |file| file.write_all(text.as_bytes())).or_failed(),
    });
    put_all_in_place(staged.collect::<Result<_, _>>()?).or_failed()?;
    if !arguments.quiet {
        let drawn = count(panels.len() as u64, "plot");
        console::say(&format!("{drawn}; wrote {}", output::listed(&paths)));
    }
    Ok(ExitCode::SUCCESS)
}

/// The plots a scene asks for, or those that suit it.
fn plots(scene: &Scene) -> Result<Vec<Plot>, Failure> {
    if scene.plots.is_empty() {
        let mut plots = defaults::plots(scene)?;
        if plots.is_empty() {
            return Err(Failure::input("there is nothing to plot: no curve, no surface"));
        }
        if plots.len() > MOST_CHOSEN {
            let (shown, all) = (MOST_CHOSEN, plots.len());
            console::warning(&format!(
                "plotted are the first {shown} of {all} curves, surfaces and knot vectors; [[plot]] \
                 tables choose others"
            ));
            plots.truncate(MOST_CHOSEN);
        }
        return Ok(plots);
    }
    let numbered = scene.plots.iter().enumerate();
    numbered.map(|(index, plot)| plot.checked(index, scene).or_bad_input()).collect()
}

/// Returns the size of the picture: the command line's, else the scene's, else a fixed size for
/// each plot. Also returns what to put before a message about it: where the scene gives it, or the
/// number of columns that it follows from.
fn size(
    arguments: &PlotArguments,
    scene: &Scene,
    grid: [usize; 2],
) -> Result<([u32; 2], String), Failure> {
    let (size, place) = match (arguments.size, &scene.figure.size) {
        (Some(size), _) => ([size.width, size.height], String::new()),
        (None, Some(size)) => (size.value, format!("{}: ", size.place)),
        (None, None) => {
            let side =
                |k: usize| PLOT_SIZE[k].saturating_mul(grid[k].try_into().unwrap_or(u32::MAX));
            let columns = scene.figure.columns.as_ref();
            let place = columns.map(|columns| format!("{}: ", columns.place)).unwrap_or_default();
            ([side(0), side(1)], place)
        }
    };
    match size {
        [..=MAX_SIDE, ..=MAX_SIDE] => Ok((size, place)),
        [width, height] => Err(Failure::input(format!(
            "{place}{width} x {height} pixels: a picture of plots has at most {MAX_SIDE} each way"
        ))),
    }
}

/// Where a plot is asked for: a line of the scene, or only its file if the plot was chosen for it.
fn place(arguments: &PlotArguments, scene: &Scene, index: usize) -> String {
    let input = || arguments.input.display().to_string();
    scene.plots.get(index).map_or_else(input, |plot| plot.place.to_string())
}

/// Makes the panel that draws the plot which is asked for at `place`.
fn panel(plot: Plot, place: &str) -> Result<Panel, Failure> {
    let Plot { title, plane, show } = plot;
    let panel = match show {
        PlotKind::Curves(entries) => space::curves(title, plane, &entries),
        PlotKind::Basis(basis) => functions::basis(title, basis),
        PlotKind::Blending(form) => functions::blending(title, form),
        PlotKind::Derivatives { curve, order } => {
            functions::derivatives(title, (nurbs(&curve)?, order.value))
        }
        PlotKind::Hodograph { curve, order } => {
            hodograph::hodograph(title, plane, (nurbs(&curve)?, order.value))
        }
        PlotKind::Curvature(curve) => functions::curvature(title, nurbs(&curve)?),
        PlotKind::Comb { curve, teeth, scale } => {
            steps::comb(title, plane, nurbs(&curve)?, (teeth, scale))
        }
        PlotKind::Insertion { curve, knots } => {
            steps::insertion(title, plane, (nurbs(&curve)?, &knots)).or_bad_input()?
        }
        PlotKind::Elevation { curve, times } => {
            steps::elevation(title, plane, (nurbs(&curve)?, times.value)).or_bad_input()?
        }
        PlotKind::DeCasteljau { curve, t } => steps::de_casteljau(title, plane, (&curve, t.value)),
        PlotKind::CornerCutting { polygon, scheme, ends, rounds } => {
            steps::corner_cutting(title, plane, (scheme, ends), (&polygon, rounds))
                .or_bad_input()?
        }
        PlotKind::Trims(surfaces) => match &surfaces[..] {
            [only] => {
                let title = title.unwrap_or_else(|| "Trims".to_owned());
                trims::trims(title.clone(), only).map_err(|error| match error {
                    TrimError::Tolerance { limit, .. } => Failure::input(format!(
                        "{place}: plot \"{title}\": the trim loops are so much larger than the \
                         domain that they would need more than {limit} points"
                    )),
                    error => Failure::Work(error.into()),
                })?
            }
            _ => return Err(Failure::work("trims of several surfaces came through the check")),
        },
        PlotKind::Surfaces { of, lines, net } => {
            surfaces::surfaces(title, plane, (&of, lines, net))
        }
        other => return Err(Failure::Work(anyhow!("cannot draw {other:?}"))),
    };
    Ok(panel)
}

/// The curve with positive weights that a checked plot of this kind has.
fn nurbs(curve: &PlottedCurve) -> Result<&NurbsCurve, Failure> {
    curve.nurbs().ok_or_else(|| Failure::work("a weight of 0 came through the check"))
}
