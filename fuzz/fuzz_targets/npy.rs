//! NumPy tables of rays: whatever the bytes, a table or an error, in memory bounded by them.
#![no_main]

use std::path::Path;

use libfuzzer_sys::fuzz_target;
use nurbray::io::table_from_bytes;

fuzz_target!(|data: &[u8]| {
    match table_from_bytes(data, Path::new("fuzz.npy"), &[6, 8]) {
        // The smallest numbers read take four bytes.
        Ok(table) => assert!(table.row_count() * table.columns() <= data.len() / 4),
        Err(error) => assert!(error.to_string().starts_with("fuzz.npy")),
    }
});
