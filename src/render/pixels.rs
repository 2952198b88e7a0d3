//! The data of a rectangle of pixels: sums of colour, coverage, first hits.

use std::ops::Range;

use super::sums::{OutOfMemory, SampleSums, block_count};
use super::{Aov, AovSet, PixelRect};

/// The samples of a rectangle of pixels, gathered: a tile while it is painted, and the
/// whole film in the end.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Pixels {
    window: PixelRect,
    /// Radiance, and albedo where it is asked for, pixel after pixel.
    sums: SampleSums,
    /// 3 for radiance alone, 6 with albedo.
    colors: usize,
    /// How many samples hit something.
    hits: Vec<u32>,
    /// The first hit in sample order, where data are asked for; meaningless without hits.
    first: Vec<FirstHit>,
    /// How many samples are in doubt, where that is asked for.
    doubts: Vec<u32>,
}

/// What one sample saw.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sample {
    pub(super) radiance: [f64; 3],
    pub(super) albedo: [f64; 3],
    pub(super) hit: Option<FirstHit>,
    /// Whether the answer for any of its rays is doubtful.
    pub(super) doubtful: bool,
}

/// The data of a hit, in the precision of the film.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct FirstHit {
    pub(super) distance: f32,
    pub(super) point: [f32; 3],
    pub(super) normal: [f32; 3],
    pub(super) uv: [f32; 2],
    pub(super) surface: f32,
}

impl Pixels {
    /// Pixels without samples; the first sample will be number `start`.
    pub(super) fn empty(window: PixelRect, aovs: AovSet, start: u32) -> Self {
        let (count, colors) = (window.area() as usize, colors(aovs));
        let first = if keeps_first(aovs) { vec![FirstHit::default(); count] } else { Vec::new() };
        let doubts = if aovs.contains(Aov::Doubt) { vec![0; count] } else { Vec::new() };
        let sums = SampleSums::empty(start, count * colors);
        Self { window, sums, colors, hits: vec![0; count], first, doubts }
    }

    /// Black pixels for a range of samples, to be filled by [`Pixels::insert`].
    ///
    /// # Errors
    /// If that much memory cannot be allocated.
    pub(super) fn black(
        window: PixelRect,
        aovs: AovSet,
        samples: Range<u32>,
    ) -> Result<Self, OutOfMemory> {
        let (count, colors) = (window.area() as usize, colors(aovs));
        let kept = if keeps_first(aovs) { count } else { 0 };
        let doubted = if aovs.contains(Aov::Doubt) { count } else { 0 };
        let bytes = count as u128
            * (block_count(samples.clone()) * colors * size_of::<f64>() + size_of::<u32>()) as u128
            + kept as u128 * size_of::<FirstHit>() as u128
            + doubted as u128 * size_of::<u32>() as u128;
        let sums = SampleSums::zeros(samples, count * colors).map_err(|_| OutOfMemory { bytes })?;
        let (mut hits, mut first, mut doubts) = (Vec::new(), Vec::new(), Vec::new());
        hits.try_reserve_exact(count).map_err(|_| OutOfMemory { bytes })?;
        hits.resize(count, 0);
        first.try_reserve_exact(kept).map_err(|_| OutOfMemory { bytes })?;
        first.resize(kept, FirstHit::default());
        doubts.try_reserve_exact(doubted).map_err(|_| OutOfMemory { bytes })?;
        doubts.resize(doubted, 0);
        Ok(Self { window, sums, colors, hits, first, doubts })
    }

    /// Resets to no samples, for another rectangle, keeping the memory.
    pub(super) fn restart(&mut self, window: PixelRect, start: u32) {
        let count = window.area() as usize;
        let kept = if self.first.is_empty() { 0 } else { count };
        self.window = window;
        self.sums.restart(start, count * self.colors);
        self.hits.clear();
        self.hits.resize(count, 0);
        self.first.clear();
        self.first.resize(kept, FirstHit::default());
        let doubted = if self.doubts.is_empty() { 0 } else { count };
        self.doubts.clear();
        self.doubts.resize(doubted, 0);
    }

    /// The pixels there are.
    pub(super) fn window(&self) -> PixelRect {
        self.window
    }

    /// Adds the next sample of every pixel; `sample` returns it for a pixel's index.
    pub(super) fn push(&mut self, sample: impl Fn(usize) -> Sample) {
        let Self { sums, colors, hits, first, doubts, .. } = self;
        sums.push(|values| {
            for (index, value) in values.chunks_exact_mut(*colors).enumerate() {
                let sample = sample(index);
                let (radiance, albedo) = value.split_at_mut(3);
                radiance.copy_from_slice(&sample.radiance);
                if !albedo.is_empty() {
                    albedo.copy_from_slice(&sample.albedo);
                }
                if let Some(doubts) = doubts.get_mut(index) {
                    *doubts += u32::from(sample.doubtful);
                }
                let Some(hit) = sample.hit else { continue };
                if hits[index] == 0
                    && let Some(first) = first.get_mut(index)
                {
                    *first = hit;
                }
                hits[index] += 1;
            }
        });
    }

    /// Copies pixels with the same samples and data into their place in this rectangle.
    pub(super) fn insert(&mut self, tile: &Self) {
        let width = tile.window.width() as usize;
        for row in 0..tile.window.height() {
            let from = row as usize * width;
            let to = self.window.index_of([tile.window.min()[0], tile.window.min()[1] + row]);
            let colors = self.colors;
            self.sums.copy_from(&tile.sums, from * colors, to * colors, width * colors);
            self.hits[to..to + width].copy_from_slice(&tile.hits[from..from + width]);
            if !self.first.is_empty() {
                self.first[to..to + width].copy_from_slice(&tile.first[from..from + width]);
            }
            if !self.doubts.is_empty() {
                self.doubts[to..to + width].copy_from_slice(&tile.doubts[from..from + width]);
            }
        }
    }

    /// Adds the samples that follow, of the same pixels with the same data.
    pub(super) fn append(&mut self, next: Self) {
        for (index, (hits, more)) in self.hits.iter_mut().zip(&next.hits).enumerate() {
            if *hits == 0
                && let Some(first) = self.first.get_mut(index)
            {
                *first = next.first[index];
            }
            *hits += more;
        }
        for (doubts, more) in self.doubts.iter_mut().zip(&next.doubts) {
            *doubts += more;
        }
        self.sums.append(next.sums);
    }

    /// The mean of radiance (0 to 2) or albedo (3 to 5) over a pixel's samples.
    pub(super) fn mean(&self, index: usize, color: usize) -> f64 {
        self.sums.mean(index * self.colors + color)
    }

    /// The share of samples that hit something.
    pub(super) fn coverage(&self, index: usize) -> f64 {
        self.share(self.hits[index])
    }

    /// The share of samples that are in doubt; 0 if that was not asked for.
    pub(super) fn doubt(&self, index: usize) -> f64 {
        self.doubts.get(index).map_or(0.0, |&doubts| self.share(doubts))
    }

    /// Which share of a pixel's samples so many are.
    fn share(&self, count: u32) -> f64 {
        let samples = self.sums.samples();
        f64::from(count) / f64::from(samples.end - samples.start)
    }

    /// The first hit in sample order, if there is one and it was asked for.
    pub(super) fn first_hit(&self, index: usize) -> Option<&FirstHit> {
        self.first.get(index).filter(|_| self.hits[index] > 0)
    }
}

fn colors(aovs: AovSet) -> usize {
    if aovs.contains(Aov::Albedo) { 6 } else { 3 }
}

fn keeps_first(aovs: AovSet) -> bool {
    aovs.iter().any(|aov| !matches!(aov, Aov::Albedo | Aov::Doubt))
}
