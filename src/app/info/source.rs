//! What borders and trim edges are made from.

use std::sync::Arc;

use glam::{DVec2, DVec3};
use nurbray::geometry::{
    KnotVector, NurbsCurve, NurbsSurface, TrianglePatch, TriangleSide, TrimEdge, TrimmedSurface,
};

use super::super::border::Border;
use super::around::{Around, with_kept_on_left};

/// What a curve is made from.
#[derive(Debug)]
pub(super) enum Source<'a> {
    /// A border of a surface, and the ranges of its parameter where trims keep it.
    Border {
        surface: &'a NurbsSurface,
        border: Border,
        kept: Vec<[f64; 2]>,
        /// The border alone, where it is simpler than the surface.
        row: Option<NurbsCurve>,
    },
    /// A side of a triangle.
    Side { patch: &'a TrianglePatch, side: TriangleSide, curve: NurbsCurve },
    /// A part of a trim edge between two corners.
    Edge { trimmed: &'a TrimmedSurface, edge: Arc<TrimEdge> },
}

impl Source<'_> {
    /// The parts of a range of its parameter on which it is smooth, in order.
    pub(super) fn spans(&self, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
        let of_knots = |knots: &KnotVector| -> Vec<[f64; 2]> {
            knots.spans_between(from, to).map(|span| [span.start, span.end]).collect()
        };
        let spans = match self {
            Self::Border { surface, border, .. } => of_knots(border.knots(surface)),
            Self::Side { curve, .. } => of_knots(curve.knots()),
            Self::Edge { edge, .. } => {
                // Each is of length 1.
                let first = from.max(0.0) as usize;
                edge.spans().skip(first).take_while(|span| span[0] < to).collect()
            }
        };
        let within = spans.into_iter().map(|[start, end]| [start.max(from), end.min(to)]);
        within.filter(|[start, end]| start < end).collect()
    }

    pub(super) fn point(&self, t: f64) -> DVec3 {
        match self {
            Self::Border { surface, border, .. } => border.point(surface, t),
            Self::Side { curve, .. } => curve.point_at(t),
            Self::Edge { edge, .. } => edge.point_at(t),
        }
    }

    /// The point at `t`, and its derivative.
    pub(super) fn tangent(&self, t: f64) -> (DVec3, DVec3) {
        let curve = match self {
            Self::Border { surface, border, row: None, .. } => return border.tangent(surface, t),
            Self::Border { row: Some(row), .. } => row,
            Self::Side { curve, .. } => curve,
            Self::Edge { edge, .. } => return edge.tangent_at(t).into(),
        };
        let at = curve.derivatives(t);
        (at.point, at.first)
    }

    /// The part of a range of its parameter where the surface ends there, in order.
    pub(super) fn kept_within(&self, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
        let Self::Border { kept, .. } = self else { return vec![[from, to]] };
        let within = kept.iter().map(|&[start, end]| [start.max(from), end.min(to)]);
        within.filter(|[start, end]| start < end).collect()
    }

    /// Whether the surface ends at this curve's point at `t`.
    pub(super) fn keeps(&self, t: f64) -> bool {
        let Self::Border { kept, .. } = self else { return true };
        kept.iter().any(|&[from, to]| from <= t && t <= to)
    }

    /// Which way the curve runs around the surface at `t`; `None` where that cannot be told.
    pub(super) fn around(&self, t: f64) -> Option<Around> {
        Some(match self {
            Self::Border { surface, border, .. } => {
                Around::new(&surface.derivatives(border.uv(t)), border.around(surface))
            }
            Self::Side { patch, side, .. } => {
                let (uv, along) = match side {
                    TriangleSide::U => (DVec2::new(0.0, t), DVec2::NEG_Y),
                    TriangleSide::V => (DVec2::new(t, 0.0), DVec2::X),
                    TriangleSide::W => (DVec2::new(t, 1.0 - t), DVec2::new(-1.0, 1.0)),
                };
                Around::new(&patch.derivatives(uv), along)
            }
            Self::Edge { trimmed, edge } => {
                let place = edge.uv_at(t);
                let along = with_kept_on_left(trimmed.trims(), place)?;
                Around::new(&trimmed.surface().derivatives(place[0]), along)
            }
        })
    }
}
