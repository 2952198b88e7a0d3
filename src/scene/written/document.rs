//! The scene as written: plain data, with the places errors will name.

use std::path::PathBuf;
use std::sync::Arc;

use glam::DVec3;

use super::{
    Construction, FigureSpec, ImportNote, NamedShape, Net, Place, PlotSpec, RenderDefaults,
    Subdivision, Transform, TriangleNet, TrimSpec, UnknownName, Written,
};
use crate::geometry::Surface;
use crate::scene::look::{Light, Material, Rgb};

/// A scene as its author wrote it. Readers build it; [`World::new`](crate::scene::World::new)
/// checks it and makes it ready to trace.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Where it was read from.
    pub place: Place,
    /// The other files that were read for it, in any order.
    pub files: Vec<PathBuf>,
    /// Where the picture is taken from, as far as the author says.
    pub camera: CameraSpec,
    /// The lights; without any, the default ones shine.
    pub lights: Vec<Light>,
    /// The materials objects may name.
    pub materials: Vec<Written<Material>>,
    /// The objects, in the order their surfaces are counted.
    pub objects: Vec<Object>,
    /// The radiance of rays that meet nothing; a pale blue grey if not given.
    pub background: Option<Rgb>,
    /// The picture asked for.
    pub settings: RenderDefaults,
    /// What is to be plotted; [`PlotSpec::checked`] makes it ready.
    pub plots: Vec<PlotSpec>,
    /// How the plots lie in one picture.
    pub figure: FigureSpec,
    /// What the files hold that is not shown, and why.
    pub notes: Vec<ImportNote>,
}

/// A thing in the scene: one or more surfaces moved and painted alike.
#[derive(Clone, Debug, PartialEq)]
pub struct Object {
    /// Its name.
    pub name: Option<Written<String>>,
    /// What to call it if it has no name; with a number if others are called the same.
    pub default_name: String,
    /// Its surfaces.
    pub parts: Vec<Part>,
    /// Where it goes: each step in turn, the first one first.
    pub transform: Vec<Written<Transform>>,
    /// The name of its material; without one it is the one named `default`, or light grey.
    pub material: Option<Written<String>>,
    /// Whether its surfaces are turned inside out.
    pub reverse: bool,
    /// Whether u and v of its surfaces are exchanged; before they are turned, if they are.
    pub swap_uv: bool,
}

impl Default for Object {
    /// An object without parts; `object` is what to call it.
    fn default() -> Self {
        Self {
            name: None,
            default_name: "object".into(),
            parts: Vec::new(),
            transform: Vec::new(),
            material: None,
            reverse: false,
            swap_uv: false,
        }
    }
}

impl Scene {
    /// The most control points all objects together may have: 2²⁶, or 2 GiB of them.
    /// A file with more is likelier to be damaged than meant.
    pub const MAX_POINTS: usize = 1 << 26;

    /// The object that was given this name.
    pub fn named_object(&self, name: &str) -> Option<&Object> {
        let named = |object: &&Object| object.name.as_ref().is_some_and(|own| own.value == name);
        self.objects.iter().find(named)
    }

    /// The error about a name that no object has.
    pub(in crate::scene) fn unknown_object(&self, name: &str) -> UnknownName {
        let called = |object: &Object| object.name.is_none() && object.default_name == name;
        if self.objects.iter().any(called) {
            return UnknownName::unnamed("object", name);
        }
        let names = self.objects.iter().filter_map(|object| object.name.as_ref());
        let known: Vec<&str> = names.map(|name| name.value.as_str()).collect();
        UnknownName::new("object", name, &known)
    }
}

impl Object {
    /// The number of control points of all its surfaces.
    pub fn point_count(&self) -> usize {
        let count = |part: &Part| {
            let trims = part.trims.as_ref().map_or(0, TrimSpec::point_count);
            part.shape.point_count().saturating_add(trims)
        };
        self.parts.iter().map(count).fold(0, usize::saturating_add)
    }
}

impl Shape {
    /// The number of control points; 0 for a shape known by name, which has only a few.
    fn point_count(&self) -> usize {
        match self {
            Self::Net(net) => net.point_count(),
            Self::Triangle(net) => net.points.value.len(),
            Self::Subdivision(surface) => surface.cage.positions().len(),
            Self::Surface(surface) => surface.point_count(),
            Self::Named(..) => 0,
            Self::Built(construction, _) => construction.point_count(),
        }
    }
}

/// One surface of an object, or several that are made together.
///
/// Code makes parts from shapes, `Part::from(shape)`, or with more to say,
/// `Part { name: "lid".into(), ..shape.into() }`; without a shape there is no part, and so no
/// default one.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What it is called within its object; may be empty.
    pub name: String,
    /// Where it was written.
    pub place: Place,
    /// Its geometry.
    pub shape: Shape,
    /// Which part of it is kept, if not all: then the shape is one surface.
    pub trims: Option<TrimSpec>,
}

/// The geometry of a surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A control net of its own; objects made from one file share it.
    Net(Arc<Net>),
    /// A triangular patch.
    Triangle(Arc<TriangleNet>),
    /// The limit surface of a cage.
    Subdivision(Arc<Subdivision>),
    /// A surface that code has made; readers of files make none of these.
    Surface(Arc<Surface>),
    /// A shape the program knows by name, and those of its measures that were written, with their
    /// places. The measures have the names that a
    /// [`ShapeError`](crate::geometry::shapes::ShapeError) gives them.
    Named(NamedShape, Vec<Written<&'static str>>),
    /// A shape made from curves or by a formula, and those of its numbers that were written, with
    /// their places. The numbers have the names of their keys in scenes.
    Built(Arc<Construction>, Vec<Written<&'static str>>),
}

impl From<Surface> for Shape {
    fn from(surface: Surface) -> Self {
        Self::Surface(Arc::new(surface))
    }
}

impl From<Shape> for Part {
    /// A part without a name, a place or trims.
    fn from(shape: Shape) -> Self {
        Self { name: String::new(), place: Place::default(), shape, trims: None }
    }
}

/// A camera as far as the author describes it; the rest is chosen so that everything is in the
/// picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CameraSpec {
    /// Where it was written.
    pub place: Place,
    /// Where the eye is; if not given, in front, to the right and above, far enough to see
    /// everything.
    pub look_from: Option<Written<DVec3>>,
    /// The middle of the picture; the middle of the scene if not given.
    pub look_at: Option<Written<DVec3>>,
    /// What points up; if not given, z, or y where the view runs along z.
    pub up: Option<Written<DVec3>>,
    /// How it sees.
    pub lens: Lens,
}

/// How a camera sees, as far as the author says.
#[derive(Clone, Debug, PartialEq)]
pub enum Lens {
    /// Perspective, with the vertical field of view in degrees.
    Perspective {
        /// The angle; [`Lens::DEFAULT_FOV`] if not given.
        fov: Option<Written<f64>>,
    },
    /// Parallel rays, with the height of the picture in scene units.
    Orthographic {
        /// The height; as much as is needed to see all if not given.
        height: Option<Written<f64>>,
    },
}

impl Lens {
    /// The default field of view in degrees: a short telephoto lens (50 mm on 35 mm film
    /// has 27°, 35 mm has 38°), which shows shapes with little distortion.
    pub const DEFAULT_FOV: f64 = 30.0;
}

impl Default for Lens {
    fn default() -> Self {
        Self::Perspective { fov: None }
    }
}
