//! A chart of a surface in Bézier form: what all its pieces share.

use std::sync::Arc;

use glam::{DVec3, DVec4};
use rayon::prelude::*;

use crate::geometry::trim::Trims;
use crate::geometry::{BezierForm, Chart, ChartMap, KnotVector};

/// The control points of a chart cut into Bézier pieces, and where the pieces lie.
#[derive(Debug)]
pub(super) struct BezierNet {
    pub(super) degree: [usize; 2],
    /// Row by row.
    pub(super) control: Control,
    /// The length of a row.
    pub(super) stride: usize,
    /// For each direction and each row, or column: what is to be known of the pieces that
    /// begin there.
    pub(super) spans: [Vec<PieceSpan>; 2],
    /// Where the chart lies in the surface's parameters.
    pub(super) map: ChartMap,
    /// Which part of the chart is there; all of it without trims.
    pub(super) trims: Option<Arc<Trims>>,
}

/// Homogeneous control points `(w x, w y, w z, w)`; of those that all have the same weight, it is
/// kept once.
#[derive(Debug)]
pub(super) struct Control {
    /// Four numbers a point, or three, and one more: so that four can be read at any point.
    numbers: Vec<f64>,
    /// The weight of all points, if it is one.
    weight: Option<f64>,
}

impl Control {
    fn new(form: &BezierForm<'_>) -> Self {
        let weight = form.weight();
        let [rows, stride] = form.knots().map(KnotVector::point_count);
        let size = if weight.is_some() { 3 } else { 4 };
        let mut numbers = vec![0.0; size * rows * stride + 1];
        let to = numbers[..size * rows * stride].par_chunks_mut(size * stride);
        to.enumerate().for_each(|(i, to)| {
            let row = form.row(i);
            debug_assert_eq!(row.len(), stride);
            for (to, point) in to.chunks_exact_mut(size).zip(row) {
                to.copy_from_slice(&point.to_array()[..size]);
            }
        });
        Self { numbers, weight }
    }

    /// The weight of all points, if it is one.
    #[inline(always)]
    pub(super) fn weight(&self) -> Option<f64> {
        self.weight
    }

    /// How many numbers a point has: three, or four where weights differ.
    #[inline(always)]
    pub(super) fn components(&self) -> usize {
        if self.weight.is_some() { 3 } else { 4 }
    }

    /// Points from the `first` on, so many.
    #[inline]
    pub(super) fn points(&self, first: usize, count: usize) -> impl Iterator<Item = DVec4> + '_ {
        let (size, weight) = (self.components(), self.weight);
        let numbers = &self.numbers[size * first..size * (first + count)];
        numbers.chunks_exact(size).map(move |point| match weight {
            Some(weight) => DVec3::from_slice(point).extend(weight),
            None => DVec4::from_slice(point),
        })
    }

    /// The numbers of points from the `first` on, so many, and one more.
    #[inline(always)]
    pub(super) fn numbers(&self, first: usize, count: usize) -> &[f64] {
        let size = self.components();
        &self.numbers[size * first..=size * (first + count)]
    }

    fn bytes(&self) -> usize {
        size_of_val(&self.numbers[..])
    }
}

/// The part of a knot vector that pieces cover.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PieceSpan {
    pub(super) domain: [f64; 2],
    /// Whether the surface ends, or may jump, at either end.
    pub(super) border: [bool; 2],
    /// Whether something else begins at the far end.
    pub(super) open_end: bool,
}

impl BezierNet {
    /// The net of a chart; also returns the rows and the columns in which pieces begin.
    pub(super) fn new(chart: &Chart<'_>) -> (Self, [Vec<u32>; 2]) {
        let form = BezierForm::new(&chart.surface);
        let knots = form.knots();
        let degree = knots.map(KnotVector::degree);
        let firsts = knots
            .map(|knots| knots.spans().map(|span| (span.index - knots.degree()) as u32).collect());
        let [b0, b1, b2, b3] = chart.border;
        let spans = [
            piece_spans(knots[0], [b0, b1], chart.open_end[0]),
            piece_spans(knots[1], [b2, b3], chart.open_end[1]),
        ];
        let stride = knots[1].point_count();
        let control = Control::new(&form);
        let (map, trims) = (chart.map, chart.trims.clone());
        (Self { degree, control, stride, spans, map, trims }, firsts)
    }

    /// The memory held, in bytes.
    pub(super) fn bytes(&self) -> usize {
        let spans = self.spans.iter().map(|spans| size_of_val(&spans[..]));
        let trims = self.trims.as_ref().map_or(0, |trims| trims.bytes());
        size_of::<Self>() + self.control.bytes() + spans.sum::<usize>() + trims
    }

    /// A net of one piece, on the unit square.
    #[cfg(test)]
    pub(super) fn single(degree: [usize; 2], control: &[DVec4]) -> Self {
        let span = PieceSpan { domain: [0.0, 1.0], border: [true; 2], open_end: false };
        let knots = degree.map(|degree| KnotVector::bezier(degree).unwrap());
        let [u, v] = knots;
        let surface =
            crate::geometry::NurbsSurface::from_homogeneous(u, v, control.to_vec()).unwrap();
        let control = Control::new(&BezierForm::new(&surface));
        let spans = [vec![span], vec![span]];
        let map = ChartMap::Identity;
        Self { degree, control, stride: degree[1] + 1, spans, map, trims: None }
    }
}

/// What is to be known of pieces by the first point they have.
fn piece_spans(knots: &KnotVector, border: [bool; 2], open_end: bool) -> Vec<PieceSpan> {
    let (start, end) = knots.domain();
    let jumps = |t: f64| knots.multiplicity(t) > knots.degree();
    let mut spans = vec![PieceSpan::default(); knots.point_count()];
    for span in knots.spans() {
        spans[span.index - knots.degree()] = PieceSpan {
            domain: [span.start, span.end],
            border: [
                if span.start == start { border[0] } else { jumps(span.start) },
                if span.end == end { border[1] } else { jumps(span.end) },
            ],
            open_end: if span.end == end { open_end } else { jumps(span.end) },
        };
    }
    spans
}

/// A number not below zero, rounded up: the upper half of an f64, for its range in less room.
#[derive(Clone, Copy, Debug)]
pub(super) struct Coarse(u32);

impl Coarse {
    pub(super) fn above(x: f64) -> Self {
        let bits = x.to_bits();
        let cut_off = bits & 0xffff_ffff != 0;
        Self((bits >> 32) as u32 + u32::from(cut_off))
    }

    pub(super) fn value(self) -> f64 {
        f64::from_bits(u64::from(self.0) << 32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarse_numbers_are_not_below() {
        for x in [0.0, 1.0, 0.1, 1.0 / 3.0, 1e70, 3e-70, 1.999_999_999, 5e-324] {
            let coarse = Coarse::above(x).value();
            assert!(x <= coarse && coarse <= x * (1.0 + 2e-6) + 1e-300, "{x}: {coarse}");
        }
    }
}
