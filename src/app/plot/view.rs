//! The part of the plane a plot shows, and its axes.

use glam::DVec2;

use super::panel::{Item, Panel, Scale};
use super::ticks::{Ticks, round_step};

/// The sizes of what stands around a plot, in pixels.
pub(super) const LEFT: f64 = 54.0;
pub(super) const RIGHT: f64 = 18.0;

/// The share of the plot's width and height that is left free around the things shown.
const ROOM: f64 = 0.07;

/// The pixels left free for labels, where points of space have any, and the largest share of the
/// plot that these may take.
const LABEL_ROOM: DVec2 = DVec2::new(48.0, 18.0);
const MOST_LABEL_ROOM: f64 = 0.16;

/// Curves are sampled this often a piece to find their extent. What lies between the samples
/// stays within [`ROOM`].
const LOOKS: u32 = 64;

/// The approximate distance of numbers along an axis in pixels: none touches the next.
const NUMBERS_APART: f64 = 62.0;

/// The smallest gaps between numbers side by side, and beside those on the left, in pixels.
const BETWEEN_NUMBERS: f64 = 6.0;
const BESIDE_NUMBERS: f64 = 9.0;

/// The ranges of both axes, and the size of the plot in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
    pub(super) pixels: DVec2,
}

impl View {
    /// The view that shows all of a panel in this many pixels; `None` if there is nothing to show,
    /// or its extent is not finite.
    pub(super) fn of(panel: &Panel, pixels: DVec2) -> Option<Self> {
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let mut include = |point: DVec2| {
            if point.is_finite() {
                (low, high) = (low.min(point), high.max(point));
            }
        };
        for item in &panel.items {
            match item {
                Item::Curve { path, .. } => {
                    let mut found = path.pieces.is_empty();
                    for &[start, end] in &path.pieces {
                        for k in 0..=LOOKS {
                            let t = start + f64::from(k) / f64::from(LOOKS) * (end - start);
                            let point = (path.at)(t.min(end));
                            found |= point.is_finite();
                            include(point);
                        }
                    }
                    if !found {
                        return None;
                    }
                }
                Item::Area { rings, .. } => rings.iter().flatten().copied().for_each(&mut include),
                Item::Arrows { steps, .. } => {
                    steps.iter().flatten().copied().for_each(&mut include)
                }
                Item::Line { points, .. } | Item::Marks { points, .. } => {
                    points.iter().copied().for_each(&mut include);
                }
                Item::Label { at, .. } => include(*at),
            }
        }
        if let Scale::Function([start, end]) = panel.scale {
            (low.x, high.x) = (start, end);
        }
        let extent = high - low;
        if !extent.is_finite() {
            return None;
        }

        // Things without extent, such as a straight line along an axis, still need a plot.
        let size = extent.max_element();
        let least = if size > 0.0 { 1e-3 * size } else { low.abs().max_element().max(1.0) };
        let room = 1.0 - 2.0 * room(panel, pixels);
        let (shown, middle) = match panel.scale {
            Scale::Space | Scale::View => {
                let unit = (extent / (room * pixels)).max_element().max(least / pixels.x);
                (unit * pixels, 0.5 * low + 0.5 * high)
            }
            Scale::Parameters => (extent.max(DVec2::splat(least)) / room, 0.5 * low + 0.5 * high),
            Scale::Function(_) => {
                let flat = 1e-9 * low.abs().max(high.abs()).y.max(f64::MIN_POSITIVE);
                let height = if extent.y > flat { extent.y / room.y } else { 2.0 * flat.max(1.0) };
                (DVec2::new(extent.x, height), 0.5 * low + 0.5 * high)
            }
        };
        let view = Self { low: middle - 0.5 * shown, high: middle + 0.5 * shown, pixels };
        (view.low.is_finite() && view.high.is_finite()).then_some(view)
    }

    /// A point of the plane in pixels from the lower left of the plot.
    pub(super) fn to_pixels(self, point: DVec2) -> DVec2 {
        (point - self.low) / (self.high - self.low) * self.pixels
    }

    /// The point of the plane at a pixel.
    pub(super) fn point_at(self, pixel: DVec2) -> DVec2 {
        self.low + pixel / self.pixels * (self.high - self.low)
    }

    /// The numbers beside both axes, two on each at least, as one alone shows no scale. In space
    /// they are equally far apart on both, if there is room for them.
    pub(super) fn ticks(self, scale: Scale) -> [Ticks; 2] {
        let unit = (self.high - self.low) / self.pixels * NUMBERS_APART;
        let step = match scale {
            Scale::Space | Scale::View => [round_step(unit.x); 2],
            // Numbers above one another need less room than side by side.
            Scale::Function(_) | Scale::Parameters => {
                [round_step(unit.x), round_step(0.7 * unit.y)]
            }
        };
        let ranges = [0, 1].map(|axis| [self.low[axis], self.high[axis]]);
        let across = |ticks: &Ticks| {
            let pixel = |value: f64| self.to_pixels(DVec2::new(value, 0.0)).x;
            let apart = ticks.step / (self.high.x - self.low.x) * self.pixels.x;
            ticks.labels().all(|(value, width)| {
                let end = pixel(value) + 0.5 * width;
                width + BETWEEN_NUMBERS <= apart && end <= self.pixels.x + RIGHT
            })
        };
        let up = |ticks: &Ticks| ticks.labels().all(|(_, width)| width <= LEFT - BESIDE_NUMBERS);
        let [x, y] = [0, 1].map(|axis| Ticks::finer(ranges[axis], step[axis]));
        let is_common = scale == Scale::Space && across(&Ticks::new(ranges[0], x.min(y)));
        let [x, y] = if is_common { [x.min(y); 2] } else { [x, y] };
        [Ticks::fitting(ranges[0], x, across), Ticks::fitting(ranges[1], y, up)]
    }
}

/// The share of the plot that is left free on each side.
fn room(panel: &Panel, pixels: DVec2) -> DVec2 {
    let labelled = panel.items.iter().any(|item| matches!(item, Item::Label { .. }));
    match panel.scale {
        Scale::Space | Scale::View | Scale::Parameters if labelled => {
            (LABEL_ROOM / pixels).clamp(DVec2::splat(ROOM), DVec2::splat(MOST_LABEL_ROOM))
        }
        _ => DVec2::splat(ROOM),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::plot::panel::{GREY, Mark};

    fn panel(scale: Scale, points: &[[f64; 2]]) -> Panel {
        let points = points.iter().map(|&point| point.into()).collect();
        Panel {
            title: String::new(),
            axes: ["x", "y"].map(str::to_owned),
            scale,
            items: vec![Item::Marks { points, mark: Mark::Dot, color: GREY }],
            legend: Vec::new(),
        }
    }

    #[test]
    fn in_space_a_unit_is_as_long_upwards_as_sideways() {
        let pixels = DVec2::new(400.0, 200.0);
        for points in [[[-1.0, 2.0], [3.0, 2.5]], [[0.0, 0.0], [0.0, 1e8]], [[5.0, 5.0]; 2]] {
            let view = View::of(&panel(Scale::Space, &points), pixels).unwrap();
            let unit = (view.high - view.low) / pixels;
            assert!((unit.x / unit.y - 1.0).abs() < 1e-12, "{view:?}");
            for point in points {
                let at = view.to_pixels(point.into());
                assert!(at.cmpge(DVec2::ZERO).all() && at.cmple(pixels).all(), "{at}");
                assert!(view.point_at(at).distance(point.into()) <= 1e-13 * view.high.length());
            }
            let apart = view.ticks(Scale::Space).map(|ticks| ticks.values[1] - ticks.values[0]);
            assert!((apart[0] / apart[1] - 1.0).abs() < 1e-12, "{apart:?}");
        }
        assert_eq!(View::of(&panel(Scale::Space, &[]), pixels), None);
        assert_eq!(View::of(&panel(Scale::Space, &[[-1e308, 0.0], [1e308, 0.0]]), pixels), None);
    }

    #[test]
    fn functions_fill_their_domain_and_some_of_the_height() {
        let view = View::of(
            &panel(Scale::Function([0.0, 3.0]), &[[0.0, 0.0], [3.0, 1.0]]),
            DVec2::new(400.0, 300.0),
        );
        let view = view.unwrap();
        assert_eq!((view.low.x, view.high.x), (0.0, 3.0));
        assert!((view.low.y + 1.0 / 0.86 * ROOM).abs() < 1e-12);
        // What is constant has a height, too.
        let flat = View::of(
            &panel(Scale::Function([0.0, 1.0]), &[[0.0, 1.0], [1.0, 1.0 + 1e-15]]),
            DVec2::new(400.0, 300.0),
        );
        let flat = flat.unwrap();
        assert!((flat.low.y.abs() + (flat.high.y - 2.0).abs()) < 1e-12, "{flat:?}");
    }

    /// Numbers near 1e8, near −1e6, far above their steps: none touches the next, or the
    /// picture's border, and each says with its axis how large it is.
    #[test]
    fn large_numbers_have_room() {
        let pixels = DVec2::new(408.0, 300.0);
        for (scale, [low, high]) in [
            (Scale::Space, [[1e8, 1.0], [1e8 + 1.0, 1.5]]),
            (Scale::Space, [[-3e-7, 1e8], [4e-7, 1e8 + 1e-6]]),
            (Scale::Function([-1_000_003.0, -999_998.0]), [[0.0, 0.0], [0.0, 1.0]]),
            (Scale::Function([0.0, 1e-4]), [[0.0, -123_457.0], [0.0, 123_457.0]]),
            (Scale::Function([1e-300, 2e-300]), [[0.0, -1e300], [0.0, 3e300]]),
            (Scale::Function([999.0, 1001.0]), [[0.0, 12_345.67], [0.0, 12_345.68]]),
        ] {
            let view = View::of(&panel(scale, &[low, high]), pixels).unwrap();
            let [x, y] = view.ticks(scale);
            let mut before = f64::NEG_INFINITY;
            for (value, width) in x.labels() {
                let middle = view.to_pixels(DVec2::new(value, 0.0)).x;
                let ends = [middle - 0.5 * width, middle + 0.5 * width];
                assert!(before < ends[0] && ends[0] > -LEFT, "{x:?}");
                assert!(ends[1] <= pixels.x + RIGHT, "{x:?}");
                before = ends[1];
            }
            assert!(y.labels().all(|(_, width)| width < LEFT - 8.0), "{y:?}");
        }
    }
}
