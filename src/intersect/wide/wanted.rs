//! What rays ask for.

use super::frames::END_SPARE;

/// What a ray asks for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Wanted {
    /// Its first hit.
    #[default]
    First,
    /// Any hit.
    Any,
    /// All hits: those of a single ray that are certified, and the leaves where there may be
    /// others.
    All,
}

impl Wanted {
    /// How far along a ray, in scaled coordinates, anything matters once the ray has a hit at `z`,
    /// if its origin was moved by `shift`.
    #[inline(always)]
    pub(super) fn far(self, z: f64, shift: f64, scale: f64) -> f32 {
        match self {
            Self::First => ((z - shift) * scale + f64::from(END_SPARE)) as f32,
            Self::Any => f32::NEG_INFINITY,
            Self::All => f32::INFINITY,
        }
    }
}
