//! Surfaces of other kinds than NURBS: triangles, and limit surfaces of cages.

use glam::{DAffine3, DVec3};
use nurbray::geometry::{BoundaryRule, Cage, CageParts, Corner, Crease, Surface, shapes};
use std::f64::consts::{FRAC_PI_2, PI};

/// The eight quartic octants of a unit sphere around the origin.
pub(crate) fn octants() -> Vec<Surface> {
    let octant = Surface::from(shapes::octant_quartic(1.0).unwrap());
    let quarter = |k: u32| DAffine3::from_rotation_z(FRAC_PI_2 * f64::from(k));
    let lower = DAffine3::from_rotation_x(PI);
    // Turns by right angles, whose cosines are rounded to exact zeros.
    let exact = |map: DAffine3| {
        let matrix = map.matrix3.to_cols_array().map(f64::round);
        DAffine3::from_mat3(glam::DMat3::from_cols_array(&matrix))
    };
    (0..8)
        .map(|k| if k < 4 { quarter(k) } else { quarter(k) * lower })
        .map(|map| octant.transformed(&exact(map)).unwrap())
        .collect()
}

/// A closed body of quads, triangles and a pentagon: two boxes that meet in an L, with a roof.
pub(crate) fn body() -> CageParts {
    let foot = [[0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]].map(|at| at.map(f64::from));
    let mut positions = Vec::new();
    for height in [0.0, 1.0] {
        positions.extend(foot.map(|[x, y]| DVec3::new(x, y, height + 0.1 * x * y)));
    }
    positions.push(DVec3::new(0.5, 0.5, 1.8));
    // The floor as a hexagon; walls; a roof of triangles over one half.
    let mut faces = vec![vec![5, 4, 3, 2, 1, 0]];
    faces.extend((0..6).map(|k| vec![k, (k + 1) % 6, 6 + (k + 1) % 6, 6 + k]));
    faces.extend((0..6).map(|k| vec![6 + k, 6 + (k + 1) % 6, 12]));
    CageParts { positions, faces, ..CageParts::default() }
}

/// A sheet with bumps, a hole, creases of several kinds and a sharp vertex.
fn sheet() -> CageParts {
    let at = |k: usize| {
        let (x, y) = ((k / 6) as f64, (k % 6) as f64);
        DVec3::new(x, y, 0.6 * (1.9 * x + 0.7 * y).sin() * (1.3 * y - 0.4 * x).cos())
    };
    let face = |k: usize| {
        let (i, j) = (k / 5, k % 5);
        vec![6 * i + j, 6 * i + 6 + j, 6 * i + 7 + j, 6 * i + 1 + j]
    };
    let mut faces: Vec<Vec<usize>> = (0..25).map(face).collect();
    faces.remove(12);
    let crease = |a, b, sharpness| Crease { vertices: [a, b], sharpness };
    CageParts {
        positions: (0..36).map(at).collect(),
        faces,
        creases: vec![
            crease(7, 8, f64::INFINITY),
            crease(8, 9, f64::INFINITY),
            crease(9, 10, 2.5),
            crease(25, 19, 1.5),
            crease(25, 26, 3.0),
        ],
        corners: vec![Corner { vertex: 28, sharpness: 1.2 }],
        boundary: BoundaryRule::EdgeAndCorner,
    }
}

/// The tolerance of limit surfaces, as a share of the size; gaps of that order could not go unseen.
const TOLERANCE: f64 = 1e-3;

/// The Catmull–Clark surface of the closed body.
pub(crate) fn catmull_clark() -> Surface {
    Cage::new(body()).unwrap().catmull_clark(TOLERANCE).unwrap().into()
}

/// The same with some edges creased, with infinite or finite sharpness.
pub(crate) fn creased() -> Surface {
    let sharp = |k: usize, sharpness| Crease { vertices: [k, (k + 1) % 6], sharpness };
    let mut creases: Vec<Crease> = (0..6).map(|k| sharp(k, f64::INFINITY)).collect();
    creases.push(Crease { vertices: [7, 12], sharpness: 1.5 });
    Cage::new(CageParts { creases, ..body() }).unwrap().catmull_clark(TOLERANCE).unwrap().into()
}

/// The Doo–Sabin surface of the closed body.
pub(crate) fn doo_sabin() -> Surface {
    Cage::new(body()).unwrap().doo_sabin(TOLERANCE).unwrap().into()
}

/// The Catmull–Clark surface of the sheet.
pub(crate) fn creased_sheet() -> Surface {
    Cage::new(sheet()).unwrap().catmull_clark(TOLERANCE).unwrap().into()
}
