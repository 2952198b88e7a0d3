//! The adjacency of corners, edges and faces of a polygon mesh: a half-edge table.

/// Marks a missing half-edge: the edge is a boundary.
pub(super) const NONE: u32 = u32::MAX;

/// The adjacency of a polygon mesh.
///
/// A *corner* is one vertex of one face; corners are counted face after face. Each stands for the
/// half-edge that leaves it along the border of its face, counterclockwise seen from outside. Its
/// twin is the opposite half-edge, which belongs to the adjacent face.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Topology {
    /// The first corner of each face, followed by the number of corners.
    starts: Vec<u32>,
    /// The vertex of each corner.
    vertices: Vec<u32>,
    /// The face of each corner.
    faces: Vec<u32>,
    /// The other half of each corner's edge, or [`NONE`].
    twins: Vec<u32>,
    /// The edge of each corner's half-edge.
    edges: Vec<u32>,
    /// One corner of each edge; edges are in the order of their two vertices, the lower one first.
    edge_corners: Vec<u32>,
    /// One corner of each vertex, or [`NONE`]; the most clockwise one where the faces around the
    /// vertex do not close.
    vertex_corners: Vec<u32>,
}

/// The half-edges of one edge that do not form a surface: more than two, or two the same way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct EdgeFault {
    /// Their corners.
    pub(super) corners: Vec<u32>,
}

/// The corners of one vertex, counterclockwise.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Star {
    /// One corner for each face around the vertex.
    pub(super) corners: Vec<u32>,
    /// Whether the last face touches the first.
    pub(super) closed: bool,
}

impl Topology {
    /// Builds the table from the vertices of the faces' corners; also returns the first faulty
    /// edge, if any. The half-edges of faulty edges have no twins.
    pub(super) fn build(
        vertex_count: usize,
        starts: Vec<u32>,
        vertices: Vec<u32>,
    ) -> (Self, Option<EdgeFault>) {
        let corner_count = vertices.len();
        let mut topology = Self {
            faces: vec![0; corner_count],
            twins: vec![NONE; corner_count],
            edges: vec![0; corner_count],
            edge_corners: Vec::with_capacity(corner_count / 2),
            vertex_corners: vec![NONE; vertex_count],
            starts,
            vertices,
        };
        for face in 0..topology.face_count() {
            let range = topology.face_range(face);
            topology.faces[range].fill(face as u32);
        }
        let fault = topology.join_edges();
        topology.find_first_corners();
        (topology, fault)
    }

    /// Pairs the half-edges by sorting them by their two vertices.
    fn join_edges(&mut self) -> Option<EdgeFault> {
        let corners = 0..self.corner_count() as u32;
        let mut halves: Vec<_> = corners.map(|corner| (self.low_high(corner), corner)).collect();
        halves.sort_unstable();

        let mut fault = None;
        for group in halves.chunk_by(|a, b| a.0 == b.0) {
            let edge = self.edge_corners.len() as u32;
            for &(_, corner) in group {
                self.edges[corner as usize] = edge;
            }
            self.edge_corners.push(group[0].1);
            match *group {
                [_] => {}
                [(_, a), (_, b)] if self.vertex(a) != self.vertex(b) => {
                    self.twins[a as usize] = b;
                    self.twins[b as usize] = a;
                }
                _ if fault.is_none() => {
                    let corners = group.iter().map(|half| half.1).collect();
                    fault = Some(EdgeFault { corners });
                }
                _ => {}
            }
        }
        fault
    }

    fn find_first_corners(&mut self) {
        for corner in 0..self.corner_count() {
            let vertex = self.vertices[corner] as usize;
            if self.vertex_corners[vertex] == NONE || self.twins[corner] == NONE {
                self.vertex_corners[vertex] = corner as u32;
            }
        }
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.vertex_corners.len()
    }

    pub(super) fn face_count(&self) -> usize {
        self.starts.len() - 1
    }

    pub(super) fn corner_count(&self) -> usize {
        self.vertices.len()
    }

    pub(super) fn edge_count(&self) -> usize {
        self.edge_corners.len()
    }

    /// The corners of a face.
    pub(super) fn face_range(&self, face: usize) -> std::ops::Range<usize> {
        self.starts[face] as usize..self.starts[face + 1] as usize
    }

    /// The vertices of a face.
    pub(super) fn face(&self, face: usize) -> &[u32] {
        &self.vertices[self.face_range(face)]
    }

    /// The number of corners of the face a corner belongs to.
    pub(super) fn sides(&self, corner: u32) -> usize {
        self.face_range(self.face_of(corner) as usize).len()
    }

    pub(super) fn vertex(&self, corner: u32) -> u32 {
        self.vertices[corner as usize]
    }

    pub(super) fn face_of(&self, corner: u32) -> u32 {
        self.faces[corner as usize]
    }

    pub(super) fn edge(&self, corner: u32) -> u32 {
        self.edges[corner as usize]
    }

    /// One corner of an edge.
    pub(super) fn edge_corner(&self, edge: usize) -> u32 {
        self.edge_corners[edge]
    }

    pub(super) fn twin(&self, corner: u32) -> u32 {
        self.twins[corner as usize]
    }

    /// The next corner of the same face.
    pub(super) fn next(&self, corner: u32) -> u32 {
        let range = self.face_range(self.face_of(corner) as usize);
        if corner as usize + 1 == range.end { range.start as u32 } else { corner + 1 }
    }

    /// The previous corner of the same face.
    pub(super) fn previous(&self, corner: u32) -> u32 {
        let range = self.face_range(self.face_of(corner) as usize);
        if corner as usize == range.start { range.end as u32 - 1 } else { corner - 1 }
    }

    /// The vertex at which a corner's half-edge ends.
    pub(super) fn tip(&self, corner: u32) -> u32 {
        self.vertex(self.next(corner))
    }

    /// The two vertices of a corner's half-edge.
    pub(super) fn edge_ends(&self, corner: u32) -> [u32; 2] {
        [self.vertex(corner), self.tip(corner)]
    }

    /// The edge between two vertices, found by binary search: edges are numbered in the order of
    /// these.
    pub(super) fn edge_between(&self, a: u32, b: u32) -> Option<u32> {
        let wanted = [a.min(b), a.max(b)];
        let found =
            self.edge_corners.binary_search_by_key(&wanted, |&corner| self.low_high(corner));
        found.ok().map(|edge| edge as u32)
    }

    /// The two vertices of a corner's half-edge, the lower one first.
    fn low_high(&self, corner: u32) -> [u32; 2] {
        let [a, b] = self.edge_ends(corner);
        [a.min(b), a.max(b)]
    }

    /// The corners of a vertex, counterclockwise; if its faces form several fans, those of one fan.
    pub(super) fn star(&self, vertex: u32) -> Star {
        let first = self.vertex_corners[vertex as usize];
        if first == NONE {
            return Star { corners: Vec::new(), closed: false };
        }
        let mut corners = vec![first];
        let mut at = first;
        loop {
            at = self.twin(self.previous(at));
            if at == NONE || at == first {
                return Star { corners, closed: at == first };
            }
            corners.push(at);
        }
    }

    /// The half-edges of the edges at a star's vertex, counterclockwise: its corners and, if the
    /// star is open, the half-edge that arrives along its last border.
    pub(super) fn spokes(&self, star: &Star) -> Vec<u32> {
        let mut spokes = star.corners.clone();
        if !star.closed {
            spokes.extend(star.corners.last().map(|&last| self.previous(last)));
        }
        spokes
    }

    /// The vertices at the far ends of a star's spokes.
    pub(super) fn spoke_ends(&self, star: &Star) -> Vec<u32> {
        let mut ends: Vec<u32> = star.corners.iter().map(|&corner| self.tip(corner)).collect();
        if !star.closed {
            ends.extend(star.corners.last().map(|&last| self.vertex(self.previous(last))));
        }
        ends
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn build(vertices: usize, faces: &[&[u32]]) -> (Topology, Option<EdgeFault>) {
        let mut starts = vec![0];
        starts.extend(faces.iter().scan(0, |sum, face| {
            *sum += face.len() as u32;
            Some(*sum)
        }));
        Topology::build(vertices, starts, faces.concat())
    }

    /// A square and a triangle that share the edge from 1 to 2.
    fn house() -> Topology {
        let (topology, fault) = build(5, &[&[0, 1, 2, 3], &[1, 4, 2]]);
        assert_eq!(fault, None);
        topology
    }

    #[test]
    fn neighbours_of_a_square_and_a_triangle() {
        let house = house();
        assert_eq!((house.face_count(), house.edge_count(), house.corner_count()), (2, 6, 7));
        assert_eq!(house.twin(1), 6); // 1 → 2 and 2 → 1
        assert_eq!(house.edge(1), house.edge(6));
        assert_eq!((house.next(3), house.previous(0), house.next(6)), (0, 3, 4));
        assert_eq!(house.edge_between(2, 1), Some(house.edge(1)));
        assert_eq!(house.edge_between(0, 2), None);
        assert_eq!(house.edge_between(0, 3), Some(house.edge(3)));
        for corner in 0..7 {
            let [a, b] = house.edge_ends(corner);
            assert_eq!(house.edge_between(a, b), Some(house.edge(corner)));
            assert_eq!(house.edge_between(b, a), Some(house.edge(corner)));
        }
    }

    #[test]
    fn stars_run_counterclockwise_from_border_to_border() {
        let house = house();
        let star = house.star(1);
        assert!(!star.closed);
        assert_eq!(house.spoke_ends(&star), [4, 2, 0]);
        // A tetrahedron, where every star closes.
        let (solid, fault) = build(4, &[&[0, 2, 1], &[0, 1, 3], &[1, 2, 3], &[2, 0, 3]]);
        assert_eq!(fault, None);
        for vertex in 0..4 {
            let star = solid.star(vertex);
            assert!(star.closed && star.corners.len() == 3);
            assert_eq!(solid.spokes(&star).len(), 3);
        }
    }

    #[test]
    fn edges_at_fault_are_found() {
        let third = build(5, &[&[0, 1, 2], &[1, 0, 3], &[0, 1, 4]]).1;
        assert_eq!(third, Some(EdgeFault { corners: vec![0, 3, 6] }));
        let same_way = build(4, &[&[0, 1, 2], &[0, 1, 3]]).1;
        assert_eq!(same_way, Some(EdgeFault { corners: vec![0, 3] }));
    }
}
