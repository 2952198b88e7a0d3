//! The borders and trim edges of surfaces.

use nurbray::geometry::{Chart, Surface};
use rayon::prelude::*;

use super::super::border::rounding;
use super::border_curve::BorderCurve;
use super::side::Side;
use super::which::Which;

/// A border or a trim edge of one of the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    /// Which surface.
    pub(crate) surface: usize,
    /// Which of its borders or edges.
    pub(crate) which: Which,
}

/// The borders and trim edges of surfaces.
pub(super) struct Edges<'a> {
    /// The edges that are curves, borders first.
    pub(super) curves: Vec<(Edge, BorderCurve<'a>)>,
    /// How many others are collapsed to a point.
    pub(super) collapsed: usize,
    /// How many of the curves are trim edges.
    pub(super) trim_edges: usize,
    /// The error bound of a point of each surface.
    rounding: Vec<f64>,
    /// The largest of these.
    largest_rounding: f64,
}

impl<'a> Edges<'a> {
    /// Collects the edges of surfaces with these charts.
    pub(super) fn of(surfaces: &'a [Surface], charts: &'a [Vec<Chart<'a>>]) -> Self {
        let largest = |charts: &Vec<Chart<'_>>| {
            charts.iter().map(|chart| rounding(&chart.surface)).fold(0.0, f64::max)
        };
        let rounding: Vec<f64> = charts.iter().map(largest).collect();
        let of_surfaces = surfaces.iter().zip(charts).enumerate();
        let sides: Vec<(usize, Side<'_>)> = of_surfaces
            .flat_map(|(index, (surface, charts))| {
                Side::all(surface, charts).into_iter().map(move |side| (index, side))
            })
            .collect();
        let collapsed = sides.iter().filter(|(_, side)| side.kept_pole().is_some()).count();
        let curve = |(surface, side): &(usize, Side<'a>)| {
            Some((Edge { surface: *surface, which: side.which() }, side.curve()?))
        };
        let mut curves: Vec<_> = sides.par_iter().filter_map(curve).collect();

        let borders = curves.len();
        let of_trims = |surface: usize| -> Vec<(Edge, BorderCurve<'a>)> {
            let Some(trimmed) = surfaces[surface].trimmed() else { return Vec::new() };
            let edges = trimmed.edges().into_iter();
            let parts =
                edges.flat_map(|edge| BorderCurve::of_edge(trimmed, edge, rounding[surface]));
            let numbered = parts.enumerate();
            numbered.map(|(k, curve)| (Edge { surface, which: Which::Trim(k) }, curve)).collect()
        };
        curves.par_extend((0..surfaces.len()).into_par_iter().flat_map_iter(of_trims));
        let trim_edges = curves.len() - borders;
        let largest_rounding = rounding.iter().copied().fold(0.0, f64::max);
        Self { curves, collapsed, trim_edges, rounding, largest_rounding }
    }

    /// At most how far apart rounding may put points where any two curves meet.
    pub(super) fn most_rounding(&self) -> f64 {
        2.0 * self.largest_rounding
    }

    /// How far apart rounding may put points where two curves meet.
    pub(super) fn rounding(&self, pair: [usize; 2]) -> f64 {
        pair.iter().map(|&k| self.rounding[self.curves[k].0.surface]).sum()
    }
}
