//! Borders and trim edges that come near each other, and whether they meet.

use glam::DVec3;
use nurbray::math::Aabb;
use rayon::prelude::*;

use super::border_curve::{BorderCurve, Sample};
use super::edges::{Edge, Edges};

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

/// Borders and trim edges that come near each other.
pub(super) struct Neighbours<'e> {
    edges: &'e Edges<'e>,
    /// The pairs of them whose boxes are near.
    pairs: Vec<[usize; 2]>,
    /// The sizes of the objects that surfaces belong to.
    sizes: &'e [f64],
}

impl<'e> Neighbours<'e> {
    pub(super) fn of(edges: &'e Edges<'e>, sizes: &'e [f64]) -> Self {
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
    pub(super) fn side_by_side(&self) -> Vec<([usize; 2], Beside)> {
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
pub(super) struct Beside {
    /// Whether they meet, to within rounding, all the way.
    pub(super) met: bool,
    /// The largest distance between them where nothing else meets either, and where that is.
    pub(super) open: Option<(f64, DVec3)>,
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
