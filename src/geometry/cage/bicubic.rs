//! The bicubic Bézier patch of a quad: exactly its part of the Catmull–Clark surface where
//! the quad is regular, close to it elsewhere.

use glam::DVec3;

use super::mesh::Mesh;
use super::net::Net;
use super::ring::Ring;
use super::topology::{NONE, Star};

/// How a vertex is regular, as seen from one of the quads around it. If it is, the quad's part of
/// the surface is that of a uniform B-spline, mirrored at sharp edges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Regular {
    /// Four quads, nothing sharp.
    Smooth,
    /// On an infinitely sharp crease, with two quads on this side.
    Crease,
    /// An infinitely sharp corner that belongs to this quad alone.
    Corner,
}

/// Whether the quad's part of the limit surface is a bicubic patch.
pub(super) fn is_regular(mesh: &Mesh, face: usize) -> bool {
    mesh.topology.face(face).len() == 4
        && mesh.topology.face_range(face).all(|corner| regular(mesh, corner as u32).is_some())
}

fn regular(mesh: &Mesh, corner: u32) -> Option<Regular> {
    let topology = &mesh.topology;
    let vertex = topology.vertex(corner);
    let star = topology.star(vertex);
    let settled = |sharpness: f64| sharpness == 0.0 || sharpness == f64::INFINITY;
    let creases = topology.spokes(&star).into_iter().map(|spoke| mesh.crease(spoke));
    let mut sharp_count = 0;
    for crease in creases {
        sharp_count += usize::from(crease > 0.0);
        if !settled(crease) {
            return None;
        }
    }
    let own = mesh.corners[vertex as usize];
    if !settled(own) || star.corners.iter().any(|&corner| topology.sides(corner) != 4) {
        return None;
    }
    let leaving = mesh.crease(corner) > 0.0;
    let arriving = mesh.crease(topology.previous(corner)) > 0.0;
    if own > 0.0 || sharp_count > 2 {
        return (leaving && arriving).then_some(Regular::Corner);
    }
    match sharp_count {
        0 => (star.closed && star.corners.len() == 4).then_some(Regular::Smooth),
        2 => (leaving != arriving && mate_ends_sharp(mesh, corner, leaving))
            .then_some(Regular::Crease),
        _ => None,
    }
}

/// Whether the quad beyond the smooth edge at a corner ends at a sharp edge.
fn mate_ends_sharp(mesh: &Mesh, corner: u32, leaving_is_sharp: bool) -> bool {
    let topology = &mesh.topology;
    if leaving_is_sharp {
        let mate = topology.twin(topology.previous(corner));
        mate != NONE && mesh.crease(topology.previous(mate)) > 0.0
    } else {
        let twin = topology.twin(corner);
        twin != NONE && mesh.crease(topology.next(twin)) > 0.0
    }
}

/// The 4 × 4 control points, v fastest: u runs from corner 0 to corner 1, v from corner 0
/// to corner 3.
///
/// At regular corners they are those of the B-spline. Elsewhere the corner point is the limit
/// point, and the points beside it move with it. `None` where a limit point is unknown because not
/// all faces around the corner are quads. Quads that share an edge get the same bits for its
/// points, because each sum adds points on opposite sides first.
pub(super) fn net(mesh: &Mesh, face: usize) -> Option<Net> {
    /// The positions in the net of corner k's point, the one towards the next corner, the one
    /// towards the previous corner, and the inner one.
    const PLACES: [[usize; 4]; 4] = [[0, 4, 1, 5], [12, 13, 8, 9], [15, 11, 14, 10], [3, 2, 7, 6]];
    let topology = &mesh.topology;
    let mut net = [DVec3::ZERO; 16];
    for (places, corner) in PLACES.iter().zip(topology.face_range(face)) {
        let vertex = Vertex::of(mesh, corner as u32)?;
        let corner = corner as u32;
        net[places[0]] = vertex.limit;
        net[places[1]] = vertex.beside(mesh, corner, End::First);
        net[places[2]] = vertex.beside(mesh, topology.previous(corner), End::Last);
        net[places[3]] = vertex.inner(mesh, corner);
    }
    Some(net)
}

/// A corner of a quad: the limit point of its vertex and, if the corner is not regular, the ring.
struct Vertex {
    limit: DVec3,
    irregular: Option<(Star, Ring)>,
}

impl Vertex {
    fn of(mesh: &Mesh, corner: u32) -> Option<Self> {
        let topology = &mesh.topology;
        let vertex = topology.vertex(corner);
        let star = topology.star(vertex);
        let regular = regular(mesh, corner);
        if let (Some(Regular::Smooth), [a, b, c, d]) = (regular, &star.corners[..]) {
            let tip = |corner| mesh.positions[topology.tip(corner) as usize];
            let far = |corner| mesh.at(topology.next(topology.next(corner)));
            let spokes = (tip(*a) + tip(*c)) + (tip(*b) + tip(*d));
            let diagonals = (far(*a) + far(*c)) + (far(*b) + far(*d));
            let limit = (16.0 * mesh.at(corner) + 4.0 * spokes + diagonals) / 36.0;
            return Some(Self { limit, irregular: None });
        }
        let ring = Ring::of(mesh, vertex)?;
        let limit = ring.limit();
        Some(Self { limit, irregular: regular.is_none().then_some((star, ring)) })
    }

    /// The control point on an edge beside the limit point of one of its ends.
    ///
    /// On a sharp edge it is a third of the way along the edge. Otherwise it is the B-spline's,
    /// `(2 v' + w')/3`, from the rows across both ends with `v' = (a + 4 v + b)/6`; at a smooth
    /// extraordinary vertex it lies in the tangent plane; at other irregular vertices it is moved
    /// with the limit point and, if nothing is sharp that refinement makes smooth, into the tangent
    /// plane if there is one.
    fn beside(&self, mesh: &Mesh, half_edge: u32, end: End) -> DVec3 {
        let topology = &mesh.topology;
        let [first, last] = topology.edge_ends(half_edge).map(|end| mesh.positions[end as usize]);
        let (v, w) = if end == End::First { (first, last) } else { (last, first) };
        let twin = topology.twin(half_edge);
        if mesh.crease(half_edge) == f64::INFINITY || twin == NONE {
            return (2.0 * v + w) / 3.0;
        }
        let leaving = if end == End::First { half_edge } else { twin };
        if let Some((star, ring)) = &self.irregular
            && let Some(spoke) = star.corners.iter().position(|&corner| corner == leaving)
            && let Some(handle) = ring.handle(spoke)
        {
            return self.limit + handle;
        }

        let across_first =
            mesh.at(topology.previous(half_edge)) + mesh.at(topology.next(topology.next(twin)));
        let across_last =
            mesh.at(topology.next(topology.next(half_edge))) + mesh.at(topology.previous(twin));
        let (across_v, across_w) = if end == End::First {
            (across_first, across_last)
        } else {
            (across_last, across_first)
        };
        let (row_v, row_w) = ((4.0 * v + across_v) / 6.0, (4.0 * w + across_w) / 6.0);
        match &self.irregular {
            None => (2.0 * row_v + row_w) / 3.0,
            Some((star, ring)) => {
                let along = (row_w - row_v) / 3.0;
                let spoke = star.corners.iter().position(|&corner| corner == leaving);
                let normal = spoke.filter(|_| !ring.is_semi_sharp()).and_then(|k| ring.normal(k));
                self.limit + normal.map_or(along, |normal| along.reject_from_normalized(normal))
            }
        }
    }

    /// The inner control point of a corner: `(n v + 2 a + 2 b + c)/(n + 5)` (Loop & Schaefer 2008).
    /// n is the number of edges at irregular vertices; n = 4 gives the B-spline's point.
    fn inner(&self, mesh: &Mesh, corner: u32) -> DVec3 {
        let topology = &mesh.topology;
        let n = match &self.irregular {
            Some((star, _)) if star.closed => star.corners.len() as f64,
            _ => 4.0,
        };
        let (next, previous) = (topology.next(corner), topology.previous(corner));
        let sides = mesh.at(next) + mesh.at(previous);
        (n * mesh.at(corner) + 2.0 * sides + mesh.at(topology.next(next))) / (n + 5.0)
    }
}

/// An end of a half-edge.
#[derive(Clone, Copy, PartialEq, Eq)]
enum End {
    First,
    Last,
}
