//! A chart of a surface: what all its pieces share.

use std::sync::Arc;

use glam::DVec4;
use rayon::prelude::*;

use super::keeping::Keeping;
use super::piece_net::numbers_a_point;
use super::power_nets::{KeptPowers, MadePowers, Others};
use super::powers;
use super::spline_net::LONGEST;
use crate::geometry::trim::Trims;
use crate::geometry::{
    BezierForm, Chart, ChartMap, Direction, Extractions, KnotVector, NurbsSurface, RectSide,
};
use crate::math::rounding;
use crate::patch::{BezierNet, NetSource, PieceNet, SplineNet};

/// The control points of a chart, and where its pieces lie.
#[derive(Debug)]
pub(in crate::patch) struct ChartNet {
    pub(super) degree: [usize; 2],
    /// See [`TensorPatch::residual_factor`](crate::patch::TensorPatch::residual_factor): every ray
    /// needs it at every leaf.
    pub(super) residual_factor: f64,
    /// Row by row.
    control: Control,
    /// The number of points in a row.
    stride: usize,
    /// How pieces make their nets from these points, by the row and the column in which they begin;
    /// `None` where these are the Bézier points.
    extraction: Option<Box<[Extractions; 2]>>,
    /// The form of the nets whose sums are used where speed counts.
    sums: Sums,
    /// For each direction and each row, or column: the data of the pieces that begin there.
    pub(super) spans: [Vec<PieceSpan>; 2],
    /// Where the chart lies in the surface's parameters.
    pub(super) map: ChartMap,
    /// Which part of the chart is kept; all of it without trims.
    pub(super) trims: Option<Arc<Trims>>,
}

/// The form of the nets whose sums are used where speed counts.
#[derive(Debug)]
enum Sums {
    /// Bernstein form: the Bézier points.
    Bernstein,
    /// Power form: nets that are kept, piece by piece.
    Powers(KeptPowers),
    /// Power form: nets that are made on demand.
    PowersOf(Box<MadePowers>),
}

/// Homogeneous control points `(w x, w y, w z, w)`; a weight that all have in common is kept once.
#[derive(Debug)]
pub(super) struct Control {
    /// Four numbers a point, or three, then some more that may be read but mean nothing.
    numbers: Vec<f64>,
    /// The weight of all points, if all have the same.
    weight: Option<f64>,
}

impl Control {
    /// This many rows of this many points, then `more` unused numbers.
    fn new<R>(
        weight: Option<f64>,
        [rows, stride]: [usize; 2],
        more: usize,
        row: impl Fn(usize) -> R + Sync,
    ) -> Self
    where
        R: AsRef<[DVec4]>,
    {
        let size = numbers_a_point(weight);
        let mut numbers = vec![0.0; size * rows * stride + more];
        let to = numbers[..size * rows * stride].par_chunks_mut(size * stride);
        to.enumerate().for_each(|(i, to)| {
            let row = row(i);
            debug_assert_eq!(row.as_ref().len(), stride);
            for (to, point) in to.chunks_exact_mut(size).zip(row.as_ref()) {
                to.copy_from_slice(&point.to_array()[..size]);
            }
        });
        Self { numbers, weight }
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
    /// How many pieces come before it in its direction, and how many there are in that direction.
    number: u32,
    count: u32,
}

impl ChartNet {
    /// The net of a chart; also returns the rows and the columns in which pieces begin.
    pub(in crate::patch) fn new(chart: &Chart<'_>, keeping: Keeping) -> (Self, [Vec<u32>; 2]) {
        let surface = &*chart.surface;
        if keeping.of_one(surface) == Keeping::Spline {
            Self::of_spline(chart, surface)
        } else {
            let form = BezierForm::new(surface);
            let knots = form.knots();
            let counts = knots.map(KnotVector::point_count);
            // One more number: so that four can be read at any point.
            let control = Control::new(form.weight(), counts, 1, |i| form.row(i));
            let (mut net, firsts) = Self::over(chart, knots, control, None);
            if let Some(powers) = net.all_by_powers(&firsts) {
                net.sums = Sums::Powers(powers);
            }
            (net, firsts)
        }
    }

    /// The net of a chart that keeps its own control points.
    fn of_spline(chart: &Chart<'_>, surface: &NurbsSurface) -> (Self, [Vec<u32>; 2]) {
        let surface = surface.in_clamped_form();
        let knots = [surface.knots_u(), surface.knots_v()];
        let counts @ [_, length] = knots.map(KnotVector::point_count);
        let row = |i: usize| &surface.control()[i * length..(i + 1) * length];
        let extraction = knots.map(Extractions::of);
        let control = Control::new(surface.common_weight(), counts, LONGEST, row);
        let (mut net, firsts) = Self::over(chart, knots, control, Some(Box::new(extraction)));
        if let Some(powers) = net.made_by_powers(&firsts, (knots, surface.control())) {
            net.sums = Sums::PowersOf(Box::new(powers));
        }
        (net, firsts)
    }

    fn over(
        chart: &Chart<'_>,
        knots: [&KnotVector; 2],
        control: Control,
        extraction: Option<Box<[Extractions; 2]>>,
    ) -> (Self, [Vec<u32>; 2]) {
        let degree = knots.map(KnotVector::degree);
        let firsts = knots
            .map(|knots| knots.spans().map(|span| (span.index - knots.degree()) as u32).collect());
        let spans = Direction::BOTH.map(|k| {
            let border = RectSide::ends_of(k).map(|side| chart.border[side]);
            piece_spans(knots[k], border, chart.open_end[k])
        });
        let stride = knots[1].point_count();
        let (map, trims) = (chart.map, chart.trims.clone());
        let net = Self {
            degree,
            residual_factor: rounding::residual_factor(degree[0], degree[1]),
            control,
            stride,
            extraction,
            sums: Sums::Bernstein,
            spans,
            map,
            trims,
        };
        (net, firsts)
    }

    /// The power nets of the pieces that begin with these rows and columns, if most are well
    /// conditioned.
    fn all_by_powers(&self, [rows, columns]: &[Vec<u32>; 2]) -> Option<KeptPowers> {
        if !powers::suit(self.degree) {
            return None;
        }
        let (mut others, size) = (Vec::new(), self.components());
        let [p, q] = self.degree;
        let count = rows.len() * columns.len();
        let mut numbers = Vec::with_capacity(count * size * (p + 1) * (q + 1) + 1);
        let mut least = [1; 2];
        let mut bezier = BezierNet::new();
        for &row in rows {
            for &column in columns {
                let NetSource::Kept(net) = self.source([row, column]) else { return None };
                bezier.clear();
                bezier.extend((0..=p).flat_map(|i| net.points(i)));
                let by_powers = powers::net_of(self.degree, &bezier);
                let needed = match &by_powers {
                    // The full degree is needed already.
                    Some(_) if least == self.degree => self.degree,
                    Some(net) => powers::least_degree(self.degree, net, &bezier),
                    None => {
                        others.push([row, column]);
                        self.degree
                    }
                };
                least = [0, 1].map(|k| needed[k].max(least[k]));
                for point in by_powers.as_ref().unwrap_or(&bezier) {
                    numbers.extend(&point.to_array()[..size]);
                }
            }
        }
        // So that four can be read at any point.
        numbers.push(0.0);
        let mut powers = KeptPowers { numbers, degree: self.degree, others: Others(others) };
        // Others need the full degree.
        if least != self.degree {
            powers.lower(least, size);
        }
        powers.others.are_few(count).then_some(powers)
    }

    /// How power nets are made from these control points, and for which pieces they are not, if
    /// most are well conditioned.
    fn made_by_powers(
        &self,
        [rows, columns]: &[Vec<u32>; 2],
        (knots, control): ([&KnotVector; 2], &[DVec4]),
    ) -> Option<MadePowers> {
        if !powers::suit(self.degree) {
            return None;
        }
        let extraction = self.extraction.as_deref()?;
        let along = [0, 1].map(|k| {
            let degree = self.degree[k];
            let length = degree * (degree + 1);
            let mut shares = vec![0.0; length * self.spans[k].len()];
            for &first in [rows, columns][k] {
                let (first, own) = (first as usize, length * first as usize);
                let own = &mut shares[own..own + length];
                powers::shares_of_points(extraction[k].at(first), degree, own);
            }
            shares
        });
        let made = MadePowers { along, degree: self.degree, others: Others(Vec::new()) };
        let gentle = powers::are_gentle(knots, control);
        let factor = self.residual_factor;
        let suits = |first: [u32; 2]| {
            let NetSource::Spline(net) = self.source(first) else { return true }; // nets are not kept here
            let bezier = net.bezier_net();
            let Some(by_powers) = powers::net_of(self.degree, &bezier) else { return false };
            gentle
                || made.of(first).is_some_and(|to_powers| {
                    let nets = (&by_powers[..], &bezier[..]);
                    powers::is_made_well(self.degree, nets, (&net.control(), to_powers), factor)
                })
        };
        let others = if gentle && powers::suit_all(self.degree) {
            Vec::new()
        } else {
            let firsts_of = |&row| columns.iter().map(move |&column| [row, column]);
            let firsts = rows.par_iter().flat_map_iter(firsts_of);
            firsts.filter(|&first| !suits(first)).collect()
        };
        let count = rows.len() * columns.len();
        let others = Others(others);
        others.are_few(count).then_some(MadePowers { others, ..made })
    }

    /// The net of a piece whose sums are used where speed counts, in power form or in Bernstein
    /// form.
    #[inline(always)]
    pub(super) fn sums_source(&self, first: [u32; 2]) -> NetSource<'_> {
        let Sums::Powers(powers) = &self.sums else { return self.source(first) };
        let spans = [0, 1].map(|k| &self.spans[k][first[k] as usize]);
        let number = (spans[0].number * spans[1].count + spans[1].number) as usize;
        let [p, q] = powers.degree;
        let length = self.components() * (q + 1);
        let numbers = &powers.numbers[length * (p + 1) * number..];
        NetSource::Kept(PieceNet::new(numbers, length, length, self.control.weight))
    }

    /// The degrees of that net, which may be less than those of the pieces.
    #[inline(always)]
    pub(super) fn sums_degree(&self) -> [usize; 2] {
        match &self.sums {
            Sums::Powers(powers) => powers.degree,
            Sums::Bernstein | Sums::PowersOf(_) => self.degree,
        }
    }

    /// Whether that net is in power form.
    #[inline(always)]
    pub(super) fn by_powers(&self, first: [u32; 2]) -> bool {
        match &self.sums {
            Sums::Bernstein => false,
            Sums::Powers(powers) => !powers.others.contain(first),
            Sums::PowersOf(made) => made.of(first).is_some(),
        }
    }

    /// The net of the piece that begins with a row and a column.
    #[inline(always)]
    pub(super) fn source(&self, first: [u32; 2]) -> NetSource<'_> {
        let [row, column] = first.map(|first| first as usize);
        let size = self.components();
        let numbers = &self.control.numbers[size * (row * self.stride + column)..];
        let length = size * (self.degree[1] + 1);
        let points = PieceNet::new(numbers, size * self.stride, length, self.control.weight);
        match self.extraction.as_deref() {
            None => NetSource::Kept(points),
            Some(extraction) => {
                let made = match &self.sums {
                    Sums::PowersOf(made) => Some(&**made),
                    _ => None,
                };
                NetSource::Spline(SplineNet::new((self.degree, extraction), made, points, first))
            }
        }
    }

    /// The weight of all points, if all have the same.
    #[inline(always)]
    pub(super) fn weight(&self) -> Option<f64> {
        self.control.weight
    }

    /// How many numbers a point has: three, or four where weights differ.
    #[inline(always)]
    pub(super) fn components(&self) -> usize {
        numbers_a_point(self.control.weight)
    }

    /// The memory held, in bytes.
    pub(in crate::patch) fn bytes(&self) -> usize {
        let spans = self.spans.iter().map(|spans| size_of_val(&spans[..]));
        let extraction = self.extraction.iter().flat_map(|both| both.iter());
        let extraction = extraction.map(Extractions::bytes);
        let trims = self.trims.as_ref().map_or(0, |trims| trims.bytes());
        size_of::<Self>()
            + self.control.bytes()
            + match &self.sums {
                Sums::Bernstein => 0,
                Sums::Powers(powers) => powers.bytes(),
                Sums::PowersOf(made) => made.bytes(),
            }
            + spans.sum::<usize>()
            + extraction.sum::<usize>()
            + trims
    }

    /// A net of one piece, on the unit square.
    #[cfg(test)]
    pub(in crate::patch) fn single(degree: [usize; 2], control: &[DVec4]) -> Self {
        let knots = degree.map(|degree| KnotVector::bezier(degree).unwrap());
        let [u, v] = knots;
        let surface = NurbsSurface::from_homogeneous(u, v, control.to_vec()).unwrap();
        Self::new(&Chart::whole(&surface), Keeping::Bezier).0
    }
}

/// The data of pieces, by the index of their first point.
fn piece_spans(knots: &KnotVector, border: [bool; 2], open_end: bool) -> Vec<PieceSpan> {
    let [start, end] = knots.domain();
    let jumps = |t: f64| knots.multiplicity(t) > knots.degree();
    let mut spans = vec![PieceSpan::default(); knots.point_count()];
    let count = knots.spans().count() as u32;
    for (number, span) in (0..count).zip(knots.spans()) {
        spans[span.index - knots.degree()] = PieceSpan {
            domain: [span.start, span.end],
            border: [
                if span.start == start { border[0] } else { jumps(span.start) },
                if span.end == end { border[1] } else { jumps(span.end) },
            ],
            open_end: if span.end == end { open_end } else { jumps(span.end) },
            number,
            count,
        };
    }
    spans
}
