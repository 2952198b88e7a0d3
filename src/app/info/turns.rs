//! Borders that run together although their surfaces are turned opposite ways: there, a ray that
//! enters a closed model through one surface and one that enters through the other have different
//! signs of N·d, and crossings are counted wrong.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use super::around::Turn;
use super::edges::{Edge, Edges};
use super::nearest::{Crowd, Neighbour};

/// Samples no farther apart than so many distances at which curves run together say nothing about
/// where a curve runs.
const APART: f64 = 16.0;

/// Two borders that run together, of surfaces turned opposite ways.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Turned {
    /// The borders, in the order of the surfaces.
    pub(crate) edges: [Edge; 2],
    /// A point where they do.
    pub(crate) at: DVec3,
}

/// How the surfaces are turned where two borders, and no more, run together: where they meet, or
/// nearly (see [`Crowd::only_beside`]).
#[derive(Clone, Debug, Default)]
pub(crate) struct Turns {
    /// In how many pairs of borders this can be told.
    pub(crate) judged: usize,
    /// Those of them whose surfaces are turned opposite ways.
    pub(crate) opposite: Vec<Turned>,
}

/// What the places tell at which two curves run together.
#[derive(Default)]
struct Votes {
    alike: usize,
    /// The places where the surfaces are turned opposite ways.
    opposite: Vec<DVec3>,
}

impl Turns {
    /// Judges the pairs of borders and trim edges that count and that run together along a stretch
    /// on which no third one does. Where three or more surfaces meet, no two of them belong together
    /// more than others.
    pub(super) fn of(crowd: &Crowd<'_>, counts: impl Fn([Edge; 2]) -> bool) -> Self {
        let curves = &crowd.edges.curves;
        let all = (0..curves.len()).into_par_iter();
        let seen: Vec<_> = all.map(|curve| turns(crowd, curve)).collect();
        let mut votes: BTreeMap<[usize; 2], Votes> = BTreeMap::new();
        for (curve, turns) in seen.into_iter().enumerate() {
            for (other, turn, at) in turns {
                let votes = votes.entry([curve.min(other), curve.max(other)]).or_default();
                match turn {
                    Turn::Alike => votes.alike += 1,
                    Turn::Opposite => votes.opposite.push(at),
                }
            }
        }

        let mut turns = Self::default();
        for (pair, Votes { alike, opposite }) in votes {
            let edges = pair.map(|k| curves[k].0);
            if !counts(edges) {
                continue;
            }
            turns.judged += 1;
            if opposite.len() > alike {
                // Half of the places, mostly, are samples of the second curve.
                turns.opposite.push(Turned { edges, at: opposite[opposite.len() / 4] });
            }
        }
        turns
    }
}

/// The curves that run together with a curve from one sample to the next, or as many as are needed
/// to tell, each time alone: which, how the surfaces are turned, and where.
fn turns(crowd: &Crowd<'_>, curve: usize) -> Vec<(usize, Turn, DVec3)> {
    let Edges { curves, .. } = crowd.edges;
    let own = &curves[curve].1;
    let samples = own.samples();
    let met: Vec<_> = (0..samples.len()).map(|k| crowd.only_beside([curve, k])).collect();
    let judged = |k: usize| {
        let Neighbour { curve: other, foot, near } = met[k]?;
        // Shorter stretches may be where they only cross or touch.
        let is_far = |next: &usize| samples[k].point.distance(samples[*next].point) > APART * near;
        let next = (k + 1..samples.len()).find(is_far)?;
        let together = |beside: &Option<Neighbour>| beside.is_some_and(|it| it.curve == other);
        if !met[k + 1..=next].iter().all(together) {
            return None;
        }
        let turn = own.around(samples[k].t)?.turn(&curves[other].1.around(foot.t)?)?;
        Some((other, turn, foot.point))
    };
    (0..samples.len()).filter_map(judged).collect()
}
