//! Borders and trim edges that nearly meet: gaps that let rays through.

use std::collections::BTreeSet;
use std::fmt;

use glam::DVec3;
use nurbray::geometry::{Chart, Charts, CurveError, Surface, TrimmedSurface};
use nurbray::math::Aabb;
use rayon::prelude::*;

use super::super::border::{Border, rounding};
use super::border_curve::BorderCurve;

/// Borders farther apart than this share of the size of the larger of the objects that they belong to are
/// apart on purpose: what is modelled at that size is as exact as that.
pub(crate) const NEAR: f64 = 1e-3;

/// Nor is a gap what is wider than this share of the smaller object: a teapot on a large table has no
/// more of them.
pub(crate) const NEAR_SMALLER: f64 = 1e-2;

/// Nor do borders nearly meet that are farther apart than this share of the shorter one's
/// length: at a corner of a small surface all of its borders are near one another.
pub(crate) const NEAR_LENGTH: f64 = 0.05;

/// The share of a border's points that must be near the other for the two to run side by
/// side. Two borders that meet at a corner of more than 12° have a smaller share: 0.05 / sin 12°.
pub(crate) const SIDE_BY_SIDE: f64 = 0.25;

/// A border or a trim edge of one of the surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Edge {
    /// Which surface.
    pub(crate) surface: usize,
    /// Which of its charts.
    chart: usize,
    /// Which of its borders or edges.
    pub(crate) which: Which,
}

/// Which border or trim edge of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Which {
    /// A border.
    Border(Border),
    /// A trim edge, counted from 0.
    Trim(usize),
}

impl fmt::Display for Which {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Border(border) => border.fmt(f),
            Self::Trim(number) => write!(f, "trim edge {number}"),
        }
    }
}

/// Two borders that run side by side without meeting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Gap {
    /// The borders, in the order of the surfaces.
    pub(crate) edges: [Edge; 2],
    /// The largest distance found between them, where they run side by side.
    pub(crate) width: f64,
    /// Where that is.
    pub(crate) at: DVec3,
}

/// How the borders of a model fit together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Fit {
    /// Borders in all, four a surface, with all trim edges.
    pub(crate) borders: usize,
    /// Of these, trim edges.
    pub(crate) trim_edges: usize,
    /// Of these, collapsed to a point.
    pub(crate) collapsed: usize,
    /// Of the others, those that meet another to within rounding.
    pub(crate) meeting: usize,
    /// Those that run beside another, but nearly meet it only.
    pub(crate) nearly: usize,
    /// Those with no other beside them.
    pub(crate) free: usize,
    /// The gaps, the widest first.
    pub(crate) gaps: Vec<Gap>,
    /// Surfaces whose trim edges are not among these, with the reason.
    pub(crate) left_out: Vec<(usize, CurveError)>,
}

/// Compares every border and trim edge with every other that comes near it.
///
/// `drawings` says of each surface which drawing (a tube, a net) it belongs to, if to one. Tubes and
/// joints of one drawing run into each other: what nearly meets there is no gap. `sizes` are those of the objects
/// that the surfaces belong to.
pub(crate) fn fit(surfaces: &[Surface], drawings: &[Option<[usize; 2]>], sizes: &[f64]) -> Fit {
    let charts: Vec<Vec<Chart<'_>>> = surfaces.iter().map(Charts::charts).collect();
    let Edges { curves, collapsed, trim_edges, left_out } = Edges::of(surfaces, &charts);
    let mut meeting = BTreeSet::new();
    let mut beside = BTreeSet::new();
    let mut gaps = Vec::new();
    for ([i, j], (width, at)) in neighbours(&curves, sizes) {
        let edges = [i, j].map(|k| curves[k].0);
        let rounded = |edge: &Edge| rounding(&charts[edge.surface][edge.chart].surface);
        let [a, b] = edges.map(|edge| drawings.get(edge.surface).copied().flatten());
        if width <= edges.iter().map(rounded).sum() {
            meeting.extend([i, j]);
        } else if a.is_none() || a != b {
            beside.extend([i, j]);
            gaps.push(Gap { edges, width, at });
        }
    }
    gaps.sort_by(|a, b| b.width.total_cmp(&a.width)); // stable: equal ones keep their order
    let nearly = beside.difference(&meeting).count();
    Fit {
        borders: curves.len() + collapsed,
        trim_edges,
        collapsed,
        meeting: meeting.len(),
        nearly,
        free: curves.len() - meeting.len() - nearly,
        gaps,
        left_out,
    }
}

/// The borders and trim edges of surfaces.
struct Edges<'a> {
    /// Those that are curves, borders first.
    curves: Vec<(Edge, BorderCurve<'a>)>,
    /// How many others are collapsed to a point.
    collapsed: usize,
    /// How many of the curves are trim edges.
    trim_edges: usize,
    /// Surfaces whose trim edges are not known, with the reason.
    left_out: Vec<(usize, CurveError)>,
}

impl<'a> Edges<'a> {
    /// Those of surfaces with these charts.
    fn of(surfaces: &[Surface], charts: &'a [Vec<Chart<'a>>]) -> Self {
        let mut borders: Vec<(Edge, Border)> = Vec::new();
        for (surface, charts) in charts.iter().enumerate() {
            for (index, chart) in charts.iter().enumerate() {
                let kept = Border::of(chart).filter(|border| border.is_kept(chart));
                borders.extend(kept.map(|border| {
                    (Edge { surface, chart: index, which: Which::Border(border) }, border)
                }));
            }
        }
        let curve = |&(edge, border): &(Edge, Border)| {
            let chart = &charts[edge.surface][edge.chart];
            let extended = border.pole(&chart.surface).is_none();
            extended.then(|| (edge, BorderCurve::new(chart, border)))
        };
        let mut curves: Vec<_> = borders.par_iter().filter_map(curve).collect();
        let extended = curves.len();
        let mut left_out = Vec::new();
        for (surface, one) in surfaces.iter().enumerate() {
            match one.trimmed().map(TrimmedSurface::edge_curves).unwrap_or(Ok(Vec::new())) {
                Ok(edges) => curves.extend(edges.into_iter().enumerate().map(|(number, edge)| {
                    let which = Which::Trim(number);
                    (Edge { surface, chart: 0, which }, BorderCurve::of_edge(edge))
                })),
                Err(error) => left_out.push((surface, error)),
            }
        }
        let trim_edges = curves.len() - extended;
        Self { curves, collapsed: borders.len() - extended, trim_edges, left_out }
    }
}

/// The pairs of borders that run side by side, the largest distance between them, and where.
fn neighbours(
    curves: &[(Edge, BorderCurve<'_>)],
    sizes: &[f64],
) -> Vec<([usize; 2], (f64, DVec3))> {
    let near = |[a, b]: [f64; 2]| (NEAR * a.max(b)).min(NEAR_SMALLER * a.min(b));
    let largest = sizes.iter().fold(0.0, |a: f64, &b| a.max(b));
    // That of the larger object is grown by at least as much as the two may be apart.
    let farthest = |edge: &Edge| near([sizes[edge.surface], largest]);
    let boxes: Vec<Aabb> = curves.iter().map(|(e, c)| c.bounds().grown(farthest(e))).collect();
    let compared = |&[i, j]: &[usize; 2]| {
        let [(a, first), (b, second)] = [&curves[i], &curves[j]];
        let near = near([a, b].map(|edge| sizes[edge.surface]));
        Some(([i, j], side_by_side(first, second, near)?))
    };
    overlapping(&boxes).par_iter().filter_map(compared).collect()
}

/// The largest distance between two borders where they run side by side, no farther apart than `near`, and
/// where; `None` if they do not.
fn side_by_side(a: &BorderCurve<'_>, b: &BorderCurve<'_>, near: f64) -> Option<(f64, DVec3)> {
    let near = near.min(NEAR_LENGTH * a.length().min(b.length()));
    // One may run along a part of the other only: then not all points of the longer are near.
    let one_way = |from: &BorderCurve<'_>, to: &BorderCurve<'_>| {
        let points = from.points();
        let distance = |&point: &DVec3| Some((to.distance(point, near)?, point));
        let distances: Vec<(f64, DVec3)> = points.iter().filter_map(distance).collect();
        let enough = distances.len() as f64 >= SIDE_BY_SIDE * points.len() as f64;
        let widest = distances.into_iter().max_by(|x, y| x.0.total_cmp(&y.0));
        widest.filter(|_| enough)
    };
    let ways = [one_way(a, b), one_way(b, a)];
    ways.into_iter().flatten().max_by(|x, y| x.0.total_cmp(&y.0))
}

/// All pairs of boxes that have a point in common, by sweeping along x.
fn overlapping(boxes: &[Aabb]) -> Vec<[usize; 2]> {
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&i, &j| boxes[i].min.x.total_cmp(&boxes[j].min.x));
    let mut open: Vec<usize> = Vec::new();
    let mut pairs = Vec::new();
    for next in order {
        open.retain(|&other| boxes[other].max.x >= boxes[next].min.x);
        let common = |&&other: &&usize| {
            boxes[other].min.cmple(boxes[next].max).all()
                && boxes[next].min.cmple(boxes[other].max).all()
        };
        pairs.extend(open.iter().filter(common).map(|&k| [k.min(next), k.max(next)]));
        open.push(next);
    }
    pairs.sort_unstable();
    pairs
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec2};
    use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
    use nurbray::geometry::{NurbsSurface, shapes};

    use super::*;

    /// [`super::fit`] of whole surfaces.
    fn fit(surfaces: &[NurbsSurface], size: f64) -> Fit {
        let surfaces: Vec<Surface> = surfaces.iter().cloned().map(Surface::from).collect();
        super::fit(&surfaces, &[], &vec![size; surfaces.len()])
    }

    #[test]
    fn the_parts_of_one_drawing_have_no_gaps() {
        let sheets = [plane_at(0.0, 0.0, 0.0), plane_at(1.0 + 1e-6, 0.0, 0.0)].map(Surface::from);
        let gaps = |drawings: [Option<[usize; 2]>; 2]| {
            super::fit(&sheets, &drawings, &[2.0; 2]).gaps.len()
        };
        assert_eq!(gaps([Some([3, 0]); 2]), 0);
        assert_eq!(gaps([Some([3, 0]), Some([4, 0])]), 1);
        assert_eq!(gaps([Some([3, 0]), None]), 1);
    }

    fn plane_at(x: f64, y: f64, z: f64) -> NurbsSurface {
        let plane = shapes::plane(1.0, 1.0).unwrap();
        plane.transformed(&DAffine3::from_translation(DVec3::new(x, y, z))).unwrap()
    }

    #[test]
    fn a_gap_is_as_wide_as_it_was_made_at_every_size() {
        for scale in [1e-8, 1.0, 1e8] {
            for width in [1e-4, 1e-7, 1e-10] {
                let sheets = [plane_at(0.0, 0.0, 0.0), plane_at(1.0 + width, 0.0, 0.0)];
                let enlarge = DAffine3::from_scale(DVec3::splat(scale));
                let sheets = sheets.map(|sheet| sheet.transformed(&enlarge).unwrap());
                let fit = fit(&sheets, 2.0 * scale);
                assert_eq!((fit.borders, fit.nearly, fit.free), (8, 2, 6), "{scale} {width}");
                assert_eq!(fit.gaps.len(), 1);
                let found = fit.gaps[0].width / scale;
                assert!((found - width).abs() < 1e-14, "{scale}: {found} for {width}");
            }
        }
    }

    #[test]
    fn sheets_that_meet_or_are_apart_have_no_gap() {
        let meet = fit(&[plane_at(0.0, 0.0, 0.0), plane_at(1.0, 0.0, 0.0)], 2.0);
        assert_eq!((meet.meeting, meet.free, meet.gaps.len()), (2, 6, 0));
        let apart = fit(&[plane_at(0.0, 0.0, 0.0), plane_at(1.1, 0.0, 0.0)], 2.0);
        assert_eq!((apart.meeting, apart.free, apart.gaps.len()), (0, 8, 0));
    }

    /// Two sheets of objects of these sizes.
    #[test]
    fn what_is_near_depends_on_both_objects() {
        let sheets = |apart: f64| [plane_at(0.0, 0.0, 0.0), plane_at(1.0 + apart, 0.0, 0.0)];
        let gaps = |apart: f64, sizes: [f64; 2]| {
            super::fit(&sheets(apart).map(Surface::from), &[], &sizes).gaps.len()
        };
        for (apart, sizes, expected) in [
            (1e-3, [2.0, 2.0], 1),
            (3e-3, [2.0, 2.0], 0),
            (3e-3, [2.0, 2e4], 1),
            (3e-2, [2.0, 2e4], 0),
            (3e-2, [2e4, 2e4], 1),
            (1e-3, [0.5, 2.0], 1),
            (1e-3, [0.05, 2.0], 0),
        ] {
            assert_eq!(gaps(apart, sizes), expected, "{apart} apart, {sizes:?} large");
        }
    }

    #[test]
    fn a_short_border_may_lie_along_a_part_of_a_long_one() {
        let halved = plane_at(0.0, 0.0, 0.0).split_v(0.5).unwrap();
        let beside = plane_at(1.0 + 1e-6, 0.0, 0.0);
        let fit = fit(&[halved.0, halved.1, beside], 2.0);
        let gaps: Vec<f64> = fit.gaps.iter().map(|gap| gap.width).collect();
        assert_eq!(gaps.len(), 2, "{:?}", fit.gaps);
        assert!(gaps.iter().all(|width| (width - 1e-6).abs() < 1e-14), "{gaps:?}");
        assert_eq!(fit.meeting, 2); // the halves along their cut
    }

    #[test]
    fn seams_and_poles_of_closed_shapes_fit() {
        let sphere = fit(&[shapes::sphere(1.0).unwrap()], 2.0);
        assert_eq!((sphere.collapsed, sphere.meeting, sphere.free), (2, 2, 0));
        let torus = fit(&[shapes::torus(3.0, 1.0).unwrap()], 8.0);
        assert_eq!((torus.collapsed, torus.meeting, torus.free), (0, 4, 0));
        assert!(sphere.gaps.is_empty() && torus.gaps.is_empty());
    }

    #[test]
    fn parts_cut_by_one_loop_meet_and_moved_ones_have_a_gap() {
        let sphere = shapes::sphere(2.0).unwrap();
        let [(u0, u1), (v0, v1)] = sphere.domain();
        let center = DVec2::new(0.5 * (u0 + u1), 0.3 * v0 + 0.7 * v1);
        let circle = TrimLoop::circle(center, 0.2).unwrap();
        let domain = TrimDomain::with_seams_of(&sphere).unwrap();
        let part = |kept, moved: f64| {
            let trims = Trims::new(domain, kept, std::slice::from_ref(&circle)).unwrap();
            let part = TrimmedSurface::new(sphere.clone(), trims).unwrap();
            let map = DAffine3::from_scale(DVec3::splat(1.0 + moved));
            Surface::from(part.transformed(&map).unwrap())
        };
        let whole = super::fit(&[part(Kept::Odd, 0.0), part(Kept::Even, 0.0)], &[], &[4.0; 2]);
        assert_eq!((whole.trim_edges, whole.gaps.len()), (2, 0));
        assert_eq!((whole.collapsed, whole.meeting, whole.free), (2, 4, 0));
        // Larger by 1e-5, a part is 2e-5 off all along its edge.
        let torn = super::fit(&[part(Kept::Odd, 1e-5), part(Kept::Even, 0.0)], &[], &[4.0; 2]);
        assert_eq!((torn.meeting, torn.nearly, torn.gaps.len()), (2, 2, 1));
        assert!((torn.gaps[0].width - 2e-5).abs() < 1e-13, "{}", torn.gaps[0].width);
        assert_eq!(torn.gaps[0].edges.map(|edge| edge.which), [Which::Trim(0); 2]);
    }
}
