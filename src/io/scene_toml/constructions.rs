//! Surfaces made from curves in a scene file, as `from_curves.md` shows them.

use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::{Keyed, Named};
use super::curves::CurveKeys;
use super::values::{Axis, Degree, Measures, Number, Vector};
use super::{LoadError, Reader};
use crate::geometry::construct::{Caps, NetStyle, RibbonStyle, SweepOptions, TubeStyle};
use crate::scene::{Construction, Written};

/// A construction, if its keys make one.
type Built = Result<Construction, LoadError>;

/// The keys of a construction.
pub(super) trait ConstructionKeys {
    /// Makes the construction, with its curves; adds the offsets of its numbers to `measures`.
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built;
}

impl<K: ConstructionKeys> ConstructionKeys for Keyed<K> {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        Box::new(self.0).construction(reader, measures)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RevolutionKeys {
    profile: Spanned<CurveKeys>,
    axis: Option<Spanned<Axis>>,
    through: Option<Spanned<Vector>>,
    degrees: Option<Spanned<Number>>,
}

impl ConstructionKeys for RevolutionKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        let through = noted("through", self.through, measures);
        let axis = noted("axis", self.axis, measures);
        let degrees = noted("degrees", self.degrees, measures);
        Ok(Construction::Revolution {
            profile: reader.curve(self.profile)?,
            through: through.map(|point| point.0).unwrap_or_default(),
            axis: axis.map_or(glam::DVec3::Z, |axis| axis.0),
            degrees: degrees.map_or(360.0, |angle| angle.0),
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ExtrusionKeys {
    profile: Spanned<CurveKeys>,
    by: Spanned<Vector>,
}

impl ConstructionKeys for ExtrusionKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        let by = noted_one("by", self.by, measures).0;
        Ok(Construction::Extrusion { profile: reader.curve(self.profile)?, by })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RuledKeys {
    from: Spanned<CurveKeys>,
    to: Spanned<CurveKeys>,
}

impl ConstructionKeys for RuledKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, _: &mut Measures) -> Built {
        Ok(Construction::Ruled { from: reader.curve(self.from)?, to: reader.curve(self.to)? })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CoonsKeys {
    u0: Spanned<CurveKeys>,
    u1: Spanned<CurveKeys>,
    v0: Spanned<CurveKeys>,
    v1: Spanned<CurveKeys>,
}

impl ConstructionKeys for CoonsKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, _: &mut Measures) -> Built {
        Ok(Construction::Coons(Box::new([
            reader.curve(self.u0)?,
            reader.curve(self.u1)?,
            reader.curve(self.v0)?,
            reader.curve(self.v1)?,
        ])))
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LoftKeys {
    sections: Vec<Spanned<CurveKeys>>,
    degree: Option<Spanned<Degree>>,
}

impl ConstructionKeys for LoftKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        let sections = self.sections.into_iter().map(|curve| reader.curve(curve));
        Ok(Construction::Loft {
            sections: sections.collect::<Result<_, _>>()?,
            degree: noted("degree", self.degree, measures).map(|degree| degree.0 as usize),
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SweepKeys {
    profile: Spanned<CurveKeys>,
    path: Spanned<CurveKeys>,
    up: Option<Spanned<Axis>>,
    twist: Option<Spanned<Number>>,
    scale: Option<Spanned<Vec<Number>>>,
    tolerance: Option<Spanned<Number>>,
}

impl ConstructionKeys for SweepKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        Ok(Construction::Sweep {
            profile: reader.curve(self.profile)?,
            path: reader.curve(self.path)?,
            options: SweepOptions {
                up: noted("up", self.up, measures).map(|up| up.0),
                twist: noted("twist", self.twist, measures).map_or(0.0, |twist| twist.0),
                scale: noted("scale", self.scale, measures).map_or(vec![1.0], numbers),
                tolerance: noted("tolerance", self.tolerance, measures).map(|length| length.0),
            },
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TubeKeys {
    curve: Spanned<CurveKeys>,
    radius: Spanned<Number>,
    #[serde(default)]
    caps: Named<CapsKey>,
    tolerance: Option<Spanned<Number>>,
}

impl ConstructionKeys for TubeKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        let caps = match self.caps.0 {
            CapsKey::Open => Caps::Open,
            CapsKey::Flat => Caps::Flat,
            CapsKey::Round => Caps::Round,
        };
        let style = TubeStyle { caps, ..round_tube(self.radius, self.tolerance, measures) };
        Ok(Construction::Tube { curve: reader.curve(self.curve)?, style })
    }
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum CapsKey {
    Open,
    Flat,
    #[default]
    Round,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RibbonKeys {
    curve: Spanned<CurveKeys>,
    width: Spanned<Number>,
    up: Option<Spanned<Axis>>,
    twist: Option<Spanned<Number>>,
    tolerance: Option<Spanned<Number>>,
}

impl ConstructionKeys for RibbonKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        Ok(Construction::Ribbon {
            curve: reader.curve(self.curve)?,
            style: RibbonStyle {
                width: noted_one("width", self.width, measures).0,
                up: noted("up", self.up, measures).map(|up| up.0),
                twist: noted("twist", self.twist, measures).map_or(0.0, |twist| twist.0),
                tolerance: noted("tolerance", self.tolerance, measures).map(|length| length.0),
            },
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PolygonKeys {
    curve: Spanned<CurveKeys>,
    radius: Spanned<Number>,
    joints: Option<Spanned<Number>>,
}

impl ConstructionKeys for PolygonKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        let style = net_style(self.radius, self.joints, measures);
        Ok(Construction::Polygon { curve: reader.curve(self.curve)?, style })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NetKeys {
    of: Spanned<String>,
    radius: Spanned<Number>,
    joints: Option<Spanned<Number>>,
    steps: Option<Spanned<u32>>,
}

impl ConstructionKeys for NetKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        let style = net_style(self.radius, self.joints, measures);
        let steps = noted("steps", self.steps, measures).map_or(0, |steps| steps as usize);
        Ok(Construction::Net { of: reader.text(self.of), steps, style })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TrimCurvesKeys {
    of: Spanned<String>,
    radius: Spanned<Number>,
    tolerance: Option<Spanned<Number>>,
}

impl ConstructionKeys for TrimCurvesKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        let style = round_tube(self.radius, self.tolerance, measures);
        Ok(Construction::TrimCurves { of: reader.text(self.of), style })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct IsoCurvesKeys {
    of: Spanned<String>,
    u: Option<Spanned<Vec<Number>>>,
    v: Option<Spanned<Vec<Number>>>,
    w: Option<Spanned<Vec<Number>>>,
    radius: Spanned<Number>,
    tolerance: Option<Spanned<Number>>,
}

impl ConstructionKeys for IsoCurvesKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>, measures: &mut Measures) -> Built {
        Ok(Construction::IsoCurves {
            of: reader.text(self.of),
            u: noted("u", self.u, measures).map_or_else(Vec::new, numbers),
            v: noted("v", self.v, measures).map_or_else(Vec::new, numbers),
            w: noted("w", self.w, measures).map_or_else(Vec::new, numbers),
            style: round_tube(self.radius, self.tolerance, measures),
        })
    }
}

/// The radius of balls at control points as a multiple of that of lines, if not given.
const JOINTS: f64 = 2.0;

fn numbers(list: Vec<Number>) -> Vec<f64> {
    list.into_iter().map(|number| number.0).collect()
}

/// Returns the value of a key; adds its offset to the measures.
fn noted_one<T>(key: &'static str, value: Spanned<T>, measures: &mut Measures) -> T {
    measures.push((key, value.span().start));
    value.into_inner()
}

/// As [`noted_one`], for a key that may be left out.
fn noted<T>(key: &'static str, value: Option<Spanned<T>>, measures: &mut Measures) -> Option<T> {
    value.map(|value| noted_one(key, value, measures))
}

fn round_tube(
    radius: Spanned<Number>,
    tolerance: Option<Spanned<Number>>,
    measures: &mut Measures,
) -> TubeStyle {
    let radius = noted_one("radius", radius, measures).0;
    let tolerance = noted("tolerance", tolerance, measures).map(|length| length.0);
    TubeStyle { radius, caps: Caps::Round, tolerance }
}

fn net_style(
    radius: Spanned<Number>,
    joints: Option<Spanned<Number>>,
    measures: &mut Measures,
) -> NetStyle {
    let radius = noted_one("radius", radius, measures).0;
    let joints = noted("joints", joints, measures).map_or(JOINTS * radius, |joints| joints.0);
    NetStyle { radius, joints }
}

impl Reader<'_, '_> {
    pub(super) fn text(&self, text: Spanned<String>) -> Written<String> {
        let offset = text.span().start;
        Written::new(text.into_inner(), self.source.place(offset))
    }
}
