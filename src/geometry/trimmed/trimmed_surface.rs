//! Trimmed NURBS surfaces.

use std::sync::Arc;

use glam::{DAffine3, DVec2};

use crate::geometry::chart::Sealed;
use crate::geometry::trim::{Side, TrimDomain, TrimError, Trims};
use crate::geometry::{Chart, Charts, NurbsSurface, SurfaceError};

/// The part of a NURBS surface that its trims keep.
///
/// The part is closed: it contains its edges, as a surface contains its borders.
///
/// # Invariants, checked once on construction
/// - the trims' domain is the surface's, bit for bit.
#[derive(Clone, Debug, PartialEq)]
pub struct TrimmedSurface {
    surface: NurbsSurface,
    trims: Arc<Trims>,
}

impl TrimmedSurface {
    /// A surface with its trims, whose domain [`TrimDomain::with_seams_of`] makes.
    ///
    /// On one without seams, made by [`TrimDomain::of`], a loop that crosses a seam of the surface
    /// ends there: of a hole over the seam, one side is cut out.
    ///
    /// # Errors
    /// When the trims are made for another domain.
    pub fn new(surface: NurbsSurface, trims: impl Into<Arc<Trims>>) -> Result<Self, TrimError> {
        let trims = trims.into();
        let [own, theirs] = [TrimDomain::of(&surface)?, trims.domain()].map(|d| d.bounds());
        if own == theirs {
            return Ok(Self { surface, trims });
        }
        let [surface, trims] = [own, theirs].map(|bounds| [bounds.min, bounds.max]);
        Err(TrimError::OtherDomain { trims, surface })
    }

    /// The whole surface.
    pub fn surface(&self) -> &NurbsSurface {
        &self.surface
    }

    /// The trims, which say which part of the surface is kept.
    pub fn trims(&self) -> &Arc<Trims> {
        &self.trims
    }

    /// Whether a point of the domain is kept, edges included.
    pub fn keeps(&self, uv: DVec2) -> bool {
        self.trims.side_of(uv) != Side::Outside
    }

    /// The surface and its trims run backwards in u, which reverses the normals; the domain stays
    /// (see [`KnotVector::reversed`](crate::geometry::KnotVector::reversed)).
    #[must_use]
    pub fn reversed_u(&self) -> Self {
        let surface = self.surface.reversed_u();
        let [[start, end], _] = surface.domain(); // a new one if knots are very close together
        let trims = Arc::new(self.trims.reversed_u([start, end]));
        Self { surface, trims }
    }

    /// The surface and its trims with u and v exchanged, which reverses the normals and keeps the
    /// same part of the surface.
    #[must_use]
    pub fn swapped(&self) -> Self {
        Self { surface: self.surface.swapped(), trims: Arc::new(self.trims.swapped()) }
    }

    /// The surface moved by an affine map; parameters and trims stay as they are.
    ///
    /// # Errors
    /// As [`NurbsSurface::transformed`].
    pub fn transformed(&self, map: &DAffine3) -> Result<Self, SurfaceError> {
        let surface = self.surface.transformed(map)?;
        Ok(Self { surface, trims: Arc::clone(&self.trims) })
    }
}

impl Sealed for TrimmedSurface {}

impl Charts for TrimmedSurface {
    fn charts(&self) -> Vec<Chart<'_>> {
        vec![Chart { trims: Some(Arc::clone(&self.trims)), ..Chart::whole(&self.surface) }]
    }
}
