//! The tables and keys of a scene file, as [`super`] shows them.

use serde::Deserialize;
use toml::Spanned;

use super::constructions::{
    ConstructionKeys, CoonsKeys, ExtrusionKeys, IsoCurvesKeys, LoftKeys, NetKeys, PolygonKeys,
    RevolutionKeys, RibbonKeys, RuledKeys, SweepKeys, TubeKeys,
};
use super::values::{Axis, Color, Factors, KnotList, Number, PerDirection, Vector};
use crate::scene::NamedShape;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneKeys {
    pub(super) background: Option<Color>,
    pub(super) camera: Option<Spanned<CameraKeys>>,
    #[serde(default)]
    pub(super) render: RenderKeys,
    #[serde(default)]
    pub(super) light: Vec<Spanned<LightKeys>>,
    #[serde(default)]
    pub(super) material: Vec<Spanned<MaterialKeys>>,
    #[serde(default)]
    pub(super) object: Vec<Spanned<ObjectKeys>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraKeys {
    pub(super) look_from: Option<Vector>,
    pub(super) look_at: Option<Vector>,
    pub(super) up: Option<Vector>,
    pub(super) perspective: Option<PerspectiveKeys>,
    pub(super) orthographic: Option<Spanned<OrthographicKeys>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PerspectiveKeys {
    pub(super) fov: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OrthographicKeys {
    pub(super) height: Option<Number>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RenderKeys {
    pub(super) size: Option<Spanned<[u32; 2]>>,
    pub(super) spp: Option<Spanned<u32>>,
    pub(super) integrator: Option<Spanned<String>>,
    pub(super) seed: Option<u64>,
    pub(super) exposure: Option<Number>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum LightKeys {
    Directional { from: Vector, irradiance: Color },
    Point { position: Vector, intensity: Color },
    Ambient { radiance: Color },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialKeys {
    pub(super) name: Spanned<String>,
    pub(super) color: Option<Spanned<Color>>,
    pub(super) checker: Option<Spanned<CheckerKeys>>,
    pub(super) lines: Option<Spanned<LinesKeys>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CheckerKeys {
    #[serde(default = "eight")]
    pub(super) count: PerDirection,
    #[serde(default = "light_and_dark")]
    pub(super) colors: [Color; 2],
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LinesKeys {
    #[serde(default = "eight")]
    pub(super) count: PerDirection,
    #[serde(default = "thin")]
    pub(super) width: Spanned<Number>,
    #[serde(default = "dark")]
    pub(super) color: Color,
    #[serde(default = "light")]
    pub(super) base: Color,
}

fn eight() -> PerDirection {
    PerDirection([8; 2])
}

fn thin() -> Spanned<Number> {
    Spanned::new(0..0, Number(0.06))
}

fn light() -> Color {
    Color([0.8; 3])
}

fn dark() -> Color {
    Color([0.05; 3])
}

fn light_and_dark() -> [Color; 2] {
    [light(), Color([0.2; 3])]
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectKeys {
    pub(super) name: Option<Spanned<String>>,
    pub(super) shape: Spanned<ShapeKeys>,
    pub(super) material: Option<Spanned<String>>,
    #[serde(default)]
    pub(super) transform: Vec<Spanned<TransformKeys>>,
    #[serde(default)]
    pub(super) reverse: bool,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum TransformKeys {
    Translate(Vector),
    Rotate { axis: Axis, degrees: Number },
    Scale(Factors),
    Matrix([[Number; 4]; 3]),
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub(super) enum ShapeKeys {
    Sphere {
        #[serde(default = "one")]
        radius: Number,
    },
    SphereBiquadratic {
        #[serde(default = "one")]
        radius: Number,
    },
    Hemisphere {
        #[serde(default = "one")]
        radius: Number,
    },
    Octant {
        #[serde(default = "one")]
        radius: Number,
    },
    Cylinder {
        #[serde(default = "one")]
        radius: Number,
        #[serde(default = "one")]
        height: Number,
    },
    Cone {
        #[serde(default = "one")]
        radius: Number,
        #[serde(default = "one")]
        height: Number,
    },
    Torus {
        #[serde(default = "one")]
        major: Number,
        #[serde(default = "third")]
        minor: Number,
    },
    Disk {
        #[serde(default = "one")]
        radius: Number,
    },
    Plane {
        #[serde(default = "one")]
        width: Number,
        #[serde(default = "one")]
        height: Number,
    },
    #[serde(rename = "lecture_patch_1")]
    LecturePatch1,
    #[serde(rename = "lecture_patch_2")]
    LecturePatch2,
    #[serde(rename = "lecture_patch_3")]
    LecturePatch3,
    DeckPatch,
    Revolution(Box<RevolutionKeys>),
    Extrusion(Box<ExtrusionKeys>),
    Ruled(Box<RuledKeys>),
    Coons(Box<CoonsKeys>),
    Loft(Box<LoftKeys>),
    Sweep(Box<SweepKeys>),
    Tube(Box<TubeKeys>),
    Ribbon(Box<RibbonKeys>),
    Polygon(Box<PolygonKeys>),
    Net(Box<NetKeys>),
    IsoCurves(Box<IsoCurvesKeys>),
    Nurbs(Box<NurbsKeys>),
    File(Spanned<String>),
}

fn one() -> Number {
    Number(1.0)
}

fn third() -> Number {
    Number(1.0 / 3.0)
}

/// A control net: a list for each u of what lies along v there.
pub(super) type Grid<T> = Vec<Spanned<Vec<T>>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NurbsKeys {
    pub(super) degree: PerDirection,
    pub(super) knots_u: Option<Spanned<KnotList>>,
    pub(super) knots_v: Option<Spanned<KnotList>>,
    pub(super) points: Spanned<Grid<Vector>>,
    pub(super) weights: Option<Spanned<Grid<Spanned<f64>>>>,
}

/// Where a shape's surfaces come from.
pub(super) enum ShapeSource {
    Named(NamedShape),
    Nurbs(Box<NurbsKeys>),
    Built(ConstructionKeys),
    File(Spanned<String>),
}

impl ShapeKeys {
    pub(super) fn source(self) -> ShapeSource {
        use ConstructionKeys as Built;
        ShapeSource::Named(match self {
            Self::Revolution(keys) => return ShapeSource::Built(Built::Revolution(keys)),
            Self::Extrusion(keys) => return ShapeSource::Built(Built::Extrusion(keys)),
            Self::Ruled(keys) => return ShapeSource::Built(Built::Ruled(keys)),
            Self::Coons(keys) => return ShapeSource::Built(Built::Coons(keys)),
            Self::Loft(keys) => return ShapeSource::Built(Built::Loft(keys)),
            Self::Sweep(keys) => return ShapeSource::Built(Built::Sweep(keys)),
            Self::Tube(keys) => return ShapeSource::Built(Built::Tube(keys)),
            Self::Ribbon(keys) => return ShapeSource::Built(Built::Ribbon(keys)),
            Self::Polygon(keys) => return ShapeSource::Built(Built::Polygon(keys)),
            Self::Net(keys) => return ShapeSource::Built(Built::Net(keys)),
            Self::IsoCurves(keys) => return ShapeSource::Built(Built::IsoCurves(keys)),
            Self::Nurbs(keys) => return ShapeSource::Nurbs(keys),
            Self::File(file) => return ShapeSource::File(file),
            Self::Sphere { radius } => NamedShape::Sphere { radius: radius.0 },
            Self::SphereBiquadratic { radius } => {
                NamedShape::SphereBiquadratic { radius: radius.0 }
            }
            Self::Hemisphere { radius } => NamedShape::Hemisphere { radius: radius.0 },
            Self::Octant { radius } => NamedShape::Octant { radius: radius.0 },
            Self::Cylinder { radius, height } => {
                NamedShape::Cylinder { radius: radius.0, height: height.0 }
            }
            Self::Cone { radius, height } => {
                NamedShape::Cone { radius: radius.0, height: height.0 }
            }
            Self::Torus { major, minor } => NamedShape::Torus { major: major.0, minor: minor.0 },
            Self::Disk { radius } => NamedShape::Disk { radius: radius.0 },
            Self::Plane { width, height } => NamedShape::Plane { width: width.0, height: height.0 },
            Self::LecturePatch1 => NamedShape::LecturePatch1,
            Self::LecturePatch2 => NamedShape::LecturePatch2,
            Self::LecturePatch3 => NamedShape::LecturePatch3,
            Self::DeckPatch => NamedShape::DeckPatch,
        })
    }
}
