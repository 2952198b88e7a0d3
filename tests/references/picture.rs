//! A picture to look at: ours, Embree's, and the difference, side by side.

use std::path::Path;

use image::{Rgb, RgbImage};

use crate::images::{Picture, Seen};
use crate::models::SIZE;

/// Writes `<name>.png` below the target folder: normals as colours on the left and in the
/// middle; on the right the angle between them, with full red, yellow, white at 1°, 2°, 3°,
/// and blue where only one is hit.
pub(crate) fn write(name: &str, ours: &Picture, theirs: &Picture) {
    let [width, height] = SIZE;
    let mut image = RgbImage::new(3 * width as u32, height as u32);
    for (at, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
        let (x, y) = ((at % width) as u32, (at / width) as u32);
        let panels = [normal(ours.as_ref()), normal(theirs.as_ref()), difference(ours, theirs)];
        for (panel, colour) in (0..).zip(panels) {
            image.put_pixel(x + panel * width as u32, y, colour);
        }
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("references");
    std::fs::create_dir_all(&folder).unwrap();
    image.save(folder.join(format!("{name}.png"))).unwrap();
}

fn byte(value: f64) -> u8 {
    (255.0 * value.clamp(0.0, 1.0)).round() as u8
}

fn normal(seen: Option<&Seen>) -> Rgb<u8> {
    let colour = seen.map(|seen| (0.5 * seen.normal + 0.5).to_array().map(byte));
    Rgb(colour.unwrap_or([20, 20, 20]))
}

fn difference(ours: &Option<Seen>, theirs: &Option<Seen>) -> Rgb<u8> {
    match (ours, theirs) {
        (Some(ours), Some(theirs)) => {
            let degrees = ours.normal.angle_between(theirs.normal).to_degrees();
            Rgb([degrees, degrees - 1.0, degrees - 2.0].map(byte))
        }
        (None, None) => Rgb([20, 20, 20]),
        _ => Rgb([40, 90, 255]),
    }
}
