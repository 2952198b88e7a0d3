//! `nurbray plot`: trims and surfaces, in their parameters and in space.

use crate::figure::{
    Axes, BLUE, CURVE, GREEN, RED, ROUNDING, SUBPIXELS, TOLERANCE, attributes, circles, numbers,
    plotted, polylines,
};
use crate::sandbox::Sandbox;

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

/// The area that a closed polygon winds around, each part counted as often as it does so.
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

    // The square is filled, except the ring and the part of the notch in the square: of the
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
        ("x.toml", &TRIMMED.replace("[object.trims]", "swap_uv = true\n[object.trims]")),
        (
            "xr.toml",
            &TRIMMED.replace("[object.trims]", "swap_uv = true\nreverse = true\n[object.trims]"),
        ),
        ("c.toml", &TRIMMED.replace("[0.4, 0.6]] }", "[0.4, 0.6], [0.4, 0.4]] }")),
    ]);
    sandbox.run("plot s.toml -o s.svg").succeeded();
    let chosen = String::from_utf8(sandbox.bytes("s.svg")).unwrap();
    // A corner given again at the end makes no other polygon.
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
    // With u and v exchanged, what bulged to the right bulges up; on the paper y runs down.
    let rise = |svg: &str| {
        let curve = polylines(svg, GREEN, CURVE)[0].clone();
        let chord =
            [curve[curve.len() - 1][0] - curve[0][0], curve[curve.len() - 1][1] - curve[0][1]];
        let middle = curve[curve.len() / 2];
        [middle[0] - curve[0][0] - 0.5 * chord[0], middle[1] - curve[0][1] - 0.5 * chord[1]]
    };
    for name in ["x", "xr"] {
        sandbox.run(&format!("plot {name}.toml -o {name}.svg")).succeeded();
        let svg = String::from_utf8(sandbox.bytes(&format!("{name}.svg"))).unwrap();
        let ([right, _], [_, down]) = (rise(&chosen), rise(&svg));
        assert!(right > 5.0 && down < -3.0, "{name}: {right} {down}");
        let [kept, as_written] = [&svg, &chosen].map(|svg| areas(svg, KEPT).len());
        assert_eq!(kept, as_written, "{name}");
    }
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

/// The Doo–Sabin surface of an open cage ends within the cage's faces: over a flat grid of unit
/// squares, half a square inside the border. No line of the figure leaves that square.
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
    let rings = circles(&svg);
    let axes = Axes::new([rings[0], rings[rings.len() - 2]], [[0.0, 0.0], [3.0, 3.0]]);
    // The border of the surface and, twice, the inner borders of faces; then the middle lines of
    // faces: six of length 2, four of them on the border.
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

/// A loop along two sides of the domain: these are borders, and the diagonal is an edge.
#[test]
fn sides_of_loops_along_the_border_are_drawn_as_borders() {
    let text = "[[plot]]\nshow = { surfaces = { of = \"p\", lines = 0 } }\n[[object]]\nname = \"p\"\n\
                shape = { plane = { width = 2, height = 2 } }\n\
                trims = { loops = [{ polygon = [[0, 0], [1, 0], [0, 1]] }] }\n";
    let svg = plotted(text, "");
    // Lines of two points are those of the legend.
    let drawn = |color| polylines(&svg, color, 1.6).into_iter().filter(|line| line.len() > 2);
    assert_eq!((drawn(BLUE).count(), drawn(RED).count()), (2, 1));
    let length = |line: Vec<[f64; 2]>| {
        let last = line[line.len() - 1];
        (last[0] - line[0][0]).hypot(last[1] - line[0][1])
    };
    let side = drawn(BLUE).map(length).fold(0.0, f64::max);
    let edge = drawn(RED).map(length).fold(0.0, f64::max);
    assert!((edge / side - std::f64::consts::SQRT_2).abs() < 1e-3, "{edge} and {side}");
}

/// The corners of a box of size 2 × 3 × 1 in the isometric view: its three edges at a corner are
/// seen as equally long for their lengths, at angles of 120° to each other.
#[test]
fn what_varies_in_all_coordinates_is_seen_from_an_oblique_direction() {
    let plot = "[[object]]\nname = \"o\"\n[object.shape.catmull_clark]\n\
                points = [[0, 0, 0], [2, 0, 0], [2, 3, 0], [0, 3, 0], [0, 0, 1], [2, 0, 1], [2, 3, 1], \
                [0, 3, 1]]\nfaces = [[3, 2, 1, 0], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], \
                [2, 3, 7, 6], [3, 0, 4, 7]]\n\
                [[plot]]\nshow = { surfaces = { of = \"o\", net = true, lines = 0 } }\n";
    let sandbox = Sandbox::with(&[
        ("auto.toml", plot),
        ("iso.toml", &format!("{plot}view = [1, -1, 1]\n")),
        ("xy.toml", &format!("{plot}plane = \"xy\"\n")),
    ]);
    let rings = |name: &str| -> (String, Vec<[f64; 2]>) {
        sandbox.run(&format!("plot {name}.toml -o {name}.svg")).succeeded();
        let svg = String::from_utf8(sandbox.bytes(&format!("{name}.svg"))).unwrap();
        let places = circles(&svg).into_iter().step_by(2).collect();
        (svg, places)
    };
    let (svg, places) = rings("iso");
    let step = |from: usize, to: usize| [0, 1].map(|k| places[to][k] - places[from][k]);
    let (x, y, z) = (step(0, 1), step(0, 3), step(0, 4));
    let unit = z[1].abs();
    for (edge, expected) in
        [(x, [2.0 * 0.75_f64.sqrt(), 1.0]), (y, [3.0 * 0.75_f64.sqrt(), -1.5]), (z, [0.0, -1.0])]
    {
        let off = [0, 1].map(|k| (edge[k] / unit - expected[k]).abs());
        assert!(off.iter().all(|&off| off * unit <= 4.0 * ROUNDING), "{edge:?}, {unit}: {off:?}");
    }
    for name in ["x", "y", "z"] {
        assert!(svg.contains(&format!("\n{name}\n")), "an axis is called {name}");
    }
    // All eight corners are seen apart if nothing is said, but not along z.
    let distinct = |places: &[[f64; 2]]| {
        let near = |a: &[f64; 2], b: &[f64; 2]| (a[0] - b[0]).hypot(a[1] - b[1]) < 3.0;
        let apart = (0..8).filter(|&k| !places[..k].iter().any(|other| near(other, &places[k])));
        apart.count()
    };
    assert_eq!((distinct(&rings("auto").1), distinct(&rings("xy").1)), (8, 4));
}
