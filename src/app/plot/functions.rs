//! Functions of a parameter: bases, blending functions, derivatives, curvature.

use std::rc::Rc;

use glam::DVec2;
use nurbray::geometry::{MatrixForm, NurbsCurve};
use nurbray::scene::PlottedBasis;

use super::bending::Bending;
use super::panel::{GREY, Item, Key, Mark, Panel, Path, Scale, Stroke, color};
use super::peaks::{Cut, Shown, shown};
use super::space::{indexed, measured, pieces};

/// With more knots than this, only the outermost show their multiplicities.
const MOST_MULTIPLICITIES: usize = 24;

/// More functions than this are told apart by their places, and not named one by one in the legend.
const MOST_NAMES: usize = 14;

/// The functions of a basis.
pub(super) fn basis(title: Option<String>, basis: PlottedBasis) -> Panel {
    let rational = basis.is_rational();
    let letter = if rational { "R" } else { "N" };
    let order = basis.derivative;
    let title = title.unwrap_or_else(|| {
        let kind = if rational { "Rational basis functions" } else { "Basis functions" };
        let drawn =
            if order > 0 { format!(": {} derivatives", ordinal(order)) } else { String::new() };
        format!("{kind} of degree {}{drawn}", basis.degree())
    });
    let (p, knots, [first, last]) = (basis.degree(), basis.knots().to_vec(), basis.shown());
    let spans = knots.windows(2).map(|ends| [ends[0], ends[1]]);
    let spans: Vec<_> = spans.filter(|&[a, b]| a < b && first <= a && b <= last).collect();
    let basis = Rc::new(basis);
    let named = (0..basis.count()).map(|index| {
        // Nothing is drawn where a function vanishes, so that the others are seen there.
        let vanishes = basis.vanishes(index);
        let lives = |span: &&[f64; 2]| {
            !vanishes && knots[index] <= span[0] && span[1] <= knots[index + p + 1]
        };
        let mut pieces: Vec<_> = spans.iter().filter(lives).copied().collect();
        // A function ends at its last knot, perhaps with a jump: the value there is that of the
        // functions that begin.
        if let Some([_, end]) = pieces.last_mut().filter(|[_, end]| *end < knots[knots.len() - 1]) {
            *end = end.next_down();
        }
        let name = derived(&indexed(letter, index), order) + if vanishes { " = 0" } else { "" };
        let basis = Rc::clone(&basis);
        Function { name, value: Box::new(move |t| basis.value(index, t)), pieces }
    });
    let mut panel = functions((title, &derived(letter, order)), &spans, named);
    let marks = knots.chunk_by(|a, b| a == b).map(|run| (run[0], run.len()));
    panel.items.extend(knot_marks(marks, panel.scale));
    panel.legend.push((Key::Point(Mark::Diamond, GREY), "knots".to_owned()));
    panel
}

/// `N′`, `N″`, `N⁽⁴⁾`.
pub(super) fn derived(name: &str, order: usize) -> String {
    const RAISED: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match order {
        0..=3 => format!("{name}{}", ["", "′", "″", "‴"][order]),
        order => {
            let raised = |digit: u8| RAISED[usize::from(digit - b'0')];
            let digits: String = order.to_string().bytes().map(raised).collect();
            format!("{name}⁽{digits}⁾")
        }
    }
}

/// `first`, `4th`.
fn ordinal(number: usize) -> String {
    match number {
        1 => "first".to_owned(),
        2 => "second".to_owned(),
        3 => "third".to_owned(),
        number => match (number % 10, number % 100) {
            (1, hundreds) if hundreds != 11 => format!("{number}st"),
            (2, hundreds) if hundreds != 12 => format!("{number}nd"),
            (3, hundreds) if hundreds != 13 => format!("{number}rd"),
            _ => format!("{number}th"),
        },
    }
}

/// Marks of knots on the axis, the multiple ones with their multiplicities.
fn knot_marks(knots: impl Iterator<Item = (f64, usize)>, scale: Scale) -> Vec<Item> {
    let Scale::Function([start, end]) = scale else { return Vec::new() };
    let mut items = Vec::new();
    let mut points = Vec::new();
    let knots: Vec<_> = knots.collect();
    let few = knots.len() <= MOST_MULTIPLICITIES;
    for (knot, times) in knots.into_iter().filter(|(knot, _)| (start..=end).contains(knot)) {
        let at = DVec2::new(knot, 0.0);
        points.push(at);
        if times > 1 && (few || knot == start || knot == end) {
            // Labels at the ends of the plot lie within it.
            let side = if knot == start {
                1.0
            } else if knot == end {
                -1.0
            } else {
                0.0
            };
            let towards = DVec2::new(side, -1.0);
            items.push(Item::Label { at, towards, text: format!("×{times}"), color: GREY });
        }
    }
    items.push(Item::Marks { points, mark: Mark::Diamond, color: GREY });
    items
}

/// A function to draw.
struct Function {
    name: String,
    value: Box<dyn Fn(f64) -> f64>,
    /// Where it is drawn.
    pieces: Vec<[f64; 2]>,
}

impl Function {
    fn new(name: &str, pieces: &[[f64; 2]], value: impl Fn(f64) -> f64 + 'static) -> Self {
        Self { name: name.to_owned(), value: Box::new(value), pieces: pieces.to_vec() }
    }
}

/// A panel of functions over a parameter that runs through these pieces.
fn functions(
    (title, value): (String, &str),
    pieces: &[[f64; 2]],
    named: impl Iterator<Item = Function>,
) -> Panel {
    let domain = [pieces.first().map_or(0.0, |p| p[0]), pieces.last().map_or(1.0, |p| p[1])];
    let zero = domain.map(|t| DVec2::new(t, 0.0)).to_vec();
    let mut items = vec![Item::Line { points: zero, stroke: Stroke::thin(GREY) }];
    let mut legend = Vec::new();
    for (index, Function { name, value, pieces }) in named.enumerate() {
        let stroke = Stroke::numbered(index);
        let at = Box::new(move |t: f64| DVec2::new(t, value(t)));
        items.push(Item::Curve { path: Path { at, pieces }, stroke });
        legend.push((Key::Line(stroke), name));
    }
    if let [first, .., last] = legend.as_slice()
        && legend.len() > MOST_NAMES
    {
        legend = vec![(first.0, format!("{} … {}, in this order", first.1, last.1))];
    }
    let axes = ["t", value].map(str::to_owned);
    Panel { title, axes, scale: Scale::Function(domain), items, legend }
}

/// The blending functions of a matrix form.
pub(super) fn blending(title: Option<String>, form: MatrixForm) -> Panel {
    let (name, letters) = match form {
        MatrixForm::Bezier => {
            ("Bézier (Bernstein)", ["B₀ of P₀", "B₁ of P₁", "B₂ of P₂", "B₃ of P₃"])
        }
        MatrixForm::BSpline => {
            ("Uniform B-spline", ["B₀ of P₀", "B₁ of P₁", "B₂ of P₂", "B₃ of P₃"])
        }
        MatrixForm::Hermite => ("Hermite", ["B₀ of P₀", "B₁ of P₁", "B₂ of P₀′", "B₃ of P₁′"]),
        MatrixForm::CatmullRom => ("Catmull–Rom", ["B₀ of P₀", "B₁ of P₁", "B₂ of P₂", "B₃ of P₃"]),
    };
    let title = title.unwrap_or_else(|| format!("{name} blending functions"));
    functions(
        (title, "B"),
        &[[0.0, 1.0]],
        letters.into_iter().enumerate().map(|(index, name)| {
            Function::new(name, &[[0.0, 1.0]], move |t| form.blending(t)[index])
        }),
    )
}

/// The coordinates of a derivative of which the curve's are not constant, and its length.
pub(super) fn derivatives(title: Option<String>, (curve, order): (&NurbsCurve, usize)) -> Panel {
    let spans = pieces(curve.knots());
    let coordinates = [("x", 0), ("y", 1), ("z", 2)].into_iter().filter(|&(_, axis)| {
        let mut values = curve.points().map(|point| point[axis]);
        let first = values.next();
        values.any(|value| Some(value) != first)
    });
    let values = coordinates.map(|(name, axis)| {
        let curve = curve.clone();
        let value = move |t| curve.derivative(order, t)[axis];
        Function::new(&derived(name, order), &spans, value)
    });
    let (moving, name) = (curve.clone(), derived("C", order));
    let length = move |t| moving.derivative(order, t).length();
    let length = Function::new(&format!("|{name}|"), &spans, length);
    let title = title.unwrap_or_else(|| capital(&derivative(order)));
    with_knots(functions((title, &name), &spans, values.chain([length])), curve)
}

/// `first derivative`, `4th derivative`.
pub(super) fn derivative(order: usize) -> String {
    format!("{} derivative", ordinal(order))
}

/// The same words with a capital.
fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().into_iter().flat_map(char::to_uppercase).chain(letters).collect()
}

/// A plot of the curvature. Where it has no bound, or a spike far above the rest, it is cut off
/// and marked.
pub(super) fn curvature(title: Option<String>, curve: &NurbsCurve) -> Panel {
    let (bending, spans) = (Bending::of(curve), pieces(curve.knots()));
    let value = move |t: f64| bending.at(t).map_or(f64::NAN, |(_, bend)| bend.length());
    let Shown { pieces, cut } = shown(&value, &spans);
    let most = cut.as_ref().map_or(f64::INFINITY, |cut| cut.limit);
    let below = move |t| Some(value(t)).filter(|&value| value <= most).unwrap_or(f64::NAN);
    let curvature = Function::new("curvature", &pieces, below);
    let title = title.unwrap_or_else(|| "Curvature".to_owned());
    let mut panel = functions((title, "κ"), &spans, [curvature].into_iter());
    if let Some(cut) = cut {
        mark_cut(&mut panel, &cut);
    }
    with_knots(panel, curve)
}

/// Adds a line where a function is cut off, and arrows on the line where the function is higher.
fn mark_cut(panel: &mut Panel, cut: &Cut) {
    let Scale::Function(domain) = panel.scale else { return };
    let stroke = Stroke { dashes: &[4.0, 3.0], ..Stroke::thin(GREY) };
    let points = domain.map(|t| DVec2::new(t, cut.limit)).to_vec();
    panel.items.push(Item::Line { points, stroke });
    let arrow = |&t: &f64| [0.98, 1.02].map(|share| DVec2::new(t, share * cut.limit));
    let steps = cut.peaks.iter().map(arrow).collect();
    panel.items.push(Item::Arrows { steps, color: color(0) });
    panel.legend.push((Key::Line(stroke), format!("cut off at {}", measured(cut.limit))));
}

/// The panel with the curve's inner knots as marks on the axis.
fn with_knots(mut panel: Panel, curve: &NurbsCurve) -> Panel {
    let inner = curve.knots().spans().skip(1).map(|span| span.start);
    let knots: Vec<_> = inner.map(|t| (t, curve.knots().multiplicity(t))).collect();
    if !knots.is_empty() {
        panel.items.extend(knot_marks(knots.into_iter(), panel.scale));
        panel.legend.push((Key::Point(Mark::Diamond, GREY), "inner knots".to_owned()));
    }
    panel
}
