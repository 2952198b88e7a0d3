//! Curves by other forms than control points in a scene file: their keys, as `from_curves.md` shows
//! them.

use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::Named;
use super::Reader;
use super::values::{Exactly, Number, Point};
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

/// A curve by the coefficients of powers of its parameter.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PowerKeys {
    coefficients: Spanned<Vec<Point>>,
    denominator: Option<Spanned<Vec<Number>>>,
    domain: Option<Spanned<Exactly<Number, 2>>>,
}

impl Reader<'_, '_> {
    pub(super) fn power(&self, keys: PowerKeys) -> CurveKind {
        let offset = keys.coefficients.span().start;
        let vectors = |list: Vec<Point>| list.into_iter().map(|vector| vector.0).collect();
        let coefficients = self.written(keys.coefficients, vectors);
        let numbers = |list: Vec<Number>| list.into_iter().map(|number| number.0).collect();
        // Errors about what is not written point at what is.
        let denominator =
            keys.denominator.unwrap_or(Spanned::new(offset..offset, vec![Number(1.0)]));
        let unit = Exactly([Number(0.0), Number(1.0)]);
        let domain = keys.domain.unwrap_or(Spanned::new(offset..offset, unit));
        CurveKind::Power {
            coefficients,
            denominator: self.written(denominator, numbers),
            domain: self.written(domain, |ends| ends.0.map(|end| end.0)),
        }
    }

    pub(super) fn segment(&self, keys: SegmentKeys) -> CurveKind {
        let vectors = |list: Vec<Point>| list.into_iter().map(|vector| vector.0).collect();
        let geometry = self.written(keys.geometry, vectors);
        CurveKind::MatrixForm { form: keys.form.0.into(), geometry }
    }
}
