//! Surfaces made from curves in a scene file, as `from_curves.md` shows them.

use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::Keyed;
use super::curves::CurveKeys;
use super::values::{Axis, Number, Vector};
use super::{LoadError, Reader};
use crate::geometry::construct::{Caps, NetStyle, RibbonStyle, SweepOptions, TubeStyle};
use crate::scene::{Construction, Written};

/// What the keys of a construction make.
pub(super) trait ConstructionKeys {
    /// The construction, with its curves.
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError>;
}

impl<K: ConstructionKeys> ConstructionKeys for Keyed<K> {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        Box::new(self.0).construction(reader)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RevolutionKeys {
    profile: Spanned<CurveKeys>,
    axis: Option<Axis>,
    through: Option<Vector>,
    degrees: Option<Number>,
}

impl ConstructionKeys for RevolutionKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        Ok(Construction::Revolution {
            profile: reader.curve(self.profile)?,
            through: self.through.map(|point| point.0).unwrap_or_default(),
            axis: self.axis.map_or(glam::DVec3::Z, |axis| axis.0),
            degrees: self.degrees.map_or(360.0, |angle| angle.0),
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ExtrusionKeys {
    profile: Spanned<CurveKeys>,
    by: Vector,
}

impl ConstructionKeys for ExtrusionKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        Ok(Construction::Extrusion { profile: reader.curve(self.profile)?, by: self.by.0 })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RuledKeys {
    from: Spanned<CurveKeys>,
    to: Spanned<CurveKeys>,
}

impl ConstructionKeys for RuledKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
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
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
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
    degree: Option<u32>,
}

impl ConstructionKeys for LoftKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        let sections = self.sections.into_iter().map(|curve| reader.curve(curve));
        Ok(Construction::Loft {
            sections: sections.collect::<Result<_, _>>()?,
            degree: self.degree.map(|degree| degree as usize),
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SweepKeys {
    profile: Spanned<CurveKeys>,
    path: Spanned<CurveKeys>,
    up: Option<Axis>,
    twist: Option<Number>,
    scale: Option<Vec<Number>>,
    tolerance: Option<Number>,
}

impl ConstructionKeys for SweepKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        Ok(Construction::Sweep {
            profile: reader.curve(self.profile)?,
            path: reader.curve(self.path)?,
            options: SweepOptions {
                up: self.up.map(|up| up.0),
                twist: self.twist.map_or(0.0, |twist| twist.0),
                scale: self.scale.map_or(vec![1.0], numbers),
                tolerance: self.tolerance.map(|tolerance| tolerance.0),
            },
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TubeKeys {
    curve: Spanned<CurveKeys>,
    radius: Number,
    #[serde(default)]
    caps: CapsKey,
    tolerance: Option<Number>,
}

impl ConstructionKeys for TubeKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        let caps = match self.caps {
            CapsKey::Open => Caps::Open,
            CapsKey::Flat => Caps::Flat,
            CapsKey::Round => Caps::Round,
        };
        let tolerance = self.tolerance.map(|tolerance| tolerance.0);
        let style = TubeStyle { radius: self.radius.0, caps, tolerance };
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
    width: Number,
    up: Option<Axis>,
    twist: Option<Number>,
    tolerance: Option<Number>,
}

impl ConstructionKeys for RibbonKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        Ok(Construction::Ribbon {
            curve: reader.curve(self.curve)?,
            style: RibbonStyle {
                width: self.width.0,
                up: self.up.map(|up| up.0),
                twist: self.twist.map_or(0.0, |twist| twist.0),
                tolerance: self.tolerance.map(|tolerance| tolerance.0),
            },
        })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PolygonKeys {
    curve: Spanned<CurveKeys>,
    radius: Number,
    joints: Option<Number>,
}

impl ConstructionKeys for PolygonKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        let style = net_style(self.radius, self.joints);
        Ok(Construction::Polygon { curve: reader.curve(self.curve)?, style })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NetKeys {
    of: Spanned<String>,
    radius: Number,
    joints: Option<Number>,
}

impl ConstructionKeys for NetKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        let style = net_style(self.radius, self.joints);
        Ok(Construction::Net { of: reader.text(self.of), style })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TrimCurvesKeys {
    of: Spanned<String>,
    radius: Number,
    tolerance: Option<Number>,
}

impl ConstructionKeys for TrimCurvesKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        let style = round_tube(self.radius, self.tolerance);
        Ok(Construction::TrimCurves { of: reader.text(self.of), style })
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct IsoCurvesKeys {
    of: Spanned<String>,
    #[serde(default)]
    u: Vec<Number>,
    #[serde(default)]
    v: Vec<Number>,
    #[serde(default)]
    w: Vec<Number>,
    radius: Number,
    tolerance: Option<Number>,
}

impl ConstructionKeys for IsoCurvesKeys {
    fn construction(self: Box<Self>, reader: &Reader<'_, '_>) -> Result<Construction, LoadError> {
        Ok(Construction::IsoCurves {
            of: reader.text(self.of),
            u: numbers(self.u),
            v: numbers(self.v),
            w: numbers(self.w),
            style: round_tube(self.radius, self.tolerance),
        })
    }
}

/// Balls at control points are so many times as thick as lines, if nothing else is said.
const JOINTS: f64 = 2.0;

fn numbers(list: Vec<Number>) -> Vec<f64> {
    list.into_iter().map(|number| number.0).collect()
}

fn round_tube(radius: Number, tolerance: Option<Number>) -> TubeStyle {
    let tolerance = tolerance.map(|tolerance| tolerance.0);
    TubeStyle { radius: radius.0, caps: Caps::Round, tolerance }
}

fn net_style(radius: Number, joints: Option<Number>) -> NetStyle {
    NetStyle { radius: radius.0, joints: joints.map_or(JOINTS * radius.0, |joints| joints.0) }
}

impl Reader<'_, '_> {
    pub(super) fn text(&self, text: Spanned<String>) -> Written<String> {
        let offset = text.span().start;
        Written::new(text.into_inner(), self.source.place(offset))
    }
}
