//! Many rays in flight that have nothing in common: each goes through the boxes by itself as far as
//! the next leaf; then the leaves of all rays are searched side by side.
//!
//! Boxes, starts and leaves that are not certified are treated as for a single ray (see
//! [its traversal](crate::intersect::wide::single::traverse), also for why nothing is lost). The
//! result for a ray does not depend on the others.

use fearless_simd::{Simd, SimdBase, f32x16, f64x8};
use fearless_simd_macros::simd;

use super::flight::Flight;
use super::pairs::{Pair, PairLanes};
use crate::intersect::query::StartIn;
use crate::intersect::tree::nodes::{Child, ChildCode, LANES, Way};
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::box_ray::{BOX_SPARE, BoxRay, Passages, first_entered, push_met};
use crate::intersect::wide::frames::{EightRays, ScaledSixteen};
use crate::intersect::wide::nearest::is_cut_off;
use crate::intersect::wide::single::ray::{Guess, SingleHit, SingleRay};
use crate::intersect::wide::single::traverse::{SingleWork, search_ahead};
use crate::intersect::wide::start::{Line, Start};
use crate::intersect::wide::surface::form::Form;
use crate::intersect::wide::view::{BvhView, Fitted};
use crate::intersect::{Shot, Statistics};
use crate::math::bits::has;
use crate::math::{Ray, RayFrame};

/// Rays in flight at a time: enough to fill the lanes with pairs, few enough for their data to stay
/// near the processor.
pub(crate) const FLIGHTS: usize = 256;

/// Scratch memory and results of tracing a batch of rays.
#[derive(Debug, Default)]
pub(crate) struct Stream {
    flights: Vec<Flight>,
    /// The rays on their way through the boxes, with what each comes to next, and the rays that
    /// wait for their pairs.
    walking: Vec<(u32, ChildCode)>,
    waiting: Vec<u32>,
    nodes: Visits,
    blocks: Visits,
    regions: Vec<(u32, (u32, Way))>,
    pairs: Vec<Pair>,
    lanes: Box<PairLanes>,
    single: SingleWork,
    /// What is asked for now.
    wanted: Wanted,
    /// Of boxes and pairs.
    statistics: Statistics,
}

impl Stream {
    /// Whether a ray has a hit.
    #[inline(always)]
    pub(crate) fn is_met(&self, k: usize) -> bool {
        self.flights[k].met
    }

    /// The hit of a ray, and the factor that converts distances to its ray parameter.
    #[inline(always)]
    pub(crate) fn hit(&self, k: usize) -> (&SingleHit, f64) {
        let flight = &self.flights[k];
        (&flight.hit, flight.t_from_z)
    }

    /// Counts of the work done so far.
    pub(crate) fn statistics(&self) -> Statistics {
        let mut all = self.statistics;
        all += self.single.statistics;
        all
    }

    /// Whether a ray must be traced by itself, whatever was found for it.
    #[inline(always)]
    pub(crate) fn is_alone(&self, k: usize) -> bool {
        self.flights[k].alone
    }
}

/// Finds the nearest certified hit of each of up to [`FLIGHTS`] rays, or any of each.
#[simd]
pub(crate) fn trace_stream<S: Simd, Q: Shot>(
    simd: S,
    view: &BvhView<'_>,
    shots: &[Q],
    wanted: Wanted,
    stream: &mut Stream,
) {
    stream.wanted = wanted;
    start(simd, view, shots, stream);
    while !stream.waiting.is_empty() {
        stream.pairs.clear();
        walk(simd, view, shots, stream);
        search_pairs(simd, view, shots, stream);
    }
}

/// Boxes that are examined in one go: first all of them are tested, one after the other without a
/// branch, so that the tests overlap; then the results are acted on.
const AT_ONCE: usize = 16;

/// A ray, and the node or block it comes to.
type Visit = (u32, u32);

/// Some of the nodes, or of the blocks, that rays of a batch come to.
#[derive(Debug)]
struct Visits {
    places: [Visit; FLIGHTS],
    count: usize,
}

impl Default for Visits {
    fn default() -> Self {
        Self { places: [(0, 0); FLIGHTS], count: 0 }
    }
}

impl Visits {
    fn clear(&mut self) {
        self.count = 0;
    }

    /// Writes down a visit, and keeps it or not. There are no more visits than flights.
    #[inline(always)]
    fn put(&mut self, visit: Visit, kept: bool) {
        self.places[self.count % FLIGHTS] = visit;
        self.count += usize::from(kept);
    }

    fn all(&self) -> &[Visit] {
        &self.places[..self.count]
    }
}

/// Where a ray enters a node's boxes, and which of them it meets.
#[derive(Clone, Copy, Debug)]
#[repr(align(64))]
struct Entered {
    entry: [f32; LANES],
    met: u32,
}

/// The results for the rays that are examined in one go.
struct Seen {
    entered: [Entered; AT_ONCE],
    passages: [Passages; AT_ONCE],
}

/// Takes all waiting rays on to the next leaves they may meet, which are added as pairs.
#[simd]
fn walk<S: Simd, Q: Shot>(simd: S, view: &BvhView<'_>, shots: &[Q], stream: &mut Stream) {
    let entered = [Entered { entry: [0.0; LANES], met: 0 }; AT_ONCE];
    let mut seen = Seen { entered, passages: [Passages::NONE; AT_ONCE] };
    stream.walking.clear();
    for k in stream.waiting.drain(..) {
        stream.flights[k as usize].go_on(k, &mut stream.walking);
    }
    while !stream.walking.is_empty() {
        stream.nodes.clear();
        stream.blocks.clear();
        for &(k, next) in &stream.walking {
            // Whether it is a node or a block cannot be predicted: so there is no branch for it.
            stream.nodes.put((k, next.index()), next.is_node());
            stream.blocks.put((k, next.index()), next.is_block());
            if let Child::Region(index, way) = next.child() {
                stream.regions.push((k, (index, way)));
            }
        }
        stream.walking.clear();
        enter_regions(view, shots, stream);
        enter_nodes(simd, view, stream, &mut seen);
        look_at_blocks(simd, view, shots, stream, &mut seen);
    }
}

/// Takes on the rays that come to a region, in or out.
fn enter_regions<Q: Shot>(view: &BvhView<'_>, shots: &[Q], stream: &mut Stream) {
    let Stream { flights, walking, regions, .. } = stream;
    for (k, (index, way)) in regions.drain(..) {
        let (region, next) = view.tree.enter(index, way);
        let flight = &mut flights[k as usize];
        flight.stack.extend(next.map(|code| (f32::NEG_INFINITY, code)));
        flight.change_to(&region.frame, shots[k as usize].ray());
        flight.go_on(k, walking);
    }
}

/// Takes on the rays that come to a node.
#[inline(always)]
fn enter_nodes<S: Simd>(simd: S, view: &BvhView<'_>, stream: &mut Stream, seen: &mut Seen) {
    let Stream { flights, walking, nodes, statistics, .. } = stream;
    statistics.nodes += nodes.all().len() as u64;
    for visits in nodes.all().chunks(AT_ONCE) {
        for (&(k, index), entered) in visits.iter().zip(&mut seen.entered) {
            let node = &view.tree.nodes[index as usize];
            let (near, met) = flights[k as usize].boxes.entries(simd, node);
            near.store_slice(&mut entered.entry);
            entered.met = met;
        }
        for (&(k, index), entered) in visits.iter().zip(&seen.entered) {
            let (node, flight) = (&view.tree.nodes[index as usize], &mut flights[k as usize]);
            push_met(simd, &mut flight.stack, &entered.entry, entered.met, node);
            flight.go_on(k, walking);
        }
    }
}

/// Takes on the rays that come to a block of leaves; those with pairs wait for their outcome.
#[inline(always)]
fn look_at_blocks<S: Simd, Q: Shot>(
    simd: S,
    view: &BvhView<'_>,
    shots: &[Q],
    stream: &mut Stream,
    seen: &mut Seen,
) {
    let Stream { flights, walking, waiting, blocks, pairs, single, wanted, .. } = stream;
    for visits in blocks.all().chunks(AT_ONCE) {
        for (&(k, index), passages) in visits.iter().zip(&mut seen.passages) {
            let block = &view.tree.blocks[index as usize];
            flights[k as usize].boxes.pass(simd, block, passages);
        }
        if view.outgrows_caches() {
            prefetch(view, visits, &seen.passages);
        }
        for (&(k, index), passages) in visits.iter().zip(&seen.passages) {
            let (shot, flight) = (&shots[k as usize], &mut flights[k as usize]);
            let asked = StreamRay::new(view, shot, *wanted, k);
            let before = pairs.len();
            asked.look_at(simd, index, passages, flight, pairs, single);
            if flight.alone || flight.is_done() {
                pairs.truncate(before);
            } else if pairs.len() > before {
                waiting.push(k);
            } else {
                flight.go_on(k, walking);
            }
        }
    }
}

/// Prefetches the leaves whose boxes are met: see [`BvhView::outgrows_caches`].
fn prefetch(view: &BvhView<'_>, visits: &[Visit], passages: &[Passages]) {
    for stage in [BvhView::prefetch_leaves, BvhView::prefetch_pieces, BvhView::prefetch_nets] {
        for (&(_, block), passages) in visits.iter().zip(passages) {
            let leaves = view.tree.leaves(block);
            stage(view, leaves.first, leaves.of(passages.met));
        }
    }
}

#[inline(always)]
fn start_of<'q, Q: Shot>(view: &BvhView<'_>, shot: &'q Q) -> Start<'q> {
    let ray = shot.ray();
    Start { from: shot.start_in(view.set), ahead: ray.t_min() >= 0.0 }
}

/// Sets all rays to begin at the root of the tree.
#[simd]
fn start<S: Simd, Q: Shot>(simd: S, view: &BvhView<'_>, shots: &[Q], stream: &mut Stream) {
    stream.waiting.clear();
    stream.flights.resize_with(shots.len().max(stream.flights.len()), Flight::default);
    let scaled = view.tree.frame();
    for base in (0..shots.len()).step_by(LANES) {
        let lanes = LANES.min(shots.len() - base);
        // Of a picture with little in it, most rays pass beside everything.
        let may_meet = |lane: usize| !view.is_passed_by(shots[base + lane].ray());
        let traced = (0..lanes).map(|lane| u32::from(may_meet(lane)) << lane).sum::<u32>();
        if traced == 0 {
            for flight in &mut stream.flights[base..base + lanes] {
                (flight.met, flight.alone) = (false, false);
            }
            continue;
        }
        let halves = [EightRays::of(simd, shots, base), EightRays::of(simd, shots, base + 8)];
        let narrow = ScaledSixteen::new(simd, &halves[0], &halves[1], scaled);
        let mut numbers = [[0f32; LANES]; 8];
        let [ox, oy, oz] = narrow.origin;
        let [dx, dy, dz] = narrow.axis;
        let [near, far] = narrow.ends;
        for (to, from) in numbers.iter_mut().zip([ox, oy, oz, dx, dy, dz, near, far]) {
            f32x16::store_slice(&from, to);
        }
        let mut wide = [[[0f64; 8]; 3]; 2];
        for half in 0..2 {
            let EightRays { magnitude, t_from_z, .. } = halves[half];
            for (to, from) in wide[half].iter_mut().zip([narrow.shift[half], magnitude, t_from_z]) {
                f64x8::store_slice(&from, to);
            }
        }
        for lane in 0..lanes {
            let flight = &mut stream.flights[base + lane];
            let [ox, oy, oz, dx, dy, dz, near, far] = &numbers;
            let origin = [ox[lane], oy[lane], oz[lane]];
            let axis = [dx[lane], dy[lane], dz[lane]];
            // In f32, not as in `RayFrame`: the same to within a unit, which the blur covers.
            let inverse = axis.map(|along| 1.0 / along);
            flight.boxes = BoxRay::new(origin, axis, inverse, [near[lane], far[lane]]);
            let [shift, magnitude, t_from_z] = &wide[lane / 8];
            (flight.shift, flight.scale) = (shift[lane % 8], scaled.scale);
            flight.magnitude = magnitude[lane % 8];
            flight.t_from_z = t_from_z[lane % 8];
            flight.met = false;
            flight.alone = view.is_beyond_f32(flight.magnitude);
            flight.stack.clear();
            if let Some(root) = view.tree.root()
                && has(traced, lane)
                && !flight.alone
            {
                flight.stack.push((f32::NEG_INFINITY, root));
                stream.waiting.push((base + lane) as u32);
            }
        }
    }
}

/// One ray of a batch, with its start.
struct StreamRay<'a> {
    view: &'a BvhView<'a>,
    ray: &'a Ray,
    start: Start<'a>,
    wanted: Wanted,
    /// Which ray of the batch.
    index: u32,
}

impl<'a> StreamRay<'a> {
    #[inline(always)]
    fn new<Q: Shot>(view: &'a BvhView<'a>, shot: &'a Q, wanted: Wanted, index: u32) -> Self {
        Self { view, ray: shot.ray(), start: start_of(view, shot), wanted, index }
    }

    /// Examines the leaves of a block whose boxes the ray meets.
    #[simd]
    fn look_at<S: Simd>(
        &self,
        simd: S,
        block: u32,
        passages: &Passages,
        flight: &mut Flight,
        pairs: &mut Vec<Pair>,
        single: &mut SingleWork,
    ) {
        let leaves = self.view.tree.leaves(block);
        let mut met = leaves.of(passages.met);
        while met != 0 {
            let nearest = first_entered(&passages.entry, met);
            met &= !(1 << nearest);
            if passages.entry[nearest] > flight.boxes.far + BOX_SPARE {
                return;
            }
            single.statistics.leaf_tests += 1;
            let index = leaves.first + nearest as u32;
            let (start, slopes) = (passages.place_of(nearest), passages.slopes_of(nearest));
            let leaf = &self.view.leaves[index as usize];
            let patch = &self.view.piece_of(index).patch;
            let error = patch.error_bound(flight.magnitude);
            let guess = Guess::of(leaf, start, slopes, error);
            let line = Line { origin: &self.ray.origin(), axis: &flight.boxes.axis };
            let fitted = self.view.fitted(index, patch);
            if self.start.is_done_with(simd, fitted, patch, line, guess.is_some(), error) {
                continue;
            }
            if let (Some(guess), Some(form)) = (guess, Form::of_pairs(patch)) {
                self.view.prefetch_leaves(index, 1); // for the search of all pairs, some time later
                pairs.push(Pair { ray: self.index, leaf: index, form, guess });
                continue;
            }
            self.search(simd, (index, fitted), guess, error, flight, single);
            if flight.alone {
                return;
            }
        }
    }

    /// Searches one leaf for this ray only: see [`search_ahead`].
    #[simd]
    fn search<S: Simd>(
        &self,
        simd: S,
        leaf: (u32, Fitted<'_>),
        guess: Option<Guess>,
        error: f64,
        flight: &mut Flight,
        single: &mut SingleWork,
    ) {
        let frame = RayFrame::new(self.ray);
        let mut ray = SingleRay::new(&frame, self.start.from, self.wanted, self.view.tree.frame());
        single.clear();
        search_ahead(simd, self.view, leaf, guess, error, &mut ray, single);
        flight.alone |= !single.undecided.is_empty();
        if let Some(hit) = single.hit()
            && flight.takes(self.view, &hit.place, self.wanted)
        {
            flight.hit = *hit;
        }
    }
}

/// Searches all pairs added so far, those of one form together.
#[simd]
fn search_pairs<S: Simd, Q: Shot>(simd: S, view: &BvhView<'_>, shots: &[Q], stream: &mut Stream) {
    let Stream { flights, pairs, lanes, single, statistics, wanted, .. } = stream;
    if pairs.windows(2).any(|pair| pair[0].form != pair[1].form) {
        pairs.sort_by_key(|pair| pair.form);
    }
    let mut rest = &pairs[..];
    while let Some(first) = rest.first() {
        let alike = rest.iter().take(LANES).take_while(|pair| pair.form == first.form).count();
        let (group, others) = rest.split_at(alike);
        rest = others;
        let outcomes = lanes.search(simd, view, shots, group);
        statistics.newton_iterations += u64::from(outcomes.steps);
        for (lane, pair) in group.iter().enumerate() {
            let flight = &mut flights[pair.ray as usize];
            let cut_off =
                has(outcomes.at_end, lane) && is_cut_off(&lanes.place(lane, pair.leaf), view);
            flight.alone |= has(outcomes.undecided, lane) && !cut_off;
            if has(outcomes.met, lane) {
                if flight.takes(view, &lanes.place(lane, pair.leaf), *wanted) {
                    lanes.put(simd, lane, pair.leaf, &mut flight.hit);
                }
            } else if has(outcomes.unconverged, lane) && !flight.is_done() {
                let shot = &shots[pair.ray as usize];
                let asked = StreamRay::new(view, shot, *wanted, pair.ray);
                let patch = &view.piece_of(pair.leaf).patch;
                let error = patch.error_bound(flight.magnitude);
                let leaf = (pair.leaf, view.fitted(pair.leaf, patch));
                asked.search(simd, leaf, None, error, flight, single);
            }
            if flight.alone {
                flight.stack.clear();
            }
        }
    }
}
