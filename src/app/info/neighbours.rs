//! Borders and trim edges that come near each other, and whether they meet.

use glam::DVec3;
use rayon::prelude::*;

use super::border_curve::BorderCurve;
use super::edges::Edges;
use super::nearest::{Crowd, View};

/// The share of a border's length that must be near the other for the two to run side by
/// side. Two borders that meet at a corner of more than 12° have a smaller share: 0.05 / sin 12°.
pub(crate) const SIDE_BY_SIDE: f64 = 0.25;

/// Two borders or trim edges that come near each other.
struct Neighbours {
    /// Which two.
    pair: [usize; 2],
    /// For each, the numbers of its samples and their distances from the other curve: only of
    /// samples that are near it and where the surface ends.
    distances: [Vec<(usize, f64)>; 2],
    /// How far apart rounding may put points that meet.
    rounding: f64,
}

impl Neighbours {
    /// All pairs that lie beside each other with none between.
    fn all(crowd: &Crowd<'_>) -> Vec<Self> {
        let (edges, views) = (crowd.edges, crowd.views());
        let seen = |(curve, view): (usize, &View)| -> Vec<[usize; 2]> {
            view.others.iter().map(|&other| [curve.min(other), curve.max(other)]).collect()
        };
        let mut pairs: Vec<[usize; 2]> = views.iter().enumerate().flat_map(seen).collect();
        pairs.sort_unstable();
        pairs.dedup();
        let looked_at = |&pair: &[usize; 2]| {
            let [a, b] = pair;
            let near = crowd.nearness.of(pair);
            let distances = [[a, b], [b, a]].map(|two| distances(edges, two, near, &views[two[0]]));
            let apart = distances.iter().all(Vec::is_empty);
            (!apart).then(|| Self { pair, distances, rounding: edges.rounding(pair) })
        };
        pairs.par_iter().filter_map(looked_at).collect()
    }

    /// The samples of one of the two along which the other one meets it. A single sample does not
    /// count: at a corner, borders meet that go different ways.
    fn joints(&self, which: usize) -> Vec<usize> {
        let met = self.distances[which].iter().filter(|(_, distance)| *distance <= self.rounding);
        let met: Vec<usize> = met.map(|&(k, _)| k).collect();
        met.windows(2).filter(|pair| pair[0] + 1 == pair[1]).flatten().copied().collect()
    }

    /// How the two run side by side: whether they meet, and how far they lie open; `None` if they
    /// do not run side by side.
    fn beside(&self, edges: &Edges<'_>, joints: &[Vec<bool>]) -> Option<Beside> {
        let (mut all, mut open): (Option<Widest>, Option<Widest>) = (None, None);
        // One may run along only a part of the other: then not all points of the longer one are
        // near.
        for (curve, distances) in self.pair.into_iter().zip(&self.distances) {
            let samples = edges.curves[curve].1.samples();
            let near: f64 = distances.iter().map(|&(k, _)| samples[k].length).sum();
            if near < SIDE_BY_SIDE * edges.curves[curve].1.kept_polyline_length() {
                continue;
            }
            for &(k, distance) in distances {
                let here = Widest { distance, at: samples[k].point };
                all = here.or_wider(all);
                if !joints[curve][k] {
                    open = here.or_wider(open);
                }
            }
        }
        Some(Beside { met: all?.distance <= self.rounding, open })
    }
}

/// The pairs that run side by side, and how.
pub(super) fn side_by_side(crowd: &Crowd<'_>) -> Vec<([usize; 2], Beside)> {
    let (edges, neighbours) = (crowd.edges, Neighbours::all(crowd));
    // For each curve, the samples where another one meets it: rays cannot pass there.
    let mut joints: Vec<Vec<bool>> =
        edges.curves.iter().map(|(_, curve)| vec![false; curve.samples().len()]).collect();
    for two in &neighbours {
        for (which, curve) in two.pair.into_iter().enumerate() {
            two.joints(which).into_iter().for_each(|k| joints[curve][k] = true);
        }
    }
    let beside = |two: &Neighbours| Some((two.pair, two.beside(edges, &joints)?));
    neighbours.iter().filter_map(beside).collect()
}

/// The distances of a curve's samples from another curve, with the samples' numbers: only of
/// samples within `near` and where the surface ends. Some are known from the curve's view.
fn distances(
    edges: &Edges<'_>,
    [from, to]: [usize; 2],
    near: f64,
    view: &View,
) -> Vec<(usize, f64)> {
    let [curve, other] = [from, to].map(|k| &edges.curves[k].1);
    let is_one = edges.curves[from].0.surface == edges.curves[to].0.surface;
    let rounding = edges.rounding([from, to]);
    let distance = |k: usize| {
        let sample = &curve.samples()[k];
        let distance = match view.known(to, k) {
            Some(known) => known?,
            None if !sample.kept => return None,
            None => other.nearest(sample.point, near)?.distance,
        };
        // Across a narrow part of a surface there is another edge of it, but no gap.
        let is_across = is_one && distance > rounding && leads_inside(curve, k, other, near);
        (!is_across).then_some((k, distance))
    };
    curve.samples_beside(other, near).into_iter().filter_map(distance).collect()
}

/// Whether the way from a sample of a curve to the nearest point of another one leads into the
/// curve's surface.
fn leads_inside(curve: &BorderCurve<'_>, k: usize, other: &BorderCurve<'_>, near: f64) -> bool {
    let sample = &curve.samples()[k];
    let foot = other.nearest(sample.point, near);
    let around = curve.around(sample.t);
    foot.zip(around).is_some_and(|(foot, around)| around.is_inward(foot.point - sample.point))
}

/// How far two borders are apart, and where.
#[derive(Clone, Copy, Debug)]
pub(super) struct Widest {
    pub(super) distance: f64,
    pub(super) at: DVec3,
}

impl Widest {
    /// This, unless the other is wider.
    fn or_wider(self, other: Option<Self>) -> Option<Self> {
        other.filter(|other| other.distance > self.distance).or(Some(self))
    }
}

/// Two borders that run side by side.
pub(super) struct Beside {
    /// Whether they meet, to within rounding, all the way.
    pub(super) met: bool,
    /// The largest distance from one to the other, over points where nothing meets the first.
    pub(super) open: Option<Widest>,
}
