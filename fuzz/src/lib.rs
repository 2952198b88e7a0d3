//! Functions that the fuzz targets share.

use nurbray::intersect::{Coherence, Kernel, Query, Tracer};
use nurbray::math::Ray;
use nurbray::scene::{Scene, World};

/// Makes a world of a scene and traces a few of its pixels in several ways: a scene that was read
/// without an error must trace without a panic.
pub fn look_at(scene: &Scene) {
    let world = match World::new(scene) {
        Ok(world) => world,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let places = [[0.5, 0.5], [0.3, 0.6], [0.8, 0.1]];
    let rays = places.map(|film| world.camera().ray(film.into(), 1.0));
    for kernel in [Kernel::Scalar, Kernel::default()] {
        let mut tracer = world.bvh().tracer_with(kernel);
        let mut batch = Vec::new();
        for coherence in [Coherence::Coherent, Coherence::Incoherent] {
            tracer.first_hits(&rays, coherence, &mut batch);
            assert_eq!(batch.len(), rays.len());
        }
        rays.iter().for_each(|ray| look_along(ray, &mut tracer, world.surfaces().len()));
    }
}

/// Asks for the first hit of a ray, all its hits, and the occlusion of a ray that leaves the first.
fn look_along(ray: &Ray, tracer: &mut Tracer<'_>, surfaces: usize) {
    let mut hits = Vec::new();
    let _ = tracer.all_hits(ray, &mut hits);
    assert!(hits.iter().all(|hit| (hit.surface as usize) < surfaces));
    let Some(hit) = tracer.first_hit(ray).hit else { return };
    assert!(hit.t > 0.0 && hit.point.is_finite());
    assert!((hit.surface as usize) < surfaces);
    if let Ok(onwards) = Ray::new(hit.point, ray.direction()) {
        let _ = tracer.occluded(&Query::leaving(onwards, &hit));
    }
}
