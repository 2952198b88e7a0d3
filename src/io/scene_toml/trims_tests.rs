//! What trims cut, and the errors of broken ones.

use glam::{DVec2, DVec3};

use crate::geometry::Surface;
use crate::intersect::{HitFlags, Query};
use crate::io::read_scene;
use crate::math::Ray;
use crate::scene::{Scene, World};

fn scene(text: &str) -> Result<Scene, String> {
    read_scene(text, "s.toml", &mut |_, _, _| unreachable!()).map_err(|error| error.to_string())
}

/// A plane, `0 ≤ u, v ≤ 1`, with trims.
fn plane(trims: &str) -> String {
    format!("[[object]]\nname = 'sheet'\nshape = 'plane'\n[object.trims]\n{trims}\n")
}

fn error(text: &str) -> String {
    let made = scene(text)
        .and_then(|scene| World::new(&scene).map(drop).map_err(|error| error.to_string()));
    made.unwrap_err()
}

#[test]
fn loops_of_every_kind_cut() {
    let hole = "{ circle = { center = [0.5, 0.5], radius = 0.2 } }";
    let placed = "{ curves = [{ circle = { center = [0.5, 0.5], radius = 0.2 } }] }";
    let halves = "{ curves = [{ arc = { center = [0.5, 0.5], radius = 0.2, degrees = 180 } },
        { arc = { center = [0.5, 0.5], radius = 0.2, from = 180, degrees = 180 } }] }";
    let square = "{ polygon = [[0.25, 0.25], [0.75, 0.25], [0.75, 0.75], [0.25, 0.75]] }";
    let ring = "{ curves = [
        { arc = { radius = 0.2, degrees = 180 }, transform = [{ translate = [0.5, 0.5, 0] }] },
        { polyline = [[0.3, 0.5], [0.3, 0.4]] },
        { bezier = [[0.3, 0.4], [0.5, 0.2], [0.7, 0.4]] },
        { nurbs = { degree = 1, points = [[0.7, 0.4], [0.7, 0.5]] } },
    ] }";
    for (loops, keep, middle) in [
        (hole.to_owned(), "outside", false),
        (hole.to_owned(), "inside", true),
        (placed.to_owned(), "outside", false),
        (halves.to_owned(), "inside", true),
        (square.to_owned(), "outside", false),
        (ring.to_owned(), "outside", false),
        (format!("{square}, {hole}"), "inside", false),
        (format!("{square}, {hole}"), "outside", true),
    ] {
        let text = plane(&format!("keep = '{keep}'\nloops = [{loops}]"));
        let world = World::new(&scene(&text).unwrap()).unwrap();
        let sheet = world.surfaces[0].surface.trimmed().unwrap();
        assert_eq!(sheet.keeps(DVec2::splat(0.5)), middle, "{text}");
        assert_eq!(sheet.keeps(DVec2::splat(0.1)), keep == "outside", "{text}");
    }
}

/// As the documentation of `reverse` says.
#[test]
fn trims_are_written_as_without_reverse_and_all_else_counts_after() {
    let left = "loops = [{ polygon = [[0.1, 0.1], [0.4, 0.1], [0.4, 0.9], [0.1, 0.9]] }]";
    let text = plane(left).replace("shape =", "reverse = true\nshape =");
    let world = World::new(&scene(&text).unwrap()).unwrap();
    let sheet = world.surfaces[0].surface.trimmed().unwrap();
    let [near, far] = [0.25, 0.75].map(|u| DVec2::new(u, 0.5));
    assert_eq!([near, far].map(|uv| sheet.keeps(uv)), [false, true]);
    assert_eq!(world.surfaces[0].surface.point_at(far), DVec3::new(-0.25, 0.0, 0.0));
    let line = |u: f64| {
        format!("[[object]]\nshape.iso_curves = {{ of = 'sheet', u = [{u}], radius = 0.01 }}")
    };
    assert!(World::new(&scene(&format!("{text}{}", line(0.75))).unwrap()).is_ok());
    assert_eq!(
        error(&format!("{text}{}", line(0.25))),
        "s.toml:8:40: surface \"iso_curves\": the line u = 0.25 lies where trims keep nothing, or \
         where the surface has ended"
    );

    // Where v cannot stay as it is, u and v are exchanged.
    for (shape, unit) in [
        ("triangle = { degree = 1, points = [[0, 0, 0], [0, 1, 0], [1, 0, 0]] }", 0.0),
        (
            "catmull_clark = { points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], \
             [0, 1, 0]], faces = [[0, 1, 4, 5], [1, 2, 3, 4]] }",
            1.0,
        ),
    ] {
        let object = format!("[[object]]\nshape = {{ {shape} }}\n");
        let [plain, turned] = ["", "reverse = true\n"].map(|reverse| {
            World::new(&scene(&format!("{object}{reverse}")).unwrap()).unwrap().surfaces.remove(0)
        });
        let exchanged = plain.surface.point_at(DVec2::new(unit + 0.5, 0.25));
        assert_eq!(turned.surface.point_at(DVec2::new(unit + 0.25, 0.5)), exchanged, "{shape}");
    }
}

/// As the documentation of `swap_uv` says.
#[test]
fn trims_are_written_as_without_swap_uv_and_all_else_counts_after() {
    let left = "loops = [{ polygon = [[0.1, 0.2], [0.4, 0.2], [0.4, 0.9], [0.1, 0.9]] }]";
    let plain = plane(left);
    let surface = |keys: &str| {
        let text = plain.replace("shape =", &format!("{keys}\nshape ="));
        World::new(&scene(&text).unwrap()).unwrap().surfaces.remove(0).surface
    };
    let as_written = surface("");
    let place = DVec2::new(0.25, 0.85);
    let both = "swap_uv = true\nreverse = true";
    for (keys, there, side) in [
        ("swap_uv = true", DVec2::new(0.85, 0.25), DVec3::NEG_Z),
        // Exchanged first: it then runs backwards in what was v.
        (both, DVec2::new(1.0 - 0.85, 0.25), DVec3::Z),
    ] {
        let turned = surface(keys);
        assert_eq!(turned.point_at(there), as_written.point_at(place), "{keys}");
        assert_eq!(turned.normal(there), Some(side), "{keys}");
        let sheet = turned.trimmed().unwrap();
        assert!(sheet.keeps(there) && !sheet.keeps(place), "{keys}");
        // What runs backwards is rounded, what is exchanged is not.
        let [kept, expected] = [&turned, &as_written].map(Surface::extent);
        let off = (kept.min - expected.min).abs().max((kept.max - expected.max).abs());
        let allowed = if keys == both { 1e-15 } else { 0.0 };
        assert!(off.max_element() <= allowed, "{keys}: {off}");
    }
    let line = "[[object]]\nshape.iso_curves = { of = 'sheet', u = [0.85], radius = 0.01 }";
    let swapped = plain.replace("shape =", "swap_uv = true\nshape =");
    assert!(World::new(&scene(&format!("{swapped}{line}")).unwrap()).is_ok());
    assert!(error(&format!("{plain}{line}")).contains("the line u = 0.85 lies where trims keep"));
}

#[test]
fn either_key_exchanges_u_and_v_of_triangles_and_unit_squares_and_both_do_nothing() {
    for (shape, unit) in [
        ("triangle = { degree = 1, points = [[0, 0, 0], [0, 1, 0], [1, 0, 0]] }", 0.0),
        (
            "catmull_clark = { points = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], \
             [0, 1, 0]], faces = [[0, 1, 4, 5], [1, 2, 3, 4]] }",
            1.0,
        ),
    ] {
        let surface = |keys: &str| {
            let text = format!("[[object]]\nshape = {{ {shape} }}\n{keys}");
            World::new(&scene(&text).unwrap()).unwrap().surfaces.remove(0).surface
        };
        let [plain, swapped] = ["", "swap_uv = true"].map(surface);
        let [uv, vu] = [[0.5, 0.25], [0.25, 0.5]].map(|[u, v]| DVec2::new(unit + u, v));
        assert_eq!(swapped.point_at(vu), plain.point_at(uv), "{shape}");
        assert_eq!(swapped.normal(vu), plain.normal(uv).map(|normal| -normal), "{shape}");
        assert_eq!(swapped, surface("reverse = true"), "{shape}");
        assert_eq!(surface("swap_uv = true\nreverse = true"), plain, "{shape}");
    }
}

/// The parameters of the documents, by their own formulas: Eberly's octant and the rows of his
/// table 2, and the net of the OpenGL books, whose u runs along the inner index.
#[test]
fn swapped_shapes_have_the_parameters_of_their_sources() {
    let surface = |shape: &str| {
        let text = format!("[[object]]\nshape = '{shape}'\nswap_uv = true");
        World::new(&scene(&text).unwrap()).unwrap().surfaces.remove(0).surface
    };
    let bernstein = |t: f64| {
        let s = 1.0 - t;
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    let (octant, hemisphere, deck) =
        (surface("octant"), surface("hemisphere"), surface("deck_patch"));
    let third = 1.0 / 3.0;
    // Rows of table 2 are those of v, columns those of u; x, y, z and the weight.
    let table = [1.0, -1.0].map(|z| {
        let pole = [1.0, third, third, 1.0].map(|w| [0.0, 0.0, z, w]);
        let belt = [[2.0, 0.0, z, third], [2.0, 4.0, z, 1.0 / 9.0]];
        let [[x0, y0, ..], [x1, y1, ..]] = belt;
        (pole, [belt[0], belt[1], [-x1, y1, z, 1.0 / 9.0], [-x0, y0, z, third]])
    });
    let [(north, upper), (south, lower)] = table;
    let table = [north, upper, lower, south];
    let heights: [[f64; 4]; 4] = [
        [4.0, 2.0, -1.0, 2.0],
        [1.0, 3.0, 0.0, -1.0],
        [4.0, 0.0, 3.0, 4.0],
        [-2.0, -2.0, 0.0, -1.0],
    ];
    for k in 0..=24 {
        let (u, v) = (f64::from(k % 5) / 4.0, f64::from(k / 5) / 4.0);
        let uv = DVec2::new(u, v);
        let over = (1.0 + u * u) * (1.0 + v * v);
        let (ru, rv) = (1.0 - u * u, 1.0 - v * v);
        let note = DVec3::new(ru * rv, ru * 2.0 * v, 2.0 * u * (1.0 + v * v)) / over;
        assert!(octant.point_at(uv).distance(note) < 1e-15, "octant at {uv}");

        let (mut sum, mut weight, mut height) = (DVec3::ZERO, 0.0, 0.0);
        for (i, of_v) in bernstein(v).into_iter().enumerate() {
            for (j, of_u) in bernstein(u).into_iter().enumerate() {
                let [x, y, z, w] = table[i][j];
                sum += of_v * of_u * w * DVec3::new(x, y, z);
                weight += of_v * of_u * w;
                height += of_v * of_u * heights[i][j];
            }
        }
        assert!(hemisphere.point_at(uv).distance(sum / weight) < 1e-15, "hemisphere at {uv}");
        let graph = DVec3::new(3.0 * u - 1.5, 3.0 * v - 1.5, height);
        assert!(deck.point_at(uv).distance(graph) < 1e-14, "deck_patch at {uv}");
    }
}

#[test]
fn trims_that_cannot_be_are_named() {
    for (trims, message) in [
        ("keep = 'inside'", "4:1: missing key \"loops\""),
        (
            "loops = []",
            "4:1: surface \"sheet\": trims: there are no loops: a surface that is not trimmed needs no trims",
        ),
        ("keep = 'both'\nloops = []", "5:8: unknown name \"both\"; known: inside, outside"),
        (
            "loops = [\n  { circle = { center = [0.5, 0.5], radius = 0.2 } },\n  { circle = { center = [0.6, 0.5], radius = 0.2 } },\n]",
            "7:3: surface \"sheet\": trims: loops 0 and 1 cross at (u, v) = (0.5",
        ),
        (
            "loops = [{ curves = [\n  { polyline = [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9]] },\n  { polyline = [[0.9, 0.8], [0.1, 0.1]] },\n] }]",
            "7:3: surface \"sheet\": trims: loop 0: the loop is open: curve 0 ends at (0.9, 0.9), but curve 1 begins at (0.9, 0.8), (0, -0.1) away",
        ),
        (
            "loops = [{ curves = [\n  { polyline = [[0.1, 0.1], [0.9, 0.1]] },\n  { bezier = [[0.9, 0.1]] },\n] }]",
            "7:3: surface \"sheet\": trims: loop 0, curve 1: 1 point: at least 2 are needed",
        ),
        (
            "loops = [{ curves = [{ polyline = [[0, 0, 0], [1, 0, 2]] }] }]",
            "5:22: surface \"sheet\": trims: loop 0, curve 0: control point 1 has z = 2: a trim curve lies in the plane z = 0",
        ),
        (
            "loops = [{ curves = [{ polyline = [[0, 0.25], [1, 0.25]] }] }]",
            "5:22: surface \"sheet\": trims: loop 0: the loop is open: it runs once across the domain in u, from (0, 0.25) to (1, 0.25), and which side of it is meant is not known; lead it back through (1, 0) and (0, 0) for the one side, through (1, 1) and (0, 1) for the other, or along a second such line for the band between the two",
        ),
        (
            "loops = [{ curves = [\n  { polygon = [[0.5, 1], [0.25, 0.5]] },\n  { polyline = [[0.25, 0.5], [0.5, 0]] },\n] }]",
            "6:3: surface \"sheet\": trims: loop 0: the loop is open: it runs once across the domain in v, from (0.5, 1) to (0.5, 0), and which side of it is meant is not known; lead it back through (0, 0) and (0, 1) for the one side, through (1, 0) and (1, 1) for the other, or along",
        ),
        (
            "loops = [{ polyline = [[0, 0], [1, 1], [1, 0], [0, 1]] }]",
            "5:10: surface \"sheet\": trims: loop 0 crosses itself at (u, v) = (0.5, 0.5)",
        ),
        (
            "loops = [{ polygon = [[0, 0], [1, 1], [1, 0], [0, 1]] }]",
            "5:10: surface \"sheet\": trims: loop 0 crosses itself at (u, v) = (0.5, 0.5)",
        ),
        (
            "loops = [{ circle = { center = [5, 5], radius = 1 } }]",
            "5:10: surface \"sheet\": trims: loop 0 lies on (4, 4) to (6, 6): no part of it is inside \
             the domain (0, 0) to (1, 1)",
        ),
        (
            "loops = [\n  { circle = { center = [0.5, 0.5], radius = 0.1 } },\n  { polygon = [[0.2, 0.2], [2e9, 0.5], [0.2, 0.8]] },\n]",
            "7:3: surface \"sheet\": trims: loop 1 reaches u = 2000000000, too far from the domain, 0 to 1: at most 1e9 times its length is supported; cut the loop off nearer to it",
        ),
        (
            "loops = [{ polygon = [[-1, -1], [2, -1], [2, 2], [-1, 2]] }]\nkeep = 'outside'",
            "4:1: surface \"sheet\": trims: they keep no part of the surface",
        ),
        (
            "loops = [{ polygon = [[0, 0], [1, 0], [1, 1], [0, 1]] }]\nkeep = 'outside'",
            "4:1: surface \"sheet\": trims: they keep no part of the surface",
        ),
        (
            "loops = [{ curves = [{ polygon = [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9]] }] }]",
            "5:22: surface \"sheet\": trims: loop 0: the loop is open: curve 0 ends at (0.9, 0.9), but curve 0 begins at (0.1, 0.1), (-0.8, -0.8) away; gaps up to (0.0008, 0.0008) are closed (one curve alone must end where it begins; only a loop { polygon = … }, not one of curves, closes by itself)",
        ),
        (
            "loops = [{ polygon = [[0, 0, 0]] }]",
            "5:23: found a list of 3 numbers, needed two numbers, [u, v]",
        ),
        (
            "loops = [{ ring = 1 }]",
            "5:12: unknown loop \"ring\"; known: polygon, polyline, circle, curves",
        ),
        ("loops = [{ circle = { radius = 1 } }]", "5:21: missing key \"center\""),
    ] {
        let found = error(&plane(trims));
        assert!(found.starts_with(&format!("s.toml:{message}")), "{found}\ns.toml:{message}");
    }
}

#[test]
fn trims_cut_one_surface() {
    let tube = "shape = { tube = { curve = { polyline = [[0, 0, 0], [1, 0, 0]] }, radius = 0.1 } }";
    let trims = "trims = { loops = [{ circle = { center = [0.5, 0.5], radius = 0.2 } }] }";
    assert_eq!(
        error(&format!("[[object]]\nname = 'rod'\n{tube}\n{trims}")),
        "s.toml:4:9: object \"rod\": trims cut one surface, and here are 3"
    );
    let octant = "shape = { octant_quartic = { radius = 1 } }";
    assert_eq!(
        error(&format!("[[object]]\nname = 'o'\n{octant}\n{trims}")),
        "s.toml:4:9: object \"o\": trims cut NURBS surfaces, and this is a triangular patch"
    );
}

#[test]
fn a_seam_is_found() {
    let text = "[[object]]\nshape = 'cylinder'\n[object.trims]\nkeep = 'outside'\n\
                loops = [{ polygon = [[-0.1, 0.2], [0.1, 0.2], [0.1, 0.8], [-0.1, 0.8]] }]\n";
    let world = World::new(&scene(text).unwrap()).unwrap();
    let side = world.surfaces[0].surface.trimmed().unwrap();
    for (u, kept) in [(0.0, false), (0.05, false), (0.95, false), (1.0, false), (0.5, true)] {
        assert_eq!(side.keeps(DVec2::new(u, 0.5)), kept, "{u}");
    }
}

#[test]
fn trim_edges_and_iso_curves_are_drawn_where_the_surface_is() {
    const SHEET: &str = "[[object]]\nname = 's'\nshape.plane = { width = 2, height = 2 }\n\
                         trims.loops = [{ circle = { center = [0.5, 0.5], radius = 0.25 } }]\n\
                         [[object]]\nname = 'l'\n";
    let made = |shape: &str| -> Result<World, String> {
        let text = format!("{SHEET}{shape}");
        let scene = read_scene(&text, "s.toml", &mut |_, _, _| unreachable!()).unwrap();
        World::new(&scene).map_err(|error| error.to_string())
    };
    // The edge is a circle of radius 1/2: the tube is a torus, with no caps.
    let world = made("shape.trim_curves = { of = 's', radius = 0.1 }").unwrap();
    assert_eq!(world.surfaces.len(), 2);
    let tube = &world.surfaces[1];
    let [[u0, u1], [v0, v1]] = tube.surface.domain();
    for k in 0..100 {
        let (s, t) = (f64::from(k % 10) / 9.0, f64::from(k / 10) / 9.0);
        let point = tube.surface.point_at((u0 + s * (u1 - u0), v0 + t * (v1 - v0)).into());
        let off = (point.truncate().length() - 0.5).hypot(point.z) - 0.1;
        assert!(off.abs() <= tube.deviation + 1e-14, "{point}: {off:e} of {:e}", tube.deviation);
    }

    // From end to end of the disk, round caps included.
    let world = made("shape.iso_curves = { of = 's', u = [0.5], radius = 0.1 }").unwrap();
    let reach = world.surfaces[1..].iter().flat_map(|one| {
        let [[u0, u1], [v0, v1]] = one.surface.domain();
        [(u0, v0), (u0, v1), (u1, v0), (u1, v1)].map(|at| one.surface.point_at(at.into()).y.abs())
    });
    let reach = reach.fold(0.0, f64::max);
    assert!((0.5 - 1e-12..=0.6 + 1e-12).contains(&reach), "{reach}");

    let error = made("shape.iso_curves = { of = 's', u = [0.5, 0.1], radius = 0.1 }").unwrap_err();
    assert_eq!(
        error,
        "s.toml:7:36: surface \"l\": the line u = 0.1 lies where trims keep nothing, or where \
         the surface has ended"
    );
    let bare = "[[object]]\nname = 'b'\nshape = 'deck_patch'\n\
                [[object]]\nname = 'l'\nshape.trim_curves = { of = 'b', radius = 0.1 }\n";
    let scene = read_scene(bare, "s.toml", &mut |_, _, _| unreachable!()).unwrap();
    assert_eq!(
        World::new(&scene).unwrap_err().to_string(),
        "s.toml:6:1: surface \"l\": there are no trim edges to draw: no surface of that object is \
         trimmed"
    );
}

/// A cylinder between two lines once around it: the part of the seam that is kept is no edge.
#[test]
fn a_band_around_a_cylinder_is_cut_along_two_lines_and_the_seam() {
    let text = "[[object]]\nshape.cylinder = { radius = 1, height = 2 }\n\
                trims.loops = [{ polygon = [[0, 0.25], [1, 0.25], [1, 0.75], [0, 0.75]] }]\n";
    let scene = read_scene(text, "s.toml", &mut |_, _, _| unreachable!()).unwrap();
    let world = World::new(&scene).unwrap();
    let mut tracer = world.bvh.tracer();
    let mut hits = Vec::new();
    for k in 0..=64 {
        // Over heights from 0 to 2, through the axis, in the plane of the seam too.
        let z = f64::from(k) / 32.0;
        for direction in [DVec3::X, DVec3::NEG_X, DVec3::new(0.6, 0.8, 0.0)] {
            let ray = Ray::new(-5.0 * direction + z * DVec3::Z, direction).unwrap();
            let _ = tracer.all_hits(&Query::primary(ray), &mut hits);
            let kept = (0.5..=1.5).contains(&z);
            // Hits on both sides of the seam are one crossing.
            let places: Vec<i64> = hits.iter().map(|hit| hit.t.round() as i64).collect();
            let expected: &[i64] = if kept { &[4, 6] } else { &[] };
            let mut met = places.clone();
            met.dedup();
            assert_eq!(met, expected, "{direction}, z = {z}: {places:?}");
            // The loop runs along the seam, too, though nothing is cut there: hits are at a border,
            // also on the leaves that the other sides pass through.
            for hit in &hits {
                let at_edge = hit.flags.contains(HitFlags::TRIM_EDGE);
                let at_seam = hit.point.y.abs() < 1e-15 && hit.point.x > 0.0;
                let is_cut = z == 0.5 || z == 1.5;
                assert_eq!(at_edge, is_cut, "{direction}, z = {z}");
                assert_eq!(hit.flags.contains(HitFlags::BORDER), at_seam, "{direction}, z = {z}");
            }
        }
    }
}

#[test]
fn what_little_is_kept_is_what_the_camera_shows() {
    let text = r#"
[[object]]
shape = { plane = { width = 4, height = 4 } }
[object.trims]
keep = "inside"
loops = [ { circle = { center = [0.25, 0.75], radius = 0.0005 } } ]
"#;
    let world = World::new(&scene(text).unwrap()).unwrap();
    let view = world.camera.view();
    // A disc of radius 0.002.
    assert!(view.look_at.distance(DVec3::new(-1.0, 1.0, 0.0)) < 1e-5, "{view:?}");
    assert!((0.002..0.02).contains(&view.look_from.distance(view.look_at)), "{view:?}");
}
