//! The part of the plane a plot shows, and its axes.

use glam::DVec2;

use super::panel::{Item, Panel, Scale};

/// What is left free around the things shown: this share of the plot's width and height.
const ROOM: f64 = 0.07;

/// Where points of space have labels, this many pixels are left free for these; at most so large
/// a share of the plot.
const LABEL_ROOM: DVec2 = DVec2::new(48.0, 18.0);
const MOST_LABEL_ROOM: f64 = 0.16;

/// Curves are looked at this often a piece to find how far they reach: what is between stays
/// within [`ROOM`].
const LOOKS: u32 = 64;

/// About the distance of numbers along an axis in pixels: none touches the next.
const NUMBERS_APART: f64 = 62.0;

/// From where to where the axes go, and the size of the plot in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct View {
    pub(super) low: DVec2,
    pub(super) high: DVec2,
    pub(super) pixels: DVec2,
}

impl View {
    /// The view that shows all of a panel in this many pixels; `None` if there is nothing to show,
    /// or its extent is beyond numbers.
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

        // What has no extent, as a straight line along an axis, still needs a plot.
        let size = extent.max_element();
        let least = if size > 0.0 { 1e-3 * size } else { low.abs().max_element().max(1.0) };
        let room = 1.0 - 2.0 * room(panel, pixels);
        let (shown, middle) = match panel.scale {
            Scale::Space => {
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

    /// The numbers beside both axes. In space they are equally far apart on both.
    pub(super) fn ticks(self, scale: Scale) -> [Ticks; 2] {
        let unit = (self.high - self.low) / self.pixels * NUMBERS_APART;
        let step = match scale {
            Scale::Space => [round_step(unit.x); 2],
            // Numbers above one another need less room than side by side.
            Scale::Function(_) | Scale::Parameters => {
                [round_step(unit.x), round_step(0.7 * unit.y)]
            }
        };
        [Ticks::new(self.low.x, self.high.x, step[0]), Ticks::new(self.low.y, self.high.y, step[1])]
    }
}

/// What is left free on each side, in shares of the plot.
fn room(panel: &Panel, pixels: DVec2) -> DVec2 {
    let labelled = panel.items.iter().any(|item| matches!(item, Item::Label { .. }));
    match panel.scale {
        Scale::Space | Scale::Parameters if labelled => {
            (LABEL_ROOM / pixels).clamp(DVec2::splat(ROOM), DVec2::splat(MOST_LABEL_ROOM))
        }
        _ => DVec2::splat(ROOM),
    }
}

/// The least of 1, 2, 5 times a power of ten that is no smaller.
fn round_step(least: f64) -> f64 {
    let power = 10_f64.powi(least.log10().floor() as i32);
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    step.into_iter().find(|&step| step >= least).unwrap_or(10.0 * power)
}

/// The numbers beside an axis.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    pub(super) values: Vec<f64>,
    step: f64,
}

impl Ticks {
    fn new(low: f64, high: f64, step: f64) -> Self {
        // A hair beyond the ends belongs to them.
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let count = (last - first).clamp(0.0, 1e4) as u32;
        let values = (0..=count).map(|k| (first + f64::from(k)) * step);
        Self { values: values.collect(), step }
    }

    /// A number with as many digits as the step has.
    pub(super) fn text(&self, value: f64) -> String {
        let decimals = -self.step.log10().floor();
        let zero = if value.abs() < 0.5 * self.step { 0.0 } else { value };
        let text = match decimals {
            d if d.abs() > 5.0 => {
                let digits = (zero.abs().log10().floor() + decimals).clamp(0.0, 15.0);
                if zero == 0.0 { "0".into() } else { format!("{zero:.0$e}", digits as usize) }
            }
            d if d > 0.0 => format!("{zero:.0$}", d as usize),
            _ => format!("{zero:.0}"),
        };
        text.replace('-', "−")
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
            let [x, y] = view.ticks(Scale::Space);
            assert_eq!(x.step, y.step);
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

    #[test]
    fn numbers_beside_axes_are_round() {
        assert_eq!([0.3, 1.0, 11.0, 0.051].map(round_step), [0.5, 1.0, 20.0, 0.1]);
        let ticks = Ticks::new(-0.13, 0.31, 0.1);
        let texts: Vec<_> = ticks.values.iter().map(|&value| ticks.text(value)).collect();
        assert_eq!(texts, ["−0.1", "0.0", "0.1", "0.2", "0.3"]);
        let ticks = Ticks::new(0.0, 3.1e-8, 1e-8);
        let texts: Vec<_> = ticks.values.iter().map(|&value| ticks.text(value)).collect();
        assert_eq!(texts, ["0", "1e−8", "2e−8", "3e−8"]);
        let ticks = Ticks::new(0.0, 45.0, 20.0);
        assert_eq!(ticks.values, [0.0, 20.0, 40.0]);
        assert_eq!(ticks.text(40.0), "40");
    }
}
