//! Cages in OBJ files: whatever the text, a cage or an error that says where.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nurbray::io::read_obj_cage;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match read_obj_cage(text, "fuzz.obj") {
        // One step of refinement exercises all of the connections. Large cages would only take
        // time.
        Ok(model) if data.len() < 1 << 12 => drop(model.cage.refined_catmull_clark()),
        Ok(_) => {}
        Err(error) => assert!(error.to_string().starts_with("fuzz.obj")),
    }
});
