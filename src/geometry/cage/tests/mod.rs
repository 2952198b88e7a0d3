//! Test cages, and references for their limit surfaces.

mod catmull_clark;
mod checks;
mod curves;
mod doo_sabin;
mod limits;
mod seams;

use glam::{DVec2, DVec3};

use super::{BoundaryRule, Cage, CageParts, Corner, Crease, FaceRect, LimitSurface};
use crate::geometry::NurbsSurface;

pub(super) const SHARP: f64 = f64::INFINITY;

/// Pseudo-random numbers from −1 to 1, the same in every run.
pub(super) fn noise(seed: usize) -> f64 {
    let mut x = seed as u64 ^ 0x9e37_79b9_7f4a_7c15;
    for _ in 0..3 {
        x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
        x ^= x >> 31;
    }
    x as f64 / u64::MAX as f64 * 2.0 - 1.0
}

pub(super) fn noisy(seed: usize) -> DVec3 {
    DVec3::new(noise(3 * seed), noise(3 * seed + 1), noise(3 * seed + 2))
}

/// A cube from −1 to 1; vertex k is at the signs of k's bits, x first.
pub(super) fn cube_parts() -> CageParts {
    let sign = |bit: usize| if bit == 0 { -1.0 } else { 1.0 };
    let positions = (0..8).map(|k| DVec3::new(sign(k & 1), sign(k & 2), sign(k & 4))).collect();
    let faces =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let faces = faces.iter().map(|face| face.to_vec()).collect();
    CageParts { positions, faces, ..CageParts::default() }
}

/// A sheet of nu × nv vertices, v fastest, counterclockwise seen from where u × v points.
pub(super) fn sheet_parts(nu: usize, nv: usize, at: impl Fn(usize, usize) -> DVec3) -> CageParts {
    let positions = (0..nu * nv).map(|k| at(k / nv, k % nv)).collect();
    let face = |k: usize| {
        let (i, j) = (k / (nv - 1), k % (nv - 1));
        vec![i * nv + j, (i + 1) * nv + j, (i + 1) * nv + j + 1, i * nv + j + 1]
    };
    let faces = (0..(nu - 1) * (nv - 1)).map(face).collect();
    CageParts { positions, faces, ..CageParts::default() }
}

pub(super) fn bumpy(i: usize, j: usize) -> DVec3 {
    DVec3::new(i as f64, j as f64, 0.0) + 0.3 * noisy(100 * i + j)
}

/// A closed ring of nu × nv quads.
pub(super) fn torus_parts(nu: usize, nv: usize) -> CageParts {
    let angle = |k: usize, n: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let at = |k: usize| {
        let ((sin, cos), (up, out)) = (angle(k / nv, nu).sin_cos(), angle(k % nv, nv).sin_cos());
        DVec3::new((3.0 + out) * cos, (3.0 + out) * sin, up) + 0.1 * noisy(k)
    };
    let vertex = |i: usize, j: usize| (i % nu) * nv + j % nv;
    let face = |k: usize| {
        let (i, j) = (k / nv, k % nv);
        vec![vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1)]
    };
    let faces = (0..nu * nv).map(face).collect();
    CageParts { positions: (0..nu * nv).map(at).collect(), faces, ..CageParts::default() }
}

/// A pyramid of n triangles over an n-gon: vertex 0 is the top.
pub(super) fn pyramid_parts(n: usize) -> CageParts {
    let angle = |k: usize| std::f64::consts::TAU * k as f64 / n as f64;
    let foot = |k: usize| DVec3::new(angle(k).cos(), angle(k).sin(), 0.0);
    let positions = std::iter::once(DVec3::Z).chain((0..n).map(foot)).collect();
    let mut faces: Vec<Vec<usize>> = (0..n).map(|k| vec![0, 1 + k, 1 + (k + 1) % n]).collect();
    faces.push((0..n).rev().map(|k| 1 + k).collect());
    CageParts { positions, faces, ..CageParts::default() }
}

pub(super) fn crease(a: usize, b: usize, sharpness: f64) -> Crease {
    Crease { vertices: [a, b], sharpness }
}

/// Named cages of all kinds.
pub(super) fn zoo() -> Vec<(&'static str, CageParts)> {
    let cube = cube_parts();
    let with = |creases: Vec<Crease>| CageParts { creases, ..cube.clone() };
    let sheet = sheet_parts(4, 3, bumpy);
    let mut hole = sheet_parts(5, 5, bumpy);
    hole.faces.remove(5); // an inner vertex becomes a reentrant corner of the border
    // Along rings of the torus, side by side; ends at the last one, in the middle of a ring.
    let around = |j: usize, count: usize, sharpness: f64| {
        (0..count).map(move |i| crease(4 * i + j, 4 * ((i + 1) % 5) + j, sharpness))
    };
    let rings = CageParts {
        creases: around(0, 5, 2.6).chain(around(1, 5, 1.0)).chain(around(2, 3, 3.0)).collect(),
        ..torus_parts(5, 4)
    };
    // From border to border one way, and not as far the other way.
    let across = |i: usize| crease(5 * i + 2, 5 * (i + 1) + 2, 2.3);
    let along = |j: usize| crease(15 + j, 15 + j + 1, 4.0);
    let seams = CageParts {
        creases: (0..5).map(across).chain((2..4).map(along)).collect(),
        ..sheet_parts(6, 5, bumpy)
    };
    let loose = CageParts { boundary: BoundaryRule::EdgeOnly, ..sheet.clone() };
    vec![
        ("cube", cube.clone()),
        (
            "rim",
            with(vec![
                crease(4, 5, SHARP),
                crease(5, 7, SHARP),
                crease(7, 6, SHARP),
                crease(6, 4, SHARP),
            ]),
        ),
        (
            "semi-sharp",
            with(vec![crease(4, 5, 1.7), crease(5, 7, 2.3), crease(7, 6, 0.4), crease(0, 1, 1.0)]),
        ),
        ("dart", with(vec![crease(0, 1, SHARP)])),
        ("corner", with(vec![crease(0, 1, SHARP), crease(0, 2, SHARP), crease(0, 4, SHARP)])),
        (
            "spike",
            CageParts { corners: vec![Corner { vertex: 7, sharpness: 1.5 }], ..cube.clone() },
        ),
        ("pyramid", pyramid_parts(5)),
        ("tetrahedron", pyramid_parts(3)),
        ("torus", torus_parts(5, 4)),
        ("sheet", sheet),
        ("loose sheet", loose),
        ("hole", hole),
        ("creased rings", rings),
        ("creased sheet", seams),
    ]
}

pub(super) fn cage(parts: &CageParts) -> Cage {
    Cage::new(parts.clone()).unwrap()
}

/// A limit surface that can be evaluated by unit square.
pub(super) struct Probe {
    pub(super) limit: LimitSurface,
    surfaces: Vec<NurbsSurface>,
}

impl Probe {
    pub(super) fn new(limit: LimitSurface) -> Self {
        let surface = |k| limit.surface(k).unwrap().unwrap();
        Self { surfaces: (0..limit.patches().len()).map(surface).collect(), limit }
    }

    /// The patch that covers a place, and the place within it.
    pub(super) fn patch(&self, unit: usize, at: [f64; 2]) -> Option<(usize, f64, f64)> {
        let inside = |s: &FaceRect| {
            let holds = |([low, high], at): ([f64; 2], f64)| low <= at && at <= high;
            s.unit == unit && s.ranges().into_iter().zip(at).all(holds)
        };
        let patch = self.limit.patches().iter().position(|patch| inside(&patch.rect))?;
        let rect = self.limit.patches()[patch].rect;
        let [u, v] = [0, 1].map(|d| (at[d] - rect.low[d]) / rect.size[d]);
        Some((patch, u, v))
    }

    /// A point, and the bound on its distance from the true one.
    pub(super) fn point(&self, unit: usize, at: [f64; 2]) -> Option<(DVec3, f64)> {
        let (patch, u, v) = self.patch(unit, at)?;
        Some((
            self.surfaces[patch].point_at(DVec2::new(u, v)),
            self.limit.patches()[patch].deviation,
        ))
    }

    pub(super) fn surface(&self, patch: usize) -> &NurbsSurface {
        &self.surfaces[patch]
    }
}

/// The whole squares of a cage's faces.
pub(super) fn units(cage: &Cage) -> Vec<(usize, FaceRect)> {
    let mut units = Vec::new();
    for face in 0..cage.face_count() {
        let sides = cage.face(face).unwrap().len();
        for _ in 0..if sides == 4 { 1 } else { sides } {
            units.push((face, FaceRect::whole(face, units.len())));
        }
    }
    units
}
