//! Scenes in the language of POV-Ray 3.7, for the opinion of another program.
//!
//! POV-Ray has no NURBS. Written are polynomial surfaces up to degree 3, as `bicubic_patch`es
//! (their Bézier pieces, elevated), and what the scene calls spheres, cones, cylinders, disks and
//! tori, as primitives of the same shape. The others are named and left out.
//!
//! Light and colour are not the scene's: one lamp at the camera, without shadows, on white.
//! So a pixel is the cosine of the angle between ray and normal, and pictures differ where
//! geometry differs. Where nothing is hit the picture is pure blue.
//!
//! POV-Ray has constants made for lengths of about 1: it drops hits nearer than an absolute 1e-6 or
//! so, for example. So the scene and its camera are moved to the middle of the scene's bounding box
//! and scaled by a power of two to a size between 1 and 2, or larger if small surfaces would be
//! lost. This changes no pixel and gives POV-Ray its best case.

mod patches;
mod primitives;

use std::fmt;

use glam::{DVec2, DVec3};
use thiserror::Error;

use crate::geometry::Surface;
use crate::math::{Aabb, rounding};
use crate::patch::ScaledFrame;
use crate::scene::{Camera, Instance, Projection, Scene, Shape, Transform, World, Written};

/// The least size that a surface should have in POV-Ray's coordinates.
const LEAST: f64 = 1.0 / 64.0;

/// How far from the middle a scene and its camera may then reach: POV-Ray ends rays at 1e7.
const FARTHEST: f64 = 1e6;

/// A scene for POV-Ray.
#[derive(Clone, Debug, PartialEq)]
pub struct PovrayScene {
    /// The file's contents.
    pub text: String,
    /// The surfaces in it, by their numbers in the world.
    pub written: Vec<usize>,
    /// The surfaces left out.
    pub skipped: Vec<PovraySkip>,
}

/// A surface that cannot be written for POV-Ray.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PovraySkip {
    /// Its name.
    pub name: String,
    /// Why.
    pub reason: PovrayGap,
}

/// Why a surface cannot be written for POV-Ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PovrayGap {
    /// The weights of a control net differ.
    #[error("it is rational, and the patches of POV-Ray are polynomial")]
    Rational,
    /// A degree is too high.
    #[error("it has degrees {u} x {v}, and the patches of POV-Ray are bicubic")]
    Degree {
        /// The degree in u.
        u: usize,
        /// The degree in v.
        v: usize,
    },
    /// A part of it is cut off.
    #[error("it is trimmed, and a patch of POV-Ray has no trims")]
    Trimmed,
    /// The patches would have to be split too often.
    #[error(
        "to be so flat its patches need {halvings} halvings each way: at most {limit}, which make a \
         million parts, are asked of POV-Ray"
    )]
    TooFine {
        /// Halvings needed in each direction.
        halvings: u32,
        /// Halvings allowed.
        limit: u32,
    },
}

impl fmt::Display for PovraySkip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "surface \"{}\" is left out: {}", self.name, self.reason)
    }
}

/// Writes a scene for a picture of `[width, height]` pixels. POV-Ray cuts patches into triangles
/// that are flat to within `flatness`, in scene units.
///
/// `scene` must be the one `world` was made of: it knows which surfaces are named shapes.
pub fn povray_scene(
    scene: &Scene,
    world: &World,
    [width, height]: [u32; 2],
    flatness: f64,
) -> PovrayScene {
    let aspect = f64::from(width) / f64::from(height);
    let bounds = world.bvh.bounds().map_or(Aabb::EMPTY, |(min, max)| Aabb { min, max });
    let usual = ScaledFrame::around(&bounds);
    let mut bodies = bodies(scene, world, flatness, &usual);
    let all = world.surfaces.iter().zip(&bodies);
    let shown = all.filter(|(_, body)| body.is_ok()).map(|(instance, _)| &instance.surface);
    let frame = enlarged(usual, world, shown);
    if frame.scale > usual.scale {
        bodies = self::bodies(scene, world, flatness, &frame);
    }

    let mut text = heading(&world.camera, aspect, &frame);
    let (mut written, mut skipped) = (Vec::new(), Vec::new());
    for (index, (instance, body)) in world.surfaces.iter().zip(bodies).enumerate() {
        match body {
            Ok(body) => {
                // A line break would end the comment.
                let name: String = instance.name.chars().filter(|c| !c.is_control()).collect();
                text.push_str(&format!("\n// {name}\n{body}"));
                written.push(index);
            }
            Err(reason) => skipped.push(PovraySkip { name: instance.name.clone(), reason }),
        }
    }
    PovrayScene { text, written, skipped }
}

/// The surfaces in a frame's coordinates. Whether one can be written does not depend on the frame.
fn bodies(
    scene: &Scene,
    world: &World,
    flatness: f64,
    frame: &ScaledFrame,
) -> Vec<Result<String, PovrayGap>> {
    let body = |instance: &Instance| match (&instance.surface, shape_of(scene, instance)) {
        (Surface::Trimmed(_), _) => Err(PovrayGap::Trimmed),
        (_, Some((shape, steps))) => primitives::primitive(shape, steps, frame)
            .map_or_else(|| patches::patches(&instance.surface, flatness, frame), Ok),
        (surface, None) => patches::patches(surface, flatness, frame),
    };
    world.surfaces.iter().map(body).collect()
}

/// A frame of a world in which the smallest of the surfaces shown is large enough for POV-Ray.
fn enlarged<'a>(
    mut frame: ScaledFrame,
    world: &World,
    shown: impl Iterator<Item = &'a Surface>,
) -> ScaledFrame {
    let sizes = shown.map(|surface| frame.scale * surface.extent().size().max_element());
    let wanted = LEAST / sizes.fold(f64::INFINITY, f64::min);
    let eye = frame.scaled(world.camera.view().look_from).length();
    let larger = wanted.min(FARTHEST / eye.max(1.0));
    if larger > 1.0 {
        frame.scale *= rounding::power_of_two_below(larger);
    }
    frame
}

/// The shape that a surface was made of, and the transforms that moved it to its place. (Some
/// shapes make several surfaces.)
fn shape_of<'a>(
    scene: &'a Scene,
    instance: &Instance,
) -> Option<(&'a Shape, &'a [Written<Transform>])> {
    let [object, part] = instance.part;
    let object = scene.objects.get(object)?;
    Some((&object.parts.get(part)?.shape, &object.transform))
}

/// The camera, the light and the look of all surfaces.
fn heading(camera: &Camera, aspect: f64, frame: &ScaledFrame) -> String {
    let [left, right, top, bottom] = [(0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.5, 1.0)]
        .map(|(x, y)| camera.ray(DVec2::new(x, y), aspect));
    let (eye, forward) = (frame.scaled(camera.view().look_from), camera.forward());

    // The picture's sides: at distance 1 in front of the eye, or on the film.
    let (kind, across, up, parallel) = match camera.projection() {
        Projection::Perspective { .. } => (
            "perspective",
            right.direction() - left.direction(),
            top.direction() - bottom.direction(),
            String::new(),
        ),
        Projection::Orthographic { .. } => (
            "orthographic",
            frame.scale * (right.origin() - left.origin()),
            frame.scale * (top.origin() - bottom.origin()),
            format!(" parallel point_at {}", vector(eye + forward)),
        ),
    };
    format!(
        "// A pixel is the cosine of the angle between ray and normal; blue is nothing.\n\
         // What is at p in the scene is here at (p - {}) * {:?}.\n\
         #version 3.7;\n\
         global_settings {{ assumed_gamma 1 }}\n\
         background {{ rgb <0, 0, 1> }}\n\
         camera {{\n  {kind}\n  location {}\n  direction {}\n  right {}\n  up {}\n}}\n\
         light_source {{ {}, rgb 1 shadowless{parallel} }}\n\
         #default {{ texture {{ pigment {{ rgb 1 }} finish {{ ambient 0 emission 0 diffuse 1 }} }} }}\n",
        vector(frame.center),
        frame.scale,
        vector(eye),
        vector(forward),
        vector(across),
        vector(up),
        vector(eye),
    )
}

/// `<x, y, z>`, each number with all its digits.
fn vector(v: DVec3) -> String {
    format!("<{:?}, {:?}, {:?}>", v.x, v.y, v.z)
}

#[cfg(test)]
mod tests;
