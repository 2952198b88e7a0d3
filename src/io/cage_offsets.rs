//! Byte offsets of the parts of a cage in its text.

use crate::geometry::{CageError, Feature};

/// Offsets of the vertices, faces, creases and corners of a cage, in their order.
#[derive(Debug, Default)]
pub(super) struct CageOffsets {
    pub(super) vertices: Vec<usize>,
    pub(super) faces: Vec<usize>,
    pub(super) creases: Vec<usize>,
    pub(super) corners: Vec<usize>,
}

impl CageOffsets {
    /// Returns the offset of the part that an error names.
    pub(super) fn of(&self, error: &CageError) -> Option<usize> {
        let (list, index) = match error {
            CageError::FewCorners { face, .. }
            | CageError::NoSuchVertex { face, .. }
            | CageError::RepeatedVertex { face, .. } => (&self.faces, *face),
            CageError::NonManifoldEdge { faces, .. } => (&self.faces, *faces.last()?),
            CageError::Orientation { faces, .. } | CageError::SameFace { faces } => {
                (&self.faces, faces[1])
            }
            CageError::Position { vertex, .. }
            | CageError::IsolatedVertex { vertex }
            | CageError::NonManifoldVertex { vertex, .. } => (&self.vertices, *vertex),
            CageError::NoSuchEdge { crease, .. } => (&self.creases, *crease),
            CageError::NoSuchCorner { corner, .. } => (&self.corners, *corner),
            CageError::Sharpness { feature, index, .. }
            | CageError::TwoSharpnesses { feature, index, .. } => match feature {
                Feature::Crease => (&self.creases, *index),
                Feature::Corner => (&self.corners, *index),
            },
            _ => return None,
        };
        list.get(index).copied()
    }
}
