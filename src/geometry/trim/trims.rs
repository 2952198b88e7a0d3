//! The trims of a surface: which of its parameters are kept.

use std::ops::Range;

use glam::DVec2;

use super::crossings::check_crossings;
use super::segment::{Passing, Segment};
use super::tree::Tree;
use super::{TrimDomain, TrimError, TrimLoop, TrimLoopError, UvBox, monotone};
use crate::geometry::Direction;
use crate::math::rounding::UNIT_ROUNDOFF;

/// The most monotone segments a surface's loops may have, copies by periods included.
pub const MAX_TRIM_SEGMENTS: usize = 1 << 21;

/// The most periods a loop may span: more is taken for a mistake of units.
const MAX_PERIODS: usize = 64;

/// Loops may reach beyond the domain by up to this many times its length: nine digits are lost
/// there, and seven are left.
const FARTHEST: f64 = 1e9;

/// Curves that reach into the domain by no more than this fraction of its length, beyond their own
/// error, lie on its border. What they cut off is so narrow that hits on it count as hits on the
/// border: these may be off by 12 such roundings or more, if the speed is even. (In files with
/// borders and loops of 13 digits they reach in farther.)
const ON_BORDER: f64 = 8.0 * UNIT_ROUNDOFF;

/// Loops that are farther outside the domain than this part of its length were not meant to run
/// along its border.
const OUTSIDE: f64 = 1e-3;

/// Which side of the loops is kept.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Kept {
    /// What lies inside an odd number of loops: the outermost loops are outlines, those
    /// directly inside them holes, those inside holes islands, and so on. Scenes write `"inside"`.
    #[doc(alias = "inside")]
    #[default]
    Odd,
    /// What lies inside an even number of loops, none included: the outermost loops are
    /// holes in the whole domain. Scenes write `"outside"`.
    #[doc(alias = "outside")]
    Even,
}

/// Where a point of the domain lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// In the part that is kept.
    Inside,
    /// In the part that is cut off.
    Outside,
    /// On a trim curve, as far as rounding errors allow to tell.
    Edge {
        /// The side on which the half-open rule puts the point. It is right for the curve as
        /// searched, but the point may lie on the other side of the curve as written.
        inside: bool,
        /// Upper bound on the distance to the curve, in u and in v separately.
        distance: DVec2,
    },
}

/// Where a rectangle of the domain lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Coverage {
    /// All of it is kept.
    Inside,
    /// All of it is cut off.
    Outside,
    /// A trim curve passes through it, or comes within rounding error of it.
    Mixed,
}

/// Closed loops that cut a surface's domain, prepared for queries with points and rectangles.
///
/// # The rule
/// A point lies inside a loop if a ray from it crosses the loop an odd number of times, and
/// what is kept depends on the number of loops around it ([`Kept`]): *even–odd*. Neither the
/// order of the loops nor the direction they run in matters. Loops are cut off at the domain's
/// border. They may touch themselves, each other and that border, in points and along stretches;
/// they may not cross, except for [tiny lobes](super::LOBE_TOLERANCE) at the joints of a loop, and
/// [by next to nothing](super::OVERLAP_TOLERANCE) where two loops touch.
///
/// # The test
/// Loops are cut into segments that are monotone in u and in v and share their ends bit for
/// bit. The ray runs towards larger u, and a segment from `v₀` to `v₁` is counted for
/// `v₀ ≤ v < v₁`: so the count is right at every end, extreme and horizontal piece, without
/// tolerance. Only segments whose rectangle contains the point are searched (Schollmeyer &
/// Fröhlich, "Direct trimming of NURBS surfaces on the GPU", 2009; Sloup & Havran, "Optimizing ray
/// tracing of trimmed NURBS surfaces on the GPU", 2021).
///
/// # Rounding
/// The answers [`Side::Inside`] and [`Side::Outside`] are proved for the loops as given, with gaps
/// closed and [sides along seams](super::SEAM_TOLERANCE) straightened. Points within `16 (p + 1) u`
/// of a curve, times the largest |u| of its Bézier piece in u and the largest |v| in v, are an
/// [`Side::Edge`] instead. `p` is the degree and `u = 2⁻⁵³`; for lines that is 16 spacings of
/// numbers just above 1.
///
/// # What a tracer does with it
/// At build, each leaf's rectangle is classified once: leaves outside are dropped, leaves inside,
/// or cut along the domain's border only, forget the trims, mixed leaves are cut down to what is
/// kept and marked as mixed. A hit on a mixed leaf is dropped if it is [`Side::Outside`] and
/// reported otherwise, edges included: the kept part is closed, as a surface is at its border. A
/// hit is flagged as being at a trim edge if it is an [`Side::Edge`]
/// [within](Trims::side_within) the error bound of its point in space, but not if the only
/// curves there lie on the domain's border. Away from edges, the few curves near a leaf give the
/// same answers faster.
#[derive(Clone, Debug, PartialEq)]
pub struct Trims {
    domain: TrimDomain,
    pub(super) kept: Kept,
    pub(super) segments: Vec<Segment>,
    loops: Vec<Range<usize>>,
    pub(super) tree: Tree,
    widest_gap: f64,
    /// See [`Trims::outside_loop_count`].
    outside: usize,
}

impl Trims {
    /// The trims made by these loops.
    ///
    /// # Errors
    /// When there is no loop; when a loop encloses nothing, is run through twice, has a dangling
    /// edge or lies outside the domain; when loops cross themselves, their copies a period away, or
    /// each other; when two loops are the same; or when they span too many periods, reach too far
    /// beyond the domain or need too many segments. Loops are counted from 0.
    pub fn new(domain: TrimDomain, kept: Kept, loops: &[TrimLoop]) -> Result<Self, TrimError> {
        let loops: Vec<TrimLoop> =
            loops.iter().map(|one| one.straight_along_seams(&domain)).collect();
        if loops.is_empty() {
            return Err(TrimError::NoLoops);
        }
        let (mut segments, mut ranges, mut owners) = (Vec::new(), Vec::new(), Vec::new());
        for (index, trim_loop) in loops.iter().enumerate() {
            let shifts = shifts_into(&domain, trim_loop, index)?;
            for shift in shifts {
                let first = segments.len();
                let copy = trim_loop.shifted(shift);
                for piece in copy.pieces() {
                    monotone::segments(piece, &mut segments);
                    if segments.len() > MAX_TRIM_SEGMENTS {
                        return Err(TrimError::TooManySegments { limit: MAX_TRIM_SEGMENTS });
                    }
                }
                if segments.len() - first < 2 {
                    let UvBox { min, max } = copy.bounds();
                    let error = TrimLoopError::Degenerate { min, max };
                    return Err(TrimError::Loop { index, error });
                }
                let rounding = 4.0 * UNIT_ROUNDOFF * shift.abs();
                segments[first..].iter_mut().for_each(|segment| segment.widen(rounding));
                ranges.push(first..segments.len());
                owners.push(index);
            }
        }
        look_for_border(&domain, &mut segments);
        let tree = Tree::new(&segments, &ranges);
        check_crossings(&domain, &segments, &ranges, &owners, &tree)?;
        for (index, trim_loop) in loops.iter().enumerate() {
            trim_loop.check_dangling(&domain).map_err(|error| TrimError::Loop { index, error })?;
        }
        let widest_gap = loops.iter().map(TrimLoop::widest_gap).fold(0.0, f64::max);
        let bounds = domain.bounds();
        let around = bounds.grown(OUTSIDE * bounds.size());
        let is_within = |segment: &Segment| {
            segment.bounds().meets(&around) && segment.passing(&around) == Passing::Meets
        };
        let mut outside = vec![true; loops.len()];
        for (range, &owner) in ranges.iter().zip(&owners) {
            outside[owner] &= !segments[range.clone()].iter().any(is_within);
        }
        let outside = outside.into_iter().filter(|&outside| outside).count();
        Ok(Self { domain, kept, segments, loops: ranges, tree, widest_gap, outside })
    }

    /// The domain that is trimmed.
    pub fn domain(&self) -> TrimDomain {
        self.domain
    }

    /// Which side of the loops is kept.
    pub fn kept(&self) -> Kept {
        self.kept
    }

    /// The widest gap that was closed between curves of a loop: see [`TrimLoop::widest_gap`].
    pub fn widest_gap(&self) -> f64 {
        self.widest_gap
    }

    /// Where a point of the domain lies. A point with a NaN is outside.
    ///
    /// For points outside the domain only the loops count, not the domain's border: the caller
    /// knows where the surface ends.
    pub fn side_of(&self, uv: DVec2) -> Side {
        self.side_within(uv, DVec2::ZERO)
    }

    /// Where a point of the domain lies that is known only to within `reach.x` in u and `reach.y`
    /// in v: an [`Side::Edge`] if a trim curve meets the rectangle `uv ± reach`, grown by the
    /// curve's rounding error.
    ///
    /// For a hit whose point is known to within `r` in space and whose tangents meet at the angle
    /// `θ`, `reach = (r / (|S_u| sin θ), r / (|S_v| sin θ))` covers all parameters that the hit may
    /// have, to first order. Infinite reaches are allowed; NaN and negative values count as zero.
    pub fn side_within(&self, uv: DVec2, reach: DVec2) -> Side {
        self.seen_within(uv, reach, 1.0)
    }

    /// [`Trims::side_within`], but of the curves' rounding errors only this part counts.
    pub(crate) fn seen_within(&self, uv: DVec2, reach: DVec2, part: f64) -> Side {
        if uv.is_nan() {
            return Side::Outside;
        }
        let reach = reach.max(DVec2::ZERO);
        let mut distance: Option<DVec2> = None;
        let crossings = self.tree.crossings(uv, &UvBox::about(uv, reach), |index| {
            let segment = &self.segments[index];
            let reach = part * segment.reach() + reach;
            let (meets, crossing) = segment.seen_from(uv, reach);
            if meets {
                distance = Some(distance.map_or(reach, |d| d.max(reach)));
            }
            crossing
        });
        let odd = crossings % 2 != 0;
        let inside = odd == (self.kept == Kept::Odd);
        match distance {
            Some(distance) => Side::Edge { inside, distance },
            None if inside => Side::Inside,
            None => Side::Outside,
        }
    }

    /// Where a rectangle of the domain lies.
    ///
    /// `Inside` and `Outside` are proved: no trim curve comes within rounding error of the closed
    /// rectangle, so [`Trims::side_of`] gives the same answer for each of its points. Curves along
    /// the domain's border do not count, as what they cut off is not part of the surface: points
    /// within rounding of such a border may be on either side. An invalid rectangle (`min > max`,
    /// NaN) is `Mixed`.
    pub fn classify(&self, rect: &UvBox) -> Coverage {
        let proper = rect.min.cmple(rect.max).all(); // false for NaN
        if !proper || self.cuts(rect) {
            return Coverage::Mixed;
        }
        match self.side_of(rect.center()) {
            Side::Inside => Coverage::Inside,
            Side::Outside => Coverage::Outside,
            Side::Edge { .. } => Coverage::Mixed,
        }
    }

    /// A rectangle that holds everything that is kept of another one, except for rounding of
    /// points; `None` if nothing is.
    ///
    /// What is kept reaches farthest at a curve, or along a whole side, its corners included.
    pub(crate) fn kept_within(&self, rect: &UvBox) -> Option<UvBox> {
        let UvBox { min, max } = *rect;
        let mut kept = UvBox::EMPTY;
        self.tree.any(rect, |index| {
            let segment = &self.segments[index];
            let reach = segment.reach();
            if let Some(ends) = segment.stretch_within(&rect.grown(reach)) {
                kept = kept.union(UvBox::around(ends.map(|t| segment.at(t))).grown(reach));
            }
            kept.min.cmple(min).all() && kept.max.cmpge(max).all()
        });
        for corner in [min, max, DVec2::new(min.x, max.y), DVec2::new(max.x, min.y)] {
            if !kept.holds(corner) && self.side_of(corner) != Side::Outside {
                kept = kept.union(UvBox { min: corner, max: corner });
            }
        }
        let kept = UvBox { min: kept.min.max(min), max: kept.max.min(max) };
        kept.min.cmple(kept.max).all().then_some(kept)
    }

    /// Whether any trim curve passes through a rectangle.
    #[cfg(test)]
    pub(super) fn meets(&self, target: &UvBox) -> bool {
        self.any_meets(target, |_| true)
    }

    /// Whether a trim curve that does not lie on the domain's border passes through a rectangle.
    pub(crate) fn cuts(&self, target: &UvBox) -> bool {
        self.any_meets(target, |segment| !segment.is_on_border())
    }

    /// Whether a trim curve that counts passes through a rectangle, grown by the curve's rounding
    /// error; false for NaN.
    fn any_meets(&self, target: &UvBox, counts: impl Fn(&Segment) -> bool) -> bool {
        self.tree.any(target, |index| {
            let segment = &self.segments[index];
            let target = target.grown(segment.reach());
            counts(segment)
                && segment.bounds().meets(&target)
                && segment.passing(&target) == Passing::Meets
        })
    }

    /// The same loops on the domain run backwards in u; `new` is its range afterwards, of the same
    /// length.
    #[must_use]
    pub(crate) fn reversed_u(&self, new: [f64; 2]) -> Self {
        let [range, _] = self.domain.range();
        self.mapped(self.domain.reversed_u(new), |one| one.mirrored_u(range, new))
    }

    /// The same loops on the domain with u and v exchanged.
    #[must_use]
    pub(crate) fn swapped(&self) -> Self {
        self.mapped(self.domain.swapped(), Segment::swapped)
    }

    /// The same loops on a domain that a map makes of this one, which takes segments to segments
    /// that share their ends as before, or to none.
    fn mapped(&self, domain: TrimDomain, map: impl Fn(&Segment) -> Option<Segment>) -> Self {
        let (mut segments, mut loops) = (Vec::with_capacity(self.segments.len()), Vec::new());
        for segments_of_loop in self.loop_segments() {
            let first = segments.len();
            segments.extend(segments_of_loop.iter().filter_map(&map));
            if segments.len() > first {
                loops.push(first..segments.len());
            }
        }
        let tree = Tree::new(&segments, &loops);
        look_for_border(&domain, &mut segments);
        Self { domain, segments, loops, tree, ..*self }
    }

    /// A rectangle of the domain that contains everything kept: its sides touch the outermost
    /// loops.
    pub fn bounds(&self) -> UvBox {
        let domain = self.domain.bounds();
        match self.kept {
            Kept::Even => domain,
            Kept::Odd => {
                // Monotone segments reach no farther than their ends.
                let UvBox { min, max } = UvBox::around(self.joints());
                UvBox { min: min.max(domain.min), max: max.min(domain.max) }
            }
        }
    }

    /// The ends of all monotone segments, which lie on the loops.
    pub fn joints(&self) -> impl Iterator<Item = DVec2> {
        self.segments.iter().map(|segment| segment.directed_ends()[0])
    }

    /// The middles of all monotone segments.
    pub(crate) fn middles(&self) -> impl Iterator<Item = DVec2> {
        self.segments.iter().map(|segment| segment.directed_at(0.5))
    }

    /// The number of loops, copies by periods included.
    pub fn loop_count(&self) -> usize {
        self.loops.len()
    }

    /// The number of loops, as given, that run outside the domain only, farther from it than a
    /// thousandth of its length: perhaps a mistake of units. They go around all of the domain, or
    /// around none of it.
    pub fn outside_loop_count(&self) -> usize {
        self.outside
    }

    /// The number of monotone segments of all loops.
    pub fn segment_count(&self) -> usize {
        self.segments.len()
    }

    /// The memory taken by the trims, in bytes.
    pub fn bytes(&self) -> usize {
        let controls: usize = self.segments.iter().map(Segment::bytes).sum();
        controls + self.tree.bytes() + std::mem::size_of_val(&*self.segments)
    }

    /// The segments of each loop, in the order in which it runs.
    pub(super) fn loop_segments(&self) -> impl Iterator<Item = &[Segment]> {
        self.loops.iter().map(|range| &self.segments[range.clone()])
    }
}

/// Marks the segments that lie on the domain's border, or outside.
fn look_for_border(domain: &TrimDomain, segments: &mut [Segment]) {
    let (bounds, off) = (domain.bounds(), border_slack(domain));
    segments.iter_mut().for_each(|segment| segment.look_for_border(&bounds, off));
}

/// How far curves on the domain's border may reach into it, beyond their own error.
pub(super) fn border_slack(domain: &TrimDomain) -> DVec2 {
    ON_BORDER * domain.bounds().size()
}

/// The shifts that make a loop reach into the domain: whole periods in periodic directions, zero in
/// others.
fn shifts_into(
    domain: &TrimDomain,
    trim_loop: &TrimLoop,
    index: usize,
) -> Result<Vec<DVec2>, TrimError> {
    let (loop_box, bounds) = (trim_loop.bounds(), domain.bounds());
    let mut along = [vec![0.0], vec![0.0]];
    for direction in Direction::BOTH {
        let period = bounds.size()[direction];
        let touch = ON_BORDER * period;
        let (low, high) = (loop_box.min[direction], loop_box.max[direction]);
        let (start, end) = (bounds.min[direction] + touch, bounds.max[direction] - touch);
        if domain.is_periodic(direction) {
            let periods = (high - low) / period;
            if periods > MAX_PERIODS as f64 {
                let limit = MAX_PERIODS;
                return Err(TrimError::TooManyPeriods { index, direction, periods, limit });
            }
            // All k with high + k period > start and low + k period < end.
            let (first, last) = (((start - high) / period).ceil(), ((end - low) / period).floor());
            let count = (last - first).max(-1.0) as usize + usize::from(last >= first);
            along[direction] = (0..count).map(|k| (first + k as f64) * period).collect();
        }
        along[direction].retain(|shift| high + shift > start && low + shift < end);
    }
    let [us, vs] = along;
    let shifts: Vec<DVec2> =
        us.iter().flat_map(|&u| vs.iter().map(move |&v| DVec2::new(u, v))).collect();
    if shifts.is_empty() {
        let loop_box = [loop_box.min, loop_box.max];
        return Err(TrimError::OutsideDomain { index, loop_box, domain: [bounds.min, bounds.max] });
    }
    for direction in Direction::BOTH {
        let periodic = domain.is_periodic(direction);
        let domain = [bounds.min[direction], bounds.max[direction]];
        let (low, high) = (loop_box.min[direction], loop_box.max[direction]);
        for (at, beyond) in [(low, domain[0] - low), (high, high - domain[1])] {
            if beyond > FARTHEST * (domain[1] - domain[0]) {
                let limit = FARTHEST;
                let error = TrimError::TooFar { index, direction, at, domain, periodic, limit };
                return Err(error);
            }
        }
    }
    Ok(shifts)
}
