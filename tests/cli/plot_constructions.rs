//! `nurbray plot`: constructions are those of the closed forms.

use crate::figure::{Axes, BLUE, GREY, RED, ROUNDING, plotted, polylines};
use crate::sandbox::Sandbox;

/// The deck's seventh property of Bernstein's basis, as it raises a degree: the new points are
/// `i/(n+1) Pᵢ₋₁ + (1 − i/(n+1)) Pᵢ`.
#[test]
fn elevated_polygons_are_the_deck_s() {
    let mut points = vec![[0.0, 0.0], [1.0, 3.0], [4.0, 3.4], [5.0, 0.5]];
    let text = "[[plot]]\n[plot.show.elevation]\ntimes = 2\n\
                curve = { bezier = [[0, 0], [1, 3], [4, 3.4], [5, 0.5]] }\n";
    let svg = plotted(text, "--size 700x600");
    let polygon = &polylines(&svg, GREY, 1.0)[0];
    let axes = Axes::new([polygon[0], polygon[2]], [points[0], points[2]]);
    for color in [BLUE, RED] {
        let count = points.len() as f64;
        let at = |i: usize| points[i.min(points.len() - 1)];
        points = (0..=points.len())
            .map(|i| {
                let share = i as f64 / count;
                [0, 1].map(|k| share * at(i.max(1) - 1)[k] + (1.0 - share) * at(i)[k])
            })
            .collect();
        let drawn = &polylines(&svg, color, 1.5)[0];
        assert_eq!(drawn.len(), points.len());
        for (&pixel, expected) in drawn.iter().zip(&points) {
            let found = axes.point(pixel);
            let off = (found[0] - expected[0]).hypot(found[1] - expected[1]) * axes.unit[0];
            assert!(off <= 3.0 * ROUNDING, "{color}: {found:?} for {expected:?}");
        }
    }
    for word in ["curve of degree 3", "of degree 4", "of degree 5", "Degree elevation"] {
        assert!(svg.contains(&format!("\n{word}\n")), "{word}");
    }
}

#[test]
fn degrees_that_cannot_be_raised_are_told_with_their_place() {
    for (times, message) in [
        (0, "elevation: times = 0: the degree is to be raised once at least"),
        (31, "degree 33: degrees from 1 to 32 are supported"),
    ] {
        let curve = "curve = { bezier = [[0, 0], [1, 2], [2, 0]] }";
        let text = format!("[[plot]]\nshow.elevation.times = {times}\nshow.elevation.{curve}\n");
        Sandbox::with(&[("s.toml", &text)])
            .run("plot s.toml -o p.svg")
            .failed(2, &format!("s.toml:2:24: plot 0: {message}"));
    }
}
