//! Why polygons cannot be the cage of a subdivision surface.

use std::fmt;

use glam::DVec3;
use thiserror::Error;

use crate::geometry::{MAX_MAGNITUDE, SurfaceError};
use crate::math::{Counted, Shown, ShownVector};

/// Why polygons cannot be the cage of a subdivision surface. Vertices and faces are counted
/// from 0.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum CageError {
    /// There is no face.
    #[error("the cage has no faces")]
    Empty,
    /// There are too many corners to count.
    #[error("the cage has {corners} corners of faces: at most {limit} can be handled")]
    TooLarge {
        /// The sum of all faces' corners, or the number of vertices.
        corners: usize,
        /// The largest number.
        limit: usize,
    },
    /// A position is NaN or infinite, or so large that sums overflow.
    #[error(
        "vertex {vertex} is {}: coordinates must be finite (up to {MAX_MAGNITUDE:e})",
        ShownVector(*.position)
    )]
    Position {
        /// Which vertex.
        vertex: usize,
        /// Where it is.
        position: DVec3,
    },
    /// A face has too few corners.
    #[error("face {face} has {}: it needs 3 or more", Counted(*.corners, "corner"))]
    FewCorners {
        /// Which face.
        face: usize,
        /// How many it has.
        corners: usize,
    },
    /// A face names a vertex that does not exist.
    #[error(
        "face {face} names vertex {vertex}, but there {} only {}",
        are(*.vertices), Counted(*.vertices, "vertex")
    )]
    NoSuchVertex {
        /// Which face.
        face: usize,
        /// The vertex it names.
        vertex: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A face names a vertex twice.
    #[error("face {face} names vertex {vertex} twice: its corners must differ")]
    RepeatedVertex {
        /// Which face.
        face: usize,
        /// The vertex.
        vertex: usize,
    },
    /// Two faces have the same corners.
    #[error(
        "faces {} and {} have the same vertices: they would cover each other", .faces[0], .faces[1]
    )]
    SameFace {
        /// The two faces.
        faces: [usize; 2],
    },
    /// More than two faces share an edge.
    #[error(
        "the edge between vertices {} and {} belongs to faces {}: at most two may share an edge",
        .vertices[0], .vertices[1], Listed(.faces)
    )]
    NonManifoldEdge {
        /// The ends of the edge.
        vertices: [usize; 2],
        /// All faces that have it.
        faces: Vec<usize>,
    },
    /// Two faces run along their common edge in the same direction.
    #[error(
        "faces {} and {} both run from vertex {} to vertex {}: one of them is inside out",
        .faces[0], .faces[1], .vertices[0], .vertices[1]
    )]
    Orientation {
        /// The ends of the edge.
        vertices: [usize; 2],
        /// The two faces.
        faces: [usize; 2],
    },
    /// No face has the vertex.
    #[error("vertex {vertex} belongs to no face")]
    IsolatedVertex {
        /// Which vertex.
        vertex: usize,
    },
    /// The faces around a vertex form separate fans that touch only there.
    #[error(
        "vertex {vertex}: its {faces} faces form separate fans (one of {fan}) that touch in \
         this vertex only"
    )]
    NonManifoldVertex {
        /// Which vertex.
        vertex: usize,
        /// The number of its faces.
        faces: usize,
        /// The number of faces connected with the first.
        fan: usize,
    },
    /// A crease is requested where there is no edge.
    #[error("crease {crease}: there is no edge between vertices {} and {}", .vertices[0], .vertices[1])]
    NoSuchEdge {
        /// Which crease.
        crease: usize,
        /// The vertices it names.
        vertices: [usize; 2],
    },
    /// A sharp corner is requested where there is no vertex.
    #[error(
        "corner {corner} names vertex {vertex}, but there {} only {}",
        are(*.vertices), Counted(*.vertices, "vertex")
    )]
    NoSuchCorner {
        /// Which corner.
        corner: usize,
        /// The vertex it names.
        vertex: usize,
        /// The number of vertices.
        vertices: usize,
    },
    /// A sharpness is out of range.
    #[error("{feature} {index} has sharpness {sharpness}: it must be from 0 to 10, or infinite")]
    Sharpness {
        /// What should be sharp.
        feature: Feature,
        /// Its index.
        index: usize,
        /// The number.
        sharpness: f64,
    },
    /// The same edge or vertex is given two sharpnesses.
    #[error("{feature} {index} gives sharpness {sharpness} to what has sharpness {other} already")]
    TwoSharpnesses {
        /// What should be sharp.
        feature: Feature,
        /// Its index.
        index: usize,
        /// Its sharpness.
        sharpness: f64,
        /// The sharpness given before.
        other: f64,
    },
}

impl CageError {
    /// The same error in the numbers of a larger cage, of whose vertices and faces only some were
    /// kept. `kept` and `kept_faces` give the original number of each; `count` is the number of
    /// vertices.
    #[must_use]
    pub(crate) fn of_kept(
        mut self,
        (kept, count): (&[usize], usize),
        kept_faces: &[usize],
    ) -> Self {
        let told = |number: &mut usize, kept: &[usize]| {
            *number = *kept.get(*number).unwrap_or(number);
        };
        let told_vertex = |vertex: &mut usize| told(vertex, kept);
        let told_face = |face: &mut usize| told(face, kept_faces);
        match &mut self {
            Self::Position { vertex, .. }
            | Self::IsolatedVertex { vertex }
            | Self::NonManifoldVertex { vertex, .. } => told_vertex(vertex),
            Self::NoSuchEdge { vertices, .. } => vertices.iter_mut().for_each(told_vertex),
            Self::RepeatedVertex { face, vertex } => {
                told_face(face);
                told_vertex(vertex);
            }
            Self::NonManifoldEdge { vertices, faces } => {
                vertices.iter_mut().for_each(told_vertex);
                faces.iter_mut().for_each(told_face);
            }
            Self::Orientation { vertices, faces } => {
                vertices.iter_mut().for_each(told_vertex);
                faces.iter_mut().for_each(told_face);
            }
            Self::SameFace { faces } => faces.iter_mut().for_each(told_face),
            Self::FewCorners { face, .. } => told_face(face),
            Self::NoSuchVertex { face, vertices, .. } => {
                told_face(face);
                *vertices = count;
            }
            Self::NoSuchCorner { vertices, .. } => *vertices = count,
            Self::Empty
            | Self::TooLarge { .. }
            | Self::Sharpness { .. }
            | Self::TwoSharpnesses { .. } => {}
        }
        self
    }
}

/// What can be sharp.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Feature {
    /// An edge.
    Crease,
    /// A vertex.
    Corner,
}

impl fmt::Display for Feature {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Crease => "crease",
            Self::Corner => "corner",
        })
    }
}

/// The verb form for this number of things.
fn are(count: usize) -> &'static str {
    if count == 1 { "is" } else { "are" }
}

/// Displays numbers as in `1, 2 and 3`.
struct Listed<'a>(&'a [usize]);

impl fmt::Display for Listed<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, number) in self.0.iter().enumerate() {
            let before = match index {
                0 => "",
                _ if index + 1 == self.0.len() => " and ",
                _ => ", ",
            };
            write!(f, "{before}{number}")?;
        }
        Ok(())
    }
}

/// Why a limit surface cannot be computed to a tolerance.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum LimitError {
    /// The tolerance is not a length, or is finer than the arithmetic allows.
    #[error(
        "tolerance {}: for a cage of this size with coordinates up to {} it must be finite and at least {}",
        Shown(*.tolerance), Shown(*.magnitude), Shown(*.smallest)
    )]
    Tolerance {
        /// The tolerance, in scene units.
        tolerance: f64,
        /// The largest absolute coordinate of the cage.
        magnitude: f64,
        /// The smallest tolerance for the cage.
        smallest: f64,
    },
    /// There would be too many patches.
    #[error(
        "more than {limit} patches are needed for tolerance {}: a larger tolerance needs fewer, \
         and so do creases that are less sharp or go straight on",
        Shown(*.tolerance)
    )]
    TooManyPatches {
        /// The largest number of rectangles: the patches, and the rectangles through which they are
        /// found.
        limit: usize,
        /// The tolerance, in scene units.
        tolerance: f64,
    },
    /// The refinement did not reach the tolerance within the number of steps squares can be halved.
    #[error("tolerance {} is not reached after {levels} steps of refinement", Shown(*.tolerance))]
    TooDeep {
        /// The tolerance, in scene units.
        tolerance: f64,
        /// The number of steps.
        levels: u32,
    },
    /// The cage has creases or corners, which a Doo–Sabin surface cannot have.
    #[error(
        "{} and {} are sharp: Doo–Sabin surfaces have no creases",
        Counted(*.edges, "inner edge"), Counted(*.vertices, "inner vertex")
    )]
    Sharp {
        /// The number of sharp edges that are not on the boundary.
        edges: usize,
        /// The number of sharp vertices that are not on the boundary.
        vertices: usize,
    },
    /// A Doo–Sabin surface would have no patch at all.
    #[error(
        "all vertices are on the boundary: a Doo–Sabin surface lies around the vertices inside"
    )]
    NothingInside,
    /// The cage would not be valid.
    #[error("{0}")]
    Cage(CageError),
    /// The surface, like its cage, is only a point or a line, or reaches too far out.
    #[error("{0}")]
    Surface(Box<SurfaceError>),
    /// A face of the Doo–Sabin surface would have only two corners.
    #[error("vertex {vertex} has two faces: Doo–Sabin surfaces need three or more around it")]
    TwoFaces {
        /// Which vertex.
        vertex: usize,
    },
}
