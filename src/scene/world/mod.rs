//! A scene ready to trace: surfaces made by `making`, under names of their own, with the camera,
//! lights and the materials of `look`; those that the scene leaves open are chosen here. The
//! other modules of the scene do not know of a world.

mod framing;
mod palette;
mod spacing;
#[cfg(test)]
mod tests;
mod unique_names;

use crate::geometry::Surface;
use crate::intersect::{BuildError, Hit, SurfaceBvh};
use crate::scene::errors::{SceneError, SceneFault};
use crate::scene::look::{Camera, Light, Material, Rgb, check_amount};
use crate::scene::making::{Made, Placer};
use crate::scene::written::{Object, Place, RenderDefaults, Scene, Written};

use framing::{BoundingSphere, default_lights};
use palette::Palette;
use unique_names::{Naming, check_unique, joined};

/// A scene ready to trace: surfaces in their places, a camera, lights.
///
/// # Invariants
/// All parts are valid: they were checked by [`World::new`] or when they were replaced.
#[derive(Debug)]
pub struct World {
    pub(crate) bvh: SurfaceBvh,
    pub(crate) surfaces: Vec<Instance>,
    pub(crate) materials: Vec<Material>,
    pub(crate) lights: Vec<Light>,
    pub(crate) camera: Camera,
    pub(crate) background: Rgb,
    pub(crate) settings: RenderDefaults,
}

/// A surface in its place.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Its name, unique in the world.
    pub name: String,
    /// The index of its object in the scene, and of its part in the object.
    pub part: [usize; 2],
    /// The surface, placed in the world; its domain is as authored.
    pub surface: Surface,
    /// Its material, an index into [`World::materials`].
    pub material: usize,
    /// Error of the surface in space, against what the scene asks for: 0 if it is exact, a measured
    /// estimate if a construction had to approximate, a proved bound for limit surfaces.
    pub deviation: f64,
}

/// Paler than things in shade, darker than things in light, a little blue: every silhouette
/// shows.
const DEFAULT_BACKGROUND: Rgb = [0.32, 0.38, 0.45];

impl World {
    /// Checks a scene and makes it ready to trace. A camera without a given place shows the whole
    /// scene in pictures of the shape that its settings ask for.
    ///
    /// As [`SurfaceBvh::build`], it works with the threads of the rayon pool in which it is called.
    ///
    /// # Errors
    /// When a surface, a transform, a light, a colour or the camera is not valid, a name is unknown
    /// or taken, or there is nothing to show, or too much; the error says where the fault was
    /// written.
    pub fn new(scene: &Scene) -> Result<Self, SceneError> {
        Placed::new(scene)?.build()
    }

    /// The surfaces in their hierarchy; a hit's surface is an index into [`World::surfaces`].
    pub fn bvh(&self) -> &SurfaceBvh {
        &self.bvh
    }

    /// The surfaces in the order of the scene.
    pub fn surfaces(&self) -> &[Instance] {
        &self.surfaces
    }

    /// The materials, to which the surfaces' `material` indices refer.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// The lights; [`World::new`] gives a scene without any its default ones.
    pub fn lights(&self) -> &[Light] {
        &self.lights
    }

    /// Replaces the lights.
    ///
    /// # Errors
    /// When [`Light::check`] refuses one of them; the world is then as it was.
    pub fn set_lights(&mut self, lights: Vec<Light>) -> Result<(), SceneError> {
        check_lights(&lights, &Place::default())?;
        self.lights = lights;
        Ok(())
    }

    /// Where the picture is taken from.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// Replaces the camera: several pictures of one world need not prepare its surfaces again.
    pub fn set_camera(&mut self, camera: Camera) {
        self.camera = camera;
    }

    /// The radiance of rays that meet nothing.
    pub fn background(&self) -> Rgb {
        self.background
    }

    /// Replaces the radiance of rays that meet nothing.
    ///
    /// # Errors
    /// When a component is negative or not finite; the world is then as it was.
    pub fn set_background(&mut self, background: Rgb) -> Result<(), SceneError> {
        check_background(background, &Place::default())?;
        self.background = background;
        Ok(())
    }

    /// The picture the scene asks for.
    pub fn settings(&self) -> &RenderDefaults {
        &self.settings
    }

    /// The share of light sent back at a hit.
    pub(crate) fn albedo(&self, hit: &Hit) -> Rgb {
        let instance = &self.surfaces[hit.surface as usize];
        self.materials[instance.material].albedo(hit.uv, || instance.surface.tile(hit.uv))
    }

    /// The same world with only the surfaces whose indices `keep` accepts.
    ///
    /// # Errors
    /// As [`SurfaceBvh::build`].
    pub fn keeping(mut self, keep: impl Fn(usize) -> bool) -> Result<Self, BuildError> {
        let mut index = 0..;
        self.surfaces.retain(|_| index.next().is_some_and(&keep));
        let surfaces: Vec<_> = self.surfaces.iter().map(|instance| &instance.surface).collect();
        self.bvh = SurfaceBvh::build(&surfaces)?;
        Ok(self)
    }
}

/// A scene whose surfaces are in their places, and not yet ready to trace: the first of the two
/// steps of [`World::new`], for those who time them.
#[derive(Clone, Debug)]
pub struct Placed<'a> {
    scene: &'a Scene,
    surfaces: Vec<Instance>,
    materials: Vec<Material>,
    lights: Vec<Light>,
    camera: Camera,
}

impl<'a> Placed<'a> {
    /// Checks a scene and puts its surfaces, camera and lights in their places.
    ///
    /// # Errors
    /// As [`World::new`], except when there is too much to trace.
    pub fn new(scene: &'a Scene) -> Result<Self, SceneError> {
        let (surfaces, materials) = check_and_place(scene)?;
        let Some(sphere) = BoundingSphere::of(surfaces.iter().map(|instance| &instance.surface))
        else {
            let fault = SceneFault::Empty { notes: scene.notes.clone() };
            return Err(SceneError::new(scene.place.clone(), fault));
        };
        let [width, height] = scene.settings.size;
        let aspect = f64::from(width) / f64::from(height);
        let camera = scene.camera.camera(sphere, aspect).map_err(|error| {
            SceneError::new(scene.camera.blame(&error).clone(), SceneFault::Camera(error))
        })?;
        let lights =
            if scene.lights.is_empty() { default_lights(&camera) } else { scene.lights.clone() };
        Ok(Self { scene, surfaces, materials, lights, camera })
    }

    /// Makes the surfaces ready to trace.
    ///
    /// # Errors
    /// When there are too many of them.
    pub fn build(self) -> Result<World, SceneError> {
        let Self { scene, surfaces, materials, lights, camera } = self;
        let traced: Vec<_> = surfaces.iter().map(|instance| &instance.surface).collect();
        let bvh = SurfaceBvh::build(&traced)
            .map_err(|error| SceneError::new(scene.place.clone(), SceneFault::Build(error)))?;
        let background = scene.background.unwrap_or(DEFAULT_BACKGROUND);
        let settings = scene.settings.clone();
        Ok(World { bvh, surfaces, materials, lights, camera, background, settings })
    }
}

impl Scene {
    /// The surfaces in their places, as [`World::new`] makes them, but not yet ready to trace.
    ///
    /// # Errors
    /// As [`World::new`], except for the camera.
    pub fn surfaces(&self) -> Result<Vec<Instance>, SceneError> {
        check_and_place(self).map(|(surfaces, _)| surfaces)
    }
}

fn check_and_place(scene: &Scene) -> Result<(Vec<Instance>, Vec<Material>), SceneError> {
    let fails = |fault| SceneError::new(scene.place.clone(), fault);
    scene.settings.check().map_err(|error| fails(SceneFault::Picture(error)))?;
    if scene.objects.is_empty() {
        let only_plots = !scene.plots.is_empty();
        return Err(fails(if only_plots { SceneFault::OnlyPlots } else { SceneFault::NoObjects }));
    }
    check_shades(scene)?;
    check_point_count(scene)?;
    let placed = place_objects(scene, Scene::MAX_POINTS)?;
    if placed.0.is_empty() {
        return Err(fails(SceneFault::Empty { notes: scene.notes.clone() }));
    }
    Ok(placed)
}

/// Refuses lights, colours and backgrounds that are not valid.
fn check_shades(scene: &Scene) -> Result<(), SceneError> {
    check_lights(&scene.lights, &scene.place)?;
    for Written { value: Material { name, texture }, place } in &scene.materials {
        let fault = |error| SceneFault::Texture { material: name.clone(), error };
        texture.check().map_err(|error| SceneError::new(place.clone(), fault(error)))?;
    }
    scene.background.map_or(Ok(()), |amount| check_background(amount, &scene.place))
}

/// Refuses lights that are not valid, written at `place`.
fn check_lights(lights: &[Light], place: &Place) -> Result<(), SceneError> {
    for (light, one) in lights.iter().enumerate() {
        let fault = |error| SceneFault::Light { light, error };
        one.check().map_err(|error| SceneError::new(place.clone(), fault(error)))?;
    }
    Ok(())
}

/// Refuses a background that is not an amount of light, written at `place`.
fn check_background(amount: Rgb, place: &Place) -> Result<(), SceneError> {
    check_amount("background", amount)
        .map_err(|error| SceneError::new(place.clone(), SceneFault::Background(error)))
}

/// Refuses scenes that would not fit in memory, before any of their points are copied.
fn check_point_count(scene: &Scene) -> Result<(), SceneError> {
    let points = scene.objects.iter().map(Object::point_count).fold(0, usize::saturating_add);
    if points > Scene::MAX_POINTS {
        let fault = SceneFault::TooManyPoints { points, limit: Scene::MAX_POINTS };
        return Err(SceneError::new(scene.place.clone(), fault));
    }
    Ok(())
}

/// The surfaces in their places and the materials. Surfaces made from curves or drawn from other
/// objects may have many times the control points that are written: they are counted as they are
/// made, up to `most_points`.
fn place_objects(
    scene: &Scene,
    most_points: usize,
) -> Result<(Vec<Instance>, Vec<Material>), SceneError> {
    let given = scene.objects.iter().filter_map(|object| object.name.as_ref());
    check_unique("object", given.clone().map(|name| (name.value.as_str(), &name.place)))?;

    // Given names are kept; default names move out of their way.
    let mut names = Naming::new(given.map(|name| name.value.clone()));
    let mut palette = Palette::new(scene)?;
    let placer = Placer { scene, most_points };
    let mut instances = Vec::new();
    let mut points = 0;
    for (number, object) in scene.objects.iter().enumerate() {
        let name = match &object.name {
            Some(name) => name.value.clone(),
            None => names.free(&object.default_name),
        };
        let material = palette.index(&name, object)?;
        let made = placer.surfaces(&name, object)?;
        let only = made.len() == 1;
        for (index, (part, made)) in made.into_iter().enumerate() {
            let name = match joined(&object.parts[part].name, &made.name).as_str() {
                "" if only => name.clone(),
                "" => names.free(&format!("{name}/{index}")),
                part => names.free(&format!("{name}/{part}")),
            };
            let Made { surface, deviation, .. } = made;
            points += surface.point_count();
            if points > most_points {
                let fault = SceneFault::TooManyPoints { points, limit: most_points };
                return Err(SceneError::new(object.parts[part].place.clone(), fault));
            }
            instances.push(Instance { name, part: [number, part], surface, material, deviation });
        }
    }
    Ok((instances, palette.into_materials()))
}
