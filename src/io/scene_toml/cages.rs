//! Subdivision surfaces in a scene file.

use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;
use toml::Spanned;

use super::values::Point;
use super::{LoadError, Reader};
use crate::geometry::{BoundaryRule, Cage, CageParts, Corner, Crease};
use crate::io::cage_offsets::CageOffsets;
use crate::io::keyed::{Keyed, Named};
use crate::io::nearby::stem;
use crate::scene::{Place, Scheme, Shape, Subdivision};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SubdivisionKeys {
    file: Option<Spanned<String>>,
    points: Option<Vec<Spanned<Point>>>,
    faces: Option<Vec<Spanned<Vec<usize>>>>,
    #[serde(default)]
    creases: Vec<Spanned<Keyed<SharpKeys>>>,
    #[serde(default)]
    corners: Vec<Spanned<Keyed<SharpKeys>>>,
    boundary: Option<Spanned<Named<BoundaryKey>>>,
    tolerance: Option<Spanned<f64>>,
}

/// Vertices, and the sharpness of these, or of the edges between them.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SharpKeys {
    vertices: Spanned<Vec<usize>>,
    sharpness: f64,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
enum BoundaryKey {
    EdgeAndCorner,
    EdgeOnly,
}

impl Reader<'_, '_> {
    /// Returns the surface, and before it the name to use if none is given.
    pub(super) fn subdivision(
        &mut self,
        scheme: Scheme,
        (called, place): (Option<&str>, &Place),
        mut keys: SubdivisionKeys,
    ) -> Result<(String, Subdivision), LoadError> {
        let tolerance = keys.tolerance.take().map(|value| self.written(value, |value| value));
        let kind = scheme.name();
        if let (Scheme::DooSabin, Some(boundary)) = (scheme, &keys.boundary) {
            let message = "doo_sabin: boundary says nothing here, as these surfaces end inside of \
                           the cage's border: it goes with catmull_clark";
            return Err(LoadError::malformed(self.source.place(boundary.span().start), message));
        }
        let inline = keys.points.is_some()
            || keys.faces.is_some()
            || !keys.creases.is_empty()
            || !keys.corners.is_empty()
            || keys.boundary.is_some();
        let (name, cage) = match keys.file.take() {
            Some(file) if inline => {
                let with = match scheme {
                    Scheme::CatmullClark => " with creases, corners and boundary",
                    Scheme::DooSabin => "",
                };
                let message =
                    format!("{kind}: needed is a file, or points and faces{with}, not both");
                return Err(LoadError::malformed(self.source.place(file.span().start), message));
            }
            Some(file) => {
                let place = self.source.place(file.span().start);
                let path = Path::new(file.get_ref());
                let stem = stem(path);
                let model = (self.read_model)(path, called.unwrap_or(&stem), &place)?;
                self.notes.extend(model.notes);
                let Some(Shape::Subdivision(model)) = model.parts.first().map(|part| &part.shape)
                else {
                    let message = format!("{kind} needs a cage (.obj): this file has surfaces");
                    return Err(LoadError::malformed(place, message));
                };
                (stem, Arc::clone(&model.cage))
            }
            None => (kind.to_owned(), Arc::new(self.cage(kind, (called, place), keys)?)),
        };
        Ok((name, Subdivision { cage, scheme, tolerance }))
    }

    fn cage(
        &self,
        kind: &str,
        (called, place): (Option<&str>, &Place),
        keys: SubdivisionKeys,
    ) -> Result<Cage, LoadError> {
        let (Some(points), Some(faces)) = (keys.points, keys.faces) else {
            let message = format!("{kind}: needed are points and faces, or a file");
            return Err(LoadError::malformed(place.clone(), message));
        };
        let mut offsets = CageOffsets {
            vertices: points.iter().map(|point| point.span().start).collect(),
            faces: faces.iter().map(|face| face.span().start).collect(),
            ..CageOffsets::default()
        };
        let mut parts = CageParts {
            positions: points.into_iter().map(|point| point.into_inner().0).collect(),
            faces: faces.into_iter().map(Spanned::into_inner).collect(),
            boundary: match keys.boundary.map(|boundary| boundary.into_inner().0) {
                Some(BoundaryKey::EdgeOnly) => BoundaryRule::EdgeOnly,
                Some(BoundaryKey::EdgeAndCorner) | None => BoundaryRule::EdgeAndCorner,
            },
            ..CageParts::default()
        };
        for crease in keys.creases {
            let offset = crease.span().start;
            let Keyed(SharpKeys { vertices, sharpness }) = crease.into_inner();
            if vertices.get_ref().len() < 2 {
                let place = self.source.place(vertices.span().start);
                let message = "a crease runs along edges: it needs two vertices or more";
                return Err(LoadError::malformed(place, message));
            }
            for pair in vertices.get_ref().windows(2) {
                parts.creases.push(Crease { vertices: [pair[0], pair[1]], sharpness });
                offsets.creases.push(offset);
            }
        }
        for corner in keys.corners {
            let offset = corner.span().start;
            let Keyed(SharpKeys { vertices, sharpness }) = corner.into_inner();
            for &vertex in vertices.get_ref() {
                parts.corners.push(Corner { vertex, sharpness });
                offsets.corners.push(offset);
            }
        }
        Cage::new(parts).map_err(|error| {
            let at = offsets.of(&error).map(|offset| self.source.place(offset));
            let called = called.unwrap_or(kind);
            let message = format!("surface \"{called}\": {error}");
            LoadError::malformed(at.unwrap_or_else(|| place.clone()), message)
        })
    }
}
