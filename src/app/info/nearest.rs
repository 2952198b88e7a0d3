//! Which borders lie beside each other with no others between them: only these are compared.
//!
//! From each sample of a curve, the others are looked for in the order of their distances. Where
//! one meets the curve, nothing else matters: no ray passes there. Elsewhere the [`KEPT`] nearest
//! are taken and, of the rest, those that are not hidden: one is hidden if its nearest point is
//! nearer to that of another, taken before, than to the sample. (Where nothing meets, this leaves
//! the relative neighbourhood graph, Toussaint 1980, whose edges at least connect all that are
//! within a distance of each other.) In the plane across the curves no more than six can hide
//! nothing of each other. So a stack of n plates costs n log n, and not n². Where the boxes of many
//! curves overlap, as in a stack askew, each curve looks at all others from three samples only.

use std::cmp::Ordering;
use std::collections::{BTreeSet, BinaryHeap};

use glam::DVec3;
use nurbray::math::Aabb;
use rayon::prelude::*;

use super::border_curve::Foot;
use super::edges::Edges;
use super::nearness::Nearness;

/// How many curves near a place are compared even if one hides another: more than the two or three
/// faces that meet along one edge of a proper model.
pub(super) const KEPT: usize = 4;

/// How many hidden curves are looked at from a sample that is not one of three: the curves seen
/// from those three, and from samples between, come first, and mostly hide all the rest.
const HIDDEN: usize = 16;

/// Curves run together if they are no farther apart than this part of the distance at which they
/// nearly meet.
const TOGETHER: f64 = 0.01;

/// A curve that runs together with another one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Neighbour {
    pub(super) curve: usize,
    /// The point of it that is nearest to the other's sample.
    pub(super) foot: Foot,
    /// How near that had to be.
    pub(super) near: f64,
}

/// The curves that are near a sample of another one.
#[derive(Clone, Copy, Debug)]
enum Within {
    Nobody,
    One(Neighbour),
    Several,
}

/// What was seen from the samples of a curve.
#[derive(Debug, Default)]
pub(super) struct View {
    /// The other curves to compare it with.
    pub(super) others: BTreeSet<usize>,
    /// Distances found on the way: other curve, sample, and the distance if it is near. Sorted.
    known: Vec<(usize, usize, Option<f64>)>,
}

impl View {
    /// The distance of a sample from another curve, if it was measured: itself `None` if not near.
    pub(super) fn known(&self, other: usize, sample: usize) -> Option<Option<f64>> {
        let found = self.known.binary_search_by_key(&(other, sample), |it| (it.0, it.1));
        Some(self.known[found.ok()?].2)
    }
}

/// All curves in a hierarchy of boxes.
pub(super) struct Crowd<'a> {
    pub(super) edges: &'a Edges<'a>,
    pub(super) nearness: &'a Nearness<'a>,
    nodes: Vec<Node>,
}

/// A box around parts of curves.
#[derive(Clone, Copy, Debug)]
struct Node {
    bounds: Aabb,
    /// How near another curve must be to any of them to count, at most.
    reach: f64,
    content: Content,
}

#[derive(Clone, Copy, Debug)]
enum Content {
    /// Two nodes from this one on.
    Nodes(usize),
    /// A few intervals of a curve.
    Curve(usize),
}

impl<'a> Crowd<'a> {
    pub(super) fn new(edges: &'a Edges<'a>, nearness: &'a Nearness<'a>) -> Self {
        let part = |(curve, reach): (usize, f64), bounds: &Aabb| Node {
            bounds: *bounds,
            reach,
            content: Content::Curve(curve),
        };
        let parts = (0..edges.curves.len()).flat_map(|curve| {
            let reach = nearness.reach(curve);
            edges.curves[curve].1.boxes().iter().map(move |bounds| part((curve, reach), bounds))
        });
        let mut parts: Vec<Node> = parts.collect();
        let mut nodes = Vec::with_capacity(2 * parts.len());
        if !parts.is_empty() {
            nodes.push(around(&parts));
            divide(0, &mut parts, &mut nodes);
        }
        Self { edges, nearness, nodes }
    }

    /// What each curve sees.
    pub(super) fn views(&self) -> Vec<View> {
        (0..self.edges.curves.len()).into_par_iter().map(|curve| self.view(curve)).collect()
    }

    /// How near two curves must be to run together: within rounding, or so much nearer than those
    /// that nearly meet that hardly anything else can be meant. (Edges of CAD files, each computed
    /// from its own face, mostly agree to a millionth of the model or better.)
    fn together(&self, pair: [usize; 2]) -> f64 {
        self.edges.rounding(pair).max(TOGETHER * self.nearness.of(pair))
    }

    /// The other curve that runs together with a curve at one of its samples, and where; `None` if
    /// none does, or several do. If one meets it within rounding, those that only nearly do are not
    /// asked.
    pub(super) fn only_beside(&self, at: [usize; 2]) -> Option<Neighbour> {
        let reach = self.edges.most_rounding();
        match self.within(at, reach, |pair| self.edges.rounding(pair)) {
            Within::One(neighbour) => return Some(neighbour),
            Within::Several => return None,
            Within::Nobody => {}
        }
        let reach = TOGETHER * self.nearness.reach(at[0]);
        match self.within(at, reach, |pair| self.together(pair)) {
            Within::One(neighbour) => Some(neighbour),
            Within::Several | Within::Nobody => None,
        }
    }

    /// The other curves that are as near to a sample of a curve as `near` says for each, and no
    /// farther than `reach`.
    fn within(
        &self,
        [curve, sample]: [usize; 2],
        reach: f64,
        near: impl Fn([usize; 2]) -> f64,
    ) -> Within {
        let from = &self.edges.curves[curve].1.samples()[sample];
        let mut found = Within::Nobody;
        let mut waiting = if from.kept { vec![0] } else { Vec::new() };
        while let Some(node) = waiting.pop() {
            if self.waiting(node, from.point, reach).is_none() {
                continue;
            }
            let other = match self.nodes[node].content {
                Content::Nodes(first) => {
                    waiting.extend([first, first + 1]);
                    continue;
                }
                Content::Curve(other) => other,
            };
            let is_known = matches!(found, Within::One(known) if known.curve == other);
            if other == curve || is_known {
                continue;
            }
            let near = near([curve, other]);
            let foot = self.edges.curves[other].1.nearest(from.point, near);
            let Some(foot) = foot.filter(|foot| foot.distance <= near) else { continue };
            match found {
                Within::Nobody => found = Within::One(Neighbour { curve: other, foot, near }),
                Within::One(_) | Within::Several => return Within::Several,
            }
        }
        found
    }

    fn view(&self, curve: usize) -> View {
        let mut view = View::default();
        let count = self.edges.curves[curve].1.samples().len();
        // From the middle on: at their ends, borders meet many that go other ways.
        let [quarter, middle] = [count / 4, count / 2];
        let all = (middle..count).chain((0..middle).rev());
        let others = all.filter(|&k| k != middle && k != quarter && k != count - 1 - quarter);
        for sample in [middle, quarter, count - 1 - quarter] {
            self.look([curve, sample], usize::MAX, &mut view);
        }
        for sample in others {
            self.look([curve, sample], HIDDEN, &mut view);
        }
        view.known.retain(|(other, ..)| view.others.contains(other));
        view.known.shrink_to_fit();
        view.known.sort_unstable_by_key(|&(other, sample, _)| (other, sample));
        view
    }

    /// Adds the curves to compare with a curve, as seen from one of its samples. Gives up after
    /// `most` hidden ones.
    fn look(&self, [curve, sample]: [usize; 2], most: usize, view: &mut View) {
        let from = &self.edges.curves[curve].1.samples()[sample];
        if !from.kept {
            return;
        }
        let point = from.point;
        // Those seen from samples before come first: mostly, they go on.
        let mut taken: Vec<DVec3> = Vec::new();
        for &other in &view.others {
            if let Some(foot) = self.measured([curve, sample], other, &mut view.known) {
                if self.meets([curve, other], foot) {
                    return;
                }
                taken.push(foot.point);
            }
        }

        let reach = self.nearness.reach(curve);
        let mut waiting: BinaryHeap<Waiting> = self.waiting(0, point, reach).into_iter().collect();
        let mut hidden = 0;
        let mut asked: BTreeSet<usize> = BTreeSet::new();
        while let Some(Waiting { what, .. }) = waiting.pop() {
            let hides = taken.len() >= KEPT;
            let is_hidden =
                |at: DVec3| hides && taken.iter().any(|by| at.distance(*by) < at.distance(point));
            match what {
                What::Foot(_, at) if is_hidden(at) => {}
                What::Foot(other, at) => {
                    taken.push(at);
                    view.others.insert(other);
                }
                What::Node(node) => {
                    let Node { bounds, content, .. } = self.nodes[node];
                    if hides && taken.iter().any(|by| is_box_hidden(&bounds, *by, point)) {
                        continue;
                    }
                    let other = match content {
                        Content::Curve(other) => other,
                        Content::Nodes(first) => {
                            let parts = [first, first + 1];
                            let parts = parts.map(|part| self.waiting(part, point, reach));
                            waiting.extend(parts.into_iter().flatten());
                            continue;
                        }
                    };
                    if other == curve || view.others.contains(&other) || !asked.insert(other) {
                        continue;
                    }
                    match self.measured([curve, sample], other, &mut view.known) {
                        Some(foot) if self.meets([curve, other], foot) => {
                            view.others.insert(other);
                            return;
                        }
                        Some(foot) if is_hidden(foot.point) => hidden += 1,
                        Some(foot) => waiting.push(Waiting::foot(other, foot)),
                        None => {}
                    }
                    if hidden > most {
                        return;
                    }
                }
            }
        }
    }

    /// A node to look into, unless it is out of reach.
    fn waiting(&self, node: usize, point: DVec3, reach: f64) -> Option<Waiting> {
        let Node { bounds, reach: own, .. } = *self.nodes.get(node)?;
        let distance = point.distance(point.clamp(bounds.min, bounds.max));
        (distance <= reach.min(own)).then_some(Waiting { distance, what: What::Node(node) })
    }

    /// The point of another curve nearest to a sample, if it is near; its distance becomes known.
    fn measured(
        &self,
        [curve, sample]: [usize; 2],
        other: usize,
        known: &mut Vec<(usize, usize, Option<f64>)>,
    ) -> Option<Foot> {
        let point = self.edges.curves[curve].1.samples()[sample].point;
        let foot = self.edges.curves[other].1.nearest(point, self.nearness.of([curve, other]));
        known.push((other, sample, foot.map(|foot| foot.distance)));
        foot
    }

    fn meets(&self, pair: [usize; 2], foot: Foot) -> bool {
        foot.distance <= self.edges.rounding(pair)
    }
}

/// A node around parts, without knowing of them.
fn around(parts: &[Node]) -> Node {
    let join = |a: Node, b: &Node| Node {
        bounds: a.bounds.union(b.bounds),
        reach: a.reach.max(b.reach),
        ..a
    };
    parts[1..].iter().fold(parts[0], join)
}

/// Divides a node around parts at the middle one along the longest side.
fn divide(node: usize, parts: &mut [Node], nodes: &mut Vec<Node>) {
    if parts.len() == 1 {
        return;
    }
    let center = |part: &Node| part.bounds.center();
    let extent = Aabb::around(parts.iter().map(center)).size();
    let axis = (0..3).max_by(|&a, &b| extent[a].total_cmp(&extent[b])).unwrap_or(0);
    let along = |a: &Node, b: &Node| center(a)[axis].total_cmp(&center(b)[axis]);
    parts.select_nth_unstable_by(parts.len() / 2, along);
    let (low, high) = parts.split_at_mut(parts.len() / 2);
    let first = nodes.len();
    nodes.extend([around(low), around(high)]);
    nodes[node].content = Content::Nodes(first);
    divide(first, low, nodes);
    divide(first + 1, high, nodes);
}

/// Whether all of a box is nearer to `by` than to `point`.
fn is_box_hidden(bounds: &Aabb, by: DVec3, point: DVec3) -> bool {
    let across = by - point;
    let least = (bounds.min * across).min(bounds.max * across);
    least.element_sum() > across.dot(0.5 * (by + point))
}

/// Something to look at, and a distance that it is not nearer than.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    distance: f64,
    what: What,
}

#[derive(Clone, Copy, Debug)]
enum What {
    Node(usize),
    /// The point of a curve nearest to the sample.
    Foot(usize, DVec3),
}

impl Waiting {
    fn foot(other: usize, Foot { point, distance, .. }: Foot) -> Self {
        Self { distance, what: What::Foot(other, point) }
    }

    /// Equally near things come in a fixed order, whatever that of the threads.
    fn rank(&self) -> (u8, usize) {
        match self.what {
            What::Node(node) => (0, node),
            What::Foot(curve, _) => (1, curve),
        }
    }
}

/// The nearest is the greatest: it comes out of a heap first.
impl Ord for Waiting {
    fn cmp(&self, other: &Self) -> Ordering {
        other.distance.total_cmp(&self.distance).then(other.rank().cmp(&self.rank()))
    }
}

impl PartialOrd for Waiting {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Waiting {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Waiting {}
