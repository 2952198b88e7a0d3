//! `nurbray plot`: functions of a parameter are those of the closed forms.

use crate::figure::{
    Axes, BLUE, CURVE, GREEN, GREY, RED, ROUNDING, attributes, plotted, polylines,
};
use crate::sandbox::Sandbox;

/// The deck's knots of degree 3.
const DECK: &str = "[0, 0, 0, 0, 1, 2, 3, 4, 4, 4, 4]";

/// The curves of a colour that are drawn, without the line of the legend.
fn drawn(svg: &str, color: &str) -> Vec<Vec<[f64; 2]>> {
    let mut lines = polylines(svg, color, CURVE);
    lines.pop();
    lines
}

/// Over the knots of degree 3, N₃,₀ to N₆,₀ are boxes one after the other, and the six others
/// keep their names and colours.
#[test]
fn functions_of_degree_0_are_boxes() {
    let text = format!("[[plot]]\nshow = {{ basis = {{ degree = 0, knots = {DECK} }} }}\n");
    let svg = plotted(&text, "--size 640x480");
    let zero = &polylines(&svg, GREY, 1.0)[0];
    for color in [BLUE, RED] {
        assert!(drawn(&svg, color).iter().all(|line| line[0][1] != zero[0][1]), "{color}");
    }
    let first = &drawn(&svg, "#CC79A7")[0];
    let axes = Axes::new([zero[0], [zero[1][0], first[0][1]]], [[0.0, 0.0], [4.0, 1.0]]);
    for (index, color) in ["#CC79A7", "#E69F00", "#56B4E9", "#3C3C3C"].into_iter().enumerate() {
        let line = &drawn(&svg, color)[0];
        let ends = [line[0], line[line.len() - 1]].map(|pixel| axes.point(pixel));
        for (end, t) in ends.into_iter().zip([index as f64, index as f64 + 1.0]) {
            assert!((end[0] - t).abs() * axes.unit[0] <= 2.0 * ROUNDING, "{color}: {end:?}");
            assert!((end[1] - 1.0).abs() * axes.unit[1] <= 2.0 * ROUNDING, "{color}: {end:?}");
        }
    }
    for word in ["N₀ = 0", "N₂ = 0", "N₃", "N₆", "N₇ = 0", "×4"] {
        assert!(svg.contains(&format!("\n{word}\n")), "{word}");
    }
}

/// N₀,₃ over 0, 1, 2, 3, 4: the fourth difference of (t − k)³₊ / 3!, at every vertex.
#[test]
fn one_function_is_drawn_on_its_support() {
    let text = "[[plot]]\n[plot.show.basis]\ndegree = 3\nknots = [0, 1, 2, 3, 4]\nsupport = true\n";
    let svg = plotted(text, "--size 640x480");
    let curve = &drawn(&svg, BLUE)[0];
    let top = curve.iter().copied().min_by(|a, b| a[1].total_cmp(&b[1])).unwrap();
    let zero = &polylines(&svg, GREY, 1.0)[0];
    let axes = Axes::new([zero[0], [zero[1][0], top[1]]], [[0.0, 0.0], [4.0, 2.0 / 3.0]]);
    let cube = |x: f64| x.max(0.0).powi(3);
    let cubic =
        |t: f64| (cube(t) - 4.0 * cube(t - 1.0) + 6.0 * cube(t - 2.0) - 4.0 * cube(t - 3.0)) / 6.0;
    assert!(curve.len() > 20);
    for &pixel in curve {
        let [t, value] = axes.point(pixel);
        let off = (value - cubic(t)).abs() * axes.unit[1];
        // Steepest is 1/2 at t = 1 and 3.
        let slack = 3.0 * ROUNDING * (1.0 + 0.5 * axes.unit[1] / axes.unit[0]);
        assert!(off <= slack, "t = {t}: {value} is {off} pixels off");
    }
}

/// The deck's formula, N′ᵢ,₃ = 3 N ᵢ,₂ / (tᵢ₊₃ − tᵢ) − 3 Nᵢ₊₁,₂ / (tᵢ₊₄ − tᵢ₊₁): N′₀,₃ is −3 (1 −
/// t)², and Bernstein's B′₁,₃ is 3 (1 − t)² − 6 t (1 − t).
#[test]
fn derivatives_of_basis_functions_are_the_deck_s() {
    let text = "[[plot]]\n[plot.show.basis]\ndegree = 3\ncount = 4\nderivative = 1\n";
    let svg = plotted(text, "--size 640x480");
    let zero = &polylines(&svg, GREY, 1.0)[0];
    let first = &drawn(&svg, BLUE)[0];
    let axes = Axes::new([first[0], zero[1]], [[0.0, -3.0], [1.0, 0.0]]);
    let b0 = |t: f64| -3.0 * (1.0 - t).powi(2);
    let b1 = |t: f64| 3.0 * (1.0 - t).powi(2) - 6.0 * t * (1.0 - t);
    for (color, function) in [(BLUE, &b0 as &dyn Fn(f64) -> f64), (RED, &b1)] {
        let curve = &drawn(&svg, color)[0];
        assert!(curve.len() > 20);
        for &pixel in curve {
            let [t, value] = axes.point(pixel);
            let off = (value - function(t)).abs() * axes.unit[1];
            let slack = 3.0 * ROUNDING * (1.0 + 12.0 * axes.unit[1] / axes.unit[0]);
            assert!(off <= slack, "t = {t}: {value} is {off} pixels off");
        }
    }
    for word in ["N′", "N₀′", "N₃′", "Basis functions of degree 3: first derivatives"] {
        assert!(svg.contains(&format!("\n{word}\n")), "{word}");
    }
    // The third is constant between the knots, and jumps there.
    let text = text.replace("derivative = 1", "derivative = 3").replace("count = 4", "count = 5");
    let svg = plotted(&text, "--size 640x480");
    let pieces = drawn(&svg, RED);
    assert_eq!(pieces.len(), 2);
    for piece in pieces {
        assert!(piece.iter().all(|pixel| pixel[1] == piece[0][1]), "{piece:?}");
    }
}

/// N₇ has the colour of N₀ but is dashed: more than half of it is drawn, in parts.
#[test]
fn functions_whose_colours_come_again_are_dashed() {
    let text = "[[plot]]\nshow = { basis = { degree = 3, count = 12 } }\n";
    let svg = plotted(text, "--size 640x480");
    let length = |lines: &[Vec<[f64; 2]>]| -> f64 {
        let parts = lines.iter().flat_map(|line| line.windows(2));
        parts.map(|ends| (ends[1][0] - ends[0][0]).hypot(ends[1][1] - ends[0][1])).sum()
    };
    // N₂ and N₉ are each other's mirror image.
    let green = polylines(&svg, "#009E73", CURVE);
    let whole: Vec<_> = green.iter().filter(|line| line.len() > 30).cloned().collect();
    assert_eq!(whole.len(), 1);
    let legend =
        |line: &&Vec<[f64; 2]>| line[0][1] == line[line.len() - 1][1] && line[0][1] > 400.0;
    let dashes: Vec<_> =
        green.iter().filter(|line| line.len() <= 30 && !legend(line)).cloned().collect();
    assert!(dashes.len() > 30, "{} dashes", dashes.len());
    for dash in &dashes[..dashes.len() - 1] {
        assert!((length(std::slice::from_ref(dash)) - 7.0).abs() < 0.1, "{dash:?}");
    }
    let share = length(&dashes) / length(&whole);
    assert!((share - 7.0 / 10.5).abs() < 0.02, "{share}");
}

/// At a cusp the curvature has no bound: the plot says where it is cut off, and marks the place.
#[test]
fn curvature_without_bound_is_cut_off_and_says_so() {
    let plot = |points: &str| {
        let text =
            format!("[[plot]]\nshow = {{ curvature = {{ curve = {{ bezier = {points} }} }} }}\n");
        plotted(&text, "--size 640x480")
    };
    // x′ = 12 τ², y′ = −6 τ for τ = t − 1/2: the curvature is (1 + 4τ²)^(−3/2) / (3 |τ|), which is
    // 10.6 where τ is two of the 64 parts of the domain.
    let svg = plot("[[0, 0], [1, 1], [0, 1], [1, 0]]");
    assert!(svg.contains("\ncut off at 11\n"));
    let branches = drawn(&svg, BLUE);
    assert_eq!(branches.len(), 2);
    let top = |line: &Vec<[f64; 2]>| line.iter().map(|p| p[1]).fold(f64::INFINITY, f64::min);
    assert!((top(&branches[0]) - top(&branches[1])).abs() < 1.0, "both end at the limit");
    let arrows = attributes(&svg, "polygon", "fill").into_iter().filter(|fill| *fill == BLUE);
    assert_eq!(arrows.count(), 1);
    // Nearly a cusp, and finite.
    let svg = plot("[[0, 0], [1, 1], [0.4, 1], [1.4, 0]]");
    assert!(!svg.contains("cut off") && drawn(&svg, BLUE).len() == 1);
}

#[test]
fn bases_that_are_none_are_told_with_their_place() {
    for (basis, place, message) in [
        (
            "degree = 3, knots = [0, 1, 2, 3, 4]",
            "3:40",
            "5 knots of degree 3: at least 8 are needed, or 5 with support = true",
        ),
        (
            "degree = 3, knots = [0, 1, 2, 3], support = true",
            "3:40",
            "4 knots of degree 3: at least 5 are needed for one function",
        ),
        ("degree = 33, knots = [0, 1]", "3:41", "degree 33: degrees from 0 to 32 are supported"),
        (
            "degree = 2, count = 5, derivative = 3",
            "3:56",
            "derivative = 3: at most 2 is possible, the degree",
        ),
        ("degree = 0, knots = [1, 1, 1]", "3:40", "all knots are 1: two must differ"),
        (
            "degree = 1, knots = [0, 1, 1, 1, 2, 2], count = 5",
            "3:40",
            "6 knots, but 5 points of degree 1 need 7",
        ),
        (
            "degree = 2, knots = [0, 0, 1, 1, 1, 2]",
            "3:40",
            "the domain [1, 1] is empty: knots 2 and 3 (counted from 0) must differ",
        ),
        ("degree = 0, weights = [1, 2]", "3:18", "degree 0: degrees from 1 to 32 are supported"),
    ] {
        let text = format!("[[plot]]\ntitle = \"A\"\nshow = {{ basis = {{ {basis} }} }}\n");
        Sandbox::with(&[("s.toml", &text)])
            .run("plot s.toml -o p.svg")
            .failed(2, &format!("s.toml:{place}: plot \"A\": basis: {message}"));
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
