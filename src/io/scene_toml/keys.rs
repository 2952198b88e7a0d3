//! The tables and keys of a scene file, as [`super`] shows them.

use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::Keyed;
use super::cages::SubdivisionKeys;
use super::constructions::{
    ConstructionKeys, CoonsKeys, ExtrusionKeys, IsoCurvesKeys, LoftKeys, NetKeys, PolygonKeys,
    RevolutionKeys, RibbonKeys, RuledKeys, SweepKeys, TrimCurvesKeys, TubeKeys,
};
use super::kinds::{Kinds, OneOf};
use super::knot_list::KnotList;
use super::patches::{MatrixPatchKeys, PowerPatchKeys};
use super::plots::{FigureKeys, PlotKeys};
use super::transforms::TransformKeys;
use super::trims::TrimKeys;
use super::values::{
    Color, Count, Degree, Degrees, Emission, Exactly, Intensity, Measures, NetPoint, Number,
    PerDirection, TrianglePoint, Vector,
};
use crate::geometry::shapes::OctantConstants;
use crate::scene::{NamedShape, Scheme};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneKeys {
    pub(super) background: Option<Color>,
    pub(super) camera: Option<Spanned<Keyed<CameraKeys>>>,
    #[serde(default)]
    pub(super) render: Keyed<RenderKeys>,
    #[serde(default)]
    pub(super) light: Vec<OneOf<LightKeys>>,
    #[serde(default)]
    pub(super) material: Vec<Keyed<MaterialKeys>>,
    #[serde(default)]
    pub(super) object: Vec<Keyed<ObjectKeys>>,
    #[serde(default)]
    pub(super) figure: Keyed<FigureKeys>,
    #[serde(default)]
    pub(super) plot: Vec<Spanned<Keyed<PlotKeys>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CameraKeys {
    pub(super) look_from: Option<Spanned<Vector>>,
    pub(super) look_at: Option<Spanned<Vector>>,
    pub(super) up: Option<Spanned<Vector>>,
    pub(super) perspective: Option<Keyed<PerspectiveKeys>>,
    pub(super) orthographic: Option<Spanned<Keyed<OrthographicKeys>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PerspectiveKeys {
    pub(super) fov: Option<Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OrthographicKeys {
    pub(super) height: Option<Spanned<Number>>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RenderKeys {
    pub(super) size: Option<Spanned<Exactly<Count, 2>>>,
    pub(super) spp: Option<Spanned<Count>>,
    pub(super) integrator: Option<Spanned<String>>,
    pub(super) seed: Option<u64>,
    pub(super) exposure: Option<Number>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum LightKeys {
    Directional(Keyed<DirectionalKeys>),
    Point(Keyed<PointKeys>),
    Ambient(Keyed<AmbientKeys>),
}

impl Kinds for LightKeys {
    const EXAMPLE: &'static str = "a light, as in { ambient = { radiance = 0.1 } }";
    const APART: &'static str = "each light is a [[light]] of its own";
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DirectionalKeys {
    pub(super) from: Spanned<Vector>,
    pub(super) irradiance: Emission,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointKeys {
    pub(super) position: Vector,
    pub(super) intensity: Intensity,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct AmbientKeys {
    pub(super) radiance: Emission,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MaterialKeys {
    pub(super) name: Spanned<String>,
    pub(super) color: Option<Spanned<Color>>,
    pub(super) checker: Option<Spanned<Keyed<CheckerKeys>>>,
    pub(super) lines: Option<Spanned<Keyed<LinesKeys>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CheckerKeys {
    #[serde(default = "eight")]
    pub(super) count: Spanned<PerDirection>,
    #[serde(default = "light_and_dark")]
    pub(super) colors: Exactly<Color, 2>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LinesKeys {
    #[serde(default = "eight")]
    pub(super) count: Spanned<PerDirection>,
    #[serde(default = "thin")]
    pub(super) width: Spanned<Number>,
    #[serde(default = "dark")]
    pub(super) color: Color,
    #[serde(default = "light")]
    pub(super) base: Color,
}

fn eight() -> Spanned<PerDirection> {
    Spanned::new(0..0, PerDirection([8; 2]))
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

fn light_and_dark() -> Exactly<Color, 2> {
    Exactly([light(), Color([0.2; 3])])
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ObjectKeys {
    pub(super) name: Option<Spanned<String>>,
    pub(super) shape: Spanned<OneOf<ShapeKeys>>,
    pub(super) trims: Option<Spanned<Keyed<TrimKeys>>>,
    pub(super) material: Option<Spanned<String>>,
    #[serde(default)]
    pub(super) transform: Vec<OneOf<TransformKeys>>,
    #[serde(default)]
    pub(super) reverse: bool,
    #[serde(default)]
    pub(super) swap_uv: bool,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum ShapeKeys {
    Sphere(Keyed<RadiusKeys>),
    SphereBiquadratic(Keyed<RadiusKeys>),
    Hemisphere(Keyed<RadiusKeys>),
    Octant(Keyed<RadiusKeys>),
    OctantQuartic(Keyed<OctantKeys>),
    Cylinder(Keyed<RadiusHeightKeys>),
    Cone(Keyed<RadiusHeightKeys>),
    Torus(Keyed<TorusKeys>),
    Disk(Keyed<RadiusKeys>),
    Plane(Keyed<PlaneKeys>),
    #[serde(rename = "lecture_patch_1")]
    BicubicGraph(Keyed<NoKeys>),
    #[serde(rename = "lecture_patch_2")]
    BicubicHood(Keyed<NoKeys>),
    #[serde(rename = "lecture_patch_3")]
    BicubicHoodPinched(Keyed<NoKeys>),
    #[serde(rename = "deck_patch")]
    RedBookPatch(Keyed<NoKeys>),
    Revolution(Box<Keyed<RevolutionKeys>>),
    Extrusion(Box<Keyed<ExtrusionKeys>>),
    Ruled(Box<Keyed<RuledKeys>>),
    Coons(Box<Keyed<CoonsKeys>>),
    Loft(Box<Keyed<LoftKeys>>),
    MatrixForm(Box<Keyed<MatrixPatchKeys>>),
    Power(Box<Keyed<PowerPatchKeys>>),
    Sweep(Box<Keyed<SweepKeys>>),
    Tube(Box<Keyed<TubeKeys>>),
    Ribbon(Box<Keyed<RibbonKeys>>),
    Polygon(Box<Keyed<PolygonKeys>>),
    Net(Box<Keyed<NetKeys>>),
    TrimCurves(Box<Keyed<TrimCurvesKeys>>),
    IsoCurves(Box<Keyed<IsoCurvesKeys>>),
    Nurbs(Box<Keyed<NurbsKeys>>),
    Triangle(Box<Keyed<TriangleKeys>>),
    CatmullClark(Box<Keyed<SubdivisionKeys>>),
    DooSabin(Box<Keyed<SubdivisionKeys>>),
    File(Spanned<String>),
}

impl Kinds for ShapeKeys {
    const EXAMPLE: &'static str = "a shape, as in { sphere = { radius = 1 } }";
    const APART: &'static str = "each shape needs an [[object]] of its own";

    fn apart(found: &[String]) -> &'static str {
        if found == ["file", "tolerance"] {
            return "of a cage's surface, write catmull_clark = { file = \"…\", tolerance = … }, or \
                    doo_sabin";
        }
        Self::APART
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NoKeys {}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RadiusKeys {
    #[serde(default = "one")]
    radius: Spanned<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct OctantKeys {
    #[serde(default = "one")]
    radius: Spanned<Number>,
    a: Option<Spanned<Exactly<Number, 3>>>,
    b: Option<Spanned<Exactly<Number, 4>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RadiusHeightKeys {
    #[serde(default = "one")]
    radius: Spanned<Number>,
    #[serde(default = "one")]
    height: Spanned<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TorusKeys {
    #[serde(default = "one")]
    major: Spanned<Number>,
    #[serde(default = "third")]
    minor: Spanned<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PlaneKeys {
    #[serde(default = "one")]
    width: Spanned<Number>,
    #[serde(default = "one")]
    height: Spanned<Number>,
}

fn one() -> Spanned<Number> {
    Spanned::new(0..0, Number(1.0))
}

fn third() -> Spanned<Number> {
    Spanned::new(0..0, Number(1.0 / 3.0))
}

/// A control net: for each u, a list of the entries along v.
pub(super) type Grid<T> = Vec<Spanned<Vec<T>>>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NurbsKeys {
    pub(super) degree: Spanned<Degrees>,
    pub(super) knots_u: Option<Spanned<KnotList>>,
    pub(super) knots_v: Option<Spanned<KnotList>>,
    pub(super) points: Spanned<Grid<NetPoint>>,
    pub(super) weights: Option<Spanned<Grid<Spanned<f64>>>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TriangleKeys {
    pub(super) degree: Spanned<Degree>,
    pub(super) points: Spanned<Vec<Spanned<TrianglePoint>>>,
    pub(super) weights: Option<Spanned<Vec<Spanned<f64>>>>,
}

/// Where a shape's surfaces come from.
pub(super) enum ShapeSource {
    Named(NamedShape, Measures),
    Nurbs(Box<Keyed<NurbsKeys>>),
    Triangle(Box<Keyed<TriangleKeys>>),
    Subdivision(Scheme, Box<Keyed<SubdivisionKeys>>),
    Built(Box<dyn ConstructionKeys>),
    File(Spanned<String>),
}

/// Returns the constants of an octant, if any are written; the others are Farin's. Adds
/// the offsets to `measures`.
fn octant_constants(
    a: Option<Spanned<Exactly<Number, 3>>>,
    b: Option<Spanned<Exactly<Number, 4>>>,
    measures: &mut Measures,
) -> Option<([f64; 3], [f64; 4])> {
    let starts = [a.as_ref().map(|a| a.span().start), b.as_ref().map(|b| b.span().start)];
    let first = starts.into_iter().flatten().min()?;
    measures.push(("constants", first));
    let names = [("a0", 0), ("a1", 0), ("a2", 0), ("b0", 1), ("b1", 1), ("b2", 1), ("b3", 1)];
    measures.extend(names.iter().map(|&(name, list)| (name, starts[list].unwrap_or(first))));
    let note = OctantConstants::farin();
    let a = a.map_or(note.a(), |a| a.into_inner().0.map(|x| x.0));
    let b = b.map_or(note.b(), |b| b.into_inner().0.map(|x| x.0));
    Some((a, b))
}

impl ShapeKeys {
    pub(super) fn source(self) -> ShapeSource {
        let mut measures = Measures::new();
        let mut measure = |name, written: Spanned<Number>| {
            if !written.span().is_empty() {
                measures.push((name, written.span().start)); // not a default
            }
            written.into_inner().0
        };
        let shape = match self {
            Self::Revolution(keys) => return ShapeSource::Built(keys),
            Self::Extrusion(keys) => return ShapeSource::Built(keys),
            Self::Ruled(keys) => return ShapeSource::Built(keys),
            Self::Coons(keys) => return ShapeSource::Built(keys),
            Self::Loft(keys) => return ShapeSource::Built(keys),
            Self::MatrixForm(keys) => return ShapeSource::Built(keys),
            Self::Power(keys) => return ShapeSource::Built(keys),
            Self::Sweep(keys) => return ShapeSource::Built(keys),
            Self::Tube(keys) => return ShapeSource::Built(keys),
            Self::Ribbon(keys) => return ShapeSource::Built(keys),
            Self::Polygon(keys) => return ShapeSource::Built(keys),
            Self::Net(keys) => return ShapeSource::Built(keys),
            Self::TrimCurves(keys) => return ShapeSource::Built(keys),
            Self::IsoCurves(keys) => return ShapeSource::Built(keys),
            Self::Nurbs(keys) => return ShapeSource::Nurbs(keys),
            Self::Triangle(keys) => return ShapeSource::Triangle(keys),
            Self::CatmullClark(keys) => {
                return ShapeSource::Subdivision(Scheme::CatmullClark, keys);
            }
            Self::DooSabin(keys) => return ShapeSource::Subdivision(Scheme::DooSabin, keys),
            Self::File(file) => return ShapeSource::File(file),
            Self::Sphere(Keyed(keys)) => {
                NamedShape::Sphere { radius: measure("radius", keys.radius) }
            }
            Self::SphereBiquadratic(Keyed(keys)) => {
                NamedShape::SphereBiquadratic { radius: measure("radius", keys.radius) }
            }
            Self::Hemisphere(Keyed(keys)) => {
                NamedShape::Hemisphere { radius: measure("radius", keys.radius) }
            }
            Self::Octant(Keyed(keys)) => {
                NamedShape::Octant { radius: measure("radius", keys.radius) }
            }
            Self::OctantQuartic(Keyed(keys)) => {
                let radius = measure("radius", keys.radius);
                let constants = octant_constants(keys.a, keys.b, &mut measures);
                NamedShape::OctantQuartic { radius, constants }
            }
            Self::Cylinder(Keyed(keys)) => NamedShape::Cylinder {
                radius: measure("radius", keys.radius),
                height: measure("height", keys.height),
            },
            Self::Cone(Keyed(keys)) => NamedShape::Cone {
                radius: measure("radius", keys.radius),
                height: measure("height", keys.height),
            },
            Self::Torus(Keyed(keys)) => NamedShape::Torus {
                major: measure("major radius", keys.major),
                minor: measure("minor radius", keys.minor),
            },
            Self::Disk(Keyed(keys)) => NamedShape::Disk { radius: measure("radius", keys.radius) },
            Self::Plane(Keyed(keys)) => NamedShape::Plane {
                width: measure("width", keys.width),
                height: measure("height", keys.height),
            },
            Self::BicubicGraph(_) => NamedShape::BicubicGraph,
            Self::BicubicHood(_) => NamedShape::BicubicHood,
            Self::BicubicHoodPinched(_) => NamedShape::BicubicHoodPinched,
            Self::RedBookPatch(_) => NamedShape::RedBookPatch,
        };
        ShapeSource::Named(shape, measures)
    }
}
