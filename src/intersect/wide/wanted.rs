//! How far along a ray anything matters, in f32.

use super::frames::END_SPARE;
use crate::intersect::wanted::Wanted;

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
