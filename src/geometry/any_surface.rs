//! A surface of any kind.

use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};

use thiserror::Error;

use super::chart::Sealed;
use super::construct::ControlNet;
use super::trim::UvBox;
use super::{
    Chart, Charts, Direction, LimitError, LimitSurface, NurbsSurface, SurfaceDerivatives,
    SurfaceError, TriangleError, TrianglePatch, TrimmedSurface,
};
use crate::math::Aabb;

/// A surface of any kind that can be traced.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Surface {
    /// A whole NURBS surface.
    Nurbs(NurbsSurface),
    /// The part of a NURBS surface that its trims keep.
    Trimmed(TrimmedSurface),
    /// A triangular patch; its (u, v) are barycentric.
    Triangle(TrianglePatch),
    /// The limit surface of a cage: Catmull–Clark's or Doo–Sabin's.
    Limit(Arc<LimitSurface>),
}

/// Why a surface cannot be moved by an affine map.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum MoveError {
    /// It is a NURBS surface, whole or trimmed.
    #[error("{0}")]
    Nurbs(SurfaceError),
    /// It is a triangular patch.
    #[error("{0}")]
    Triangle(TriangleError),
    /// It is a limit surface.
    #[error("{0}")]
    Limit(LimitError),
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

impl From<TrianglePatch> for Surface {
    fn from(patch: TrianglePatch) -> Self {
        Self::Triangle(patch)
    }
}

impl From<LimitSurface> for Surface {
    fn from(surface: LimitSurface) -> Self {
        Self::Limit(Arc::new(surface))
    }
}

/// Surfaces made from one `Arc` share its patches.
impl From<Arc<LimitSurface>> for Surface {
    fn from(surface: Arc<LimitSurface>) -> Self {
        Self::Limit(surface)
    }
}

impl Sealed for Surface {}

impl Charts for Surface {
    fn charts(&self) -> Vec<Chart<'_>> {
        match self {
            Self::Nurbs(surface) => surface.charts(),
            Self::Trimmed(surface) => surface.charts(),
            Self::Triangle(patch) => patch.charts(),
            Self::Limit(surface) => surface.charts(),
        }
    }
}

impl Surface {
    /// The underlying NURBS surface, whole or trimmed; `None` for other kinds.
    pub fn nurbs(&self) -> Option<&NurbsSurface> {
        match self {
            Self::Nurbs(surface) => Some(surface),
            Self::Trimmed(trimmed) => Some(trimmed.surface()),
            _ => None,
        }
    }

    /// The surface with its trims, if it has any.
    pub fn trimmed(&self) -> Option<&TrimmedSurface> {
        match self {
            Self::Trimmed(trimmed) => Some(trimmed),
            _ => None,
        }
    }

    /// The kind of surface, as messages name it.
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Nurbs(_) => "a NURBS surface",
            Self::Trimmed(_) => "a trimmed NURBS surface",
            Self::Triangle(_) => "a triangular patch",
            Self::Limit(_) => "a subdivision surface",
        }
    }

    /// The control points, and the lines between neighbouring ones.
    pub fn control_net(&self) -> ControlNet {
        match self {
            Self::Nurbs(surface) => surface.into(),
            Self::Trimmed(trimmed) => trimmed.surface().into(),
            Self::Triangle(patch) => patch.into(),
            Self::Limit(surface) => surface.cage_net().clone(),
        }
    }

    /// A box that holds what is kept of the surface, except for rounding: the control points of the
    /// part within the outermost loops of its trims.
    pub fn extent(&self) -> Aabb {
        self.charts().iter().map(extent_of).fold(Aabb::EMPTY, Aabb::union)
    }

    /// The degrees in u and in v.
    pub fn degree(&self) -> [usize; 2] {
        match self {
            Self::Nurbs(surface) => surface.degree(),
            Self::Trimmed(trimmed) => trimmed.surface().degree(),
            Self::Triangle(patch) => [patch.degree(); 2],
            Self::Limit(surface) => [surface.degree(); 2],
        }
    }

    /// The number of control points; for a limit surface, of all its patches together.
    pub fn point_count(&self) -> usize {
        match self {
            Self::Nurbs(surface) => surface.control().len(),
            Self::Trimmed(trimmed) => trimmed.surface().control().len(),
            Self::Triangle(patch) => patch.control().len(),
            Self::Limit(surface) => {
                surface.patches().len() * (surface.degree() + 1) * (surface.degree() + 1)
            }
        }
    }

    /// Whether weights differ.
    pub fn is_rational(&self) -> bool {
        match self {
            Self::Nurbs(surface) => surface.is_rational(),
            Self::Trimmed(trimmed) => trimmed.surface().is_rational(),
            Self::Triangle(patch) => patch.is_rational(),
            Self::Limit(_) => false,
        }
    }

    /// The smallest parameter rectangle that holds the domain: `[start, end]` in u, then in v.
    pub fn domain(&self) -> [[f64; 2]; 2] {
        match self {
            Self::Nurbs(surface) => surface.domain(),
            Self::Trimmed(trimmed) => trimmed.surface().domain(),
            Self::Triangle(_) => [[0.0, 1.0]; 2],
            Self::Limit(surface) => [[0.0, surface.unit_count() as f64], [0.0, 1.0]],
        }
    }

    /// The parameter rectangle around `uv` over which a texture is spread: the domain, or for a
    /// limit surface the unit square.
    pub fn tile(&self, uv: DVec2) -> [[f64; 2]; 2] {
        match self {
            Self::Limit(surface) => {
                let last = surface.unit_count().saturating_sub(1) as f64;
                let unit = uv.x.floor().clamp(0.0, last);
                [[unit, unit + 1.0], [0.0, 1.0]]
            }
            _ => self.domain(),
        }
    }

    /// Whether `uv` is exactly on a border of the domain, except that `u + v` of a triangular patch
    /// may be rounded. Hits are known to be at a border to within rounding by
    /// [`HitFlags::BORDER`](crate::intersect::HitFlags::BORDER).
    pub fn on_border(&self, uv: DVec2) -> bool {
        match self {
            Self::Nurbs(_) | Self::Trimmed(_) => {
                let [u, v] = self.domain();
                u.contains(&uv.x) || v.contains(&uv.y)
            }
            Self::Triangle(_) => {
                let w = 1.0 - uv.x - uv.y;
                uv.min_element() <= 0.0 || w <= 2.0 * f64::EPSILON
            }
            Self::Limit(surface) => surface.on_border(uv),
        }
    }

    /// The point with its first and second derivatives, on the surface as authored.
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        match self {
            Self::Nurbs(surface) => surface.derivatives(uv),
            Self::Trimmed(trimmed) => trimmed.surface().derivatives(uv),
            Self::Triangle(patch) => patch.derivatives(uv),
            Self::Limit(surface) => surface.derivatives(uv),
        }
    }

    /// The point at `uv`.
    pub fn point_at(&self, uv: DVec2) -> DVec3 {
        match self {
            Self::Nurbs(surface) => surface.point_at(uv),
            Self::Trimmed(trimmed) => trimmed.surface().point_at(uv),
            Self::Triangle(patch) => patch.point_at(uv),
            Self::Limit(surface) => surface.point_at(uv),
        }
    }

    /// The unit normal, if there is one.
    pub fn normal(&self, uv: DVec2) -> Option<DVec3> {
        match self {
            Self::Nurbs(surface) => surface.normal(uv),
            Self::Trimmed(trimmed) => trimmed.surface().normal(uv),
            Self::Triangle(patch) => patch.normal(uv),
            Self::Limit(surface) => surface.normal(uv),
        }
    }

    /// The surface with its normals reversed, which moves its parameters: a NURBS surface, whole
    /// or trimmed, is run backwards in u, `u` becoming `a + b − u` on the domain from `a` to `b`
    /// (see [`NurbsSurface::reversed_u`]); in a triangular patch, u and v are exchanged, and so
    /// they are within each unit square of a limit surface.
    #[must_use]
    pub fn reversed(&self) -> Self {
        match self {
            Self::Nurbs(surface) => surface.reversed_u().into(),
            Self::Trimmed(trimmed) => trimmed.reversed_u().into(),
            Self::Triangle(patch) => patch.swapped().into(),
            Self::Limit(surface) => surface.reversed().into(),
        }
    }

    /// The surface with u and v exchanged, `S(v, u)`, which reverses its normals; those of a limit
    /// surface are exchanged within each unit square. Trims are exchanged, too: the same part of
    /// the surface is kept. Nothing is rounded.
    ///
    /// Of a triangular patch and of a limit surface this is the same as
    /// [`reversed`](Self::reversed).
    #[must_use]
    pub fn swapped(&self) -> Self {
        match self {
            Self::Nurbs(surface) => surface.swapped().into(),
            Self::Trimmed(trimmed) => trimmed.swapped().into(),
            Self::Triangle(patch) => patch.swapped().into(),
            Self::Limit(surface) => surface.reversed().into(),
        }
    }

    /// The surface moved by an affine map; the parameters stay as they are.
    ///
    /// # Errors
    /// When the map is not finite, flattens space, or takes a control point too far.
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, MoveError> {
        match self {
            Self::Nurbs(surface) => {
                surface.transformed(map).map(Self::from).map_err(MoveError::Nurbs)
            }
            Self::Trimmed(trimmed) => {
                trimmed.transformed(map).map(Self::from).map_err(MoveError::Nurbs)
            }
            Self::Triangle(patch) => {
                patch.transformed(map).map(Self::from).map_err(MoveError::Triangle)
            }
            Self::Limit(surface) => {
                surface.transformed(map).map(Self::from).map_err(MoveError::Limit)
            }
        }
    }
}

/// A box that holds what is kept of a chart.
fn extent_of(chart: &Chart<'_>) -> Aabb {
    let Some(trims) = &chart.trims else { return Aabb::around(chart.surface.points()) };
    let UvBox { min, max } = trims.bounds();
    if !min.cmplt(max).all() {
        return Aabb::around([min, max].map(|uv| chart.surface.point_at(uv)));
    }
    let part = chart.surface.restricted(Direction::U, [min.x, max.x]);
    Aabb::around(part.restricted(Direction::V, [min.y, max.y]).points())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::shapes;
    use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};

    #[test]
    fn extents_hold_what_is_kept_and_little_more() {
        let cut = |kept: Kept, radius: f64| {
            let plane = shapes::plane(2.0, 1.0).unwrap();
            let domain = TrimDomain::with_seams_of(&plane).unwrap();
            let circle = TrimLoop::circle(DVec2::splat(0.5), radius).unwrap();
            let trims = Trims::new(domain, kept, &[circle]).unwrap();
            Surface::from(TrimmedSurface::new(plane, trims).unwrap()).extent().size()
        };
        for radius in [1e-12, 1e-7, 0.25] {
            let off = cut(Kept::Odd, radius) - 2.0 * radius * DVec3::new(2.0, 1.0, 0.0);
            assert!(off.abs().max_element() < 1e-15, "{radius:e}: {off}");
        }
        assert_eq!(cut(Kept::Even, 0.25), DVec3::new(2.0, 1.0, 0.0));
        let whole = Surface::from(shapes::plane(2.0, 1.0).unwrap());
        assert_eq!(whole.extent().size(), DVec3::new(2.0, 1.0, 0.0));
    }
}
