//! Surfaces to trace.

use std::sync::Arc;

use glam::{DAffine3, DVec2, DVec3};
use nurbray::geometry::trim::{Side, Trims};
use nurbray::geometry::{NurbsSurface, Surface, TrimmedSurface};
use nurbray::intersect::{BuildOptions, SurfaceBvh};

/// Surfaces, and what is known of them.
pub(crate) struct Model {
    pub(crate) name: String,
    pub(crate) surfaces: Vec<NurbsSurface>,
    /// Which part of the first surface is there, if not all of it.
    pub(crate) trims: Option<Arc<Trims>>,
    /// Whether they enclose a volume, with all normals pointing out of it.
    pub(crate) closed: bool,
}

impl Model {
    pub(crate) fn new(name: impl Into<String>, surface: NurbsSurface) -> Self {
        Self { name: name.into(), surfaces: vec![surface], trims: None, closed: false }
    }

    pub(crate) fn closed(name: impl Into<String>, surface: NurbsSurface) -> Self {
        Self { closed: true, ..Self::new(name, surface) }
    }

    pub(crate) fn bvh(&self) -> SurfaceBvh {
        let mut surfaces: Vec<Surface> = self.surfaces.iter().cloned().map(Into::into).collect();
        if let Some(trims) = &self.trims {
            let cut = TrimmedSurface::new(self.surfaces[0].clone(), Arc::clone(trims));
            surfaces[0] = cut.unwrap().into();
        }
        SurfaceBvh::build(&surfaces, &BuildOptions::default()).unwrap()
    }

    /// Whether a place on a surface is surely there.
    pub(crate) fn keeps(&self, surface: usize, uv: DVec2) -> bool {
        let trims = self.trims.as_ref().filter(|_| surface == 0);
        trims.is_none_or(|trims| trims.contains(uv) == Side::Inside)
    }

    /// The same model, scaled about the origin, then moved.
    pub(crate) fn placed(&self, scale: f64, shift: DVec3) -> Self {
        let map = DAffine3::from_translation(shift) * DAffine3::from_scale(DVec3::splat(scale));
        let surfaces = self.surfaces.iter().map(|surface| surface.transformed(&map).unwrap());
        let name = format!("{} × {scale:e} + {:e}", self.name, shift.x);
        let surfaces = surfaces.collect();
        Self { name, surfaces, trims: self.trims.clone(), closed: self.closed }
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
