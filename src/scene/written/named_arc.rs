//! Parts of the unit circle by name.

use super::UnknownName;
use crate::geometry::NurbsCurve;
use crate::geometry::shapes::{
    QuadraticArc, circle_cubic, half_circle_cubic, quarter_circle_quadratic,
};

/// A part of the unit circle in the plane `z = 0`, or all of it
/// ([`shapes`](crate::geometry::shapes) says how).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NamedArc {
    /// A quarter of degree 2 with the weights 1, 1, 2.
    Quarter2,
    /// A quarter of degree 2 with the weights √2, 1, √2, divided by √2.
    Quarter2Symmetric,
    /// A half of degree 3.
    Half3,
    /// The whole of degree 3, with a triple knot.
    Full3,
}

impl NamedArc {
    /// All of them, with their names in scenes.
    const NAMES: [(&str, Self); 4] = [
        ("quarter_2", Self::Quarter2),
        ("quarter_2_symmetric", Self::Quarter2Symmetric),
        ("half_3", Self::Half3),
        ("full_3", Self::Full3),
    ];

    /// The curve.
    pub fn curve(self) -> NurbsCurve {
        match self {
            Self::Quarter2 => quarter_circle_quadratic(QuadraticArc::Rational),
            Self::Quarter2Symmetric => quarter_circle_quadratic(QuadraticArc::Symmetric),
            Self::Half3 => half_circle_cubic(),
            Self::Full3 => circle_cubic(),
        }
    }
}

impl std::str::FromStr for NamedArc {
    type Err = UnknownName;

    fn from_str(name: &str) -> Result<Self, UnknownName> {
        let found = Self::NAMES.iter().find(|(known, _)| *known == name);
        found
            .map(|(_, circle)| *circle)
            .ok_or_else(|| UnknownName::new("circle", name, &Self::NAMES.map(|(known, _)| known)))
    }
}
