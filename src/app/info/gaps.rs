//! Borders and trim edges that nearly meet: gaps that let rays through.

use std::collections::BTreeSet;
use std::fmt;

use glam::DVec3;
use nurbray::geometry::{Chart, Charts, CurveError, Surface, TrimmedSurface};
use nurbray::math::Aabb;
use rayon::prelude::*;

use super::super::border::{Border, rounding};
use super::border_curve::{BorderCurve, Sample};

/// Borders farther apart than this share of the size of the larger of the objects that they belong to are
/// apart on purpose: what is modelled at that size is as exact as that.
pub(crate) const NEAR: f64 = 1e-3;

/// Nor is a gap what is wider than this share of the smaller object: a teapot on a large table has no
/// more of them.
pub(crate) const NEAR_SMALLER: f64 = 1e-2;

/// Nor do borders nearly meet that are farther apart than this share of the shorter one's
/// length: at a corner of a small surface all of its borders are near one another.
pub(crate) const NEAR_LENGTH: f64 = 0.05;

/// The share of a border's length that must be near the other for the two to run side by
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
    /// Borders in all, with all trim edges: four a surface, two at each knot where it may jump, but for those that
    /// trims have cut off or run along.
    pub(crate) borders: usize,
    /// Of these, trim edges, counted from corner to corner.
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
    let edges = Edges::of(surfaces, &charts);
    let mut meeting = BTreeSet::new();
    let mut beside = BTreeSet::new();
    let mut gaps = Vec::new();
    for (pair, Beside { met, open }) in Neighbours::of(&edges, sizes).side_by_side() {
        let two = pair.map(|k| edges.curves[k].0);
        let [a, b] = two.map(|edge| drawings.get(edge.surface).copied().flatten());
        if met {
            meeting.extend(pair);
        } else if let Some((width, at)) = open.filter(|_| a.is_none() || a != b) {
            beside.extend(pair);
            gaps.push(Gap { edges: two, width, at });
        }
    }
    gaps.sort_by(|a, b| b.width.total_cmp(&a.width)); // stable: equal ones keep their order
    let nearly = beside.difference(&meeting).count();
    let Edges { curves, collapsed, trim_edges, left_out, .. } = edges;
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
    /// How far a point of each surface may be off.
    rounding: Vec<f64>,
}

impl<'a> Edges<'a> {
    /// Those of surfaces with these charts.
    fn of(surfaces: &[Surface], charts: &'a [Vec<Chart<'a>>]) -> Self {
        let mut borders: Vec<(Edge, Border)> = Vec::new();
        for (surface, charts) in charts.iter().enumerate() {
            for (index, chart) in charts.iter().enumerate() {
                let all = Border::of(chart).chain(Border::inner(chart));
                borders.extend(all.map(|border| {
                    (Edge { surface, chart: index, which: Which::Border(border) }, border)
                }));
            }
        }
        let chart = |edge: &Edge| &charts[edge.surface][edge.chart];
        let (poles, extended): (Vec<_>, Vec<_>) = borders
            .into_iter()
            .partition(|(edge, border)| border.pole(&chart(edge).surface).is_some());
        let collapsed = poles.iter().filter(|(edge, border)| border.is_kept(chart(edge))).count();
        let curve = |&(edge, border): &(Edge, Border)| {
            Some((edge, BorderCurve::new(chart(&edge), border)?))
        };
        let mut curves: Vec<_> = extended.par_iter().filter_map(curve).collect();
        let extended = curves.len();
        let mut left_out = Vec::new();
        for (surface, one) in surfaces.iter().enumerate() {
            match one.trimmed().map(TrimmedSurface::edge_curves).unwrap_or(Ok(Vec::new())) {
                Ok(edges) => {
                    let parts = edges.into_iter().flat_map(BorderCurve::of_edge).enumerate();
                    curves.extend(parts.map(|(number, curve)| {
                        (Edge { surface, chart: 0, which: Which::Trim(number) }, curve)
                    }));
                }
                Err(error) => left_out.push((surface, error)),
            }
        }
        let trim_edges = curves.len() - extended;
        let largest = |charts: &Vec<Chart<'_>>| {
            charts.iter().map(|chart| rounding(&chart.surface)).fold(0.0, f64::max)
        };
        let rounding = charts.iter().map(largest).collect();
        Self { curves, collapsed, trim_edges, left_out, rounding }
    }

    /// How far points of two curves may be apart that meet.
    fn rounding(&self, pair: [usize; 2]) -> f64 {
        pair.iter().map(|&k| self.rounding[self.curves[k].0.surface]).sum()
    }
}

/// Borders and trim edges that come near each other.
struct Neighbours<'e> {
    edges: &'e Edges<'e>,
    /// The pairs of them whose boxes are near.
    pairs: Vec<[usize; 2]>,
    /// The sizes of the objects that surfaces belong to.
    sizes: &'e [f64],
}

impl<'e> Neighbours<'e> {
    fn of(edges: &'e Edges<'e>, sizes: &'e [f64]) -> Self {
        let largest = sizes.iter().fold(0.0, |a: f64, &b| a.max(b));
        // That of the larger object is grown by at least as much as the two may be apart.
        let grown = |(edge, curve): &(Edge, BorderCurve<'_>)| {
            curve.bounds().grown(near([sizes[edge.surface], largest]))
        };
        let boxes: Vec<Aabb> = edges.curves.iter().map(grown).collect();
        Self { edges, pairs: overlapping(&boxes), sizes }
    }

    /// How far points of one curve are from another one, each with its number; of those that are near and where the
    /// surface ends.
    fn distances(&self, [from, to]: [usize; 2]) -> Vec<(usize, f64)> {
        let [(a, from), (b, to)] = [&self.edges.curves[from], &self.edges.curves[to]];
        let near = near([self.sizes[a.surface], self.sizes[b.surface]])
            .min(NEAR_LENGTH * from.length().min(to.length()));
        let distance = |(k, sample): (usize, &Sample)| Some((k, to.distance(sample.point, near)?));
        from.samples().iter().enumerate().filter(|(_, s)| s.kept).filter_map(distance).collect()
    }

    /// For each curve the points where another one meets it: there is no way through.
    fn joints(&self) -> Vec<Vec<bool>> {
        let meeting = |&[i, j]: &[usize; 2]| {
            let met = self.edges.rounding([i, j]);
            [[i, j], [j, i]].map(|pair| {
                let mut distances = self.distances(pair);
                distances.retain(|&(_, distance)| distance <= met);
                (pair[0], distances)
            })
        };
        let met: Vec<_> = self.pairs.par_iter().map(meeting).collect();
        let curves = self.edges.curves.iter();
        let mut joints: Vec<Vec<bool>> =
            curves.map(|(_, curve)| vec![false; curve.samples().len()]).collect();
        for (curve, distances) in met.into_iter().flatten() {
            for (k, _) in distances {
                joints[curve][k] = true;
            }
        }
        joints
    }

    /// The pairs that run side by side, and how.
    fn side_by_side(&self) -> Vec<([usize; 2], Beside)> {
        let joints = self.joints();
        let beside = |&pair: &[usize; 2]| Some((pair, self.beside(pair, &joints)?));
        self.pairs.par_iter().filter_map(beside).collect()
    }

    fn beside(&self, [i, j]: [usize; 2], joints: &[Vec<bool>]) -> Option<Beside> {
        // One may run along a part of the other only: then not all points of the longer are near.
        let ways = [[i, j], [j, i]].map(|pair| {
            let samples = self.edges.curves[pair[0]].1.samples();
            let distances = self.distances(pair);
            let near: f64 = distances.iter().map(|&(k, _)| samples[k].length).sum();
            let all: f64 = samples.iter().filter(|s| s.kept).map(|s| s.length).sum();
            (near >= SIDE_BY_SIDE * all).then(|| {
                let point = |&(k, distance): &(usize, f64)| (distance, samples[k].point);
                let open = distances.iter().filter(|(k, _)| !joints[pair[0]][*k]);
                let widest = |x: &(f64, DVec3), y: &(f64, DVec3)| x.0.total_cmp(&y.0);
                let all = distances.iter().map(point).max_by(widest);
                (all, open.map(point).max_by(widest))
            })
        });
        let wider = |x: (f64, DVec3), y: (f64, DVec3)| if y.0 >= x.0 { y } else { x };
        let ways = ways.into_iter().flatten();
        let (all, open): (Vec<_>, Vec<_>) = ways.unzip();
        let (width, _) = all.into_iter().flatten().reduce(wider)?;
        let met = width <= self.edges.rounding([i, j]);
        Some(Beside { met, open: open.into_iter().flatten().reduce(wider) })
    }
}

/// How far objects of these sizes may be apart and nearly meet.
fn near([a, b]: [f64; 2]) -> f64 {
    (NEAR * a.max(b)).min(NEAR_SMALLER * a.min(b))
}

/// Two borders that run side by side.
struct Beside {
    /// Whether they meet, to within rounding, all the way.
    met: bool,
    /// The largest distance between them where nothing else meets either, and where that is.
    open: Option<(f64, DVec3)>,
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
    use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
    use nurbray::geometry::{KnotVector, NurbsSurface, shapes};

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

    /// A patch of degree 1 between lines from `y` = 0 to 1, with these inner knots in v.
    fn uneven(lines: &[[DVec3; 2]], inner: &[f64]) -> NurbsSurface {
        let vs = [&[0.0], inner, &[1.0]].concat();
        let us: Vec<f64> = (0..lines.len()).map(|k| (k / 2 + k % 2) as f64).collect();
        let knots = |values: &[f64]| {
            let ends = [&values[..1], values, &values[values.len() - 1..]].concat();
            KnotVector::new(1, ends).unwrap()
        };
        let points = lines.iter().flat_map(|&[from, to]| vs.iter().map(move |&v| from.lerp(to, v)));
        NurbsSurface::new(knots(&us), knots(&vs), points.collect(), None).unwrap()
    }

    fn sheet(x: [f64; 2], inner: &[f64]) -> NurbsSurface {
        uneven(&x.map(|x| [DVec3::new(x, 0.0, 0.0), DVec3::new(x, 1.0, 0.0)]), inner)
    }

    /// Parameters say nothing of lengths.
    #[test]
    fn knots_may_be_uneven() {
        let early = [0.002, 0.004, 0.006, 0.008];
        let late = [0.992, 0.994, 0.996, 0.998];
        let torn = fit(&[sheet([0.0, 1.0], &early), sheet([1.0 + 1e-4, 2.0], &late)], 2.0);
        assert_eq!((torn.nearly, torn.free, torn.gaps.len()), (2, 6, 1));
        assert!((torn.gaps[0].width - 1e-4).abs() < 1e-14, "{}", torn.gaps[0].width);
        // Borders that meet at a corner are not beside each other, however many knots are there.
        let tiny: Vec<f64> = (1..40).map(|k| 1e-5 * f64::from(k)).collect();
        for inner in [&[1e-4][..], &[1.0 - 1e-4], &early, &tiny] {
            let whole = fit(&[sheet([0.0, 1.0], inner)], 2.0);
            assert_eq!((whole.free, whole.gaps.len()), (4, 0), "{inner:?}");
        }
    }

    #[test]
    fn what_is_closed_by_another_border_is_no_gap() {
        let corner = |k: usize| {
            let on = |bit: usize| f64::from(u8::from(k & bit != 0));
            DVec3::new(on(1), on(2), 5e-4 * on(4))
        };
        let faces =
            [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 4, 5], [2, 3, 6, 7], [0, 2, 4, 6], [1, 3, 5, 7]];
        let faces = faces
            .map(|[a, b, c, d]| uneven(&[[corner(a), corner(b)], [corner(c), corner(d)]], &[]));
        let closed = fit(&faces, 1.5);
        assert_eq!((closed.meeting, closed.free, closed.gaps.len()), (24, 0, 0));
        // Without a narrow side there is one.
        let open = fit(&faces[..5], 1.5);
        assert_eq!((open.nearly, open.free, open.gaps.len()), (2, 2, 1), "{:?}", open.gaps);
        assert!((open.gaps[0].width - 5e-4).abs() < 1e-14, "{}", open.gaps[0].width);
    }

    #[test]
    fn surfaces_may_be_torn_at_a_knot() {
        let line = |x: f64| [DVec3::new(x, 0.0, 0.0), DVec3::new(x, 1.0, 0.0)];
        for (apart, (meeting, nearly)) in [(0.0, (2, 0)), (1e-4, (0, 2))] {
            let torn = uneven(&[line(0.0), line(1.0), line(1.0 + apart), line(2.0)], &[]);
            let torn = fit(&[torn], 2.0);
            assert_eq!((torn.borders, torn.meeting, torn.nearly), (6, meeting, nearly), "{apart}");
            assert_eq!((torn.free, torn.gaps.len()), (4, nearly / 2), "{apart}");
            for gap in &torn.gaps {
                assert!((gap.width - apart).abs() < 1e-14, "{}", gap.width);
                let names = gap.edges.map(|edge| edge.which.to_string());
                assert_eq!(names, ["just before u = 1", "u = 1"]);
            }
        }
    }

    /// A border is no other edge than the trim edge along it.
    #[test]
    fn trims_may_run_along_borders() {
        let square = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].map(DVec2::from);
        let square = TrimLoop::polygon(&square).unwrap();
        let disc = TrimLoop::circle(DVec2::splat(0.5), 0.5).unwrap();
        let plate = |x: f64, one: &TrimLoop| {
            let plane = plane_at(x, 0.0, 0.0);
            let domain = TrimDomain::of(&plane).unwrap();
            let trims = Trims::new(domain, Kept::Odd, std::slice::from_ref(one)).unwrap();
            Surface::from(TrimmedSurface::new(plane, trims).unwrap())
        };
        let counts = |surfaces: &[Surface]| {
            let sizes = vec![2.0; surfaces.len()];
            let Fit { borders, trim_edges, meeting, nearly, free, gaps, .. } =
                super::fit(surfaces, &[], &sizes);
            ([borders, trim_edges, meeting, nearly, free], gaps.len())
        };
        assert_eq!(counts(&[plate(0.0, &square)]), ([4, 4, 0, 0, 4], 0));
        assert_eq!(counts(&[plate(0.0, &disc)]), ([1, 1, 0, 0, 1], 0));
        let two = |apart: f64| [plate(0.0, &square), plate(1.0 + apart, &square)];
        assert_eq!(counts(&two(0.0)), ([8, 8, 2, 0, 6], 0));
        assert_eq!(counts(&two(1e-4)), ([8, 8, 0, 2, 6], 1));
        // Half of a plate: three borders are left in part, and a new edge.
        let half = TrimLoop::rectangle(UvBox::new([0.0, 0.5], [-0.5, 1.5])).unwrap();
        let ([borders, trim_edges, ..], _) = counts(&[plate(0.0, &half)]);
        assert_eq!((borders, trim_edges), (4, 2), "one along u = 0");
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
