//! The keys of transforms.

use serde::Deserialize;
use toml::Spanned;

use super::kinds::Kinds;
use super::values::{Axis, Exactly, Factors, Number, Vector};
use crate::io::keyed::Keyed;

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum TransformKeys {
    Translate(Spanned<Vector>),
    Rotate(Keyed<RotateKeys>),
    Scale(Spanned<Factors>),
    Matrix(Spanned<Exactly<Exactly<Number, 4>, 3>>),
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
