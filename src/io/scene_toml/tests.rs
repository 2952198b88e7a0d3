//! What scenes say, and what is said of broken ones.

use std::cell::RefCell;

use glam::{DVec2, DVec3};

use super::*;
use crate::scene::{IntegratorKind, Projection, World};

/// Reads a scene that mentions no files.
fn read(text: &str) -> Result<Scene, LoadError> {
    read_scene(text, "s.toml", &mut |file, _, place| {
        Err(LoadError::malformed(place.clone(), format!("no {}", file.display())))
    })
}

pub(super) fn scene(text: &str) -> Scene {
    read(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// What the user is told, whichever floor notices.
pub(super) fn error(text: &str) -> String {
    match read(text) {
        Err(error) => error.to_string(),
        Ok(scene) => World::new(&scene).unwrap_err().to_string(),
    }
}

/// A sphere, and these lines behind it.
fn with_sphere(lines: &str) -> String {
    format!("[[object]]\nshape = {{ sphere = {{}} }}\n{lines}")
}

/// The TOML blocks of the module's documentation.
fn documented() -> Vec<String> {
    let mut blocks = Vec::new();
    let mut block: Option<String> = None;
    let module = include_str!("../scene_toml.rs").lines().take_while(|l| l.starts_with("//!"));
    let module = module.map(|l| l.trim_start_matches("//!").strip_prefix(' ').unwrap_or(""));
    for line in module.chain(DOCUMENTS.iter().flat_map(|text| text.lines())) {
        match (&mut block, line) {
            (None, "```toml") => block = Some(String::new()),
            (Some(_), "```") => blocks.extend(block.take()),
            (Some(text), line) => *text += &format!("{line}\n"),
            _ => {}
        }
    }
    blocks
}

/// What the documentation is made of besides the module's own.
const DOCUMENTS: [&str; 3] =
    [include_str!("from_curves.md"), include_str!("plots.md"), include_str!("trims.md")];

#[test]
fn what_the_documentation_shows_can_be_read() {
    let blocks = documented();
    assert_eq!(blocks.len(), 11);
    for text in blocks {
        let asked = RefCell::new(Vec::new());
        let scene = read_scene(&text, "doc", &mut |file, _, _| {
            asked.borrow_mut().push(file.display().to_string());
            let shape = Shape::Named(crate::scene::NamedShape::DeckPatch, Vec::new());
            let part = Part { name: "0".into(), place: Place::default(), shape, trims: None };
            Ok(Model { parts: vec![part], notes: Vec::new() })
        });
        let scene = scene.unwrap_or_else(|error| panic!("{error}\n{text}"));
        for (index, plot) in scene.plots.iter().enumerate() {
            plot.checked(index + 1, &scene).unwrap_or_else(|error| panic!("{error}\n{text}"));
        }
        assert_eq!(scene.plots.len(), text.matches("[[plot]]").count());
        if scene.objects.is_empty() {
            continue;
        }
        let world = World::new(&scene).unwrap_or_else(|error| panic!("{error}\n{text}"));
        assert!(world.surfaces.len() >= text.matches("[[object]]").count());
        assert_eq!(asked.into_inner().len(), text.matches("{ file =").count());
    }
}

#[test]
fn what_cannot_be_made_from_curves_is_told() {
    let shape = |text: &str| error(&format!("[[object]]\nname = 'cup'\n[object.shape.{text}"));
    assert_eq!(
        shape("revolution]\nprofile = {}"),
        "s.toml:4:11: curve: needed is one, and only one, of nurbs, polyline, bezier, through, \
         bspline, catmull_rom, hermite, circle, arc, note_circle, quarter_circle_2, \
         quarter_circle_4"
    );
    assert_eq!(
        shape("revolution]\nprofile = { polyline = [[1, 0], [1, 0]] }"),
        "s.toml:4:11: surface \"cup\": profile: points 0 and 1 coincide: neighbours must differ"
    );
    assert_eq!(
        shape("revolution]\nprofile = { polyline = [[1, 0], [2, 0]] }\ndegrees = 400"),
        "s.toml:3:9: surface \"cup\": angle 400°: it must be from -360° to 360°, and not 0°"
    );
    assert_eq!(
        shape(
            "extrusion]\nprofile = { nurbs = { degree = 2, points = [[1, 0], [2, 0]] } }\nby = [0, 0, 1]"
        ),
        "s.toml:4:44: surface \"cup\": profile: 2 points of degree 2: at least 3 are needed"
    );
    assert_eq!(
        shape("ruled]\nfrom = { circle = { radius = -1 } }\nto = { circle = { radius = 1 } }"),
        "s.toml:4:8: surface \"cup\": from: radius -1: it must be positive and finite"
    );
    let arc = |arc: &str| shape(&format!("extrusion]\nprofile = {{ {arc} }}\nby = [0, 0, 1]"));
    for (profile, message) in [
        (
            "quarter_circle_2 = { weights = [1, 1, 1] }",
            "4:11: surface \"cup\": profile: 2 w1² / (w0 w2) is 2: a circle needs 1",
        ),
        ("quarter_circle_2 = { weights = [1, 1] }", "4:44: found a list of 2, needed a list of 3"),
        (
            "quarter_circle_4 = { solution = 1, w1 = 0.1 }",
            "4:11: surface \"cup\": profile: w1 is 0.1: solution 1 needs a weight above 0.176777 \
             (√2/8, below which the arc leaves its quadrant), up to 1e70",
        ),
        (
            "quarter_circle_4 = { weights = [1, 1], y1 = 0.5, x2 = 0.75 }",
            "4:11: surface \"cup\": profile: 4 w1² y1² + 3 w2 (x2 - 1) is 0.25: a circle needs 0",
        ),
        (
            "quarter_circle_4 = { weights = [1, 1], y1 = 0.5 }",
            "4:11: quarter_circle_4: needed is solution = 1 or 2, with w1 if it is not 1; or all of \
             weights = [w1, w2], y1 and x2",
        ),
        (
            "hermite = { points = [[0, 0], [1, 0]], derivatives = [[1, 0]] }",
            "4:11: surface \"cup\": profile: 1 derivative for 2 points: each needs one",
        ),
    ] {
        assert_eq!(arc(profile), format!("s.toml:{message}"));
    }
    assert_eq!(
        shape("loft]\nsections = [{ polyline = [[1, 0], [2, 0]] }]"),
        "s.toml:3:9: surface \"cup\": 1 section: degree 1 across needs at least 2"
    );
    assert_eq!(
        shape("ruled]\nfrom = { circle = { radius = 1 } }\nto = { polyline = [[1]] }"),
        "s.toml:5:20: found a list of 1 number, needed [x, y, z], or [x, y]"
    );
}

#[test]
fn nets_are_drawn_of_objects_that_have_surfaces_of_their_own() {
    let ball = "[[object]]\nname = 'ball'\nshape = { octant = {} }\n\
        transform = [{ translate = [0, 0, 5] }]\n";
    let net = "[[object]]\nname = 'net'\nshape.net = { of = 'ball', radius = 0.01 }\n";
    let world = World::new(&scene(&format!("{net}{ball}"))).unwrap();
    let names: Vec<_> = world.surfaces.iter().map(|surface| surface.name.as_str()).collect();
    // 3 × 3 points, of which three are the pole; 12 lines, of which two have no length.
    assert_eq!(names.len(), 1 + 7 + 10, "{names:?}");
    assert_eq!((names[17], names[1]), ("ball", "net/line 2"));
    let pole = world.surfaces.iter().find(|surface| surface.name == "net/point 3").unwrap();
    let middle = 0.5 * (pole.surface.point_at(DVec2::ZERO) + pole.surface.point_at(DVec2::Y));
    assert!(middle.distance(DVec3::new(0.0, 0.0, 6.0)) < 1e-14, "moved with the ball: {middle}");
    assert_eq!(
        error(&format!("{ball}{}", net.replace("'ball'", "'bell'"))),
        "s.toml:7:20: object \"net\": unknown object \"bell\"; did you mean \"ball\"?"
    );
    let lines =
        "[[object]]\nname = 'l'\nshape.iso_curves = { of = 'net', u = [0.5], radius = 0.1 }";
    assert_eq!(
        error(&format!("{ball}{net}{lines}")),
        "s.toml:10:27: object \"l\": \"net\" is itself drawn from another object: name that one"
    );
}

#[test]
fn the_long_example_says_what_it_means() {
    let scene = scene(&documented()[0]);
    assert_eq!(scene.background, Some([0.32, 0.38, 0.45]));
    let place = |line, column| Place::file("s.toml").at_line(line, column);
    let look_from = Written::new(DVec3::new(4.0, -7.0, 3.0), place(5, 13));
    assert_eq!(scene.camera.look_from, Some(look_from));
    let fov = Some(Written::new(30.0, place(8, 23)));
    assert_eq!(scene.camera.lens, Lens::Perspective { fov });
    assert_eq!(scene.settings, RenderDefaults { size: (800, 600), spp: 16, ..Default::default() });
    assert_eq!(
        scene.lights[1],
        Light::Point { position: DVec3::new(3.0, -2.0, 5.0), intensity: [20.0, 18.0, 15.0] }
    );
    assert_eq!(scene.lights[2], Light::Ambient { radiance: [0.05; 3] });
    let texture = |k: usize| scene.materials[k].value.texture;
    assert_eq!(texture(1), Texture::Checker { count: [8, 8], colors: [[0.7; 3], [0.3; 3]] });
    assert_eq!(
        texture(2),
        Texture::IsoLines { count: [8, 16], width: 0.06, line: [0.05; 3], base: [0.8; 3] }
    );
    let Texture::Constant([r, g, b]) = texture(0) else { panic!() };
    // sRGB 200, 102, 74 as linear light.
    assert!((r - 0.5776).abs() < 1e-4 && (g - 0.1329).abs() < 1e-4 && (b - 0.0685).abs() < 1e-4);
    assert_eq!(scene.objects[2].transform.len(), 3);
    assert_eq!(scene.objects[2].transform[0].value, Transform::Scale(DVec3::splat(0.8)));
}

#[test]
fn one_line_is_a_picture() {
    let world = World::new(&scene("object = [{ shape = { sphere = {} } }]")).unwrap();
    let ray = world.camera.ray(DVec2::splat(0.5), 1.5);
    assert!(ray.origin().cross(ray.direction()).length() < 1e-14, "it looks at the sphere");
    assert_eq!(world.settings.integrator, IntegratorKind::Direct);
    let scene = scene("object = [{ shape = 'torus' }]"); // its name says all
    assert_eq!(World::new(&scene).unwrap().surfaces[0].name, "torus");
    let scene = self::scene(
        "\u{feff}camera = { orthographic = {} }\nobject = [{ shape = \"deck_patch\" }]",
    );
    let world = World::new(&scene).unwrap();
    assert!(matches!(world.camera.projection(), Projection::Orthographic { .. }));
}

#[test]
fn an_inline_net() {
    let text = "[[object]]\nname = 'lid'\n[object.shape.nurbs]\ndegree = [2, 1]\n\
        knots_v = [[0, 2], [1, 2]]\npoints = [[[0,0,0],[0,1,0]],[[1,0,1],[1,1,1]],[[2,0,0],[2,1,0]]]\n\
        weights = [[1, 1], [0.5, 0.5], [1, 1]]\n";
    let world = World::new(&scene(text)).unwrap();
    let surface = world.surfaces[0].surface.nurbs().unwrap();
    assert_eq!(world.surfaces[0].name, "lid");
    assert_eq!(surface.size(), (3, 2));
    assert_eq!(surface.point(1, 1), DVec3::ONE);
    assert_eq!(surface.weight(1, 0), 0.5);
    assert_eq!(surface.knots_u().values(), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
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
        (
            "[render]\nsize = [0, 600]",
            "4:8: size 0x600: a picture needs at least one pixel each way",
        ),
        (
            "[render]\nsize = [1e9, 600]",
            "4:9: found the number 1000000000, needed a whole number from 0 to 4294967295",
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
            "4:26: unknown key \"radius\"; there is none",
        ),
        (
            "[[object]]\nshape = { sphere = {}, cone = {} }",
            "4:9: found several keys, needed a shape, as in { sphere = { radius = 1 } }",
        ),
        (
            "[[object]]\nshape = { sphere = { radius = -1 } }",
            "4:31: surface \"sphere 2\": radius -1: it must be positive and finite (from 1e-70 to 1e70)",
        ),
        ("[[object]]\nshape = { file = 'x.json' }", "4:18: no x.json"),
    ] {
        assert_eq!(error(&with_sphere(lines)), format!("s.toml:{message}"), "{lines}");
    }
}

/// A list of values in the order of a table's keys would do for the parser.
#[test]
fn lists_are_no_tables() {
    for (lines, place) in [
        ("[[object]]\nshape = { sphere = [2] }", "4:20"),
        ("[[object]]\nshape = { sphere = [] }", "4:20"),
        ("[[object]]\nshape = { deck_patch = [] }", "4:24"),
        ("[[object]]\nshape = { nurbs = [[1, 1]] }", "4:19"),
        ("transform = [{ rotate = ['z', 10] }]", "3:25"),
        ("[[light]]\nambient = [1]", "4:11"),
        ("[[material]]\nname = 'm'\nlines = [8]", "5:9"),
        ("[[material]]\nname = 'm'\nchecker = [8]", "5:11"),
        ("[camera]\nperspective = [30]", "4:15"),
        ("[camera]\northographic = [30]", "4:16"),
    ] {
        let message = format!("s.toml:{place}: found a list, needed a table");
        assert_eq!(error(&with_sphere(lines)), message, "{lines}");
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

/// Longer lists would do for the parser, too.
#[test]
fn lists_have_as_many_values_as_they_need() {
    for (lines, message) in [
        ("[render]\nsize = [8, 6, 4]", "4:8: found a list of 3, needed a list of 2"),
        ("[render]\nsize = [8]", "4:8: found a list of 1, needed a list of 2"),
        ("[render]\nsize = 800", "4:8: found integer 800, needed a list of 2"),
        (
            "[[material]]\nname = 'm'\nchecker = { colors = [0, 1, 0.5] }",
            "5:22: found a list of 3, needed a list of 2",
        ),
        (
            "transform = [{ matrix = [[1, 0, 0, 0], [0, 1, 0, 0, 7], [0, 0, 1, 0]] }]",
            "3:40: found a list of 5, needed a list of 4",
        ),
        (
            "transform = [{ matrix = [[1, 0, 0, 0], [0, 1, 0, 0]] }]",
            "3:25: found a list of 2, needed a list of 3",
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
        ("name = ''", "3:8: a name needs a letter at least"),
        ("name = \"a\\nb\"", "3:8: a name is a single line, without control characters"),
        (
            "[render]\nseed = 99999999999999999999",
            "4:8: found integer 99999999999999999999, needed a whole number from 0 on",
        ),
    ] {
        assert_eq!(error(&with_sphere(lines)), format!("s.toml:{message}"), "{lines}");
    }
}

#[test]
fn broken_nets() {
    let net = |keys: &str| format!("[[object]]\nname = 'lid'\n[object.shape.nurbs]\n{keys}");
    let points = "points = [[[0,0,0],[0,1,0]],[[1,0,1],[1,1,1]]]\n";
    for (keys, message) in [
        (
            format!("degree = 1\nknots_u = [0, 0, 1]\n{points}"),
            "5:11: surface \"lid\", direction u: 3 knots, but 2 points of degree 1 need 4",
        ),
        (
            format!("degree = 1\nknots_v = [[0, 2], [1, 1000000000000]]\n{points}"),
            "5:11: surface \"lid\", direction v: knot 1 is repeated 1000000000000 times: degree 1 allows up to 2",
        ),
        (
            format!("degree = 1\nknots_u = [[0, 2], 1]\n{points}"),
            "5:11: knots are listed either all as numbers or all as [knot, times]",
        ),
        (
            format!("degree = 1\nknots_u = [[0, 3.5], [1, 2]]\n{points}"),
            "5:12: found 3.5 as the times of a knot, needed [knot, times] with a whole number from 1 on",
        ),
        (
            format!("degree = 1\nknots_u = [[0, 2], [1, -3]]\n{points}"),
            "5:20: found -3 as the times of a knot, needed [knot, times] with a whole number from 1 on",
        ),
        (
            format!("degree = 1\nknots_u = [0, 0, inf, inf]\n{points}"),
            "5:18: found inf, needed a finite number",
        ),
        (
            format!("degree = 1\nknots_u = [0, 1, 0.5, 2]\n{points}"),
            "5:11: surface \"lid\", direction u: knot 2 is 0.5 after 1: knots must not decrease",
        ),
        (
            format!("degree = 5\n{points}"),
            "5:10: surface \"lid\", direction u: 2 points of degree 5: at least 6 are needed",
        ),
        (
            format!("degree = -1\n{points}"),
            "4:10: found -1, needed a whole number from 0 on, or two as [u, v]",
        ),
        ("degree = 1\n".to_owned(), "3:1: missing key \"points\""),
        (
            "degree = 1\npoints = [[[0,0,0],[0,1,0]],\n [[1,0,1]]]".to_owned(),
            "6:2: surface \"lid\": row 1 of points has 1, but row 0 has 2",
        ),
        (
            "degree = 1\npoints = [[[0,0,0],[0,1]]]".to_owned(),
            "5:20: found a list of 2 numbers, needed three numbers, [x, y, z]",
        ),
        (
            "degree = 1\npoints = [[[1,1,1],[1,1,1]],[[1,1,1],[1,1,1]]]".to_owned(),
            "5:10: surface \"lid\": all control points are (1, 1, 1): the surface has no extent",
        ),
        (
            format!("degree = 1\n{points}weights = [[1, 1], [0, 1]]"),
            "6:21: surface \"lid\": the weight of control point (1, 0) is 0: it must be positive and finite (from 1e-70 to 1e70)",
        ),
        (
            format!("degree = 1\n{points}weights = [[1, 1], [1, nan]]"),
            "6:24: surface \"lid\": the weight of control point (1, 1) is NaN: it must be positive and finite (from 1e-70 to 1e70)",
        ),
        (
            format!("degree = 1\n{points}weights = [[1, 1], [1, 1e300]]"),
            "6:24: surface \"lid\": the weight of control point (1, 1) is 1e300: it must be positive and finite (from 1e-70 to 1e70)",
        ),
        (
            "degree = 1\npoints = [[[-1e308,0,0],[0,1,0]],[[1,0,1],[1e308,1,1]]]".to_owned(),
            "5:10: surface \"lid\": control point (0, 0) is (-1e308, 0, 0): coordinates must be finite (up to 1e70)",
        ),
        (
            format!("degree = 1\n{points}weights = [[1, 1]]"),
            "6:11: surface \"lid\": 1 × 2 weights for 2 × 2 points",
        ),
    ] {
        assert_eq!(error(&net(&keys)), format!("s.toml:{message}"), "{keys}");
    }
}

#[test]
fn broken_toml() {
    for (text, message) in [
        (
            "",
            "s.toml: there is nothing to show: write an [[object]], with a shape such as \"sphere\"",
        ),
        ("\u{feff}[objec]\r\n", "s.toml:1:2: unknown key \"objec\"; did you mean \"object\"?"),
        ("a = ", "s.toml:1:5: string values must be quoted, expected literal string"),
        ("[[object]]\nshape = { sphere = {", "s.toml:2:21: unclosed inline table, expected \"}\""),
        ("[camera]\nup = [0, 0", "s.toml:2:11: unclosed array, expected \"]\""),
        ("[camera]\nup = [0, 0, 1]\nup = [0, 0, 1]", "s.toml:3:1: key \"up\" is given twice"),
        ("[[object]]\nname = 'x", "s.toml:2:10: invalid literal string, expected \"'\""),
    ] {
        assert_eq!(error(text), message, "{text}");
    }
    let whole = &documented()[0];
    for end in (0..whole.len()).filter(|&end| whole.is_char_boundary(end)) {
        if let Err(error) = read(&whole[..end]) {
            assert!(error.to_string().starts_with("s.toml:"), "cut at {end}: {error}");
        }
    }
    let deep = format!("a = {}", "[".repeat(1_000_000));
    assert_eq!(error(&deep), "s.toml:1:85: cannot recurse further; max recursion depth met");
}
