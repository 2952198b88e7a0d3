//! Traces one ray through the boxes: the nearest certain hit, and the leaves that are left
//! undecided.
//!
//! # Why it is right
//! - No box is entered too late or left too early: the planes of axis-parallel boxes are moved
//!   outwards by more than the rounding errors, and oriented boxes were grown when they were made.
//!   So every leaf that is met before the nearest hit is searched, in whatever order, and the
//!   nearest of the hits counts: the answer does not depend on the tree.
//! - In small parts of the scene the same holds in other coordinates (see
//!   [`regions`](crate::intersect::tree::regions)), to which the ray is converted anew from f64. A
//!   ray that passes far beside such a part has inaccurate coordinates there, but nothing to meet.
//! - A leaf is left as missed where the certificate, or the ray's own proof, leaves at most one
//!   root in the widened leaf or a part of it, and Newton's iteration on the true surface finds
//!   that root outside the leaf, beyond a side of the piece by more than any error, outside the
//!   ray's range, or to be the one the ray starts on; where the proof leaves no root; or where the
//!   ray leaves the leaf and cannot come back (`departure`).
//! - A hit is a root on the true surface, clear of the ends of the ray and of its start.
//! - Everything else is listed in [`SingleWork::undecided`] for the scalar search, which handles
//!   borders, poles, tangency and the ends of rays.

use fearless_simd::{Simd, SimdBase, f32x4};
use fearless_simd_macros::simd;

use super::finish::{Outcome, Search, finish};
use super::ray::{Guess, SingleHit, SingleRay};
use crate::intersect::Statistics;
use crate::intersect::tree::nodes::Child;
use crate::intersect::wide::box_ray::{BOX_SPARE, Passages, Stack, first_entered};
use crate::intersect::wide::nearest::{Fate, is_cut_off, keep};
use crate::intersect::wide::proof::one_ray::isolate;
use crate::intersect::wide::reach::WIDENED;
use crate::intersect::wide::search::one_ray::Distances;
use crate::intersect::wide::start::Line;
use crate::intersect::wide::surface::spline_net::RecentNets;
use crate::intersect::wide::surface::sums::OneNet;
use crate::intersect::wide::view::{BvhView, Fitted};
use crate::math::RayFrame;
use crate::math::bits::set_bits;
use crate::patch::{Leaf, Piece};

/// Scratch memory and results of tracing one ray.
#[derive(Debug, Default)]
pub(crate) struct SingleWork {
    stack: Stack,
    /// Whether there is a hit.
    met: bool,
    /// Two places for hits, so that none is copied, and which of them holds the nearest certified
    /// hit; in any-hit searches, the first one found.
    hits: [SingleHit; 2],
    best: usize,
    /// All certified hits, if all are asked for.
    pub all: Vec<SingleHit>,
    /// Leaves that the scalar search must examine.
    pub undecided: Vec<u32>,
    pub statistics: Statistics,
    nets: RecentNets,
}

/// Finds a ray's nearest certified hit, or any hit if that is all it asks for; `work.undecided`
/// lists the leaves that could not be certified or decided, which may hold nearer hits.
#[simd]
pub(crate) fn trace_single<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    ray: &mut SingleRay<'_>,
    work: &mut SingleWork,
) {
    work.clear();
    let Some(mut next) = view.tree.root() else { return };
    loop {
        match next.child() {
            Child::Node(index) => {
                work.statistics.nodes += 1;
                let node = &view.tree.nodes[index as usize];
                if let Some(nearest) = ray.boxes.enter(simd, node, &mut work.stack) {
                    next = nearest;
                    continue;
                }
            }
            Child::Block(index) => {
                search_block(simd, view, index, ray, work);
                if ray.is_done() {
                    return;
                }
            }
            Child::Region(index, way) => {
                let (region, inside) = view.tree.enter(index, way);
                work.stack.extend(inside.map(|code| (f32::NEG_INFINITY, code)));
                ray.change_to(&region.frame, work.hit());
            }
        }
        next = loop {
            match work.stack.pop() {
                None => return,
                Some((entry, child)) if entry <= ray.boxes.far => break child,
                Some(_) => {}
            }
        };
    }
}

/// Searches the leaves of a block, near ones first.
#[simd]
fn search_block<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    index: u32,
    ray: &mut SingleRay<'_>,
    work: &mut SingleWork,
) {
    let block = &view.tree.blocks[index as usize];
    let leaves = view.tree.leaves(index);
    let mut passages = Passages::NONE;
    ray.boxes.pass(simd, block, &mut passages);
    let mut met = leaves.of(passages.met);
    view.prefetch_leaves(leaves.first, met);
    if ray.asks_for_all() {
        for k in set_bits(met) {
            work.statistics.leaf_tests += 1;
            let leaf = leaves.first + k as u32;
            search_leaf(simd, view, leaf, &passages, k, ray, work);
        }
        return;
    }
    while met != 0 {
        let nearest = first_entered(&passages.entry, met);
        met &= !(1 << nearest);
        if passages.entry[nearest] > ray.boxes.far + BOX_SPARE {
            return;
        }
        work.statistics.leaf_tests += 1;
        let leaf = leaves.first + nearest as u32;
        search_leaf(simd, view, leaf, &passages, nearest, ray, work);
        if ray.is_done() {
            return;
        }
    }
}

/// Searches one leaf, the `k`-th of a block, for one ray, whose ways through the block's boxes are
/// in `passages`.
#[simd]
fn search_leaf<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    index: u32,
    passages: &Passages,
    k: usize,
    ray: &mut SingleRay<'_>,
    work: &mut SingleWork,
) {
    let leaf = &view.leaves[index as usize];
    let patch = &view.piece_of(index).patch;
    let error = patch.error_bound(ray.magnitude());
    let guess = Guess::of(leaf, passages.place_of(k), passages.slopes_of(k), error);
    // Of all hits, the scalar search also finds those that rounding leaves open.
    if ray.asks_for_all() && guess.is_none() {
        return work.undecided.push(index);
    }
    let fitted = view.fitted(index, patch);
    let line = Line { origin: &ray.frame.origin, axis: &ray.boxes.axis };
    if !ray.start.is_done_with(simd, fitted, patch, line, guess.is_some(), error) {
        search_ahead(simd, view, (index, fitted), guess, error, ray, work);
    }
}

/// Searches one leaf for one ray that does not start on its one root there: from a start in box
/// coordinates, if the leaf is certified for the ray; `error` is the error bound of a point's
/// distance from the ray.
#[inline(always)]
pub(crate) fn search_ahead<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    (index, fitted): (u32, Fitted<'_>),
    guess: Option<Guess>,
    error: f64,
    ray: &mut SingleRay<'_>,
    work: &mut SingleWork,
) {
    let leaf = fitted.leaf;
    let piece = view.piece_of(index);
    if guess.is_none() && passes_near_pole(leaf, piece, ray.frame) {
        return work.undecided.push(index);
    }
    let patch = &piece.patch;
    // Most rays will need the net; made now, it is ready when the search in f32 is.
    let mut nets = std::mem::take(&mut work.nets);
    let surface = OneNet { patch, net: nets.net_of(simd, leaf.piece, patch) };
    let leaf = NetLeaf { index, fitted, surface: &surface };
    search_net(simd, view, &leaf, guess, error, ray, work);
    work.nets = nets;
}

/// How near a pole a ray must pass, as a part of the leaf's longer half side, for the proof to be
/// given up before it is tried: it would halve the leaf many times, and then as a rule in vain.
const NEAR_POLE: f64 = 1.0 / 8.0;

#[inline(always)]
fn passes_near_pole(leaf: &Leaf, piece: &Piece, ray: &RayFrame) -> bool {
    leaf.pole(piece).is_some_and(|pole| {
        let [x, y] = leaf.half_side_lengths().map(f64::from);
        ray.distance(pole) < NEAR_POLE * x.max(y)
    })
}

/// A leaf with the net for sums.
struct NetLeaf<'a> {
    index: u32,
    fitted: Fitted<'a>,
    surface: &'a OneNet<'a>,
}

/// [`search_ahead`] with the net for sums.
#[inline(always)]
fn search_net<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    leaf: &NetLeaf<'_>,
    guess: Option<Guess>,
    error: f64,
    ray: &mut SingleRay<'_>,
    work: &mut SingleWork,
) {
    let &NetLeaf { index, fitted, surface } = leaf;
    if let Some(Guess { start, clearance }) = guess {
        let start = place_in_lanes(simd, start);
        let near = if fitted.leaf.is_parallelogram() {
            start
        } else {
            Distances::new(simd, fitted, ray.frame).newton(simd, start)
        };
        let near = [near[0], near[1]];
        // As a rule, a start outside leads to a root outside, which the proof shows sooner.
        if near[0].abs().max(near[1].abs()) <= WIDENED as f32 {
            let wanted = Search { near, domain: [[-WIDENED, WIDENED]; 2], error, clearance };
            let (outcome, steps) = finish(simd, fitted, surface, ray, &wanted, work.other());
            work.statistics.newton_iterations += steps;
            match outcome {
                Outcome::Missed => return,
                Outcome::Hit => return work.take(index, ray, view),
                Outcome::AtEnd if work.has_cut_off(index, view) => return,
                Outcome::AtEnd | Outcome::Undecided => return work.undecided.push(index),
                Outcome::NotFound => {}
            }
        }
    }
    // Too flat an angle, a leaf with a pole, a start outside, or no convergence.
    search_by_proof(simd, view, leaf, error, ray, work);
}

/// Searches one leaf by the ray's own proof of how many roots it has there.
#[simd] // a function of its own: it needs far more room than the usual way
fn search_by_proof<S: Simd>(
    simd: S,
    view: &BvhView<'_>,
    &NetLeaf { index, fitted, surface }: &NetLeaf<'_>,
    error: f64,
    ray: &mut SingleRay<'_>,
    work: &mut SingleWork,
) {
    let distances = Distances::new(simd, fitted, ray.frame);
    let start = ray.start.place_in(fitted.leaf);
    let Some(parts) = isolate(simd, distances, fitted, ray.frame, start, error) else {
        work.undecided.push(index);
        return;
    };
    for part in parts.iter() {
        let near = distances.newton(simd, place_in_lanes(simd, part.middle));
        let near = [near[0], near[1]];
        let domain = part.domain().map(|range| range.map(f64::from));
        let wanted = Search { near, domain, error, clearance: f64::INFINITY };
        let (outcome, steps) = finish(simd, fitted, surface, ray, &wanted, work.other());
        work.statistics.newton_iterations += steps;
        match outcome {
            Outcome::Missed => {}
            Outcome::Hit => work.take(index, ray, view),
            Outcome::AtEnd if work.has_cut_off(index, view) => {}
            Outcome::AtEnd | Outcome::Undecided | Outcome::NotFound => {
                work.undecided.push(index);
                return;
            }
        }
    }
}

#[inline(always)]
fn place_in_lanes<S: Simd>(simd: S, [x, y]: [f32; 2]) -> f32x4<S> {
    f32x4::from_slice(simd, &[x, y, 0.0, 0.0])
}

impl SingleWork {
    /// Forgets what was found, but keeps statistics.
    pub(crate) fn clear(&mut self) {
        self.met = false;
        self.all.clear();
        self.undecided.clear();
        self.stack.clear();
    }

    /// The nearest certified hit; in any-hit searches, the first one found.
    #[inline(always)]
    pub(crate) fn hit(&self) -> Option<&SingleHit> {
        self.met.then_some(&self.hits[self.best])
    }

    /// Where the next hit is put.
    #[inline(always)]
    fn other(&mut self) -> &mut SingleHit {
        &mut self.hits[1 - self.best]
    }

    /// Whether trims cut off the root of a leaf that was put into [`Self::other`].
    #[inline(always)]
    fn has_cut_off(&mut self, leaf: u32, view: &BvhView<'_>) -> bool {
        self.other().place.leaf = leaf;
        is_cut_off(&self.other().place, view)
    }

    /// Takes the hit of a leaf that was put into [`Self::other`].
    #[inline(always)]
    fn take(&mut self, leaf: u32, ray: &mut SingleRay<'_>, view: &BvhView<'_>) {
        self.other().place.leaf = leaf;
        let found = &self.hits[1 - self.best];
        match keep(&found.place, view, self.hit().map(|hit| &hit.place)) {
            Fate::Nearer if ray.asks_for_all() => self.all.push(*found),
            Fate::Nearer => {
                ray.shorten(found.place.z);
                self.met = true;
                self.best = 1 - self.best;
            }
            Fate::Dropped => {}
            Fate::Undecided => self.undecided.push(leaf),
        }
    }
}
