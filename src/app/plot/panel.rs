//! What a plot is made of, in the coordinates of its axes.

use glam::DVec2;
use plotters::style::RGBColor;

/// Colours of curves, one after the other: those of Okabe and Ito (2008), which people with any
/// colour vision can tell apart; their yellow is too pale for lines.
pub(super) const COLORS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(60, 60, 60),
];

/// The dashes of lines whose colours repeat, so that more lines can be told apart.
const DASHES: [&[f64]; 4] = [&[], &[7.0, 3.5], &[2.0, 3.0], &[9.0, 3.0, 2.0, 3.0]];

/// The colour of control polygons and points, which stay in the background of the curves.
pub(super) const GREY: RGBColor = RGBColor(130, 130, 130);

/// The colours of words and axes, and of what lies behind everything.
pub(super) const INK: RGBColor = RGBColor(40, 40, 40);
pub(super) const GRID: RGBColor = RGBColor(232, 232, 232);

/// The colour of the curve of this number.
pub(super) fn color(index: usize) -> RGBColor {
    COLORS[index % COLORS.len()]
}

/// One plot.
pub(super) struct Panel {
    /// The text above the plot.
    pub(super) title: String,
    /// The names of the axes.
    pub(super) axes: [String; 2],
    /// What the axes measure.
    pub(super) scale: Scale,
    /// What is drawn, from back to front.
    pub(super) items: Vec<Item>,
    /// The entries of the legend.
    pub(super) legend: Vec<(Key, String)>,
}

/// What the axes of a plot measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Scale {
    /// Both lengths in space: a circle is round.
    Space,
    /// Lengths in a parallel view of space, which has its numbers among the things drawn.
    View,
    /// Values over a parameter, which runs through this range.
    Function([f64; 2]),
    /// Two parameters, each on a scale of its own.
    Parameters,
}

/// Something to draw.
pub(super) enum Item {
    /// A curve.
    Curve { path: Path, stroke: Stroke },
    /// Straight lines from point to point.
    Line { points: Vec<DVec2>, stroke: Stroke },
    /// What lies within an odd number of these closed polygons, none of which cross.
    Area { rings: Vec<Vec<DVec2>>, color: RGBColor },
    /// Heads of arrows in the middle between two points, towards the second.
    Arrows { steps: Vec<[DVec2; 2]>, color: RGBColor },
    /// Points.
    Marks { points: Vec<DVec2>, mark: Mark, color: RGBColor },
    /// Words beside a point, on the side of it that `towards` points to.
    Label { at: DVec2, towards: DVec2, text: String, color: RGBColor },
}

/// A curve as a function of a parameter, smooth on each of its pieces.
pub(super) struct Path {
    /// The point at a parameter; not finite where there is none.
    pub(super) at: Box<dyn Fn(f64) -> DVec2>,
    /// The pieces from first to last: at a parameter they share, the later one holds.
    pub(super) pieces: Vec<[f64; 2]>,
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    /// Its colour.
    pub(super) color: RGBColor,
    /// Its width in pixels.
    pub(super) width: f64,
    /// The lengths of its dashes and of the gaps behind them in pixels; a line without any is
    /// solid.
    pub(super) dashes: &'static [f64],
}

/// How a point is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mark {
    /// A ring: control points.
    Ring,
    /// A disc: points that are constructed.
    Dot,
    /// A square on its corner: knots.
    Diamond,
}

/// What a line of the legend shows.
#[derive(Clone, Copy, Debug)]
pub(super) enum Key {
    /// A line.
    Line(Stroke),
    /// A point.
    Point(Mark, RGBColor),
    /// The colour of an area.
    Area(RGBColor),
}

impl Stroke {
    /// A solid line.
    pub(super) fn new(color: RGBColor, width: f64) -> Self {
        Self { color, width, dashes: &[] }
    }

    /// The stroke of a curve that the plot is about.
    pub(super) fn curve(color: RGBColor) -> Self {
        Self::new(color, 2.2)
    }

    /// The stroke of the curve of this number. Among as many curves as there are combinations of
    /// colours and dashes, no two are drawn alike.
    pub(super) fn numbered(index: usize) -> Self {
        Self { dashes: DASHES[index / COLORS.len() % DASHES.len()], ..Self::curve(color(index)) }
    }

    /// The same stroke in another width.
    pub(super) fn wide(self, width: f64) -> Self {
        Self { width, ..self }
    }

    /// The stroke of polygons and other guide lines.
    pub(super) fn thin(color: RGBColor) -> Self {
        Self::new(color, 1.0)
    }
}
