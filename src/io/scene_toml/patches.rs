//! Patches by other forms than a control net in a scene file.

use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::Named;
use super::constructions::ConstructionKeys;
use super::forms::FormKey;
use super::values::{Exactly, Measures, NetPoint, Number};
use super::{LoadError, Reader};
use crate::scene::Construction;

/// A patch in matrix form.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MatrixPatchKeys {
    form: Named<FormKey>,
    geometry: Spanned<Vec<Vec<NetPoint>>>,
}

impl ConstructionKeys for MatrixPatchKeys {
    fn construction(
        self: Box<Self>,
        _: &Reader<'_, '_>,
        measures: &mut Measures,
    ) -> Result<Construction, LoadError> {
        measures.push(("geometry", self.geometry.span().start));
        let rows = self.geometry.into_inner().into_iter();
        let geometry = rows.map(|row| row.into_iter().map(|vector| vector.0).collect()).collect();
        Ok(Construction::MatrixForm { form: self.form.0.into(), geometry })
    }
}

/// A patch by the coefficients of powers of its parameters.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PowerPatchKeys {
    coefficients: Spanned<Vec<Vec<NetPoint>>>,
    denominator: Option<Spanned<Vec<Vec<Number>>>>,
    domain: Option<Spanned<Exactly<Exactly<Number, 2>, 2>>>,
}

impl ConstructionKeys for PowerPatchKeys {
    fn construction(
        self: Box<Self>,
        _: &Reader<'_, '_>,
        measures: &mut Measures,
    ) -> Result<Construction, LoadError> {
        measures.push(("coefficients", self.coefficients.span().start));
        let rows = self.coefficients.into_inner().into_iter();
        let coefficients =
            rows.map(|row| row.into_iter().map(|vector| vector.0).collect()).collect();
        let denominator = self.denominator.map_or_else(
            || vec![vec![1.0]],
            |rows| {
                measures.push(("denominator", rows.span().start));
                let rows = rows.into_inner().into_iter();
                rows.map(|row| row.into_iter().map(|number| number.0).collect()).collect()
            },
        );
        let domain = self.domain.map_or([[0.0, 1.0]; 2], |domain| {
            measures.push(("domain", domain.span().start));
            domain.into_inner().0.map(|ends| ends.0.map(|end| end.0))
        });
        Ok(Construction::Power { coefficients, denominator, domain })
    }
}
