//! Finds loops that cross themselves or each other, as opposed to loops that only touch.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec2;

use super::contacts::{Contact, contacts_after};
use super::lobes::Lobes;
use super::segment::Segment;
use super::tree::Tree;
use super::{TrimDomain, TrimError, TrimLoop, TrimLoopError, UvBox};

/// The number of parts into which a contact that could not be resolved further is divided for
/// sampling: two curves that cross there and back again are noticed if a sixteenth of the contact
/// lies between.
const INSIDE_CONTACT: usize = 16;

/// The number of halvings that narrow a crossing from the length of a loop down to rounding error.
const MOST_HALVINGS: usize = 100;

/// The number of parts of segments that may be compared per segment, in addition to
/// [`WORK_FOR_A_START`]. A corner where two segments touch costs about 200 comparisons, a common
/// side up to 1000. That is enough for a mosaic.
const WORK_PER_SEGMENT: usize = 1 << 11;

/// The part of the budget that does not depend on the number of segments: a hundred curves may well
/// all touch each other, and a thousand circles lie inside each other, as in a zone plate. A
/// comparison takes ten to thirty nanoseconds, so this is four seconds at most.
const WORK_FOR_A_START: usize = 1 << 27;

/// A loop that is run through twice encloses its area twice; one that runs there and back encloses
/// only rounding errors. This fraction of its rectangle separates the two.
const SMALL_AREA: f64 = 1e-9;

/// A loop no larger than this many rounding errors of its curves counts as a point.
const MOST_REACHES: f64 = 64.0;

/// Two loops may cross where they overlap by no more than this, relative to the smallest of their
/// extents and the domain's, in u and in v.
///
/// In CAD files, a hole that touches an outline, or two that share a side, may cross it there by
/// what their curves are off. What lies between counts by the even–odd rule like all else. For a
/// loop drawn a thousand pixels wide, it is a hundredth of a pixel wide.
pub const OVERLAP_TOLERANCE: f64 = 1e-5;

/// How far two loops may overlap, in u and in v.
pub(crate) fn tolerated_overlap(domain: &TrimDomain, a: &TrimLoop, b: &TrimLoop) -> DVec2 {
    tolerated([domain.bounds(), a.bounds(), b.bounds()])
}

/// Loops may reach far beyond the domain, so it counts, too. (It counts as a whole: all copies of a
/// loop by periods are measured alike, however far each reaches in.)
fn tolerated(boxes: [UvBox; 3]) -> DVec2 {
    OVERLAP_TOLERANCE * boxes.map(|one| one.size()).into_iter().fold(DVec2::INFINITY, DVec2::min)
}

/// The number of contacts at which they are checked for the first time, before all are found.
const FIRST_LOOK: usize = 64;

/// Fails if a loop crosses itself, its copy a period away, or another, by more than is
/// [tolerated](OVERLAP_TOLERANCE).
///
/// Around a crossing of two strands of one loop, the winding number takes three values: `k` left of
/// neither strand, `k + 1`, and `k + 2` left of both. So the smaller of the two values beside a
/// strand changes where another strand crosses it, and is the same all along a loop that only
/// touches itself. Likewise, where a strand crosses another loop, it changes between the inside and
/// the outside of that loop. These values are computed along the strands where they come near
/// another one, at points clear of it. Whatever happens at a common corner or along a common
/// stretch, the values before and after it tell a crossing from a touch. The values along [small
/// lobes](Lobes) are left out. Where a loop crosses another, only values at points farther from it
/// than the tolerance count.
pub(super) fn check_crossings(
    domain: &TrimDomain,
    segments: &[Segment],
    loops: &[Range<usize>],
    owners: &[usize],
    tree: &Tree,
) -> Result<(), TrimError> {
    for (range, &owner) in loops.iter().zip(owners) {
        let there_and_back =
            range.len() == 2 && segments[range.clone()].iter().all(Segment::is_straight);
        if there_and_back {
            return Err(degenerate(owner, &segments[range.clone()]));
        }
    }

    let mut checks = Checks { domain, segments, loops, owners, trees: BTreeMap::new() };
    let most = WORK_FOR_A_START + WORK_PER_SEGMENT * segments.len();
    let (mut found, mut work, mut enough) = (Vec::new(), 0, FIRST_LOOK);
    for a in 0..segments.len() {
        let (contacts, compared) = contacts_after(a, segments, loops, tree);
        found.extend(contacts);
        work += compared;
        // A tangle crosses itself early, so not all of its contacts need to be found.
        if found.len() >= enough || work > most {
            checks.check(&found)?;
            enough = found.len() * 4;
        }
        if work > most {
            return Err(TrimError::Entangled { limit: most });
        }
    }
    checks.check(&found)
}

/// What contacts are checked with.
struct Checks<'a> {
    domain: &'a TrimDomain,
    segments: &'a [Segment],
    loops: &'a [Range<usize>],
    owners: &'a [usize],
    /// The hierarchies of single loops that others touch, each built once: a loop with many teeth
    /// may touch another one at each.
    trees: BTreeMap<usize, Tree>,
}

impl Checks<'_> {
    /// Fails if loops cross at or between these contacts.
    fn check(&mut self, contacts: &[Contact]) -> Result<(), TrimError> {
        let Self { segments, loops, owners, .. } = *self;
        let mut own: BTreeMap<usize, Vec<&Contact>> = BTreeMap::new();
        for contact in contacts.iter().filter(|contact| contact.loops[0] == contact.loops[1]) {
            own.entry(contact.loops[0]).or_default().push(contact);
        }
        let near = by_loops(contacts);
        for ([this, other], found) in &near {
            let (this, other) = (*this, *other);
            let lobes = match own.get(&this).filter(|_| this == other) {
                Some(own) => Lobes::between(own.iter().copied(), segments, &loops[this]),
                None => Lobes::default(),
            };
            let itself = this == other;
            let spare = DVec2::ZERO;
            let range = loops[this].clone();
            let tree = self.tree(other);
            let mut course =
                Strand { segments, range, lobes, other: tree, itself, spare }.course(found);
            if matches!(course, Course::Crosses(_)) && !itself {
                course = self.course_with_overlap([this, other], &near);
                // A narrow loop along a side of another one overlaps it by no more than is
                // tolerated wherever it is.
                if matches!(course, Course::Hidden)
                    && !matches!(self.course_with_overlap([other, this], &near), Course::Hidden)
                {
                    course = Course::Steady;
                }
            }
            let (loop_a, loop_b) = (owners[this], owners[other]);
            match course {
                Course::Steady => {}
                Course::Crosses(at) if itself => {
                    return Err(TrimError::SelfCrossing { index: loop_a, at });
                }
                Course::Crosses(at) if loop_a == loop_b => {
                    return Err(TrimError::CopyCrossing { index: loop_a, at });
                }
                Course::Crosses(at) => {
                    let loops = [loop_a.min(loop_b), loop_a.max(loop_b)];
                    return Err(TrimError::Crossing { loops, at });
                }
                Course::Hidden if itself => {
                    let own = &segments[loops[this].clone()];
                    let error = if encloses(own) { repeated } else { degenerate };
                    return Err(error(loop_a, own));
                }
                Course::Hidden => {
                    let loops = [loop_a.min(loop_b), loop_a.max(loop_b)];
                    return Err(TrimError::Coincident { loops });
                }
            }
        }
        Ok(())
    }

    /// The course of a loop along another one, where it is farther from it than they may overlap.
    fn course_with_overlap(
        &mut self,
        [this, other]: [usize; 2],
        near: &BTreeMap<[usize; 2], Stretches>,
    ) -> Course {
        let Self { domain, segments, loops, .. } = *self;
        let [own, others] = [this, other].map(|of| around(&segments[loops[of].clone()]));
        let strand = Strand {
            segments,
            range: loops[this].clone(),
            lobes: Lobes::default(),
            other: self.tree(other),
            itself: false,
            spare: tolerated([domain.bounds(), own, others]),
        };
        let near = near.get(&[this, other]).cloned().unwrap_or_default();
        strand.course(&strand.with_all_in(&others, near))
    }

    /// The hierarchy of one loop.
    fn tree(&mut self, index: usize) -> &Tree {
        let alone = std::slice::from_ref(&self.loops[index]);
        self.trees.entry(index).or_insert_with(|| Tree::new(self.segments, alone))
    }
}

fn degenerate(index: usize, segments: &[Segment]) -> TrimError {
    let UvBox { min, max } = around(segments);
    TrimError::Loop { index, error: TrimLoopError::Degenerate { min, max } }
}

fn repeated(index: usize, segments: &[Segment]) -> TrimError {
    let UvBox { min, max } = around(segments);
    TrimError::Loop { index, error: TrimLoopError::Repeated { min, max } }
}

fn around(segments: &[Segment]) -> UvBox {
    segments.iter().map(Segment::bounds).fold(UvBox::EMPTY, UvBox::union)
}

/// Whether a loop encloses anything: its signed area, computed from the polygon of its segments'
/// ends and middles, is not small relative to its rectangle.
fn encloses(segments: &[Segment]) -> bool {
    let bounds = around(segments);
    let corners = segments.iter().flat_map(|one| [0.0, 0.5].map(|along| one.directed_at(along)));
    let corners: Vec<DVec2> = corners.map(|corner| corner - bounds.min).collect();
    let next = corners.iter().cycle().skip(1);
    let area: f64 = corners.iter().zip(next).map(|(a, b)| 0.5 * a.perp_dot(*b)).sum();
    let reach = segments.iter().map(Segment::reach).fold(DVec2::ZERO, DVec2::max);
    let seen = bounds.size().cmpgt(MOST_REACHES * reach).all();
    seen && area.abs() > SMALL_AREA * bounds.size().element_product()
}

/// The stretches of a loop that are near a given loop, by segment.
type Stretches = BTreeMap<usize, Vec<[f64; 2]>>;

fn by_loops(contacts: &[Contact]) -> BTreeMap<[usize; 2], Stretches> {
    let mut sorted: BTreeMap<[usize; 2], Stretches> = BTreeMap::new();
    for contact in contacts {
        let [a, b] = contact.loops;
        let mut add = |loops, k: usize| {
            let stretches = sorted.entry(loops).or_default();
            stretches.entry(contact.segments[k]).or_default().push(contact.stretches[k]);
        };
        add([a, b], 0);
        add([b, a], 1);
    }
    sorted
}

/// How a loop runs relative to another, or to itself.
enum Course {
    /// It keeps to one side.
    Steady,
    /// It changes sides.
    Crosses(DVec2),
    /// It is nowhere clear of the other.
    Hidden,
}

/// A loop that is followed along another.
struct Strand<'a> {
    segments: &'a [Segment],
    range: Range<usize>,
    lobes: Lobes,
    other: &'a Tree,
    /// Whether the other is the loop itself.
    itself: bool,
    /// How near the other is, besides the rounding of both, where nothing counts.
    spare: DVec2,
}

impl Strand<'_> {
    fn course(&self, near: &Stretches) -> Course {
        let mut before: Option<(f64, i32)> = None;
        let mut hidden = true;
        for (&index, stretches) in near {
            for place in places(&self.segments[index], stretches) {
                let place = index as f64 + place;
                if self.lobes.hold(place) {
                    continue;
                }
                let Some(value) = self.value(place, self.spare) else { continue };
                hidden = false;
                match before {
                    Some((last, other)) if other != value => {
                        return Course::Crosses(self.change([last, place], other));
                    }
                    _ => before = Some((place, value)),
                }
            }
        }
        // Wherever it comes near the other loop, it lies on it. Does it elsewhere, too?
        let middles = || self.range.clone().map(|index| index as f64 + 0.5);
        if hidden && middles().all(|place| self.value(place, self.spare).is_none()) {
            return Course::Hidden;
        }
        Course::Steady
    }

    /// Some stretches, and all segments that may come into a rectangle.
    fn with_all_in(&self, rect: &UvBox, mut stretches: Stretches) -> Stretches {
        for index in self.range.clone() {
            if self.segments[index].bounds().meets(rect) {
                stretches.entry(index).or_default();
            }
        }
        stretches
    }

    /// Where the value changes between two places of the loop; it is `value` at the first.
    fn change(&self, [mut from, mut to]: [f64; 2], value: i32) -> DVec2 {
        for _ in 0..MOST_HALVINGS {
            let middle = 0.5 * (from + to);
            match self.value(middle, DVec2::ZERO) {
                None => return self.point(middle),
                Some(here) if here == value => from = middle,
                Some(_) => to = middle,
            }
        }
        self.point(to)
    }

    /// The smaller winding number beside the loop or, for another loop, 1 inside it and 0 outside;
    /// `None` within `spare`, or rounding error, of another strand. A place is the index of the
    /// segment plus the fraction of it that the loop has run through.
    fn value(&self, place: f64, spare: DVec2) -> Option<i32> {
        let (index, along) = self.locate(place);
        let point = self.segments[index].directed_at(along);
        let own = &self.segments[index];
        let mut clear = true;
        let target = UvBox::about(point, own.reach() + spare);
        let crossings = self.other.crossings(point, &target, |other| {
            if self.itself && other == index {
                return 0;
            }
            let segment = &self.segments[other];
            let reach = segment.reach() + own.reach() + spare;
            let (meets, crossing) = segment.seen_from(point, reach);
            clear &= !meets;
            crossing
        });
        if !clear {
            return None;
        }
        if !self.itself {
            return Some(crossings.rem_euclid(2));
        }
        // The ray leaves a rising strand on its right, where the winding number is the smaller one,
        // and a falling strand on its left. From the upper end of a strand, to within rounding, or
        // from a horizontal one, the ray runs just above it: on its left if the strand goes towards
        // larger u.
        let [from, to] = own.directed_ends();
        let on_the_left = if point.y < from.y.max(to.y) { to.y < from.y } else { from.x < to.x };
        Some(crossings - i32::from(on_the_left))
    }

    fn point(&self, place: f64) -> DVec2 {
        let (index, along) = self.locate(place);
        self.segments[index].directed_at(along)
    }

    /// The segment of a place and the fraction of it; rounding may have turned the end of the last
    /// segment into the beginning of one that does not exist.
    fn locate(&self, place: f64) -> (usize, f64) {
        let index = (place.floor() as usize).min(self.range.end - 1);
        (index, place - index as f64)
    }
}

/// The places along a segment, in the direction of its loop, at which to compute the value: between
/// the stretches that are near another curve, and within them.
fn places(segment: &Segment, stretches: &[[f64; 2]]) -> Vec<f64> {
    let mut ends: Vec<f64> = stretches.iter().flat_map(|one| segment.directed(*one)).collect();
    ends.extend([0.0, 1.0]);
    ends.sort_by(f64::total_cmp);
    let between = ends.windows(2).flat_map(|range| {
        let at = move |k: usize| k as f64 / INSIDE_CONTACT as f64;
        (1..INSIDE_CONTACT).map(move |k| range[0] + at(k) * (range[1] - range[0]))
    });
    // 1 itself would be the beginning of the next segment.
    between.filter(|place| (0.0..1.0).contains(place)).collect()
}
