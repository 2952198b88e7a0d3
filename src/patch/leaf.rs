//! What is kept of a part of a piece, to search it.

pub(super) mod bicubic;
pub(super) mod fit;
pub(super) mod fit_error;
mod stretch;
pub(super) mod trim_windows;

use glam::{DVec2, DVec3};

use self::bicubic::{Fit, WeightFit, second_derivatives};
use self::fit::Approximation;
use self::stretch::stretch;
use super::oriented_box::Axes;
use super::parts::part::PartNet;
use super::pieces::field::Net;
use super::{
    BORDER_REACH, Certificate, DyadicRect, LEAF_SLACK, OrientedBox, Part, Piece, ScaledFrame,
    StRect,
};
use crate::geometry::RectSide;
use crate::math::rounded::{Up8, Up16};
use crate::math::{prefetch, rounding};

/// A part of a piece that is flat enough to search, in the common form that all leaves have,
/// whatever the degree: four cache lines.
///
/// In *box coordinates* from −1 to 1, `x` and `y` follow `s` and `t` from one end of the leaf to
/// the other. The surface `S = X / W` is approximated, relative to the leaf's middle and in scene
/// units: its numerators `X` by bicubic polynomials in `x` and `y`, `fit`, and its weight `W`,
/// which is 1 in the middle, by another one. A leaf has a weight of its own where the degrees are
/// three at most, and the weights differ, but not too much (`MOST_WEIGHT`). In all other leaves `W`
/// is 1, and `X` approximates `S` itself. The `WeightFit`s and the leaf's `OrientedBox` are kept
/// elsewhere, beside those of its neighbours in space.
///
/// The distances of the surface's points from a plane through a ray, `n · (S − o)`, have the roots
/// of `F = n · X + (n · (c − o)) W`, where `c` is the leaf's middle; the coefficients of `F` are
/// sums of those of `X` and `W`. They give Newton's iteration a start. Since their error is bounded
/// (`FitError`) for rays that meet the leaf's box, they can also prove for a ray that a part of the
/// leaf holds one root at most, or none.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Leaf {
    fit: Fit,
    /// The point that the approximation is relative to: its own value in the middle, off the
    /// surface by [`fit_error`](Self::fit_error) at most.
    pub(crate) middle: DVec3,
    rect: DyadicRect,
    /// The index of the piece.
    pub piece: u32,
    /// Which rays meet the leaf at most once.
    pub(crate) certificate: Certificate,
    fit_error: Up16,
    slope_error: Up16,
    fit_bend: Up16,
    /// `T / M`, with `M` as kept in `fit_bend`.
    fit_third: Up8,
    stretch: Up16,
    /// [`TRIMMED`], [`PARALLELOGRAM`], [`AT_BORDER`], [`BIQUADRATIC`] and [`SHORT_TANGENTS`].
    marks: u8,
}

impl Leaf {
    /// The leaf of a part, its weight, and the close box around all points it answers for.
    pub(crate) fn new(
        part: &Part,
        piece: &Piece,
        frame: &ScaledFrame,
    ) -> (Self, WeightFit, OrientedBox) {
        let part_net = PartNet::over(piece, part.rect);
        let collapsed = collapsed_side(part.rect, piece);
        let approximation = Approximation::new(&part_net, piece);
        let Approximation { middle, fit, weight, chords, .. } = approximation;
        let axes = Axes::along(chords);
        let noise = piece.patch.noise();
        let oriented = OrientedBox::around(&part_net.answered(piece), &axes, noise, frame);
        let error = approximation.error(&part_net, piece, oriented.farthest_from(middle, frame));

        let widened = part_net.widened(piece, collapsed);
        let (degree, rational) = (piece.patch.degree(), piece.patch.is_rational());
        // Parameters are known to half a unit in the last place of one.
        let spacing = part.rect.ranges().map(|[from, to]| rounding::UNIT_ROUNDOFF / (to - from));
        let net = Net { degree, control: &widened, noise, rational, spacing };
        let certificate = Certificate::new(&net, collapsed, &axes, &oriented);
        let fit_bend = Up16::above(error.bend);
        let mut leaf = Self {
            fit,
            middle,
            rect: part.rect,
            piece: part.piece,
            certificate,
            fit_error: Up16::above(error.value),
            slope_error: Up16::above(error.slope),
            fit_bend,
            fit_third: Up8::above(error.third / f64::from(fit_bend.value())),
            stretch: Up16::above(f64::INFINITY),
            marks: 0,
        };
        let [x, y] = leaf.half_side_lengths().map(f64::from);
        let is_parallelogram = error.bend <= MOST_BEND_OF_PARALLELOGRAM * x.min(y);
        leaf.marks |= if is_parallelogram { PARALLELOGRAM } else { 0 }
            | if part.trimmed { TRIMMED } else { 0 };
        let mut sides = RectSide::ALL.into_iter();
        let is_at_border = sides.any(|side| leaf.near_border(piece, side).is_some());
        leaf.marks |= if is_at_border { AT_BORDER } else { 0 };
        leaf.marks |= if bicubic::is_biquadratic(&leaf.fit, &weight) { BIQUADRATIC } else { 0 };
        let has_short_tangents = leaf.has_pole() || are_short(chords, part.rect, piece);
        leaf.marks |= if has_short_tangents { SHORT_TANGENTS } else { 0 };
        leaf.stretch = Up16::above(stretch(&leaf.fit, &weight, &error));
        (leaf, weight, oriented)
    }

    /// Prefetches every cache line, for use soon.
    #[inline(always)]
    pub(crate) fn prefetch(&self) {
        self.fit.iter().for_each(prefetch);
        prefetch(&self.piece);
    }

    /// The part of the piece's unit square: from and to in `s`, then in `t`.
    #[inline(always)]
    pub fn rect(&self) -> StRect {
        self.rect.ranges()
    }

    /// The box coordinates of a point of the unit square.
    #[inline(always)]
    pub(crate) fn box_coordinates(&self, st: DVec2) -> DVec2 {
        let [s, t] = self.rect();
        let place = |[from, to]: [f64; 2], at: f64| (2.0 * at - (from + to)) / (to - from);
        DVec2::new(place(s, st.x), place(t, st.y))
    }

    /// The part of the unit square, as a value by which the leaves of a piece can be ordered.
    pub(crate) fn place(&self) -> DyadicRect {
        self.rect
    }

    /// The leaf's rectangle with `part` of its sides added on each side, except at a side that is
    /// collapsed to a point.
    #[inline(always)]
    pub(crate) fn widened(&self, piece: &Piece, part: f64) -> StRect {
        let wider = |[from, to]: [f64; 2]| {
            let more = part * (to - from);
            [from - more, to + more]
        };
        let [s, t] = self.rect();
        let rect = [wider(s), wider(t)];
        match self.collapsed(piece) {
            Some(side) => side.ended_at_it(rect),
            None => rect,
        }
    }

    /// The collapsed side of its piece at which the leaf ends, if any.
    #[inline(always)]
    pub(crate) fn collapsed(&self, piece: &Piece) -> Option<RectSide> {
        if self.has_pole() { collapsed_side(self.rect, piece) } else { None }
    }

    /// The point in which the leaf ends, if it does.
    #[inline(always)]
    pub(crate) fn pole(&self, piece: &Piece) -> Option<DVec3> {
        piece.collapsed(self.collapsed(piece)?)
    }

    /// Whether a trim curve passes through, so that hits must be tested against it; otherwise
    /// everything that the leaf answers for is kept.
    #[inline(always)]
    pub fn is_trimmed(&self) -> bool {
        self.marks & TRIMMED != 0
    }

    /// Whether the box coordinates at which a ray crosses the middle of the leaf's box are about as
    /// near to its root as f32 can tell: the leaf is nearly a parallelogram with an even
    /// parametrization.
    #[inline(always)]
    pub(crate) fn is_parallelogram(&self) -> bool {
        self.marks & PARALLELOGRAM != 0
    }

    /// Whether the approximation has no terms of degree three in `x` or `y`.
    #[inline(always)]
    pub(crate) fn is_biquadratic(&self) -> bool {
        self.marks & BIQUADRATIC != 0
    }

    /// Whether hits on the leaf may be within rounding of a border of the surface: see
    /// [`Self::near_border`].
    #[inline(always)]
    pub(crate) fn is_at_border(&self) -> bool {
        self.marks & AT_BORDER != 0
    }

    /// The distance from a side of the piece, in its parameter, within which a hit may be within
    /// rounding of the side; `None` unless the side is a border of the surface and near the leaf.
    /// The leaf must be certified for the ray, or the ray's own proof hold in it, which allows for
    /// no larger errors.
    ///
    /// Rounding then moves a root by less than half of the leaf's slack, and a hit at a border is
    /// within [`BORDER_REACH`] times that; the distance returned is twice as much.
    #[inline(always)]
    pub(crate) fn near_border(&self, piece: &Piece, side: RectSide) -> Option<f64> {
        let [from, to] = self.rect()[side.fixed()];
        let reach = 2.0 * BORDER_REACH * (0.5 * LEAF_SLACK) * (to - from);
        let distance = if side.is_last() { 1.0 - to } else { from };
        (piece.is_border(side) && distance <= reach).then_some(reach)
    }

    /// Whether the leaf ends in a pole, near which its certificate has conditions of its own.
    #[inline(always)]
    pub(crate) fn has_pole(&self) -> bool {
        self.certificate.pole_per_error() > 0.0
    }

    /// Whether a tangent may be so short that the fast sums lose digits of it: in a leaf that ends in
    /// a pole, and near a pole where tangents vanish faster than the distance from it, as where two
    /// rows of control points are one point.
    #[inline(always)]
    pub(crate) fn has_short_tangents(&self) -> bool {
        self.marks & SHORT_TANGENTS != 0
    }

    /// The approximation's numerators: coefficients of `xⁱ yʲ`, at `4 i + j`, coordinate by
    /// coordinate.
    #[inline(always)]
    pub(crate) fn fit(&self) -> &Fit {
        &self.fit
    }

    /// The approximation's second derivatives in the middle, by box coordinates: `xx`, `xy`, `yy`.
    #[inline(always)]
    pub(crate) fn second_derivatives(&self, weight: Option<&WeightFit>) -> [DVec3; 3] {
        let Some(weight) = weight else {
            return [2.0 * term(&self.fit, 8), term(&self.fit, 5), 2.0 * term(&self.fit, 2)];
        };
        let term = |m: usize| term(&self.fit, m).extend(f64::from(weight[m]));
        second_derivatives([term(4), term(1)], [term(8), term(5), term(2)])
    }

    /// The error bound of `F`, the distances times the weight: see [`FitError`].
    #[inline(always)]
    pub(crate) fn fit_error(&self) -> f32 {
        self.fit_error.value()
    }

    /// The error bound of either partial derivative of `F`.
    #[inline(always)]
    pub(crate) fn slope_error(&self) -> f32 {
        self.slope_error.value()
    }

    /// `M` of [`FitError`].
    #[inline(always)]
    pub(crate) fn fit_bend(&self) -> f32 {
        self.fit_bend.value()
    }

    /// `T` of [`FitError`].
    #[inline(always)]
    pub(crate) fn fit_third(&self) -> f64 {
        // Exact; in f32 it might be rounded down to nothing.
        f64::from(self.fit_third.value()) * f64::from(self.fit_bend())
    }

    /// An upper bound of the ratio of the distance between two places, where the approximation's
    /// bounds hold ([`FIT_DOMAIN`](crate::patch::FIT_DOMAIN)), to that between the surface's points
    /// there; box coordinates are multiplied by [`Self::half_side_lengths`]. Infinite where nothing
    /// is known. Of polynomials, it is finite only where the terms of tangents add up to at most
    /// twice their lengths in the middle.
    #[inline(always)]
    pub(crate) fn stretch(&self) -> f32 {
        self.stretch.value()
    }

    /// The approximate lengths of the half sides in `x` and `y`.
    pub(crate) fn half_side_lengths(&self) -> [f32; 2] {
        [4, 1].map(|k| {
            // In f64: squares of tiny leaves vanish in f32.
            let [x, y, z] = [0, 1, 2].map(|axis| f64::from(self.fit[axis][k]));
            (x * x + y * y + z * z).sqrt() as f32
        })
    }
}

/// Leaves whose [`FitError::bend`] is no larger than this fraction of their half sides count as
/// parallelograms.
const MOST_BEND_OF_PARALLELOGRAM: f64 = 1e-6;

/// Tangents are short that are no longer than this part of the piece's longest: they are sums that
/// cancel, and have three digits less.
const SHORT: f64 = 1e-3;

/// Whether a tangent in a part of a piece with a collapsed side, by the vectors across its middle, is
/// [`SHORT`].
fn are_short(chords: [DVec3; 2], rect: DyadicRect, piece: &Piece) -> bool {
    if piece.collapsed_sides().next().is_none() {
        return false;
    }
    let sides = rect.ranges().map(|[from, to]| to - from);
    let longest = piece.patch.longest_tangents();
    (0..2).any(|k| chords[k].length() <= SHORT * sides[k] * longest[k])
}

/// The marks of leaves: see [`Leaf::is_trimmed`], [`Leaf::is_parallelogram`],
/// [`Leaf::is_at_border`], [`Leaf::is_biquadratic`] and [`Leaf::has_short_tangents`].
const TRIMMED: u8 = 1;
const PARALLELOGRAM: u8 = 2;
const AT_BORDER: u8 = 4;
const BIQUADRATIC: u8 = 8;
const SHORT_TANGENTS: u8 = 16;

/// One coefficient of an approximation.
fn term(fit: &Fit, m: usize) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|axis| f64::from(fit[axis][m])))
}

/// The collapsed side of a piece that a rectangle touches.
fn collapsed_side(rect: DyadicRect, piece: &Piece) -> Option<RectSide> {
    let ranges = rect.ranges();
    let ends_there = |side: &RectSide| side.is_reached_by(&ranges);
    RectSide::ALL.into_iter().filter(|side| piece.is_collapsed(*side)).find(ends_there)
}

const _: () = assert!(size_of::<Leaf>() == 256);
