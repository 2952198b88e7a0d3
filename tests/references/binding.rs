//! The binding itself: packets of every width, both primitives, ranges, places, clean-up.

use glam::{DVec2, DVec3};
use nurbray::intersect::Coherence;
use nurbray::io::mesh::{GridMesh, MeshPoint};
use nurbray::io::{Embree, EmbreePrimitive, EmbreeScene, PacketWidth};
use nurbray::math::Ray;

use crate::loaded::embree;

const WIDTHS: [PacketWidth; 3] = [PacketWidth::One, PacketWidth::Eight, PacketWidth::Sixteen];
const PRIMITIVES: [EmbreePrimitive; 2] = [EmbreePrimitive::Grid, EmbreePrimitive::Triangle];

/// A bump `z = h(x, y)` over `[0, 1]²`, moved by `offset`; 6 × 4 cells.
fn bump(offset: DVec3) -> GridMesh {
    let mut mesh = GridMesh::default();
    mesh.push_grid((7, 5), |row, column| {
        let uv = DVec2::new(row as f64 / 6.0, column as f64 / 4.0);
        let height = (3.0 * uv.x).sin() * (2.0 * uv.y).cos();
        MeshPoint { position: offset + uv.extend(height), normal: DVec3::Z, uv }
    })
    .unwrap();
    mesh
}

/// Rays down on a 9 × 9 raster that reaches a little beyond the bump.
fn rays_down(offset: DVec3) -> Vec<Ray> {
    let place = |i: i32| -0.06 + 0.14 * f64::from(i);
    (0..81)
        .map(|i| offset + DVec3::new(place(i % 9), place(i / 9), 5.0))
        .map(|origin| Ray::new(origin, DVec3::new(0.0, 0.0, -2.0)).unwrap())
        .collect()
}

/// Traces down on a bump and checks each hit against the mesh itself; counts the hits.
fn check(scene: &EmbreeScene, mesh: &GridMesh, primitive: EmbreePrimitive, at: DVec3) -> usize {
    let triangles: Vec<_> = mesh.triangles().collect();
    let rays = rays_down(at);
    let mut counts = Vec::new();
    for width in WIDTHS {
        for coherence in [Coherence::Coherent, Coherence::Incoherent] {
            let mut batch = scene.rays(&rays, width, coherence);
            scene.intersect(&mut batch);
            scene.intersect(&mut batch); // a second time: answers must not depend on the first
            let hits = batch.hits();
            assert_eq!(hits.len(), rays.len());
            for (ray, hit) in rays.iter().zip(&hits) {
                let inside = (ray.origin() - at).truncate();
                let expected = inside.cmpge(DVec2::ZERO).all() && inside.cmple(DVec2::ONE).all();
                assert_eq!(hit.is_some(), expected, "{width:?} {primitive:?} {inside}");
                let Some(hit) = hit else { continue };
                let number = hit.primitive as usize;
                let point = match primitive {
                    EmbreePrimitive::Grid => mesh.at_grid(number, hit.place),
                    EmbreePrimitive::Triangle => mesh.at_triangle(triangles[number], hit.place),
                };
                let meshes = vec![mesh.clone(); hit.mesh as usize + 1];
                assert_eq!(hit.on(&meshes), Some(point), "{width:?} {primitive:?} {inside}");
                // Coordinates of size 5 in f32, a few operations each.
                let error = (point.position - ray.at(hit.t)).length();
                assert!(error < 4e-6, "{width:?} {primitive:?} {inside}: {error:e}");
            }
            counts.push(hits.iter().flatten().count());

            scene.occluded(&mut batch);
            let occluded = batch.occlusions();
            assert!(occluded.iter().zip(&hits).all(|(&occluded, hit)| occluded == hit.is_some()));
        }
    }
    assert!(counts.iter().all(|&count| count == counts[0]), "{counts:?}");
    counts[0]
}

#[test]
fn every_width_and_primitive_finds_the_same_places() {
    let Some(embree) = embree() else { return };
    let major = embree.version()[0];
    assert!(major == 3 || major == 4);
    for offset in [DVec3::ZERO, DVec3::new(1e6, -2e6, 3e6)] {
        let mesh = bump(offset);
        for primitive in PRIMITIVES {
            let scene = embree.scene(std::slice::from_ref(&mesh), primitive).unwrap();
            assert_eq!(check(&scene, &mesh, primitive, offset), 49);
        }
    }
}

#[test]
fn ranges_and_lengths_of_directions_are_kept() {
    let Some(embree) = embree() else { return };
    let mesh = bump(DVec3::ZERO);
    let scene = embree.scene(&[mesh, bump(DVec3::Z)], EmbreePrimitive::Grid).unwrap();
    let (origin, down) = (DVec3::new(0.3, 0.4, 5.0), DVec3::NEG_Z);
    let ranges = [(0.0, f64::INFINITY), (3.5, 9.0), (0.0, 3.0), (6.0, 9.0)];
    let rays = ranges.map(|(near, far)| Ray::with_range(origin, down, near, far).unwrap());
    for width in WIDTHS {
        let mut batch = scene.rays(&rays, width, Coherence::Incoherent);
        scene.intersect(&mut batch);
        let meshes: Vec<_> = batch.hits().iter().map(|hit| hit.map(|hit| hit.mesh)).collect();
        assert_eq!(meshes, [Some(1), Some(0), None, None], "{width:?}");
        scene.occluded(&mut batch);
        assert_eq!(batch.occlusions(), [true, true, false, false], "{width:?}");
    }
}

#[test]
fn scenes_of_any_size_and_rays_of_any_length_are_met_alike() {
    let Some(embree) = embree() else { return };
    let found = |size: f64, length: f64| {
        let mut mesh = GridMesh::default();
        mesh.push_grid((9, 9), |row, column| {
            let uv = DVec2::new(row as f64 / 8.0, column as f64 / 8.0);
            let height = (3.0 * uv.x).sin() * (2.0 * uv.y).cos();
            MeshPoint { position: size * uv.extend(height), normal: DVec3::Z, uv }
        })
        .unwrap();
        let scene = embree.scene(&[mesh], EmbreePrimitive::Grid).unwrap();
        let rays: Vec<Ray> = rays_down(DVec3::ZERO)
            .iter()
            .map(|ray| Ray::new(size * ray.origin(), length * ray.direction()).unwrap())
            .collect();
        let mut batch = scene.rays(&rays, PacketWidth::Eight, Coherence::Coherent);
        scene.intersect(&mut batch);
        let plain = |t: f64| t * length / size;
        batch.hits().iter().map(|hit| hit.map(|hit| (plain(hit.t), hit.place))).collect::<Vec<_>>()
    };
    let expected = found(1.0, 1.0);
    assert_eq!(expected.iter().flatten().count(), 49);
    // Powers of two: the same bits.
    for power in [-100, -30, 30, 100] {
        for length in [power, 0] {
            let (size, length) = (2_f64.powi(power), 2_f64.powi(length));
            assert_eq!(found(size, length), expected, "{size:e} {length:e}");
        }
    }
}

#[test]
fn memory_is_counted_and_returned() {
    let Some(embree) = embree() else { return };
    let before = embree.bytes();
    let scene = embree.scene(&[bump(DVec3::ZERO)], EmbreePrimitive::Triangle).unwrap();
    let during = embree.bytes();
    assert!(during >= before + 35 * 12, "{before} {during}"); // the vertices at least
    drop(scene);
    assert!(embree.bytes() < during);
}

/// Embree must not leave the processor flushing denormals to zero: our f64 code needs them.
#[test]
fn denormal_numbers_survive() {
    let halves = || {
        let smallest = std::hint::black_box(f64::MIN_POSITIVE);
        (std::hint::black_box(smallest * 0.5) * 2.0, std::hint::black_box(1e-310) * 1e300)
    };
    let expected = halves();
    assert_eq!(expected.0, f64::MIN_POSITIVE);
    let Some(embree) = embree() else { return };
    let scene = embree.scene(&[bump(DVec3::ZERO)], EmbreePrimitive::Grid).unwrap();
    let mut batch = scene.rays(&rays_down(DVec3::ZERO), PacketWidth::Eight, Coherence::Coherent);
    scene.intersect(&mut batch);
    assert_eq!(halves(), expected);
}

#[test]
fn scenes_outlive_the_handle_they_came_from_and_serve_many_threads() {
    let Some(embree) = embree() else { return };
    let mesh = bump(DVec3::ZERO);
    let scene = embree.scene(std::slice::from_ref(&mesh), EmbreePrimitive::Grid).unwrap();
    drop(embree);
    std::thread::scope(|scope| {
        for _ in 0..3 {
            scope.spawn(|| check(&scene, &mesh, EmbreePrimitive::Grid, DVec3::ZERO));
        }
    });
}

#[test]
fn an_empty_scene_is_never_hit() {
    let Some(embree) = embree() else { return };
    let scene = embree.scene(&[], EmbreePrimitive::Grid).unwrap();
    let mut batch = scene.rays(&rays_down(DVec3::ZERO), PacketWidth::Sixteen, Coherence::Coherent);
    scene.intersect(&mut batch);
    assert!(batch.hits().iter().all(Option::is_none));
    let single = Embree::load_with_threads(1).unwrap();
    assert_eq!(single.version().len(), 3);
}
