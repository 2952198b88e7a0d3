//! An SVG picture as a PNG, with a font of its own: no font of the system is looked for.

use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Error, anyhow};
use nurbray::io::{StagedFile, stage_png_bytes};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb::Database};

/// Draws the picture and writes it to a file that is not yet put in its place.
///
/// # Errors
/// When there is no memory for it, or the file cannot be written.
pub(super) fn stage(
    path: &Path,
    svg: &str,
    [width, height]: [u32; 2],
) -> Result<StagedFile, Error> {
    let mut fonts = Database::new();
    fonts.load_font_data(dejavu::sans::regular().to_vec());
    fonts.set_sans_serif_family("DejaVu Sans");
    let options = Options { fontdb: Arc::new(fonts), ..Options::default() };
    let tree = Tree::from_str(svg, &options).context("cannot draw")?;
    let mut picture = Pixmap::new(width, height)
        .ok_or_else(|| anyhow!("cannot draw {width}x{height} pixels: there is no room for them"))?;
    resvg::render(&tree, Transform::identity(), &mut picture.as_mut());
    // The picture begins with a white rectangle: every pixel is opaque.
    let opaque = picture.data().chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied();
    Ok(stage_png_bytes(path, (width, height), &opaque.collect::<Vec<u8>>())?)
}
