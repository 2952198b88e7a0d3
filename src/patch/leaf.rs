//! What is kept of a part of a piece, to search it.

use glam::DVec3;

use super::fit::{Approximation, Fit, NO_WEIGHT, Quotient, WeightFit};
use super::oriented_box::Axes;
use super::part::Halving;
use super::rounded::{Up8, Up16};
use super::tangents::Net;
use super::{
    Certificate, CollapsedSide, DyadicRect, FIT_DOMAIN, OrientedBox, Part, Piece, SceneFrame,
};
use crate::math::{prefetch, rounding};

/// A leaf answers for roots a little outside its rectangle, by this part of its side, so
/// that a root on the line between two leaves is not lost to rounding in both.
pub const LEAF_SLACK: f64 = 1e-3;

/// A leaf's certificate holds on its rectangle widened by this part of its sides: Newton's
/// steps may stray there. Wider, it would speak of fewer rays.
pub const WIDENING: f64 = 0.02;

/// A part of a piece that is flat enough to search, in the common form that all leaves have,
/// whatever the degree: four cache lines.
///
/// In *box coordinates* from −1 to 1, `x` and `y` follow `s` and `t` from one end of the leaf
/// to the other. The surface `S = X / W` is approximated, relative to the leaf's middle and in scene units: its
/// numerators `X` by bicubic polynomials in `x` and `y`, [`fit`](Self::fit), and its weight `W`, which is 1 in the
/// middle, by another one. A leaf of a piece whose weights are alike has none: `W` is 1. Those of others, their
/// [`WeightFit`]s, are kept elsewhere, as is the leaf's [`OrientedBox`], beside those of its neighbours in space.
///
/// The distances of a plane through a ray from all points, `n · (S − o)`, have the roots of
/// `F = n · X + (n · (c − o)) W`, with the leaf's middle `c`: sums of the coefficients. They give Newton's iteration
/// a start; and since what they are off by is bounded ([`FitError`](super::FitError)) for rays that meet the leaf's
/// box, they can prove of one ray that a part of the leaf holds one root at most, or none.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Leaf {
    fit: Fit,
    /// What the approximation is relative to: its own value in the middle, off the surface by
    /// [`fit_error`](Self::fit_error) at most.
    pub middle: DVec3,
    rect: DyadicRect,
    /// Which piece.
    pub piece: u32,
    /// Which rays meet the leaf at most once.
    pub certificate: Certificate,
    fit_error: Up16,
    slope_error: Up16,
    fit_bend: Up16,
    /// `T / M`, with `M` as kept in `fit_bend`.
    fit_third: Up8,
    stretch: Up16,
    trimmed: bool,
}

impl Leaf {
    /// The leaf of a part, its weight, and the close box around all points it answers for.
    pub fn new(part: &Part, piece: &Piece, frame: &SceneFrame) -> (Self, WeightFit, OrientedBox) {
        let halving = Halving::over(piece, part.rect);
        let collapsed = collapsed_side(part.rect, piece);
        let Approximation { mut middle, mut fit, chords, mut error } =
            Approximation::new(&halving, piece);
        let stretch = Up16::above(stretch(&fit, error.slope));
        let axes = Axes::along(chords);
        let noise = piece.patch.noise();
        let oriented = OrientedBox::around(&halving.answered(piece), &axes, noise, frame);
        let mut weights = NO_WEIGHT;
        if let Some(quotient) = Quotient::new(&halving, piece) {
            let reach = oriented.farthest_from(quotient.middle, frame);
            if let Some(known) = quotient.approximation(reach, &error) {
                middle = quotient.middle;
                (fit, weights, error) = known;
            }
        }

        let widened = halving.widened(piece, collapsed);
        let (degree, rational) = (piece.patch.degree(), piece.patch.is_rational());
        // Parameters are known to half a unit in the last place of one.
        let spacing = part.rect.ranges().map(|[from, to]| rounding::UNIT_ROUNDOFF / (to - from));
        let net = Net { degree, control: &widened, noise, rational, spacing };
        let certificate = Certificate::new(&net, collapsed, &axes, &oriented);
        let fit_bend = Up16::above(error.bend);
        let leaf = Self {
            fit,
            middle,
            rect: part.rect,
            piece: part.piece,
            certificate,
            fit_error: Up16::above(error.value),
            slope_error: Up16::above(error.slope),
            fit_bend,
            fit_third: Up8::above(error.third / f64::from(fit_bend.value())),
            stretch,
            trimmed: part.trimmed,
        };
        (leaf, weights, oriented)
    }

    /// Asks for every cache line, for those who will want them soon.
    #[inline(always)]
    pub(crate) fn prefetch(&self) {
        self.fit.iter().for_each(prefetch);
        prefetch(&self.piece);
    }

    /// The part of the piece's unit square: from and to in `s`, then in `t`.
    #[inline(always)]
    pub fn rect(&self) -> [[f64; 2]; 2] {
        self.rect.ranges()
    }

    /// The same, as a number that leaves of a piece can be put in order by.
    pub fn place(&self) -> DyadicRect {
        self.rect
    }

    /// The leaf's rectangle with `part` of its sides added on each side, but for a side that
    /// is collapsed to a point.
    #[inline(always)]
    pub fn widened(&self, piece: &Piece, part: f64) -> [[f64; 2]; 2] {
        let mut rect = self.rect().map(|[from, to]| {
            let more = part * (to - from);
            [from - more, to + more]
        });
        if let Some(side) = self.collapsed(piece) {
            side.end_at_it(&mut rect);
        }
        rect
    }

    /// Where the leaf ends at a collapsed side of its piece.
    #[inline(always)]
    pub fn collapsed(&self, piece: &Piece) -> Option<CollapsedSide> {
        if self.has_pole() { collapsed_side(self.rect, piece) } else { None }
    }

    /// Where the leaf ends in a point, if it does.
    #[inline(always)]
    pub fn pole(&self, piece: &Piece) -> Option<DVec3> {
        let side = self.collapsed(piece)?;
        piece.collapsed_sides().find(|&(other, _)| other == side).map(|(_, point)| point)
    }

    /// Whether a trim curve passes through, so that hits must be asked for their side of it;
    /// else all of what the leaf answers for is there.
    #[inline(always)]
    pub fn is_trimmed(&self) -> bool {
        self.trimmed
    }

    /// Whether the leaf ends in a pole, near which its certificate has conditions of its own.
    #[inline(always)]
    pub fn has_pole(&self) -> bool {
        self.certificate.pole_per_error() > 0.0
    }

    /// The approximation's numerators: coefficients of `xⁱ yʲ`, at `4 i + j`, coordinate by coordinate.
    #[inline(always)]
    pub fn fit(&self) -> &Fit {
        &self.fit
    }

    /// The approximation's second derivatives in the middle, by box coordinates: `xx`, `xy`, `yy`.
    #[inline(always)]
    pub fn second_derivatives(&self, weights: Option<&WeightFit>) -> [DVec3; 3] {
        let term = |m: usize| DVec3::from_array([0, 1, 2].map(|axis| f64::from(self.fit[axis][m])));
        let [xx, xy, yy] = [2.0 * term(8), term(5), 2.0 * term(2)];
        let Some(weights) = weights else { return [xx, xy, yy] };
        // Of `X / W` where `X` is zero and `W` is 1.
        let [by_x, by_y] = [4, 1].map(|m| f64::from(weights[m]));
        let (along_x, along_y) = (term(4), term(1));
        let mixed = xy - by_x * along_y - by_y * along_x;
        [xx - 2.0 * by_x * along_x, mixed, yy - 2.0 * by_y * along_y]
    }

    /// How far `F`, the distances times the weight, may be off: see [`FitError`](super::FitError).
    #[inline(always)]
    pub fn fit_error(&self) -> f32 {
        self.fit_error.value()
    }

    /// The same of either partial derivative.
    #[inline(always)]
    pub fn slope_error(&self) -> f32 {
        self.slope_error.value()
    }

    /// `M` of [`FitError`](super::FitError).
    #[inline(always)]
    pub fn fit_bend(&self) -> f32 {
        self.fit_bend.value()
    }

    /// `T` of [`FitError`](super::FitError).
    #[inline(always)]
    pub fn fit_third(&self) -> f64 {
        // Exact; in f32 it might be rounded down to nothing.
        f64::from(self.fit_third.value()) * f64::from(self.fit_bend())
    }

    /// How much farther apart two places of the leaf, or a little outside, are at most than their
    /// points in space, where box coordinates are multiplied by [`Self::half_side_lengths`]; infinite
    /// where nothing is known.
    #[inline(always)]
    pub fn stretch(&self) -> f32 {
        self.stretch.value()
    }

    /// The lengths, about, of the half sides in `x` and `y`.
    pub fn half_side_lengths(&self) -> [f32; 2] {
        [4, 1].map(|k| {
            // In f64: squares of tiny leaves vanish in f32.
            let [x, y, z] = [0, 1, 2].map(|axis| f64::from(self.fit[axis][k]));
            (x * x + y * y + z * z).sqrt() as f32
        })
    }
}

/// [`FIT_DOMAIN`]`ᵏ`.
const POWERS: [f64; 6] = {
    let mut powers = [1.0; 6];
    let mut k = 1;
    while k < powers.len() {
        powers[k] = powers[k - 1] * FIT_DOMAIN;
        k += 1;
    }
    powers
};

/// See [`Leaf::stretch`]; `slope_error` is that of [`FitError`](super::FitError).
///
/// With the sides made unit vectors, the tangents in the middle take a vector to one that is not
/// shorter than `√(1 − |cos φ|)` of it, `φ` the angle between them; all other terms of the
/// approximation add no more than their sizes, and the surface the slopes' error.
fn stretch(fit: &Fit, slope_error: f64) -> f64 {
    let term = |i: usize, j: usize| {
        DVec3::from_array([0, 1, 2].map(|axis| f64::from(fit[axis][4 * i + j])))
    };
    let (a, b) = (term(1, 0), term(0, 1));
    let lengths = [a.length(), b.length()];
    let least = (1.0 - (a.dot(b) / (lengths[0] * lengths[1])).abs()).sqrt();
    let mut turning = [slope_error; 2];
    for i in 0..4 {
        for j in (0..4).filter(|j| i + j > 1) {
            let size = term(i, j).length() * POWERS[i + j - 1];
            turning[0] += i as f64 * size;
            turning[1] += j as f64 * size;
        }
    }
    let most = (turning[0] / lengths[0]).hypot(turning[1] / lengths[1]);
    // What rounding does is far less than this; false for NaN.
    let stretches = least - most > 1e-3;
    if stretches { 1.0 / (least - most) } else { f64::INFINITY }
}

/// The collapsed side of a piece that a rectangle touches.
fn collapsed_side(rect: DyadicRect, piece: &Piece) -> Option<CollapsedSide> {
    let ranges = rect.ranges();
    piece.collapsed_sides().map(|(side, _)| side).find(|side| side.is_reached_by(&ranges))
}

const _: () = assert!(size_of::<Leaf>() == 256);
