//! Curves by other forms than control points in a scene file: their keys, as `from_curves.md` shows
//! them.

use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::Named;
use super::Reader;
use super::values::Point;
use crate::geometry::MatrixForm;
use crate::scene::CurveKind;

/// The name of a matrix form.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum FormKey {
    Bezier,
    Bspline,
    Hermite,
    CatmullRom,
}

impl From<FormKey> for MatrixForm {
    fn from(form: FormKey) -> Self {
        match form {
            FormKey::Bezier => Self::Bezier,
            FormKey::Bspline => Self::BSpline,
            FormKey::Hermite => Self::Hermite,
            FormKey::CatmullRom => Self::CatmullRom,
        }
    }
}

/// A segment in matrix form.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SegmentKeys {
    form: Named<FormKey>,
    geometry: Spanned<Vec<Point>>,
}

impl Reader<'_, '_> {
    pub(super) fn segment(&self, keys: SegmentKeys) -> CurveKind {
        let vectors = |list: Vec<Point>| list.into_iter().map(|vector| vector.0).collect();
        let geometry = self.written(keys.geometry, vectors);
        CurveKind::MatrixForm { form: keys.form.0.into(), geometry }
    }
}
