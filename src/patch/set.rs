//! All pieces and leaves of a list of surfaces.

use std::ops::Range;
use std::sync::Arc;

use rayon::prelude::*;
use thiserror::Error;

use super::leaves::parts;
use super::net::{ChartNet, Keeping};
use super::tiles::Grid;
use super::{GroupedParts, Piece};
use crate::geometry::{Chart, Charts};
use crate::math::Aabb;

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

/// Surfaces cut into Bézier pieces, in the order of the surfaces, whatever the number of
/// threads.
#[derive(Clone, Debug)]
pub struct PatchSet {
    pieces: Vec<Piece>,
    /// Holds every surface, but for rounding.
    bounds: Aabb,
    /// The memory held by the nets of each surface, in bytes.
    net_bytes: Vec<usize>,
    /// Where the pieces of each surface are.
    pieces_of: Vec<Range<usize>>,
}

impl PatchSet {
    /// Cuts surfaces into pieces; also returns the parts of pieces that are to be leaves, group by group.
    ///
    /// # Errors
    /// When there are more than 32-bit indices can count.
    pub fn new<S: Charts + Sync>(surfaces: &[S]) -> Result<(Self, GroupedParts), PatchSetError> {
        check_count("surfaces", surfaces.len())?;
        let charts: Vec<Vec<Chart<'_>>> = surfaces.par_iter().map(Charts::charts).collect();
        let keeping = Keeping::of(charts.iter().flatten());
        let nets: Vec<Vec<_>> =
            charts.into_par_iter().map(|charts| nets(&charts, keeping)).collect();
        let count = |(_, [u, v]): &(_, [Vec<u32>; 2])| u.len() * v.len();
        let counts = nets.iter().map(|charts| charts.iter().map(count).sum::<usize>());
        let count_of_pieces = counts.clone().sum();
        check_count("Bézier pieces", count_of_pieces)?;
        let bytes = |charts: &Vec<(ChartNet, _)>| charts.iter().map(|(net, _)| net.bytes()).sum();
        let net_bytes = nets.iter().map(bytes).collect();
        let mut end = 0;
        let pieces_of = counts.map(|count| {
            end += count;
            end - count..end
        });
        let pieces_of = pieces_of.collect();
        let charts = (0u32..).zip(nets).flat_map(|(k, nets)| nets.into_iter().map(move |n| (k, n)));
        let mut pieces = Vec::with_capacity(count_of_pieces);
        let mut grids = Vec::new();
        for (surface, (net, [rows, columns])) in charts {
            let net = Arc::new(net);
            grids.push(Grid { first: pieces.len(), rows: rows.len(), columns: columns.len() });
            let indices = (0..rows.len() * columns.len()).into_par_iter();
            pieces.par_extend(indices.map(|k| {
                let first = [rows[k / columns.len()], columns[k % columns.len()]];
                Piece::new(&net, surface, first)
            }));
        }
        let parts = parts(&pieces, &grids);
        check_count("leaves", parts.all().len())?;
        let bounds = parts.all().iter().fold(Aabb::EMPTY, |bounds, part| bounds.union(part.bounds));
        Ok((Self { pieces, bounds, net_bytes, pieces_of }, parts))
    }

    /// The pieces, surface by surface.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
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
        let surfaces = (0..self.surface_count()).map(|surface| self.bytes_of(surface));
        surfaces.sum::<usize>()
            + size_of_val(&self.pieces_of[..])
            + size_of_val(&self.net_bytes[..])
    }

    /// The part of it that a surface takes: its control points, trims and pieces.
    pub fn bytes_of(&self, surface: usize) -> usize {
        self.net_bytes[surface] + size_of_val(&self.pieces[self.pieces_of(surface)])
    }
}

fn check_count(what: &'static str, count: usize) -> Result<(), PatchSetError> {
    let limit = u32::MAX as usize / 4; // two bits say what a number counts
    if count > limit { Err(PatchSetError::TooMany { what, count, limit }) } else { Ok(()) }
}

/// The charts of a surface cut into pieces, and the rows and columns in which those begin.
fn nets(charts: &[Chart<'_>], keeping: Keeping) -> Vec<(ChartNet, [Vec<u32>; 2])> {
    charts.par_iter().map(|chart| ChartNet::new(chart, keeping)).collect()
}
