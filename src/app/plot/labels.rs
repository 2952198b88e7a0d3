//! Where labels go: beside their points, off lines and other labels.

use glam::DVec2;

use super::flatten::flatten;
use super::panel::{Item, Panel};
use super::view::View;

/// The directions a label may lie in from its point.
const DIRECTIONS: u32 = 24;

/// The gaps allowed between a label and its point, in pixels: nearer is better.
const GAPS: [f64; 4] = [6.0, 11.0, 18.0, 28.0];

/// Costs of a place for a label: over a line (for each pixel of its length), over a point, over
/// another label, off the plot (high: the label would be cut off), in another direction than
/// wished (for a right angle), farther off.
const ON_LINE: f64 = 1.0;
const ON_MARK: f64 = 20.0;
const ON_LABEL: f64 = 60.0;
const OFF_PLOT: f64 = 1000.0;
const ASTRAY: f64 = 1.5;
const FAR: f64 = 1.2;

/// Where all places cost more than this, some line runs through the label.
const CROWDED: f64 = 20.0;

/// An axis-parallel box in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct LabelBox {
    pub(super) middle: DVec2,
    pub(super) half: DVec2,
}

impl LabelBox {
    fn holds(&self, point: DVec2) -> bool {
        (point - self.middle).abs().cmple(self.half).all()
    }

    fn overlaps(&self, other: &Self) -> bool {
        (other.middle - self.middle).abs().cmplt(self.half + other.half).all()
    }
}

/// The boxes of a panel's labels, in their order, in pixels from the lower left of the plot.
/// `size` gives the size of a text. Each label in turn takes the cheapest place left.
pub(super) fn placed(panel: &Panel, view: View, size: impl Fn(&str) -> DVec2) -> Vec<LabelBox> {
    let (lines, marks) = obstacles(panel, view);
    let mut boxes: Vec<LabelBox> = Vec::new();
    for item in &panel.items {
        let Item::Label { at, towards, text, .. } = item else { continue };
        let (at, half) = (view.to_pixels(*at), 0.5 * size(text));
        let wished = towards.normalize_or(DVec2::Y);
        let mut best = (f64::INFINITY, LabelBox { middle: at, half });
        let mut try_at = |step: usize, (direction, away): (DVec2, DVec2)| {
            let place = LabelBox { middle: at + away, half };
            let corners = [place.middle - half, place.middle + half];
            let outside =
                corners.into_iter().any(|c| !(c.cmpge(DVec2::ZERO) & c.cmple(view.pixels)).all());
            let cost = ON_LINE * lines.iter().filter(|&&p| place.holds(p)).count() as f64
                + ON_MARK * marks.iter().filter(|&&p| place.holds(p)).count() as f64
                + ON_LABEL * boxes.iter().filter(|other| place.overlaps(other)).count() as f64
                + if outside { OFF_PLOT } else { 0.0 }
                + ASTRAY * (1.0 - direction.dot(wished))
                + FAR * step as f64;
            if cost < best.0 {
                best = (cost, place);
            }
            best.0
        };
        let mut least = f64::INFINITY;
        for (step, gap) in GAPS.into_iter().enumerate() {
            for k in 0..DIRECTIONS {
                let angle = std::f64::consts::TAU * f64::from(k) / f64::from(DIRECTIONS);
                let direction = DVec2::from_angle(angle);
                // From the middle of the box to its border.
                let reach = (half / direction.abs()).min_element();
                least = try_at(step, (direction, (gap + reach) * direction));
            }
        }
        if least > CROWDED {
            for (step, gap) in GAPS.into_iter().enumerate() {
                for corner in CORNERS {
                    // A wide box beside its point, above or below its height.
                    let away = corner * (half + DVec2::new(gap, 0.5 * gap));
                    try_at(step, (corner.normalize(), away));
                }
            }
        }
        boxes.push(best.1);
    }
    boxes
}

/// The quadrants in which a label may begin beside its point.
const CORNERS: [DVec2; 4] =
    [DVec2::ONE, DVec2::new(1.0, -1.0), DVec2::new(-1.0, 1.0), DVec2::NEG_ONE];

/// Points about a pixel apart along all lines, and the points that are marked.
fn obstacles(panel: &Panel, view: View) -> (Vec<DVec2>, Vec<DVec2>) {
    let (mut along, mut marks) = (Vec::new(), Vec::new());
    let mut trace = |line: &[DVec2]| {
        for ends in line.windows(2) {
            let steps = (ends[0].distance(ends[1])).ceil().clamp(1.0, 1e4) as u32;
            let share = |k| f64::from(k) / f64::from(steps);
            along.extend((0..steps).map(|k| ends[0].lerp(ends[1], share(k))));
        }
    };
    for item in &panel.items {
        match item {
            Item::Curve { path, .. } => {
                let pixels = |t| view.to_pixels((path.at)(t));
                flatten(pixels, &path.pieces, 0.5).iter().for_each(|line| trace(line));
            }
            Item::Line { points, .. } => {
                trace(&points.iter().map(|&p| view.to_pixels(p)).collect::<Vec<_>>());
            }
            Item::Marks { points, .. } => {
                marks.extend(points.iter().map(|&point| view.to_pixels(point)));
            }
            Item::Area { .. } | Item::Arrows { .. } | Item::Label { .. } => {}
        }
    }
    (along, marks)
}

#[cfg(test)]
mod tests {
    use super::super::panel::{GREY, Mark, Scale, Stroke};
    use super::*;

    #[test]
    fn labels_keep_off_lines_marks_labels_and_the_border() {
        let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]];
        let points: Vec<DVec2> = corners.map(DVec2::from).to_vec();
        let label = |at: DVec2| Item::Label {
            at,
            towards: DVec2::X,
            text: "P₁₂, w = 0.3333".into(),
            color: GREY,
        };
        let mut items = vec![
            Item::Line { points: points.clone(), stroke: Stroke::thin(GREY) },
            Item::Marks { points: points.clone(), mark: Mark::Ring, color: GREY },
        ];
        items.extend(points[..4].iter().chain(&points[..4]).map(|&at| label(at)));
        let panel = Panel {
            title: String::new(),
            axes: ["x", "y"].map(str::to_owned),
            scale: Scale::Space,
            items,
            legend: Vec::new(),
        };
        let view = View::of(&panel, DVec2::splat(400.0)).unwrap();
        let size = DVec2::new(90.0, 13.0);
        let boxes = placed(&panel, view, |_| size);
        assert_eq!(boxes.len(), 8);
        let corners: Vec<DVec2> = points.iter().map(|&point| view.to_pixels(point)).collect();
        for (index, label) in boxes.iter().enumerate() {
            assert!((label.middle - label.half).cmpge(DVec2::ZERO).all(), "{label:?}");
            assert!((label.middle + label.half).cmple(view.pixels).all(), "{label:?}");
            assert!(boxes[..index].iter().all(|other| !label.overlaps(other)), "{label:?}");
            let at = corners[index % 4];
            assert!(label.middle.distance(at) < 0.5 * size.length() + 20.0, "far off: {label:?}");
            for edge in corners.windows(2) {
                let near = (0..=400).map(|k| edge[0].lerp(edge[1], f64::from(k) / 400.0));
                assert!(!near.into_iter().any(|p| label.holds(p)), "on a line: {label:?}");
            }
        }
    }
}
