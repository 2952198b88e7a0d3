//! What trims and borders leave of a surface around a place, and the edges that end there.

use std::f64::consts::{FRAC_PI_2, TAU};

use glam::{DVec2, DVec3};
use smallvec::SmallVec;

use super::reach::trim_reach;
use crate::geometry::RectSide;
use crate::geometry::trim::Sectors;
use crate::patch::{BORDER_REACH, Jet, Piece};

/// Edges that lead from one place are the same if the cosine of their angle is more than this: if
/// they are within 1e-3 of each other.
const ONE_EDGE: f64 = 1.0 - 5e-7;

/// The sectors of directions around a place that neither sides nor trims cut off: angles in the
/// plane of the parameters, from that of growing `u` towards that of growing `v`, from 0 to a full
/// turn. Sectors next to each other may be parts of one.
pub(crate) fn kept_sectors(
    [s0, s1, t0, t1]: [bool; 4],
    trims: Option<&Sectors>,
) -> SmallVec<[[f64; 2]; 8]> {
    let edges = trims.iter().flat_map(|sectors| sectors.edges().iter().copied());
    let quarters = (0..=4).map(|k| f64::from(k) * FRAC_PI_2);
    let mut cuts: SmallVec<[f64; 12]> = quarters.chain(edges).collect();
    cuts.sort_by(f64::total_cmp);
    let is_kept = |&[from, to]: &[f64; 2]| {
        let middle = 0.5 * (from + to);
        let (v, u) = middle.sin_cos();
        let beyond = s0 && u < 0.0 || s1 && u > 0.0 || t0 && v < 0.0 || t1 && v > 0.0;
        from < to && !beyond && trims.is_none_or(|sectors| sectors.keeps(middle))
    };
    cuts.windows(2).map(|pair| [pair[0], pair[1]]).filter(is_kept).collect()
}

/// The unit vector at an angle. Where it is along an axis the other coordinate is exactly zero, for
/// in space it may be multiplied by something large.
pub(crate) fn direction(angle: f64) -> DVec2 {
    let exact = |x: f64| if x.abs() <= 4.0 * f64::EPSILON { 0.0 } else { x };
    DVec2::new(exact(angle.cos()), exact(angle.sin()))
}

/// An edge of a surface that leads away from a place.
#[derive(Clone, Copy, Debug)]
pub(crate) struct EdgeEnd {
    /// The unit vector along it.
    way: DVec3,
    /// Whether the surface lies to the left of this way, as seen against the normal.
    is_left: bool,
}

/// The edges that lead away from a place of a piece, few or none.
pub(crate) type EdgeEnds = SmallVec<[EdgeEnd; 4]>;

/// The edges that lead away from a place: borders of the surface that are near, a mark for each
/// side of the piece, and the edges of trims. None are known at a pole.
pub(crate) fn edges_at(
    piece: &Piece,
    jet: &Jet,
    borders: [bool; 4],
    trims: Option<&Sectors>,
) -> EdgeEnds {
    let lengths = piece.lengths();
    let kept = kept_sectors(borders, trims);
    // One sector begins where another ends, or at an edge.
    let is_inside = |angle: f64, other: usize| {
        kept.iter().any(|sector| sector[other] == angle || (sector[other] - angle).abs() == TAU)
    };
    let mut edges = EdgeEnds::new();
    for &[from, to] in &kept {
        for (angle, other, is_left) in [(from, 1, true), (to, 0, false)] {
            if !is_inside(angle, other) {
                let along = direction(angle) / lengths;
                let way = (along.x * jet.ds + along.y * jet.dt).normalize_or_zero();
                edges.push(EdgeEnd { way, is_left });
            }
        }
    }
    edges
}

/// The edges within `error` of a place: none where trim curves are too many to tell.
pub(super) fn edges_within(piece: &Piece, st: DVec2, jet: &Jet, error: f64) -> EdgeEnds {
    let distances = piece.side_distances(st, jet);
    let near = |side| piece.is_border(side) && distances[side] <= BORDER_REACH * error;
    let borders = RectSide::ALL.map(near);
    let Some(trims) = piece.trims() else { return edges_at(piece, jet, borders, None) };
    let reach = piece.chart_reach(trim_reach(jet, error), 1.0);
    let sectors = trims.around(piece.chart_uv(st), reach);
    sectors.map_or_else(EdgeEnds::new, |sectors| edges_at(piece, jet, borders, Some(&sectors)))
}

impl EdgeEnd {
    fn is_along(&self, other: &Self) -> bool {
        self.way.dot(other.way) > ONE_EDGE
    }

    /// Whether this is the edge of another surface, which lies on its other side.
    pub(crate) fn adjoins(&self, other: &Self) -> bool {
        self.is_along(other) && self.is_left != other.is_left
    }
}

/// How two surfaces that share edges are turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Turn {
    /// Alike: they have each edge on opposite sides, as seen against their normals.
    Alike,
    /// Opposite ways, at some edge.
    Opposite,
    /// They are not known to share an edge: perhaps a vertex only.
    Unknown,
}

impl Turn {
    pub(crate) fn of(some: &[EdgeEnd], others: &[EdgeEnd]) -> Self {
        let pairs = some.iter().flat_map(|a| others.iter().map(move |b| (a, b)));
        let mut turn = Self::Unknown;
        for (a, b) in pairs.filter(|(a, b)| a.is_along(b)) {
            turn = if a.adjoins(b) { Self::Alike } else { return Self::Opposite };
        }
        turn
    }
}
