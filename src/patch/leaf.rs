//! Pieces halved until they are flat enough to search.

use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use super::tangents::{Certificate, CollapsedSide, Net};
use super::tensor::euclidean;
use super::{ControlNet, OrientedBox, Piece};
use crate::math::{Aabb, bernstein, rounding};

/// A leaf answers for roots a little outside its rectangle, by this part of its side, so
/// that a root on the line between two leaves is not lost to rounding in both.
pub const LEAF_SLACK: f64 = 1e-3;

/// A leaf's certificate holds on its rectangle widened by this part of its sides: Newton's
/// steps may stray there. Wider, it would speak of fewer rays.
pub const WIDENING: f64 = 0.02;

/// A piece is not halved more often than this in one direction: 2⁻¹⁶ of a side is small
/// for any surface worth drawing, and a cusp would never become flat.
const MOST_HALVINGS: u32 = 16;

/// A part of a piece that is flat enough to search, with everything the search needs.
#[derive(Clone, Debug)]
pub struct Leaf {
    /// Which piece.
    pub piece: u32,
    /// The part of the piece's unit square: from and to in `s`, then in `t`.
    pub rect: [[f64; 2]; 2],
    /// A close box around all points the leaf answers for.
    pub oriented: OrientedBox,
    /// Which rays meet the leaf at most once.
    pub certificate: Certificate,
    /// Where the leaf ends at a collapsed side of its piece.
    pub collapsed: Option<CollapsedSide>,
}

impl Leaf {
    /// The leaf's rectangle with `part` of its sides added on each side, but for a side that
    /// is collapsed to a point.
    pub fn widened(&self, part: f64) -> [[f64; 2]; 2] {
        let mut rect = self.rect.map(|[from, to]| {
            let more = part * (to - from);
            [from - more, to + more]
        });
        match self.collapsed {
            Some(CollapsedSide::S(end)) => rect[0][end] = end as f64,
            Some(CollapsedSide::T(end)) => rect[1][end] = end as f64,
            None => {}
        }
        rect
    }
}

/// A part of a piece on the way to become a leaf.
#[derive(Clone, Debug)]
pub(super) struct Part {
    rect: [[f64; 2]; 2],
    halvings: [u32; 2],
    net: ControlNet,
}

impl Part {
    /// A whole piece.
    pub(super) fn whole(piece: &Piece) -> Self {
        let net = piece.patch.control().collect();
        Self { rect: [[0.0, 1.0]; 2], halvings: [0; 2], net }
    }

    /// Hands over the parts of this part that are flat to within `flatness`.
    pub(super) fn flattened(self, piece: &Piece, flatness: f64, done: &mut impl FnMut(Self)) {
        match self.direction_to_halve(piece, flatness) {
            None => done(self),
            Some(direction) => {
                let [first, second] = self.halves(piece, direction);
                second.flattened(piece, flatness, done);
                first.flattened(piece, flatness, done);
            }
        }
    }

    /// Where the part bends most, if that is more than `flatness`.
    ///
    /// The measure of a direction is the largest second difference of the control points
    /// along it, times the second derivative's factor, over the longest row's chord: half
    /// the angle by which the rows turn. Twist counts where it leaves the leaf's plane.
    fn direction_to_halve(&self, piece: &Piece, flatness: f64) -> Option<usize> {
        let [p, q] = piece.patch.degree();
        let noise = piece.patch.residual_factor() * piece.patch.magnitude();
        let points: SmallVec<[DVec3; 16]> = self.net.iter().map(|&c| euclidean(c)).collect();
        if Aabb::around(points.iter().copied()).size().max_element() < 1e4 * noise {
            return None; // rounding is all there is left to see
        }
        let rows = [(p, q + 1, q, 1), (q, 1, p, q + 1)];
        let [bend_s, bend_t] = rows.map(|(degree, step, others, other_step)| {
            let row = |k: usize, i: usize| points[k * other_step + i * step];
            let chord = (0..=others).map(|k| row(k, 0).distance(row(k, degree)));
            let longest = chord.fold(noise, f64::max);
            let turns = (0..=others).flat_map(|k| (1..degree).map(move |i| (k, i)));
            let second = turns
                .map(|(k, i)| (row(k, i - 1) - 2.0 * row(k, i) + row(k, i + 1)).length())
                .fold(0.0, f64::max);
            (second * (degree * degree.saturating_sub(1)) as f64 / 2.0 / longest, longest)
        });

        let corner = |i: usize, j: usize| points[i * p * (q + 1) + j * q];
        let twist = corner(0, 0) - corner(0, 1) - corner(1, 0) + corner(1, 1);
        let normal = (corner(1, 1) - corner(0, 0)).cross(corner(0, 1) - corner(1, 0));
        let out_of_plane = twist.dot(normal.normalize_or_zero()).abs();
        let longest = bend_s.1.max(bend_t.1);
        let twist = out_of_plane / longest;

        // Two collapsed sides at the two ends of a direction need a leaf each.
        let both_ends = |at: usize| {
            piece.collapsed(2 * at).is_some()
                && piece.collapsed(2 * at + 1).is_some()
                && self.halvings[at] == 0
        };
        let mut wanted = [bend_s.0.max(twist), bend_t.0.max(twist)];
        for direction in 0..2 {
            if both_ends(direction) {
                wanted[direction] = f64::INFINITY;
            }
            if self.halvings[direction] >= MOST_HALVINGS {
                wanted[direction] = 0.0;
            }
        }
        if twist > flatness && twist >= bend_s.0.max(bend_t.0) && wanted[0] == wanted[1] {
            return Some(usize::from(bend_t.1 > bend_s.1));
        }
        let direction = usize::from(wanted[1] > wanted[0]);
        (wanted[direction] > flatness).then_some(direction)
    }

    fn halves(self, piece: &Piece, direction: usize) -> [Self; 2] {
        let degree = piece.patch.degree();
        let [from, to] = self.rect[direction];
        let middle = 0.5 * (from + to);
        let half = |range: [f64; 2], rect_range: [f64; 2]| {
            let mut part = self.clone();
            part.rect[direction] = rect_range;
            part.halvings[direction] += 1;
            let mut ranges = [[0.0, 1.0]; 2];
            ranges[direction] = range;
            bernstein::restrict_net(&mut part.net, degree, ranges[0], ranges[1]);
            part
        };
        [half([0.0, 0.5], [from, middle]), half([0.5, 1.0], [middle, to])]
    }

    /// The finished leaf, and a box with sides along the axes that holds every point the leaf
    /// answers for, but for rounding.
    pub(super) fn into_leaf(self, index: u32, piece: &Piece) -> (Leaf, Aabb) {
        let degree = piece.patch.degree();
        let noise = piece.patch.residual_factor() * piece.patch.magnitude();
        let collapsed = self.collapsed_side(piece);

        // The leaf answers for its slack, but never beyond the piece.
        let grown = |by: f64, direction: usize, inside: bool| {
            let [from, to] = self.rect[direction];
            let low = if from == 0.0 && inside { 0.0 } else { -by };
            let high = if to == 1.0 && inside { 1.0 } else { 1.0 + by };
            [low, high]
        };
        let mut answered = self.net.clone();
        let slack = LEAF_SLACK;
        bernstein::restrict_net(
            &mut answered,
            degree,
            grown(slack, 0, true),
            grown(slack, 1, true),
        );
        let bounds = Aabb::around(answered.iter().map(|&c| euclidean(c))).grown(noise);
        let chords = self.chords(piece);
        let oriented = OrientedBox::around(&answered, chords, noise);

        // The certificate speaks of the widened rectangle, which ends at a collapsed side.
        let mut ranges = [grown(WIDENING, 0, false), grown(WIDENING, 1, false)];
        match collapsed {
            Some(CollapsedSide::S(end)) => ranges[0][end] = end as f64,
            Some(CollapsedSide::T(end)) => ranges[1][end] = end as f64,
            None => {}
        }
        let mut widened = self.net.clone();
        bernstein::restrict_net(&mut widened, degree, ranges[0], ranges[1]);
        // Parameters are known to half a unit in the last place of one.
        let sides = self.rect.map(|[from, to]| to - from);
        let spacing = rounding::UNIT_ROUNDOFF / sides[0].min(sides[1]);
        let net = Net { degree, control: &widened, noise, spacing };
        let certificate = Certificate::new(&net, collapsed)
            .unwrap_or_else(|| Certificate::none(chords[0].cross(chords[1]).normalize_or_zero()));
        (Leaf { piece: index, rect: self.rect, oriented, certificate, collapsed }, bounds)
    }

    fn collapsed_side(&self, piece: &Piece) -> Option<CollapsedSide> {
        let touches = |side: CollapsedSide| match side {
            CollapsedSide::S(end) => self.rect[0][end] == end as f64,
            CollapsedSide::T(end) => self.rect[1][end] == end as f64,
        };
        piece.collapsed_sides().map(|(side, _)| side).find(|&side| touches(side))
    }

    /// The vectors across the middle of the part, in `s` and in `t`.
    fn chords(&self, piece: &Piece) -> [DVec3; 2] {
        let [s, t] = self.rect;
        let (ms, mt) = (0.5 * (s[0] + s[1]), 0.5 * (t[0] + t[1]));
        let at = |s: f64, t: f64| piece.patch.point(DVec2::new(s, t));
        [at(s[1], mt) - at(s[0], mt), at(ms, t[1]) - at(ms, t[0])]
    }
}
