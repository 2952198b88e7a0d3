//! What is read from geomdl files, and the errors of broken ones.

use glam::DVec3;

use super::*;
use crate::scene::{Object, Scene, World};

const SURFACE: &str = r#"{
  "name": "lid", "degree_u": 1, "degree_v": 2, "size_u": 2, "size_v": 3,
  "knotvector_u": [0, 0, 1, 1],
  "knotvector_v": [0, 0, 0, 1, 1, 1],
  "control_points": {
    "points": [[0, 0, 0], [0, 1, 1], [0, 2, 0], [1, 0, 0], [1, 1, 1], [1, 2, 0.5]],
    "weights": [1, 1, 1, 1, 2, 1]
  }
}"#;

fn model(text: &str) -> Model {
    read_geomdl(text, "m.json", "m").unwrap()
}

/// The message that the user gets, whichever layer notices the error.
fn error(text: &str) -> String {
    let model = match read_geomdl(text, "m.json", "m") {
        Ok(model) => model,
        Err(error) => return error.to_string(),
    };
    let object = Object { default_name: "m".into(), parts: model.parts, ..Object::default() };
    let place = Place::file("m.json");
    let scene = Scene { place, objects: vec![object], notes: model.notes, ..Scene::default() };
    World::new(&scene).unwrap_err().to_string()
}

/// The surface above in a `shape`, with something in it replaced.
fn changed(from: &str, to: &str) -> String {
    assert!(SURFACE.contains(from), "{from}");
    format!(
        "{{\"shape\": {{\"type\": \"surface\", \"data\": [\n{}\n]}}}}",
        SURFACE.replace(from, to)
    )
}

fn net(part: &Part) -> &Net {
    let Shape::Net(net) = &part.shape else { panic!("{part:?}") };
    net
}

/// To the last bit: an error of one unit there is within the accuracy promised for hits, but it is
/// not the number of the file.
#[test]
fn numbers_are_those_of_the_file() {
    for k in 1..400 {
        let number = (f64::from(k) * 0.618_033_988_749_894_9).fract();
        let model = model(&changed("0.5", &number.to_string()));
        let z = net(&model.parts[0]).points.value[5].z;
        assert_eq!(z.to_bits(), number.to_bits(), "{number} became {z}");
    }
}

#[test]
fn one_surface_in_every_wrapping() {
    let flat = SURFACE.replace("\"control_points\": {\n    \"points\":", "\"control_points\":");
    let flat = flat.replace("1]\n  }\n}", "1]\n}");
    for text in [
        changed("lid", "lid"),
        format!("{{\"shape\": {{\"data\": {SURFACE}}}}}"),
        format!("{{\"surfaces\": [{SURFACE}], \"order\": \"v fastest (geomdl)\"}}"),
        format!("{{\"surfaces\": [{flat}]}}"),
        format!("\u{feff}\n {SURFACE}\n"),
    ] {
        let model = model(&text);
        assert!(model.notes.is_empty(), "{:?}", model.notes);
        let [part] = model.parts.as_slice() else { panic!("{text}") };
        assert_eq!(part.name, "lid");
        let net = net(part);
        let degree = net.degree.each_ref().map(|degree| degree.value);
        assert_eq!((degree, net.size), ([1, 2], [2, 3]));
        assert_eq!(net.knots[1].value, Knots::Values(vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]));
        assert_eq!(net.points.value[5], DVec3::new(1.0, 2.0, 0.5));
        assert_eq!(net.weights.as_ref().unwrap().value, [1.0, 1.0, 1.0, 1.0, 2.0, 1.0]);
    }
}

#[test]
fn weights_are_optional_and_names_too() {
    let text =
        changed(",\n    \"weights\": [1, 1, 1, 1, 2, 1]", "").replace("\"name\": \"lid\",", "");
    let single = model(&text);
    assert_eq!(net(&single.parts[0]).weights, None);
    assert_eq!(single.parts[0].name, "");

    let surface = SURFACE.replace("\"name\": \"lid\",", "\"name\": \"\",");
    let pair = model(&format!("{{\"shape\": {{\"data\": [{surface}, {surface}]}}}}"));
    let names: Vec<_> = pair.parts.iter().map(|part| part.name.as_str()).collect();
    assert_eq!(names, ["0", "1"]);
}

#[test]
fn what_is_left_out_is_noted() {
    let curve = r#"{"type": "spline", "name": "rim", "degree": 2, "knotvector": [0, 1],
                    "control_points": {"points": [[0, 0, 0]]}}"#;
    let volume = r#"{"degree_u": 1, "degree_v": 1, "degree_w": 1}"#;
    let points = r#"{"type": "freeform", "points": [[0, 0, 0]]}"#;
    let plane = SURFACE.replace(
        "[[0, 0, 0], [0, 1, 1], [0, 2, 0], [1, 0, 0], [1, 1, 1], [1, 2, 0.5]]",
        "[[0, 1], [2, 3]]",
    );
    let trimmed = SURFACE.replace("\"degree_u\"", "\"reversed\": 1, \"degree_u\"");
    let weighted = SURFACE.replace("\"degree_u\"", "\"rational\": false, \"degree_u\"");
    let text = format!(
        "{{\"shape\": {{\"data\": [{curve},\n{volume},\n{points},\n{plane},\n{trimmed},\n{weighted}]}}}}"
    );
    let model = model(&text);
    assert_eq!(model.parts.len(), 2);
    let notes: Vec<_> = model.notes.iter().map(ToString::to_string).collect();
    assert_eq!(
        notes,
        [
            "m.json:1:21: curve \"m/rim\": a curve has no surface to show",
            "m.json:3:1: volume \"m/1\": volumes are not supported",
            "m.json:4:1: free-form points \"m/2\": points alone are no surface",
            "m.json:5:1: surface \"m/lid\": its points have 2 coordinates, surfaces in space need 3",
            "m.json:14:1: surface \"m/lid\": \"reversed\" left out: (u, v) and the normal stay as \
             written; reverse = true in a scene turns all surfaces of the file",
            "m.json:23:1: surface \"m/lid\": \"rational\" is false, but its weights differ: they are \
             used",
        ]
    );
    assert_eq!(
        error(&format!("{{\"shape\": {{\"data\": {curve}}}}}")),
        "m.json: there is no surface to show (not imported: curve \"m/rim\": \
         a curve has no surface to show)"
    );
}

#[test]
fn keys_that_nobody_knows_are_noted() {
    // Everything that geomdl writes is known.
    let exported = SURFACE.replace(
        "\"name\": \"lid\",",
        "\"type\": \"spline\", \"rational\": true, \"dimension\": 3, \"delta\": [0.05, 0.05], \"id\": 3,",
    );
    let trims = format!("\"trims\": {{\"count\": 3, \"data\": [{CIRCLE}, {SQUARE}, {OUTLINE}]}}");
    let exported = exported.replace("\"degree_u\"", &format!("{trims}, \"degree_u\""));
    let text =
        format!("{{\"shape\": {{\"type\": \"surface\", \"count\": 1, \"data\": [{exported}]}}}}");
    assert_eq!(model(&text).notes, []);

    let odd = SURFACE
        .replace("\"name\": \"lid\",", "\"holes\": [1, {\"weights\": 2}], \"degree\": 3,")
        .replace("\"weights\"", "\"wieghts\"")
        .replace(
            "\"degree_u\"",
            "\"trims\": [{\"points\": [[0, 0], [1, 0], [1, 1]],\n\"sense\": 1}], \"degree_u\"",
        );
    let text =
        format!("{{\"surfaces\": [{odd}, {odd}],\n\"units\": \"mm\", \"order\": \"v fastest\"}}");
    let notes: Vec<_> = model(&text).notes.iter().map(ToString::to_string).collect();
    let unknown = "no such key is known here";
    assert_eq!(
        notes,
        [
            format!("m.json:2:12: key \"holes\", 2 times: {unknown}"),
            format!("m.json:2:43: key \"degree\", 2 times: {unknown}; did you mean \"degree_u\"?"),
            format!("m.json:3:10: key \"sense\", 2 times: {unknown}"),
            format!("m.json:8:16: key \"wieghts\", 2 times: {unknown}; did you mean \"weights\"?"),
            format!("m.json:20:10: key \"units\", once: {unknown}"),
        ]
    );

    // If there are two lists of weights, one is used and the other one noted.
    let twice = changed("\"degree_u\"", "\"weights\": [1, 1, 1, 1, 3, 1], \"degree_u\"");
    let twice = model(&twice);
    assert_eq!(net(&twice.parts[0]).weights.as_ref().unwrap().value[4], 2.0);
    let text = twice.notes.iter().map(ToString::to_string).collect::<String>();
    assert_eq!(
        text,
        "m.json:2:1: surface \"m/lid\": \"weights\" left out: those of \"control_points\" are used"
    );

    // A surface alone may have the keys that belong to a file.
    let alone = SURFACE.replace("\"name\": \"lid\",", "\"order\": \"v fastest\", \"units\": 1,");
    let text = model(&alone).notes.iter().map(ToString::to_string).collect::<String>();
    assert_eq!(text, format!("m.json:2:34: key \"units\", once: {unknown}"));
}

#[test]
fn what_a_file_says_of_itself_is_compared_with_what_it_holds() {
    let notes = |head: &str, data: &str| {
        let model = model(&format!("{{\"shape\": {{{head}, \"data\": {data}}}}}"));
        let notes: Vec<_> = model.notes.iter().map(ToString::to_string).collect();
        (model.parts.len(), notes.join("; "))
    };
    let two = format!("[{SURFACE}, {SURFACE}]");
    for (head, data, note) in [
        ("\"type\": \"surface\", \"count\": 2", two.as_str(), ""),
        ("\"type\": \"surface\", \"count\": 1.0", SURFACE, ""),
        ("\"count\": null", &two, ""),
        ("\"count\": 3", &two, "m.json:1:21: key \"count\": it is 3, but \"data\" has 2 entries"),
        ("\"count\": 0", SURFACE, "m.json:1:21: key \"count\": it is 0, but \"data\" has 1 entry"),
        (
            "\"count\": [2]",
            &two,
            "m.json:1:21: key \"count\": it is no number, but \"data\" has 2 entries",
        ),
        (
            "\"type\": \"curve\"",
            &two,
            "m.json:1:20: key \"type\": it is \"curve\", but \"data\" has 2 surfaces",
        ),
    ] {
        let (surfaces, found) = notes(head, data);
        assert_eq!(found, note, "{head}");
        assert_eq!(surfaces, if data == two { 2 } else { 1 }, "{head}");
    }
    // A list without surfaces: each entry has a note of its own.
    let curve = "{\"degree\": 2}";
    let (_, found) = notes("\"type\": \"curve\"", curve);
    assert_eq!(found, "m.json:1:37: curve \"m\": a curve has no surface to show");
}

#[test]
fn wrong_counts() {
    assert_eq!(
        error(&changed("[0, 0, 1, 1]", "[0, 0, 1]")),
        "m.json:4:19: surface \"m/lid\", direction u: 3 knots, but 2 points of degree 1 need 4"
    );
    assert_eq!(
        error(&changed(", [1, 2, 0.5]", "")),
        "m.json:7:15: surface \"m/lid\": size_u × size_v is 2 × 3, but the list has 5 points"
    );
    assert_eq!(
        error(&changed("[1, 1, 1, 1, 2, 1]", "[1, 1]")),
        "m.json:8:16: surface \"m/lid\": 2 weights for 6 control points: \
         each needs one, or none has any"
    );
    // Absurd counts are refused before anything is allocated for them.
    for (size, shown) in [("3", "3 × 3"), ("9223372036854775808", "9223372036854775808 × 3")] {
        assert_eq!(
            error(&changed("\"size_u\": 2", &format!("\"size_u\": {size}"))),
            format!(
                "m.json:7:15: surface \"m/lid\": size_u × size_v is {shown}, but the list has 6 \
                 points"
            )
        );
    }
    assert_eq!(
        error(&changed("\"degree_v\": 2", "\"degree_v\": 4000000000")),
        "m.json:3:45: surface \"m/lid\", direction v: degree 4000000000: \
         degrees from 1 to 32 are supported"
    );
}

#[test]
fn wrong_numbers() {
    assert_eq!(
        error(&changed("[0, 0, 1, 1]", "[0, 0.5, 0.25, 1]")),
        "m.json:4:19: surface \"m/lid\", direction u: knot 2 is 0.25 after 0.5: \
         knots must not decrease"
    );
    assert_eq!(
        error(&changed("1, 2, 1]", "1, -2, 1]")),
        "m.json:8:29: surface \"m/lid\": the weight of control point (1, 1) is -2: \
         it must be positive and finite (from 1e-70 to 1e70)"
    );
    for (bad, word) in [("NaN", "NaN"), ("Infinity", "Infinity"), ("-Infinity", "-Infinity")] {
        let text = changed("[0, 1, 1]", &format!("[0, 1, {bad}]"));
        let message = error(&text);
        let wanted = format!(": {word} is not a number JSON knows: numbers must be finite");
        assert!(message.starts_with("m.json:7:3") && message.ends_with(&wanted), "{message}");
    }
    assert_eq!(
        error(&changed("[0, 1, 1]", "[0, 1, 1e999]")),
        "m.json:7:38: the number is too large: numbers must be finite"
    );
}

#[test]
fn wrong_layout() {
    assert_eq!(
        error("{}"),
        "m.json: neither \"shape\" nor \"surfaces\" is here: it is no geomdl JSON model"
    );
    assert_eq!(error("{\n \"shape\": {}}"), "m.json:2:11: shape: missing key \"data\"");
    assert_eq!(
        error(&changed("\"size_v\": 3,", "")),
        "m.json:2:1: surface \"m/lid\": missing key \"size_v\""
    );
    assert_eq!(
        error(&changed("\"degree_u\": 1, \"degree_v\": 2,", "")),
        "m.json:2:1: surface \"m/lid\": missing key \"degree_u\""
    );
    assert_eq!(
        error(&changed("\"degree_u\": 1", "\"degree_u\": 1.5")),
        "m.json:3:30: found the number 1.5, needed a whole number from 0 on"
    );
    assert_eq!(
        error(&changed("[0, 1, 1]", "[0, 1]")),
        "m.json:7:15: surface \"m/lid\": point 1 has 2 coordinates, but point 0 has 3"
    );
    assert_eq!(
        error(&changed("[0, 1, 1]", "7")),
        "m.json:7:27: found integer 7, needed a point, [x, y, z]"
    );
    assert_eq!(
        error("{\"surfaces\": [], \"order\": \"u fastest\"}"),
        "m.json:1:27: order \"u fastest\": only points written v fastest can be read"
    );
    for of in ["\"name\"", "\"degree_u\""] {
        let written = SURFACE.replacen(of, &format!("\"order\": \"u fastest\", {of}"), 1);
        let said = error(&format!("{{\"surfaces\": [{written}]}}"));
        assert!(said.ends_with("order \"u fastest\": only points written v fastest can be read"));
    }
    for (text, message) in [
        ("", ": the file is empty"),
        (" \n", ": the file is empty"),
        ("[]", ":1:1: found a list, needed an object"),
        ("[[1]]", ":1:1: found a list, needed an object"),
        ("garbage", ":1:1: this is no JSON"),
        ("null", ":1:1: found null, needed an object"),
        ("{\"surfaces\": 3}", ":1:14: found integer 3, needed an object"),
        ("{\"shape\": [\"x\"]}", ":1:11: found a list, needed an object"),
        ("{\"surfaces\": [[1, 2]]}", ":1:15: found a list, needed an object"),
        ("{\"shape\": {}, \"shape\": {}}", ":1:21: key \"shape\" is given twice"),
        ("{'shape': {}}", ":1:2: a key must be in double quotes"),
        ("{} {}", ":1:4: the model ends before this"),
        (
            "{\"surfaces\": [1,]}",
            ":1:17: found a closing bracket, needed a value before it: a comma too many?",
        ),
        (
            "{\"order\": \"v fastest\",}",
            ":1:23: found a closing bracket, needed a value before it: a comma too many?",
        ),
    ] {
        assert_eq!(error(text), format!("m.json{message}"), "{text}");
    }
}

#[test]
fn truncated_files_say_where_they_end() {
    let whole = changed("lid", "lid");
    assert_eq!(
        error(&whole[..whole.find("[1, 2, 0.5").unwrap() + 5]),
        "m.json:7:75: the file ends inside a list: it is not complete"
    );
    for end in (0..whole.len()).filter(|&end| whole.is_char_boundary(end)) {
        let message = error(&whole[..end]);
        assert!(message.starts_with("m.json:"), "cut at {end}: {message}");
    }
}

#[test]
fn deep_nesting_is_an_error_not_a_stack_overflow() {
    let deep = format!("{{\"surfaces\": {}", "[".repeat(1_000_000));
    assert!(error(&deep).starts_with("m.json:1:"), "{}", error(&deep));
    let closed = format!("{{\"surfaces\": {}{}}}", "[".repeat(100_000), "]".repeat(100_000));
    assert!(error(&closed).starts_with("m.json:1:"), "{}", error(&closed));
}

/// The surface above with trims.
fn trimmed(trims: &str) -> String {
    changed("\"degree_u\"", &format!("\"trims\": {trims},\n  \"degree_u\""))
}

/// What the exporter of geomdl writes: a rational circle as a spline, a polygon as free-form
/// points, a container of two curves; the last one keeps what it goes around.
const CIRCLE: &str = r#"{"type": "spline", "rational": true, "dimension": 2, "degree": 2,
    "knotvector": [0, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1],
    "control_points": {
      "points": [[0.7, 0.5], [0.7, 0.7], [0.5, 0.7], [0.3, 0.7], [0.3, 0.5], [0.3, 0.3],
                 [0.5, 0.3], [0.7, 0.3], [0.7, 0.5]],
      "weights": [1, 0.7071067811865476, 1, 0.7071067811865476, 1, 0.7071067811865476, 1,
                  0.7071067811865476, 1]},
    "delta": 0.01, "reversed": 0}"#;
const SQUARE: &str = r#"{"type": "freeform", "dimension": 2, "name": "",
    "points": [[0.1, 0.1], [0.2, 0.1], [0.2, 0.2], [0.1, 0.2]]}"#;
const OUTLINE: &str = r#"{"type": "container", "count": 2, "reversed": true, "data": [
    {"type": "freeform", "dimension": 2, "points": [[0.05, 0.05], [0.95, 0.05], [0.95, 0.95]]},
    {"type": "spline", "rational": false, "dimension": 2, "degree": 1, "knotvector": [0, 0, 0.5, 1, 1],
     "control_points": {"points": [[0.95, 0.95], [0.05, 0.95], [0.05, 0.05]]}}]}"#;

fn world(text: &str) -> World {
    let parts = model(text).parts;
    let object = Object { default_name: "m".into(), parts, ..Object::default() };
    World::new(&Scene { objects: vec![object], ..Scene::default() }).unwrap()
}

#[test]
fn trims_cut_as_in_geomdl() {
    use glam::DVec2;
    let places = [(0.5, 0.5), (0.15, 0.15), (0.3, 0.8), (0.01, 0.5)];
    for (trims, kept) in [
        (format!("{{\"count\": 2, \"data\": [{CIRCLE}, {SQUARE}]}}"), [false, false, true, true]),
        (format!("[{CIRCLE}, {OUTLINE}, {SQUARE}]"), [false, false, true, false]),
        (format!("[{}]", CIRCLE.replace("\"reversed\": 0", "\"reversed\": 1")), {
            [true, false, false, false]
        }),
    ] {
        let world = world(&trimmed(&trims));
        let surface = world.surfaces[0].surface.trimmed().unwrap();
        let found = places.map(|(u, v)| surface.keeps(DVec2::new(u, v)));
        assert_eq!(found, kept, "{trims}");
    }
    let none = world(&trimmed("{\"count\": 0, \"data\": []}"));
    assert!(none.surfaces[0].surface.trimmed().is_none());
}

/// Wherever a hole begins, it lies in the outline that it touches, overlaps a little, or is
/// inscribed in; also if it is so narrow that it lies within the tolerated overlap.
#[test]
fn what_overlaps_a_little_is_still_a_hole() {
    let near = |v: f64| [[0.5, v], [0.7, 0.95], [0.7, 0.6], [0.5, 0.6]];
    let holes = [0.95, 0.95 + 1e-15, 0.95 + 1e-12, 0.95 + 1e-7, 0.95 + 1e-6].map(near);
    let inscribed = [[0.5, 0.05], [0.95, 0.5], [0.5, 0.95], [0.05, 0.5]];
    let cases = holes.into_iter().chain([inscribed]).map(|hole| (OUTLINE, hole));
    // Along a slanted side, a hole may be narrower than the overlap that would be tolerated.
    let triangle = r#"{"points": [[0.1, 0.1], [0.9, 0.1], [0.9, 0.9]], "reversed": 1}"#;
    let narrow = [[0.3, 0.3], [0.7, 0.7], [0.7 + 3e-6, 0.7 - 3e-6], [0.3 + 3e-6, 0.3 - 3e-6]];
    for (outline, mut hole) in cases.chain([(triangle, narrow)]) {
        for _ in 0..4 {
            hole.rotate_left(1);
            let hole = format!("{{\"points\": {hole:?}, \"reversed\": 0}}");
            for trims in [format!("[{outline}, {hole}]"), format!("[{hole}, {outline}]")] {
                let made = world(&trimmed(&trims));
                assert!(made.surfaces[0].surface.trimmed().is_some(), "{trims}");
            }
        }
    }
}

#[test]
fn what_trims_leave_unused_is_noted() {
    let line = r#"{"points": [[0.2, 0.2], [0.8, 0.2], [0.5, 0.8], [0.2, 0.2]]"#;
    let twice = CIRCLE.replace("\"delta\"", "\"weights\": [1], \"points\": [[0, 0]], \"delta\"");
    for (trims, notes) in [
        (format!("[{line}}}, {CIRCLE}, {OUTLINE}]"), &[][..]),
        (format!("{{\"count\": 1, \"data\": [{line}, \"reversed\": true}}]}}"), &[]),
        (
            format!(
                "{{\"count\": 2, \"data\": [{}]}}",
                OUTLINE.replace("\"count\": 2", "\"count\": 3")
            ),
            &[
                "\"count\" is not the number of loops in \"data\"",
                "\"count\" of a loop is not the number of curves in its \"data\"",
            ],
        ),
        (
            format!("[{line}, \"type\": \"spline\"}}, {}]", CIRCLE.replace("spline", "container")),
            &["\"type\" of a curve is not what its other keys make of it"],
        ),
        (
            format!("[{twice}, {twice}]"),
            &[
                "\"points\" beside the control points of a spline are left out",
                "\"weights\" left out: those of \"control_points\" are used",
            ],
        ),
        (
            format!("[{line}, \"degree\": 1, \"weights\": [1]}}]"),
            &["degree, knots and weights beside free-form points are left out"],
        ),
        (
            format!("[{{\"weights\": [1], \"data\": [{line}, \"reversed\": 1}}]}}]"),
            &[
                "\"reversed\" of a curve within \"data\" is left out",
                "what stands beside the curves of \"data\" is left out",
            ],
        ),
    ] {
        let found: Vec<_> = model(&trimmed(&trims)).notes.iter().map(ToString::to_string).collect();
        let expected: Vec<_> = notes
            .iter()
            .map(|note| format!("m.json:2:1: trims of surface \"m/lid\": {note}"))
            .collect();
        assert_eq!(found, expected, "{trims}");
    }
}

#[test]
fn trims_that_cannot_be_are_named() {
    let inner = SQUARE.replace("0.1", "0.45").replace("0.2", "0.55");
    for (trims, message) in [
        (
            format!("[{CIRCLE}, {inner}]"),
            "m.json:10:36: surface \"m/lid\": trims: loop 1 is written as a hole, but it has 1 \
             around it and would be an outline",
        ),
        (
            format!("[{}]", CIRCLE.replace("[0.7, 0.5]],", "[0.6, 0.5]],").replace("\n", " ")),
            "m.json:3:28: surface \"m/lid\": trims: loop 0: the loop is open: curve 0 ends at \
             (0.6, 0.5), but curve 0 begins at (0.7, 0.5), (0.1, 0) away",
        ),
        (
            "[{\"type\": \"spline\"}]".to_owned(),
            "m.json:3:28: surface \"m/lid\": trims: loop 0 is neither a spline (degree, knotvector, \
             control_points), nor points, nor a container (data)",
        ),
        (
            "[{\"data\": [{\"points\": [[0, 0], [1, 0]]}, {\"data\": []}]}]".to_owned(),
            "m.json:3:68: surface \"m/lid\": trims: loop 0, curve 1, is a container within a \
             container, of which only splines and points are read",
        ),
        (
            "[{\"data\": [{\"degree\": 1}]}]".to_owned(),
            "m.json:3:38: surface \"m/lid\": trims: loop 0, curve 0, is neither a spline \
             (degree, knotvector, control_points) nor points",
        ),
        (
            "{\"count\": 1}".to_owned(),
            "m.json:3:27: surface \"m/lid\": trims: missing key \"data\"",
        ),
        (
            "[{\"points\": [[0.1], [0.9, 0.1], [0.5, 0.5]]}]".to_owned(),
            "m.json:3:39: surface \"m/lid\": trims: a point has 1 coordinate, but trim curves lie \
             in (u, v) and need 2",
        ),
        (
            "[{\"points\": [[0.1, 0.1], [], [0.5, 0.5]]}]".to_owned(),
            "m.json:3:39: surface \"m/lid\": trims: a point has 0 coordinates, but trim curves lie \
             in (u, v) and need 2",
        ),
        (
            "[{\"points\": [[0, 0, 1]]}]".to_owned(),
            "m.json:3:39: surface \"m/lid\": trims: a point has 3 coordinates, but trim curves lie \
             in (u, v) and need 2",
        ),
    ] {
        let found = error(&trimmed(&trims));
        assert!(found.starts_with(message), "{found}\n{message}");
    }
}
