//! The tightest of several bends.

use super::ConstructError;

/// The tightest bend of those that tubes are too thick for: who makes the tube thinner than the first
/// one found allows should not be told of the next one then.
#[derive(Debug, Default)]
pub struct Tightest(Option<ConstructError>);

impl Tightest {
    /// What was made; nothing, if it folds, which is kept in mind.
    ///
    /// # Errors
    /// When it was not made for another reason.
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
    /// When something folds: where the bend is the tightest.
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
