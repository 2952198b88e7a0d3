//! Control nets of eight pieces side by side.

use fearless_simd::{Simd, SimdBase, SimdMask, f64x8, mask64x8};
use fearless_simd_macros::simd;

use super::LANES;
use super::form::Form;
use super::frames::transposed;
use super::jets::Net;
use super::spline_net::make;
use crate::patch::{NetRoom, NetSource, Piece, PieceNet};

/// Pieces of higher degrees have too large nets to hold eight of them side by side.
pub(super) const MOST_DEGREE: usize = 7;

/// The numbers of the largest net.
const MOST_NUMBERS: usize = 4 * (MOST_DEGREE + 1) * (MOST_DEGREE + 1);

/// Eight nets of one form: number by number, row by row.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub(super) struct LaneNet {
    pub(super) form: Form,
    weight: [f64; 8],
    numbers: [[f64; 8]; MOST_NUMBERS],
    /// Room for nets that are not kept.
    rooms: [NetRoom; 8],
}

impl Default for LaneNet {
    fn default() -> Self {
        let form = Form::default();
        let rooms = std::array::from_fn(|_| NetRoom::new());
        Self { form, weight: [0.0; 8], numbers: [[0.0; 8]; MOST_NUMBERS], rooms }
    }
}

impl LaneNet {
    /// Takes in the nets of pieces `first … first + 7`; in lanes that are not `wanted`, of which there is one at
    /// least, that of another lane.
    #[simd]
    pub(super) fn take<S: Simd>(
        &mut self,
        simd: S,
        form: Form,
        (pieces, first): (&[&Piece; LANES], usize),
        wanted: mask64x8<S>,
    ) {
        self.form = form;
        let length = form.row_length();
        let mut nets = [PieceNet::EMPTY; 8];
        let wanted = wanted.to_bitmask();
        for (lane, room) in self.rooms.iter_mut().enumerate() {
            if wanted >> lane & 1 == 0 {
                continue;
            }
            let patch = &pieces[first + lane].patch;
            self.weight[lane] = patch.weight().unwrap_or(1.0);
            nets[lane] = match patch.sums_source() {
                NetSource::Kept(net) => net,
                NetSource::Spline(spline) => make(simd, &spline, room),
            };
        }
        let other = wanted.trailing_zeros() as usize % 8;
        for lane in 0..8 {
            if wanted >> lane & 1 == 0 {
                (nets[lane], self.weight[lane]) = (nets[other], self.weight[other]);
            }
        }
        for i in 0..=form.degree()[0] {
            let mut at = 0;
            while at < length {
                // Eight numbers; the last of a row overlap with those before.
                let from = at.min(length.saturating_sub(8));
                let mut rows = [f64x8::splat(simd, 0.0); 8];
                for lane in 0..8 {
                    let row = nets[lane].row(i);
                    rows[lane] = match row.get(from..from + 8) {
                        Some(numbers) => f64x8::from_slice(simd, numbers),
                        None => {
                            let mut numbers = [0.0; 8];
                            numbers[..length].copy_from_slice(&row[..length]);
                            f64x8::from_slice(simd, &numbers)
                        }
                    };
                }
                let columns = transposed(rows);
                for k in 0..length.min(8) {
                    columns[k].store_slice(&mut self.numbers[i * length + from + k]);
                }
                at = from + 8;
            }
        }
    }
}

impl<S: Simd> Net<S> for LaneNet {
    type Row<'a> = &'a [[f64; 8]];

    #[inline(always)]
    fn form(&self) -> Form {
        self.form
    }

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
