//! A polygon mesh with sharp edges and vertices: the cage, or the result of its refinement.

use glam::DVec3;

use super::topology::Topology;
use crate::geometry::construct::ControlNet;

/// Positions, neighbourhoods and sharpness.
///
/// Sharpness is the number of refinement steps for which an edge is a crease or a vertex stays
/// where it is (DeRose, Kass & Truong 1998); it may be fractional or infinite. Edges on the
/// boundary are always creases.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mesh {
    pub(super) topology: Topology,
    pub(super) positions: Vec<DVec3>,
    /// The sharpness of each edge.
    pub(super) creases: Vec<f64>,
    /// The sharpness of each vertex.
    pub(super) corners: Vec<f64>,
}

/// Some faces of a mesh as a mesh of their own.
pub(super) struct Part {
    pub(super) mesh: Mesh,
    /// The original face of each of its faces.
    pub(super) faces: Vec<u32>,
}

impl Mesh {
    /// The vertices and edges.
    pub(super) fn control_net(&self) -> ControlNet {
        let topology = &self.topology;
        let ends = |edge| topology.edge_ends(topology.edge_corner(edge)).map(|end| end as usize);
        ControlNet {
            points: self.positions.clone(),
            lines: (0..topology.edge_count()).map(ends).collect(),
        }
    }

    /// The position of a corner's vertex.
    pub(super) fn at(&self, corner: u32) -> DVec3 {
        self.positions[self.topology.vertex(corner) as usize]
    }

    /// The sharpness of a corner's half-edge.
    pub(super) fn crease(&self, corner: u32) -> f64 {
        self.creases[self.topology.edge(corner) as usize]
    }

    /// The mean of a face's vertices.
    pub(super) fn centroid(&self, face: usize) -> DVec3 {
        let vertices = self.topology.face(face);
        let sum: DVec3 = vertices.iter().map(|&vertex| self.positions[vertex as usize]).sum();
        sum / vertices.len() as f64
    }

    /// All faces that have one of these vertices, with their vertices, in the order of the faces.
    /// Each of the vertices has all of its faces in one fan.
    ///
    /// Edges that lose a face keep their sharpness: they do not become creases.
    pub(super) fn part_around(&self, vertices: impl Iterator<Item = u32>) -> Part {
        let topology = &self.topology;
        let mut around: Vec<u32> = vertices.collect();
        around.sort_unstable();
        around.dedup();
        let faces_at = |vertex: u32| {
            topology.star(vertex).corners.into_iter().map(|corner| topology.face_of(corner))
        };
        let mut faces: Vec<u32> = around.into_iter().flat_map(faces_at).collect();
        faces.sort_unstable();
        faces.dedup();

        // Number the vertices anew, in the order in which they occur.
        let mut number = vec![u32::MAX; topology.vertex_count()];
        let (mut old_vertices, mut old_corners) = (Vec::new(), Vec::new());
        let (mut starts, mut vertices) = (vec![0], Vec::new());
        for &face in &faces {
            for corner in topology.face_range(face as usize) {
                let old = topology.vertex(corner as u32);
                if number[old as usize] == u32::MAX {
                    number[old as usize] = old_vertices.len() as u32;
                    old_vertices.push(old as usize);
                }
                vertices.push(number[old as usize]);
                old_corners.push(corner as u32);
            }
            starts.push(vertices.len() as u32);
        }

        let (part, _) = Topology::build(old_vertices.len(), starts, vertices);
        let old_corner = |edge| old_corners[part.edge_corner(edge) as usize];
        let creases = (0..part.edge_count()).map(|edge| self.crease(old_corner(edge))).collect();
        let positions = old_vertices.iter().map(|&old| self.positions[old]).collect();
        let corners = old_vertices.iter().map(|&old| self.corners[old]).collect();
        Part { mesh: Self { topology: part, positions, creases, corners }, faces }
    }
}
