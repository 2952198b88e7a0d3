//! Surfaces made from curves in a scene file, as `from_curves.md` shows them.

use serde::Deserialize;
use toml::Spanned;

use super::curves::CurveKeys;
use super::values::{Axis, Number, Vector};
use super::{LoadError, Reader};
use crate::geometry::construct::{Caps, NetStyle, RibbonStyle, SweepOptions, TubeStyle};
use crate::scene::{Construction, Written};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RevolutionKeys {
    profile: Spanned<CurveKeys>,
    axis: Option<Axis>,
    through: Option<Vector>,
    degrees: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct ExtrusionKeys {
    profile: Spanned<CurveKeys>,
    by: Vector,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RuledKeys {
    from: Spanned<CurveKeys>,
    to: Spanned<CurveKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct CoonsKeys {
    u0: Spanned<CurveKeys>,
    u1: Spanned<CurveKeys>,
    v0: Spanned<CurveKeys>,
    v1: Spanned<CurveKeys>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LoftKeys {
    sections: Vec<Spanned<CurveKeys>>,
    degree: Option<u32>,
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TubeKeys {
    curve: Spanned<CurveKeys>,
    radius: Number,
    #[serde(default)]
    caps: CapsKey,
    tolerance: Option<Number>,
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PolygonKeys {
    curve: Spanned<CurveKeys>,
    radius: Number,
    joints: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct NetKeys {
    of: Spanned<String>,
    radius: Number,
    joints: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TrimCurvesKeys {
    of: Spanned<String>,
    radius: Number,
    tolerance: Option<Number>,
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

/// Balls at control points are so many times as thick as lines, if nothing else is said.
const JOINTS: f64 = 2.0;

fn net_style(radius: Number, joints: Option<Number>) -> NetStyle {
    NetStyle { radius: radius.0, joints: joints.map_or(JOINTS * radius.0, |joints| joints.0) }
}

/// The keys of every construction.
pub(super) enum ConstructionKeys {
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
    TrimCurves(Box<TrimCurvesKeys>),
    IsoCurves(Box<IsoCurvesKeys>),
}

impl Reader<'_, '_> {
    pub(super) fn construction(&self, keys: ConstructionKeys) -> Result<Construction, LoadError> {
        Ok(match keys {
            ConstructionKeys::Revolution(keys) => Construction::Revolution {
                profile: self.curve(keys.profile)?,
                through: keys.through.map(|point| point.0).unwrap_or_default(),
                axis: keys.axis.map_or(glam::DVec3::Z, |axis| axis.0),
                degrees: keys.degrees.map_or(360.0, |angle| angle.0),
            },
            ConstructionKeys::Extrusion(keys) => {
                Construction::Extrusion { profile: self.curve(keys.profile)?, by: keys.by.0 }
            }
            ConstructionKeys::Ruled(keys) => {
                Construction::Ruled { from: self.curve(keys.from)?, to: self.curve(keys.to)? }
            }
            ConstructionKeys::Coons(keys) => Construction::Coons(Box::new([
                self.curve(keys.u0)?,
                self.curve(keys.u1)?,
                self.curve(keys.v0)?,
                self.curve(keys.v1)?,
            ])),
            ConstructionKeys::Loft(keys) => {
                let sections = keys.sections.into_iter().map(|curve| self.curve(curve));
                Construction::Loft {
                    sections: sections.collect::<Result<_, _>>()?,
                    degree: keys.degree.map(|degree| degree as usize),
                }
            }
            ConstructionKeys::Sweep(keys) => Construction::Sweep {
                profile: self.curve(keys.profile)?,
                path: self.curve(keys.path)?,
                options: SweepOptions {
                    up: keys.up.map(|up| up.0),
                    twist: keys.twist.map_or(0.0, |twist| twist.0),
                    scale: keys.scale.map_or(vec![1.0], |list| list.iter().map(|s| s.0).collect()),
                    tolerance: keys.tolerance.map(|tolerance| tolerance.0),
                },
            },
            ConstructionKeys::Tube(keys) => {
                let caps = match keys.caps {
                    CapsKey::Open => Caps::Open,
                    CapsKey::Flat => Caps::Flat,
                    CapsKey::Round => Caps::Round,
                };
                let tolerance = keys.tolerance.map(|tolerance| tolerance.0);
                let style = TubeStyle { radius: keys.radius.0, caps, tolerance };
                Construction::Tube { curve: self.curve(keys.curve)?, style }
            }
            ConstructionKeys::Ribbon(keys) => Construction::Ribbon {
                curve: self.curve(keys.curve)?,
                style: RibbonStyle {
                    width: keys.width.0,
                    up: keys.up.map(|up| up.0),
                    twist: keys.twist.map_or(0.0, |twist| twist.0),
                    tolerance: keys.tolerance.map(|tolerance| tolerance.0),
                },
            },
            ConstructionKeys::Polygon(keys) => Construction::Polygon {
                curve: self.curve(keys.curve)?,
                style: net_style(keys.radius, keys.joints),
            },
            ConstructionKeys::Net(keys) => {
                let style = net_style(keys.radius, keys.joints);
                Construction::Net { of: self.text(keys.of), style }
            }
            ConstructionKeys::TrimCurves(keys) => {
                let tolerance = keys.tolerance.map(|tolerance| tolerance.0);
                Construction::TrimCurves {
                    of: self.text(keys.of),
                    style: TubeStyle { radius: keys.radius.0, caps: Caps::Round, tolerance },
                }
            }
            ConstructionKeys::IsoCurves(keys) => {
                let tolerance = keys.tolerance.map(|tolerance| tolerance.0);
                let numbers = |list: Vec<Number>| list.into_iter().map(|number| number.0).collect();
                Construction::IsoCurves {
                    of: self.text(keys.of),
                    u: numbers(keys.u),
                    v: numbers(keys.v),
                    w: numbers(keys.w),
                    style: TubeStyle { radius: keys.radius.0, caps: Caps::Round, tolerance },
                }
            }
        })
    }

    pub(super) fn text(&self, text: Spanned<String>) -> Written<String> {
        let offset = text.span().start;
        Written::new(text.into_inner(), self.source.place(offset))
    }
}
