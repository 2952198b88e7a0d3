//! Surfaces made from curves in a scene file, as `from_curves.md` shows them.

use serde::Deserialize;
use toml::Spanned;

use super::curves::CurveKeys;
use super::values::{Axis, Number, Vector};
use super::{LoadError, Reader};
use crate::scene::Construction;

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

/// The keys of every construction.
pub(super) enum ConstructionKeys {
    Revolution(Box<RevolutionKeys>),
    Extrusion(Box<ExtrusionKeys>),
    Ruled(Box<RuledKeys>),
    Coons(Box<CoonsKeys>),
    Loft(Box<LoftKeys>),
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
        })
    }
}
