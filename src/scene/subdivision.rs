//! Subdivision surfaces as written.

use std::borrow::Cow;
use std::sync::Arc;

use super::{DrawError, Place, Written};
use crate::geometry::construct::NetStyle;
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

/// More steps than these bring any cage beyond what can be drawn, if it grows at all.
const MOST_STEPS: usize = 16;

impl Subdivision {
    /// The cage after this many steps of the scheme.
    ///
    /// # Errors
    /// When there are more steps than any cage that grows can take, or a cage on the way has more
    /// vertices than can be drawn: after the first few, each step makes about four times as many.
    pub(super) fn cage_after(&self, steps: usize) -> Result<Cow<'_, Cage>, DrawError> {
        if steps > MOST_STEPS {
            return Err(DrawError::Steps { steps, most: MOST_STEPS });
        }
        let mut cage = Cow::Borrowed(&*self.cage);
        for after in 0..steps {
            let (count, limit) = (cage.positions().len(), NetStyle::MAX_POINTS);
            if count > limit {
                return Err(DrawError::LargeCage { after, steps, count, limit });
            }
            cage = Cow::Owned(match self.scheme {
                Scheme::CatmullClark => cage.refined_catmull_clark(),
                Scheme::DooSabin => cage.refined_doo_sabin(),
            });
        }
        Ok(cage)
    }

    /// The surface.
    pub(super) fn surface(&self) -> Result<LimitSurface, LimitError> {
        let tolerance = self.tolerance.as_ref().map(|tolerance| tolerance.value);
        let tolerance = tolerance.unwrap_or_else(|| self.cage.default_tolerance());
        match self.scheme {
            Scheme::CatmullClark => self.cage.catmull_clark(tolerance),
            Scheme::DooSabin => self.cage.doo_sabin(tolerance),
        }
    }

    /// Where the tolerance was written, if an error is about it.
    pub(super) fn blame(&self, error: &LimitError) -> Option<&Place> {
        let too_fine = matches!(
            error,
            LimitError::Tolerance { .. }
                | LimitError::TooManyPatches { .. }
                | LimitError::TooDeep { .. }
        );
        self.tolerance.as_ref().filter(|_| too_fine).map(|tolerance| &tolerance.place)
    }
}
