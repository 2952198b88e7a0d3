//! `nurbray plot`: what is drawn is where the closed forms say, and the gallery's figures are
//! what their scenes say.

use std::fs;
use std::path::Path;

use crate::figure::{
    Axes, BLUE, CURVE, GREEN, GREY, RED, ROUNDING, TOLERANCE, plotted, polylines, scene,
};
use crate::sandbox::{SPHERE, SQUARE, Sandbox};

/// Every vertex of each circle's polyline is on the circle, and no chord is far inside.
#[test]
fn circles_are_round() {
    // A circle, how much of it, and a point of its control polygon by its number.
    let quarter = (0.25, [1.0, 0.0], (usize::MAX, [0.0, 1.0]));
    let (half, full) = ((0.5, [0.0, 1.0], (3, [0.0, -1.0])), (1.0, [0.0, 1.0], (3, [0.0, -1.0])));
    for (circle, (share, start, (number, other))) in [
        ("note_circle = \"quarter_2\"", quarter),
        ("note_circle = \"quarter_2_symmetric\"", quarter),
        ("quarter_circle_4 = { solution = 1 }", quarter),
        ("quarter_circle_4 = { solution = 2 }", quarter),
        ("quarter_circle_4 = { solution = 1, w1 = 0.8 }", quarter),
        ("quarter_circle_4 = { solution = 2, w1 = 3 }", quarter),
        ("quarter_circle_2 = { weights = [1, 3, 18] }", quarter),
        (
            "quarter_circle_4 = { weights = [0.8365163037378079, 0.7886751345948129], \
           y1 = 0.4226497308103742, x2 = 0.7886751345948129 }",
            quarter,
        ),
        ("note_circle = \"half_3\"", half),
        ("note_circle = \"full_3\"", full),
    ] {
        let text = format!("[[plot]]\nshow = {{ curves = [{{ curve = {{ {circle} }} }}] }}\n");
        let svg = plotted(&text, "--size 900x700");

        // Two points of the polygon are known; a unit is as long both ways.
        let polygon = &polylines(&svg, GREY, 1.0)[0];
        let known = polygon[number.min(polygon.len() - 1)];
        let unit = (known[1] - polygon[0][1]) / (start[1] - other[1]);
        let axes = Axes { pixel: polygon[0], point: start, unit: [unit; 2] };
        if start[0] != other[0] {
            let across = (known[0] - polygon[0][0]) / (other[0] - start[0]);
            assert!((across - unit).abs() <= 2.0 * ROUNDING, "{circle}: {across} and {unit}");
        }

        let curve = &polylines(&svg, BLUE, CURVE)[0];
        let points: Vec<_> = curve.iter().map(|&pixel| axes.point(pixel)).collect();
        for point in &points {
            let off = (point[0].hypot(point[1]) - 1.0).abs() * unit;
            assert!(off <= 3.0 * ROUNDING, "{circle}: {point:?} is {off} pixels off");
        }
        let mut length = 0.0;
        for chord in points.windows(2) {
            let middle = [0, 1].map(|k| 0.5 * (chord[0][k] + chord[1][k]));
            let inside = (1.0 - middle[0].hypot(middle[1])) * unit;
            assert!(inside <= TOLERANCE + 3.0 * ROUNDING, "{circle}: a chord is {inside} inside");
            length += (chord[1][0] - chord[0][0]).hypot(chord[1][1] - chord[0][1]);
        }
        let expected = std::f64::consts::TAU * share;
        assert!((length / expected - 1.0).abs() < 2e-3, "{circle}: {length}");
    }
}

/// Rogers' figure 4.2: all four curves pass x = 5/2 where he says, weight 0 included.
#[test]
fn rogers_curves_pass_his_points() {
    let svg = plotted(&scene("rogers_curves.toml"), "");
    let polygon = &polylines(&svg, GREY, 1.0)[0];
    let axes = Axes::new([polygon[0], polygon[3]], [[0.0, 0.0], [4.0, 2.0]]);
    assert!((axes.unit[0] / axes.unit[1] - 1.0).abs() < 1e-3, "{:?}", axes.unit);
    for (color, y) in [(BLUE, 2.0), (RED, 8.0 / 7.0), (GREEN, 0.5), ("#CC79A7", 0.125)] {
        let curve: Vec<_> =
            polylines(&svg, color, CURVE)[0].iter().map(|&pixel| axes.point(pixel)).collect();
        let chord = curve.windows(2).find(|chord| chord[0][0] <= 2.5 && 2.5 <= chord[1][0]);
        let [[x0, y0], [x1, y1]] = [chord.unwrap()[0], chord.unwrap()[1]];
        let found = y0 + (2.5 - x0) / (x1 - x0) * (y1 - y0);
        let off = (found - y).abs() * axes.unit[1];
        assert!(off <= TOLERANCE + 3.0 * ROUNDING, "{color}: {found} is {off} pixels from {y}");
    }
}

/// De Casteljau's construction on the deck's numbers: each round divides in the ratio 2 : 3.
#[test]
fn de_casteljau_divides_evenly() {
    let corners = [[0.0, 0.0], [1.0, 3.0], [4.0, 3.4], [5.0, 0.5]];
    let text = "[[plot]]\n[plot.show.de_casteljau]\nt = 0.4\n\
                curve = { bezier = [[0, 0], [1, 3], [4, 3.4], [5, 0.5]] }\n";
    let svg = plotted(text, "--size 700x600");
    let polygon = &polylines(&svg, GREY, 1.0)[0];
    let axes = Axes::new([polygon[0], polygon[2]], [corners[0], corners[2]]);
    let mut round = corners.to_vec();
    for color in [BLUE, RED] {
        round = round.windows(2).map(|w| [0, 1].map(|k| 0.6 * w[0][k] + 0.4 * w[1][k])).collect();
        let drawn = &polylines(&svg, color, 1.5)[0];
        assert_eq!(drawn.len(), round.len());
        for (&pixel, expected) in drawn.iter().zip(&round) {
            let found = axes.point(pixel);
            let off = (found[0] - expected[0]).hypot(found[1] - expected[1]) * axes.unit[0];
            assert!(off <= 3.0 * ROUNDING, "{color}: {found:?} for {expected:?}");
        }
    }
}

#[test]
fn the_same_input_gives_the_same_bytes_and_a_png_is_the_same_picture() {
    let sandbox = Sandbox::with(&[("s.toml", &scene("note_circles.toml"))]);
    for run in ["a", "b"] {
        sandbox.run(&format!("plot s.toml -o {run}.svg -o {run}.png --size 900x700")).succeeded();
    }
    assert_eq!(sandbox.bytes("a.svg"), sandbox.bytes("b.svg"));
    assert_eq!(sandbox.bytes("a.png"), sandbox.bytes("b.png"));

    let svg = String::from_utf8(sandbox.bytes("a.svg")).unwrap();
    assert!(svg.starts_with("<svg width=\"900\" height=\"700\" viewBox=\"0 0 28800 22400\""));
    for word in ["Half, degree 3", "P₁, w = 0.333", "t = 0.5 (×3)", "control points", "knots"] {
        assert!(svg.contains(word), "{word}");
    }
    assert!(!svg.contains("NaN") && !svg.contains("inf"));

    // Where the SVG has a curve the PNG is blue, and where it has words there is ink.
    let picture = image::open(sandbox.path("a.png")).unwrap().into_rgb8();
    assert_eq!(picture.dimensions(), (900, 700));
    let drawn = polylines(&svg, BLUE, CURVE);
    let curves = drawn.iter().filter(|line| line.len() > 2); // those of the legend have ends only
    for &[x, y] in curves.flat_map(|line| &line[1..line.len() - 1]) {
        let [r, g, b] = picture.get_pixel(x as u32, y as u32).0;
        assert!(r < 200 && r <= g && g <= b, "({x}, {y}) is {r}, {g}, {b}");
    }
    let title = picture.enumerate_pixels().filter(|(_, y, pixel)| *y < 28 && pixel.0[0] < 128);
    assert!(title.count() > 500, "the titles are missing");
}

#[test]
fn quiet_says_nothing() {
    let sandbox = Sandbox::with(&[("s.toml", "[[plot]]\nshow = { blending = \"bezier\" }\n")]);
    for quiet in ["--quiet", "-q"] {
        let run = sandbox.run(&format!("plot s.toml -o p.svg {quiet}")).succeeded();
        assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
    }
}

#[test]
fn scenes_without_plots_get_those_that_suit_them() {
    let sandbox = Sandbox::with(&[
        ("ball.toml", SPHERE),
        ("square.json", SQUARE),
        (
            "vase.toml",
            "[[object]]\nname = \"vase\"\n[object.shape.revolution]\n\
             profile = { bezier = [[1, 0, 0], [2, 0, 1], [0.5, 0, 2]] }\n",
        ),
    ]);
    let svg = |input: &str| {
        sandbox.run(&format!("plot {input} -o p.svg")).succeeded();
        String::from_utf8(sandbox.bytes("p.svg")).unwrap()
    };
    let ball = svg("ball.toml");
    assert!(ball.contains("Degree 3: ball, u") && ball.contains("Degree 3: ball, v"));
    assert!(svg("square.json").contains("Degree 1: square, u and 1 more"));
    // The profile lies in y = 0: x and z are shown.
    let vase = svg("vase.toml");
    for word in ["vase: profile", "\nx\n", "\nz\n", "Degree 2: vase, u"] {
        assert!(vase.contains(word), "{word}");
    }
    assert!(!vase.contains("\ny\n"));
}

#[test]
fn wrong_use_is_refused_before_anything_is_written() {
    let plot = "[[plot]]\nshow = { blending = \"bezier\" }\n";
    let huge = format!("[figure]\nsize = [9000, 100]\n{plot}");
    let sandbox = Sandbox::with(&[("s.toml", plot), ("huge.toml", &huge)]);
    let known = "known are .svg and .png";
    sandbox
        .run("plot s.toml -o p.pdf")
        .failed(2, &format!("p.pdf: cannot write .pdf files; {known}"));
    sandbox.run("plot s.toml -o p.svg -o p.svg").failed(2, "\"p.svg\" is given twice as output");
    sandbox.run("plot s.toml").misused("the following required arguments were not provided:");
    sandbox
        .run("plot s.toml -o p.svg --size 100x100")
        .failed(2, "100 x 100 pixels are too few for 1 plot: at least 132x216 are needed");
    sandbox.run("plot huge.toml -o p.svg").failed(
        2,
        "huge.toml:2:8: 9000 x 100 pixels: a picture of plots has at most 8192 each way",
    );
    sandbox.run("render s.toml -o p.png").failed(
        2,
        "s.toml: there is nothing to trace: the scene has plots, but no object (`nurbray plot` \
         draws the plots; to trace, write an [[object]], with a shape such as \"sphere\")",
    );
    assert_eq!(sandbox.files(), ["huge.toml", "s.toml"]);
}

#[test]
fn what_cannot_be_plotted_is_told_with_its_place() {
    let bezier = "curve = { bezier = [[0, 0], [1, 2], [2, 0]] }";
    for (show, place, message) in [
        ("{ blendin = 1 }", "3:10", "unknown plot \"blendin\"; did you mean \"blending\"?"),
        ("{ blending = \"bsplin\" }", "3:21", "unknown name \"bsplin\"; did you mean \"bspline\"?"),
        ("{ curves = [] }", "3:8", "plot \"A\": there are no curves to draw: give at least one"),
        (
            "{ curves = [{ curve = { bezier = [[0, 0]] } }] }",
            "3:30",
            "plot \"A\": curve 0: 1 point: at least 2 are needed",
        ),
        (
            "{ curves = [{ curve = { note_circle = \"half\" } }] }",
            "3:46",
            "unknown circle \"half\"; did you mean \"half_3\"?",
        ),
        (
            "{ curves = [{ curve = { quarter_circle_4 = { solution = 3 } } }] }",
            "3:64",
            "found 3, needed solution 1 or 2",
        ),
        (
            "{ basis = { degree = 2 } }",
            "3:18",
            "plot \"A\": basis: it is not known of how many points: give knots, weights, or count = …",
        ),
        (
            "{ basis = { degree = 2, knots = [0, 0, 0, 1, 1] } }",
            "3:40",
            "plot \"A\": basis: 5 knots of degree 2: at least 6 are needed, or 4 with support = true",
        ),
        (
            "{ basis = { degree = 2, knots = [0, 0, 1, 1], count = 2 } }",
            "3:40",
            "plot \"A\": basis: 2 points of degree 2: at least 3 are needed",
        ),
        (
            "{ basis = { degree = 2, count = 0, knots = \"uniform\", support = true } }",
            "3:51",
            "plot \"A\": basis: no control points: at least 1 is needed",
        ),
        (
            "{ basis = { degree = 1, weights = [1, 0, 0, 1] } }",
            "3:42",
            "plot \"A\": basis: the weights of all control points that matter at t = 0.3333333333333333 are 0: one must be positive",
        ),
        (
            "{ basis = { degree = 1, weights = [1, 2], support = true } }",
            "3:42",
            "plot \"A\": basis: rational functions end with the domain: support = true goes without weights",
        ),
        (
            "{ basis = { degree = 2, count = 4, weights = [1, 1, 1] } }",
            "3:53",
            "plot \"A\": basis: 3 weights for count = 4: each point needs one",
        ),
        (
            "{ basis = { degree = 2, knots = [0, 0, 0, 1, 2, 3, 3, 3], weights = [1, 1, 1] } }",
            "3:76",
            "plot \"A\": basis: 3 weights, but the knots of degree 2 go with 5 control points: each needs one",
        ),
        (
            "{ basis = { degree = 3, knots = { periodic = [0, 1, 2, 3, 4] }, weights = [1] } }",
            "3:82",
            "plot \"A\": basis: 1 weight, but the knots of degree 3 go with 4 control points: each needs one",
        ),
        (
            "{ curves = [{ curve = { bezier = [[0, 0], [1e308, 0], [-1e308, 1]] } }] }",
            "3:30",
            "plot \"A\": curve 0: control point 1 is (1e308, 0, 0): coordinates must be finite (up to 1e70)",
        ),
        (
            "{ curvature = { curve = { bezier = [[1, 2], [1, 2]] } } }",
            "3:8",
            "plot \"A\": it has no finite extent that could be drawn",
        ),
        (
            &format!("{{ de_casteljau = {{ t = 1.5, {bezier} }} }}"),
            "3:31",
            "plot \"A\": the parameter 1.5 does not lie inside the domain from 0 to 1",
        ),
        (
            &format!("{{ insertion = {{ knots = [0.5, 0.5, 0.5, 0.5], {bezier} }} }}"),
            "3:48",
            "plot \"A\": knot 0.5 is repeated 4 times: degree 2 allows up to 3",
        ),
        (
            &format!("{{ comb = {{ teeth = 0, {bezier} }} }}"),
            "3:8",
            "plot \"A\": comb: 0 teeth a span: needed are 1 to 1000",
        ),
        (
            "{ basis = { degree = 3, count = 1001 } }",
            "3:18",
            "plot \"A\": basis: 1001 functions: at most 1000 can be drawn",
        ),
        (
            "{ corner_cutting = { scheme = \"chaikin\", polygon = [[0, 0], [1, 1]] } }",
            "3:8",
            "plot \"A\": polygon: 2 points: at least 3 are needed",
        ),
    ] {
        let text = format!("[[plot]]\ntitle = \"A\"\nshow = {show}\n");
        let sandbox = Sandbox::with(&[("s.toml", &text)]);
        let run = sandbox.run("plot s.toml -o p.svg");
        assert_eq!(run.stderr, format!("error: s.toml:{place}: {message}\n"));
        assert_eq!(run.code, 2);
    }
    // Without a title a plot has its number, which counts from 0 as all numbers do.
    let text = "[[plot]]\nshow = { blending = \"bezier\" }\n[[plot]]\nshow = { curves = [] }\n";
    Sandbox::with(&[("s.toml", text)])
        .run("plot s.toml -o p.svg")
        .failed(2, "s.toml:4:8: plot 1: there are no curves to draw: give at least one");
    // Curves of model files are not imported.
    let curve = "{\"degree\": 1, \"name\": \"rim\"}";
    let curves = format!("{{\"shape\": {{\"data\": [{curve}, {curve}, {curve}, {curve}]}}}}");
    Sandbox::with(&[("m.json", &curves)]).run("plot m.json -o p.svg").failed(
        2,
        "m.json: there is nothing to plot: of model files only surfaces are imported, not curve \
         \"m/rim\", curve \"m/rim\", curve \"m/rim\", 1 more; a scene draws a curve that its \
         [[plot]] gives",
    );
    // An empty scene has the same error with every subcommand.
    let sandbox = Sandbox::with(&[("empty.toml", "")]);
    let hint = "there is nothing to show: the scene has no object (write an \
         [[object]], with a shape such as \"sphere\")";
    sandbox.run("plot empty.toml -o p.svg").failed(2, &format!("empty.toml: {hint}"));
}

/// Loops far larger than the domain, and pictures of as many columns as no screen has.
#[test]
fn what_is_too_large_to_plot_is_told_with_its_place() {
    let plane = |radius: f64| {
        let middle = 0.5 - radius;
        format!(
            "[[object]]\nname = \"disk\"\nshape = \"plane\"\n\
             trims = {{ loops = [{{ circle = {{ center = [0.5, {middle}], radius = {radius} }} }}] }}\n"
        )
    };
    let chosen = plane(1e8);
    let asked =
        format!("{chosen}[[plot]]\ntitle = \"A\"\nshow = {{ trims = {{ of = \"disk\" }} }}\n");
    let unnamed = plane(0.25).replace("name = \"disk\"\n", "");
    let wide = format!("{}[figure]\ncolumns = 100\n", unnamed.repeat(30));
    let files = [("chosen.toml", &*chosen), ("asked.toml", &asked), ("wide.toml", &wide)];
    let sandbox = Sandbox::with(&files);
    for (line, message) in [
        (
            "plot chosen.toml -o out.svg",
            "chosen.toml: plot \"Trims of disk\": the trim loops are so",
        ),
        ("plot asked.toml -o out.svg", "asked.toml:7:8: plot \"A\": the trim loops are so much"),
        ("plot wide.toml -o out.svg", "wide.toml:92:11: "),
    ] {
        let run = sandbox.run(line);
        assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{}", run.stderr);
        assert!(run.stderr.contains(&format!("error: {message}")), "{}", run.stderr);
    }
    fs::write(sandbox.path("near.toml"), plane(1e7)).unwrap();
    sandbox.run("plot near.toml -o out.svg").succeeded();
}

/// An SVG's words and numbers.
fn tokens(svg: &str) -> Vec<Result<f64, &str>> {
    let breaks = |c: char| c.is_whitespace() || "\",=<>()".contains(c);
    let words = svg.split(breaks).filter(|word| !word.is_empty());
    words.map(|word| word.parse().map_err(|_| word)).collect()
}

/// The figures in `renders/` equal those drawn again from `scenes/`. Cosines and the like are the
/// system library's, so a number may be off by one unit, a 32nd of a pixel.
#[test]
fn the_gallery_s_figures_are_their_scenes() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let sandbox = Sandbox::new();
    let mut figures = 0;
    for entry in fs::read_dir(root.join("renders")).unwrap() {
        let figure = entry.unwrap().path();
        if figure.extension().is_none_or(|extension| extension != "svg") {
            continue;
        }
        let stem = figure.file_stem().unwrap().to_str().unwrap().to_owned();
        let scene = root.join("scenes").join(&stem).with_extension("toml");
        sandbox.run(&format!("plot {} -o p.svg", scene.display())).succeeded();
        let (old, new) = (fs::read_to_string(&figure).unwrap(), sandbox.bytes("p.svg"));
        let (old, new) = (tokens(&old), tokens(std::str::from_utf8(&new).unwrap()));
        let same = |pair: (&Result<f64, &str>, &Result<f64, &str>)| match pair {
            (Ok(a), Ok(b)) => (a - b).abs() <= 1.0,
            (a, b) => a == b,
        };
        assert!(
            old.len() == new.len() && old.iter().zip(&new).all(same),
            "renders/{stem}.svg is another picture; if the change is meant, draw it again:\n  \
             cargo run --release -- plot scenes/{stem}.toml -o renders/{stem}.svg"
        );
        figures += 1;
    }
    assert!(figures >= 8, "only {figures} figures");
}
