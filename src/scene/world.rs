//! A scene ready to trace.

use super::{Camera, Light, Material, RenderDefaults, Rgb};
use crate::geometry::NurbsSurface;
use crate::intersect::SurfaceBvh;

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
