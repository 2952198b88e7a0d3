//! What is read from scenes, and the errors of broken ones.

use std::cell::RefCell;

use glam::{DVec2, DVec3};

use super::*;
use crate::scene::{IntegratorKind, Part, Projection, Shape, Transform, World};

/// Reads a scene that mentions no files.
fn read(text: &str) -> Result<Scene, LoadError> {
    read_scene(text, "s.toml", &mut |file, _, place| {
        Err(LoadError::malformed(place.clone(), format!("no {}", file.display())))
    })
}

pub(super) fn scene(text: &str) -> Scene {
    read(text).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// The message that the user gets, whichever layer notices the error.
pub(super) fn error(text: &str) -> String {
    match read(text) {
        Err(error) => error.to_string(),
        Ok(scene) => World::new(&scene).unwrap_err().to_string(),
    }
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

/// The files that are part of the module's documentation.
const DOCUMENTS: [&str; 3] =
    [include_str!("from_curves.md"), include_str!("plots.md"), include_str!("trims.md")];

#[test]
fn what_the_documentation_shows_can_be_read() {
    let blocks = documented();
    assert_eq!(blocks.len(), 13);
    for text in blocks {
        let asked = RefCell::new(Vec::new());
        let scene = read_scene(&text, "doc", &mut |file, _, _| {
            asked.borrow_mut().push(file.display().to_string());
            let shape = Shape::Named(crate::scene::NamedShape::RedBookPatch, Vec::new());
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
fn the_long_example_says_what_it_means() {
    let scene = scene(&documented()[0]);
    assert_eq!(scene.background, Some([0.32, 0.38, 0.45]));
    let place = |line, column| Place::file("s.toml").at_line(line, column);
    let look_from = Written::new(DVec3::new(4.0, -7.0, 3.0), place(5, 13));
    assert_eq!(scene.camera.look_from, Some(look_from));
    let fov = Some(Written::new(30.0, place(8, 23)));
    assert_eq!(scene.camera.lens, Lens::Perspective { fov });
    assert_eq!(scene.settings, RenderDefaults { size: [800, 600], spp: 16, ..Default::default() });
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
    assert_eq!(world.settings().integrator, IntegratorKind::Direct);
    let scene = scene("object = [{ shape = 'torus' }]"); // its name says all
    assert_eq!(World::new(&scene).unwrap().surfaces[0].name, "torus");
    let scene = self::scene(
        "\u{feff}camera = { orthographic = {} }\nobject = [{ shape = \"deck_patch\" }]",
    );
    let world = World::new(&scene).unwrap();
    assert!(matches!(world.camera.projection(), Projection::Orthographic { .. }));
}

#[test]
fn broken_toml() {
    for (text, message) in [
        (
            "",
            "s.toml: there is nothing to show: the scene has no object (write an \
             [[object]], with a shape such as \"sphere\")",
        ),
        ("\u{feff}[objec]\r\n", "s.toml:1:2: unknown key \"objec\"; did you mean \"object\"?"),
        (
            "a = ",
            "s.toml:1:5: found nothing, needed a value: a number, text in quotes, true or false, a \
             list or a table",
        ),
        (
            "# ä\n[[object]]\nshape = { sphere = { radius = 1,5 } }",
            "s.toml:3:35: found 1,5, needed 1.5 if it is one number, [1, 5] if it is a list",
        ),
        (
            "[[object]]\nshape = { sphere = {",
            "s.toml:2:21: the table that begins at 2:20 is not closed: needed }",
        ),
        (
            "[camera]\nup = [0, 0",
            "s.toml:2:11: the list that begins at 2:6 is not closed: needed ]",
        ),
        ("[camera]\nup = [0, 0, 1]\nup = [0, 0, 1]", "s.toml:3:1: key \"up\" is given twice"),
        (
            "[object.trims]\nloops = []\n[[object]]\nshape = 'plane'",
            "s.toml:3:3: [[object]] stands below [object] or [object.…]: write [[object]] first, and tables of its \
             own below it",
        ),
        (
            "[object]\nshape = 'plane'\n[object]\nshape = 'sphere'",
            "s.toml:3:2: [object] is given twice: write [[object]] for each",
        ),
        ("[camera]\nup = [0, 0, 1]\n[camera]", "s.toml:3:2: key \"camera\" is given twice"),
        (
            "[[object]]\nmaterial = 'a'\nmaterial = 'b'",
            "s.toml:3:1: key \"material\" is given twice",
        ),
        (
            "[[object]]\nshape = { revolve = { profile = 3 } }",
            "s.toml:2:11: unknown shape \"revolve\"; did you mean \"revolution\"?",
        ),
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
    // The parser does not say where this is.
    let deep = format!("[[object]]\nshape = 'sphere'\n[{}a]", "a.".repeat(200));
    assert_eq!(error(&deep), "s.toml: it cannot be read as TOML: recursion limit");
}
