//! Triangles of surfaces, with and without trims.

use std::collections::HashMap;

use glam::DVec2;

use super::*;
use crate::geometry::trim::{Kept, Side, TrimDomain, TrimLoop, Trims};
use crate::geometry::{KnotVector, NurbsSurface, Surface, TrimmedSurface, shapes};

#[test]
fn a_plane_needs_two_triangles() {
    let plane = shapes::plane(2.0, 1.0).unwrap();
    let made = Tessellation::to_tolerance(&[plane], 1e-9).unwrap();
    assert_eq!(made.meshes()[0].triangles().count(), 2);
    assert!(made.deviation() < 1e-16);
    assert!((made.diagonal() - 5f64.sqrt()).abs() < 1e-15);
}

/// The largest distance between a sphere and points all over its triangles.
fn from_sphere(made: &Tessellation, radius: f64) -> f64 {
    let mut worst: f64 = 0.0;
    let weights = [[0.5, 0.0], [0.0, 0.5], [0.5, 0.5], [1.0 / 3.0, 1.0 / 3.0], [0.2, 0.3]];
    for mesh in made.meshes() {
        for corners in mesh.triangles() {
            for place in weights.map(DVec2::from_array) {
                let point = mesh.at_triangle(corners, place).position;
                worst = worst.max((point.length() - radius).abs());
            }
        }
    }
    worst
}

#[test]
fn tolerances_are_kept_and_little_more() {
    for radius in [1e-8, 1.0, 1e8] {
        for sphere in [shapes::sphere(radius), shapes::sphere_biquadratic(radius)] {
            let sphere = [sphere.unwrap()];
            for fraction in [1e-2, 1e-3, 1e-4] {
                let made = Tessellation::to_tolerance(&sphere, fraction).unwrap();
                let allowed = fraction * made.diagonal();
                let worst = from_sphere(&made, radius);
                assert!(made.deviation() <= allowed);
                assert!(worst < 1.02 * allowed, "{fraction}: {worst:e} > {allowed:e}");
                assert!(worst > 0.4 * allowed, "{fraction}: {worst:e} of {allowed:e}");
                assert!((made.deviation() / worst - 1.0).abs() < 0.2);
            }
        }
    }
}

fn holed(surface: NurbsSurface, loops: &[TrimLoop]) -> Surface {
    let domain = TrimDomain::with_seams_of(&surface).unwrap();
    let trims = Trims::new(domain, Kept::Even, loops).unwrap();
    TrimmedSurface::new(surface, trims).unwrap().into()
}

fn area(made: &Tessellation) -> f64 {
    let corners = made.meshes().iter().flat_map(|mesh| {
        mesh.triangles().map(|corners| corners.map(|k| mesh.positions()[k as usize]))
    });
    corners.map(|[a, b, c]| 0.5 * (b - a).cross(c - a).length()).sum()
}

#[test]
fn trimmed_surfaces_keep_their_area_and_no_point_of_a_hole() {
    // An elliptic hole in a sheet of 2 × 1, with a square island.
    let (center, radius) = (DVec2::new(0.4, 0.5), 0.3);
    let circle = TrimLoop::circle(center, radius).unwrap();
    let square = [[0.3, 0.4], [0.5, 0.4], [0.5, 0.6], [0.3, 0.6]].map(DVec2::from);
    let square = TrimLoop::polygon(&square).unwrap();
    let sheet = [holed(shapes::plane(2.0, 1.0).unwrap(), &[circle.clone(), square])];
    let exact = 2.0 * (1.0 - std::f64::consts::PI * radius * radius + 0.04);
    let mut errors = Vec::new();
    for fraction in [1e-2, 1e-3, 1e-4] {
        let made = Tessellation::to_tolerance(&sheet, fraction).unwrap();
        assert!((made.diagonal() - 5f64.sqrt()).abs() < 1e-15);
        // Chords lie within the ellipse, of circumference 4.6: the hole is a little small.
        let excess = area(&made) - exact;
        assert!(0.0 < excess && excess < 4.6 * fraction * made.diagonal(), "{excess}");
        errors.push(excess);
        for at in made.meshes()[0].uv() {
            let from_hole = at.distance(center) - radius;
            let on_island = (*at - center).abs().max_element() <= 0.1 + 1e-12;
            assert!(on_island || from_hole > -fraction * made.diagonal(), "{at}");
        }
    }
    assert!(errors[2] < 0.1 * errors[1] && errors[1] < 0.2 * errors[0], "{errors:?}");

    // A band cut out of a curved surface: half of it is left, within its tolerance.
    let cylinder = shapes::cylinder(1.0, 3.0).unwrap();
    let [[u0, u1], [v0, v1]] = cylinder.domain();
    let v = |share: f64| v0 + share * (v1 - v0);
    let band = [(u0, 0.25), (u1, 0.25), (u1, 0.75), (u0, 0.75)];
    let band = TrimLoop::polygon(&band.map(|(u, share)| DVec2::new(u, v(share)))).unwrap();
    let made = Tessellation::to_tolerance(&[holed(cylinder, &[band])], 1e-4).unwrap();
    let half = std::f64::consts::PI * 3.0;
    assert!((area(&made) / half - 1.0).abs() < 2e-3, "{} of {half}", area(&made));
    for position in made.meshes()[0].positions() {
        let off = (position.truncate().length() - 1.0).abs();
        assert!(off <= 1e-4 * made.diagonal(), "{position}");
        assert!(!(0.76..2.24).contains(&position.z), "{position}");
    }
}

#[test]
fn a_hole_takes_about_as_many_triangles_as_its_edge_has_chords() {
    let center = DVec2::new(0.5, 0.5);
    for (radius, fraction) in [(0.3, 1e-3), (0.3, 1e-4), (0.1, 1e-4)] {
        let circle = TrimLoop::circle(center, radius).unwrap();
        let sheet = holed(shapes::plane(2.0, 2.0).unwrap(), &[circle]);
        let made = Tessellation::to_tolerance(&[sheet], fraction).unwrap();
        // The chords of n equal arcs are off by r (1 − cos(π / n)).
        let distance = fraction * made.diagonal();
        let chords = std::f64::consts::PI / (1.0 - distance / (2.0 * radius)).acos();
        let triangles = made.meshes()[0].triangles().count() as f64;
        // A ring between a polygon of n corners and a square is n + 4 triangles.
        assert!(triangles < 1.3 * chords + 8.0, "{triangles} for {chords} chords");
    }
}

/// The area of a square from -1 to 1 cut into `cells` × `cells` spans, and kept by loops in its
/// parameters from 0 to 1. The only edges without a neighbour are at loops and at the border.
fn kept_area(cells: usize, loops: &[TrimLoop]) -> f64 {
    let knots = || KnotVector::clamped_uniform(1, cells + 1).unwrap();
    let points = (0..(cells + 1) * (cells + 1)).map(|k| {
        let at = DVec2::new((k / (cells + 1)) as f64, (k % (cells + 1)) as f64);
        (2.0 * at / cells as f64 - 1.0).extend(0.0)
    });
    let sheet = NurbsSurface::new(knots(), knots(), points.collect(), None).unwrap();
    let [u, v] = sheet.domain();
    assert_eq!([u, v], [[0.0, 1.0]; 2]);
    let domain = TrimDomain::with_seams_of(&sheet).unwrap();
    let trims = Trims::new(domain, Kept::Even, loops).unwrap();
    let made = Tessellation::to_tolerance(&[holed(sheet, loops)], 1e-4).unwrap();
    for [a, b] in open_edges(&made.meshes()[0]) {
        let middle = 0.5 * (a + b);
        let at_border = (middle - 0.5).abs().max_element() == 0.5;
        let reach = DVec2::splat(2e-4);
        let at_loop = matches!(trims.side_within(middle, reach), Side::Edge { .. });
        assert!(at_border || at_loop, "{a} to {b}");
    }
    area(&made)
}

#[test]
fn loops_may_touch_overlap_nest_and_run_along_cells() {
    let square = |low: DVec2, high: DVec2| {
        let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
        TrimLoop::polygon(&corners).unwrap()
    };
    let at = |u, v| DVec2::new(u, v);
    let circle = |u, radius| TrimLoop::circle(DVec2::new(u, 0.5), radius).unwrap();
    let disk = |radius: f64| 4.0 * std::f64::consts::PI * radius * radius;
    let overlap = 1e-16;
    let cases = [
        // An island in a hole, with a hole in it.
        (
            vec![circle(0.5, 0.4), circle(0.5, 0.3), circle(0.5, 0.1)],
            4.0 - disk(0.4) + disk(0.3) - disk(0.1),
        ),
        // Holes that touch: in a point, in a corner, along a side.
        (vec![circle(0.25, 0.125), circle(0.5, 0.125)], 4.0 - 2.0 * disk(0.125)),
        (
            vec![square(at(0.1, 0.1), at(0.3, 0.3)), square(at(0.3, 0.3), at(0.7, 0.6))],
            4.0 - 4.0 * 0.16,
        ),
        (
            vec![square(at(0.1, 0.1), at(0.3, 0.4)), square(at(0.3, 0.2), at(0.6, 0.3))],
            4.0 - 4.0 * 0.09,
        ),
        // Along cells of spans of 1/4 and 1/2, and across their corners.
        (vec![square(at(0.25, 0.25), at(0.75, 0.5))], 4.0 - 4.0 * 0.125),
        (vec![square(at(0.25, 0.1), at(0.75, 0.5))], 4.0 - 4.0 * 0.2),
        (
            vec![
                TrimLoop::polygon(&[at(0.0, 0.5), at(0.5, 0.0), at(1.0, 0.5), at(0.5, 1.0)])
                    .unwrap(),
            ],
            2.0,
        ),
        // With a corner on the side of a cell.
        (
            vec![TrimLoop::polygon(&[at(0.1, 0.1), at(0.5, 0.5), at(0.1, 0.9)]).unwrap()],
            4.0 - 4.0 * 0.16,
        ),
        // Overlapping by rounding, or next to nothing; off the side of a cell by as much.
        (
            vec![square(at(0.1, 0.1), at(0.3 + overlap, 0.4)), square(at(0.3, 0.1), at(0.6, 0.4))],
            4.0 - 4.0 * 0.15,
        ),
        (vec![square(at(0.25 + overlap, 0.1), at(0.5 - overlap, 0.4))], 4.0 - 4.0 * 0.075),
        (vec![circle(0.25, 0.125 + 1e-13), circle(0.5, 0.125)], 4.0 - 2.0 * disk(0.125)),
        // Nearer than their chords are to them.
        (vec![circle(0.5, 0.25), circle(0.5, 0.25 + 1e-6)], 4.0),
    ];
    for (number, (loops, exact)) in cases.iter().enumerate() {
        for cells in [1, 2, 4, 7] {
            let found = kept_area(cells, loops);
            let off = (found - exact).abs();
            // Chords are within 1e-4 of the diagonal, 2.8, of edges that are up to 10 long.
            assert!(off < 3e-3, "case {number}, {cells} cells: {found} of {exact}");
        }
    }
}

/// Bricks in two rows, each joint of one in the middle of a brick of the other, turned: joints
/// are exact only to rounding.
#[test]
fn loops_may_touch_at_any_angle() {
    let corner = |turn: f64, x: f64, y: f64| {
        DVec2::splat(0.5) + DVec2::from_angle(turn).rotate(DVec2::new(x, y))
    };
    for turn in [0.2, 0.6, 0.7, 0.9, 1.0, 1.3] {
        for [columns, rows] in [[2, 1], [3, 2], [6, 2], [3, 3]] {
            let bricks = (0..columns * rows).map(|k| {
                let [row, column] = [k / columns, k % columns].map(f64::from);
                let (x, y) = (column - 0.5 * (row % 2.0) - 2.0, row - 1.0);
                let ends = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)];
                let ends = ends.map(|(i, j)| corner(turn, 0.12 * (x + i), 0.12 * (y + j)));
                TrimLoop::polygon(&ends).unwrap()
            });
            let bricks: Vec<TrimLoop> = bricks.collect();
            let exact = 4.0 - 4.0 * 0.12 * 0.12 * f64::from(columns * rows);
            for cells in [1, 3] {
                let off = (kept_area(cells, &bricks) - exact).abs();
                assert!(off < 1e-8, "{columns} × {rows}, {turn}, {cells} cells: {off}");
            }
        }
    }
}

/// A hole with a bump that a chord leaves out, in a row of cells narrower than that.
#[test]
fn narrow_cells_do_not_decide_for_others() {
    let knots =
        KnotVector::with_multiplicities(1, &[(0.0, 2), (0.5, 1), (0.5005, 1), (1.0, 2)]).unwrap();
    let across = KnotVector::bezier(1).unwrap();
    let points = [0.0, 0.5, 0.5005, 1.0]
        .iter()
        .flat_map(|&x| [0.0, 1.0].map(|y| DVec3::new(x, y, 0.0)))
        .collect();
    let sheet = NurbsSurface::new(knots, across, points, None).unwrap();
    let hole = [(0.1, 0.1), (0.4999, 0.1), (0.5008, 0.5), (0.4999, 0.9), (0.1, 0.9)];
    let hole = [TrimLoop::polygon(&hole.map(|(u, v)| DVec2::new(u, v))).unwrap()];
    for fraction in [1e-2, 1e-3, 1e-4] {
        let made = Tessellation::to_tolerance(&[holed(sheet.clone(), &hole)], fraction);
        let off = (area(&made.unwrap()) - (1.0 - 0.8 * 0.40035)).abs();
        assert!(off < fraction * 1.5, "{fraction}: {off}");
    }
}

#[test]
fn deviation_falls_with_the_square_of_the_cells() {
    let torus = [shapes::torus(2.0, 0.5).unwrap()];
    let deviation = |cells| Tessellation::with_cells(&torus, cells).unwrap().deviation();
    for cells in [8, 16, 32] {
        let ratio = deviation(cells) / deviation(2 * cells);
        assert!((3.8..4.2).contains(&ratio), "{cells}: {ratio}");
    }
}

#[test]
fn straight_directions_are_not_cut() {
    let cylinder = shapes::cylinder(1.0, 3.0).unwrap();
    let made = Tessellation::to_tolerance(&[cylinder], 1e-4).unwrap();
    let mut cells = [0, 0];
    for grid in made.meshes()[0].grids() {
        cells = [cells[0].max(grid.rows() - 1), cells[1].max(grid.columns() - 1)];
    }
    assert_eq!(cells.iter().min(), Some(&1), "{cells:?}");
    // An arc of 90° cut into n has sagittas of 1 − cos(π / 4 n); 1e-4 of the diagonal
    // √(2² + 2² + 3²) allow n = 28, but the quarter circles' speed varies a little.
    assert!((28..=30).contains(cells.iter().max().unwrap()), "{cells:?}");
}

/// Two faces of a roof, or, with a knot more, two sheets.
fn roof(times: usize) -> NurbsSurface {
    let across = KnotVector::with_multiplicities(1, &[(0.0, 2), (1.0, times), (2.0, 2)]);
    let along = KnotVector::bezier(1).unwrap();
    let profile: &[(f64, f64)] = match times {
        1 => &[(0.0, 0.0), (1.0, 1.0), (2.0, 0.0)],
        _ => &[(0.0, 0.0), (1.0, 1.0), (1.5, 0.0), (2.0, 0.0)],
    };
    let points = profile.iter().flat_map(|&(x, z)| [0.0, 1.0].map(|y| DVec3::new(x, y, z)));
    NurbsSurface::new(across.unwrap(), along, points.collect(), None).unwrap()
}

#[test]
fn creases_keep_the_normals_of_both_sides_and_jumps_stay_open() {
    let creased = Tessellation::with_cells(&[roof(1)], 3).unwrap();
    let mesh = &creased.meshes()[0];
    assert_eq!(mesh.grids().len(), 2);
    for (position, normal) in mesh.positions().iter().zip(mesh.normals()) {
        let slope = if normal.x < 0.0 { 1.0 } else { -1.0 };
        assert!((normal.z - 0.5f64.sqrt()).abs() < 1e-15);
        assert!(position.x == 1.0 || (position.x < 1.0) == (slope > 0.0));
    }

    let open = Tessellation::with_cells(&[roof(2)], 2).unwrap();
    let mesh = &open.meshes()[0];
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| mesh.positions()[corner as usize]);
        assert!((b - a).cross(c - a).x <= 0.0, "a triangle spans the gap");
    }
}

/// The ends of all edges that belong to one triangle only, as parameters. Edges are the same if
/// their ends have the same positions, bit for bit.
fn open_edges(mesh: &GridMesh) -> Vec<[DVec2; 2]> {
    let mut edges = HashMap::new();
    for corners in mesh.triangles() {
        let [a, b, c] = corners.map(|corner| corner as usize);
        for ends in [[a, b], [b, c], [c, a]] {
            let bits = |k: usize| (mesh.positions()[k] + 0.0).to_array().map(f64::to_bits);
            let mut key = ends.map(bits);
            key.sort_unstable();
            if key[0] != key[1] {
                let (times, _) = edges.entry(key).or_insert((0, ends.map(|k| mesh.uv()[k])));
                *times += 1;
            }
        }
    }
    edges.into_values().filter(|(times, _)| *times == 1).map(|(_, ends)| ends).collect()
}

#[test]
fn surfaces_have_no_gaps_inside_and_none_at_their_seams() {
    let closed = [
        shapes::sphere(1.0).unwrap(),
        shapes::torus(1.0, 0.35).unwrap(),
        shapes::torus(2.0, 1.7).unwrap(),
    ];
    for fraction in [1e-2, 1e-3, 1e-4] {
        for made in closed.each_ref().map(std::slice::from_ref) {
            let made = Tessellation::to_tolerance(made, fraction).unwrap();
            assert_eq!(open_edges(&made.meshes()[0]).len(), 0);
        }
        for surface in [wavy(), creased()] {
            let [u, v] = surface.domain();
            let made = Tessellation::to_tolerance(&[surface], fraction).unwrap();
            for [a, b] in open_edges(&made.meshes()[0]) {
                let at = |[start, end]: [f64; 2], a, b| a == b && (a == start || a == end);
                assert!(at(u, a.x, b.x) || at(v, a.y, b.y), "{fraction}: {a} to {b}");
            }
        }
    }
}

/// A bicubic surface with single, double and triple knots in both directions, more wavy in
/// some parts than in others.
fn creased() -> NurbsSurface {
    let knots = || {
        let knots = [(0.0, 4), (1.0, 3), (1.5, 1), (2.0, 2), (3.0, 3), (4.0, 4)];
        KnotVector::with_multiplicities(3, &knots).unwrap()
    };
    let count = knots().point_count() as i32;
    let points = (0..count * count).map(|k| {
        let (x, y) = (f64::from(k / count), f64::from(k % count));
        DVec3::new(x, y, (0.2 * x * x).sin() * (1.0 + (0.1 * y * y).cos()))
    });
    NurbsSurface::new(knots(), knots(), points.collect(), None).unwrap()
}

fn wavy() -> NurbsSurface {
    let knots = || KnotVector::clamped_uniform(3, 7).unwrap();
    let points = (0..49).map(|k| {
        let (x, y) = (f64::from(k / 7), f64::from(k % 7));
        DVec3::new(x, y, (1.7 * x).sin() * (1.3 * y).cos())
    });
    NurbsSurface::new(knots(), knots(), points.collect(), None).unwrap()
}

#[test]
fn normals_are_those_of_the_surface_at_poles_too() {
    let sphere = shapes::sphere(2.0).unwrap();
    let made = Tessellation::with_cells(&[sphere], 5).unwrap();
    let mesh = &made.meshes()[0];
    for (position, normal) in mesh.positions().iter().zip(mesh.normals()) {
        assert!((*normal - *position / 2.0).length() < 1e-12, "{position}: {normal}");
    }
}

#[test]
fn refuses_what_cannot_be_made() {
    let plane = [shapes::plane(1.0, 1.0).unwrap()];
    let message = |fraction| Tessellation::to_tolerance(&plane, fraction).unwrap_err().to_string();
    assert_eq!(
        message(0.0),
        "a tolerance of 0: a positive fraction of the model's diagonal is needed"
    );
    assert!(Tessellation::to_tolerance(&plane, f64::NAN).is_err());
    let fine = Tessellation::to_tolerance(&[shapes::sphere(1.0).unwrap()], 1e-14);
    assert!(matches!(fine, Err(MeshError::TooManyVertices { .. })));
    let long = Tessellation::with_cells(&plane, 1 << 20);
    assert!(matches!(long, Err(MeshError::TooManyVertices { .. })));
}
