//! What the fuzz targets share.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use nurbray::intersect::Query;
use nurbray::scene::{Scene, World};

/// Puts `data` into a file and passes its path on: some readers read files.
///
/// One file a process is enough, as libFuzzer runs one input at a time.
pub fn with_file(extension: &str, data: &[u8], read: impl FnOnce(&Path)) {
    static FOLDER: OnceLock<PathBuf> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let name = format!("nurbray-fuzz-{}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(&folder).expect("a writable temporary folder");
        folder
    });
    let path = folder.join("input").with_extension(extension);
    fs::write(&path, data).expect("a writable temporary folder");
    read(&path);
}

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
