//! The tightest of several bends.

use super::ConstructError;

/// The tightest of the bends for which tubes are too thick. Reporting only the first bend found
/// would mean that a tube made thin enough for it fails at the next one.
#[derive(Debug, Default)]
pub struct Tightest(Option<ConstructError>);

impl Tightest {
    /// Returns what was made; `None` if it folds, which is remembered.
    ///
    /// # Errors
    /// When making it failed for another reason.
    pub fn sift<T>(
        &mut self,
        made: Result<T, ConstructError>,
    ) -> Result<Option<T>, ConstructError> {
        let error = match made {
            Ok(made) => return Ok(Some(made)),
            Err(error) => error,
        };
        let Some(radius) = error.bend() else { return Err(error) };
        let known = self.0.as_ref().and_then(ConstructError::bend);
        if known.is_none_or(|known| radius < known) {
            self.0 = Some(error);
        }
        Ok(None)
    }

    /// # Errors
    /// When something folds; the error is that of the tightest bend.
    pub fn check(self) -> Result<(), ConstructError> {
        self.0.map_or(Ok(()), Err)
    }
}

impl ConstructError {
    /// The radius of the bend where something folds.
    fn bend(&self) -> Option<f64> {
        match self {
            Self::Fold { radius, .. } => Some(*radius),
            Self::Line { error, .. } => error.bend(),
            _ => None,
        }
    }
}
