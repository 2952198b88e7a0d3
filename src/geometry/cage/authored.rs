//! Cages as authored, and their checks.

use glam::DVec3;

use super::error::{CageError, Feature};
use super::mesh::Mesh;
use super::topology::{EdgeFault, Topology};
use crate::geometry::construct::ControlNet;
use crate::geometry::magnitude::is_usable;
use crate::math::Aabb;

/// A cage as its author wrote it: plain data that [`Cage::new`] checks.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CageParts {
    /// The vertices.
    pub positions: Vec<DVec3>,
    /// The vertices of each face, as indices from 0, counterclockwise seen from outside.
    pub faces: Vec<Vec<usize>>,
    /// Edges that are more or less sharp.
    pub creases: Vec<Crease>,
    /// Vertices that are more or less sharp.
    pub corners: Vec<Corner>,
    /// What happens at the corners of the boundary.
    pub boundary: BoundaryRule,
}

/// An edge that stays sharp for a number of refinement steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crease {
    /// The ends of the edge.
    pub vertices: [usize; 2],
    /// From 0 to 10 steps, or infinitely many; a fraction blends the last step.
    pub sharpness: f64,
}

/// A vertex that stays in place for a number of refinement steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner {
    /// The vertex.
    pub vertex: usize,
    /// From 0 to 10 steps, or infinitely many; a fraction blends the last step.
    pub sharpness: f64,
}

/// What Catmull–Clark subdivision does at the boundary of a cage. Boundary edges are always sharp:
/// the surface's border is the cubic B-spline of the cage's border.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum BoundaryRule {
    /// Boundary vertices of a single face are sharp corners, at which the border curve begins and
    /// ends: a grid has the corners of a clamped B-spline.
    #[default]
    EdgeAndCorner,
    /// The border curve runs smoothly past all boundary vertices.
    EdgeOnly,
}

/// The polygon mesh of a subdivision surface, faces of any size.
///
/// # Invariants, checked once on construction and relied on everywhere else
/// - there is a face; faces have 3 or more corners at different vertices;
/// - coordinates are finite and at most [`MAX_MAGNITUDE`](crate::geometry::MAX_MAGNITUDE);
/// - no two faces have the same vertices;
/// - an edge belongs to one face (a boundary) or to two that run along it in opposite directions;
/// - the faces around a vertex are one fan, open or closed; each vertex has a face;
/// - sharpness is from 0 to 10, or infinite.
#[derive(Clone, Debug, PartialEq)]
pub struct Cage {
    mesh: Mesh,
}

/// The most corners of all faces, 2²⁸: refinement counts four times as many in 32 bits.
const MAX_CORNERS: usize = 1 << 28;

/// The largest finite sharpness: a crease of sharpness 10 is rounded over a thousandth of a face,
/// and may need about four thousand patches per edge where it does not go straight on. OpenSubdiv
/// treats 10 as infinite.
pub(super) const MAX_SHARPNESS: f64 = 10.0;

impl Cage {
    /// A cage from its parts.
    ///
    /// # Errors
    /// When one of the invariants above does not hold, or a crease or corner names a missing edge
    /// or vertex or contradicts another.
    pub fn new(parts: CageParts) -> Result<Self, CageError> {
        check_sizes(&parts)?;
        for (face, vertices) in parts.faces.iter().enumerate() {
            check_face(face, vertices, parts.positions.len())?;
        }
        check_distinct(&parts.faces)?;
        let mut starts = vec![0];
        let mut vertices = Vec::new();
        for face in &parts.faces {
            vertices.extend(face.iter().map(|&vertex| vertex as u32));
            starts.push(vertices.len() as u32);
        }
        let (topology, fault) = Topology::build(parts.positions.len(), starts, vertices);
        if let Some(fault) = fault {
            return Err(edge_error(&topology, &fault));
        }
        check_vertices(&topology)?;

        let creases = edge_sharpness(&topology, &parts.creases)?;
        let corners = vertex_sharpness(&topology, &parts)?;
        Ok(Self { mesh: Mesh { topology, positions: parts.positions, creases, corners } })
    }

    /// The cage of a mesh that came from refining a valid cage, and is therefore valid.
    pub(super) fn from_mesh(mesh: Mesh) -> Self {
        Self { mesh }
    }

    pub(super) fn mesh(&self) -> &Mesh {
        &self.mesh
    }

    /// The vertices.
    pub fn positions(&self) -> &[DVec3] {
        &self.mesh.positions
    }

    /// The number of faces.
    pub fn face_count(&self) -> usize {
        self.mesh.topology.face_count()
    }

    /// The number of edges.
    pub fn edge_count(&self) -> usize {
        self.mesh.topology.edge_count()
    }

    /// The vertices of a face, counterclockwise seen from outside; `None` beyond the last.
    pub fn face(&self, face: usize) -> Option<&[u32]> {
        (face < self.face_count()).then(|| self.mesh.topology.face(face))
    }

    /// The two vertices of each edge; each edge comes once.
    pub fn edges(&self) -> impl Iterator<Item = [u32; 2]> + '_ {
        let topology = &self.mesh.topology;
        (0..topology.edge_count()).map(|edge| topology.edge_ends(topology.edge_corner(edge)))
    }

    /// The vertices and edges as a net to draw.
    pub fn control_net(&self) -> ControlNet {
        self.mesh.control_net()
    }

    /// The sharpness of each edge, in the order of [`Cage::edges`]; boundaries are infinite.
    pub fn edge_sharpness(&self) -> &[f64] {
        &self.mesh.creases
    }

    /// The sharpness of each vertex.
    pub fn vertex_sharpness(&self) -> &[f64] {
        &self.mesh.corners
    }

    /// Whether the cage has no boundary.
    pub fn is_closed(&self) -> bool {
        let topology = &self.mesh.topology;
        (0..topology.corner_count() as u32).all(|c| topology.twin(c) != super::topology::NONE)
    }

    /// The largest absolute coordinate.
    pub fn magnitude(&self) -> f64 {
        self.mesh.positions.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
    }

    /// The largest side of the bounding box.
    pub(super) fn largest_side(&self) -> f64 {
        Aabb::around(self.positions().iter().copied()).size().max_element()
    }

    /// The smallest tolerance that may be requested for the limit surface: 1e-9 of half the cage's
    /// largest side or, where the cage lies more than 500 of its sides from the origin, what
    /// rounding requires, 1e-12 of the largest coordinate. (Around vertices of many faces this
    /// tolerance may not be reached; that is an error.)
    pub fn smallest_tolerance(&self) -> f64 {
        let by_steps = SMALLEST_OF_SIZE * 0.5 * self.largest_side();
        by_steps.max(SMALLEST_OF_MAGNITUDE * self.magnitude())
    }
}

/// About what the available halving steps reach: the worst vertices shrink by 0.6545 a step.
const SMALLEST_OF_SIZE: f64 = 1e-9;

/// Patches must be within a fraction of the tolerance, 0.0064 of it at least: 50 rounding errors of
/// the largest coordinate. A refinement step computes averages, with a few rounding errors.
const SMALLEST_OF_MAGNITUDE: f64 = 1e-12;

fn check_sizes(parts: &CageParts) -> Result<(), CageError> {
    if parts.faces.is_empty() {
        return Err(CageError::Empty);
    }
    let corners = parts.faces.iter().map(Vec::len).fold(0, usize::saturating_add);
    let corners = corners.max(parts.positions.len());
    if corners > MAX_CORNERS {
        return Err(CageError::TooLarge { corners, limit: MAX_CORNERS });
    }
    let usable = |p: &DVec3| is_usable(*p);
    match parts.positions.iter().position(|position| !usable(position)) {
        Some(vertex) => Err(CageError::Position { vertex, position: parts.positions[vertex] }),
        None => Ok(()),
    }
}

fn check_face(face: usize, corners: &[usize], vertices: usize) -> Result<(), CageError> {
    if corners.len() < 3 {
        return Err(CageError::FewCorners { face, corners: corners.len() });
    }
    if let Some(&vertex) = corners.iter().find(|&&vertex| vertex >= vertices) {
        return Err(CageError::NoSuchVertex { face, vertex, vertices });
    }
    let mut sorted = corners.to_vec();
    sorted.sort_unstable();
    match sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err(CageError::RepeatedVertex { face, vertex: pair[0] }),
        None => Ok(()),
    }
}

/// Fails if two faces have the same vertices: they would cover each other, in either orientation.
fn check_distinct(faces: &[Vec<usize>]) -> Result<(), CageError> {
    let sorted = |face: &Vec<usize>| {
        let mut corners = face.clone();
        corners.sort_unstable();
        corners
    };
    let mut order: Vec<(Vec<usize>, usize)> =
        faces.iter().enumerate().map(|(index, face)| (sorted(face), index)).collect();
    order.sort_unstable();
    match order.windows(2).find(|pair| pair[0].0 == pair[1].0) {
        Some(pair) => Err(CageError::SameFace { faces: [pair[0].1, pair[1].1] }),
        None => Ok(()),
    }
}

fn edge_error(topology: &Topology, fault: &EdgeFault) -> CageError {
    let vertices = topology.edge_ends(fault.corners[0]).map(|vertex| vertex as usize);
    let faces: Vec<usize> =
        fault.corners.iter().map(|&corner| topology.face_of(corner) as usize).collect();
    match faces[..] {
        [a, b] => CageError::Orientation { vertices, faces: [a, b] },
        _ => CageError::NonManifoldEdge { vertices, faces },
    }
}

fn check_vertices(topology: &Topology) -> Result<(), CageError> {
    let mut faces = vec![0_usize; topology.vertex_count()];
    for corner in 0..topology.corner_count() as u32 {
        faces[topology.vertex(corner) as usize] += 1;
    }
    for (vertex, &faces) in faces.iter().enumerate() {
        let fan = topology.star(vertex as u32).corners.len();
        if faces == 0 {
            return Err(CageError::IsolatedVertex { vertex });
        }
        if fan != faces {
            return Err(CageError::NonManifoldVertex { vertex, faces, fan });
        }
    }
    Ok(())
}

/// The sharpness of each edge: as authored, but infinite at boundaries.
fn edge_sharpness(topology: &Topology, creases: &[Crease]) -> Result<Vec<f64>, CageError> {
    let mut sharpness = vec![None; topology.edge_count()];
    for (index, crease) in creases.iter().enumerate() {
        let [a, b] = crease.vertices;
        let there = a.max(b) < topology.vertex_count();
        let edge = if there { topology.edge_between(a as u32, b as u32) } else { None };
        let edge = edge.ok_or(CageError::NoSuchEdge { crease: index, vertices: [a, b] })?;
        set_sharpness(&mut sharpness[edge as usize], crease.sharpness, (Feature::Crease, index))?;
    }
    let boundary = |edge: usize| topology.twin(topology.edge_corner(edge)) == super::topology::NONE;
    let given = sharpness.into_iter().enumerate();
    Ok(given
        .map(|(edge, given)| if boundary(edge) { f64::INFINITY } else { given.unwrap_or(0.0) })
        .collect())
}

/// The sharpness of each vertex: as authored, but infinite where the boundary rule says so.
fn vertex_sharpness(topology: &Topology, parts: &CageParts) -> Result<Vec<f64>, CageError> {
    let mut sharpness = vec![None; topology.vertex_count()];
    for (index, corner) in parts.corners.iter().enumerate() {
        let (vertex, vertices) = (corner.vertex, topology.vertex_count());
        let place = sharpness.get_mut(vertex);
        let place = place.ok_or(CageError::NoSuchCorner { corner: index, vertex, vertices })?;
        set_sharpness(place, corner.sharpness, (Feature::Corner, index))?;
    }
    let sharp_by_rule = |vertex: usize| {
        let star = topology.star(vertex as u32);
        parts.boundary == BoundaryRule::EdgeAndCorner && !star.closed && star.corners.len() == 1
    };
    let given = sharpness.into_iter().enumerate();
    Ok(given
        .map(|(vertex, given)| match given {
            _ if sharp_by_rule(vertex) => f64::INFINITY,
            given => given.unwrap_or(0.0),
        })
        .collect())
}

fn set_sharpness(
    place: &mut Option<f64>,
    sharpness: f64,
    (feature, index): (Feature, usize),
) -> Result<(), CageError> {
    if !(0.0..=MAX_SHARPNESS).contains(&sharpness) && sharpness != f64::INFINITY {
        return Err(CageError::Sharpness { feature, index, sharpness });
    }
    match *place {
        Some(other) if other != sharpness => {
            Err(CageError::TwoSharpnesses { feature, index, sharpness, other })
        }
        _ => {
            *place = Some(sharpness);
            Ok(())
        }
    }
}
