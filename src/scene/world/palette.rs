//! The materials of a scene, and the default one of objects that name none.

use std::collections::HashMap;

use super::unique_names::check_unique;
use crate::scene::errors::{SceneError, SceneFault};
use crate::scene::look::{Material, Rgb, Texture};
use crate::scene::written::{Object, Scene, UnknownName, Written};

/// The name of the material of objects that name none. A scene may describe it.
const DEFAULT_MATERIAL: &str = "default";

/// Light grey, as plaster is.
const DEFAULT_COLOR: Rgb = [0.8; 3];

/// The materials so far, found by name.
pub(super) struct Palette {
    materials: Vec<Material>,
    /// The materials that the scene describes.
    by_name: HashMap<String, usize>,
    /// The material of objects that name none, once there is one.
    default: Option<usize>,
}

impl Palette {
    pub(super) fn new(scene: &Scene) -> Result<Self, SceneError> {
        let names = scene.materials.iter().map(|m| (m.value.name.as_str(), &m.place));
        check_unique("material", names)?;
        let materials: Vec<_> = scene.materials.iter().map(|m| m.value.clone()).collect();
        let by_name: HashMap<_, _> =
            materials.iter().enumerate().map(|(i, m)| (m.name.clone(), i)).collect();
        let default = by_name.get(DEFAULT_MATERIAL).copied();
        Ok(Self { materials, by_name, default })
    }

    /// The index of an object's material; the default one is made when first needed.
    pub(super) fn index(&mut self, name: &str, object: &Object) -> Result<usize, SceneError> {
        let Some(Written { value, place }) = &object.material else {
            return Ok(self.default());
        };
        self.by_name.get(value).copied().ok_or_else(|| {
            let mut known: Vec<_> = self.by_name.iter().collect();
            known.sort_by_key(|(_, index)| **index); // as written
            let known: Vec<_> = known.into_iter().map(|(name, _)| name.as_str()).collect();
            let error = UnknownName::new("material", value, &known);
            let fault = SceneFault::Material { object: name.to_owned(), error };
            SceneError::new(place.clone(), fault)
        })
    }

    /// All of them, in the order of their indices.
    pub(super) fn into_materials(self) -> Vec<Material> {
        self.materials
    }

    fn default(&mut self) -> usize {
        *self.default.get_or_insert_with(|| {
            let texture = Texture::Constant(DEFAULT_COLOR);
            self.materials.push(Material { name: DEFAULT_MATERIAL.to_owned(), texture });
            self.materials.len() - 1
        })
    }
}
