//! Control nets of eight pieces side by side.

use fearless_simd::{Simd, SimdBase, SimdMask, f64x8, mask64x8};
use fearless_simd_macros::simd;

use super::form::{Form, MOST_DEGREE};
use super::power_lines::{Lines, MOST_IN_LINE, Shares, coefficients, make_lines};
use super::spline_net::make;
use super::sums::Net;
use crate::intersect::tree::nodes::LANES;
use crate::intersect::wide::frames::transposed;
use crate::math::bits::has;
use crate::patch::{NetRoom, NetSource, Piece, PieceNet, TensorPatch, ToPowers};

/// How many numbers the largest net has.
const MOST_NUMBERS: usize = 4 * (MOST_DEGREE + 1) * (MOST_DEGREE + 1);

/// Eight nets of one form, interleaved number by number, row by row.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(crate) struct LaneNet {
    pub form: Form,
    weight: [f64; 8],
    numbers: Numbers,
    /// Separate room for nets that are not kept; most of these are made in `numbers`.
    rooms: Box<[NetRoom; 8]>,
}

type Numbers = [[f64; 8]; MOST_NUMBERS];

impl Default for LaneNet {
    fn default() -> Self {
        let form = Form::default();
        let rooms = Box::new(std::array::from_fn(|_| NetRoom::new()));
        Self { form, weight: [0.0; 8], numbers: [[0.0; 8]; MOST_NUMBERS], rooms }
    }
}

impl LaneNet {
    /// Takes in the nets of pieces `first … first + 7` in the lanes that are `wanted`, of which
    /// there is at least one; all other lanes repeat one of these.
    #[simd]
    pub(crate) fn take<S: Simd>(
        &mut self,
        simd: S,
        form: Form,
        pieces: &[&Piece; LANES],
        first: usize,
        wanted: mask64x8<S>,
    ) {
        self.form = form;
        let wanted = wanted.to_bitmask();
        let other = wanted.trailing_zeros() as usize % 8;
        let mut patches = [&pieces[first + other].patch; 8];
        for lane in 0..8 {
            if has(wanted, lane) {
                patches[lane] = &pieces[first + lane].patch;
            }
            self.weight[lane] = patches[lane].weight().unwrap_or(1.0);
        }
        let mut nets = [PieceNet::EMPTY; 8];
        if let Some(along) = all_from_splines(&patches, &mut nets) {
            put(simd, form, &nets, &mut self.numbers);
            // Eight nets made here take less than half as long as nets made one by one.
            make_all(simd, form, &along, &mut self.numbers);
            return;
        }
        for (lane, room) in self.rooms.iter_mut().enumerate() {
            if has(wanted, lane) {
                nets[lane] = match patches[lane].sums_source() {
                    NetSource::Kept(net) => net,
                    NetSource::Spline(spline) => make(simd, &spline, room),
                };
            }
        }
        for lane in 0..8 {
            if !has(wanted, lane) {
                nets[lane] = nets[other];
            }
        }
        put(simd, form, &nets, &mut self.numbers);
    }
}

/// Returns what converts spline control points to nets by powers, if all eight are made so, and
/// puts those points into `points`.
#[inline(always)]
fn all_from_splines<'p>(
    patches: &[&'p TensorPatch; 8],
    points: &mut [PieceNet<'p>; 8],
) -> Option<[[ToPowers<'p>; 8]; 2]> {
    let NetSource::Spline(first) = patches[0].sums_source() else { return None };
    let [along_s, along_t] = first.by_powers()?;
    let mut along = [[along_s; 8], [along_t; 8]];
    for lane in 0..8 {
        let NetSource::Spline(spline) = patches[lane].sums_source() else { return None };
        points[lane] = spline.points();
        [along[0][lane], along[1][lane]] = spline.by_powers()?;
    }
    Some(along)
}

/// Puts nets into lanes.
#[inline(always)]
fn put<S: Simd>(simd: S, form: Form, nets: &[PieceNet<'_>; 8], numbers: &mut Numbers) {
    let (length, count) = (form.row_length(), form.degree()[0] + 1);
    // Rows without gaps are treated as one.
    let together = nets.iter().all(PieceNet::is_without_gaps);
    let (rows, length) = if together { (1, count * length) } else { (count, length) };
    for i in 0..rows {
        let mut lanes = [&[][..]; 8];
        for lane in 0..8 {
            lanes[lane] = nets[lane].numbers_from(i, length);
        }
        put_row(simd, &lanes, &mut numbers[i * length..(i + 1) * length]);
    }
}

/// Puts one row of each lane into lanes: as many of its numbers as there is room for.
#[inline(always)]
fn put_row<S: Simd>(simd: S, rows: &[&[f64]; 8], numbers: &mut [[f64; 8]]) {
    let length = numbers.len();
    let mut eight = [f64x8::splat(simd, 0.0); 8];
    if length < 8 {
        for lane in 0..8 {
            let mut row = [0.0; 8];
            row[..length].copy_from_slice(rows[lane]);
            eight[lane] = f64x8::from_slice(simd, &row);
        }
        let columns = transposed(eight);
        for k in 0..length {
            columns[k].store_slice(&mut numbers[k]);
        }
        return;
    }
    let mut at = 0;
    while at < length {
        // The last eight numbers of a row overlap with those before.
        let from = at.min(length - 8);
        for lane in 0..8 {
            eight[lane] = f64x8::from_slice(simd, &rows[lane][from..from + 8]);
        }
        let columns = transposed(eight);
        for k in 0..8 {
            columns[k].store_slice(&mut numbers[from + k]);
        }
        at = from + 8;
    }
}

/// Converts the control points in lanes to nets by powers, with the operations of [`make`].
#[inline(always)]
fn make_all<S: Simd>(simd: S, form: Form, along: &[[ToPowers<'_>; 8]; 2], numbers: &mut Numbers) {
    match (form.degree(), form.rational) {
        // Unrolled for the most common degrees.
        ([3, 3], false) => make_all_of(simd, ([3, 3], 12), along, numbers),
        (degree @ [p, q], _) if p.max(q) <= 3 => {
            make_all_of(simd, (degree, form.row_length()), along, numbers);
        }
        (degree, _) => make_all_long(simd, (degree, form.row_length()), along, numbers),
    }
}

/// [`make_all`] for these degrees, up to three, and this many numbers in a row: all columns, then
/// all rows.
#[inline(always)]
fn make_all_of<S: Simd>(
    simd: S,
    ([p, q], length): ([usize; 2], usize),
    [along_s, along_t]: &[[ToPowers<'_>; 8]; 2],
    numbers: &mut Numbers,
) {
    let size = length / (q + 1);
    let shares = in_lanes::<S, 4>(simd, along_s, p);
    for column in 0..length {
        make_line(simd, &shares, p, column, length, numbers);
    }
    let shares = in_lanes::<S, 4>(simd, along_t, q);
    for i in 0..=p {
        for c in 0..size {
            make_line(simd, &shares, q, i * length + c, size, numbers);
        }
    }
}

/// [`make_all`] for any degrees.
#[simd]
fn make_all_long<S: Simd>(
    simd: S,
    ([p, q], length): ([usize; 2], usize),
    [along_s, along_t]: &[[ToPowers<'_>; 8]; 2],
    numbers: &mut Numbers,
) {
    let shares = in_lanes::<S, MOST_IN_LINE>(simd, along_s, p);
    let columns = Lines { blocks: 1, apart: 0, count: length, step: length };
    make_lines(simd, &shares, p, columns, numbers);
    let shares = in_lanes::<S, MOST_IN_LINE>(simd, along_t, q);
    let size = length / (q + 1);
    let rows = Lines { blocks: p + 1, apart: length, count: size, step: size };
    make_lines(simd, &shares, q, rows, numbers);
}

/// Converts points to coefficients of powers: every `step`-th number, from `first` on.
#[inline(always)]
fn make_line<S: Simd>(
    simd: S,
    shares: &Shares<S, 4>,
    degree: usize,
    first: usize,
    step: usize,
    numbers: &mut Numbers,
) {
    let mut points = [f64x8::splat(simd, 0.0); 4];
    for k in 0..=degree {
        points[k] = f64x8::from_slice(simd, &numbers[first + k * step]);
    }
    let made = coefficients(simd, shares, degree, points);
    for k in 0..=degree {
        made[k].store_slice(&mut numbers[first + k * step]);
    }
}

/// The shares by which the nets of all lanes are made.
#[inline(always)]
fn in_lanes<S: Simd, const N: usize>(
    simd: S,
    to_powers: &[ToPowers<'_>; 8],
    degree: usize,
) -> Shares<S, N> {
    let mut rows = [&[][..]; 8];
    for lane in 0..8 {
        rows[lane] = &to_powers[lane].shares()[..degree * (degree + 1)];
    }
    let mut numbers = [[[0.0; 8]; N]; N];
    let numbers = &mut numbers.as_flattened_mut()[..degree * (degree + 1)];
    put_row(simd, &rows, numbers);
    let mut shares = [[f64x8::splat(simd, 0.0); N]; N];
    for i in 0..=degree {
        for k in 0..degree {
            shares[i][k] = f64x8::from_slice(simd, &numbers[degree * i + k]);
        }
    }
    shares
}

impl<S: Simd> Net<S, f64x8<S>> for LaneNet {
    type Row<'a> = &'a [[f64; 8]];

    #[inline(always)]
    fn weight(&self, simd: S) -> Option<f64x8<S>> {
        let weight = f64x8::from_slice(simd, &self.weight);
        let ones = weight.simd_eq(f64x8::splat(simd, 1.0));
        if ones.all_true() { None } else { Some(weight) }
    }

    #[inline(always)]
    fn row(&self, i: usize, length: usize) -> Self::Row<'_> {
        &self.numbers[i * length..(i + 1) * length]
    }

    #[inline(always)]
    fn control<'a, const C: usize>(simd: S, row: &Self::Row<'a>, j: usize) -> [f64x8<S>; C]
    where
        Self: 'a,
    {
        let numbers = &row[C * j..C * (j + 1)];
        let mut control = [f64x8::splat(simd, 0.0); C];
        for c in 0..C {
            control[c] = f64x8::from_slice(simd, &numbers[c]);
        }
        control
    }
}
