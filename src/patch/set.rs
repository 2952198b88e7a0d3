//! All pieces of a list of surfaces.

use std::fmt;
use std::num::NonZeroU32;
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};

use rayon::prelude::*;
use thiserror::Error;

use super::leaves::parts;
use super::pieces::apexes;
use super::pieces::chart_grid::ChartGrid;
use super::pieces::chart_net::ChartNet;
use super::pieces::keeping::{Keeping, piece_count};
use super::{GroupedParts, Piece};
use crate::geometry::{Chart, Charts, NurbsSurface};
use crate::math::Aabb;

/// Why surfaces cannot be prepared for tracing.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum BuildError {
    /// There are more than indices can count, or than memory is likely to hold.
    #[error("{count} {what}, but at most {limit} can be traced")]
    TooMany {
        /// What there are too many of.
        what: &'static str,
        /// How many were found.
        count: usize,
        /// How many are possible.
        limit: usize,
    },
}

/// The most that 32-bit indices can count: in a tree, two of their bits say what is counted (the
/// intersector's `ChildCode`).
const MOST_COUNTED: usize = u32::MAX as usize / 4;

/// The most Bézier points of all surfaces together: 2²⁷, or 4 GiB of them. Splines of degrees too
/// high for their own control points to be kept have up to `p q` times as many, so a file of a few
/// megabytes may ask for more memory than there is; the program would then end without a message.
const MOST_BEZIER_POINTS: usize = 1 << 27;

/// Tells the pieces of one set from those of others: hits may outlive the set they were found in,
/// or be mistaken for hits of another. Copies of a set are that set.
///
/// Not zero, so that an absent root takes no more memory than a present one.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) struct SetId(NonZeroU32);

/// Not the number, which depends on what else was made.
impl fmt::Debug for SetId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("SetId")
    }
}

impl SetId {
    /// One that no other set has, unless there were as many sets in between as there are numbers.
    pub(crate) fn unique() -> Self {
        static NEXT: AtomicU32 = AtomicU32::new(1);
        loop {
            if let Some(id) = NonZeroU32::new(NEXT.fetch_add(1, Ordering::Relaxed)) {
                return Self(id);
            }
        }
    }
}

/// Surfaces cut into Bézier pieces, in the order of the surfaces, whatever the number of
/// threads.
#[derive(Clone)]
pub struct PatchSet {
    id: SetId,
    pieces: Vec<Piece>,
    /// A box that holds every surface, except for rounding.
    bounds: Aabb,
    /// The memory held by the nets of each surface, in bytes.
    net_bytes: Vec<usize>,
    /// Where the pieces of each surface are.
    pieces_of: Vec<Range<usize>>,
}

/// Counts only, as the contents may be very long.
impl fmt::Debug for PatchSet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PatchSet")
            .field("surfaces", &self.surface_count())
            .field("pieces", &self.pieces.len())
            .field("bytes", &self.bytes())
            .finish_non_exhaustive()
    }
}

impl PatchSet {
    /// Cuts surfaces into pieces; also returns the parts of pieces that become leaves, group by
    /// group.
    ///
    /// # Errors
    /// If there are more surfaces, pieces, Bézier points or leaves than are possible; except for
    /// leaves, that is known before anything is made.
    pub(crate) fn new<S: Charts + Sync>(
        surfaces: &[S],
    ) -> Result<(Self, GroupedParts), BuildError> {
        check_count("surfaces", surfaces.len(), MOST_COUNTED)?;
        let charts: Vec<Vec<Chart<'_>>> = surfaces.par_iter().map(Charts::charts).collect();
        let counts = charts.iter().map(|charts| total(charts, piece_count));
        let count_of_pieces = counts.clone().fold(0, usize::saturating_add);
        check_count("Bézier pieces", count_of_pieces, MOST_COUNTED)?;
        let mut end = 0;
        let pieces_of = counts.map(|count| {
            end += count;
            end - count..end
        });
        let pieces_of = pieces_of.collect();
        let keeping = Keeping::of(charts.iter().flatten());
        let kept = charts.iter().flatten().map(|chart| keeping.bezier_points(&chart.surface));
        check_count("Bézier points", kept.fold(0, usize::saturating_add), MOST_BEZIER_POINTS)?;
        let nets: Vec<Vec<_>> =
            charts.into_par_iter().map(|charts| nets(&charts, keeping)).collect();
        let bytes = |charts: &Vec<(ChartNet, _)>| charts.iter().map(|(net, _)| net.bytes()).sum();
        let net_bytes = nets.iter().map(bytes).collect();
        let charts = (0u32..).zip(nets).flat_map(|(k, nets)| nets.into_iter().map(move |n| (k, n)));
        let mut pieces = Vec::with_capacity(count_of_pieces);
        let mut grids = Vec::new();
        for (surface, (net, [rows, columns])) in charts {
            let net = Arc::new(net);
            grids.push(ChartGrid { first: pieces.len(), rows: rows.len(), columns: columns.len() });
            let indices = (0..rows.len() * columns.len()).into_par_iter();
            pieces.par_extend(indices.map(|k| {
                let first = [rows[k / columns.len()], columns[k % columns.len()]];
                Piece::new(&net, surface, first)
            }));
        }
        grids.iter().for_each(|grid| apexes::mark(&mut pieces, grid));
        let parts = parts(&pieces, &grids);
        check_count("leaves", parts.all().len(), MOST_COUNTED)?;
        let bounds = parts.bounds();
        let id = SetId::unique();
        Ok((Self { id, pieces, bounds, net_bytes, pieces_of }, parts))
    }

    /// What tells this set from others.
    pub(crate) fn id(&self) -> SetId {
        self.id
    }

    /// The pieces, surface by surface.
    pub fn pieces(&self) -> &[Piece] {
        &self.pieces
    }

    /// The number of surfaces.
    pub fn surface_count(&self) -> usize {
        self.pieces_of.len()
    }

    /// Which pieces a surface was cut into; none if there is no such surface.
    pub fn pieces_of(&self, surface: usize) -> Range<usize> {
        self.pieces_of.get(surface).cloned().unwrap_or_default()
    }

    /// A box that holds every surface, except for rounding. It is not the smallest: it holds the
    /// control points of all parts into which the surfaces are cut.
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

    /// The memory that one surface takes, in bytes: its control points, trims and pieces; nothing
    /// if there is no such surface.
    pub fn bytes_of(&self, surface: usize) -> usize {
        self.net_bytes.get(surface).unwrap_or(&0)
            + size_of_val(&self.pieces[self.pieces_of(surface)])
    }
}

fn check_count(what: &'static str, count: usize, limit: usize) -> Result<(), BuildError> {
    if count > limit { Err(BuildError::TooMany { what, count, limit }) } else { Ok(()) }
}

/// The sum of a count over all charts of a surface.
fn total(charts: &[Chart<'_>], count: fn(&NurbsSurface) -> usize) -> usize {
    charts.iter().map(|chart| count(&chart.surface)).fold(0, usize::saturating_add)
}

/// The nets of a surface's charts, and the rows and columns in which their pieces begin.
fn nets(charts: &[Chart<'_>], keeping: Keeping) -> Vec<(ChartNet, [Vec<u32>; 2])> {
    charts.par_iter().map(|chart| ChartNet::new(chart, keeping)).collect()
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::KnotVector;

    #[test]
    fn nets_that_no_memory_holds_are_not_begun() {
        let spline = |degree, n: usize| {
            let knots = KnotVector::uniform(degree, n).unwrap();
            let points =
                (0..n * n).map(|k| DVec3::new((k / n) as f64, (k % n) as f64, (k as f64).sin()));
            NurbsSurface::new(knots.clone(), knots, points.collect(), None).unwrap()
        };
        let fails = |surfaces: &[NurbsSurface]| PatchSet::new(surfaces).unwrap_err().to_string();
        let large = spline(32, 400);
        assert_eq!(
            fails(std::slice::from_ref(&large)),
            "138697729 Bézier points, but at most 134217728 can be traced"
        );
        // Each of them is small enough.
        let halves = [spline(32, 300), spline(31, 300)];
        assert!(fails(&halves).ends_with(" Bézier points, but at most 134217728 can be traced"));
        // For low degrees it is the control points that are kept.
        let (dense, _) = PatchSet::new(&[spline(7, 100)]).unwrap();
        assert_eq!(dense.pieces().len(), 93 * 93);
    }
}
