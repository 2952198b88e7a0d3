//! How finely surfaces are cut into triangles. For Embree only, like the meshes it makes.

use glam::DVec3;

use super::grid_mesh::{GridMesh, MAX_GRID_SIDE, MAX_VERTICES, MeshError};
use super::plan::Plan;
use crate::geometry::Charts;

/// Rounds of refinement before the counts are taken as they are. The deviation falls with
/// the square of the counts, so that two or three rounds suffice, except where the
/// parametrisation is singular. The deviation reached is measured and reported in any case.
const MAX_ROUNDS: usize = 10;

/// Tolerance of the chords of trim curves on flat surfaces, as a share of the diagonal, where
/// nothing else says how many chords there should be.
const FLAT_EDGES: f64 = 1e-4;

/// How finely surfaces are to be cut: found once, carried out as often as needed.
#[derive(Clone, Debug)]
pub struct TessellationPlan {
    surfaces: usize,
    plans: Vec<(usize, Plan)>,
    diagonal: f64,
    /// Tolerance of the chords of trim curves, in scene units.
    edges: f64,
}

impl TessellationPlan {
    /// Plans to cut every knot span into `cells` × `cells`.
    ///
    /// # Errors
    /// When a surface cannot be cut at its creases. If `cells` is more than a grid may have,
    /// [`TessellationPlan::meshes`] fails.
    pub fn with_cells(surfaces: &[impl Charts], cells: usize) -> Result<Self, MeshError> {
        let cells = cells.min(2 * MAX_GRID_SIDE); // more is too many all the same
        let diagonal = diagonal(&plans(surfaces, shown)?);
        let plans = plans(surfaces, |_| cells)?;
        let worst = plans.iter().map(|(_, plan)| plan.measure().worst()).fold(0.0, f64::max);
        let edges = worst.max(FLAT_EDGES * diagonal);
        Ok(Self { surfaces: surfaces.len(), plans, diagonal, edges })
    }

    /// Plans to cut surfaces so finely that their distance from their triangles stays within
    /// `fraction` of the diagonal of their common bounding box. Each row and each column of knot
    /// spans of a chart has a count of its own. The distance is checked by sampling: see
    /// [`Tessellation::deviation`].
    ///
    /// # Errors
    /// When `fraction` is not a positive number, or a surface cannot be cut at its creases.
    pub fn to_tolerance(surfaces: &[impl Charts], fraction: f64) -> Result<Self, MeshError> {
        Self::to(surfaces, fraction, |diagonal| fraction * diagonal)
    }

    /// Plans to cut surfaces so finely that their distance from their triangles stays within
    /// `distance`, in scene units, checked as [`TessellationPlan::to_tolerance`] does.
    ///
    /// # Errors
    /// When `distance` is not a positive number, or a surface cannot be cut at its creases.
    pub fn to_distance(surfaces: &[impl Charts], distance: f64) -> Result<Self, MeshError> {
        Self::to(surfaces, distance, |_| distance)
    }

    /// Plans for a distance that may depend on the diagonal, if the tolerance asked for is usable.
    fn to(
        surfaces: &[impl Charts],
        tolerance: f64,
        distance: impl Fn(f64) -> f64,
    ) -> Result<Self, MeshError> {
        let usable = tolerance > 0.0 && tolerance.is_finite(); // false for NaN
        if !usable {
            return Err(MeshError::Tolerance { tolerance });
        }
        let mut plans = plans(surfaces, shown)?;
        let diagonal = diagonal(&plans);
        let distance = distance(diagonal);
        for (_, plan) in &mut plans {
            plan.estimate(distance);
            for _ in 0..MAX_ROUNDS {
                if !plan.refine(distance) {
                    break;
                }
            }
        }
        Ok(Self { surfaces: surfaces.len(), plans, diagonal, edges: distance })
    }

    /// The diagonal of the bounding box of all surfaces, from a few points of each knot span;
    /// it does not depend on how finely they are cut.
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }

    /// Carries the plan out: one mesh for each surface, in the same order, of positions only.
    ///
    /// # Errors
    /// When a grid or all of them together would become too large.
    pub fn meshes(&self) -> Result<Vec<GridMesh>, MeshError> {
        self.carried_out(false)
    }

    /// As [`TessellationPlan::meshes`], the same vertices in the same order, with the normals and
    /// parameters of the surfaces.
    ///
    /// # Errors
    /// When a grid or all of them together would become too large.
    pub fn detailed_meshes(&self) -> Result<Vec<GridMesh>, MeshError> {
        self.carried_out(true)
    }

    fn carried_out(&self, detailed: bool) -> Result<Vec<GridMesh>, MeshError> {
        let mut counts = vec![0_usize; self.surfaces];
        for (surface, plan) in &self.plans {
            counts[*surface] = counts[*surface].saturating_add(plan.vertex_count());
        }
        let vertices = counts.iter().copied().fold(0, usize::saturating_add);
        if vertices > MAX_VERTICES {
            return Err(MeshError::TooManyVertices { vertices, limit: MAX_VERTICES });
        }
        let room = |vertices| GridMesh::with_room(vertices, detailed);
        let mut meshes: Vec<_> = counts.into_iter().map(room).collect();
        for (surface, plan) in &self.plans {
            plan.carry_out(self.edges, &mut meshes[*surface])?;
        }
        Ok(meshes)
    }

    fn deviation(&self) -> f64 {
        self.plans.iter().map(|(_, plan)| plan.measure().worst()).fold(0.0, f64::max)
    }
}

/// Surfaces as grids of triangles: one mesh a surface, one grid a knot span where nothing is
/// trimmed.
///
/// On trimmed surfaces, cells that are kept whole form grids as large as possible. The kept part of
/// a cut cell is triangulated along chords of the trim curves; the chords are as near to the curves
/// as the triangles are to the surface.
///
/// Within a surface neighbouring grids share the vertices of their borders, bit for bit, also where
/// smooth pieces meet. Across seams they do so if the control points there are the same; on closed
/// surfaces with other knots at their ends, vertices agree to rounding. Between surfaces, and
/// between the patches of a triangular or subdivision surface, they do so if the counts agree, as
/// [`Tessellation::with_cells`] makes them; otherwise gaps as wide as the deviation may open.
#[derive(Clone, Debug)]
pub struct Tessellation {
    meshes: Vec<GridMesh>,
    deviation: f64,
    diagonal: f64,
}

impl Tessellation {
    /// Cuts every knot span into `cells` × `cells`.
    ///
    /// # Errors
    /// As [`TessellationPlan::with_cells`] and [`TessellationPlan::meshes`].
    pub fn with_cells(surfaces: &[impl Charts], cells: usize) -> Result<Self, MeshError> {
        Self::carried_out(&TessellationPlan::with_cells(surfaces, cells)?)
    }

    /// Cuts surfaces so finely that their distance from their triangles stays within `fraction`
    /// of the diagonal of their common bounding box.
    ///
    /// # Errors
    /// As [`TessellationPlan::to_tolerance`] and [`TessellationPlan::meshes`].
    pub fn to_tolerance(surfaces: &[impl Charts], fraction: f64) -> Result<Self, MeshError> {
        Self::carried_out(&TessellationPlan::to_tolerance(surfaces, fraction)?)
    }

    fn carried_out(plan: &TessellationPlan) -> Result<Self, MeshError> {
        let meshes = plan.detailed_meshes()?;
        Ok(Self { meshes, deviation: plan.deviation(), diagonal: plan.diagonal })
    }

    /// One mesh for each surface, in the same order.
    pub fn meshes(&self) -> &[GridMesh] {
        &self.meshes
    }

    /// The largest distance between the surfaces and their triangles, in scene units, sampled in
    /// some cells of every knot span at the middles of edges and triangles. It is measured along
    /// the normal, and in space at the borders of smooth pieces. Points between the samples may
    /// deviate a few per cent more.
    pub fn deviation(&self) -> f64 {
        self.deviation
    }

    /// As [`TessellationPlan::diagonal`].
    pub fn diagonal(&self) -> f64 {
        self.diagonal
    }
}

/// The plans of all charts, each with the number of the surface it belongs to.
fn plans(
    surfaces: &[impl Charts],
    cells: impl Fn(usize) -> usize,
) -> Result<Vec<(usize, Plan)>, MeshError> {
    let mut plans = Vec::new();
    for (number, surface) in surfaces.iter().enumerate() {
        for chart in surface.charts() {
            plans.push((number, Plan::new(chart, &cells)?));
        }
    }
    Ok(plans)
}

/// Cells a span that suffice to show how a span bends and how far it reaches.
fn shown(degree: usize) -> usize {
    2 * degree
}

/// The diagonal of the box around the vertices of all plans.
fn diagonal(plans: &[(usize, Plan)]) -> f64 {
    let nothing = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (low, high) = plans.iter().fold(nothing, |(low, high), (_, plan)| {
        let (lowest, highest) = plan.bounds();
        (low.min(lowest), high.max(highest))
    });
    if low.x <= high.x { (high - low).length() } else { 0.0 }
}

#[cfg(test)]
mod tests;
