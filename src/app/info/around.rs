//! Which way an edge runs around its surface.

use glam::{DVec2, DVec3};
use nurbray::geometry::SurfaceDerivatives;
use nurbray::geometry::trim::{Side, Trims};

/// Edges that meet have about the same tangent, or the opposite one: the cosine between them is at
/// least this in absolute value. Where it is not, one of them has a cusp, or no tangent.
const PARALLEL: f64 = 0.9;

/// A vector leads straight over a surface if the cosine between it and the surface's own direction
/// is more than this. Ends of a surface that overlap a little, and lie one above the other, have a
/// gap.
const STRAIGHT: f64 = 0.9;

/// Surfaces that leave an edge at a smaller angle, in radians, lie on each other. Their directions
/// are known to a few roundings, more where u and v are askew.
const COINCIDENT: f64 = 1e-6;

/// The first distance from a trim curve at which its two sides are looked at, as a part of the
/// largest parameter: a few of its error bounds. Each further one is [`FARTHER`] times as large.
const BESIDE: f64 = 1e-14;

const FARTHER: f64 = 8.0;

/// The last such distance, as a part of the domain: farther off there may be other curves.
const FARTHEST: f64 = 1e-4;

/// A point of an edge, which is run through with the surface on the left, as seen from the tip of
/// the normal `S_u × S_v`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    /// The unit vector along the edge.
    along: DVec3,
    /// The unit vector into the surface, across the edge.
    inward: DVec3,
}

/// How two surfaces that meet in an edge are turned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Turn {
    /// Their normals point to the same side of what the two are together.
    Alike,
    /// To opposite sides.
    Opposite,
}

impl Around {
    /// The point of a surface with these derivatives, where the edge runs along this vector in
    /// (u, v). Without a direction where a derivative vanishes.
    pub(super) fn new(at: &SurfaceDerivatives, along: DVec2) -> Self {
        let of = |uv: DVec2| uv.x * at.du + uv.y * at.dv;
        let (tangent, inside) = (of(along).normalize(), of(along.perp()));
        let across = inside - inside.dot(tangent) * tangent;
        Self { along: tangent, inward: across.normalize() }
    }

    /// Whether a vector from the point leads straight over the surface, to first order; false if
    /// that is not known.
    pub(super) fn is_inward(&self, way: DVec3) -> bool {
        self.inward.dot(way) > STRAIGHT * way.length()
    }

    /// How the surfaces of two edges are turned that meet at this point: alike if the edges run
    /// against each other, at any angle between the surfaces. `None` if the edges are not parallel
    /// or have no direction, and for surfaces that lie on each other: copies of one are as they
    /// are.
    pub(super) fn turn(&self, other: &Self) -> Option<Turn> {
        let cosine = self.along.dot(other.along);
        if cosine <= -PARALLEL {
            return Some(Turn::Alike);
        }
        let apart = self.inward.distance(other.inward) > COINCIDENT; // false for NaN
        (cosine >= PARALLEL && apart).then_some(Turn::Opposite)
    }
}

/// The vector along a trim curve, or the opposite one, that has what is kept on its left. `None`
/// if both sides are kept, or none is, or it cannot be told.
pub(super) fn with_kept_on_left(trims: &Trims, [uv, along]: [DVec2; 2]) -> Option<DVec2> {
    // In units of the domain, so that steps in u and in v are alike.
    let domain = trims.domain().bounds();
    let size = domain.size();
    let left = (along / size).perp().normalize() * size;
    let largest = (domain.min.abs().max(domain.max.abs()) / size).max_element();
    let mut step = BESIDE * largest;
    while step <= FARTHEST {
        let sides = [1.0, -1.0].map(|sign| trims.side_of(uv + sign * step * left));
        match sides {
            [Side::Inside, Side::Outside] => return Some(along),
            [Side::Outside, Side::Inside] => return Some(-along),
            [Side::Edge { .. }, _] | [_, Side::Edge { .. }] => step *= FARTHER,
            _ => return None,
        }
    }
    None
}
