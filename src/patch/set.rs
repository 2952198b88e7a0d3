//! All pieces and leaves of a list of surfaces.

use std::ops::Range;

use glam::DVec4;
use rayon::prelude::*;
use thiserror::Error;

use super::leaf::Part;
use super::{Leaf, Piece, TensorPatch, piece};
use crate::geometry::{KnotVector, NurbsSurface};
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
#[derive(Clone, Debug, Default)]
pub struct PatchSet {
    pieces: Vec<Piece>,
    leaves: Vec<Leaf>,
    /// Where the pieces of each surface are.
    pieces_of: Vec<Range<usize>>,
}

impl PatchSet {
    /// Cuts surfaces into pieces and leaves.
    ///
    /// # Errors
    /// When there are more than 32-bit indices can count.
    pub fn new(surfaces: &[NurbsSurface]) -> Result<Self, PatchSetError> {
        check_count("surfaces", surfaces.len())?;
        let cut: Vec<Vec<Piece>> =
            surfaces.par_iter().enumerate().map(|(k, surface)| pieces(surface, k as u32)).collect();
        let mut pieces_of = Vec::with_capacity(cut.len());
        let mut start = 0;
        for some in &cut {
            pieces_of.push(start..start + some.len());
            start += some.len();
        }
        let pieces: Vec<Piece> = cut.into_iter().flatten().collect();
        check_count("Bézier pieces", pieces.len())?;
        let leaves = leaves(&pieces);
        check_count("leaves", leaves.len())?;
        Ok(Self { pieces, leaves, pieces_of })
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
        self.leaves.iter().fold(Aabb::EMPTY, |bounds, leaf| bounds.union(leaf.bounds))
    }

    /// The memory held, in bytes.
    pub fn bytes(&self) -> usize {
        let control: usize = self.pieces.iter().map(|piece| piece.patch.control().len()).sum();
        size_of_val(&self.pieces[..])
            + control * size_of::<DVec4>()
            + size_of_val(&self.leaves[..])
            + size_of_val(&self.pieces_of[..])
    }
}

fn check_count(what: &'static str, count: usize) -> Result<(), PatchSetError> {
    let limit = u32::MAX as usize / 2;
    if count > limit { Err(PatchSetError::TooMany { what, count, limit }) } else { Ok(()) }
}

/// The Bézier pieces of a surface, by knot insertion to full multiplicity: neighbours get
/// the same control points on the edge they share.
fn pieces(surface: &NurbsSurface, index: u32) -> Vec<Piece> {
    let bezier = surface.bezier_form();
    let (_, nv) = bezier.size();
    let (knots_u, knots_v) = (bezier.knots_u(), bezier.knots_v());
    let degree = [knots_u.degree(), knots_v.degree()];
    let [p, q] = degree;

    let mut pieces = Vec::new();
    for u in knots_u.spans() {
        for v in knots_v.spans() {
            let rows = u.index - p..=u.index;
            let columns = |i: usize| i * nv + v.index - q..=i * nv + v.index;
            let control = rows.flat_map(|i| bezier.control()[columns(i)].iter().copied());
            let patch = TensorPatch::new(degree, control.collect());
            let collapsed = piece::collapsed(&patch);
            let border = [
                is_border(knots_u, u.start),
                is_border(knots_u, u.end),
                is_border(knots_v, v.start),
                is_border(knots_v, v.end),
            ];
            let domain = [[u.start, u.end], [v.start, v.end]];
            let jump_at_end = [jumps(knots_u, u.end), jumps(knots_v, v.end)];
            let surface = index;
            pieces.push(Piece { patch, surface, domain, border, jump_at_end, collapsed });
        }
    }
    pieces
}

/// Whether the surface ends, or may jump, at a knot.
fn is_border(knots: &KnotVector, t: f64) -> bool {
    let (start, end) = knots.domain();
    t == start || t == end || jumps(knots, t)
}

/// Whether the surface may jump at a knot inside the domain.
fn jumps(knots: &KnotVector, t: f64) -> bool {
    let (start, end) = knots.domain();
    start < t && t < end && knots.multiplicity(t) > knots.degree()
}

/// The leaves of all pieces: as flat as their number allows.
fn leaves(pieces: &[Piece]) -> Vec<Leaf> {
    let mut parts: Vec<Vec<Part>> = Vec::new();
    for flatness in FLATNESS {
        let flattened: Vec<Vec<Part>> = if parts.is_empty() {
            let whole = pieces.par_iter().map(|piece| {
                let mut done = Vec::new();
                Part::whole(piece).flattened(piece, flatness, &mut done);
                done
            });
            whole.collect()
        } else {
            let finer = parts.par_iter().zip(pieces).map(|(parts, piece)| {
                let mut done = Vec::new();
                for part in parts {
                    part.clone().flattened(piece, flatness, &mut done);
                }
                done
            });
            finer.collect()
        };
        let count: usize = flattened.iter().map(Vec::len).sum();
        if !parts.is_empty() && count * size_of::<Leaf>() > WORTHWHILE_BYTES {
            break;
        }
        parts = flattened;
    }
    let leaves =
        parts.into_par_iter().zip(pieces).enumerate().flat_map_iter(|(k, (parts, piece))| {
            parts.into_iter().map(move |part| part.into_leaf(k as u32, piece))
        });
    leaves.collect()
}
