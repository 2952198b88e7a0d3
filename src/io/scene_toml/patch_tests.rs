//! Triangles and cages in scenes, and the errors about them.

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
fn an_octant_s_constants_are_told_where_they_are_written() {
    let octant = |keys: &str| format!("[[object]]\nshape = {{ octant_quartic = {{ {keys} }} }}");
    let a = "a = [0.4226497308103742, 0.7886751345948129, 0.589353461558106]";
    let b = "b = [5.071796769724491, 4.242640687119285, 4, 3.344677257168586]";
    for keys in [a.to_owned(), b.to_owned(), format!("radius = 2, {a}, {b}")] {
        let world = World::new(&scene(&octant(&keys))).unwrap();
        let point = world.surfaces[0].surface.point_at(DVec2::new(0.2, 0.3));
        let radius = if keys.starts_with('r') { 2.0 } else { 1.0 };
        assert!((point.length() - radius).abs() < 1e-15, "{keys}: {point}");
    }
    let message = error(&octant("radius = 1, a = [0.42, 0.79, 0.59]"));
    let begins =
        "s.toml:2:46: surface \"octant_quartic\": the constants a = [0.42, 0.79, 0.59], b = [";
    assert!(message.starts_with(begins), "{message}");
    assert!(
        message.contains("] make no sphere: ") && message.contains("a = [0.4226497308103742, "),
        "{message}"
    );
    assert_eq!(
        error(&octant("b = [5, 4, 4, -3]")),
        "s.toml:2:34: surface \"octant_quartic\": b3 -3: it must be positive and finite (from 1e-70 to \
         1e70)"
    );
    assert!(
        error(&octant("b = [5, 4, 4]")).contains("list of 4"),
        "{}",
        error(&octant("b = [5, 4, 4]"))
    );
}

/// Each error is placed at the curve that folds.
#[test]
fn profiles_that_fold_are_told_where_they_are_written() {
    let of = |shape: &str| error(&format!("[[object]]\nname = 'o'\n[object.shape.{shape}"));
    let back = "{ polyline = [[0, 0], [3, 1], [1.5, 0.5]] }";
    let line = "{ polyline = [[0, 0, 1], [1, 0, 1]] }";
    let folds = "it folds at control point 1, (3, 1, 0): there it turns round and runs back over \
                 itself, for a length of 1.58114; the surface would be covered twice";
    for (shape, place, which) in [
        (format!("extrusion]\nby = [0, 0, 1]\nprofile = {back}"), "5:11", "profile"),
        (format!("revolution]\naxis = 'y'\nprofile = {back}"), "5:11", "profile"),
        (format!("sweep]\npath = {line}\nprofile = {back}"), "5:11", "profile"),
        (format!("sweep]\nprofile = {line}\npath = {back}"), "5:8", "path"),
        (format!("tube]\nradius = 0.1\ncurve = {back}"), "5:9", "curve"),
        (format!("ribbon]\nwidth = 0.1\ncurve = {back}"), "5:9", "curve"),
        (format!("ruled]\nto = {back}\nfrom = {back}"), "5:8", "curve `from`"),
        (format!("loft]\nsections = [\n{line},\n{back},\n{line},\n]"), "6:1", "section 1"),
    ] {
        assert_eq!(of(&shape), format!("s.toml:{place}: surface \"o\": {which}: {folds}"));
    }
    // A circle about its own diameter.
    let ball = "revolution]\naxis = 'y'\nprofile = { circle = { radius = 1 } }";
    let message = of(ball);
    let begins =
        "s.toml:5:11: surface \"o\": profile: turned by 360° about the axis it covers itself: ";
    assert!(message.starts_with(begins), "{message}");
}

/// Each key stands on a line of its own, as the documentation shows them.
#[test]
fn numbers_of_constructions_are_told_where_they_are_written() {
    let profile = "profile = { circle = { radius = 0.2 } }";
    let line = "polyline = [[0, 0, 0], [0, 0, 1]]";
    let sections = "sections = [{ polyline = [[0, 0], [1, 0]] }, { polyline = [[0, 1], [1, 1]] }]";
    let (sweep, tube) =
        (format!("{profile}\npath = {{ {line} }}"), format!("curve = {{ {line} }}"));
    for (kind, others, key, message) in [
        (
            "revolution",
            profile,
            "degrees = 720",
            "angle 720°: it must be from -360° to 360°, and not 0°",
        ),
        (
            "revolution",
            profile,
            "axis = [0, 0, 0]",
            "direction of the axis (0, 0, 0): it must be finite and not zero",
        ),
        (
            "extrusion",
            profile,
            "by = [0, 0, 0]",
            "extrusion by (0, 0, 0): it must be finite and not zero",
        ),
        ("loft", sections, "degree = 0", "degree 0 across: degrees from 1 to 32 are supported"),
        ("loft", sections, "degree = 2", "2 sections: degree 2 across needs at least 3"),
        (
            "sweep",
            &sweep,
            "up = 'z'",
            "up (0, 0, 1) runs along the path, whose direction there is (0, 0, 1): choose another one",
        ),
        ("sweep", &sweep, "scale = [1, -1]", "scale 1 is -1: it must be finite, and not negative"),
        ("sweep", &sweep, "tolerance = 0", "tolerance 0: it must be positive and finite"),
        ("tube", &tube, "radius = -1", "tube: radius -1: it must be positive and finite"),
        ("ribbon", &tube, "width = 0", "width 0: it must be positive and finite"),
        (
            "polygon",
            &format!("{tube}\nradius = 1"),
            "joints = -1",
            "joint radius -1: it must be positive and finite",
        ),
    ] {
        let text = format!("[[object]]\nname = 'o'\n[object.shape.{kind}]\n{others}\n{key}");
        let (row, column) = (text.lines().count(), key.find("= ").unwrap() + 3);
        let expected = format!("s.toml:{row}:{column}: surface \"o\": {message}");
        assert_eq!(error(&text), expected);
    }
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
        "s.toml:6:13: surface \"box\": tolerance 0: for a cage of this size with coordinates up to 1 it must \
         be finite and at least 5e-10"
    );
    assert_eq!(
        cage(&format!("doo_sabin]\n{points}\nfaces = [[0, 1, 2, 3, 4]]")),
        "s.toml:3:9: surface \"box\": all vertices are on the boundary: a Doo–Sabin surface lies \
         around the vertices inside"
    );
    assert_eq!(
        cage("catmull_clark]\nfile = 'x.obj'\nboundary = 'edge_only'"),
        "s.toml:4:8: catmull_clark: needed is a file, or points and faces with creases, corners and \
         boundary, not both"
    );
    assert_eq!(
        cage("doo_sabin]\nfile = 'x.obj'\nfaces = [[0, 1, 2]]"),
        "s.toml:4:8: doo_sabin: needed is a file, or points and faces, not both"
    );
    // No Doo–Sabin surface reaches the border, whichever rule is given.
    for rule in ["edge_only", "edge_and_corner"] {
        assert_eq!(
            cage(&format!("doo_sabin]\nfile = 'x.obj'\nboundary = '{rule}'")),
            "s.toml:5:12: doo_sabin: boundary says nothing here, as these surfaces end inside of \
             the cage's border: it goes with catmull_clark"
        );
    }
    assert_eq!(
        cage("doo_sabin]\nfaces = [[0, 1, 2]]"),
        "s.toml:3:9: doo_sabin: needed are points and faces, or a file"
    );
    assert_eq!(cage("doo_sabin]\nfile = 'deck.json'"), "s.toml:4:8: no deck.json");
}

#[test]
fn nets_and_iso_curves_of_cages_and_triangles_lie_on_them() {
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
    // After a Doo–Sabin step there are three points for each triangle, which moves halfway to its
    // middle. Each triangle has three edges of its own, and six that lead to its neighbours, which
    // share them.
    let refined = net.replace("'box'", "'box', steps = 1");
    let world = World::new(&scene(&format!("{cage}{refined}"))).unwrap();
    assert_eq!(world.surfaces.len(), 1 + 24 + 12);
    let tripled = net.replace("'box'", "'ball', steps = 1");
    let ball = cage.replace("box", "ball").replace("doo_sabin", "catmull_clark");
    let world = World::new(&scene(&format!("{ball}{tripled}"))).unwrap();
    assert_eq!(world.surfaces.len(), 1 + 24 + 14);
    assert_eq!(
        error(&format!("[[object]]\nname = 'ball'\nshape = 'sphere'\n{tripled}")),
        "s.toml:6:36: surface \"net\": steps are those of subdivision, and the object is not only subdivision surfaces"
    );
    let many = net.replace("'box'", "'box', steps = 17");
    assert_eq!(
        error(&format!("{cage}{many}")),
        "s.toml:7:35: surface \"net\": 17 steps: a cage is drawn after up to 16"
    );
    let lines =
        "[[object]]\nname = 'l'\nshape.iso_curves = { of = 'box', u = [0.5], radius = 0.1 }";
    // The middle of every tube is within 0.03 of a grid of points on the cage's surface.
    let thin = |shape: &str| format!("[[object]]\nname = 'l'\nshape.iso_curves = {{ {shape} }}\n");
    let on_cage = thin("of = 'box', u = [0.5, 12], v = [0.25], radius = 1e-3");
    let world = World::new(&scene(&format!("{cage}{on_cage}"))).unwrap();
    let surface = &world.surfaces[0].surface;
    let lines_of_cage: Vec<_> = surface.domain().iter().map(|range| range[1]).collect();
    assert_eq!(lines_of_cage, [12.0, 1.0]);
    let grid: Vec<DVec3> = (0..12 * 65 * 65)
        .map(|k| {
            let (unit, i, j) = (k / 65 / 65, k / 65 % 65, k % 65);
            let u = (unit as f64 + i as f64 / 64.0).min((unit as f64 + 1.0).next_down());
            surface.point_at(DVec2::new(u, j as f64 / 64.0))
        })
        .collect();
    for tube in world.surfaces[1..].iter().filter(|one| one.name.starts_with("l/tube")) {
        let [[u0, u1], [v0, v1]] = tube.surface.domain();
        let at = |s: f64, t: f64| {
            tube.surface.point_at(DVec2::new(u0 + s * (u1 - u0), v0 + t * (v1 - v0)))
        };
        for t in [0.1, 0.5, 0.8] {
            let middle = 0.5 * (at(0.0, t) + at(0.5, t));
            let near = grid.iter().map(|point| point.distance(middle)).fold(f64::MAX, f64::min);
            assert!(near < 0.03, "{}: {near}", tube.name);
        }
    }
    assert_eq!(
        error(&format!("{cage}{}", thin("of = 'box', u = [13], radius = 0.1"))),
        "s.toml:7:38: surface \"l\": the line u = 13 is not on the surface, whose u is from 0 to 12"
    );

    // On a sphere's octant, tubes are within their radius of the sphere; each is of one line.
    let octant = "[[object]]\nname = 'box'\nshape = { octant_quartic = { radius = 1 } }\n";
    let on_octant = thin("of = 'box', u = [0.25], v = [0, 0.5], w = [0.5], radius = 1e-2");
    let world = World::new(&scene(&format!("{octant}{on_octant}"))).unwrap();
    let tubes = world.surfaces[1..].iter().filter(|one| one.name.starts_with("l/tube"));
    assert_eq!(tubes.clone().count(), 4);
    for tube in tubes {
        for k in 0..81 {
            let at = DVec2::new(f64::from(k / 9) / 8.0, f64::from(k % 9) / 8.0);
            let domain = tube.surface.domain();
            let low = DVec2::new(domain[0][0], domain[1][0]);
            let size = DVec2::new(domain[0][1], domain[1][1]) - low;
            let off = tube.surface.point_at(low + at * size).length() - 1.0;
            assert!(off.abs() <= 1e-2 + tube.deviation + 1e-12, "{}: {off}", tube.name);
        }
    }
    for (line, message) in [
        ("u = [1.5]", "the line u = 1.5 is not on the surface, whose u is from 0 to 1"),
        ("w = [1]", "the line w = 1 is a single point, where there is nothing to draw"),
    ] {
        let lines = thin(&format!("of = 'box', {line}, radius = 0.1"));
        let expected = format!("s.toml:6:38: surface \"l\": {message}");
        assert_eq!(error(&format!("{octant}{lines}")), expected);
    }
    // At a pole there is nothing to draw.
    let ball = "[[object]]\nname = 'box'\nshape = 'sphere'\n";
    assert_eq!(
        error(&format!("{ball}{}", thin("of = 'box', w = [0.5], radius = 0.1"))),
        "s.toml:6:38: surface \"l\": a NURBS surface has no lines of constant w: triangular patches \
         have"
    );
    assert_eq!(
        error(&format!("{ball}{}", lines.replace("0.5", "0.5, 0"))),
        "s.toml:6:38: surface \"l\": the line u = 0 is a single point, where there is nothing to \
         draw"
    );
}
