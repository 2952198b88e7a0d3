//! One step of Doo–Sabin refinement.

use std::f64::consts::TAU;

use glam::DVec3;

use super::Cage;
use super::mesh::Mesh;
use super::topology::{NONE, Topology};

impl Cage {
    /// The cage of the same Doo–Sabin surface after one step of refinement: a shrunken face
    /// in each face, a quad along each inner edge, a face around each inner vertex.
    ///
    /// The vertices correspond to the corners of this cage's faces. The shrunken faces come first,
    /// with their corners in the same order. The scheme has no creases and corners, so the new cage
    /// has none. Boundary vertices give no faces, so the border moves inwards.
    ///
    /// Source: Doo & Sabin 1978, with their weights: `(n + 5)/(4n)` for the corner itself,
    /// `(3 + 2 cos(2π j/n))/(4n)` for the corner j places further.
    #[must_use]
    pub fn refined_doo_sabin(&self) -> Self {
        Self::from_mesh(refined(self.mesh()))
    }
}

/// One step; see [`Cage::refined_doo_sabin`].
pub(super) fn refined(mesh: &Mesh) -> Mesh {
    let topology = &mesh.topology;
    let mut positions = Vec::with_capacity(topology.corner_count());
    for face in 0..topology.face_count() {
        shrink(mesh, face, &mut positions);
    }
    let children = child_topology(topology);
    let is_boundary = |edge: usize| children.twin(children.edge_corner(edge)) == NONE;
    let crease = |edge| if is_boundary(edge) { f64::INFINITY } else { 0.0 };
    let creases = (0..children.edge_count()).map(crease).collect();
    let corners = vec![0.0; positions.len()];
    Mesh { topology: children, positions, creases, corners }
}

/// The new corners of a face.
fn shrink(mesh: &Mesh, face: usize, positions: &mut Vec<DVec3>) {
    let vertices = mesh.topology.face(face);
    let n = vertices.len();
    let at = |i: usize| mesh.positions[vertices[i % n] as usize];
    if n == 4 {
        // The B-spline's weights, exact in f64.
        positions.extend(
            (0..4).map(|i| (9.0 * at(i) + 3.0 * (at(i + 1) + at(i + 3)) + at(i + 2)) / 16.0),
        );
        return;
    }
    let count = n as f64;
    let weight = |j: usize| {
        let own = if j == 0 { count } else { 0.0 };
        (own + 3.0 + 2.0 * (TAU * j as f64 / count).cos()) / (4.0 * count)
    };
    let weights: Vec<f64> = (0..n).map(weight).collect();
    let corner = |i| (0..n).map(|j| weights[j] * at(i + j)).sum::<DVec3>();
    positions.extend((0..n).map(corner));
}

fn child_topology(topology: &Topology) -> Topology {
    let mut starts = vec![0];
    let mut vertices = Vec::with_capacity(4 * topology.corner_count());
    let mut close = |vertices: &Vec<u32>| starts.push(vertices.len() as u32);
    for face in 0..topology.face_count() {
        vertices.extend(topology.face_range(face).map(|corner| corner as u32));
        close(&vertices);
    }
    for edge in 0..topology.edge_count() {
        let corner = topology.edge_corner(edge);
        let twin = topology.twin(corner);
        if twin != NONE {
            vertices.extend([topology.next(corner), corner, topology.next(twin), twin]);
            close(&vertices);
        }
    }
    for vertex in 0..topology.vertex_count() as u32 {
        let star = topology.star(vertex);
        if star.closed && star.corners.len() > 2 {
            vertices.extend(star.corners);
            close(&vertices);
        }
    }
    Topology::build(topology.corner_count(), starts, vertices).0
}
