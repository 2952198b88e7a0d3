//! Surfaces made from curves, as written.

use glam::DVec3;

use super::curve::CurveFault;
use super::{CurveSpec, Place, SceneError, SceneFault};
use crate::geometry::NurbsSurface;
use crate::geometry::construct::{self, Axis, Borders, ConstructError};

/// Surfaces made from curves; [`construct`] says how each is made and runs.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Construction {
    /// A profile turned about an axis.
    Revolution {
        /// The profile.
        profile: CurveSpec,
        /// A point of the axis.
        through: DVec3,
        /// The axis' direction.
        axis: DVec3,
        /// The angle.
        degrees: f64,
    },
    /// A profile moved along a vector.
    Extrusion {
        /// The profile.
        profile: CurveSpec,
        /// The vector.
        by: DVec3,
    },
    /// Straight lines from one curve to another.
    Ruled {
        /// The one.
        from: CurveSpec,
        /// The other.
        to: CurveSpec,
    },
    /// A Coons patch between four borders: those of constant u, then of constant v.
    Coons(Box<[CurveSpec; 4]>),
    /// A surface through section curves.
    Loft {
        /// The sections in turn.
        sections: Vec<CurveSpec>,
        /// The degree across; as high as the sections allow up to 3 if not given.
        degree: Option<usize>,
    },
}

/// A surface made, and how far it is from what was asked for.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Made {
    /// What it is called within its object; may be empty.
    pub(super) name: String,
    pub(super) surface: NurbsSurface,
    /// A bound of the distance in space; 0 where it is exact.
    pub(super) deviation: f64,
}

impl From<NurbsSurface> for Made {
    /// A surface that is exactly what was asked for, the only one.
    fn from(surface: NurbsSurface) -> Self {
        Self { name: String::new(), surface, deviation: 0.0 }
    }
}

/// Makes the surfaces of one part: knows what errors should call it, and where it stands.
pub(super) struct Workshop<'a> {
    /// The surface's name.
    pub(super) surface: &'a str,
    /// Where the construction was written.
    pub(super) place: &'a Place,
}

impl Construction {
    /// Its name in scenes.
    pub fn name(&self) -> &'static str {
        match self {
            Self::Revolution { .. } => "revolution",
            Self::Extrusion { .. } => "extrusion",
            Self::Ruled { .. } => "ruled",
            Self::Coons(_) => "coons",
            Self::Loft { .. } => "loft",
        }
    }

    /// The number of control points of its curves.
    pub fn point_count(&self) -> usize {
        self.curves().into_iter().map(CurveSpec::point_count).fold(0, usize::saturating_add)
    }

    fn curves(&self) -> Vec<&CurveSpec> {
        match self {
            Self::Revolution { profile, .. } | Self::Extrusion { profile, .. } => vec![profile],
            Self::Ruled { from, to } => vec![from, to],
            Self::Coons(borders) => borders.iter().collect(),
            Self::Loft { sections, .. } => sections.iter().collect(),
        }
    }

    /// The surfaces.
    pub(super) fn make(&self, shop: &Workshop<'_>) -> Result<Vec<Made>, SceneError> {
        let surface = match self {
            Self::Revolution { profile, through, axis, degrees } => {
                let profile = shop.curve("profile", profile)?;
                let axis = shop.checked(Axis::new(*through, *axis))?;
                shop.checked(construct::revolve(&profile, &axis, *degrees))?
            }
            Self::Extrusion { profile, by } => {
                let profile = shop.curve("profile", profile)?;
                shop.checked(construct::extrude(&profile, *by))?
            }
            Self::Ruled { from, to } => {
                let (from, to) = (shop.curve("from", from)?, shop.curve("to", to)?);
                shop.checked(construct::ruled(&from, &to))?
            }
            Self::Coons(borders) => {
                let [u0, u1, v0, v1] = &**borders;
                let borders = Borders {
                    u0: shop.curve("border u0", u0)?,
                    u1: shop.curve("border u1", u1)?,
                    v0: shop.curve("border v0", v0)?,
                    v1: shop.curve("border v1", v1)?,
                };
                shop.checked(construct::coons(&borders))?
            }
            Self::Loft { sections, degree } => {
                let made = sections.iter().enumerate();
                let made =
                    made.map(|(index, curve)| shop.curve(&format!("section {index}"), curve));
                let made = made.collect::<Result<Vec<_>, _>>()?;
                let highest = made.len().saturating_sub(1).clamp(1, construct::LOFT_DEGREE);
                shop.checked(construct::loft(&made, degree.unwrap_or(highest)))?.surface
            }
        };
        Ok(vec![surface.into()])
    }
}

impl Workshop<'_> {
    /// The curve written under a key.
    fn curve(
        &self,
        key: &str,
        curve: &CurveSpec,
    ) -> Result<crate::geometry::NurbsCurve, SceneError> {
        let surface = self.surface.to_owned();
        curve.curve().map_err(|fault| match fault {
            CurveFault::Curve(place, error) => {
                let error = ConstructError::Curve { which: key.to_owned(), error };
                SceneError::new(place, SceneFault::Construction { surface, error })
            }
            CurveFault::Transform(place, error) => {
                let object = format!("{surface}, {key}");
                SceneError::new(place, SceneFault::Transform { object, error })
            }
        })
    }

    /// What was made, or why not.
    fn checked<T>(&self, made: Result<T, ConstructError>) -> Result<T, SceneError> {
        made.map_err(|error| {
            let surface = self.surface.to_owned();
            SceneError::new(self.place.clone(), SceneFault::Construction { surface, error })
        })
    }
}
