//! What is said of triangles and cages in scenes.

use glam::{DVec2, DVec3};

use super::tests::{error, scene};
use crate::scene::World;

#[test]
fn what_is_no_triangle_is_told() {
    let shape = |text: &str| error(&format!("[[object]]\nshape.triangle = {{ {text} }}"));
    let corners = "points = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]";
    assert_eq!(
        shape(&format!("degree = 2, {corners}")),
        "s.toml:2:41: surface \"triangle\": 3 control points, but a triangle of degree 2 needs 6"
    );
    assert_eq!(
        shape(&format!("degree = 0, {corners}")),
        "s.toml:2:29: surface \"triangle\": degree 0: degrees from 1 to 32 are supported"
    );
    assert_eq!(
        shape(&format!("degree = 1, {corners}, weights = [1, 2]")),
        "s.toml:2:86: surface \"triangle\": 2 weights for 3 control points: each needs one, or \
         none has any"
    );
    assert_eq!(
        shape(&format!("degree = 1, {corners}, weights = [1, 2, -1]")),
        "s.toml:2:93: surface \"triangle\": the weight of control point (1, 0, 0) is -1: it must \
         be positive and finite (from 1e-70 to 1e70)"
    );
    assert_eq!(
        shape("degree = 1, points = [[0, 0, 0], [1, 0, 0], [1e99, 0, 0]]"),
        "s.toml:2:64: surface \"triangle\": control point (1, 0, 0) is (1e99, 0, 0): coordinates \
         must be finite (up to 1e70)"
    );
}

#[test]
fn what_is_no_cage_is_told_where_it_is_written() {
    let cage = |text: &str| error(&format!("[[object]]\nname = 'box'\n[object.shape.{text}"));
    let points = "points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 1]]";
    let with = |faces: &str| cage(&format!("catmull_clark]\n{points}\nfaces = [{faces}]"));
    assert_eq!(
        with("[0, 1, 2], [1, 0, 3], [0, 1, 4]"),
        "s.toml:5:32: surface \"box\": the edge between vertices 0 and 1 belongs to faces 0, 1 \
         and 2: at most two may share an edge"
    );
    assert_eq!(
        with("[0, 1, 2], [0, 1, 3], [3, 4, 0]"),
        "s.toml:5:21: surface \"box\": faces 0 and 1 both run from vertex 0 to vertex 1: one of \
         them is inside out"
    );
    assert_eq!(
        with("[0, 1, 2], [1, 0, 3]"),
        "s.toml:4:55: surface \"box\": vertex 4 belongs to no face"
    );
    assert_eq!(
        with("[0, 1, 2], [1, 0, 3, 4]]\ncreases = [{ vertices = [0, 1, 2, 4], sharpness = 1 }"),
        "s.toml:6:12: surface \"box\": crease 2: there is no edge between vertices 2 and 4"
    );
    assert_eq!(
        with("[0, 1, 2], [1, 0, 3, 4]]\ncorners = [{ vertices = [3], sharpness = -1 }"),
        "s.toml:6:12: surface \"box\": corner 0 has sharpness -1: it must be from 0 to 10, or \
         infinite"
    );
    assert_eq!(
        cage(&format!("catmull_clark]\n{points}\nfaces = [[0, 1, 2, 3, 4]]\ntolerance = 0")),
        "s.toml:6:13: surface \"box\": tolerance 0: for a cage with coordinates up to 1 it must \
         be finite and at least 1e-9"
    );
    assert_eq!(
        cage(&format!("doo_sabin]\n{points}\nfaces = [[0, 1, 2, 3, 4]]")),
        "s.toml:3:9: surface \"box\": all vertices are on the boundary: a Doo–Sabin surface lies \
         around the vertices inside"
    );
    assert_eq!(
        cage("doo_sabin]\nfile = 'x.obj'\nboundary = 'edge_only'"),
        "s.toml:4:8: doo_sabin: needed is a file, or points and faces with creases, corners and \
         boundary, not both"
    );
    assert_eq!(
        cage("doo_sabin]\nfaces = [[0, 1, 2]]"),
        "s.toml:3:9: doo_sabin: needed are points and faces, or a file"
    );
    assert_eq!(cage("doo_sabin]\nfile = 'deck.json'"), "s.toml:4:8: no deck.json");
}

#[test]
fn a_net_of_a_cage_is_the_cage_and_iso_curves_are_of_nurbs() {
    let cage = "[[object]]\nname = 'box'\nshape.doo_sabin = { points = [[1, 1, 1], [-1, -1, 1], \
        [-1, 1, -1], [1, -1, -1]], faces = [[0, 1, 3], [0, 2, 1], [0, 3, 2], [1, 2, 3]], \
        tolerance = 1e-3 }\ntransform = [{ scale = 2 }]\n";
    let net = "[[object]]\nname = 'net'\nshape.net = { of = 'box', radius = 0.01 }\n";
    let world = World::new(&scene(&format!("{cage}{net}"))).unwrap();
    assert_eq!(world.surfaces.len(), 1 + 6 + 4);
    assert!(world.surfaces[0].deviation > 0.0 && world.surfaces[0].deviation <= 2e-3);
    let corner = world.surfaces.iter().find(|one| one.name == "net/point 1").unwrap();
    let middle = 0.5 * (corner.surface.point_at(DVec2::ZERO) + corner.surface.point_at(DVec2::Y));
    assert!(middle.distance(DVec3::splat(2.0)) < 1e-14, "moved with the box: {middle}");
    let lines =
        "[[object]]\nname = 'l'\nshape.iso_curves = { of = 'box', u = [0.5], radius = 0.1 }";
    assert_eq!(
        error(&format!("{cage}{lines}")),
        "s.toml:7:1: surface \"l\": a subdivision surface has no iso-curves: NURBS surfaces have"
    );
    // At a pole there is nothing to draw.
    let ball = "[[object]]\nname = 'box'\nshape = 'sphere'\n";
    assert_eq!(
        error(&format!("{ball}{}", lines.replace("0.5", "0.5, 0"))),
        "s.toml:6:1: surface \"l\": the line u = 0 is a single point, where there is nothing to \
         draw"
    );
}
