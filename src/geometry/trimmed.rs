//! Trimmed NURBS surfaces.

use std::sync::Arc;

use glam::{DAffine3, DVec2};

use super::trim::{Side, TrimDomain, TrimError, Trims};
use super::{Chart, Charts, Direction, NurbsSurface, SurfaceError};

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
        self.trims.contains(uv) != Side::Outside
    }

    /// The surface and its trims run backwards in u, which reverses the normals; the domain stays
    /// (see [`KnotVector::reversed`](super::KnotVector::reversed)).
    #[must_use]
    pub fn reversed_u(&self) -> Self {
        let surface = self.surface.reversed_u();
        let [(start, end), _] = surface.domain(); // a new one if knots are very close together
        let trims = Arc::new(self.trims.reversed_u([start, end]));
        Self { surface, trims }
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

impl Charts for TrimmedSurface {
    fn charts(&self) -> Vec<Chart<'_>> {
        vec![Chart { trims: Some(Arc::clone(&self.trims)), ..Chart::whole(&self.surface) }]
    }
}

/// The tolerance of the control points of a seam, in units of the rounding error of a point.
const SEAM: f64 = 4.0;

impl NurbsSurface {
    /// Whether the surface closes on itself in a direction: the curves at both ends of the
    /// domain have the same control points and, up to one common factor, the same weights, to
    /// within `16 (p + q + 4) u` of the largest coordinate, and are not single points.
    pub fn closes(&self, direction: Direction) -> bool {
        let clamped = self.clamped();
        let (nu, nv) = clamped.size();
        let pairs: Vec<[(usize, usize); 2]> = match direction {
            Direction::U => (0..nv).map(|j| [(0, j), (nu - 1, j)]).collect(),
            Direction::V => (0..nu).map(|i| [(i, 0), (i, nv - 1)]).collect(),
        };
        let [p, q] = [clamped.knots_u().degree(), clamped.knots_v().degree()];
        let factor = SEAM * crate::math::rounding::residual_factor(p, q);
        let point = |(i, j)| clamped.point(i, j);
        let magnitude =
            pairs.iter().flatten().map(|&at| point(at).abs().max_element()).fold(0.0, f64::max);
        let tolerance = factor * magnitude;
        let ratio =
            |[a, b]: [(usize, usize); 2]| clamped.weight(b.0, b.1) / clamped.weight(a.0, a.1);
        let same = |pair: &[(usize, usize); 2]| {
            (point(pair[0]) - point(pair[1])).abs().max_element() <= tolerance
                && (ratio(*pair) / ratio(pairs[0]) - 1.0).abs() <= factor
        };
        let first = point(pairs[0][0]);
        let extended =
            pairs.iter().any(|pair| (point(pair[0]) - first).abs().max_element() > tolerance);
        extended && pairs.iter().all(same)
    }
}
