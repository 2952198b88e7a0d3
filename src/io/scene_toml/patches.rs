//! Patches by other forms than a control net in a scene file.

use serde::Deserialize;
use toml::Spanned;

use super::super::keyed::Named;
use super::constructions::ConstructionKeys;
use super::forms::FormKey;
use super::values::{Measures, NetPoint};
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
