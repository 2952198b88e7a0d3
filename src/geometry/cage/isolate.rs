//! The Catmull–Clark limit surface as bicubic patches, by feature-adaptive refinement.

use super::Cage;
use super::batches::{batches, first_units, patches};
use super::bicubic::{is_regular, net};
use super::catmull_clark::refined;
use super::creased::CreasedQuad;
use super::error::LimitError;
use super::limit_surface::{FaceRect, LimitSurface};
use super::mesh::Mesh;
use super::seams::within;
use super::topology::{NONE, Topology};
use super::tree::{Cut, DEFAULT_TOLERANCE, MAX_LEVELS, Tree};
use crate::math::Aabb;

impl Cage {
    /// The Catmull–Clark limit surface to a tolerance in scene units, see
    /// [`LimitSurface`]; [`Cage::default_tolerance`] is a sensible one.
    ///
    /// Regular quads (four around each corner, or the mirrored halves and quarters of that
    /// at infinitely sharp creases, corners and boundaries) are bicubic patches. Quads beside a
    /// semi-sharp crease that goes straight on are a few bicubic strips. The others are refined
    /// (feature-adaptively: Nießner, Loop, Meyer & DeRose 2012) until the remainder is proved to be
    /// within the tolerance; then the largest squares that a single patch fits are used.
    ///
    /// # Errors
    /// When the tolerance is not a length, is less than [`Cage::smallest_tolerance`], or would need
    /// millions of patches.
    pub fn catmull_clark(&self, tolerance: f64) -> Result<LimitSurface, LimitError> {
        let batches = batches(&self.mesh().topology);
        within(tolerance, self.mesh(), |share| {
            self.catmull_clark_patches((tolerance, share), &batches)
        })
    }

    /// The patches within a share of the tolerance; where they are not exact they may not meet.
    pub(super) fn catmull_clark_patches(
        &self,
        (tolerance, share): (f64, f64),
        batches: &[Vec<u32>],
    ) -> Result<LimitSurface, LimitError> {
        let units = first_units(&self.mesh().topology);
        patches((self, batches), 3, (tolerance, share), |faces, tree| {
            let borders = Borders(&self.mesh().topology);
            let known = |&face: &u32| {
                let (cage_face, unit) = (face as usize, units[face as usize]);
                let is_quad = self.mesh().topology.face(cage_face).len() == 4;
                Ok(match is_quad {
                    true => {
                        let whole = FaceRect::whole(cage_face, unit);
                        (face, Known::Node(tree.add_root(whole, borders.of_quad(cage_face))?))
                    }
                    false => (face, Known::Polygon { face: cage_face, unit }),
                })
            };
            let faces = faces.iter().map(known).collect::<Result<Vec<_>, LimitError>>()?;
            let mut level = settle(self.mesh(), &faces, (tree, borders))?;
            for _ in 0..MAX_LEVELS {
                let Some((mesh, faces)) = &level else { return Ok(()) };
                level = settle(mesh, faces, (tree, borders))?;
            }
            match level {
                None => Ok(()),
                Some(_) => Err(LimitError::TooDeep { tolerance, levels: MAX_LEVELS }),
            }
        })
    }

    /// A tolerance for pictures: 1e-4 of the cage's largest side, a tenth of a pixel where that
    /// side spans a thousand pixels.
    ///
    /// It bounds the distance at the same (u, v), which near extraordinary vertices is mostly along
    /// the surface. Measured: there, patches of this tolerance are less than 1e-12 of the side off
    /// the surface, patches of ten times this tolerance about 1e-7. The tolerance is needed where
    /// semi-sharp creases meet, turn or end: there a crease of sharpness 6 is rounded over a 64th
    /// of a face, in as many patches as that takes; at 1e-3 it would take half as many and be 2e-4
    /// of the side off. Normals are compared, too, where they can be seen: at this tolerance, not
    /// at 1e-3, a patch is turned by no more than 5e-3 at places where the surface is known, before
    /// it is moved to meet its neighbours.
    pub fn default_tolerance(&self) -> f64 {
        let size = self.largest_side();
        // A cage very far from the origin, or one without extent, cannot have that tolerance.
        (DEFAULT_TOLERANCE * size).max(self.smallest_tolerance()).max(f64::MIN_POSITIVE)
    }
}

/// The sides of unit squares that lie on the cage's boundary.
#[derive(Clone, Copy)]
struct Borders<'a>(&'a Topology);

impl Borders<'_> {
    fn at(&self, corner: usize) -> bool {
        self.0.twin(corner as u32) == NONE
    }

    /// Which sides of a quad are borders, in the order of
    /// [`RectSide::ALL`](crate::geometry::RectSide::ALL).
    fn of_quad(&self, face: usize) -> [bool; 4] {
        let first = self.0.face_range(face).start;
        [3, 1, 0, 2].map(|k| self.at(first + k))
    }

    /// Which sides of the unit square at a corner of any other face are borders.
    fn of_corner(&self, face: usize, k: usize) -> [bool; 4] {
        let corner = self.0.face_range(face).start + k;
        [self.at(self.0.previous(corner as u32) as usize), false, self.at(corner), false]
    }
}

/// What the tree knows of a face of the current mesh.
#[derive(Clone, Copy, Debug)]
enum Known {
    /// It is this square.
    Node(u32),
    /// It is a face of the cage with squares of its own, from this one on.
    Polygon { face: usize, unit: usize },
}

/// A mesh and the faces of it that are to be processed; the others only surround them.
type Level = (Mesh, Vec<(u32, Known)>);

/// Sets the patches of the faces' squares, and refines the mesh where more is needed.
///
/// The refined part contains all faces at the vertices of each kept face. So the quads at these
/// vertices have the right corners, and they are all that surrounds the quads of the kept face.
/// What refinement makes of the part's other borders is not used again.
fn settle(
    mesh: &Mesh,
    faces: &[(u32, Known)],
    (tree, borders): (&mut Tree<'_>, Borders<'_>),
) -> Result<Option<Level>, LimitError> {
    let mut kept = Vec::new();
    for &(face, known) in faces {
        if let Known::Node(node) = known {
            let patch = net(mesh, face as usize);
            match patch {
                Some(patch) if is_regular(mesh, face as usize) => {
                    tree.set_exact(node, patch);
                    continue;
                }
                Some(patch) if tree.end(node, patch, hull(mesh, face as usize)) => continue,
                _ => {}
            }
            match CreasedQuad::of(mesh, face as usize) {
                Some(quad) => tree.set_strips(node, &quad)?,
                None => {
                    let first = tree.open(node, patch, Cut::Quarters)?;
                    kept.push((face, Next::Quarters(first)));
                }
            }
        } else if let Known::Polygon { face: cage_face, unit } = known {
            kept.push((face, Next::Units(cage_face, unit)));
        }
    }
    if kept.is_empty() {
        return Ok(None);
    }

    let vertices = kept.iter().flat_map(|&(face, _)| mesh.topology.face(face as usize));
    let part = mesh.part_around(vertices.copied());
    // Both lists are in the order of faces; the quads of a corner have the corner's number.
    let mut children = Vec::with_capacity(4 * kept.len());
    let mut kept = kept.into_iter().peekable();
    for (index, old) in part.faces.iter().enumerate() {
        let Some((_, next)) = kept.next_if(|(face, _)| face == old) else { continue };
        for (k, quad) in part.mesh.topology.face_range(index).enumerate() {
            let known = match next {
                Next::Quarters(first) => Known::Node(first + k as u32),
                Next::Units(face, unit) => {
                    let border = borders.of_corner(face, k);
                    Known::Node(tree.add_root(FaceRect::whole(face, unit + k), border)?)
                }
            };
            children.push((quad as u32, known));
        }
    }
    Ok(Some((refined(&part.mesh), children)))
}

/// What the quads of a kept face become.
#[derive(Clone, Copy, Debug)]
enum Next {
    /// Four consecutive squares from this one on.
    Quarters(u32),
    /// Unit squares of a face of the cage.
    Units(usize, usize),
}

/// A box around all faces that touch a face. The surface over the face lies inside, because all
/// points of a refined mesh are means of those around them, with weights from 0 to 1.
fn hull(mesh: &Mesh, face: usize) -> Aabb {
    let topology = &mesh.topology;
    let mut hull = Aabb::EMPTY;
    for &vertex in topology.face(face) {
        for corner in topology.star(vertex).corners {
            let around = topology.face(topology.face_of(corner) as usize);
            hull = around.iter().fold(hull, |hull, &v| hull.with(mesh.positions[v as usize]));
        }
    }
    hull
}
