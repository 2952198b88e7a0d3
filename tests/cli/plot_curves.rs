//! `nurbray plot`: hodographs, data points, and the words around a plot.

use crate::figure::{
    Axes, BLUE, CURVE, GREY, ROUNDING, SUBPIXELS, TOLERANCE, attributes, circles, plotted,
    polylines,
};
use crate::sandbox::Sandbox;

/// The derivative of a cubic runs through the parabola of the differences of its control points,
/// three times as long. That of the quarter circle (1 + i t) / (1 − i t) runs through points of
/// length 2 / (1 + t²) in the direction of the angle 90° + 2 atan t.
#[test]
fn hodographs_are_those_of_closed_forms() {
    let plot =
        |curve: &str| format!("[[plot]]\nshow = {{ hodograph = {{ curve = {{ {curve} }} }} }}\n");
    let svg = plotted(&plot("bezier = [[0, 0], [1, 2], [3, 2], [3, 0]]"), "--size 700x600");
    let control = [[3.0, 6.0], [6.0, 0.0], [0.0, -6.0]];
    let polygon = &polylines(&svg, GREY, 1.0)[0];
    assert_eq!(polygon.len(), 3);
    let axes = Axes::new([polygon[0], polygon[2]], [control[0], control[2]]);
    let curve = &polylines(&svg, BLUE, CURVE)[0];
    for &pixel in curve {
        let [x, y] = axes.point(pixel);
        let t = 0.5 - y / 12.0;
        let expected = 3.0 * (1.0 - t).powi(2) + 12.0 * t * (1.0 - t);
        let off = (x - expected).abs() * axes.unit[0];
        assert!(off <= TOLERANCE + 4.0 * ROUNDING, "({x}, {y}) is {off} pixels off");
    }
    for word in ["Hodograph: first derivative", "D₀", "D₂", "t = 0 (×4)", "C′", "origin"] {
        assert!(svg.contains(&format!("\n{word}\n")), "{word}");
    }

    let quarter = "nurbs = { degree = 2, points = [[1, 0], [1, 1], [0, 1]], weights = [1, 1, 2] }";
    let svg = plotted(&plot(quarter), "--size 700x600");
    // It runs from (0, 2) to (-1, 0).
    let curve = &polylines(&svg, BLUE, CURVE)[0];
    let axes = Axes::new([curve[0], curve[curve.len() - 1]], [[0.0, 2.0], [-1.0, 0.0]]);
    assert!((axes.unit[0] / axes.unit[1] - 1.0).abs() < 1e-3, "{:?}", axes.unit);
    for &pixel in curve {
        let [x, y] = axes.point(pixel);
        let t = (0.5 * (-x).atan2(y)).tan();
        let off = (x.hypot(y) - 2.0 / (1.0 + t * t)).abs() * axes.unit[0];
        assert!(off <= TOLERANCE + 4.0 * ROUNDING, "({x}, {y}) is {off} pixels off");
    }
    assert!(!svg.contains("D₀"), "a rational one has no such control points");

    // With order = 2, the straight line from (3, -12) to (-9, -12).
    let bezier = "bezier = [[0, 0], [1, 2], [3, 2], [3, 0]]";
    let second = plot(bezier).replace(" } } }", " }, order = 2 } }");
    let svg = plotted(&second, "");
    assert!(svg.contains("\nHodograph: second derivative\n") && svg.contains("\nD₁\n"));
    let derivatives = second.replace("hodograph", "derivatives");
    let svg = plotted(&derivatives, "");
    for word in ["x″", "y″", "|C″|", "C″", "Second derivative"] {
        assert!(svg.contains(&format!("\n{word}\n")), "{word}");
    }
}

/// Points are called as they were given, where the control points of pieces are others.
#[test]
fn splines_show_the_points_they_are_made_from() {
    let plot =
        |curve: &str| format!("[[plot]]\nshow = {{ curves = [{{ curve = {{ {curve} }} }}] }}\n");
    let points = [[0.0, 0.0], [1.0, 2.0], [3.0, 2.0], [4.0, 0.0], [2.0, -1.0]];
    for (closed, corners) in [("", 5), (", closed = true", 6)] {
        let spline = "catmull_rom = { points = [[0, 0], [1, 2], [3, 2], [4, 0], [2, -1]]";
        let svg = plotted(&plot(&format!("{spline}{closed} }}")), "");
        let polygon = &polylines(&svg, GREY, 1.0)[0];
        assert_eq!(polygon.len(), corners);
        let axes = Axes::new([polygon[0], polygon[2]], [points[0], points[2]]);
        let rings: Vec<_> = circles(&svg).into_iter().step_by(2).take(5).collect();
        for (&ring, expected) in rings.iter().zip(points) {
            let found = axes.point(ring);
            let off = (found[0] - expected[0]).hypot(found[1] - expected[1]) * axes.unit[0];
            assert!(off <= 3.0 * ROUNDING, "{found:?} for {expected:?}");
        }
        for word in ["P₀", "P₄", "points"] {
            assert!(svg.contains(&format!("\n{word}\n")), "{word}");
        }
        assert!(!svg.contains("P₅") && !svg.contains("control points"));
    }

    let hermite = "hermite = { points = [[0, 0], [2, 1], [4, 0]], \
                   derivatives = [[0, 4], [3, 0], [0, -4]] }";
    let svg = plotted(&plot(hermite), "");
    let tangents = polylines(&svg, GREY, 1.0);
    let axes = Axes::new([tangents[0][0], tangents[1][0]], [[0.0, 0.0], [2.0, 1.0]]);
    for (line, expected) in tangents.iter().zip([[0.0, 4.0 / 3.0], [3.0, 1.0], [4.0, -4.0 / 3.0]]) {
        let [x, y] = axes.point(line[1]);
        let off = (x - expected[0]).hypot(y - expected[1]) * axes.unit[0];
        assert!(line.len() == 2 && off <= 3.0 * ROUNDING, "({x}, {y}) for {expected:?}");
    }
    for word in ["P₀", "P₂", "points", "derivatives × 1/3"] {
        assert!(svg.contains(&format!("\n{word}\n")), "{word}");
    }
    assert!(!svg.contains("P₃"));
}

/// Both ends at a knot where a curve jumps are marked, and each has its label.
#[test]
fn both_ends_are_marked_where_a_curve_jumps() {
    let curve = "nurbs = { degree = 1, knots = [0, 0, 1, 1, 2, 2], \
                 points = [[0, 0], [1, 0], [1, 1], [2, 1]] }";
    let svg = plotted(&format!("[[plot]]\nshow.curves = [{{ curve = {{ {curve} }} }}]\n"), "");
    let diamonds = attributes(&svg, "polygon", "fill").into_iter().filter(|fill| *fill == BLUE);
    assert_eq!(diamonds.count(), 4 + 1, "and one in the legend");
    assert_eq!(svg.matches("t = 1 (×2)").count(), 2);
}

/// One number alone beside an axis shows no scale.
#[test]
fn each_axis_has_two_numbers() {
    let bezier = "[[-4, -4], [-2, 4], [2, -4], [4, 4]]";
    let text =
        format!("[[plot]]\nshow.de_casteljau = {{ curve = {{ bezier = {bezier} }}, t = 0.25 }}\n");
    let svg = plotted(&text, "--size 480x300");
    // The numbers beside the axis upwards end where it begins.
    let upwards = attributes(&svg, "text", "text-anchor").into_iter().filter(|at| *at == "end");
    assert!(upwards.count() > 2, "two numbers and the name");
}

#[test]
fn long_titles_stay_readable() {
    let title = |words: usize| vec!["seven"; words].join(" ");
    let text = |title: &str| format!("[[plot]]\ntitle = \"{title}\"\nshow.blending = \"bezier\"\n");
    let size = |svg: &str, word: &str| {
        let (before, _) = svg.split_once(word).unwrap();
        let (_, size) = before.rsplit_once("font-size=\"").unwrap();
        size.split('"').next().unwrap().parse::<f64>().unwrap() / SUBPIXELS
    };
    for (words, lines) in [(4, 1), (12, 1), (16, 2), (40, 2)] {
        let svg = plotted(&text(&title(words)), "");
        assert!(size(&svg, "seven seven") >= 9.9, "{words} words");
        let in_lines = svg.lines().filter(|line| line.starts_with("seven"));
        assert_eq!(in_lines.count(), lines, "{words} words");
        assert_eq!(svg.contains('…'), words == 40, "{words} words");
    }
}

/// A PNG has only the letters of the built-in font; an SVG file has those of its viewer.
#[test]
fn letters_that_a_png_cannot_show_are_told() {
    let text = "[[plot]]\ntitle = \"曲线 and curve\"\nshow.blending = \"bezier\"\n";
    let sandbox = Sandbox::with(&[("s.toml", text)]);
    let run = sandbox.run("plot s.toml -o p.png").succeeded();
    let told = "warning: p.png: the built-in font has no \"曲\", \"线\"; an SVG file is shown in the \
                viewer's own fonts\n1 plot; wrote p.png\n";
    assert_eq!(run.stderr, told);
    assert_eq!(sandbox.run("plot s.toml -o p.svg").succeeded().stderr, "1 plot; wrote p.svg\n");
}
