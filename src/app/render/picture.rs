//! The pictures to write, by their extensions.

use std::path::{Path, PathBuf};

use super::super::failure::Failure;

/// A kind of picture file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    /// OpenEXR.
    Exr,
    /// PNG.
    Png,
}

/// A picture to write.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Picture<'a> {
    /// Where.
    pub(super) path: &'a Path,
    /// How.
    pub(super) format: Format,
}

/// Tells the formats by the extensions, in upper or lower case.
///
/// # Errors
/// When an extension is missing or none of a format that is written: wrong use.
pub(super) fn pictures(outputs: &[PathBuf]) -> Result<Vec<Picture<'_>>, Failure> {
    let picture = |path: &'_ PathBuf| {
        let extension = path.extension().map(|extension| extension.to_ascii_lowercase());
        let format = match extension.as_ref().and_then(|extension| extension.to_str()) {
            Some("exr") => Some(Format::Exr),
            Some("png") => Some(Format::Png),
            _ => None,
        };
        format.ok_or_else(|| {
            let found = match &extension {
                Some(extension) => format!("cannot write .{} files", extension.display()),
                None => "no extension says how to write it".into(),
            };
            Failure::input(format!("{}: {found}; known are .exr and .png", path.display()))
        })
    };
    let mut pictures = Vec::new();
    for path in outputs {
        pictures.push(Picture { path, format: picture(path)? });
    }
    Ok(pictures)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extensions_say_how() {
        let paths = ["a.exr", "b/c.PNG"].map(PathBuf::from);
        let formats: Vec<Format> = pictures(&paths).unwrap().iter().map(|p| p.format).collect();
        assert_eq!(formats, [Format::Exr, Format::Png]);
    }

    #[test]
    fn unknown_extensions_are_refused_with_the_known_ones() {
        let message =
            |path: &str| pictures(&[PathBuf::from(path)]).unwrap_err().reason().to_string();
        assert_eq!(message("a.jpg"), "a.jpg: cannot write .jpg files; known are .exr and .png");
        assert_eq!(message("a"), "a: no extension says how to write it; known are .exr and .png");
    }
}
