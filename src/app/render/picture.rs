//! The pictures to write, by their extensions.

use std::path::{Path, PathBuf};

use super::super::failure::Failure;
use super::super::output;

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
    /// The file.
    pub(super) path: &'a Path,
    /// Its format.
    pub(super) format: Format,
}

/// Finds the formats by the extensions, in upper or lower case.
///
/// # Errors
/// When an extension is missing or not that of a format that is written: wrong use.
pub(super) fn pictures(outputs: &[PathBuf]) -> Result<Vec<Picture<'_>>, Failure> {
    let picture = |path| {
        let format = match output::format(path, &["exr", "png"])? {
            "exr" => Format::Exr,
            _ => Format::Png,
        };
        Ok(Picture { path, format })
    };
    outputs.iter().map(PathBuf::as_path).map(picture).collect()
}

/// Whether all pictures are of one format.
pub(super) fn all(pictures: &[Picture<'_>], format: Format) -> bool {
    pictures.iter().all(|picture| picture.format == format)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_output_has_its_format() {
        let paths = ["a.exr", "b/c.PNG"].map(PathBuf::from);
        let found = pictures(&paths).unwrap();
        assert_eq!([found[0].format, found[1].format], [Format::Exr, Format::Png]);
        assert!(!all(&found, Format::Exr) && all(&found[..1], Format::Exr));
        let paths = ["a.exr", "b.jpg"].map(PathBuf::from);
        let message = pictures(&paths).unwrap_err().reason().to_string();
        assert_eq!(message, "b.jpg: cannot write .jpg files; known are .exr and .png");
    }
}
