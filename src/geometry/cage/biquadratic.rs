//! The Doo–Sabin limit surface as biquadratic patches, by feature-adaptive refinement.

use glam::DVec3;

use super::Cage;
use super::batches::{batches, first_units, patches};
use super::doo_sabin::refined;
use super::error::LimitError;
use super::limit_surface::{FaceRect, LimitSurface};
use super::mesh::Mesh;
use super::net::Net;
use super::seams::within;
use super::topology::NONE;
use super::tree::{Cut, MAX_LEVELS, Tree};
use crate::geometry::RectSide;
use crate::math::Aabb;

/// A vertex of the current mesh with four faces around it. The patch over it extends to the middles
/// of these faces.
#[derive(Clone, Copy, Debug)]
struct Element {
    /// The corner at this vertex in the face whose middle is (u, v) = (0, 0).
    first: u32,
    /// Its square.
    node: u32,
}

/// A mesh and the vertices of it that are to be processed; the others only surround them.
type Level = (Mesh, Vec<Element>);

impl Cage {
    /// The Doo–Sabin limit surface to a tolerance in scene units, see [`LimitSurface`].
    ///
    /// A vertex with four quads around it gives a biquadratic patch. Vertices at other faces are
    /// refined until the remainder is proved to be within the tolerance, as in
    /// [`Cage::catmull_clark`]. The squares are those of Catmull–Clark surfaces: each corner of a
    /// face gives the patch that reaches from its vertex to the face's middle.
    ///
    /// At the boundary the surface ends inside the cage, as a uniform B-spline does: corners at
    /// boundary vertices give no patch.
    ///
    /// # Errors
    /// When the tolerance is not a length, is less than [`Cage::smallest_tolerance`], or would need
    /// millions of patches; when inner edges or vertices are sharp, which this scheme does not
    /// support; when all vertices are on the boundary; when a vertex has two faces.
    pub fn doo_sabin(&self, tolerance: f64) -> Result<LimitSurface, LimitError> {
        check(self.mesh())?;
        let batches = batches(&self.mesh().topology);
        within(tolerance, self.mesh(), |share| self.doo_sabin_patches((tolerance, share), &batches))
    }

    /// The patches within a share of the tolerance; where they are not exact they may not meet.
    pub(super) fn doo_sabin_patches(
        &self,
        (tolerance, share): (f64, f64),
        batches: &[Vec<u32>],
    ) -> Result<LimitSurface, LimitError> {
        let units = first_units(&self.mesh().topology);
        let once = refined(self.mesh());
        patches((self, batches), 2, (tolerance, share), |faces, tree| {
            let mut elements = Vec::new();
            for &face in faces {
                let place = (face as usize, units[face as usize]);
                start(self.mesh(), &once, place, (tree, &mut elements))?;
            }
            let mut level = settle(&once, &elements, tree)?;
            for _ in 0..MAX_LEVELS {
                let Some((mesh, elements)) = &level else { return Ok(()) };
                level = settle(mesh, elements, tree)?;
            }
            match level {
                None => Ok(()),
                Some(_) => Err(LimitError::TooDeep { tolerance, levels: MAX_LEVELS }),
            }
        })
    }
}

/// Refuses cages that have no Doo–Sabin surface.
fn check(mesh: &Mesh) -> Result<(), LimitError> {
    let topology = &mesh.topology;
    let inner_edge = |edge: usize| topology.twin(topology.edge_corner(edge)) != NONE;
    let edges = (0..topology.edge_count()).filter(|&e| mesh.creases[e] > 0.0 && inner_edge(e));
    let mut inside = 0;
    let mut vertices = 0;
    for vertex in 0..topology.vertex_count() {
        let star = topology.star(vertex as u32);
        if star.closed && star.corners.len() < 3 {
            return Err(LimitError::TwoFaces { vertex });
        }
        inside += usize::from(star.closed);
        vertices += usize::from(star.closed && mesh.corners[vertex] > 0.0);
    }
    match edges.count() {
        0 if vertices == 0 && inside > 0 => Ok(()),
        0 if vertices == 0 => Err(LimitError::NothingInside),
        edges => Err(LimitError::Sharp { edges, vertices }),
    }
}

/// Adds the elements of a face's corners in the mesh after the first step, which has a vertex for
/// each corner of the cage.
fn start(
    mesh: &Mesh,
    once: &Mesh,
    (face, unit): (usize, usize),
    (tree, elements): (&mut Tree<'_>, &mut Vec<Element>),
) -> Result<(), LimitError> {
    let topology = &mesh.topology;
    let range = topology.face_range(face);
    let sides = range.len();
    for (k, corner) in range.enumerate() {
        if !topology.star(topology.vertex(corner as u32)).closed {
            continue;
        }
        // The middle of the face around the vertex is at corner k of a quad, at (0, 0) of other
        // squares.
        let (rect, turn) = if sides == 4 {
            (FaceRect::whole(face, unit).quarter(k), k)
        } else {
            (FaceRect::whole(face, unit + k), 0)
        };
        let node = tree.add_root(rect, borders(mesh, corner as u32, turn))?;
        elements.push(Element { first: first_corner(once, corner as u32, turn), node });
    }
    Ok(())
}

/// Which sides of a corner's patch are borders of the surface: those towards neighbours in the same
/// face that give no patch. The result is turned by `turn` quarters: at corner 0 of a square, u
/// runs towards the next corner, v towards the previous one.
fn borders(mesh: &Mesh, corner: u32, turn: usize) -> [bool; 4] {
    /// Counterclockwise, from the one towards which u grows.
    const AROUND: [RectSide; 4] =
        [RectSide::LastU, RectSide::LastV, RectSide::FirstU, RectSide::FirstV];
    let topology = &mesh.topology;
    let open = |corner: u32| !topology.star(topology.vertex(corner)).closed;
    let next = open(topology.next(corner));
    let previous = open(topology.previous(corner));
    let mut border = [false; 4];
    border[AROUND[turn % 4]] = next;
    border[AROUND[(turn + 1) % 4]] = previous;
    border
}

/// The corner at (0, 0) of a new vertex.
///
/// `in_face` is its corner in the shrunken face. Around the new vertex lie, counterclockwise from
/// the face around the old vertex: that face, the face along the edge that leaves, the shrunken
/// face, the face along the edge that arrives. The first of these is at corner `turn`.
fn first_corner(refined: &Mesh, in_face: u32, turn: usize) -> u32 {
    let topology = &refined.topology;
    let steps = (4 - turn % 4 + 2) % 4;
    (0..steps).fold(in_face, |corner, _| topology.twin(topology.previous(corner)))
}

/// The four corners of an element, counterclockwise from (0, 0).
fn corners(mesh: &Mesh, element: Element) -> [u32; 4] {
    let turned = |corner| mesh.topology.twin(mesh.topology.previous(corner));
    let first = element.first;
    let second = turned(first);
    let third = turned(second);
    [first, second, third, turned(third)]
}

fn settle(
    mesh: &Mesh,
    elements: &[Element],
    tree: &mut Tree<'_>,
) -> Result<Option<Level>, LimitError> {
    let topology = &mesh.topology;
    let mut kept = Vec::new();
    for &element in elements {
        let corners = corners(mesh, element);
        let patch = net(mesh, corners);
        if corners.iter().all(|&corner| topology.sides(corner) == 4) {
            tree.set_exact(element.node, patch);
        } else if !tree.end(element.node, patch, hull(mesh, corners)) {
            kept.push((corners, tree.open(element.node, Some(patch), Cut::Quarters)?));
        }
    }
    if kept.is_empty() {
        return Ok(None);
    }

    let part = mesh.part_around(kept.iter().map(|(corners, _)| topology.vertex(corners[0])));
    let mut number = vec![0; topology.face_count()];
    for (index, &old) in part.faces.iter().enumerate() {
        number[old as usize] = index;
    }
    let in_part = |corner: u32| {
        let face = topology.face_of(corner) as usize;
        let place = corner as usize - topology.face_range(face).start;
        (part.mesh.topology.face_range(number[face]).start + place) as u32
    };
    let once = refined(&part.mesh);
    let mut children = Vec::with_capacity(4 * kept.len());
    for (corners, first_child) in kept {
        for (k, corner) in corners.into_iter().enumerate() {
            // The middle of the face around the old vertex is opposite corner k, where the corner's
            // own face is.
            let first = first_corner(&once, in_part(corner), k + 2);
            children.push(Element { first, node: first_child + k as u32 });
        }
    }
    Ok(Some((once, children)))
}

/// The 3 × 3 control points, v fastest: the vertex, the middles of its edges, the centroids of its
/// faces. They are the B-spline's if all faces are quads; a centroid is always a point of the limit
/// surface.
fn net(mesh: &Mesh, corners: [u32; 4]) -> Net {
    /// The positions in the net of the face of corner k, and of the edge that leaves the corner.
    const PLACES: [[usize; 2]; 4] = [[0, 1], [6, 3], [8, 7], [2, 5]];
    let topology = &mesh.topology;
    let mut net = [DVec3::ZERO; 16];
    let vertex = mesh.at(corners[0]);
    net[4] = vertex;
    for (places, corner) in PLACES.iter().zip(corners) {
        net[places[0]] = mesh.centroid(topology.face_of(corner) as usize);
        net[places[1]] = 0.5 * (vertex + mesh.positions[topology.tip(corner) as usize]);
    }
    net
}

/// A box around the faces of an element. The surface over the element lies inside, because all
/// points of a refined mesh are means of those around them, with weights from 0 to 1.
fn hull(mesh: &Mesh, corners: [u32; 4]) -> Aabb {
    let faces = corners.map(|corner| mesh.topology.face_of(corner) as usize);
    let vertices = faces.iter().flat_map(|&face| mesh.topology.face(face));
    Aabb::around(vertices.map(|&vertex| mesh.positions[vertex as usize]))
}
