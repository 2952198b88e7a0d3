//! Pieces halved until they are flat enough to search, without what trims cut off.

use glam::{DVec3, DVec4};

use super::bend::{Bend, MOST_HALVINGS};
use crate::geometry::RectSide;
use crate::geometry::trim::{Coverage, Trims};
use crate::math::rounding::UNIT_ROUNDOFF;
use crate::math::{Aabb, bernstein};
use crate::patch::pieces::tensor::euclidean;
use crate::patch::{BezierNet, DyadicRect, LEAF_SLACK, Piece, StRect, WIDENING};

/// A trim curve within the domain that stays this near to the border of a part, as a fraction of
/// its sides, is not worth halving for: all parts on that side would be mixed, and hardly less of
/// them kept.
const RIM: f64 = 1.0 / 16.0;

/// Leaves flatter than this gain little. Flat leaves need fewer Newton steps, fit their boxes
/// better and are certified for more rays; but there are more of them, each met by fewer rays of a
/// packet. Measured against 0.06, which takes about twice the memory: a sphere is traced 0.97 to
/// 1.08 times as fast, a sheet of hills 0.98 to 1.07, a trimmed one 0.98 to 1.12, a surface of
/// degree 5 × 5 0.88 to 1.
const FLATTEST: f64 = 0.09;

/// The bend that a part with a trim curve through it is treated as having, for the first halving
/// made for the sake of the curve, the second, and so on: halves that are cut off, or cut down, are
/// met by fewer rays, and hits on halves that the curve misses need no test.
///
/// Measured: with six such halvings instead of four, four models of trimmed planes and cylinders
/// are traced 0.9 to 1.2 times as fast, mostly 1.05 times, and take up to 1.35 times the memory.
/// Eight and twelve gain one of them another 1.1 times, and the others nothing.
const AT_TRIMS: [f64; 6] = [0.15, 0.15, 0.12, 0.12, 0.12, 0.12];
const _: () = assert!(AT_TRIMS[5] > FLATTEST, "the last is worth something");

/// A part is cut down to what trims keep of it if no more than this of it is left.
const WORTH_CUTTING_DOWN: f64 = 0.875;

/// What is left reaches farther beyond what is kept than this many times the error bound of points.
const LEAST_MARGIN: f64 = 1e4;

/// A part of a piece that is flat enough to become a leaf.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part {
    /// The index of the piece.
    pub piece: u32,
    /// The part of the piece's unit square.
    pub rect: DyadicRect,
    /// Holds all points the leaf answers for.
    pub bounds: Aabb,
    /// Whether a trim curve passes through it.
    pub trimmed: bool,
}

/// A part of a piece and the control points over it, while it is being halved.
#[derive(Debug)]
pub(in crate::patch) struct PartNet {
    rect: DyadicRect,
    net: BezierNet,
    /// How often, at most, its control points were rounded, one time after the other: in a half as
    /// often as the degree says, as the mean of two rounds once; in any other part see
    /// [`roundings_of_cut`].
    roundings: usize,
    /// How often it was halved for the sake of trim curves.
    cuts: u32,
    /// Whether trims are known to have cut off nothing of it; determined before it is handed over.
    inside: bool,
    /// How much it bends, set before it is handed over; `None` where only rounding error is left to
    /// measure.
    bend: Option<Bend>,
}

/// A way to halve a part.
#[derive(Clone, Copy, Debug)]
pub(in crate::patch) struct Cut {
    /// The direction to halve in.
    direction: usize,
    /// Whether it is for the sake of a trim curve.
    at_trims: bool,
    /// What the cut is worth: the angle the part bends by, or its equivalent, times the square root
    /// of its size, which is the geometric mean of its sides. Large parts are seen by more rays;
    /// but a small part may be what a picture is about, so the factor is not the area. Measured: a
    /// body with the wires of its net is traced 1.2 to 2 times as fast as with the angle alone;
    /// teapot, goblet and a flange with bolts are 0.97 to 1.06 times as fast.
    pub(in crate::patch) worth: f64,
}

/// How many roundings move a net's points at most when it is restricted to any rectangle, as
/// [`restrict_net`](bernstein::restrict_net) says.
fn roundings_of_cut(piece: &Piece) -> usize {
    let [p, q] = piece.patch.degree();
    6 * (p + q)
}

impl PartNet {
    /// A whole piece.
    pub(in crate::patch) fn whole(piece: &Piece) -> Self {
        Self {
            rect: DyadicRect::UNIT,
            net: piece.patch.control_net(),
            roundings: 0,
            cuts: 0,
            inside: false,
            bend: None,
        }
    }

    /// The part of a piece over a rectangle.
    pub(in crate::patch) fn over(piece: &Piece, rect: DyadicRect) -> Self {
        let mut net = piece.patch.control_net();
        let [s, t] = rect.ranges();
        bernstein::restrict_net(&mut net, piece.patch.degree(), s, t);
        Self { rect, net, roundings: roundings_of_cut(piece), cuts: 0, inside: false, bend: None }
    }

    /// Hands over the parts of this part that are flat enough to be leaves and are not cut off by
    /// trims.
    pub(in crate::patch) fn coarse_parts(mut self, piece: &Piece, done: &mut impl FnMut(Self)) {
        // Where a certificate holds, roots are known to far less than the widening; others are
        // compared with the trims where their error reaches beyond it.
        let coverage = self.trims_of(piece).map_or(Coverage::Inside, |trims| {
            trims.classify(&piece.uv_box(self.on_piece(WIDENING)))
        });
        if coverage == Coverage::Outside {
            return;
        }
        self.inside = coverage == Coverage::Inside;
        if let (false, Some(smaller)) = (self.inside, self.cut_down(piece)) {
            smaller.coarse_parts(piece, done);
            return;
        }
        self.bend = Bend::of(piece, self.rect, &self.net);
        match self.bend.and_then(|bend| bend.too_much()) {
            Some(direction) => {
                let [first, second] = self.halves(piece, direction);
                second.coarse_parts(piece, done);
                first.coarse_parts(piece, done);
            }
            None => done(self),
        }
    }

    /// The best way to halve this part further, if that is worth anything.
    pub(in crate::patch) fn way(&self, piece: &Piece) -> Option<Cut> {
        let bend = self.bend?;
        let (mut direction, mut angle) = bend.most();
        let mut at_trims = false;
        let worth = AT_TRIMS.get(self.cuts as usize).filter(|&&worth| worth > angle);
        if let (Some(&worth), Some(across)) = (worth, self.direction_to_cut(piece)) {
            (direction, angle, at_trims) = (across, worth, true);
        }
        let worth = angle * bend.size().sqrt();
        (angle > FLATTEST).then_some(Cut { direction, at_trims, worth })
    }

    /// Hands over the parts of both halves, as [`coarse_parts`](Self::coarse_parts) does.
    pub(in crate::patch) fn halved(&self, piece: &Piece, way: Cut, done: &mut impl FnMut(Self)) {
        for mut half in self.halves(piece, way.direction) {
            half.cuts += u32::from(way.at_trims);
            half.coarse_parts(piece, done);
        }
    }

    /// The part without what trims cut off along its sides, if that is worthwhile.
    ///
    /// What is left reaches as far beyond what is kept as roots may stray, which is also far more
    /// than rounding: a side that is too short for that is left as it is. So is one that runs along
    /// a point, where its parameter may be anything.
    fn cut_down(&self, piece: &Piece) -> Option<Self> {
        let kept = piece.kept_part(self.on_piece(WIDENING))?;
        let old = self.rect.ranges();
        let chords = piece.patch.chords(old).map(DVec3::length);
        let runs_along_pole = |k: usize| {
            let mut poles = piece.collapsed_sides().map(|(side, _)| side);
            poles.any(|side| side.along() as usize == k && side.is_reached_by(&old))
        };
        let rect = self.rect.cut_down_to(std::array::from_fn(|k| {
            let more = WIDENING * (old[k][1] - old[k][0]);
            let is_long = WIDENING * chords[k] > LEAST_MARGIN * piece.patch.noise();
            let is_cut = is_long && !runs_along_pole(k);
            if is_cut { [kept[k][0] - more, kept[k][1] + more] } else { old[k] }
        }));
        let new = rect.ranges();
        let area = |[s, t]: StRect| (s[1] - s[0]) * (t[1] - t[0]);
        if area(new) > WORTH_CUTTING_DOWN * area(old) {
            return None;
        }
        let on_part = [0, 1].map(|k| {
            let [from, to] = old[k];
            new[k].map(|at| (at - from) / (to - from))
        });
        let net = self.grown(piece, on_part[0], on_part[1]);
        let roundings = self.roundings + roundings_of_cut(piece);
        Some(Self { rect, net, roundings, bend: None, ..*self })
    }

    /// The trims of the piece, if they may have cut off something of this part.
    fn trims_of<'a>(&self, piece: &'a Piece) -> Option<&'a Trims> {
        piece.trims().filter(|_| !self.inside)
    }

    /// The part's rectangle with `part` of its sides added on each side, as far as the piece
    /// goes.
    fn on_piece(&self, part: f64) -> StRect {
        self.rect.ranges().map(|[from, to]| {
            let more = part * (to - from);
            [(from - more).max(0.0), (to + more).min(1.0)]
        })
    }

    /// The direction in which to halve a part that a trim curve passes through, if that is
    /// worthwhile: that of the longer side.
    fn direction_to_cut(&self, piece: &Piece) -> Option<usize> {
        let trims = self.trims_of(piece)?;
        let middle = piece.uv_box(self.on_piece(-RIM));
        if trims.classify(&middle) != Coverage::Mixed {
            return None;
        }
        let chords = piece.patch.chords(self.rect.ranges()).map(DVec3::length);
        let longer = usize::from(chords[1] > chords[0]);
        [longer, 1 - longer].into_iter().find(|&k| self.rect.halvings(k) < MOST_HALVINGS)
    }

    fn halves(&self, piece: &Piece, direction: usize) -> [Self; 2] {
        let half = |side: u32| {
            let from = 0.5 * f64::from(side);
            let mut ranges = [[0.0, 1.0]; 2];
            ranges[direction] = [from, from + 0.5];
            let net = self.grown(piece, ranges[0], ranges[1]);
            let roundings = self.roundings + piece.patch.degree()[direction];
            let rect = self.rect.half(direction, side);
            Self { rect, net, roundings, bend: None, ..*self }
        };
        [half(0), half(1)]
    }

    /// What is kept of the part: its place, and an axis-parallel box around every point its leaf
    /// answers for, grown by the error bound of points, and of its own control points.
    pub(in crate::patch) fn part(&self, index: u32, piece: &Piece) -> Part {
        let whole = self.rect == DyadicRect::UNIT;
        let bounds = if whole {
            self.bounds()
        } else {
            Aabb::around(self.answered(piece).iter().map(|&c| euclidean(c)))
        };
        let bounds = bounds.grown(piece.patch.noise() + self.rounding(piece));
        Part { piece: index, rect: self.rect, bounds, trimmed: !self.inside }
    }

    /// How far rounding may have moved the control points over the leaf and its slack.
    fn rounding(&self, piece: &Piece) -> f64 {
        let roundings = self.roundings + roundings_of_cut(piece);
        roundings as f64 * UNIT_ROUNDOFF * piece.patch.magnitude()
    }

    /// The control points over the leaf and its slack; the slack ends with the piece.
    pub(in crate::patch) fn answered(&self, piece: &Piece) -> BezierNet {
        let range = |[from, to]: [f64; 2]| {
            let low = if from == 0.0 { 0.0 } else { -LEAF_SLACK };
            let high = if to == 1.0 { 1.0 } else { 1.0 + LEAF_SLACK };
            [low, high]
        };
        let [s, t] = self.rect.ranges().map(range);
        self.grown(piece, s, t)
    }

    /// The control points over the rectangle that the certificate speaks of, which ends at a
    /// collapsed side.
    pub(in crate::patch) fn widened(
        &self,
        piece: &Piece,
        collapsed: Option<RectSide>,
    ) -> BezierNet {
        let mut ranges = [[-WIDENING, 1.0 + WIDENING]; 2];
        if let Some(side) = collapsed {
            ranges = side.ended_at_it(ranges);
        }
        self.grown(piece, ranges[0], ranges[1])
    }

    /// The control points over a rectangle given in sides of the part.
    pub(in crate::patch) fn grown(&self, piece: &Piece, s: [f64; 2], t: [f64; 2]) -> BezierNet {
        let mut net = BezierNet::from_slice(&self.net);
        bernstein::restrict_net(&mut net, piece.patch.degree(), s, t);
        net
    }

    /// The bounding box of the control points.
    pub(in crate::patch) fn bounds(&self) -> Aabb {
        Aabb::around(self.net.iter().map(|&c| euclidean(c)))
    }

    /// Its rectangle on the piece.
    pub(in crate::patch) fn rect(&self) -> DyadicRect {
        self.rect
    }

    /// The control points.
    pub(in crate::patch) fn net(&self) -> &[DVec4] {
        &self.net
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::{DVec2, DVec3};

    use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims, UvBox};
    use crate::geometry::{KnotVector, NurbsSurface, TrimmedSurface};
    use crate::math::SplitMix;
    use crate::patch::{PatchSet, StRect, holds};

    /// The corners of a polygon about the middle of the unit square.
    fn polygon(corners: usize, radius: impl Fn(usize) -> f64, aspect: DVec2) -> Vec<DVec2> {
        let corner = |k: usize| {
            let turn = DVec2::from_angle(0.3 + TAU * k as f64 / corners as f64);
            0.5 + radius(k) * aspect * turn
        };
        (0..corners).map(corner).collect()
    }

    fn rectangle(u: [f64; 2], v: [f64; 2]) -> Vec<DVec2> {
        let UvBox { min, max } = UvBox::new(u, v);
        vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
    }

    /// The unit square with parameters from `offset` on, trimmed by polygons in the unit square.
    fn trimmed(offset: f64, kept: Kept, polygons: &[Vec<DVec2>]) -> TrimmedSurface {
        let range = [offset, offset + 1.0];
        let knots = || KnotVector::new(1, vec![range[0], range[0], range[1], range[1]]).unwrap();
        let points = [DVec3::ZERO, DVec3::Y, DVec3::X, DVec3::X + DVec3::Y];
        let plane = NurbsSurface::new(knots(), knots(), points.to_vec(), None).unwrap();
        let loops = polygons.iter().map(|corners| {
            let moved: Vec<DVec2> = corners.iter().map(|corner| corner + offset).collect();
            TrimLoop::polygon(&moved).unwrap()
        });
        let domain = TrimDomain::new(range, range).unwrap();
        let trims = Trims::new(domain, kept, &loops.collect::<Vec<_>>()).unwrap();
        TrimmedSurface::new(plane, trims).unwrap()
    }

    #[test]
    fn leaves_hold_all_that_trims_keep_and_little_more() {
        let [even, slender] = [DVec2::ONE, DVec2::new(0.02, 0.9)];
        let star = |k: usize| if k.is_multiple_of(2) { 0.45 } else { 0.15 };
        let polygons = [
            vec![polygon(3, |_| 0.4, even)],
            vec![polygon(5, |_| 0.5, slender)],
            vec![polygon(14, star, even)],
            vec![polygon(40, |_| 0.4, even), polygon(40, |_| 0.3, even)],
            vec![polygon(4, |_| 0.03, even)],
            // Along lines at which parts are halved.
            vec![rectangle([0.25, 0.5], [0.0, 1.0]), rectangle([0.375, 0.4375], [0.5, 0.75])],
            // Far thinner than any leaf.
            vec![rectangle([0.3, 0.3 + 1e-7], [0.1, 0.9])],
        ];
        let mut random = SplitMix::new(15);
        for (k, offset) in (0..polygons.len()).flat_map(|k| [(k, 0.0), (k, -3e6)]) {
            let surface = trimmed(offset, Kept::Odd, &polygons[k]);
            let bounds = surface.trims().bounds();
            let (_, parts) = PatchSet::new(std::slice::from_ref(&surface)).unwrap();
            let rects: Vec<StRect> = parts.all().iter().map(|part| part.rect.ranges()).collect();
            let (mut kept, mut held) = (0, 0);
            for _ in 0..20_000 {
                let uv = bounds.min + bounds.size() * DVec2::new(random.unit(), random.unit());
                let is_held = rects.iter().any(|&rect| holds(rect, uv - offset));
                let is_kept = surface.keeps(uv);
                assert!(is_held || !is_kept, "{uv} of {k} at {offset}");
                kept += u32::from(is_kept);
                held += u32::from(is_held);
            }
            let area: f64 = rects.iter().map(|[s, t]| (s[1] - s[0]) * (t[1] - t[0])).sum();
            let size = bounds.size();
            let size = size.max(DVec2::splat(1.0 / 128.0));
            assert!(area < 1.5 * size.x * size.y, "{k} at {offset}: {area}");
            assert!(f64::from(held) < 1.8 * f64::from(kept), "{k} at {offset}: {held} of {kept}");
        }
    }

    #[test]
    fn what_surrounds_a_hole_is_not_cut_down() {
        let surface = trimmed(0.0, Kept::Even, &[polygon(12, |_| 0.01, DVec2::ONE)]);
        let (_, parts) = PatchSet::new(std::slice::from_ref(&surface)).unwrap();
        let rects = parts.all().iter().map(|part| part.rect.ranges());
        let area: f64 = rects.map(|[s, t]| (s[1] - s[0]) * (t[1] - t[0])).sum();
        assert!((1.0 - 0.01 * 0.01 * 4.0..=1.0).contains(&area), "{area}");
    }
}
