//! PNG pictures: what the film looks like on a screen.

use std::fmt;
use std::io::{self, Write};
use std::path::Path;

use image::codecs::png::{CompressionType, FilterType, PngEncoder};
use image::{ExtendedColorType, ImageEncoder, ImageError};

use super::{StagedFile, WriteError, stage};
use crate::render::{AovSet, Channel, Film};

/// What a PNG left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PngWarning {
    /// Data of the film that a PNG cannot hold.
    pub left_out: AovSet,
}

impl fmt::Display for PngWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a PNG holds colour only: {} left out (an .exr file holds them)", self.left_out)
    }
}

/// Writes the film's colour as an 8-bit PNG: radiance times `2^exposure`, clipped to
/// `[0, 1]`, with the sRGB transfer function (IEC 61966-2-1).
///
/// The same film gives the same bytes: there is no time in the file and no dithering.
/// The picture is opaque, as the film's colour holds the background. A cropped film gives
/// the pixels of the crop only. Values that are not numbers are black.
///
/// Returns what was left out if the film holds more than colour.
///
/// # Errors
/// When the file cannot be written; an older one then stays as it was.
pub fn write_png(
    path: &Path,
    film: &Film,
    exposure: f64,
) -> Result<Option<PngWarning>, WriteError> {
    stage_png(path, film, exposure)?.put_in_place()?;
    Ok(warning(film))
}

/// Writes the PNG that [`write_png`] writes, byte for byte, to memory, a socket or the like.
///
/// ```
/// use nurbray::io::write_png_to;
/// use nurbray::render::{Film, RenderSettings};
///
/// let film = Film::new(&RenderSettings { size: [2, 2], ..Default::default() })?;
/// let mut bytes = Vec::new();
/// write_png_to(&mut bytes, &film, 0.0)?;
/// assert!(bytes.starts_with(b"\x89PNG"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// When the writer fails; part of the picture may then be written.
pub fn write_png_to(
    writer: impl Write,
    film: &Film,
    exposure: f64,
) -> io::Result<Option<PngWarning>> {
    write_png_bytes_to(writer, size(film), &screen_bytes(film, exposure))?;
    Ok(warning(film))
}

/// What a PNG of this film leaves out.
fn warning(film: &Film) -> Option<PngWarning> {
    let left_out = film.settings().aovs;
    (!left_out.is_empty()).then_some(PngWarning { left_out })
}

/// The width and the height of the film's picture.
fn size(film: &Film) -> [u32; 2] {
    [film.window().width(), film.window().height()]
}

/// Writes a PNG as [`write_png`] does, but does not put the file in its place yet.
///
/// # Errors
/// When the file cannot be written.
pub fn stage_png(path: &Path, film: &Film, exposure: f64) -> Result<StagedFile, WriteError> {
    stage_png_bytes(path, size(film), &screen_bytes(film, exposure))
}

/// Writes a picture of `[width, height]` pixels, given as red, green and blue bytes row by
/// row from the top, as a PNG. The same pixels give the same bytes.
///
/// # Errors
/// When there are not three bytes a pixel, or the file cannot be written; an older one then
/// stays as it was.
pub fn write_png_bytes(path: &Path, size: [u32; 2], bytes: &[u8]) -> Result<(), WriteError> {
    stage_png_bytes(path, size, bytes)?.put_in_place()
}

/// Writes a PNG as [`write_png_bytes`] does, but does not put the file in its place yet.
///
/// # Errors
/// When there are not three bytes a pixel, or the file cannot be written.
pub fn stage_png_bytes(
    path: &Path,
    size: [u32; 2],
    bytes: &[u8],
) -> Result<StagedFile, WriteError> {
    stage(path, |file| write_png_bytes_to(file, size, bytes))
}

/// Writes the PNG that [`write_png_bytes`] writes, byte for byte, to memory, a socket or the like.
///
/// # Errors
/// When there are not three bytes a pixel, or the writer fails; part of the picture may then be
/// written.
pub fn write_png_bytes_to(
    mut writer: impl Write,
    [width, height]: [u32; 2],
    bytes: &[u8],
) -> io::Result<()> {
    let needed = 3 * u128::from(width) * u128::from(height);
    if bytes.len() as u128 != needed {
        return Err(io::Error::other(format!(
            "{} bytes, but {width}x{height} pixels need {needed}",
            bytes.len()
        )));
    }
    PngEncoder::new_with_quality(&mut writer, CompressionType::Default, FilterType::Adaptive)
        .write_image(bytes, width, height, ExtendedColorType::Rgb8)
        .map_err(|error| match error {
            ImageError::IoError(error) => error,
            other => io::Error::other(other),
        })?;
    writer.flush()
}

/// Red, green and blue of each pixel as sRGB bytes.
fn screen_bytes(film: &Film, exposure: f64) -> Vec<u8> {
    let gain = exposure.exp2();
    let mut bytes = vec![0; film.window().area() as usize * 3];
    for (color, channel) in [Channel::R, Channel::G, Channel::B].into_iter().enumerate() {
        let plane = film.plane(channel).unwrap_or_default();
        for (pixel, value) in bytes.chunks_exact_mut(3).zip(plane) {
            pixel[color] = srgb_byte(f64::from(value) * gain);
        }
    }
    bytes
}

/// The nearest byte to a linear value's sRGB code; NaN is black.
fn srgb_byte(linear: f64) -> u8 {
    // The standard's linear toe ends at 0.0031308, where both parts are 0.04045.
    let code =
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 };
    (code * 255.0).round() as u8 // saturates; NaN becomes 0
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::render::{PixelRect, RenderSettings};

    #[test]
    fn codes_of_the_standard() {
        // Linear values of the codes 0, 10, 11, 128, 188, 255, from the inverse formula.
        let decode = |code: u8| {
            let c = f64::from(code) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        for code in 0..=255 {
            assert_eq!(srgb_byte(decode(code)), code);
        }
        assert_eq!(srgb_byte(0.5), 188);
        assert_eq!([srgb_byte(-1.0), srgb_byte(f64::NAN), srgb_byte(f64::INFINITY)], [0, 0, 255]);
    }

    #[test]
    fn the_same_film_gives_the_same_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let crop = PixelRect::new([2, 1], [7, 5]).unwrap();
        let settings = RenderSettings {
            size: [9, 6],
            crop: Some(crop),
            aovs: "Z,id".parse().unwrap(),
            ..RenderSettings::default()
        };
        let film = Film::new(&settings).unwrap();
        let (a, b) = (folder.path().join("a.png"), folder.path().join("b.png"));
        let warning = write_png(&a, &film, 0.0).unwrap().unwrap();
        assert_eq!(
            warning.to_string(),
            "a PNG holds colour only: Z,id left out (an .exr file holds them)"
        );
        write_png(&b, &film, 0.0).unwrap();
        assert_eq!(fs::read(&a).unwrap(), fs::read(&b).unwrap());
        let mut memory = Vec::new();
        assert_eq!(write_png_to(&mut memory, &film, 0.0).unwrap(), Some(warning));
        assert_eq!(memory, fs::read(&a).unwrap());
        let picture = image::open(&a).unwrap();
        assert_eq!((picture.width(), picture.height()), (5, 4));
        // Signature, header, data, end: no chunk that could hold a time.
        let bytes = fs::read(&a).unwrap();
        assert!(!bytes.windows(4).any(|chunk| chunk == b"tIME" || chunk == b"tEXt"));
    }

    #[test]
    fn a_film_without_data_gives_no_warning() {
        let folder = tempfile::tempdir().unwrap();
        let settings = RenderSettings { size: [2, 2], ..RenderSettings::default() };
        let film = Film::new(&settings).unwrap();
        assert_eq!(write_png(&folder.path().join("a.png"), &film, 0.0).unwrap(), None);
        assert!(write_png(folder.path(), &film, 0.0).is_err());
    }

    #[test]
    fn bytes_are_written_as_they_are() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.png");
        write_png_bytes(&path, [2, 1], &[1, 2, 3, 250, 0, 7]).unwrap();
        let picture = image::open(&path).unwrap().into_rgb8();
        assert_eq!(
            (picture.dimensions(), picture.as_raw().as_slice()),
            ((2, 1), &[1, 2, 3, 250, 0, 7][..])
        );
        let error = write_png_bytes(&path, [2, 2], &[0; 6]).unwrap_err().to_string();
        assert!(error.ends_with("6 bytes, but 2x2 pixels need 12"), "{error}");
        assert_eq!(image::open(&path).unwrap().width(), 2);
    }

    #[test]
    fn writers_that_fail_are_errors() {
        let film = Film::new(&RenderSettings { size: [2, 2], ..Default::default() }).unwrap();
        let mut room = [0_u8; 20]; // the signature and a part of the header
        assert!(write_png_to(&mut room[..], &film, 0.0).is_err());
    }
}
