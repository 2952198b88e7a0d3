//! The patches printed in the documents this project started from: three bicubic Bézier
//! patches of a lecture, and the 4 × 4 net of a course deck.
//!
//! `u` runs over the rows of the nets as printed, `v` along the columns, both in `[0, 1]`.

use glam::DVec3;

use super::quadrics::unit_knots;
use crate::geometry::NurbsSurface;

/// The points of a 4 × 4 net, row by row.
type Net = [[(f64, f64, f64); 4]; 4];

fn bicubic(net: &Net) -> NurbsSurface {
    let control = net.as_flattened().iter().map(|&(x, y, z)| DVec3::new(x, y, z).extend(1.0));
    NurbsSurface::assembled([unit_knots(3), unit_knots(3)], control.collect())
}

/// The lecture's first patch: a graph over the square `[0, 3]²`, as `x = 3v` and `y = 3u`,
/// so that each vertical line over it meets it exactly once. Its normals point down.
pub fn lecture_patch_1() -> NurbsSurface {
    let heights =
        [[5.0, 6.0, 3.0, 5.0], [3.0, 5.0, 6.0, 3.0], [4.0, 3.0, 5.0, 6.0], [5.0, 4.0, 3.0, 5.0]];
    let mut net: Net = [[(0.0, 0.0, 0.0); 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            net[i][j] = (j as f64, i as f64, heights[i][j]);
        }
    }
    bicubic(&net)
}

/// The lecture's second patch: a hood whose rim bulges.
pub fn lecture_patch_2() -> NurbsSurface {
    bicubic(&[
        [(2.0, 2.0, 0.0), (1.0, 1.0, 1.0), (4.0, 1.0, 1.0), (3.0, 2.0, 0.0)],
        [(2.0, 2.0, 1.0), (1.0, 1.0, 2.0), (4.0, 1.0, 2.0), (3.0, 2.0, 1.0)],
        [(2.0, 3.0, 1.0), (1.0, 4.0, 2.0), (4.0, 4.0, 2.0), (3.0, 3.0, 1.0)],
        [(2.0, 3.0, 0.0), (1.0, 4.0, 1.0), (4.0, 4.0, 1.0), (3.0, 3.0, 0.0)],
    ])
}

/// The lecture's third patch: the second with its four corners drawn into one point.
pub fn lecture_patch_3() -> NurbsSurface {
    bicubic(&[
        [(2.5, 2.5, 0.0), (1.0, 1.0, 1.0), (4.0, 1.0, 1.0), (2.5, 2.5, 0.0)],
        [(2.0, 2.0, 1.0), (1.0, 1.0, 2.0), (4.0, 1.0, 2.0), (3.0, 2.0, 1.0)],
        [(2.0, 3.0, 1.0), (1.0, 4.0, 2.0), (4.0, 4.0, 2.0), (3.0, 3.0, 1.0)],
        [(2.5, 2.5, 0.0), (1.0, 4.0, 1.0), (4.0, 4.0, 1.0), (2.5, 2.5, 0.0)],
    ])
}

/// The course deck's OpenGL net: a graph over the square `[−1.5, 1.5]²`, as
/// `x = 3v − 1.5` and `y = 3u − 1.5`. Its normals point down.
pub fn deck_patch() -> NurbsSurface {
    let heights = [
        [4.0, 2.0, -1.0, 2.0],
        [1.0, 3.0, 0.0, -1.0],
        [4.0, 0.0, 3.0, 4.0],
        [-2.0, -2.0, 0.0, -1.0],
    ];
    let mut net: Net = [[(0.0, 0.0, 0.0); 4]; 4];
    for i in 0..4 {
        for j in 0..4 {
            net[i][j] = (j as f64 - 1.5, i as f64 - 1.5, heights[i][j]);
        }
    }
    bicubic(&net)
}
