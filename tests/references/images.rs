//! The same view by nurbray and by Embree, and how they differ.

use glam::DVec3;
use nurbray::intersect::{Coherence, Query, SurfaceBvh};
use nurbray::io::mesh::Tessellation;
use nurbray::io::{Embree, EmbreeHit, EmbreePrimitive, PacketWidth};
use nurbray::math::Ray;

use crate::models::Model;

/// What one pixel sees.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Seen {
    /// The distance along the pixel's unit ray.
    pub(crate) depth: f64,
    /// The unit normal.
    pub(crate) normal: DVec3,
    /// Which surface.
    pub(crate) surface: u32,
}

/// A picture: what each pixel sees, if anything.
pub(crate) type Picture = Vec<Option<Seen>>;

/// The picture by nurbray.
pub(crate) fn exact(model: &Model, rays: &[Ray]) -> Picture {
    let bvh = SurfaceBvh::build(&model.surfaces).unwrap();
    let queries: Vec<_> = rays.iter().map(|&ray| Query::primary(ray)).collect();
    let mut answers = Vec::new();
    bvh.tracer().first_hits(&queries, Coherence::Coherent, &mut answers);
    let seen = answers.iter().map(|answer| {
        answer.hit.map(|hit| Seen { depth: hit.t, normal: hit.normal, surface: hit.surface })
    });
    seen.collect()
}

/// The picture by Embree: depths of the triangles, normals interpolated between vertices.
pub(crate) fn meshed(embree: &Embree, tessellation: &Tessellation, rays: &[Ray]) -> Picture {
    let meshes = tessellation.meshes();
    let scene = embree.scene(meshes, EmbreePrimitive::Grid).unwrap();
    let mut batch = scene.rays(rays, PacketWidth::Sixteen, Coherence::Coherent);
    scene.intersect(&mut batch);
    let seen = |hit: EmbreeHit| {
        let normal = hit.on(meshes).unwrap().normal;
        Seen { depth: hit.t, normal, surface: hit.mesh }
    };
    batch.hits().into_iter().map(|hit| hit.map(seen)).collect()
}
