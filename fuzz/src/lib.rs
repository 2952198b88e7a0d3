//! What the fuzz targets share.

use nurbray::intersect::Query;
use nurbray::scene::{Scene, World};

/// Makes a world of a scene and looks at a few of its pixels: what was read without an error
/// must trace without a panic.
pub fn look_at(scene: &Scene) {
    let world = match World::new(scene) {
        Ok(world) => world,
        Err(error) => return assert!(!error.to_string().is_empty()),
    };
    let mut tracer = world.bvh.tracer();
    for film in [[0.5, 0.5], [0.3, 0.6], [0.8, 0.1]] {
        let ray = world.camera.ray(film.into(), 1.0);
        if let Some(hit) = tracer.first_hit(&Query::primary(ray)).hit {
            assert!(hit.t > 0.0 && hit.point.is_finite());
            assert!((hit.surface as usize) < world.surfaces.len());
        }
    }
}
