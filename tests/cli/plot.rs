//! `nurbray plot`: what is drawn is where the closed forms say, and the gallery's figures are
//! what their scenes say.

use std::fs;
use std::path::Path;

use crate::figure::{
    Axes, BLUE, CURVE, GREEN, GREY, RED, ROUNDING, SUBPIXELS, TOLERANCE, attributes, numbers,
    plotted, polylines, scene,
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

/// Rogers' figure 4.1: his formulas on 1 ≤ t < 2, at every vertex of R₂ and R₃ (ours R₁ and R₂).
#[test]
fn rogers_basis_functions_are_his() {
    for (h3, weight) in [(0.0, "0"), (0.25, "0.25"), (5.0, "5")] {
        let text = format!(
            "[[plot]]\n[plot.show.basis]\ndegree = 2\nknots = [0, 0, 0, 1, 2, 3, 3, 3]\n\
             weights = [1, 1, {weight}, 1, 1]\n"
        );
        let svg = plotted(&text, "--size 640x480");
        let zero = &polylines(&svg, GREY, 1.0)[0];
        let first = &polylines(&svg, BLUE, CURVE)[0]; // R₀ begins at (0, 1)
        let axes = Axes::new([first[0], zero[1]], [[0.0, 1.0], [3.0, 0.0]]);
        let unit = axes.unit[1];

        let n2 = |t: f64| t * (2.0 - t) / 2.0 + (3.0 - t) * (t - 1.0) / 2.0;
        let sum = |t: f64| (2.0 - t).powi(2) / 2.0 + h3 * n2(t) + (t - 1.0).powi(2) / 2.0;
        let r1 = |t: f64| (2.0 - t).powi(2) / 2.0 / sum(t);
        let r2 = |t: f64| h3 * n2(t) / sum(t);
        let mut seen = 0;
        for (color, function) in [(RED, &r1 as &dyn Fn(f64) -> f64), (GREEN, &r2)] {
            // The legend has a line of the colour, too: it comes last.
            let drawn = polylines(&svg, color, CURVE);
            assert_eq!(drawn.len(), if h3 == 0.0 && color == GREEN { 1 } else { 2 }, "{h3}");
            for &pixel in drawn[..drawn.len() - 1].iter().flatten() {
                let [t, value] = axes.point(pixel);
                if (1.0..2.0).contains(&t) {
                    // A vertex is off sideways, too, and the function has a slope.
                    let slope = (function(t + 1e-6) - function(t - 1e-6)) / 2e-6;
                    let slack = 3.0 * ROUNDING * (1.0 + slope.abs() * unit / axes.unit[0]);
                    let off = (value - function(t)).abs() * unit;
                    assert!(off <= slack, "{h3}, t = {t}: {value} is {off} pixels off");
                    seen += 1;
                }
            }
        }
        assert!(seen > 15, "{h3}: only {seen} vertices");
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

/// The lecture's polynomials, B₁ = (3t³ − 6t² + 4)/6 and B₀ = (1 − t)³/6.
#[test]
fn blending_functions_are_the_lecture_s() {
    let svg = plotted("[[plot]]\nshow = { blending = \"bspline\" }\n", "--size 500x500");
    let zero = &polylines(&svg, GREY, 1.0)[0];
    let b0 = &polylines(&svg, BLUE, CURVE)[0];
    let axes = Axes::new([b0[0], zero[1]], [[0.0, 1.0 / 6.0], [1.0, 0.0]]);
    let polynomials = [(BLUE, [-1.0, 3.0, -3.0, 1.0]), (RED, [3.0, -6.0, 0.0, 4.0])];
    for (color, [a, b, c, d]) in polynomials {
        let curve = &polylines(&svg, color, CURVE)[0];
        assert!(curve.len() > 8);
        for &pixel in curve {
            let [t, value] = axes.point(pixel);
            let expected = (((a * t + b) * t + c) * t + d) / 6.0;
            let off = (value - expected).abs() * axes.unit[1];
            assert!(off < 0.25, "{color} at {t}: {off} pixels off");
        }
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
        "s.toml: there is nothing to trace, only plots, which `nurbray plot` draws: write an \
         [[object]], with a shape such as \"sphere\"",
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
            "plot \"A\": curve 0: degree 0: degrees from 1 to 32 are supported",
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
            "plot \"A\": basis: it is not known how many functions: give knots, weights, or count = …",
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
            "plot \"A\": basis: 3 weights for count = 4: each function has one",
        ),
        (
            "{ curves = [{ curve = { bezier = [[0, 0], [1e308, 0], [-1e308, 1]] } }] }",
            "3:8",
            "plot \"A\": it has no finite extent that could be drawn",
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
    // What a file says of no [[plot]] at all is what every subcommand says.
    let sandbox = Sandbox::with(&[("empty.toml", "")]);
    let hint = "there is nothing to show: write an [[object]], with a shape such as \"sphere\"";
    sandbox.run("plot empty.toml -o p.svg").failed(2, &format!("empty.toml: {hint}"));
}

/// An SVG's words and numbers.
fn tokens(svg: &str) -> Vec<Result<f64, &str>> {
    let breaks = |c: char| c.is_whitespace() || "\",=<>()".contains(c);
    let words = svg.split(breaks).filter(|word| !word.is_empty());
    words.map(|word| word.parse().map_err(|_| word)).collect()
}

/// The figures in `renders/` are those of `scenes/`, drawn again. Cosines and the like are the
/// system library's: a number may be off by one unit, a 32nd of a pixel.
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

/// The filled areas of a colour, in pixels.
fn areas(svg: &str, color: &str) -> Vec<Vec<[f64; 2]>> {
    let points = attributes(svg, "polygon", "points");
    let colors = attributes(svg, "polygon", "fill");
    assert_eq!(points.len(), colors.len());
    let drawn = points.iter().zip(&colors).filter(|(_, found)| **found == color);
    let pixels = |text: &str| -> Vec<[f64; 2]> {
        numbers(text).chunks(2).map(|at| [at[0] / SUBPIXELS, at[1] / SUBPIXELS]).collect()
    };
    drawn.map(|(points, _)| pixels(points)).collect()
}

/// The area a closed polygon winds around, each part as often as it does.
fn area(polygon: &[[f64; 2]]) -> f64 {
    let pairs = polygon.iter().zip(polygon.iter().cycle().skip(1));
    0.5 * pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>().abs()
}

const KEPT: &str = "#DEECF6";

/// A square with a round hole, an island in it, and a notch at its border.
const TRIMMED: &str = "
[[object]]
name = \"sheet\"
shape = { plane = { width = 2, height = 2 } }
[object.trims]
keep = \"outside\"
loops = [
    { circle = { center = [0.5, 0.5], radius = 0.25 } },
    { polygon = [[0.4, 0.4], [0.6, 0.4], [0.6, 0.6], [0.4, 0.6]] },
    { curves = [
        { bezier = [[-0.1, 0.1], [0.1, 0.1], [0.1, 0.3], [-0.1, 0.3]] },
        { polyline = [[-0.1, 0.3], [-0.1, 0.1]] },
    ] },
]
";

#[test]
fn trims_are_where_they_should_be_and_what_they_keep_is_filled() {
    let svg =
        plotted(&format!("[[plot]]\nshow = {{ trims = {{ of = \"sheet\" }} }}\n{TRIMMED}"), "");
    // The domain's border is the unit square.
    let border = &polylines(&svg, "#282828", 1.0);
    let border = border.iter().find(|line| line.len() == 5).unwrap();
    let axes = Axes::new([border[0], border[2]], [[0.0, 0.0], [1.0, 1.0]]);
    let unit = axes.unit[0];
    assert!((unit - axes.unit[1]).abs() < 0.01, "{:?}", axes.unit);

    let circle = &polylines(&svg, RED, CURVE)[0];
    assert!(circle.len() > 20);
    for &pixel in circle {
        let [u, v] = axes.point(pixel);
        let off = ((u - 0.5).hypot(v - 0.5) - 0.25).abs() * unit;
        assert!(off <= TOLERANCE + 3.0 * ROUNDING, "{off} pixels off");
    }
    // The Bézier curve from (-0.1, 0.1) bulges to u = 0.05 where v = 0.2.
    let bezier = &polylines(&svg, GREEN, CURVE)[0];
    let bulge = bezier.iter().map(|&pixel| axes.point(pixel)[0]);
    assert!((bulge.fold(f64::MIN, f64::max) - 0.05).abs() * unit < 0.2);

    // Filled is the square without the ring and without the part of the notch in it: of the
    // curve (0.3 t − 0.3 t² … − 0.1, …), u = 0.6 t (1 − t) − 0.1, v = 0.1 + 0.6 t² − 0.4 t³.
    let filled = areas(&svg, KEPT);
    assert_eq!(filled.len(), 1);
    let steps = 10_000;
    let notch: f64 = (0..steps)
        .map(|k| {
            let t = (f64::from(k) + 0.5) / f64::from(steps);
            let (u, dv) = (0.6 * t * (1.0 - t) - 0.1, 1.2 * t - 1.2 * t * t);
            u.max(0.0) * dv / f64::from(steps)
        })
        .sum();
    let expected = 1.0 - (std::f64::consts::PI / 16.0 - 0.04) - notch;
    let found = area(&filled[0]) / unit / unit;
    assert!((found - expected).abs() < 1e-3, "{found} for {expected}");
    for word in ["loop 0", "loop 2", "kept", "lines", "arcs", "Bézier curves", "control points"] {
        assert!(svg.contains(word), "{word}");
    }

    // A scene without [[plot]] gets the same panel, and a mirrored object mirrored loops.
    let sandbox = Sandbox::with(&[
        ("s.toml", TRIMMED),
        ("r.toml", &TRIMMED.replace("[object.trims]", "reverse = true\n[object.trims]")),
        ("c.toml", &TRIMMED.replace("[0.4, 0.6]] }", "[0.4, 0.6], [0.4, 0.4]] }")),
    ]);
    sandbox.run("plot s.toml -o s.svg").succeeded();
    let chosen = String::from_utf8(sandbox.bytes("s.svg")).unwrap();
    // Nor does a corner given again at the end make another polygon.
    sandbox.run("plot c.toml -o c.svg").succeeded();
    assert_eq!(String::from_utf8(sandbox.bytes("c.svg")).unwrap(), chosen);
    assert!(chosen.contains("Trims of sheet") && areas(&chosen, KEPT).len() == 1);
    sandbox.run("plot r.toml -o r.svg").succeeded();
    let mirrored = String::from_utf8(sandbox.bytes("r.svg")).unwrap();
    let bulge = |svg: &str| {
        let curve = polylines(svg, GREEN, CURVE)[0].clone();
        curve[curve.len() / 2][0] - curve[0][0]
    };
    assert!(bulge(&chosen) > 5.0 && (bulge(&chosen) + bulge(&mirrored)).abs() < 0.1);
}

#[test]
fn bases_of_too_many_functions_are_left_out_with_a_warning() {
    let model = |count: usize| {
        let knots: Vec<f64> = (0..count).map(|k| k as f64).collect();
        let points: Vec<[usize; 3]> =
            (0..count).flat_map(|x| [0, 1].map(|y| [x, y, x % 2])).collect();
        let (first, last) = (knots[0], knots[count - 1]);
        format!(
            "{{\"degree_u\": 1, \"degree_v\": 1, \"size_u\": {count}, \"size_v\": 2,\n\
             \"knotvector_u\": {:?}, \"knotvector_v\": [0, 0, 1, 1],\n\
             \"control_points\": {{\"points\": {points:?}}}}}",
            [&[first], &knots[..], &[last]].concat()
        )
    };
    let sandbox = Sandbox::with(&[("few.json", &model(1000)), ("many.json", &model(1001))]);
    let few = sandbox.run("plot few.json -o few.svg").succeeded();
    assert!(!few.stderr.contains("not plotted"), "{}", few.stderr);
    let many = sandbox.run("plot many.json -o many.svg").succeeded();
    let warning = "basis functions of many, u are not plotted: more than 1000 functions";
    assert!(many.stderr.contains(warning), "{}", many.stderr);
    let panels = |file: &str| {
        let svg = String::from_utf8(sandbox.bytes(file)).unwrap();
        [svg.contains("many, u") || svg.contains("few, u"), svg.contains(", v")]
    };
    assert_eq!([panels("few.svg"), panels("many.svg")], [[true, true], [false, true]]);
}

#[test]
fn triangles_and_cages_are_drawn_in_space() {
    // An octant of the unit sphere, seen along z: its borders are the axes and a quarter circle.
    let octant = "[[plot]]\nplane = \"xy\"\nshow = { surfaces = { of = \"o\", lines = 1 } }\n\
                  [[object]]\nname = \"o\"\nshape = { octant_quartic = { radius = 1 } }\n";
    let svg = plotted(octant, "");
    let borders: Vec<_> = polylines(&svg, BLUE, 1.6).into_iter().filter(|l| l.len() > 2).collect();
    assert_eq!(borders.len(), 3);
    let all: Vec<[f64; 2]> = borders.iter().flatten().copied().collect();
    let least = all.iter().fold([f64::MAX, f64::MIN], |m, p| [m[0].min(p[0]), m[1].max(p[1])]);
    let most = all.iter().fold([f64::MIN, f64::MAX], |m, p| [m[0].max(p[0]), m[1].min(p[1])]);
    let axes = Axes::new([least, most], [[0.0, 0.0], [1.0, 1.0]]);
    for &pixel in &all {
        let [x, y] = axes.point(pixel);
        let off = x.abs().min(y.abs()).min((x.hypot(y) - 1.0).abs()) * axes.unit[0];
        assert!(off <= 0.2, "({x}, {y}) is {off} pixels off");
    }
    assert!(svg.contains("curves of constant parameter") && !svg.contains("control points"));

    // Without [[plot]], too: nothing is left out because it has no knots.
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let sandbox = Sandbox::with(&[
        ("o.toml", &octant[octant.find("[[object").unwrap()..]),
        ("cube.obj", cube),
    ]);
    for (input, title, rings) in [("o.toml", "o in space", 15), ("cube.obj", "cube in space", 8)] {
        let run = sandbox.run(&format!("plot {input} -o p.svg")).succeeded();
        assert_eq!(run.stderr, "1 plot; wrote p.svg\n");
        let svg = String::from_utf8(sandbox.bytes("p.svg")).unwrap();
        assert!(svg.contains(title) && svg.contains("control points"), "{title}");
        // Two circles a ring, and one in the legend.
        assert_eq!(attributes(&svg, "circle", "r").len(), 2 * rings + 1);
    }
}

/// A Doo–Sabin surface ends within the faces of an open cage: that of a flat grid of unit squares
/// half a square inside its border, and no line of it leaves that square.
#[test]
fn lines_of_an_open_doo_sabin_surface_end_where_it_does() {
    let points: Vec<_> = (0..16).map(|k| format!("[{}, {}, 0]", k % 4, k / 4)).collect();
    let face = |k: usize| {
        let corner = k / 3 * 4 + k % 3;
        format!("[{corner}, {}, {}, {}]", corner + 1, corner + 5, corner + 4)
    };
    let faces: Vec<_> = (0..9).map(face).collect();
    let text = format!(
        "[[plot]]\nshow = {{ surfaces = {{ of = \"g\", net = true, lines = 1 }} }}\n[[object]]\n\
         name = \"g\"\nshape = {{ doo_sabin = {{ points = [{}], faces = [{}] }} }}\n",
        points.join(", "),
        faces.join(", ")
    );
    let svg = plotted(&text, "");
    // The rings of the cage's vertices: the first at (0, 0), the last but the legend's at (3, 3).
    let rings: Vec<[f64; 2]> = svg
        .split("<circle cx=\"")
        .skip(1)
        .map(|rest| {
            let mut quoted = rest.split('"').step_by(2);
            [(); 2].map(|()| quoted.next().unwrap().parse::<f64>().unwrap() / SUBPIXELS)
        })
        .collect();
    let axes = Axes::new([rings[0], rings[rings.len() - 2]], [[0.0, 0.0], [3.0, 3.0]]);
    // Borders: those of the surface, and twice the inner ones of faces; between them the middles
    // of faces, on the border half of the time.
    for (color, width, expected) in [(BLUE, 1.6, 8.0 + 16.0), ("#56B4E9", 1.0, 12.0)] {
        let lines = polylines(&svg, color, width);
        let mut length = 0.0;
        for line in lines.iter().filter(|line| line.len() > 2) {
            let points: Vec<_> = line.iter().map(|&pixel| axes.point(pixel)).collect();
            for &point in &points {
                assert!(point.iter().all(|x| (0.49..2.51).contains(x)), "{color}: {point:?}");
            }
            length += points
                .windows(2)
                .map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]))
                .sum::<f64>();
        }
        assert!((length - expected).abs() < 0.05, "{color}: {length} for {expected}");
    }
}

/// At a knot of multiplicity p + 1 functions end as high as others begin: they jump, and no line
/// is drawn down to zero.
#[test]
fn basis_functions_that_jump_are_broken_there() {
    for weights in ["", "weights = [1, 2, 1, 3, 1, 1]\n"] {
        let text = format!(
            "[[plot]]\n[plot.show.basis]\ndegree = 2\nknots = [0, 0, 0, 1, 1, 1, 2, 2, 2]\n{weights}"
        );
        let svg = plotted(&text, "--size 640x480");
        // The axis at zero, from t = 0 to t = 2.
        let axis = polylines(&svg, GREY, 1.0);
        let axis = axis.iter().find(|line| line.len() == 2 && line[0][1] == line[1][1]).unwrap();
        let jumps = polylines(&svg, GREEN, CURVE); // the third function, and its legend
        let line = jumps.iter().find(|line| line.len() > 4).unwrap();
        let [first, last] = [line[0], line[line.len() - 1]];
        assert!((first[1] - axis[0][1]).abs() < 0.1, "it begins at zero: {first:?}");
        assert!((last[0] - 0.5 * (axis[0][0] + axis[1][0])).abs() < 0.1, "and ends at t = 1");
        assert!(last[1] < axis[0][1] - 100.0, "high up: {last:?}");
    }
}
