//! What a figure of `nurbray plot` shows, read back from its SVG.

use std::fs;
use std::path::Path;

use crate::sandbox::Sandbox;

/// The picture's own units in a pixel.
pub(crate) const SUBPIXELS: f64 = 32.0;

/// The error bound of a vertex, in pixels: rounding to the picture's units, both ways.
pub(crate) const ROUNDING: f64 = 0.71 / SUBPIXELS;

/// How far a curve may be from its polyline, in pixels, as `--help` says.
pub(crate) const TOLERANCE: f64 = 0.1;

/// The values of an attribute in the elements of a kind.
pub(crate) fn attributes<'a>(svg: &'a str, element: &str, name: &str) -> Vec<&'a str> {
    let (open, attribute) = (format!("<{element} "), format!(" {name}=\""));
    let elements = svg.split(open.as_str()).skip(1).map(|rest| rest.split('>').next().unwrap());
    elements.filter_map(|text| text.split(attribute.as_str()).nth(1)?.split('"').next()).collect()
}

pub(crate) fn numbers(text: &str) -> Vec<f64> {
    text.split([',', ' '])
        .filter(|word| !word.is_empty())
        .map(|word| word.parse().unwrap())
        .collect()
}

/// The polylines of a colour, in pixels.
pub(crate) fn polylines(svg: &str, color: &str, width: f64) -> Vec<Vec<[f64; 2]>> {
    let points = attributes(svg, "polyline", "points");
    let colors = attributes(svg, "polyline", "stroke");
    let widths = attributes(svg, "polyline", "stroke-width");
    assert!(points.len() == colors.len() && points.len() == widths.len());
    let drawn = points.iter().zip(colors.iter().zip(&widths)).filter(|(_, (found, wide))| {
        let wide = wide.parse::<f64>().unwrap() / SUBPIXELS;
        **found == color && (wide - width).abs() < 0.05
    });
    drawn
        .map(|(points, _)| {
            numbers(points).chunks(2).map(|at| [at[0] / SUBPIXELS, at[1] / SUBPIXELS]).collect()
        })
        .collect()
}

/// The middles of all circles, in pixels. A ring is two of them.
pub(crate) fn circles(svg: &str) -> Vec<[f64; 2]> {
    let places = svg.split("<circle cx=\"").skip(1).map(|rest| {
        let mut quoted = rest.split('"').step_by(2);
        [(); 2].map(|()| quoted.next().unwrap().parse::<f64>().unwrap() / SUBPIXELS)
    });
    places.collect()
}

pub(crate) const BLUE: &str = "#0072B2";
pub(crate) const RED: &str = "#D55E00";
pub(crate) const GREEN: &str = "#009E73";
pub(crate) const GREY: &str = "#828282";
pub(crate) const CURVE: f64 = 2.2;

/// The map from pixels back to a plot's coordinates, from two points known in both.
pub(crate) struct Axes {
    pub(crate) pixel: [f64; 2],
    pub(crate) point: [f64; 2],
    /// Pixels a unit; upwards counts as positive.
    pub(crate) unit: [f64; 2],
}

impl Axes {
    pub(crate) fn new(pixels: [[f64; 2]; 2], points: [[f64; 2]; 2]) -> Self {
        let unit = |k: usize| {
            let sign = if k == 0 { 1.0 } else { -1.0 };
            sign * (pixels[1][k] - pixels[0][k]) / (points[1][k] - points[0][k])
        };
        Self { pixel: pixels[0], point: points[0], unit: [unit(0), unit(1)] }
    }

    pub(crate) fn point(&self, pixel: [f64; 2]) -> [f64; 2] {
        [
            self.point[0] + (pixel[0] - self.pixel[0]) / self.unit[0],
            self.point[1] - (pixel[1] - self.pixel[1]) / self.unit[1],
        ]
    }
}

pub(crate) fn scene(name: &str) -> String {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    fs::read_to_string(folder.join(name)).unwrap()
}

/// Plots a scene and reads the picture.
pub(crate) fn plotted(scene: &str, options: &str) -> String {
    let sandbox = Sandbox::with(&[("s.toml", scene)]);
    let run = sandbox.run(&format!("plot s.toml -o p.svg {options}")).succeeded();
    assert_eq!(run.stdout, "");
    assert!(run.stderr.ends_with("; wrote p.svg\n") && run.stderr.lines().count() == 1);
    assert_eq!(sandbox.files(), ["p.svg", "s.toml"]);
    String::from_utf8(sandbox.bytes("p.svg")).unwrap()
}
