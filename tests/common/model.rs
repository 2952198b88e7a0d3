//! Surfaces to trace.

use glam::{DAffine3, DVec3};
use nurbray::geometry::NurbsSurface;
use nurbray::intersect::{BuildOptions, SurfaceBvh};

/// Surfaces, and what is known of them.
pub(crate) struct Model {
    pub(crate) name: String,
    pub(crate) surfaces: Vec<NurbsSurface>,
    /// Whether they enclose a volume, with all normals pointing out of it.
    pub(crate) closed: bool,
}

impl Model {
    pub(crate) fn new(name: impl Into<String>, surface: NurbsSurface) -> Self {
        Self { name: name.into(), surfaces: vec![surface], closed: false }
    }

    pub(crate) fn closed(name: impl Into<String>, surface: NurbsSurface) -> Self {
        Self { closed: true, ..Self::new(name, surface) }
    }

    pub(crate) fn bvh(&self) -> SurfaceBvh {
        SurfaceBvh::build(&self.surfaces, &BuildOptions::default()).unwrap()
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
        let points = self.surfaces.iter().flat_map(|s| s.control()).map(|c| c.truncate() / c.w);
        points.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)))
    }

    pub(crate) fn center(&self) -> DVec3 {
        let (low, high) = self.bounds();
        0.5 * (low + high)
    }

    /// That of a sphere around the bounding box.
    pub(crate) fn radius(&self) -> f64 {
        let (low, high) = self.bounds();
        0.5 * (high - low).length()
    }
}
