//! What the fuzz targets share.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Puts `data` into a file and passes its path on: the readers read files.
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
