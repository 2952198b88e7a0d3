//! A surface of any kind.

use glam::{DAffine3, DVec2, DVec3};

use super::{Chart, Charts, NurbsSurface, SurfaceDerivatives, SurfaceError, TrimmedSurface};

/// A surface of any kind that can be traced.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Surface {
    /// A whole NURBS surface.
    Nurbs(NurbsSurface),
    /// A part of a NURBS surface.
    Trimmed(TrimmedSurface),
}

impl From<NurbsSurface> for Surface {
    fn from(surface: NurbsSurface) -> Self {
        Self::Nurbs(surface)
    }
}

impl From<TrimmedSurface> for Surface {
    fn from(surface: TrimmedSurface) -> Self {
        Self::Trimmed(surface)
    }
}

impl Charts for Surface {
    fn charts(&self) -> Vec<Chart<'_>> {
        match self {
            Self::Nurbs(surface) => surface.charts(),
            Self::Trimmed(surface) => surface.charts(),
        }
    }
}

impl Surface {
    /// The NURBS surface, if it is one or a part of one.
    pub fn nurbs(&self) -> Option<&NurbsSurface> {
        match self {
            Self::Nurbs(surface) => Some(surface),
            Self::Trimmed(trimmed) => Some(trimmed.surface()),
        }
    }

    /// The surface with its trims, if it has any.
    pub fn trimmed(&self) -> Option<&TrimmedSurface> {
        match self {
            Self::Trimmed(trimmed) => Some(trimmed),
            Self::Nurbs(_) => None,
        }
    }

    /// The degrees in u and in v.
    pub fn degree(&self) -> [usize; 2] {
        match self {
            Self::Nurbs(surface) => [surface.knots_u().degree(), surface.knots_v().degree()],
            Self::Trimmed(trimmed) => {
                let surface = trimmed.surface();
                [surface.knots_u().degree(), surface.knots_v().degree()]
            }
        }
    }

    /// The number of control points.
    pub fn point_count(&self) -> usize {
        match self {
            Self::Nurbs(surface) => surface.control().len(),
            Self::Trimmed(trimmed) => trimmed.surface().control().len(),
        }
    }

    /// Whether weights differ.
    pub fn is_rational(&self) -> bool {
        match self {
            Self::Nurbs(surface) => surface.is_rational(),
            Self::Trimmed(trimmed) => trimmed.surface().is_rational(),
        }
    }

    /// The smallest rectangle of parameters that holds the domain: from and to in u, then in v.
    pub fn domain(&self) -> [(f64, f64); 2] {
        match self {
            Self::Nurbs(surface) => surface.domain(),
            Self::Trimmed(trimmed) => trimmed.surface().domain(),
        }
    }

    /// The point with its first and second derivatives, on the surface as authored.
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        match self {
            Self::Nurbs(surface) => surface.derivatives(uv.x, uv.y),
            Self::Trimmed(trimmed) => trimmed.surface().derivatives(uv.x, uv.y),
        }
    }

    /// The point.
    pub fn point_at(&self, uv: DVec2) -> DVec3 {
        match self {
            Self::Nurbs(surface) => surface.point_at(uv.x, uv.y),
            Self::Trimmed(trimmed) => trimmed.surface().point_at(uv.x, uv.y),
        }
    }

    /// The unit normal, if there is one.
    pub fn normal(&self, uv: DVec2) -> Option<DVec3> {
        match self {
            Self::Nurbs(surface) => surface.normal(uv.x, uv.y),
            Self::Trimmed(trimmed) => trimmed.surface().normal(uv.x, uv.y),
        }
    }

    /// The surface with its normals turned.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Nurbs(surface) => surface.reversed_u().into(),
            Self::Trimmed(trimmed) => trimmed.reversed_u().into(),
        }
    }

    /// The surface moved by an affine map, parameters in their places.
    ///
    /// # Errors
    /// When the map is not finite, flattens space, or takes a control point too far.
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, SurfaceError> {
        match self {
            Self::Nurbs(surface) => surface.transformed(map).map(Self::from),
            Self::Trimmed(trimmed) => trimmed.transformed(map).map(Self::from),
        }
    }
}
