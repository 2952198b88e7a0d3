//! Names of files, and suggestions for a path that leads nowhere.

use std::fs;
use std::path::{Path, PathBuf};

use crate::scene::nearest;

/// The most entries of a folder that are compared with a missing file's name.
const MAX_LISTED: usize = 1000;

/// Returns a file with a similar name in the same folder, as a suggestion for a missing file. It
/// has one of the `endings` (in lower case), those of files that can be read instead.
///
/// Names are compared without their endings, which all would have in common.
pub(super) fn nearest_file(path: &Path, endings: &[&str]) -> Option<PathBuf> {
    let folder = match path.parent()? {
        empty if empty.as_os_str().is_empty() => Path::new("."),
        folder => folder,
    };
    let wanted = path.file_stem()?.to_string_lossy().into_owned();
    let entries = fs::read_dir(folder).ok()?.take(MAX_LISTED).flatten();
    let mut names: Vec<PathBuf> = entries.map(|entry| entry.file_name().into()).collect();
    names.retain(|name| {
        let ending = name.extension().map(|ending| ending.to_string_lossy().to_lowercase());
        ending.is_some_and(|ending| endings.contains(&ending.as_str()))
            && Some(name.as_os_str()) != path.file_name() // it exists, but is of no use
    });
    // Folders are not listed in the same order everywhere. Of equal stems, one with the wanted
    // ending comes first.
    names.sort_by_key(|name| (name.extension() != path.extension(), name.clone()));
    let stem = |name: &PathBuf| name.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let stems: Vec<String> = names.iter().filter_map(stem).collect();
    let known: Vec<&str> = stems.iter().map(String::as_str).collect();
    let meant = nearest(&wanted, &known)?;
    let name = names.iter().find(|name| stem(name).as_deref() == Some(meant))?;
    Some(path.with_file_name(name))
}

/// The name of a file without its folder and ending, on one line.
pub(super) fn stem(path: &Path) -> String {
    let name = path.file_stem().map(|stem| stem.to_string_lossy());
    name.map_or_else(|| "model".to_owned(), |name| name.replace(char::is_control, "\u{fffd}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_near_is_a_name_and_not_its_ending() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["mine.toml", "mine.exr", "ball.json", "ball.TOML", "rays.npy"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        let near = |name: &str, endings: &[&str]| {
            let found = nearest_file(&folder.path().join(name), endings)?;
            Some(found.file_name().unwrap().to_string_lossy().into_owned())
        };
        let scenes = ["toml", "json", "obj"];
        for (name, meant) in [
            ("mien.toml", Some("mine.toml")),
            ("mine", Some("mine.toml")), // the EXR cannot be what was meant
            ("mine.json", Some("mine.toml")),
            ("mine.toml", None),
            ("bal.json", Some("ball.json")),
            ("bal.TOML", Some("ball.TOML")),
            ("nope.toml", None),
            ("rayz.toml", None),
        ] {
            assert_eq!(near(name, &scenes).as_deref(), meant, "{name}");
        }
        assert_eq!(near("ray.npy", &["npy"]).as_deref(), Some("rays.npy"));
        assert_eq!(near("none/ray.npy", &["npy"]), None);
    }
}
