//! geomdl JSON models: whatever the text, surfaces or an error that says where.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nurbray::io::read_geomdl;
use nurbray::scene::{Object, Scene};
use nurbray_fuzz::look_at;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match read_geomdl(text, "fuzz.json", "fuzz") {
        Ok(model) => {
            // Every surface takes a byte or more of the text.
            assert!(model.parts.len() <= data.len());
            let object = Object { parts: model.parts, ..Object::default() };
            look_at(&Scene { objects: vec![object], ..Scene::default() });
        }
        Err(error) => assert!(error.to_string().starts_with("fuzz.json")),
    }
});
