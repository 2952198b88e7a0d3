//! The keys of transforms.

use serde::{Deserialize, Deserializer};
use toml::Spanned;

use super::kinds::Kinds;
use super::values::{Axis, Exactly, Factors, Number, Vector};
use crate::io::keyed::keyed;

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum TransformKeys {
    Translate(Spanned<Vector>),
    Rotate(Rotation),
    Scale(Spanned<Factors>),
    Matrix(Spanned<Exactly<Exactly<Number, 4>, 3>>),
}

/// The keys of a rotation.
pub(super) struct Rotation(pub(super) RotateKeys);

impl<'de> Deserialize<'de> for Rotation {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        keyed(deserializer, "a table, as in rotate = { axis = \"z\", degrees = 90 }").map(Self)
    }
}

impl Kinds for TransformKeys {
    const EXAMPLE: &'static str = "a transform, as in { translate = [1, 0, 0] }";
    const APART: &'static str = "each transform is a table of its own, [{ … }, { … }]";
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RotateKeys {
    pub(super) axis: Spanned<Axis>,
    pub(super) degrees: Number,
}
