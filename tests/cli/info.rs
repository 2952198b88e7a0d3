//! `nurbray info`.

use serde_json::json;

use crate::sandbox::{SHEETS_WITH_A_GAP, SPHERE, Sandbox, TRIMMED, turned_square};

#[test]
fn a_sphere_is_closed_and_has_two_poles() {
    let sandbox = Sandbox::with(&[("sphere.toml", SPHERE)]);
    let run = sandbox.run("info sphere.toml --json").succeeded();
    assert_eq!(run.stderr, "");
    let json = run.json();
    let ball = &json["surfaces"][0];
    assert_eq!((ball["index"].as_u64(), ball["name"].as_str()), (Some(0), Some("ball")));
    assert_eq!(ball["material"], "default");
    assert_eq!(ball["degree"], json!([3, 3]));
    assert_eq!(ball["rational"], true);
    assert_eq!(ball["size"], json!([4, 7]));
    assert_eq!(ball["domain"], json!([[0.0, 1.0], [0.0, 1.0]]));
    assert_eq!(ball["pieces"], 2);
    assert!(ball["leaves"].as_u64().unwrap() >= 2 && ball["bytes"].as_u64().unwrap() > 0);
    for (corner, sign) in ball["bounds"].as_array().unwrap().iter().zip([-1.0, 1.0]) {
        for x in corner.as_array().unwrap() {
            let x = x.as_f64().unwrap();
            assert!((sign * x - 1.0).abs() < 1e-11, "{corner}"); // tight, not the control points
        }
    }
    let poles = ball["collapsed_edges"].as_array().unwrap();
    let edges: Vec<&str> = poles.iter().map(|pole| pole["edge"].as_str().unwrap()).collect();
    assert_eq!(edges, ["u = 0", "u = 1"]);
    assert_eq!(poles[0]["point"].as_array().unwrap().len(), 3);

    assert_eq!(json["total"]["surfaces"], 1);
    assert_eq!(json["total"]["control_points"], 28);
    let borders = json!({ "total": 4, "trim_edges": 0, "collapsed": 2, "meeting": 2, "nearly_meeting": 0, "free": 0 });
    assert_eq!(json["borders"], borders);
    assert_eq!((&json["gaps"], &json["not_imported"]), (&json!([]), &json!([])));
    assert_eq!(json["input"], "sphere.toml");
}

#[test]
fn gaps_are_listed_with_their_width() {
    let sandbox = Sandbox::with(&[("sheets.toml", SHEETS_WITH_A_GAP)]);
    let json = sandbox.run("info sheets.toml --json").succeeded().json();
    assert_eq!(json["borders"]["nearly_meeting"], 2);
    let gap = &json["gaps"][0];
    assert_eq!(json["gaps"].as_array().unwrap().len(), 1);
    assert_eq!(gap["surfaces"], json!([0, 1]));
    let width = gap["width"].as_f64().unwrap();
    assert!((width - 1e-7).abs() < 1e-14, "{width}");
    let relative = gap["relative"].as_f64().unwrap();
    assert!((relative - 1e-7 / 20_f64.sqrt()).abs() < 1e-12, "{relative}");

    let text = sandbox.run("info sheets.toml").succeeded().stdout;
    assert!(text.contains("\n1 gap, widest first:\n"), "{text}");
    assert!(text.contains("0 left, ") && text.contains("| 1 right, "), "{text}");
    assert!(text.contains("1.00e-7 (2.2e-8 of the size)"), "{text}");
}

/// A bicubic sheet cut by a curve of degree eight. In space, the edge has degree 48.
const STEEP_TRIM: &str = r#"
[[object]]
name = "sheet"
trims = { loops = [{ curves = [{ bezier = [
    [0.5, 0.2], [0.8, 0.2], [0.9, 0.4], [0.8, 0.7], [0.5, 0.9], [0.2, 0.7], [0.1, 0.4], [0.2, 0.2], [0.5, 0.2],
] }] }] }
[object.shape.nurbs]
degree = [3, 3]
knots_u = [0, 0, 0, 0, 1, 1, 1, 1]
knots_v = [0, 0, 0, 0, 1, 1, 1, 1]
points = [
    [[0, 0, 0], [0, 1, 0], [0, 2, 0], [0, 3, 0]],
    [[1, 0, 0], [1, 1, 1], [1, 2, 0], [1, 3, 0]],
    [[2, 0, 0], [2, 1, 0], [2, 2, 1], [2, 3, 0]],
    [[3, 0, 0], [3, 1, 0], [3, 2, 0], [3, 3, 0]],
]
"#;

/// The sheet around the hole and the part cut out of it, once in place and once moved.
#[test]
fn gaps_along_edges_of_any_degree_are_found() {
    let cut_out = STEEP_TRIM
        .replace("name = \"sheet\"", "name = \"part\"")
        .replace("trims = {", "trims = { keep = \"inside\",");
    let two = [STEEP_TRIM.replace("trims = {", "trims = { keep = \"outside\","), cut_out].concat();
    let torn = two
        .replace("name = \"part\"", "name = \"part\"\ntransform = [{ translate = [0, 0, 1e-5] }]");
    let sandbox = Sandbox::with(&[("whole.toml", &two), ("torn.toml", &torn)]);
    let of = |name: &str| sandbox.run(&format!("info {name} --json")).succeeded().json();

    let whole = of("whole.toml");
    let borders = json!({ "total": 6, "trim_edges": 2, "collapsed": 0, "meeting": 2,
        "nearly_meeting": 0, "free": 4 });
    assert_eq!((&whole["borders"], &whole["gaps"]), (&borders, &json!([])));
    assert_eq!(whole["turns"], json!({ "judged": 1, "opposite": [] }));
    let torn = of("torn.toml");
    assert_eq!(torn["borders"]["nearly_meeting"], 2);
    // Where the sheet is steep, the nearest point of the moved edge is not the one above.
    let width = torn["gaps"][0]["width"].as_f64().unwrap();
    assert!(width > 0.9e-5 && width < 1e-5 + 1e-14, "{width}");
}

#[test]
fn what_is_not_imported_is_listed_with_its_place() {
    let sandbox = Sandbox::with(&[("square.json", &turned_square())]);
    let run = sandbox.run("info square.json").succeeded();
    assert!(run.stdout.contains("\n1 thing not imported:\n  square.json:"), "{}", run.stdout);
    let json = sandbox.run("info square.json --json").succeeded().json();
    let note = &json["not_imported"][0];
    assert_eq!(note["file"], "square.json");
    assert!(note["line"].as_u64().unwrap() > 1 && note["column"].as_u64().is_some());
    assert!(
        note["what"].is_string() && note["why"].as_str().unwrap().contains("reversed"),
        "{note}"
    );
}

#[test]
fn trims_are_listed() {
    let sandbox = Sandbox::with(&[("sheet.toml", TRIMMED), ("sphere.toml", SPHERE)]);
    let text = sandbox.run("info sheet.toml").succeeded().stdout;
    let line = "\n1 trimmed surface:\n  0 sheet  kept outside 2 loops  of ";
    assert!(text.contains(line), "{text}");
    let json = sandbox.run("info sheet.toml --json").succeeded().json();
    let trims = &json["surfaces"][0]["trims"];
    assert_eq!((&trims["keep"], &trims["loops"]), (&json!("outside"), &json!(2)));
    assert!(trims["segments"].as_u64().unwrap() >= 7 && trims["bytes"].as_u64().unwrap() > 0);
    let (mixed, all) = (&trims["mixed_leaves"], &json["surfaces"][0]["leaves"]);
    assert!(0 < mixed.as_u64().unwrap() && mixed.as_u64() < all.as_u64(), "{mixed} {all}");
    assert_eq!(json["surfaces"][0]["bounds"], json!([[-1.0, -1.0, 0.0], [1.0, 1.0, 0.0]]));
    let whole = sandbox.run("info sphere.toml --json").succeeded().json();
    assert!(whole["surfaces"][0]["trims"].is_null());
}

/// Such gaps occur in CAD files.
#[test]
fn gaps_in_trim_loops_are_closed_and_told() {
    let scene = |end: &str| {
        let loops = format!(
            "[{{ polyline = [[0, 0], [1, 0], [1, 1]] }}, {{ polyline = [[1, 1], [0, 1], {end}] }}]"
        );
        format!(
            "[[object]]\nname = \"sheet\"\nshape = {{ plane = {{ width = 2, height = 2 }} }}\n\
             trims = {{ loops = [{{ curves = {loops} }}] }}\n"
        )
    };
    let (near, far) = (scene("[0.00005, 0]"), scene("[0.002, 0]"));
    let sandbox = Sandbox::with(&[("near.toml", &near), ("far.toml", &far)]);
    let text = sandbox.run("info near.toml").succeeded().stdout;
    assert!(text.contains("gaps up to 0.00005 of a loop closed\n"), "{text}");
    let json = sandbox.run("info near.toml --json").succeeded().json();
    assert_eq!(json["surfaces"][0]["trims"]["widest_gap"], json!(5e-5));
    let run = sandbox.run("info far.toml");
    assert_eq!(run.code, 2);
    let error = run.stderr;
    assert!(error.contains("the loop is open: curve 1 ends at (0.002, 0)"), "{error}");
    assert!(error.contains("gaps up to (0.001, 0.001) are closed"), "{error}");
}

/// A circle meant in the units of the plane, not of (u, v), goes around all of it.
#[test]
fn loops_outside_the_domain_are_told() {
    let scene = |loops: &str| {
        format!(
            "[[object]]\nshape = {{ plane = {{ width = 40, height = 40 }} }}\ntrims = {{ loops = [{loops}] }}\n"
        )
    };
    let around = scene("{ circle = { center = [0, 0], radius = 18 } }");
    let border = scene("{ polygon = [[0, 0], [1, 0], [1, 1], [0, 1]] }");
    let sandbox = Sandbox::with(&[("around.toml", &around), ("border.toml", &border)]);
    for (name, outside) in [("around", 1), ("border", 0)] {
        let text = sandbox.run(&format!("info {name}.toml")).succeeded().stdout;
        assert_eq!(text.contains("  1 loop outside the domain only\n"), outside > 0, "{text}");
        let json = sandbox.run(&format!("info {name}.toml --json")).succeeded().json();
        assert_eq!(json["surfaces"][0]["trims"]["loops_outside"], json!(outside));
    }
}

/// Half a lens: the poles that trims cut off are not listed.
#[test]
fn poles_are_those_that_trims_keep() {
    let cap = "[[object]]\nname = \"cap\"\nshape = { sphere = { radius = 1 } }\ntrims = { loops = \
               [{ polygon = [[0.8, 0], [1, 0], [1, 1], [0.8, 1]] }] }\n";
    let sandbox = Sandbox::with(&[("cap.toml", cap)]);
    let json = sandbox.run("info cap.toml --json").succeeded().json();
    let poles = json["surfaces"][0]["collapsed_edges"].as_array().unwrap();
    assert_eq!(poles.len(), 1, "{poles:?}");
    assert_eq!(poles[0]["edge"], "u = 1");
    let text = sandbox.run("info cap.toml").succeeded().stdout;
    assert!(text.contains("1 collapsed edge (poles):"), "{text}");
}

#[test]
fn bounds_are_those_of_what_trims_keep() {
    let disc = r#"
[[object]]
shape = { plane = { width = 4, height = 4 } }
[object.trims]
keep = "inside"
loops = [ { circle = { center = [0.25, 0.75], radius = 0.0005 } } ]
"#;
    let sandbox = Sandbox::with(&[("disc.toml", disc)]);
    let json = sandbox.run("info disc.toml --json").succeeded().json();
    let found = json["surfaces"][0]["bounds"].as_array().unwrap().iter();
    let found = found.flat_map(|corner| corner.as_array().unwrap());
    // A radius of 0.002 around (-1, 1): far less than the plane's one leaf.
    let expected = [-1.002, 0.998, 0.0, -0.998, 1.002, 0.0];
    for (x, expected) in found.zip(expected) {
        assert!((x.as_f64().unwrap() - expected).abs() < 1e-11, "{json}");
    }
}

/// A triangle is traced in three parts, but has three sides.
#[test]
fn a_triangle_has_three_borders() {
    let triangle = |corner: &str| {
        format!(
            "[[object]]\nname = \"t\"\n[object.shape.triangle]\ndegree = 1\n\
             points = [[0, 0, 0], [0, 1, 0], {corner}]\n"
        )
    };
    let whole = triangle("[1, 0, 0]");
    let beside = format!("{whole}{}", triangle("[1, 1, 0]").replace("[0, 0, 0]", "[1, 0, 0]"));
    let sandbox = Sandbox::with(&[
        ("whole.toml", &whole),
        ("two.toml", &beside.replacen("\"t\"", "\"s\"", 1)),
    ]);
    let borders = |name: &str| {
        let json = sandbox.run(&format!("info {name} --json")).succeeded().json();
        ["total", "meeting", "free"].map(|key| json["borders"][key].as_u64().unwrap())
    };
    assert_eq!(borders("whole.toml"), [3, 0, 3]);
    assert_eq!(borders("two.toml"), [6, 2, 4]);
}

/// The loop's sides along u = 0 and v = 0 cut nothing, for `cast` as for all the others.
#[test]
fn sides_of_loops_along_the_border_are_no_trim_edges() {
    let scene = |loops: &str, more: &str| {
        format!(
            "[[object]]\nname = \"p\"\nshape = {{ plane = {{ width = 2, height = 2 }} }}\n\
             trims = {{ loops = [{{ polygon = [{loops}] }}] }}\n{more}"
        )
    };
    let corner = "[0, 0], [1, 0], [0, 1]";
    let tubes = "[[object]]\nshape = { trim_curves = { of = \"p\", radius = 0.01 } }\n";
    let around = scene("[0, 0], [1, 0], [1, 1], [0, 1]", tubes);
    let sandbox = Sandbox::with(&[
        ("corner.toml", &scene(corner, "")),
        ("tubes.toml", &scene(corner, tubes)),
        ("around.toml", &around),
    ]);
    let json = sandbox.run("info corner.toml --json").succeeded().json();
    let borders = ["total", "trim_edges", "free"].map(|key| json["borders"][key].as_u64().unwrap());
    assert_eq!(borders, [3, 1, 3]);
    // One tube with two caps, along the diagonal.
    let json = sandbox.run("info tubes.toml --json").succeeded().json();
    assert_eq!(json["total"]["surfaces"], 4);
    let error = sandbox.run("info around.toml");
    assert_eq!(error.code, 2);
    let told = "there are no trim edges to draw: the loops run along the border, or outside";
    assert!(error.stderr.contains(told), "{}", error.stderr);
}

#[test]
fn people_get_tables() {
    let sandbox = Sandbox::with(&[("sphere.toml", SPHERE)]);
    let text = sandbox.run("info sphere.toml").succeeded().stdout;
    assert!(text.starts_with("sphere.toml: 1 surface, 28 control points, 2 pieces, "), "{text}");
    assert!(text.contains("2 collapsed edges (poles):\n  0 ball  u = 0  at "), "{text}");
    assert!(
        text.contains("4 borders: 2 collapsed, 2 meeting another to within rounding, "),
        "{text}"
    );
    assert!(text.ends_with("everything in the file was imported\n"), "{text}");
}

/// Two squares beside each other, of which one is turned over.
#[test]
fn surfaces_turned_opposite_ways_are_named() {
    let scene = |reverse: bool| {
        format!(
            "[[object]]\nname = \"left\"\n[object.shape.nurbs]\ndegree = [1, 1]\n\
             points = [[[-1, 0, 0], [-1, 1, 0]], [[0, 0, 0], [0, 1, 0]]]\n\
             [[object]]\nname = \"right\"\nreverse = {reverse}\n\
             [object.shape.nurbs]\ndegree = [1, 1]\n\
             points = [[[0, 0, 0], [1, 0, 0]], [[0, 1, 0], [1, 1, 0]]]\n"
        )
    };
    let (torn, mended) = (scene(false), scene(true));
    let sandbox = Sandbox::with(&[("torn.toml", &torn), ("mended.toml", &mended)]);
    let json = sandbox.run("info torn.toml --json").succeeded().json();
    let (turns, pair) = (&json["turns"], &json["turns"]["opposite"][0]);
    assert_eq!(
        (turns["judged"].as_u64(), turns["opposite"].as_array().unwrap().len()),
        (Some(1), 1)
    );
    assert_eq!(pair["surfaces"], json!([0, 1]));
    assert_eq!(pair["edges"], json!(["u = 1", "v = 0"]));
    assert_eq!((&pair["at"][0], &pair["at"][2]), (&json!(0.0), &json!(0.0)));
    assert_eq!(json["borders"]["meeting"], 2);
    let text = sandbox.run("info torn.toml").succeeded().stdout;
    let named = "\n1 of 1 pair of borders that meet, or nearly, with surfaces turned opposite ways:\n  \
                 0 left, u = 1  | 1 right, v = 0  at (0, ";
    assert!(text.contains(named), "{text}");
    assert!(text.contains("`reverse = true` turns all surfaces of an object\n"), "{text}");

    let json = sandbox.run("info mended.toml --json").succeeded().json();
    assert_eq!(json["turns"], json!({ "judged": 1, "opposite": [] }));
    let text = sandbox.run("info mended.toml").succeeded().stdout;
    assert!(
        text.contains(
            "\n1 pair of borders that meet, or nearly, with surfaces turned alike, none opposite ways\n"
        ),
        "{text}"
    );
}
