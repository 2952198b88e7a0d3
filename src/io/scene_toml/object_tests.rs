//! Nets, surfaces made from curves or drawn from others, and the errors about them.

use glam::{DVec2, DVec3};

use super::tests::{error, scene};
use crate::scene::World;

#[test]
fn what_cannot_be_made_from_curves_is_told() {
    let shape = |text: &str| error(&format!("[[object]]\nname = 'cup'\n[object.shape.{text}"));
    assert_eq!(
        shape("revolution]\nprofile = {}"),
        "s.toml:4:11: curve: needed is one, and only one, of nurbs, polyline, bezier, through, \
         bspline, catmull_rom, hermite, matrix_form, power, circle, arc, note_circle, quarter_circle_2, \
         quarter_circle_4"
    );
    assert_eq!(
        shape("revolution]\nprofile = { polyline = [[1, 0], [1, 0]] }"),
        "s.toml:4:11: surface \"cup\": profile: points 0 and 1 coincide: neighbours must differ"
    );
    assert_eq!(
        shape("revolution]\nprofile = { polyline = [[1, 0], [2, 0]] }\ndegrees = 400"),
        "s.toml:5:11: surface \"cup\": angle 400°: it must be from -360° to 360°, and not 0°"
    );
    assert_eq!(
        shape(
            "extrusion]\nprofile = { nurbs = { degree = 2, points = [[1, 0], [2, 0]] } }\nby = [0, 0, 1]"
        ),
        "s.toml:4:44: surface \"cup\": profile: 2 points of degree 2: at least 3 are needed"
    );
    let weighted = |weights: &str| {
        let points = "degree = 1, points = [[1, 0], [2, 0]]";
        shape(&format!(
            "extrusion]\nby = [0, 0, 1]\nprofile = {{ nurbs = {{ {points},\nweights = {weights} }} }}"
        ))
    };
    let wanted = "it must be positive and finite (from 1e-70 to 1e70)";
    assert_eq!(
        weighted("[1,\n-1]"),
        format!(
            "s.toml:7:1: surface \"cup\": profile: the weight of control point 1 is -1: {wanted}"
        )
    );
    assert_eq!(
        weighted("[1, 0, 1]"),
        "s.toml:6:11: surface \"cup\": profile: 3 weights for 2 control points: each needs one, or \
         none has any"
    );
    assert_eq!(
        shape("ruled]\nfrom = { circle = { radius = -1 } }\nto = { circle = { radius = 1 } }"),
        "s.toml:4:8: surface \"cup\": from: radius -1: it must be positive and finite"
    );
    let arc = |arc: &str| shape(&format!("extrusion]\nprofile = {{ {arc} }}\nby = [0, 0, 1]"));
    for (profile, message) in [
        (
            "quarter_circle_2 = { weights = [1, 1, 1] }",
            "4:11: surface \"cup\": profile: 2 w1² / (w0 w2) is 2: a circle needs 1 to within 3.6e-15",
        ),
        (
            "quarter_circle_2 = { weights = [1, 1] }",
            "4:44: found a list of 2, needed a list of 3 numbers",
        ),
        (
            "quarter_circle_4 = { solution = 1, w1 = 0.1 }",
            "4:11: surface \"cup\": profile: w1 is 0.1: solution 1 needs a weight above 0.1767766952966369 \
             (√2/8, below which the arc leaves its quadrant), up to 1e70",
        ),
        (
            "quarter_circle_4 = { weights = [1, 1], y1 = 0.5, x2 = 0.75 }",
            "4:11: surface \"cup\": profile: 4 w1² y1² + 3 w2 (x2 - 1) is 0.25: a circle needs 0 to within 1.7e-14",
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
fn a_center_is_the_first_step_of_a_circle_s_transform() {
    let arc = |keys: &str, steps: &str| {
        let profile =
            format!("{{ arc = {{ {keys} radius = 2, degrees = 90 }}, transform = [{steps}] }}");
        let text =
            format!("[[object]]\nshape.extrusion = {{ profile = {profile}, by = [0, 0, 1] }}");
        World::new(&scene(&text)).unwrap().surfaces[0].surface.point_at(DVec2::new(0.3, 0.6))
    };
    for (center, step) in [("[1, 2]", "[1, 2, 0]"), ("[1, 2, 3]", "[1, 2, 3]")] {
        assert_eq!(
            arc(&format!("center = {center},"), "{ scale = 3 }"),
            arc("", &format!("{{ translate = {step} }}, {{ scale = 3 }}"))
        );
    }
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
    assert_eq!(
        error(&format!("{ball}{}", lines.replace("'net', u = [0.5]", "'ball'"))),
        "s.toml:7:1: surface \"l\": no lines are named: give u, v or, of triangular patches, w a list of parameters"
    );
    assert_eq!(
        error(&format!("{ball}{}", lines.replace("'net', u = [0.5]", "'ball', v = [0.5, 7]"))),
        "s.toml:7:39: surface \"l\": direction v: the parameter 7 does not lie inside the domain from 0 to 1"
    );
}

/// The degree is at fault where it was written, not the knots.
#[test]
fn degrees_that_are_none_have_their_place() {
    let text = "[[object]]\nname = 'lid'\n[object.shape.nurbs]\nknots_u = [0, 0, 1, 1]\n\
        degree = [33, 1]\npoints = [[[0,0,0],[0,1,0]],[[1,0,1],[1,1,1]]]\n";
    assert_eq!(
        error(text),
        "s.toml:5:10: surface \"lid\", direction u: degree 33: degrees from 1 to 32 are supported"
    );
    let text = "[[object]]\nname = 'lid'\n[object.shape.extrusion]\nby = [0, 0, 1]\n\
        [object.shape.extrusion.profile.nurbs]\nknots = [0, 0, 1, 1]\ndegree = 0\n\
        points = [[0, 0], [1, 0]]\n";
    assert_eq!(
        error(text),
        "s.toml:7:10: surface \"lid\": profile: degree 0: degrees from 1 to 32 are supported"
    );
}

#[test]
fn an_inline_net() {
    let text = "[[object]]\nname = 'lid'\n[object.shape.nurbs]\ndegree = [2, 1]\n\
        knots_v = [[0, 2], [1, 2]]\npoints = [[[0,0,0],[0,1,0]],[[1,0,1],[1,1,1]],[[2,0,0],[2,1,0]]]\n\
        weights = [[1, 1], [0.5, 0.5], [1, 1]]\n";
    let world = World::new(&scene(text)).unwrap();
    let surface = world.surfaces[0].surface.nurbs().unwrap();
    assert_eq!(world.surfaces[0].name, "lid");
    assert_eq!(surface.size(), [3, 2]);
    assert_eq!(surface.point(1, 1), Some(DVec3::ONE));
    assert_eq!(surface.weight(1, 0), Some(0.5));
    assert_eq!(surface.knots_u().values(), [0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
}

/// A closed net is the one in which the first rows are written again after the last.
#[test]
fn knots_by_name() {
    let tube = |knots: &str, rows: &str, weights: &str| {
        let text = format!(
            "[[object]]\n[object.shape.nurbs]\ndegree = [2, 1]\n{knots}\n\
             points = [{rows}]\nweights = [{weights}]"
        );
        World::new(&scene(&text)).unwrap().surfaces[0].surface.nurbs().unwrap().clone()
    };
    let [a, b, c] = ["[[1,0,0],[1,0,2]]", "[[0,1,0],[0,1,2]]", "[[-1,-1,0],[-1,-1,2]]"];
    let (once, again) = (format!("{a},{b},{c}"), format!("{a},{b},{c},{a},{b}"));
    let (weights, twice) = ("[1,1],[2,2],[1,3]", "[1,1],[2,2],[1,3],[1,1],[2,2]");
    let written = tube("knots_u = [-2, -1, 0, 1, 2, 3, 4, 5]", &again, twice);
    assert_eq!(tube("knots_u = 'periodic'", &once, weights), written);
    assert_eq!(tube("knots_u = { periodic = [0, 1, 2, 3] }", &once, weights), written);
    let uneven = tube("knots_u = { periodic = [0, 1, 3, 7] }", &once, weights);
    assert_eq!(uneven.knots_u().values(), [-6.0, -4.0, 0.0, 1.0, 3.0, 7.0, 8.0, 10.0]);
    assert_eq!(
        tube("knots_v = 'uniform'", &once, weights).knots_v().values(),
        [0.0, 1.0, 2.0, 3.0]
    );
    assert_eq!(tube("knots_u = 'clamped'", &once, weights), tube("", &once, weights));
    assert_eq!(
        tube("knots_u = 'standard'", &again, twice).knots_u().values(),
        [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]
    );

    let curve = |curve: &str| {
        format!("[[object]]\nshape = {{ tube = {{ curve = {{ {curve} }}, radius = 0.1 }} }}")
    };
    // Other programs write the repeated points, too.
    let repeats = "the last 2 control points are the first 2 again: a periodic spline repeats them \
                   by itself, leave them out";
    let net = |points: &str, degree: &str, knots: &str| {
        let nurbs = format!("degree = {degree}, {knots} = 'periodic', points = [{points}]");
        format!("[[object]]\nshape.nurbs = {{ {nurbs} }}")
    };
    let [x, y, z, w] = [[1, 0], [0, 1], [-1, 0], [0, -1]].map(|[x, y]| [[x, y, 0], [x, y, 2]]);
    let columns = [0, 1].map(|k| [x, y, z, w, x, y].map(|row| row[k]));
    assert_eq!(
        error(&net(&again, "[2, 1]", "knots_u")),
        format!("s.toml:2:65: surface \"nurbs\", direction u: {repeats}")
    );
    let columns = format!("{:?}, {:?}", columns[0], columns[1]);
    assert_eq!(
        error(&net(&columns, "[1, 2]", "knots_v")),
        format!("s.toml:2:65: surface \"nurbs\", direction v: {repeats}")
    );
    let points = "degree = 2, points = [[1, 0], [0, 1], [-1, 0], [1, 0], [0, 1]]";
    let twice = curve(&format!("nurbs = {{ {points}, knots = 'periodic' }}"));
    assert_eq!(error(&twice), format!("s.toml:2:28: surface \"tube\": curve: {repeats}"));
    // Other weights make other control points, and an apex is the same point all around.
    let weighted =
        net(&again, "[2, 1], weights = [[1, 1], [1, 1], [1, 1], [2, 1], [1, 1]]", "knots_u");
    assert_eq!(World::new(&scene(&weighted)).unwrap().surfaces.len(), 1);
    let apex = "[0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1], [0, 0, 1]";
    let base = "[1, 0], [0, 1], [-1, 0], [0, -1], [1, -1]";
    let [base, apex] = [base, apex].map(|points| {
        format!("{{ nurbs = {{ degree = 2, points = [{points}], knots = 'periodic' }} }}")
    });
    let cone = format!("[[object]]\nshape = {{ ruled = {{ from = {base}, to = {apex} }} }}");
    assert_eq!(World::new(&scene(&cone)).unwrap().surfaces.len(), 1);

    let points = "degree = 3, points = [[1, 0], [0, 1], [-1, 0], [0, -1]]";
    let tube =
        |knots: &str| World::new(&scene(&curve(&format!("nurbs = {{ {points}, {knots} }}"))));
    assert!(tube("knots = 'periodic', weights = [1, 2, 1, 2]").is_ok());
    let closed = "bspline = { points = [[1, 0], [0, 1], [-1, 0], [0, -1]], closed = true }";
    assert_eq!(
        tube("knots = 'periodic'").unwrap().surfaces.len(),
        World::new(&scene(&curve(closed))).unwrap().surfaces.len()
    );
    assert_eq!(
        error(&curve(&format!("nurbs = {{ {points}, knots = 'periodic', weights = [1, 1, 1] }}"))),
        "s.toml:2:127: surface \"tube\": curve: 3 weights for 4 control points: each needs one, or none has any"
    );
    for (knots, message) in [
        (
            "'open'",
            "2:105: found \"open\", needed a list of knots, \"clamped\", \"standard\", \"uniform\", \"periodic\" or { periodic = [...] }",
        ),
        (
            "{ periodic = [0, 1, 2] }",
            "2:105: surface \"tube\": curve: 3 knots for one period, but 4 points need 5",
        ),
        ("{ period = [0, 1, 2] }", "2:107: unknown key \"period\"; did you mean \"periodic\"?"),
        (
            "3",
            "2:105: found integer 3, needed a list of knots, \"clamped\", \"standard\", \"uniform\", \"periodic\" or { periodic = [...] }",
        ),
    ] {
        let text = curve(&format!("nurbs = {{ {points}, knots = {knots} }}"));
        assert_eq!(error(&text), format!("s.toml:{message}"));
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
            "4:10: found -1, needed a whole number from 1 to 32, or two as [u, v]",
        ),
        ("degree = 1\n".to_owned(), "3:1: missing key \"points\""),
        (
            "degree = 1\npoints = [[[0,0,0],[0,1,0]],\n [[1,0,1]]]".to_owned(),
            "6:2: surface \"lid\": row 1 of points has 1, but row 0 has 2",
        ),
        (
            "degree = 1\npoints = [[[0,0,0],[0]]]".to_owned(),
            "5:20: found a list of 1 number, needed [x, y, z], or [x, y]",
        ),
        (
            "degree = 1\npoints = [[0,0,0],[0,1,0],[1,0,0],[1,1,0]]".to_owned(),
            "5:12: found 0, needed a row of points: a net is [[[x, y, z], …], …]",
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
