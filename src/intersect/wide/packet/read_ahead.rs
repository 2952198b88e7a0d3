//! Reading of rays from memory ahead of their tracing.

use std::hint::black_box;
use std::slice;

use crate::intersect::Shot;
use crate::intersect::wide::PACKET;
use crate::math::prefetch;

/// How many rays are read in one go.
const AT_ONCE: usize = 16 * PACKET;

/// How far ahead of a packet, in rays, others are prefetched while the packet is traced.
const FARTHEST: usize = 32 * PACKET;

/// Reads the rays of a batch some time before they are traced.
///
/// A long run of rays is read at the full rate of memory. The rays of one packet are only a page of
/// memory or two: read by themselves, they would each time wait anew for the first to arrive.
/// Measured on a million rays in memory, on Zen 4: a ray of a picture's background takes 5 ns
/// instead of 10.
#[derive(Debug, Default)]
pub(crate) struct ReadAhead {
    /// How many of the rays that come next have been read or prefetched.
    left: usize,
}

/// Rays to be prefetched while others are traced.
#[derive(Debug)]
pub(crate) struct Ahead<'a, Q> {
    rays: slice::Iter<'a, Q>,
    at: Moment,
}

/// Where on its way a packet prefetches rays that come after it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Moment {
    /// At each box it comes to. Measured on a Xeon with AVX-512: shadow rays, which carry the root
    /// they leave and are thus half as large again as rays alone, are traced 1.04 to 1.09 times as
    /// fast; ambient occlusion 1.02 to 1.03 times. Rays of pictures, whose background takes less
    /// time than memory does, become slower: 0.95.
    Box,
    /// Where it finishes a leaf in f64, which takes longer than memory does. Measured on Zen 4:
    /// rays of pictures are traced 1.02 to 1.06 times as fast; shadow rays, many of which need no
    /// finish, at 0.98 to 1.04 of the speed with [`Box`](Self::Box).
    Finish,
}

impl Moment {
    /// How many rays are prefetched at a time.
    fn count(self) -> usize {
        match self {
            Self::Box => 8,     // no more than processors wait for at a time
            Self::Finish => 16, // one for each lane
        }
    }
}

impl ReadAhead {
    /// Makes sure that the rays of the next packet, the first of `rest`, have been read. They then
    /// count as traced.
    #[inline(always)]
    pub(crate) fn read<Q: Shot>(&mut self, rest: &[Q]) {
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

    /// Runs `trace`, which may prefetch `others`, the rays after its packet, as it goes.
    #[inline(always)]
    pub(crate) fn while_tracing<Q>(
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
    /// Prefetches some more rays, if this is the moment.
    #[inline(always)]
    pub(super) fn ask(&mut self, at: Moment) {
        if at == self.at {
            self.rays.by_ref().take(at.count()).for_each(prefetch);
        }
    }
}
