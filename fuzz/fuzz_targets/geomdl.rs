//! geomdl JSON models: whatever the text, surfaces or an error that says where.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nurbray::io::read_geomdl;

fuzz_target!(|data: &[u8]| {
    let Ok(text) = std::str::from_utf8(data) else { return };
    match read_geomdl(text, "fuzz.json") {
        // Every point takes a byte or more of the text.
        Ok(model) => assert!(model.parts.len() <= data.len()),
        Err(error) => assert!(error.to_string().starts_with("fuzz.json")),
    }
});
