//! Subdivision surfaces as written.

use std::sync::Arc;

use super::{Place, Written};
use crate::geometry::{Cage, LimitError, LimitSurface};

/// A subdivision surface: a cage, the scheme that smooths it, and the tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct Subdivision {
    /// The cage.
    pub cage: Arc<Cage>,
    /// The scheme.
    pub scheme: Scheme,
    /// How far the surface may be from the scheme's limit surface, in the object's own units;
    /// [`Cage::default_tolerance`] if not given.
    pub tolerance: Option<Written<f64>>,
}

/// A way to smooth a cage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scheme {
    /// Catmull & Clark's: bicubic, with creases and corners.
    CatmullClark,
    /// Doo & Sabin's: biquadratic.
    DooSabin,
}

impl Scheme {
    /// Its name in scenes.
    pub fn name(self) -> &'static str {
        match self {
            Self::CatmullClark => "catmull_clark",
            Self::DooSabin => "doo_sabin",
        }
    }
}

impl Subdivision {
    /// The surface.
    pub(in crate::scene) fn surface(&self) -> Result<LimitSurface, LimitError> {
        let tolerance = self.tolerance.as_ref().map(|tolerance| tolerance.value);
        let tolerance = tolerance.unwrap_or_else(|| self.cage.default_tolerance());
        match self.scheme {
            Scheme::CatmullClark => self.cage.catmull_clark(tolerance),
            Scheme::DooSabin => self.cage.doo_sabin(tolerance),
        }
    }

    /// Where the tolerance was written, if an error is about it.
    pub(in crate::scene) fn blame(&self, error: &LimitError) -> Option<&Place> {
        let too_fine = matches!(
            error,
            LimitError::Tolerance { .. }
                | LimitError::TooManyPatches { .. }
                | LimitError::TooDeep { .. }
        );
        self.tolerance.as_ref().filter(|_| too_fine).map(|tolerance| &tolerance.place)
    }
}
