//! The errors about keys, names and values that mean nothing.

use glam::{DVec2, DVec3};

use super::tests::{error, scene};
use crate::scene::{Plane, PlotKind, World};

/// A sphere, and these lines after it.
pub(super) fn with_sphere(lines: &str) -> String {
    format!("[[object]]\nshape = {{ sphere = {{}} }}\n{lines}")
}

#[test]
fn unknown_keys_and_names_get_the_nearest() {
    assert_eq!(
        error(&with_sphere("[camera]\nlook_form = [1, 2, 3]")),
        "s.toml:4:1: unknown key \"look_form\"; did you mean \"look_from\"?"
    );
    assert_eq!(
        error("[[object]]\nshape = { sphere = { radios = 1 } }"),
        "s.toml:2:22: unknown key \"radios\"; did you mean \"radius\"?"
    );
    assert_eq!(
        error("[[object]]\nshape = { shpere = {} }"),
        "s.toml:2:11: unknown shape \"shpere\"; did you mean \"sphere\"?"
    );
    assert_eq!(
        error("[[object]]\nshape = \"deck_pitch\""),
        "s.toml:2:9: unknown shape \"deck_pitch\"; did you mean \"deck_patch\"?"
    );
    assert_eq!(
        error(&with_sphere("material = \"rad\"\n[[material]]\nname = \"red\"\ncolor = 1")),
        "s.toml:3:12: object \"sphere\": unknown material \"rad\"; did you mean \"red\"?"
    );
    assert_eq!(
        error(&with_sphere("[render]\nintegrator = \"dirct\"")),
        "s.toml:4:14: unknown integrator \"dirct\"; did you mean \"direct\"?"
    );
    assert_eq!(
        error(&with_sphere("[[light]]\npiont = { position = [0, 0, 1], intensity = 1 }")),
        "s.toml:4:1: unknown light \"piont\"; did you mean \"point\"?"
    );
    assert_eq!(
        error(&with_sphere("transform = [{ scal = 2 }]")),
        "s.toml:3:16: unknown transform \"scal\"; did you mean \"scale\"?"
    );
    assert_eq!(
        error(&with_sphere("[matrial]\n")),
        "s.toml:3:2: unknown key \"matrial\"; did you mean \"material\"?"
    );
}

#[test]
fn wrong_values_say_what_is_needed() {
    for (lines, message) in [
        (
            "[camera]\nlook_from = [1, 2]",
            "4:13: found a list of 2 numbers, needed three numbers, [x, y, z]",
        ),
        ("[camera]\nup = 'z'", "4:6: found \"z\", needed three numbers, [x, y, z]"),
        ("[camera]\nlook_at = [0, nan, 0]", "4:15: found NaN, needed a finite number"),
        ("[camera]\nlook_at = [0, 1e999, 0]", "4:15: floating-point number overflowed"),
        ("[camera]\nperspective = { fov = '30' }", "4:23: found \"30\", needed a number"),
        (
            "[camera]\nperspective = { fov = 180 }",
            "4:23: camera: fov is 180: needed is an angle from 1e-6 degrees up to, not including, 180",
        ),
        (
            "[camera]\nperspective = {}\northographic = {}",
            "5:16: camera: needed is perspective or orthographic, not both",
        ),
        (
            "[camera]\nlook_from = [1, 1, 1]\nlook_at = [1, 1, 1]",
            "5:11: camera: look_from and look_at are the same point (1, 1, 1)",
        ),
        (
            "transform = [{ scale = [1, 0, 1] }]",
            "3:24: object \"sphere\": scale (1, 0, 1) flattens space: no factor may be 0",
        ),
        (
            "transform = [{ rotate = { axis = 'w', degrees = 9 } }]",
            "3:34: found \"w\", needed \"x\", \"y\", \"z\" or [x, y, z]",
        ),
        ("transform = [{ rotate = { axis = 'z' } }]", "3:25: missing key \"degrees\""),
        (
            "transform = [{ matrix = [[1, 0, 0, 0], [0, 1, 0, 0], [1, 1, 0, 0]] }]",
            "3:25: object \"sphere\": the matrix flattens space: its determinant is 0 within rounding",
        ),
        ("reverse = 1", "3:11: found integer 1, needed true or false"),
        ("swap_uv = 'v'", "3:11: found string \"v\", needed true or false"),
        (
            "[render]\nsize = [0, 600]",
            "4:8: size 0x600: a picture needs at least one pixel each way",
        ),
        (
            "[render]\nsize = [1e10, 600]",
            "4:9: found the number 10000000000, needed a whole number from 1 to 4294967295",
        ),
        (
            "[render]\nspp = 0.5",
            "4:7: found the number 0.5, needed a whole number from 1 to 4294967295",
        ),
        ("[render]\nspp = -1", "4:7: found integer -1, needed a whole number from 1 to 4294967295"),
        (
            "[figure]\nsize = [0.5, 3]",
            "4:9: found the number 0.5, needed a whole number from 1 to 4294967295",
        ),
        ("[render]\nspp = 0", "4:7: spp 0: a picture needs at least one sample a pixel"),
        ("[render]\nseed = -1", "4:8: found integer -1, needed a whole number from 0 on"),
        (
            "[light]\nambient = { radiance = 1 }",
            "3:1: there can be several of these: write [[light]]",
        ),
        (
            "[[light]]\nambient = { radiance = -1 }",
            "4:24: found -1, needed an amount of light from 0 on",
        ),
        (
            "[[light]]\nambient = { radiance = 'red' }",
            "4:24: found \"red\", needed a number, [r, g, b] or \"#rrggbb\"",
        ),
        (
            "[[light]]\ndirectional = { from = [0, 0, 0], irradiance = 1 }",
            "4:24: directional: from (0, 0, 0) is no direction",
        ),
        (
            "[[light]]",
            "3:1: found an empty table, needed a light, as in { ambient = { radiance = 0.1 } }",
        ),
        ("[[material]]\nname = 'm'", "4:8: material \"m\": needed is one of color, checker, lines"),
        (
            "[[material]]\nname = 'm'\ncolor = 1\nlines = {}",
            "6:9: material \"m\": needed is only one of color, checker, lines",
        ),
        (
            "[[material]]\nname = 'm'\nlines = { width = 2 }",
            "5:19: found 2, needed a share of a cell from 0 to 1",
        ),
        (
            "[[material]]\nname = 'm'\nlines = { count = [1.5, 2] }",
            "5:19: found a list of 2 numbers, needed a whole number from 0 on, or two as [u, v]",
        ),
        (
            "[[material]]\nname = 'm'\ncolor = 1\n[[material]]\nname = 'm'\ncolor = 1",
            "7:8: the material name \"m\" is taken: it is given at 4:8",
        ),
        (
            "[[material]]\nname = 'm'\ncolor = 'red'",
            "5:9: found \"red\", needed a number, [r, g, b] or \"#rrggbb\"",
        ),
        ("[[material]]\nname = 'm'\nlines = { width = 'x' }", "5:19: found \"x\", needed a number"),
        (
            "[[material]]\nname = 'm'\ncolor = -0.5",
            "5:9: found -0.5, needed a color, made of numbers from 0 on",
        ),
        (
            "[[material]]\nname = 'm'\nchecker = { colors = [0.5, [0, -1, 0]] }",
            "5:28: found -1, needed a color, made of numbers from 0 on",
        ),
        ("[[material]]\nname = 3", "4:8: found integer 3, needed a string"),
        ("transform = [{ translate = 3 }]", "3:28: found 3, needed three numbers, [x, y, z]"),
        ("[[object]]\nname = 'b'", "3:1: missing key \"shape\""),
        (
            "[[object]]\nshape = 'nurbs'",
            "4:9: \"nurbs\" alone says too little: write { nurbs = … }",
        ),
        (
            "[[object]]\nshape = 'pot.json'",
            "4:9: unknown shape \"pot.json\"; write { file = \"pot.json\" }",
        ),
        (
            "[[object]]\nshape = { deck_patch = { radius = 1 } }",
            "4:26: unknown key \"radius\": none is known here",
        ),
        (
            "[[object]]\nshape = { sphere = {}, cone = {} }",
            "4:9: found the keys sphere and cone, needed one: each shape needs an [[object]] of its own",
        ),
        (
            "[[object]]\nshape = { sphere = { radius = -1 } }",
            "4:31: surface \"sphere 2\": radius -1: it must be positive and finite (from 1e-70 to 1e70)",
        ),
        (
            "[[light]]\npoint = { position = [0, 0, 1], intensity = 1 }\nambient = { radiance = 1 }\n\
             directional = { from = [0, 0, 1], irradiance = 1 }",
            "3:1: found the keys point, ambient and directional, needed one: each light is a \
             [[light]] of its own",
        ),
        (
            "transform = [{ scale = 2, translate = [1, 0, 0] }]",
            "3:14: found the keys scale and translate, needed one: each transform is a table of its \
             own, [{ … }, { … }]",
        ),
        (
            "[[plot]]\nshow = { blending = 'bspline', trims = { of = 'sphere' } }",
            "4:8: found the keys blending and trims, needed one: each needs a [[plot]] of its own",
        ),
        ("[[object]]\nshape = { file = 'x.json' }", "4:18: no x.json"),
        (
            "[[object]]\nshape = { file = 'x.obj', tolerance = 1e-6 }",
            "4:9: found the keys file and tolerance, needed one: of a cage's surface, write \
             catmull_clark = { file = \"…\", tolerance = … }, or doo_sabin",
        ),
        (
            "[[object]]\nshape = { tolerance = 1e-6, file = 'x.obj' }",
            "4:11: unknown shape \"tolerance\"; write catmull_clark = { file = \"…\", tolerance = … }, \
             or doo_sabin",
        ),
    ] {
        assert_eq!(error(&with_sphere(lines)), format!("s.toml:{message}"), "{lines}");
    }
}

#[test]
fn only_plots_of_space_have_a_plane() {
    let curve = "curve = { bezier = [[0, 0], [1, 2], [2, 0]] }";
    for (kind, show, over) in [
        ("basis", "{ degree = 2, count = 4 }", "the parameter"),
        ("blending", "'bspline'", "the parameter"),
        ("derivatives", &format!("{{ {curve} }}"), "the parameter"),
        ("curvature", &format!("{{ {curve} }}"), "the parameter"),
        ("trims", "{ of = 'sphere' }", "u and v"),
    ] {
        let plot = with_sphere(&format!("[[plot]]\nshow = {{ {kind} = {show} }}\nplane = 'xz'"));
        let told = |key: &str| {
            format!(
                "a plot of {kind} is drawn over {over}, not in a plane of space: leave {key} out"
            )
        };
        assert_eq!(error(&plot), format!("s.toml:5:9: {}", told("plane")));
        let view = plot.replace("plane = 'xz'", "view = [1, -1, 1]");
        assert_eq!(error(&view), format!("s.toml:5:8: {}", told("view")));
    }
    let comb = format!("[[plot]]\nshow = {{ comb = {{ {curve} }} }}\nplane = 'xz'");
    assert_eq!(scene(&comb).plots[0].plane, Some(Plane::Xz));

    let seen = |view: &str| comb.replace("plane = 'xz'", view);
    let across = Plane::Across(DVec3::new(1.0, -1.0, 1.0));
    assert_eq!(scene(&seen("view = [1, -1, 1]")).plots[0].plane, Some(across));
    for (view, told) in [
        ("view = [0, 0, 0]", "3:8: view (0, 0, 0) is no direction: it must not be zero"),
        ("plane = 'xy'\nview = [1, 2, 3]", "4:8: both plane and view: a plot has one of them"),
    ] {
        assert_eq!(error(&seen(view)), format!("s.toml:{told}"));
    }
}

#[test]
fn derivatives_have_an_order_up_to_the_degree() {
    let plot = |kind: &str, order: &str| {
        let curve = "{ bezier = [[0, 0], [1, 2], [2, 0]] }";
        scene(&format!("[[plot]]\nshow = {{ {kind} = {{ curve = {curve}{order} }} }}"))
    };
    for kind in ["derivatives", "hodograph"] {
        for (order, expected) in [("", 1), (", order = 1", 1), (", order = 2", 2)] {
            let scene = plot(kind, order);
            let found = match scene.plots[0].checked(0, &scene).unwrap().show {
                PlotKind::Derivatives { order, .. } | PlotKind::Hodograph { order, .. } => order,
                other => panic!("{other:?}"),
            };
            assert_eq!(found.value, expected);
        }
        for order in [0, 3] {
            let scene = plot(kind, &format!(", order = {order}"));
            let told = scene.plots[0].checked(0, &scene).unwrap_err().to_string();
            let needed = "needed is 1 to 2, the degree of the curve";
            assert!(told.ends_with(&format!("order = {order}: {needed}")), "{told}");
        }
    }
}

/// The parser would accept a list of values in the order of a table's keys.
#[test]
fn lists_are_no_tables() {
    for (lines, place) in [
        ("[[object]]\nshape = { sphere = [2] }", "4:20"),
        ("[[object]]\nshape = { sphere = [] }", "4:20"),
        ("[[object]]\nshape = { deck_patch = [] }", "4:24"),
        ("[[object]]\nshape = { plane = [1, 1] }", "4:19"), // which is a name in plots
        ("[[material]]\nname = 'm'\nlines = [8]", "5:9"),
        ("[[material]]\nname = 'm'\nchecker = [8]", "5:11"),
    ] {
        let message = format!("s.toml:{place}: found a list, needed a table");
        assert_eq!(error(&with_sphere(lines)), message, "{lines}");
    }
    // What is often written so has an example.
    for (lines, message) in [
        (
            "[[light]]\nambient = [1]",
            "4:11: found a list, needed a table, as in ambient = { radiance = 0.1 }",
        ),
        (
            "[camera]\nperspective = [30]",
            "4:15: found a list, needed a table, as in perspective = { fov = 30 }",
        ),
        (
            "[camera]\northographic = [30]",
            "4:16: found a list, needed a table, as in orthographic = { height = 4 }",
        ),
        (
            "transform = [{ rotate = [0, 0, 90] }]",
            "3:25: found a list, needed a table, as in rotate = { axis = \"z\", degrees = 90 }",
        ),
        (
            "[[object]]\nshape = { nurbs = [[1, 1]] }",
            "4:19: found a list, needed a table, as in nurbs = { degree = …, points = […] }",
        ),
        (
            "[[plot]]\nshow.curves = [{ curve = { bspline = [[0, 0], [1, 1]] } }]",
            "4:38: found a list, needed a table, as in bspline = { degree = 3, points = […] }",
        ),
        (
            "trims = [{ circle = { center = [0.5, 0.5], radius = 0.1 } }]",
            "3:9: found a list, needed a table, as in trims = { loops = [{ … }] }, of a plot { of = \"…\" }",
        ),
        (
            "[[plot]]\nshow.basis = 3",
            "4:14: found integer 3, needed a table, as in basis = { degree = 3, count = 4 }",
        ),
    ] {
        assert_eq!(error(&with_sphere(lines)), format!("s.toml:{message}"), "{lines}");
    }
    for text in ["camera = [1]", "render = [1]", "object = [[1]]", "material = [[1]]"] {
        assert!(error(text).ends_with(": found a list, needed a table"), "{text}: {}", error(text));
    }
    for table in ["camera", "render"] {
        let message = format!("s.toml:3:1: there is only one of these: write [{table}]");
        assert_eq!(error(&with_sphere(&format!("[[{table}]]"))), message);
    }
    assert_eq!(
        error(&with_sphere("transform = { scale = 2 }")),
        "s.toml:3:13: found a table, needed a list: write [{ … }]"
    );
}

/// The parser would accept a table with the name as a key, too.
#[test]
fn names_are_text() {
    let needed = "needed a name in quotes, as in blending = \"bspline\"";
    for (blending, found) in [
        ("{ bezier = {} }", "found a table"),
        ("{ bezier = 3 }", "found a table"),
        ("['bezier']", "found a list"),
        ("3", "found integer 3"),
    ] {
        let message = error(&format!("[[plot]]\nshow = {{ blending = {blending} }}"));
        assert_eq!(message, format!("s.toml:2:21: {found}, {needed}"), "{blending}");
    }
    assert_eq!(
        error(&with_sphere("trims = { keep = ['inside'], loops = [] }")),
        "s.toml:3:18: found a list, needed a name in quotes, as in keep = \"inside\""
    );
}

#[test]
fn what_is_written_elsewhere_or_called_otherwise_is_told() {
    let curve = |keys: &str| format!("[[plot]]\nshow.curves = [{{ curve = {{ {keys} }} }}]");
    let points = "points = [[0, 0], [1, 2], [2, 0], [3, 1]]";
    for (text, message) in [
        (
            curve(&format!("nurbs = {{ order = 3, {points} }}")),
            "2:38: unknown key \"order\"; write degree = …, which is the order less 1",
        ),
        (
            curve(&format!("bspline = {{ knots = [0, 1], {points} }}")),
            "2:40: unknown key \"knots\"; write nurbs = { … } instead of bspline: it has knots, \
             \"uniform\" ones too",
        ),
        (
            curve(&format!("bspline = {{ weights = [1, 2, 1, 1], {points} }}")),
            "2:40: unknown key \"weights\"; write nurbs = { …, knots = \"uniform\", weights = … } \
             instead of bspline",
        ),
        (
            curve(&format!("bspline = {{ clamped = true, {points} }}")),
            "2:40: unknown key \"clamped\"; write nurbs = { … } instead of bspline: it is clamped \
             if no knots are given",
        ),
        (
            curve("file = 'rim.json'"),
            "2:28: unknown key \"file\"; write nurbs = { … }: only surfaces are read from files",
        ),
        (
            "[[object]]\nshape = { sphere = { center = [0, 0, 1] } }".into(),
            "2:22: unknown key \"center\"; write transform = [{ translate = [x, y, z] }] under \
             [[object]]",
        ),
        (
            "[[plot]]\nshow = { de_boor = { t = 1 } }".into(),
            "2:10: unknown plot \"de_boor\"; write de_casteljau = { … }: of a spline it shows de \
             Boor's algorithm",
        ),
        (
            "[[plot]]\nshow = { bernstein = 3 }".into(),
            "2:10: unknown plot \"bernstein\"; write basis = { degree = n, count = n + 1 }",
        ),
        (
            "[[plot]]\nshow = { bezier = [[0, 0], [1, 1]] }".into(),
            "2:10: unknown plot \"bezier\"; write { curves = [{ curve = { bezier = … } }] }",
        ),
        (
            "[[plot]]\nshow.curves = [{ bezier = [[0, 0], [1, 1]] }]".into(),
            "2:18: unknown key \"bezier\"; write curve = { bezier = … }",
        ),
        (
            with_sphere(&format!("trims.loops = [{{ bspline = {{ {points} }} }}]")),
            "3:18: unknown loop \"bspline\"; write { curves = [{ bspline = … }] }",
        ),
    ] {
        assert_eq!(error(&text), format!("s.toml:{message}"), "{text}");
    }
}

#[test]
fn degrees_are_whole_numbers_that_can_be_degrees() {
    let points = "points = [[0, 0], [1, 2], [2, 0]]";
    let curve = |degree: &str| {
        let nurbs = format!("nurbs = {{ degree = {degree}, {points} }}");
        format!("[[plot]]\nshow.curves = [{{ curve = {{ {nurbs} }} }}]")
    };
    let basis = |degree: &str| format!("[[plot]]\nshow.basis = {{ degree = {degree}, count = 4 }}");
    for (degree, found) in
        [("-2.0", "the number -2.0"), ("-1", "integer -1"), ("2.5", "the number 2.5")]
    {
        assert_eq!(
            error(&curve(degree)),
            format!("s.toml:2:47: found {found}, needed a whole number from 1 to 32")
        );
        assert_eq!(
            error(&basis(degree)),
            format!("s.toml:2:25: found {found}, needed a whole number from 0 to 32")
        );
    }
    for text in [curve("2.0"), basis("2.0")] {
        assert_eq!(scene(&text).plots.len(), 1);
    }
}

#[test]
fn points_are_not_homogeneous_and_stand_in_the_lists_that_are_theirs() {
    let weight = "found a list of 4 numbers, needed [x, y, z], or [x, y]: a weight stands in \
                  weights = …, and does not multiply x, y, z";
    let curve = |points: &str| {
        format!("[[plot]]\nshow.curves = [{{ curve = {{ polyline = [{points}] }} }}]")
    };
    for (text, message) in [
        (curve("[0, 0, 0, 1]"), format!("2:40: {weight}")),
        (
            curve("[[0, 0], [1, 1]]"),
            "2:40: found a list of lists, needed [x, y, z], or [x, y]".into(),
        ),
        (
            "[[object]]\nshape.nurbs = { degree = 1, points = [[[0, 0, 0, 1]]] }".into(),
            format!("2:40: {weight}"),
        ),
        (
            "[[object]]\nshape.triangle = { degree = 1, points = [[[0, 1, 0]], [[0, 0], [1, 0]]] }"
                .into(),
            "2:42: found a row in brackets, needed one list of all points: those from the corner \
             w = 1 to v = 1, then the row beside them, up to u = 1"
                .into(),
        ),
    ] {
        assert_eq!(error(&text), format!("s.toml:{message}"), "{text}");
    }
}

/// As the documentation says of curves, nets, triangles and cages alike.
#[test]
fn points_of_two_numbers_lie_in_the_plane() {
    let corners = ["[0, 0]", "[0, 1]", "[1, 0]", "[1, 1]"];
    let [a, b, c, d] = corners;
    for shape in [
        format!("nurbs = {{ degree = 1, points = [[{a}, {b}], [{c}, {d}]] }}"),
        format!("triangle = {{ degree = 1, points = [{a}, {b}, {c}] }}"),
        format!("catmull_clark = {{ points = [{a}, {c}, {d}, {b}], faces = [[0, 1, 2, 3]] }}"),
    ] {
        let flat = format!("[[object]]\nshape = {{ {shape} }}");
        let spatial = corners
            .iter()
            .fold(flat.clone(), |text, corner| text.replace(corner, &corner.replace(']', ", 0]")));
        let [flat, spatial] = [flat, spatial].map(|text| World::new(&scene(&text)).unwrap());
        let middle = DVec2::splat(0.25);
        let [flat, spatial] =
            [flat, spatial].map(|world| world.surfaces[0].surface.point_at(middle));
        assert_eq!(flat, spatial, "{shape}");
    }
}

/// The parser would accept longer lists, too.
#[test]
fn lists_have_as_many_values_as_they_need() {
    for (lines, message) in [
        (
            "[render]\nsize = [8, 6, 4]",
            "4:8: found a list of 3, needed a list of 2 whole numbers, [width, height]",
        ),
        (
            "[figure]\nsize = [8]",
            "4:8: found a list of 1, needed a list of 2 whole numbers, [width, height]",
        ),
        (
            "[render]\nsize = 800",
            "4:8: found integer 800, needed a list of 2 whole numbers, [width, height]",
        ),
        (
            "[[material]]\nname = 'm'\nchecker = { colors = [0, 1, 0.5] }",
            "5:22: found a list of 3, needed a list of 2 colors",
        ),
        (
            "transform = [{ matrix = [[1, 0, 0, 0], [0, 1, 0, 0, 7], [0, 0, 1, 0]] }]",
            "3:40: found a list of 5, needed a list of 4 numbers",
        ),
        (
            "transform = [{ matrix = [[1, 0, 0, 0], [0, 1, 0, 0]] }]",
            "3:25: found a list of 2, needed a list of 3 rows of 4 numbers",
        ),
    ] {
        assert_eq!(error(&with_sphere(lines)), format!("s.toml:{message}"), "{lines}");
    }
}

#[test]
fn errors_point_at_the_value_not_at_its_table() {
    for (lines, message) in [
        (
            "[camera]\nup = [0, 0, 0]",
            "4:6: camera: up (0, 0, 0) is no direction: it must not be zero",
        ),
        (
            "[camera]\nlook_from = [0, 0, 9]\nup = [0, 0, 1]",
            "5:6: camera: up (0, 0, 1) runs along the view (0, 0, -1): it must point another way",
        ),
        (
            "[camera]\nlook_at = [0, 0, 0]\nlook_from = [0, -1e200, 0]",
            "5:13: camera: look_from (0, -1e200, 0): coordinates must be finite, at most 1e100",
        ),
        (
            "[camera]\northographic = { height = -1 }",
            "4:27: camera: height is -1: needed is a positive length, at most 1e100",
        ),
        (
            "[[object]]\nshape = { torus = { major = 1, minor = 2 } }",
            "4:40: surface \"torus\": minor radius 2: it must be smaller than the major radius 1, \
             else the torus meets itself",
        ),
        (
            "[[object]]\nshape = { torus = { major = 0.1 } }", // the other one is a default
            "4:9: surface \"torus\": minor radius 0.3333333333333333: it must be smaller than the \
             major radius 0.1, else the torus meets itself",
        ),
        (
            "transform = [{ rotate = { axis = [0, 0, 0], degrees = 9 } }]",
            "3:34: object \"sphere\": rotate: the axis (0, 0, 0) has no direction",
        ),
        (
            "transform = [{ scale = 1e80 }]",
            "3:24: surface \"sphere\", placed by its transform: control point (0, 0) is \
             (0, 0, 1e80): coordinates must be finite (up to 1e70)",
        ),
        ("[camera]\nfov = 30", "4:1: unknown key \"fov\"; write perspective = { fov = … }"),
        (
            "[[material]]\nname = 'm'\nchecker = { count = [4, 0] }",
            "5:21: found 0, needed counts from 1 on",
        ),
        ("[camera]\nup = 1e300", "4:6: found 1e300, needed three numbers, [x, y, z]"),
        ("name = ''", "3:8: a name needs a character that is not blank"),
        ("name = ' '", "3:8: a name needs a character that is not blank"),
        ("name = '\u{a0}'", "3:8: a name needs a character that is not blank"),
        ("name = \"a\\nb\"", "3:8: a name is a single line, without control characters"),
        (
            "[render]\nseed = 99999999999999999999",
            "4:8: found integer 99999999999999999999, needed a whole number from 0 on, of at most 18 \
             digits",
        ),
    ] {
        assert_eq!(error(&with_sphere(lines)), format!("s.toml:{message}"), "{lines}");
    }
}
