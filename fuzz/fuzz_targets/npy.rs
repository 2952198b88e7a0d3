//! Ray files: whatever the bytes, rays or an error, in memory bounded by the file's length.
#![no_main]

use libfuzzer_sys::fuzz_target;
use nurbray_fuzz::with_file;

fuzz_target!(|data: &[u8]| {
    with_file("npy", data, |path| match nurbray::io::read_rays(path) {
        Ok(rays) => assert!(rays.len() <= data.len()),
        Err(error) => assert!(!error.to_string().is_empty()),
    });
});
