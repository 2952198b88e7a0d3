//! An SVG picture as a PNG, with a font of its own: no font of the system is looked for.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;

use anyhow::{Context, Error, anyhow};
use nurbray::io::{StagedFile, stage_png_bytes};
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::{Group, Node, Options, Tree, fontdb::Database};

use super::super::console;

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
    let mut missing = BTreeSet::new();
    add_missing(tree.root(), &mut missing);
    if !missing.is_empty() {
        let listed: Vec<String> = missing.iter().map(|text| format!("\"{text}\"")).collect();
        console::warning(&format!(
            "{}: the built-in font has no {}; an SVG file is shown in the viewer's own fonts",
            path.display(),
            listed.join(", ")
        ));
    }
    let mut picture = Pixmap::new(width, height)
        .ok_or_else(|| anyhow!("cannot draw {width}x{height} pixels: there is no room for them"))?;
    resvg::render(&tree, Transform::identity(), &mut picture.as_mut());
    // The picture begins with a white rectangle: every pixel is opaque.
    let opaque = picture.data().chunks_exact(4).flat_map(|pixel| &pixel[..3]).copied();
    Ok(stage_png_bytes(path, [width, height], &opaque.collect::<Vec<u8>>())?)
}

/// Adds the characters for which the font has no letter, and shows a box.
fn add_missing(group: &Group, missing: &mut BTreeSet<String>) {
    for node in group.children() {
        match node {
            Node::Group(group) => add_missing(group, missing),
            Node::Text(text) => {
                let glyphs = text.layouted().iter().flat_map(|span| &span.positioned_glyphs);
                let unknown = glyphs.filter(|glyph| glyph.id.0 == 0);
                missing.extend(unknown.map(|glyph| glyph.text.clone()));
            }
            _ => {}
        }
    }
}
