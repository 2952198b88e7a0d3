//! What is written, and why the rest is left out.

use super::*;
use crate::io::read_scene;

fn written(text: &str) -> PovrayScene {
    let scene = read_scene(text, "test.toml", &mut |_, _, _| unreachable!()).unwrap();
    let world = World::new(&scene).unwrap();
    povray_scene(&scene, &world, [200, 100], 0.01)
}

/// The numbers of the only `what <…>` in a text.
fn numbers(text: &str, what: &str) -> Vec<f64> {
    let rest = text.split(&format!("{what} <")).nth(1).unwrap();
    let list = rest.split('>').next().unwrap();
    list.split(',').map(|number| number.trim().parse().unwrap()).collect()
}

/// An object with a net of its own.
fn net(degree: &str, points: &str, more: &str) -> String {
    let keys = format!("degree = {degree}\npoints = {points}\n{more}\n");
    format!("[[object]]\nname = \"sail\"\n[object.shape.nurbs]\n{keys}")
}

fn points(rows: i32, columns: i32) -> String {
    let row = |i: i32| {
        let points = (0..columns).map(|j| format!("[{i}, {j}, {}]", i * j * j % 7));
        format!("[{}]", points.collect::<Vec<_>>().join(", "))
    };
    format!("[{}]", (0..rows).map(row).collect::<Vec<_>>().join(", "))
}

const PLANE: &str = "[[object]]\nname = \"table\"\nshape = { plane = { width = 3, height = 6 } }\n";

#[test]
fn cameras_are_given_by_their_vectors() {
    let camera = "[camera]\nlook_from = [0, -4, 0]\nlook_at = [0, 0, 0]\n";
    let text = written(&format!("{camera}perspective = {{ fov = 90 }}\n{PLANE}")).text;
    assert!(text.contains("  perspective\n"));
    // The plane is 6 long: a quarter of that is between 1 and 2.
    assert_eq!(numbers(&text, "location"), [0.0, -1.0, 0.0]);
    assert_eq!(numbers(&text, "direction"), [0.0, 1.0, 0.0]);
    let close = |found: Vec<f64>, expected: [f64; 3]| {
        let off = found.iter().zip(expected).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-15, "{found:?} {expected:?}");
    };
    close(numbers(&text, "right"), [4.0, 0.0, 0.0]);
    close(numbers(&text, "up"), [0.0, 0.0, 2.0]);
    assert_eq!(numbers(&text, "light_source {"), [0.0, -1.0, 0.0]);

    let text = written(&format!("{camera}orthographic = {{ height = 3 }}\n{PLANE}")).text;
    assert!(text.contains("  orthographic\n") && text.contains("shadowless parallel"));
    close(numbers(&text, "right"), [1.5, 0.0, 0.0]);
    close(numbers(&text, "up"), [0.0, 0.0, 0.75]);
    close(numbers(&text, "point_at"), [0.0, 0.0, 0.0]);
}

#[test]
fn polynomial_pieces_become_bicubic_patches() {
    let scene = written(PLANE);
    assert_eq!((scene.written.as_slice(), scene.skipped.len()), (&[0][..], 0));
    assert!(
        scene
            .text
            .contains("\n// table\nbicubic_patch { type 1 flatness 0.0025 u_steps 0 v_steps 0\n")
    );
    // Thirds of the rectangle, all sixteen, a quarter as large.
    for (x, y) in [("-0.375", "-0.75"), ("-0.125", "0.25"), ("0.375", "0.75")] {
        assert!(scene.text.contains(&format!("<{x}, {y}, 0.0>")), "{}", scene.text);
    }
    // 7 x 5 points of degrees 3 and 2: 4 x 3 pieces.
    let scene = written(&net("[3, 2]", &points(7, 5), ""));
    assert_eq!(scene.text.matches("bicubic_patch").count(), 12);
}

#[test]
fn quadrics_and_tori_stay_what_they_are() {
    let text = "
[[object]]
shape = { sphere = { radius = 2 } }
transform = [{ scale = [1, 2, 3] }, { translate = [4, 5, 6] }]
[[object]]
shape = { torus = { major = 2, minor = 0.5 } }
[[object]]
shape = { octant = { radius = 1 } }
";
    let scene = written(text);
    assert_eq!(scene.written, [0, 1, 2]);
    // All of it reaches from -2.5 to 8.25 ± 0.25, 9 and 12: an eighth is between 1 and 2. The
    // sphere's radius is halved, and its place doubled for that.
    assert!(scene.text.contains("sphere { 0, 1.0\n"));
    let matrix = numbers(&scene.text, "matrix");
    assert_eq!(matrix[..9], [0.25, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.75]);
    // From (4, 5, 6) to the torus, which is at the origin.
    let torus = numbers(scene.text.split("torus {").nth(1).unwrap(), "matrix");
    for (k, apart) in [(9, 0.5), (10, 0.625), (11, 0.75)] {
        assert!((matrix[k] - torus[k] - apart).abs() < 1e-15, "{matrix:?} {torus:?}");
    }
    assert!(scene.text.contains("torus { 1.0, 0.25 sturm rotate 90*x\n"));
    assert!(scene.text.contains("clipped_by"));
}

/// One shape may make several surfaces: those after it are still written as their own shapes.
#[test]
fn surfaces_are_written_as_what_they_were_made_of() {
    let sheet = net("[1, 1]", "[[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 1]]]", "");
    let others = "
[[object]]
name = \"wires\"
shape = { net = { of = \"sail\", radius = 0.01, joints = 0.02 } }
[[object]]
name = \"rod\"
shape = { tube = { curve = { polyline = [[0, 0], [4, 0]] }, radius = 0.2 } }
[[object]]
name = \"ball\"
shape = { sphere = { radius = 2 } }
";
    let text = format!("{sheet}{others}{PLANE}");
    let scene = read_scene(&text, "test.toml", &mut |_, _, _| unreachable!()).unwrap();
    let world = World::new(&scene).unwrap();
    let povray = povray_scene(&scene, &world, [200, 100], 0.01);
    let names: Vec<&str> = povray.written.iter().map(|&k| &*world.surfaces[k].name).collect();
    assert_eq!(names, ["sail", "ball", "table"]);
    let body = |name: &str| {
        let rest = povray.text.split(&format!("// {name}\n")).nth(1).unwrap();
        rest.split_whitespace().next().unwrap().to_owned()
    };
    let bodies: Vec<String> = names.iter().map(|name| body(name)).collect();
    assert_eq!(bodies, ["bicubic_patch", "sphere", "bicubic_patch"]);
    // Nothing is dropped: four lines, four points, a rod and its two caps.
    assert_eq!(povray.skipped.len(), 11);
    assert!(povray.skipped.iter().all(|skip| skip.reason == PovrayGap::Rational));
}

#[test]
fn scenes_of_any_size_are_written_alike() {
    let scene = |size: f64| {
        let length = |factor: f64| factor * size;
        written(&format!(
            "[camera]\nlook_from = [{:e}, 0, {:e}]\nlook_at = [0, 0, 0]\n\
             [[object]]\nshape = {{ sphere = {{ radius = {:e} }} }}\n\
             transform = [{{ translate = [{:e}, 0, 0] }}]\n\
             [[object]]\nshape = {{ cone = {{ radius = {:e}, height = {:e} }} }}\n",
            length(5.0),
            length(2.0),
            length(1.0),
            length(3.0),
            length(0.5),
            length(1.25)
        ))
    };
    let without_first_lines =
        |scene: PovrayScene| scene.text.lines().skip(2).collect::<Vec<_>>().join("\n");
    let plain = without_first_lines(scene(1.0));
    assert!(plain.contains("cone { 0, 0.25, <0, 0, 0.625>, 0 open"), "{plain}");
    for size in [2_f64.powi(-60), 2_f64.powi(40)] {
        assert_eq!(without_first_lines(scene(size)), plain);
    }
}

/// A ball on a floor a hundred thousand times as large, and the same seen from far away.
#[test]
fn small_things_in_large_scenes_stay_large_enough() {
    let scale = |away: f64| {
        let text = written(&format!(
            "[camera]\nlook_from = [0, {away:e}, 1]\nlook_at = [0, 0, 0]\n\
             [[object]]\nshape = {{ plane = {{ width = 1e5, height = 1e5 }} }}\n\
             [[object]]\nshape = {{ sphere = {{ radius = 0.5 }} }}\n"
        ))
        .text;
        let middle = text.lines().nth(1).unwrap().rsplit(' ').next().unwrap().to_owned();
        middle.trim_end_matches('.').parse::<f64>().unwrap()
    };
    let near = scale(-30.0);
    assert!((LEAST / 4.0..=LEAST).contains(&near), "{near}");
    let far = scale(-1e9);
    assert!(far < near && far * 1e9 > 0.4 * FARTHEST && far * 1e9 <= FARTHEST, "{far}");
}

/// What is left out does not need to be seen.
#[test]
fn small_things_that_are_left_out_do_not_set_the_scale() {
    let speck =
        "[[object]]\nname = \"speck\"\nshape = { plane = { width = 1e-9, height = 1e-9 } }\n";
    let trims = "trims = { loops = [{ circle = { center = [0.5, 0.5], radius = 0.2 } }] }\n";
    let scale_line = |text: &str| written(text).text.lines().nth(1).unwrap().to_owned();
    let plain = scale_line(PLANE);
    assert_eq!(scale_line(&format!("{PLANE}{speck}{trims}")), plain);
    assert_ne!(scale_line(&format!("{PLANE}{speck}")), plain);
}

#[test]
fn what_cannot_be_said_is_named() {
    let square = |more: &str| net("1", &points(2, 2), more);
    let scene = written(&format!("{PLANE}{}", square("weights = [[1, 1], [1, 2]]")));
    assert_eq!(scene.written, [0]);
    assert_eq!(
        scene.skipped[0].to_string(),
        "surface \"sail\" is left out: it is rational, and the patches of POV-Ray are polynomial"
    );
    assert!(written(&square("")).skipped.is_empty());

    let high = net("[4, 5]", &points(5, 6), "");
    let reason = PovrayGap::Degree { u: 4, v: 5 };
    assert_eq!(written(&high).skipped[0].reason, reason);
    assert_eq!(reason.to_string(), "it has degrees 4 x 5, and the patches of POV-Ray are bicubic");
}

#[test]
fn patches_that_would_be_split_without_end_are_refused() {
    let text = "[[object]]\nshape = \"lecture_patch_2\"\n";
    let scene = read_scene(text, "test.toml", &mut |_, _, _| unreachable!()).unwrap();
    let world = World::new(&scene).unwrap();
    let fine = povray_scene(&scene, &world, [9, 9], 1e-12);
    let message = fine.skipped[0].reason.to_string();
    assert!(message.starts_with("to be so flat its patches need 2"), "{message}");
    assert!(message.contains(" halvings each way: at most 10, "), "{message}");
}

#[test]
fn trimmed_surfaces_are_left_out() {
    let trims = "trims = { loops = [{ circle = { center = [0.5, 0.5], radius = 0.2 } }] }\n";
    let scene = written(&format!("{PLANE}{trims}"));
    assert!(scene.written.is_empty());
    assert_eq!(
        scene.skipped[0].to_string(),
        "surface \"table\" is left out: it is trimmed, and a patch of POV-Ray has no trims"
    );
}
