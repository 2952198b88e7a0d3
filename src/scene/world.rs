//! A scene ready to trace.

use std::collections::{HashMap, HashSet};

use glam::DAffine3;

use super::framing::{BoundingSphere, default_lights};
use super::{
    Camera, Light, Material, Object, Part, RenderDefaults, Rgb, Scene, SceneError, SceneFault,
    Shape, Texture, UnknownName, Written,
};
use crate::geometry::NurbsSurface;
use crate::intersect::{BuildOptions, SurfaceBvh};

/// A scene ready to trace: surfaces in their places, a camera, lights.
#[derive(Debug)]
pub struct World {
    /// The surfaces in their hierarchy; a hit's surface is an index into [`World::surfaces`].
    pub bvh: SurfaceBvh,
    /// The surfaces in the order of the scene.
    pub surfaces: Vec<Instance>,
    /// What the surfaces' `material` indices mean.
    pub materials: Vec<Material>,
    /// The lights; never empty.
    pub lights: Vec<Light>,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// The radiance of rays that meet nothing.
    pub background: Rgb,
    /// The picture the scene asks for.
    pub settings: RenderDefaults,
}

/// A surface in its place.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its name, unique in the world.
    pub name: String,
    /// The surface, placed in the world; its domain is as authored.
    pub surface: NurbsSurface,
    /// Its material, an index into [`World::materials`].
    pub material: usize,
}

/// The name of the material of objects that name none. A scene may describe it.
const DEFAULT_MATERIAL: &str = "default";

/// Light grey, as plaster is.
const DEFAULT_COLOR: Rgb = [0.8; 3];

/// Paler than what stands in shade, darker than what stands in light, a little blue: every
/// silhouette shows.
const DEFAULT_BACKGROUND: Rgb = [0.32, 0.38, 0.45];

impl World {
    /// Checks a scene and makes it ready to trace.
    ///
    /// # Errors
    /// When a surface, a transform or the camera is not one, a name is unknown or taken,
    /// there is nothing to show, or too much; the error says where it was written.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        check_point_count(scene)?;
        let (surfaces, materials) = place_objects(scene)?;

        let Some(sphere) = BoundingSphere::of(surfaces.iter().map(|instance| &instance.surface))
        else {
            let fault = SceneFault::Empty { notes: scene.notes.clone() };
            return Err(SceneError::new(scene.place.clone(), fault));
        };
        let camera = scene.camera.camera(sphere).map_err(|error| {
            SceneError::new(scene.camera.place.clone(), SceneFault::Camera(error))
        })?;
        let lights =
            if scene.lights.is_empty() { default_lights(&camera) } else { scene.lights.clone() };

        let nets: Vec<_> = surfaces.iter().map(|instance| instance.surface.clone()).collect();
        let bvh = SurfaceBvh::build(&nets, &BuildOptions::default())
            .map_err(|error| SceneError::new(scene.place.clone(), SceneFault::Build(error)))?;
        let background = scene.background.unwrap_or(DEFAULT_BACKGROUND);
        let settings = scene.settings.clone();
        Ok(Self { bvh, surfaces, materials, lights, camera, background, settings })
    }
}

/// Refuses what would not fit in memory before any of it is copied.
fn check_point_count(scene: &Scene) -> Result<(), SceneError> {
    let points = scene.objects.iter().map(Object::point_count).fold(0, usize::saturating_add);
    if points > Scene::MAX_POINTS {
        let fault = SceneFault::TooManyPoints { points, limit: Scene::MAX_POINTS };
        return Err(SceneError::new(scene.place.clone(), fault));
    }
    Ok(())
}

fn check_unique<'a>(
    what: &'static str,
    names: impl Iterator<Item = (&'a str, &'a super::Place)>,
) -> Result<(), SceneError> {
    let mut seen = HashMap::new();
    for (name, place) in names {
        if let Some(first) = seen.insert(name, place) {
            let (name, first) = (name.to_owned(), first.clone());
            let fault = SceneFault::Duplicate { what, name, first };
            return Err(SceneError::new(place.clone(), fault));
        }
    }
    Ok(())
}

fn place_objects(scene: &Scene) -> Result<(Vec<Instance>, Vec<Material>), SceneError> {
    let given = scene.objects.iter().filter_map(|object| object.name.as_ref());
    check_unique("object", given.clone().map(|name| (name.value.as_str(), &name.place)))?;

    // Names that are given are kept; others move out of their way.
    let mut taken: HashSet<String> = given.map(|name| name.value.clone()).collect();
    let mut palette = Palette::new(scene)?;
    let mut instances = Vec::new();
    for object in &scene.objects {
        let name = match &object.name {
            Some(name) => name.value.clone(),
            None => free_name(&object.default_name, &mut taken),
        };
        let material = palette.index(&name, object)?;
        let world_from_object = affine(&name, object)?;
        for (index, part) in object.parts.iter().enumerate() {
            let name = match part.name.as_str() {
                "" if object.parts.len() == 1 => name.clone(),
                "" => free_name(&format!("{name}/{index}"), &mut taken),
                part => free_name(&format!("{name}/{part}"), &mut taken),
            };
            let surface = place_part(&name, part, &world_from_object)?;
            let surface = if object.reverse { surface.reversed_u() } else { surface };
            instances.push(Instance { name, surface, material });
        }
    }
    Ok((instances, palette.materials))
}

/// The name itself if it is free, else the first of `name 2`, `name 3`, … that is.
fn free_name(name: &str, taken: &mut HashSet<String>) -> String {
    let mut free = name.to_owned();
    let mut number = 1;
    while !taken.insert(free.clone()) {
        number += 1;
        free = format!("{name} {number}");
    }
    free
}

/// The materials so far, found by name.
struct Palette {
    materials: Vec<Material>,
    by_name: HashMap<String, usize>,
}

impl Palette {
    fn new(scene: &Scene) -> Result<Self, SceneError> {
        let names = scene.materials.iter().map(|m| (m.value.name.as_str(), &m.place));
        check_unique("material", names)?;
        let materials: Vec<_> = scene.materials.iter().map(|m| m.value.clone()).collect();
        let by_name = materials.iter().enumerate().map(|(i, m)| (m.name.clone(), i)).collect();
        Ok(Self { materials, by_name })
    }

    /// The index of an object's material; the default one is made when first needed.
    fn index(&mut self, name: &str, object: &Object) -> Result<usize, SceneError> {
        let wanted = object.material.as_ref().map_or(DEFAULT_MATERIAL, |material| &material.value);
        if let Some(&index) = self.by_name.get(wanted) {
            return Ok(index);
        }
        if let Some(Written { value, place }) = &object.material {
            let known: Vec<_> = self.materials.iter().map(|m| m.name.as_str()).collect();
            let error = UnknownName::new("material", value, &known);
            let fault = SceneFault::Material { object: name.to_owned(), error };
            return Err(SceneError::new(place.clone(), fault));
        }
        let index = self.materials.len();
        let texture = Texture::Constant(DEFAULT_COLOR);
        self.materials.push(Material { name: DEFAULT_MATERIAL.to_owned(), texture });
        self.by_name.insert(DEFAULT_MATERIAL.to_owned(), index);
        Ok(index)
    }
}

/// All steps of an object's transform, the first one first.
fn affine(name: &str, object: &Object) -> Result<DAffine3, SceneError> {
    object.transform.iter().try_fold(DAffine3::IDENTITY, |before, step| {
        let step_affine = step.value.affine().map_err(|error| {
            let fault = SceneFault::Transform { object: name.to_owned(), error };
            SceneError::new(step.place.clone(), fault)
        })?;
        Ok(step_affine * before)
    })
}

fn place_part(
    name: &str,
    part: &Part,
    world_from_object: &DAffine3,
) -> Result<NurbsSurface, SceneError> {
    let surface = match &part.shape {
        Shape::Net(net) => net.surface().map_err(|fault| {
            let place = net.place(fault.blame).clone();
            let fault = SceneFault::Surface { surface: name.to_owned(), error: fault.error };
            SceneError::new(place, fault)
        })?,
        Shape::Named(shape) => shape.surface().map_err(|error| {
            let fault = SceneFault::Shape { surface: name.to_owned(), error };
            SceneError::new(part.place.clone(), fault)
        })?,
    };
    if *world_from_object == DAffine3::IDENTITY {
        return Ok(surface); // bit for bit as authored
    }
    surface.transformed(world_from_object).map_err(|error| {
        let fault = SceneFault::Placed { surface: name.to_owned(), error };
        SceneError::new(part.place.clone(), fault)
    })
}
