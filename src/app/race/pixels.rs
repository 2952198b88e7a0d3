//! The order in which the pixels of a picture are traced.

/// The side of a tile in pixels: a power of 2, for the Z-order curve.
pub(super) const TILE: usize = 64;

/// The pixels `[x, y]` of a picture of `size`, y down.
///
/// Tiles of 64 × 64 pixels, row after row; within a tile along a Z-order curve, so that 16
/// pixels in a row are 4 × 4 and 64 are 8 × 8: coherent packets of every width.
pub(crate) fn tiled_pixels(size: [u32; 2]) -> impl Iterator<Item = [usize; 2]> {
    let [width, height] = size.map(|side| side as usize);
    let [across, down] = [width, height].map(|side| side.div_ceil(TILE));
    let pixels = (0..across * down).flat_map(move |tile| {
        let corner = [tile % across * TILE, tile / across * TILE];
        let within = 0..TILE * TILE;
        within.map(move |code| [corner[0] + even_bits(code), corner[1] + even_bits(code >> 1)])
    });
    pixels.filter(move |&[x, y]| x < width && y < height)
}

/// Bits 0, 2, 4, … of a number below `TILE`², next to one another.
fn even_bits(code: usize) -> usize {
    (0..TILE.ilog2()).map(|bit| (code >> (2 * bit) & 1) << bit).sum()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn every_pixel_comes_once_and_packets_are_squares() {
        for [width, height] in [[1, 1], [100, 70], [64, 129]] {
            let pixels: Vec<_> = tiled_pixels([width, height]).collect();
            assert_eq!(pixels.len(), (width * height) as usize);
            assert_eq!(pixels.iter().collect::<HashSet<_>>().len(), pixels.len());
        }
        let pixels: Vec<_> = tiled_pixels([128, 64]).collect();
        for (packet, side) in [(16, 4), (64, 8)] {
            for square in pixels.chunks(packet) {
                for axis in 0..2 {
                    let along = square.iter().map(|pixel| pixel[axis]);
                    assert_eq!(along.clone().max().unwrap() - along.min().unwrap(), side - 1);
                }
            }
        }
    }
}
