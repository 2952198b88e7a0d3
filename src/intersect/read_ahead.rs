//! Rays on their way from memory to the processor.

use std::hint::black_box;
use std::slice;

use super::Shot;
use super::wide::PACKET;
use crate::math::prefetch;

/// So many rays are read in one go.
const AT_ONCE: usize = 16 * PACKET;

/// So far ahead of a packet rays are asked for while it is traced.
const FARTHEST: usize = 32 * PACKET;

/// Reads the rays of a batch some time before they are traced.
///
/// A long row of them is read at the rate at which memory gives them. Those of one packet are a page of
/// memory or two: each time, it would wait anew until the first have come. Measured on a million rays in
/// memory, on Zen 4: a ray of a picture's background takes 5 ns instead of 10.
#[derive(Debug, Default)]
pub(super) struct ReadAhead {
    /// How many of those that come next have been read or asked for.
    left: usize,
}

/// Rays to be asked for while others are traced.
#[derive(Debug)]
pub(super) struct Ahead<'a, Q> {
    rays: slice::Iter<'a, Q>,
    at: Moment,
}

/// Where on its way a packet asks for rays that come after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Moment {
    /// At each box it comes to. Measured on a Xeon with AVX-512: with that, shadow rays are traced 1.04 to 1.09
    /// times as fast, which come with what they leave and are thus half as large again as rays alone; ambient
    /// occlusion 1.02 to 1.03 times. Rays of pictures are not, whose background takes less time than memory
    /// does: 0.95.
    Box,
    /// Where it finishes a leaf in f64, which takes longer than memory does. Measured on Zen 4: rays of pictures
    /// are traced 1.02 to 1.06 times as fast; shadow rays, of which many need no finish, at 0.98 to 1.04 of
    /// [`Box`](Self::Box).
    Finish,
}

impl Moment {
    /// How many rays are asked for.
    fn count(self) -> usize {
        match self {
            Self::Box => 8,     // no more than processors wait for at a time
            Self::Finish => 16, // those of as many lanes
        }
    }
}

impl ReadAhead {
    /// Sees to it that the rays of the packet that comes next, the first of `rest`, have been read. They
    /// are then taken for traced.
    #[inline(always)]
    pub(super) fn read<Q: Shot>(&mut self, rest: &[Q]) {
        if self.left < PACKET {
            let mut all = 0;
            for shot in &rest[..rest.len().min(AT_ONCE)] {
                let from = shot.start_root().map_or(0, |root| u64::from(root.piece));
                all |= shot.ray().t_min().to_bits() | from;
            }
            black_box(all);
            self.left = AT_ONCE;
        }
        self.left -= PACKET;
    }

    /// Runs `trace`, which may ask for the rays behind that packet, `others`, as it goes.
    #[inline(always)]
    pub(super) fn while_tracing<Q>(
        &mut self,
        others: &[Q],
        at: Moment,
        trace: impl FnOnce(&mut Ahead<'_, Q>),
    ) {
        let end = others.len().min(FARTHEST);
        let rays = others[..end].get(self.left..).unwrap_or_default().iter();
        let mut ahead = Ahead { rays, at };
        let asked = ahead.rays.len();
        trace(&mut ahead);
        self.left += asked - ahead.rays.len();
    }
}

impl<Q> Ahead<'_, Q> {
    /// Asks for some more, if this is the moment.
    #[inline(always)]
    pub(super) fn ask(&mut self, at: Moment) {
        if at == self.at {
            self.rays.by_ref().take(at.count()).for_each(prefetch);
        }
    }
}
