//! TOML scenes, and the step from a scene to a world: whatever the text, either a world or
//! an error that says where.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nurbray::io::{Model, read_scene};
use nurbray::scene::World;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // No files: models have a target of their own.
    match read_scene(text, "fuzz.toml", &mut |_, _| Ok(Model::default())) {
        Ok(scene) => {
            if let Err(error) = World::new(&scene) {
                assert!(!error.to_string().is_empty());
            }
        }
        Err(error) => assert!(error.to_string().starts_with("fuzz.toml")),
    }
});
