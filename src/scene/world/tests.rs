//! Scenes that can be shown, and scenes that cannot.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::*;
use crate::geometry::construct::NetStyle;
use crate::geometry::{KnotError, SurfaceError};
use crate::scene::{
    CameraSpec, Construction, ImportNote, Knots, Lens, NamedShape, Net, Part, Place, Projection,
    Shape, Texture, Transform, Written,
};

fn part(shape: NamedShape) -> Part {
    let shape = Shape::Named(shape, Vec::new());
    Part { name: String::new(), place: Place::file("s.toml").at_line(3, 4), shape, trims: None }
}

fn object(shape: NamedShape) -> Object {
    let default_name = shape.name().to_owned();
    Object { default_name, parts: vec![part(shape)], ..Object::default() }
}

fn scene(objects: Vec<Object>) -> Scene {
    Scene { place: Place::file("s.toml"), objects, ..Scene::default() }
}

fn here<T>(value: T) -> Written<T> {
    Written::new(value, Place::file("s.toml").at_line(41, 7))
}

fn message(scene: &Scene) -> String {
    World::new(scene).unwrap_err().to_string()
}

#[test]
fn light_that_is_none_is_refused() {
    let ball = || vec![object(NamedShape::Sphere { radius: 1.0 })];
    let dark = Light::Ambient { radiance: [0.0; 3] };
    let lights = vec![dark, Light::Ambient { radiance: [1.0, -1.0, 1.0] }];
    assert_eq!(
        message(&Scene { lights, ..scene(ball()) }),
        "s.toml: light 1: radiance (1, -1, 1): red, green and blue \
         must be finite numbers from 0 to 3.4e38"
    );
    let background = Some([0.0, f64::NAN, 0.0]);
    assert_eq!(
        message(&Scene { background, ..scene(ball()) }),
        "s.toml: background (0, NaN, 0): red, green and blue \
         must be finite numbers from 0 to 3.4e38"
    );
    let texture = Texture::Constant([0.0, 0.0, -1.0]);
    let materials = vec![here(Material { name: "red".into(), texture })];
    assert_eq!(
        message(&Scene { materials, ..scene(ball()) }),
        "s.toml:41:7: material \"red\": color (0, 0, -1): red, green and blue must be finite numbers \
         from 0 to 3.4e38"
    );
}

#[test]
fn a_world_takes_no_light_that_is_none_later_either() {
    let mut world = World::new(&scene(vec![object(SPHERE)])).unwrap();
    let (lights, background) = (world.lights().to_vec(), world.background());
    let dark = Light::Ambient { radiance: [0.0, f64::NAN, 0.0] };
    assert_eq!(
        world.set_lights(vec![dark]).unwrap_err().to_string(),
        "light 0: radiance (0, NaN, 0): red, green and blue must be finite numbers from 0 to 3.4e38"
    );
    assert_eq!(
        world.set_background([-1.0; 3]).unwrap_err().to_string(),
        "background (-1, -1, -1): red, green and blue must be finite numbers from 0 to 3.4e38"
    );
    assert_eq!((world.lights(), world.background()), (&lights[..], background));
    let bright = Light::Ambient { radiance: [1.0; 3] };
    world.set_lights(vec![bright]).unwrap();
    world.set_background([0.5; 3]).unwrap();
    assert_eq!((world.lights(), world.background()), (&[bright][..], [0.5; 3]));
}

#[test]
fn surfaces_made_in_code_are_placed_as_written_ones_are() {
    let mut written = net_scene(bilinear());
    let turned = Transform::Rotate { axis: DVec3::X, degrees: 30.0 };
    written.objects[0].transform = vec![here(turned)];
    written.objects[0].reverse = true;
    let mut made = written.clone();
    let surface = Surface::from(bilinear().surface().unwrap());
    made.objects[0].parts = vec![Shape::from(surface).into()];
    assert_eq!(made.objects[0].point_count(), 4);
    let [made, written] = [made, written].map(|scene| scene.surfaces().unwrap());
    assert_eq!((&made[0].name, made[0].deviation, made.len()), (&written[0].name, 0.0, 1));
    assert_eq!(made[0].surface, written[0].surface);
}

#[test]
fn a_net_says_why_it_is_no_surface() {
    let net = Net { size: [2, 3], ..bilinear() };
    assert_eq!(
        net.surface().unwrap_err().to_string(),
        "4 control points, but the knots need 2 × 3 of them"
    );
}

fn bilinear() -> Net {
    let points = [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)];
    let points = points.map(|(x, y)| DVec3::new(x, y, 0.0)).to_vec();
    Net {
        degree: [1, 1].map(here),
        knots: [here(Knots::ClampedUniform), here(Knots::ClampedUniform)],
        size: [2, 2],
        points: Written::new(points, Place::file("s.toml").at_line(50, 1)),
        weights: None,
    }
}

fn net_scene(net: Net) -> Scene {
    let mut object = object(NamedShape::RedBookPatch);
    object.name = Some(here("lid".to_owned()));
    object.parts[0].shape = Shape::Net(Arc::new(net));
    scene(vec![object])
}

const SPHERE: NamedShape = NamedShape::Sphere { radius: 1.0 };

#[test]
fn transforms_apply_in_the_order_listed() {
    let mut thing = object(SPHERE);
    thing.transform = vec![
        here(Transform::Scale(DVec3::splat(2.0))),
        here(Transform::Rotate { axis: DVec3::Y, degrees: 90.0 }),
        here(Transform::Translate(DVec3::new(10.0, 0.0, 0.0))),
    ];
    let world = World::new(&scene(vec![thing])).unwrap();
    let pole = world.surfaces[0].surface.point_at(DVec2::ZERO);
    assert!((pole - DVec3::new(12.0, 0.0, 0.0)).length() < 1e-14, "{pole}");
}

#[test]
fn reverse_turns_the_normal_and_keeps_the_domain() {
    let (plain, mut turned) = (object(SPHERE), object(SPHERE));
    turned.reverse = true;
    let world = World::new(&scene(vec![plain, turned])).unwrap();
    let [plain, turned] = [&world.surfaces[0].surface, &world.surfaces[1].surface];
    assert_eq!(plain.domain(), turned.domain());
    let (left, right) = (DVec2::new(0.3, 0.2), DVec2::new(0.7, 0.2));
    let (p, q) = (plain.point_at(left), turned.point_at(right));
    assert!((p - q).length() < 1e-15);
    assert!(plain.normal(left).unwrap().dot(p) > 0.99);
    assert!(turned.normal(right).unwrap().dot(p) < -0.99);
}

#[test]
fn every_surface_gets_a_name_of_its_own() {
    let mut pair = object(SPHERE);
    pair.default_name = "sphere".into();
    pair.parts = vec![part(SPHERE), part(SPHERE), part(SPHERE)];
    pair.parts[1].name = "cap".into();
    pair.parts[2].name = "cap".into();
    let mut named = object(SPHERE);
    named.name = Some(here("sphere".into()));
    let world = World::new(&scene(vec![object(SPHERE), named, pair])).unwrap();
    let names: Vec<_> = world.surfaces.iter().map(|s| s.name.as_str()).collect();
    assert_eq!(names, ["sphere 2", "sphere", "sphere 3/0", "sphere 3/cap", "sphere 3/cap 2"]);
    assert_eq!(world.bvh.surface_count(), 5);
}

#[test]
fn what_is_made_and_drawn_is_counted() {
    let mut ball = object(SPHERE);
    ball.name = Some(here("ball".into()));
    let points = World::new(&scene(vec![ball.clone()])).unwrap().surfaces[0].surface.point_count();
    let style = NetStyle { radius: 0.01, joints: 0.02 };
    let net = Construction::Net { of: here("ball".into()), steps: 0, style };
    let mut drawing = object(SPHERE);
    drawing.default_name = "net".into();
    drawing.parts[0].shape = Shape::Built(Arc::new(net), Vec::new());
    let drawn = 30 * 18 + 14 * 45; // its lines and balls

    let scene = scene(vec![ball, drawing.clone(), drawing]);
    let fails = |limit| place_objects(&scene, limit).err().map(|error| error.to_string());
    let all = points + 2 * drawn;
    assert_eq!(fails(all), None);
    assert_eq!(
        fails(all - 1),
        Some(format!("s.toml:3:4: {all} control points in all: at most {} are supported", all - 1))
    );
    // One alone is refused before the rest of it is made.
    assert_eq!(
        fails(drawn - 1),
        Some(format!(
            "s.toml:3:4: surface \"net\": a drawing of more than {} control points: at most \
             that many are supported",
            drawn - 1
        ))
    );
}

#[test]
fn materials_by_name_and_the_default() {
    let red = Material { name: "red".into(), texture: Texture::Constant([1.0, 0.0, 0.0]) };
    let mut painted = object(SPHERE);
    painted.material = Some(here("red".into()));
    let mut scene = scene(vec![object(SPHERE), painted.clone(), object(SPHERE)]);
    scene.materials.push(here(red.clone()));
    let world = World::new(&scene).unwrap();
    let used: Vec<_> = world.surfaces.iter().map(|s| s.material).collect();
    assert_eq!(used, [1, 0, 1]);
    assert_eq!(world.materials[1].texture, Texture::Constant([0.8; 3]));

    // A scene may say what the default is.
    scene.materials.push(here(Material { name: "default".into(), ..red.clone() }));
    let world = World::new(&scene).unwrap();
    assert_eq!(world.materials.len(), 2);
    assert_eq!(world.materials[world.surfaces[0].material].texture, red.texture);

    // A material that the scene does not describe cannot be named, even if other objects use it.
    let mut plain = self::scene(vec![object(SPHERE), painted.clone()]);
    assert_eq!(
        message(&plain),
        "s.toml:41:7: object \"sphere 2\": unknown material \"red\": none is known here"
    );
    plain.objects[1].material = Some(here("default".into()));
    assert!(message(&plain).ends_with("unknown material \"default\": none is known here"));

    scene.objects[1].material = Some(here("rad".into()));
    assert_eq!(
        message(&scene),
        "s.toml:41:7: object \"sphere 2\": unknown material \"rad\"; did you mean \"red\"?"
    );
}

#[test]
fn names_are_given_once() {
    let mut first = object(SPHERE);
    first.name = Some(Written::new("lid".into(), Place::file("s.toml").at_line(2, 1)));
    let mut second = object(SPHERE);
    second.name = Some(here("lid".into()));
    assert_eq!(
        message(&scene(vec![first, second])),
        "s.toml:41:7: the object name \"lid\" is taken: it is given at 2:1"
    );
    let red = Material { name: "red".into(), texture: Texture::Constant([1.0, 0.0, 0.0]) };
    let mut scene = scene(vec![object(SPHERE)]);
    scene.materials = vec![red.clone().into(), red.into()];
    assert_eq!(message(&scene), "the material name \"red\" is taken");
}

#[test]
fn numbers_that_are_no_surface() {
    let mut net = bilinear();
    net.knots[0] = here(Knots::Values(vec![0.0, 0.0, 1.0]));
    assert_eq!(
        message(&net_scene(net)),
        "s.toml:41:7: surface \"lid\", direction u: 3 knots, but 2 points of degree 1 need 4"
    );
    let mut net = bilinear();
    net.knots[1] = here(Knots::Multiplicities(vec![(0.0, 2), (1.0, 3)]));
    let error = World::new(&net_scene(net)).unwrap_err();
    let SceneFault::Surface { error: SurfaceError::Knots { error, .. }, .. } = error.fault() else {
        panic!("{error}")
    };
    assert!(matches!(error, KnotError::Multiplicity { times: 3, .. }), "{error}");

    // A size that no list of points has, and knots that would be made for it.
    let mut net = bilinear();
    net.knots[0] = here(Knots::PeriodicUniform);
    (net.size, net.points.value) = ([usize::MAX, 0], Vec::new());
    assert_eq!(
        message(&net_scene(net)),
        "s.toml:41:7: surface \"lid\", direction u: 18446744073709551615 points: \
         at most 16777216 in one direction are supported"
    );

    let mut net = bilinear();
    net.weights = Some(here(vec![1.0, 1.0, -2.0, 1.0]));
    assert_eq!(
        message(&net_scene(net)),
        "s.toml:41:7: surface \"lid\": the weight of control point (1, 0) is -2: \
         it must be positive and finite (from 1e-70 to 1e70)"
    );
    let mut net = bilinear();
    net.points.value.fill(DVec3::ONE);
    assert_eq!(
        message(&net_scene(net)),
        "s.toml:50:1: surface \"lid\": all control points are (1, 1, 1): \
         the surface has no extent"
    );
}

#[test]
fn objects_made_in_code_have_names() {
    let shape = || Shape::Named(NamedShape::Sphere { radius: 1.0 }, Vec::new());
    let unnamed = |count: usize| Object {
        parts: (0..count).map(|_| shape().into()).collect(),
        ..Object::default()
    };
    let scene = Scene { objects: vec![unnamed(1), unnamed(2)], ..Scene::default() };
    let world = World::new(&scene).unwrap();
    let names: Vec<_> = world.surfaces().iter().map(|surface| surface.name.as_str()).collect();
    assert_eq!(names, ["object", "object 2/0", "object 2/1"]);
}

#[test]
fn other_messages() {
    assert_eq!(
        message(&scene(vec![object(NamedShape::Torus { major: 1.0, minor: 2.0 })])),
        "s.toml:3:4: surface \"torus\": minor radius 2: it must be smaller than the major \
         radius 1, else the torus meets itself"
    );
    let mut flat = object(SPHERE);
    flat.transform = vec![here(Transform::Scale(DVec3::new(1.0, 1.0, 0.0)))];
    assert_eq!(
        message(&scene(vec![flat])),
        "s.toml:41:7: object \"sphere\": scale (1, 1, 0) flattens space: no factor may be 0"
    );
    assert_eq!(
        message(&scene(vec![])),
        "s.toml: there is nothing to show: the scene has no object (write an \
         [[object]], with a shape such as \"sphere\")"
    );
    // Scenes made in code are not mended by writing TOML.
    assert_eq!(message(&Scene::default()), "there is nothing to show: the scene has no object");
    assert_eq!(
        SceneError::new(Place::default(), SceneFault::OnlyPlots).to_string(),
        "there is nothing to trace: the scene has plots, but no object"
    );
    let mut curves = scene(vec![Object::default()]);
    let note = |what: &str| ImportNote {
        place: Place::default(),
        what: what.into(),
        why: "it is a curve".into(),
    };
    curves.notes = vec![note("curve 0"), note("curve 1")];
    assert_eq!(
        message(&curves),
        "s.toml: there is no surface to show (not imported: curve 0: it is a curve; 1 more)"
    );
}

#[test]
fn a_camera_is_found_that_shows_everything_at_every_size() {
    for size in [1e-8, 1.0, 1e8] {
        for lens in [Lens::default(), Lens::Orthographic { height: None }] {
            let mut thing = object(NamedShape::Sphere { radius: size });
            thing.transform = vec![here(Transform::Translate(DVec3::new(5.0 * size, 0.0, 0.0)))];
            let mut scene = scene(vec![thing]);
            scene.camera.lens = lens;

            // Every ray through the picture's border passes the sphere by, but not by far.
            let center = DVec3::new(5.0 * size, 0.0, 0.0);
            for width in [300, 1000, 1700] {
                scene.settings.size = [width, 1000];
                let world = World::new(&scene).unwrap();
                let aspect = f64::from(width) / 1000.0;
                for film in [(0.0, 0.5), (1.0, 0.5), (0.5, 0.0), (0.5, 1.0)] {
                    let ray = world.camera.ray(DVec2::new(film.0, film.1), aspect);
                    let direction = ray.direction().normalize();
                    let miss = (center - ray.origin()).cross(direction).length() / size;
                    let widest = 1.2 * f64::max(aspect, 1.0 / aspect);
                    assert!((1.0..widest).contains(&miss), "{miss} {film:?} {aspect} {size}");
                }
            }
        }
    }
}

#[test]
fn what_the_author_says_of_the_camera_is_kept() {
    let mut scene = scene(vec![object(SPHERE)]);
    let top = DVec3::new(0.0, 0.0, 9.0);
    scene.camera = CameraSpec { look_from: Some(top.into()), ..CameraSpec::default() };
    let world = World::new(&scene).unwrap();
    assert_eq!(world.camera.view().look_from, top);
    assert!(world.camera.view().look_at.length() < 1e-15);
    assert_eq!(world.camera.up(), DVec3::Y, "seen from above, y is up");
    let fov = Lens::DEFAULT_FOV;
    assert_eq!(world.camera.projection(), Projection::Perspective { fov });

    scene.camera.place = Place::file("s.toml").at_line(1, 1);
    scene.camera.look_at = Some(here(top));
    assert_eq!(
        message(&scene),
        "s.toml:41:7: camera: look_from and look_at are the same point (0, 0, 9)"
    );
}
