//! The picture cut into tiles.

use super::PixelRect;

/// The side of a tile in pixels: small enough that threads finish together, large enough
/// that a batch of a few samples (see [`Painter`](super::painter::Painter)) fills packets
/// of rays.
const SIDE: u32 = 16;

/// A fixed grid of square tiles over the whole picture, of which the tiles that meet the
/// window count. A crop or another number of threads never moves it.
#[derive(Clone, Copy, Debug)]
pub(super) struct TileGrid {
    window: PixelRect,
    /// The column and row of the first tile that counts.
    first: [u32; 2],
    columns: usize,
    rows: usize,
}

impl TileGrid {
    pub(super) fn new(window: PixelRect) -> Self {
        let first = window.min().map(|pixel| pixel / SIDE);
        let end = window.max().map(|pixel| pixel.div_ceil(SIDE));
        let [columns, rows] = [0, 1].map(|axis| (end[axis] - first[axis]) as usize);
        Self { window, first, columns, rows }
    }

    /// How many tiles meet the window.
    pub(super) fn count(&self) -> usize {
        self.columns * self.rows
    }

    /// The pixels of one tile that lie in the window, tiles counted row after row.
    pub(super) fn get(&self, index: usize) -> Option<PixelRect> {
        if index >= self.count() {
            return None;
        }
        let place = [(index % self.columns) as u32, (index / self.columns) as u32];
        let min = [0, 1].map(|axis| (self.first[axis] + place[axis]) * SIDE);
        let tile = PixelRect::new(min, min.map(|pixel| pixel + SIDE)).ok()?;
        tile.intersection(&self.window)
    }
}

/// The pixels of a tile in an order in which neighbours stay together: the Z-order curve,
/// whose every aligned run of 4ᵏ pixels is a square of a whole tile.
pub(super) fn pixels_of(tile: PixelRect) -> impl Iterator<Item = [u32; 2]> {
    let corner = tile.min().map(|pixel| pixel - pixel % SIDE);
    (0..SIDE * SIDE)
        .map(move |code| [corner[0] + even_bits(code), corner[1] + even_bits(code >> 1)])
        .filter(move |&pixel| tile.contains(pixel))
}

/// Bits 0, 2, 4 and 6 of a number as one of 4 bits.
fn even_bits(code: u32) -> u32 {
    (0..4).map(|bit| (code >> (2 * bit) & 1) << bit).sum()
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    fn rect(min: [u32; 2], max: [u32; 2]) -> PixelRect {
        PixelRect::new(min, max).unwrap()
    }

    #[test]
    fn tiles_cover_every_pixel_of_the_window_once() {
        for window in [
            rect([0, 0], [1, 1]),
            rect([0, 0], [64, 48]),
            rect([5, 3], [50, 17]),
            rect([16, 16], [32, 32]),
            rect([65_500, 65_530], [65_536, 65_536]),
        ] {
            let grid = TileGrid::new(window);
            let mut seen = HashSet::new();
            for tile in (0..grid.count()).map(|index| grid.get(index).unwrap()) {
                for pixel in pixels_of(tile) {
                    assert!(window.contains(pixel) && seen.insert(pixel), "{pixel:?}");
                }
            }
            assert_eq!(seen.len() as u64, window.area());
            assert_eq!(grid.get(grid.count()), None);
        }
    }

    #[test]
    fn a_crop_does_not_move_the_grid() {
        let whole = TileGrid::new(rect([0, 0], [100, 100]));
        let crop = rect([20, 30], [61, 90]);
        let grid = TileGrid::new(crop);
        let parts: Vec<_> =
            (0..whole.count()).filter_map(|i| whole.get(i)?.intersection(&crop)).collect();
        assert_eq!((0..grid.count()).map(|i| grid.get(i).unwrap()).collect::<Vec<_>>(), parts);
    }

    #[test]
    fn runs_of_the_curve_are_squares() {
        let pixels: Vec<_> = pixels_of(rect([16, 32], [32, 48])).collect();
        assert_eq!(pixels[..4], [[16, 32], [17, 32], [16, 33], [17, 33]]);
        for run in pixels.chunks(64) {
            let (x, y) = (run[0][0], run[0][1]);
            assert!(run.iter().all(|p| (x..x + 8).contains(&p[0]) && (y..y + 8).contains(&p[1])));
        }
    }
}
