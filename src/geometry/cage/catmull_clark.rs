//! One step of Catmull–Clark refinement.

use glam::DVec3;

use super::Cage;
use super::mesh::Mesh;
use super::topology::{NONE, Topology};
use super::vertex_rule::{Surroundings, decayed, edge_point};

impl Cage {
    /// The cage of the same Catmull–Clark surface after one step of refinement: each face
    /// of n corners becomes n quads.
    ///
    /// The vertices are those of this cage, moved, then one for each edge and one for each face.
    /// The quad at corner k of a face has the index of that corner. The quads of a quad keep its
    /// directions: its corner k is corner k of the k-th of them. The quads of any other face begin
    /// with the face's corner.
    ///
    /// Source: Catmull & Clark 1978; DeRose, Kass & Truong 1998 for creases, with the rules
    /// for fractions and boundaries of OpenSubdiv (creasing method "uniform").
    #[must_use]
    pub fn refined_catmull_clark(&self) -> Self {
        Self::from_mesh(refined(self.mesh()))
    }
}

/// One step; see [`Cage::refined_catmull_clark`].
pub(super) fn refined(mesh: &Mesh) -> Mesh {
    let topology = &mesh.topology;
    let (vertex_count, edge_count) = (topology.vertex_count(), topology.edge_count());
    let centroids: Vec<DVec3> =
        (0..topology.face_count()).map(|face| mesh.centroid(face)).collect();
    let mut positions = Vec::with_capacity(vertex_count + edge_count + centroids.len());
    positions.extend((0..vertex_count as u32).map(|vertex| moved(mesh, &centroids, vertex)));
    positions.extend((0..edge_count).map(|edge| middle(mesh, &centroids, edge)));
    positions.extend(centroids);

    let children = child_topology(topology, positions.len());
    let corners = mesh.corners.iter().map(|&sharpness| decayed(sharpness));
    let corners = corners.chain(std::iter::repeat(0.0)).take(positions.len()).collect();
    // An edge between a vertex and an edge's point is half of that edge; others are new.
    let crease = |child: usize| {
        let [a, b] = children.edge_ends(children.edge_corner(child)).map(|end| end as usize);
        let is_half = a.min(b) < vertex_count;
        if is_half { decayed(mesh.creases[a.max(b) - vertex_count]) } else { 0.0 }
    };
    let creases = (0..children.edge_count()).map(crease).collect();
    Mesh { topology: children, positions, creases, corners }
}

fn moved(mesh: &Mesh, centroids: &[DVec3], vertex: u32) -> DVec3 {
    let topology = &mesh.topology;
    let star = topology.star(vertex);
    let at = |&vertex: &u32| mesh.positions[vertex as usize];
    let spokes: Vec<DVec3> = topology.spoke_ends(&star).iter().map(at).collect();
    let creases: Vec<f64> = topology.spokes(&star).iter().map(|&c| mesh.crease(c)).collect();
    let faces = star.corners.iter().map(|&corner| topology.face_of(corner) as usize);
    let centroids: Vec<DVec3> = faces.map(|face| centroids[face]).collect();
    let surroundings = Surroundings {
        center: mesh.positions[vertex as usize],
        corner: mesh.corners[vertex as usize],
        spokes: &spokes,
        creases: &creases,
        centroids: &centroids,
    };
    surroundings.moved()
}

fn middle(mesh: &Mesh, centroids: &[DVec3], edge: usize) -> DVec3 {
    let topology = &mesh.topology;
    let corner = topology.edge_corner(edge);
    let twin = topology.twin(corner);
    let ends = topology.edge_ends(corner).map(|end| mesh.positions[end as usize]);
    let sides = (twin != NONE)
        .then(|| [corner, twin].map(|corner| centroids[topology.face_of(corner) as usize]));
    edge_point(ends, sides, mesh.creases[edge])
}

/// A quad for each corner: the vertex, the edge that leaves it, the face, the edge that arrives. In
/// a quad they are rotated so that the vertex keeps its place.
fn child_topology(topology: &Topology, vertex_count: usize) -> Topology {
    let first_edge = topology.vertex_count() as u32;
    let first_face = first_edge + topology.edge_count() as u32;
    let mut vertices = Vec::with_capacity(4 * topology.corner_count());
    for face in 0..topology.face_count() {
        let range = topology.face_range(face);
        for (k, corner) in range.clone().enumerate() {
            let corner = corner as u32;
            let mut quad = [
                topology.vertex(corner),
                first_edge + topology.edge(corner),
                first_face + face as u32,
                first_edge + topology.edge(topology.previous(corner)),
            ];
            if range.len() == 4 {
                quad.rotate_right(k);
            }
            vertices.extend(quad);
        }
    }
    let starts = (0..=topology.corner_count() as u32).map(|quad| 4 * quad).collect();
    Topology::build(vertex_count, starts, vertices).0
}
