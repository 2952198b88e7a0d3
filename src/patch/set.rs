//! All pieces and leaves of a list of surfaces.

use std::ops::Range;
use std::sync::Arc;

use glam::{DVec3, DVec4};
use rayon::prelude::*;
use thiserror::Error;

use super::leaf::Part;
use super::{Leaf, Piece, TensorPatch, piece};
use crate::geometry::{Chart, ChartMap, Charts, KnotVector};
use crate::math::Aabb;

/// How flat leaves are tried to be, from coarse to fine: see `Part::direction_to_halve`.
///
/// Flatter leaves need fewer Newton steps, fit their boxes better and are certified for
/// more rays; but there are more of them. Measured on sphere, teapot and height fields,
/// the work a ray stops falling at about 0.06, and rises where leaves leave the cache.
const FLATNESS: [f64; 4] = [0.5, 0.25, 0.12, 0.06];

/// Finer leaves are made only while all of them take no more than this: about the size of
/// a second-level cache.
const WORTHWHILE_BYTES: usize = 4 << 20;

/// Why surfaces cannot be cut into pieces.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum PatchSetError {
    /// There are more than 32-bit indices can count.
    #[error("{count} {what}, but at most {limit} can be traced")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many were found.
        count: usize,
        /// How many are possible.
        limit: usize,
    },
}

/// Surfaces cut into Bézier pieces, and those into leaves; both in the order of the
/// surfaces, whatever the number of threads.
#[derive(Clone, Debug)]
pub struct PatchSet {
    pieces: Vec<Piece>,
    leaves: Vec<Leaf>,
    /// Holds every surface, but for rounding.
    bounds: Aabb,
    /// The number of control points in the surfaces' nets.
    points: usize,
    /// Where the pieces of each surface are.
    pieces_of: Vec<Range<usize>>,
}

impl PatchSet {
    /// Cuts surfaces into pieces and leaves; also returns a box around each leaf, for a
    /// hierarchy.
    ///
    /// # Errors
    /// When there are more than 32-bit indices can count.
    pub fn new<S: Charts + Sync>(surfaces: &[S]) -> Result<(Self, Vec<Aabb>), PatchSetError> {
        check_count("surfaces", surfaces.len())?;
        let cut: Vec<(Vec<Piece>, usize)> =
            surfaces.par_iter().enumerate().map(|(k, surface)| pieces(surface, k as u32)).collect();
        let points = cut.iter().map(|(_, points)| points).sum();
        let mut pieces_of = Vec::with_capacity(cut.len());
        let mut start = 0;
        for (some, _) in &cut {
            pieces_of.push(start..start + some.len());
            start += some.len();
        }
        let pieces: Vec<Piece> = cut.into_iter().flat_map(|(pieces, _)| pieces).collect();
        check_count("Bézier pieces", pieces.len())?;
        let (leaves, boxes) = leaves(&pieces);
        check_count("leaves", leaves.len())?;
        let bounds = boxes.iter().fold(Aabb::EMPTY, |bounds, &leaf| bounds.union(leaf));
        Ok((Self { pieces, leaves, bounds, points, pieces_of }, boxes))
    }

    /// The pieces, surface by surface.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The leaves, piece by piece.
    pub fn leaves(&self) -> &[Leaf] {
        &self.leaves
    }

    /// The number of surfaces.
    pub fn surface_count(&self) -> usize {
        self.pieces_of.len()
    }

    /// Which pieces a surface was cut into.
    pub fn pieces_of(&self, surface: usize) -> Range<usize> {
        self.pieces_of[surface].clone()
    }

    /// Holds every surface, but for rounding.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// The memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let collapsed = self.pieces.iter().filter(|piece| piece.collapsed.is_some()).count();
        let mapped = self.pieces.iter().filter(|piece| piece.map.is_some()).count();
        size_of_val(&self.pieces[..])
            + collapsed * size_of::<[Option<DVec3>; 4]>()
            + mapped * size_of::<ChartMap>()
            + self.points * size_of::<DVec4>()
            + size_of_val(&self.leaves[..])
            + size_of_val(&self.pieces_of[..])
    }
}

fn check_count(what: &'static str, count: usize) -> Result<(), PatchSetError> {
    let limit = u32::MAX as usize / 2;
    if count > limit { Err(PatchSetError::TooMany { what, count, limit }) } else { Ok(()) }
}

/// The Bézier pieces of a surface, chart by chart. Also returns the size of their nets.
fn pieces(surface: &impl Charts, index: u32) -> (Vec<Piece>, usize) {
    let mut pieces = Vec::new();
    let points = surface.charts().iter().map(|chart| cut(chart, index, &mut pieces)).sum();
    (pieces, points)
}

/// Cuts a chart into Bézier pieces, by knot insertion to full multiplicity: neighbours get the
/// same control points on the edge they share. Returns the size of their net.
fn cut(chart: &Chart<'_>, index: u32, pieces: &mut Vec<Piece>) -> usize {
    let bezier = chart.surface.bezier_form();
    let (_, nv) = bezier.size();
    let knots = [bezier.knots_u(), bezier.knots_v()];
    let degree = knots.map(KnotVector::degree);
    let [p, q] = degree;
    let map = match chart.map {
        ChartMap::Identity => None,
        ChartMap::Bilinear(_) => Some(Box::new(chart.map)),
    };

    let net: Arc<[DVec4]> = bezier.control().into();
    for u in knots[0].spans() {
        for v in knots[1].spans() {
            let patch = TensorPatch::new(degree, (&net, nv), [u.index - p, v.index - q]);
            let collapsed = piece::collapsed(&patch);
            let domain = [[u.start, u.end], [v.start, v.end]];
            let border = [0, 1, 2, 3].map(|side| {
                let (knots, t) = (knots[side / 2], domain[side / 2][side % 2]);
                let (start, end) = knots.domain();
                let ends = t == [start, end][side % 2];
                if ends { chart.border[side] } else { jumps(knots, t) }
            });
            let open_end = [0, 1].map(|k| {
                let (knots, end) = (knots[k], domain[k][1]);
                if end == knots.domain().1 { chart.open_end[k] } else { jumps(knots, end) }
            });
            let (surface, map) = (index, map.clone());
            pieces.push(Piece { patch, surface, domain, map, border, open_end, collapsed });
        }
    }
    net.len()
}

/// Whether the surface may jump at a knot inside the domain.
fn jumps(knots: &KnotVector, t: f64) -> bool {
    let (start, end) = knots.domain();
    start < t && t < end && knots.multiplicity(t) > knots.degree()
}

/// The leaves of all pieces, and a box around each: as flat as their number allows.
fn leaves(pieces: &[Piece]) -> (Vec<Leaf>, Vec<Aabb>) {
    let flatness = worthwhile_flatness(pieces);
    let leaves = pieces.par_iter().enumerate().flat_map_iter(|(k, piece)| {
        let mut parts = Vec::new();
        Part::whole(piece).flattened(piece, flatness, &mut |part| parts.push(part));
        parts.into_iter().map(move |part| part.into_leaf(k as u32, piece))
    });
    leaves.unzip()
}

/// The finest flatness whose leaves take no more room than is worthwhile.
fn worthwhile_flatness(pieces: &[Piece]) -> f64 {
    let [mut finest, finer @ ..] = FLATNESS;
    let most = WORTHWHILE_BYTES / size_of::<Leaf>();
    for flatness in finer {
        if pieces.len() > most {
            break;
        }
        let counts = pieces.par_iter().map(|piece| {
            let mut count = 0;
            Part::whole(piece).flattened(piece, flatness, &mut |_| count += 1);
            count
        });
        if counts.sum::<usize>() > most {
            break;
        }
        finest = flatness;
    }
    finest
}
