//! TOML scenes: whatever the text, a scene or an error that says where.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nurbray::io::{Model, read_scene};
use nurbray_fuzz::look_at;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    // No files: models have a target of their own.
    match read_scene(text, "fuzz.toml", &mut |_, _, _| Ok(Model::default())) {
        Ok(scene) => look_at(&scene),
        Err(error) => assert!(error.to_string().starts_with("fuzz.toml")),
    }
});
