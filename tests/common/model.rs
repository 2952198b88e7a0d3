//! Surfaces to trace.

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::trim::Side;
use nurbray::geometry::{Charts, NurbsSurface, Surface};
use nurbray::intersect::SurfaceBvh;

/// Surfaces, and what is known of them.
pub(crate) struct Model {
    pub(crate) name: String,
    pub(crate) surfaces: Vec<Surface>,
    /// Whether they enclose a volume, with all normals pointing out of it.
    pub(crate) closed: bool,
}

impl Model {
    pub(crate) fn new(name: impl Into<String>, surface: impl Into<Surface>) -> Self {
        Self { name: name.into(), surfaces: vec![surface.into()], closed: false }
    }

    pub(crate) fn closed(name: impl Into<String>, surface: impl Into<Surface>) -> Self {
        Self { closed: true, ..Self::new(name, surface) }
    }

    pub(crate) fn bvh(&self) -> SurfaceBvh {
        SurfaceBvh::build(&self.surfaces).unwrap()
    }

    /// Whether trims surely keep a place on a surface.
    pub(crate) fn keeps(&self, surface: usize, uv: DVec2) -> bool {
        let trimmed = self.surfaces[surface].trimmed();
        trimmed.is_none_or(|trimmed| trimmed.trims().side_of(uv) == Side::Inside)
    }

    /// The same model, scaled about the origin, then moved.
    pub(crate) fn placed(&self, scale: f64, shift: DVec3) -> Self {
        let map = DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(scale));
        let surfaces = self.surfaces.iter().map(|surface| surface.transformed(&map).unwrap());
        let name = format!("{} × {scale:e} + {:e}", self.name, shift.x);
        Self { name, surfaces: surfaces.collect(), closed: self.closed }
    }

    /// The smallest and largest coordinates of the control points.
    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        let empty = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        let bounds = self.surfaces.iter().map(bounds);
        bounds.fold(empty, |(a, b), (low, high)| (a.min(low), b.max(high)))
    }

    pub(crate) fn center(&self) -> DVec3 {
        let (low, high) = self.bounds();
        0.5 * (low + high)
    }

    /// The radius of a sphere around the bounding box.
    pub(crate) fn radius(&self) -> f64 {
        let (low, high) = self.bounds();
        0.5 * (high - low).length()
    }
}

/// The smallest and largest coordinates of a surface's control points.
pub(crate) fn bounds(surface: &Surface) -> (DVec3, DVec3) {
    let charts = surface.charts();
    let points = charts.iter().flat_map(|chart| chart.surface.control());
    points
        .map(|c| c.truncate() / c.w)
        .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)))
}

/// The NURBS surface a model is.
pub(crate) fn nurbs(surface: &Surface) -> &NurbsSurface {
    surface.nurbs().unwrap()
}
