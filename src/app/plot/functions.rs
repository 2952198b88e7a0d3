//! Functions of a parameter: bases, blending functions, derivatives, curvature.

use std::rc::Rc;

use glam::DVec2;
use nurbray::geometry::{CurveError, KnotVector, MatrixForm, NurbsCurve, RationalBasis};

use super::bending::Bending;
use super::panel::{GREY, Item, Key, Mark, Panel, Path, Scale, Stroke, color};
use super::space::{indexed, pieces};

/// Of more knots than this only the outermost say how often they are there.
const MOST_MULTIPLICITIES: usize = 24;

/// More functions than this are told apart by their places, not by a legend.
const MOST_NAMES: usize = 14;

/// The functions of a basis; with `support`, off the domain, too.
///
/// # Errors
/// When the knots off the domain cannot be made knots of a larger one.
pub(super) fn basis(
    title: Option<String>,
    basis: &RationalBasis,
    support: bool,
) -> Result<Panel, CurveError> {
    let weights = basis.weights();
    let rational = weights.iter().any(|&weight| weight != weights[0]);
    let letter = if rational { "R" } else { "N" };
    let count = weights.len();
    let title = title.unwrap_or_else(|| {
        let kind = if rational { "Rational basis functions" } else { "Basis functions" };
        format!("{kind} of degree {}", basis.knots().degree())
    });

    // Where functions are seen whole, others come in from outside: these are left out.
    let (seen, skipped) = if support { widened(basis)? } else { (basis.clone(), 0) };
    let (p, all) = (basis.knots().degree(), basis.knots().values());
    let (spans, seen) = (pieces(seen.knots()), Rc::new(seen));
    let mut panel = functions(
        (title, letter),
        &spans,
        (0..count).map(|index| {
            let seen = Rc::clone(&seen);
            let value = move |t: f64| seen.value(skipped + index, t);
            // Where it vanishes nothing is drawn: the others are seen there.
            let begins = spans.partition_point(|span| span[0] < all[index]);
            let ends = spans.partition_point(|span| span[1] <= all[index + p + 1]);
            let lives = if weights[index] > 0.0 { begins..ends.max(begins) } else { 0..0 };
            let name = match weights[index] {
                0.0 => format!("{} = 0", indexed(letter, index)),
                _ => indexed(letter, index),
            };
            let mut pieces = spans[lives].to_vec();
            // Where all its knots but the first are one, it jumps to zero where it ends: there the
            // value is that of the functions that begin.
            let jumps = all[index + 1] == all[index + p + 1];
            if let Some([_, end]) = pieces.last_mut().filter(|_| jumps)
                && spans.last().is_some_and(|span| *end < span[1])
            {
                *end = end.next_down();
            }
            Function { name, value: Box::new(value), pieces }
        }),
    );
    let values = basis.knots().values();
    let marks = values.chunk_by(|a, b| a == b).map(|run| (run[0], run.len()));
    panel.items.extend(knot_marks(marks, panel.scale));
    panel.legend.push((Key::Point(Mark::Diamond, GREY), "knots".to_owned()));
    Ok(panel)
}

/// The basis over so many more knots that its functions' supports are the domain, and how many
/// functions come before the old ones. Each old function depends on its own knots only.
fn widened(basis: &RationalBasis) -> Result<(RationalBasis, usize), CurveError> {
    let knots = basis.knots();
    let (p, values) = (knots.degree(), knots.values());
    let (first, last) = (values[0], values[values.len() - 1]);
    let before = p + 1 - knots.multiplicity(first);
    let after = p + 1 - knots.multiplicity(last);
    let mut wide = vec![first; before];
    wide.extend(values);
    wide.extend(vec![last; after]);
    // A basis with weights is never asked for this: what its sum is off the domain, and with it
    // the functions, depends on points that are not there.
    let weights = vec![1.0; wide.len() - p - 1];
    Ok((RationalBasis::new(KnotVector::new(p, wide)?, weights)?, before))
}

/// Knots on the axis, those on it several times with how often.
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
            // Within the plot at its ends.
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

/// Functions over a parameter that runs through these pieces.
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
        let stroke = Stroke::curve(color(index));
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

/// The coordinates of the first derivative that are not zero all along, and the speed.
pub(super) fn derivatives(title: Option<String>, curve: &NurbsCurve) -> Panel {
    let coordinates = [("x′", 0), ("y′", 1), ("z′", 2)].into_iter().filter(|&(_, axis)| {
        let first = curve.point(0)[axis];
        (1..curve.control().len()).any(|index| curve.point(index)[axis] != first)
    });
    let values = coordinates.map(|(name, axis)| {
        let curve = curve.clone();
        Function::new(name, &pieces(curve.knots()), move |t| curve.derivatives(t).first[axis])
    });
    let (moving, spans) = (curve.clone(), pieces(curve.knots()));
    let speed = Function::new("|C′|", &spans, move |t| moving.derivatives(t).first.length());
    let title = title.unwrap_or_else(|| "First derivative".to_owned());
    with_knots(functions((title, "C′"), &spans, values.chain([speed])), curve)
}

/// The curvature.
pub(super) fn curvature(title: Option<String>, curve: &NurbsCurve) -> Panel {
    let (bending, spans) = (Bending::of(curve), pieces(curve.knots()));
    let curvature = Function::new("curvature", &spans, move |t| {
        bending.at(t).map_or(f64::NAN, |(_, bend)| bend.length())
    });
    let title = title.unwrap_or_else(|| "Curvature".to_owned());
    with_knots(functions((title, "κ"), &spans, [curvature].into_iter()), curve)
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
