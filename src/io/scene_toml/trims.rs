//! Trims in a scene file, as `trims.md` shows them.

use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::{Keyed, Named};
use super::curves::CurveKeys;
use super::kinds::{Kinds, OneOf};
use super::values::{Number, Pair};
use super::{LoadError, Reader};
use crate::geometry::trim::Kept;
use crate::scene::{LoopKind, LoopSpec, Part, TrimSpec};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct TrimKeys {
    #[serde(default)]
    keep: Named<KeepKey>,
    loops: Vec<Spanned<OneOf<LoopKeys>>>,
}

#[derive(Clone, Copy, Default, Deserialize)]
#[serde(rename_all = "snake_case")]
enum KeepKey {
    #[default]
    Inside,
    Outside,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum LoopKeys {
    #[serde(alias = "polyline")]
    Polygon(Vec<Pair>),
    Circle(Keyed<CircleKeys>),
    Curves(Vec<Spanned<CurveKeys>>),
}

impl Kinds for LoopKeys {
    const EXAMPLE: &'static str =
        "a loop, as in { circle = { center = [0.5, 0.5], radius = 0.2 } }";
    const APART: &'static str = "each loop is a table of its own, [{ … }, { … }]";
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct CircleKeys {
    center: Pair,
    radius: Number,
}

impl Reader<'_, '_> {
    /// Gives an object's one surface its trims.
    pub(super) fn trim(
        &self,
        keys: Spanned<Keyed<TrimKeys>>,
        parts: &mut [Part],
    ) -> Result<(), LoadError> {
        let place = self.source.place(keys.span().start);
        let [part] = parts else {
            let count = parts.len();
            let message = format!("trims: they cut one surface, and this shape has {count}");
            return Err(LoadError::malformed(place, message));
        };
        if part.trims.is_some() {
            let message = "trims: the surface of this file has its own";
            return Err(LoadError::malformed(place, message));
        }
        let Keyed(keys) = keys.into_inner();
        let kept = match keys.keep.0 {
            KeepKey::Inside => Kept::Odd,
            KeepKey::Outside => Kept::Even,
        };
        let loops = keys.loops.into_iter().map(|one| self.trim_loop(one));
        part.trims = Some(TrimSpec { place, kept, loops: loops.collect::<Result<_, _>>()? });
        Ok(())
    }

    fn trim_loop(&self, keys: Spanned<OneOf<LoopKeys>>) -> Result<LoopSpec, LoadError> {
        let place = self.source.place(keys.span().start);
        let OneOf(keys) = keys.into_inner();
        let kind = match keys {
            LoopKeys::Polygon(corners) => {
                LoopKind::Polygon(corners.into_iter().map(|corner| corner.0).collect())
            }
            LoopKeys::Circle(Keyed(CircleKeys { center: Pair(center), radius })) => {
                LoopKind::Circle { center, radius: radius.0 }
            }
            LoopKeys::Curves(curves) => {
                let curves = curves.into_iter().map(|curve| self.curve(curve));
                LoopKind::Curves(curves.collect::<Result<_, _>>()?)
            }
        };
        Ok(LoopSpec { place, kind, sense: None })
    }
}
