//! What a path may have meant that leads nowhere.

use std::fs;
use std::path::{Path, PathBuf};

use crate::scene::nearest;

/// The most entries of a folder that are compared with a missing file's name.
const MAX_LISTED: usize = 1000;

/// A file in the same folder with a similar name, for a file that is not there.
pub(super) fn nearest_file(path: &Path) -> Option<PathBuf> {
    let folder = match path.parent()? {
        empty if empty.as_os_str().is_empty() => Path::new("."),
        folder => folder,
    };
    let wanted = path.file_name()?.to_string_lossy().into_owned();
    let entries = fs::read_dir(folder).ok()?.take(MAX_LISTED).flatten();
    let mut names: Vec<_> =
        entries.map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    names.sort(); // the order of a folder is not the same everywhere
    let names: Vec<_> = names.iter().map(String::as_str).collect();
    nearest(&wanted, &names).map(|name| path.with_file_name(name))
}
