//! The picture: the result of all samples of all pixels.

use std::ops::{AddAssign, Range};

use thiserror::Error;

use super::pixels::Pixels;
use super::sums::OutOfMemory;
use super::{Channel, PixelRect, RenderSettings, SettingsError};
use crate::intersect::Statistics;
use crate::scene::Camera;

/// A rendered picture, or a part of one: linear colour, coverage and data of each pixel.
///
/// - `R G B` is the mean radiance over the pixel (box filter), background included,
///   linear with Rec. 709 primaries. Samples lie anywhere in the pixel, as the
///   [`Sampler`](super::Sampler) spreads them.
/// - `A` is the coverage, the share of samples that hit a surface. Over a black background
///   colour is thus premultiplied, as compositing expects; from `R G B` over another one
///   take `(1 − A) · background`.
/// - [`Aov`](super::Aov) says what the data channels hold.
///
/// Films of neighbouring sample ranges can be merged: the result is the film of the
/// joined range bit for bit, for sums over samples do not depend on the split. Films of crops
/// can be pasted into that of the whole picture.
///
/// Films are equal if they are the same picture: of the same size, window, channels and range of
/// samples, with the same numbers in all pixels (those of the sums, which are f64). How it was
/// made does not count, neither the threads and what else is in the [settings](Film::settings),
/// nor the [counters](Film::counters): the work depends on which samples were traced together.
#[derive(Clone, Debug)]
pub struct Film {
    settings: RenderSettings,
    pixels: Pixels,
    counters: Counters,
}

impl PartialEq for Film {
    fn eq(&self, other: &Self) -> bool {
        let (a, b) = (&self.settings, &other.settings);
        // The pixels know their window and their samples.
        a.size == b.size && a.aovs == b.aovs && self.pixels == other.pixels
    }
}

/// What was traced for a film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Rays traced, shadow rays among them.
    pub rays: u64,
    /// Camera rays that hit something.
    pub hits: u64,
    /// Rays whose answer floating point could not decide, shadow rays among them.
    pub doubtful: u64,
    /// The work done.
    pub statistics: Statistics,
}

impl AddAssign for Counters {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.doubtful += other.doubtful;
        self.statistics += other.statistics;
    }
}

/// Why there is no film.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum FilmError {
    /// There can be no such picture.
    #[error(transparent)]
    Settings(#[from] SettingsError),
    /// The memory cannot be allocated.
    #[error("a film of {width}x{height} pixels needs {bytes} bytes, more than can be had")]
    Memory {
        /// The width of the rendered part.
        width: u32,
        /// The height of the rendered part.
        height: u32,
        /// How much memory.
        bytes: u128,
    },
}

/// Why two films cannot be merged.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum MergeError {
    /// They do not show the same picture.
    #[error("films of different {0} cannot be merged")]
    Different(&'static str),
    /// The range of one does not begin where the other's ends.
    #[error(
        "films of samples {}..{} and {}..{} cannot be merged: one range must follow the other",
        .0.start, .0.end, .1.start, .1.end
    )]
    NotNeighbours(Range<u32>, Range<u32>),
}

/// Why a film cannot be pasted into another.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum PasteError {
    /// They are not of the same picture.
    #[error("films of different {0} cannot be pasted into each other")]
    Different(&'static str),
    /// The film has no place for some of the pixels.
    #[error("the pixels {part} cannot be pasted into a film that holds {window} only")]
    Outside {
        /// The pixels to be pasted.
        part: PixelRect,
        /// Those of the film.
        window: PixelRect,
    },
}

impl Film {
    /// A black film for these settings.
    ///
    /// # Errors
    /// When there can be no such picture, or no memory for it.
    pub fn new(settings: &RenderSettings) -> Result<Self, FilmError> {
        settings.check()?;
        let window = settings.window()?;
        let pixels = Pixels::black(window, settings.aovs, settings.samples.clone()).map_err(
            |OutOfMemory { bytes }| {
                let (width, height) = (window.width(), window.height());
                FilmError::Memory { width, height, bytes }
            },
        )?;
        Ok(Self { settings: settings.clone(), pixels, counters: Counters::default() })
    }

    /// What picture it is; after a merge, `samples` is the joined range.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The pixels it holds: all of the picture, or the crop.
    pub fn window(&self) -> PixelRect {
        self.pixels.window()
    }

    /// What was traced for it.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The channels it holds, colour first.
    pub fn channels(&self) -> impl Iterator<Item = Channel> {
        self.settings.aovs.channels()
    }

    /// One number of one pixel of the picture; `None` off the window, and for channels the
    /// film does not hold.
    pub fn value(&self, channel: Channel, pixel: [u32; 2]) -> Option<f32> {
        let holds = self.window().contains(pixel) && self.channels().any(|held| held == channel);
        holds.then(|| self.value_at(channel, self.window().index_of(pixel)))
    }

    /// One channel of all pixels of the window, row after row from the top; `None` for
    /// channels the film does not hold.
    pub fn plane(&self, channel: Channel) -> Option<Vec<f32>> {
        let holds = self.channels().any(|held| held == channel);
        let count = self.window().area() as usize;
        holds.then(|| (0..count).map(|index| self.value_at(channel, index)).collect())
    }

    /// One channel of one row of the window, from the left; `None` for rows off the window, and for
    /// channels the film does not hold. `y` is counted from the top of the picture.
    pub fn row(&self, channel: Channel, y: u32) -> Option<impl Iterator<Item = f32> + '_> {
        let window = self.window();
        let first = [window.min()[0], y];
        let holds = window.contains(first) && self.channels().any(|held| held == channel);
        let pixels = |start: usize| start..start + window.width() as usize;
        holds
            .then(|| pixels(window.index_of(first)).map(move |index| self.value_at(channel, index)))
    }

    /// How many pixels hold a number beyond 3.4e38, the largest of 32 bits, in any channel: it is
    /// infinite there. (The distance of pixels in which nothing is hit does not count.)
    pub fn overflows(&self) -> u64 {
        let lost = |index: usize, channel: Channel| {
            let is_miss = channel == Channel::Z && self.pixels.first_hit(index).is_none();
            !is_miss && !self.value_at(channel, index).is_finite()
        };
        let pixels = 0..self.window().area() as usize;
        pixels.filter(|&index| self.channels().any(|channel| lost(index, channel))).count() as u64
    }

    /// How many pixels have a point whose steps are coarser than a tenth of the pixel.
    ///
    /// Points are of 32 bits. Where the largest coordinate has magnitude `m`, neighbouring ones
    /// are up to `2⁻²³ m` apart; the rays through neighbouring pixels are
    /// [this far](Camera::pixel_width) apart at the distance of the hit. Returns 0 for films
    /// without data of hits.
    pub fn coarse_points(&self, camera: &Camera) -> u64 {
        let size = self.settings.size;
        // At distance 0 the pixels of a perspective camera have no width, and those of an
        // orthographic one have all of it: in between the width grows evenly.
        let [start, one] = [0.0, 1.0].map(|depth| camera.pixel_width(size, depth));
        let coarse = |index: &usize| {
            self.pixels.first_hit(*index).is_some_and(|hit| {
                let largest = hit.point.iter().fold(0.0, |m: f32, x| m.max(x.abs()));
                let step = f64::from(f32::EPSILON) * f64::from(largest);
                step > 0.1 * (start + (one - start) * f64::from(hit.distance))
            })
        };
        (0..self.window().area() as usize).filter(coarse).count() as u64
    }

    fn value_at(&self, channel: Channel, index: usize) -> f32 {
        use Channel::*;
        let mean = |color| self.pixels.mean(index, color) as f32;
        let first = self.pixels.first_hit(index);
        match channel {
            R => mean(0),
            G => mean(1),
            B => mean(2),
            A => self.pixels.coverage(index) as f32,
            Z => first.map_or(f32::INFINITY, |hit| hit.distance),
            PX => first.map_or(0.0, |hit| hit.point[0]),
            PY => first.map_or(0.0, |hit| hit.point[1]),
            PZ => first.map_or(0.0, |hit| hit.point[2]),
            NX => first.map_or(0.0, |hit| hit.normal[0]),
            NY => first.map_or(0.0, |hit| hit.normal[1]),
            NZ => first.map_or(0.0, |hit| hit.normal[2]),
            U => first.map_or(0.0, |hit| hit.uv[0]),
            V => first.map_or(0.0, |hit| hit.uv[1]),
            AlbedoR => mean(3),
            AlbedoG => mean(4),
            AlbedoB => mean(5),
            Id => first.map_or(-1.0, |hit| hit.surface),
            Doubt => self.pixels.doubt(index) as f32,
        }
    }

    /// This film and one of the same picture whose samples directly follow or precede.
    ///
    /// Joining A..B with B..C gives the film of A..C, bit for bit, in either order.
    ///
    /// # Errors
    /// When the films differ in size, crop, integrator, data channels, seed or kernel, or one
    /// range does not follow the other. That both are of the same scene and camera cannot be
    /// seen from films, and is up to the caller.
    pub fn merge(self, other: Self) -> Result<Self, MergeError> {
        let crops = (self.window() != other.window()).then_some("crops");
        if let Some(what) = self.differing(&other).or(crops) {
            return Err(MergeError::Different(what));
        }
        let (a, b) = (&self.settings, &other.settings);
        let (mut first, second) = if a.samples.end == b.samples.start {
            (self, other)
        } else if b.samples.end == a.samples.start {
            (other, self)
        } else {
            return Err(MergeError::NotNeighbours(a.samples.clone(), b.samples.clone()));
        };
        first.settings.samples.end = second.settings.samples.end;
        first.pixels.append(second.pixels);
        first.counters += second.counters;
        Ok(first)
    }

    /// Puts the pixels of a film of the same picture, as a rule of a crop, in their places in this
    /// one, which is as a rule that of the whole picture.
    ///
    /// A film of crops that cover it is that of the whole picture, bit for bit. What nothing is
    /// pasted on stays as it was, black in a [new](Film::new) film; where crops overlap, the last
    /// one counts, which has the same pixels. Counters are added up: paste each crop once.
    ///
    /// ```
    /// use nurbray::render::{Film, PixelRect, RenderSettings};
    ///
    /// let settings = RenderSettings { size: [8, 6], ..Default::default() };
    /// let mut whole = Film::new(&settings)?;
    /// for (min, max) in [([0, 0], [8, 3]), ([0, 3], [8, 6])] {
    ///     let crop = Some(PixelRect::new(min, max)?);
    ///     // Here the crop would be rendered, on some other machine perhaps.
    ///     let part = Film::new(&RenderSettings { crop, ..settings.clone() })?;
    ///     whole.paste(&part)?;
    /// }
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// When the films differ in size, integrator, data channels, seed, kernel or samples, or the
    /// other one has pixels that this one has not; this film then stays as it was. That both are
    /// of the same scene and camera cannot be seen from films, and is up to the caller.
    pub fn paste(&mut self, part: &Self) -> Result<(), PasteError> {
        let samples = (self.settings.samples != part.settings.samples).then_some("samples");
        if let Some(what) = self.differing(part).or(samples) {
            return Err(PasteError::Different(what));
        }
        let (part_window, window) = (part.window(), self.window());
        if window.intersection(&part_window) != Some(part_window) {
            return Err(PasteError::Outside { part: part_window, window });
        }
        self.insert(&part.pixels, part.counters);
        Ok(())
    }

    /// What keeps films from being parts of one picture, whatever their crops and samples.
    fn differing(&self, other: &Self) -> Option<&'static str> {
        let (a, b) = (&self.settings, &other.settings);
        let same = [
            ("sizes", a.size == b.size),
            ("integrators", a.integrator == b.integrator),
            ("data channels", a.aovs == b.aovs),
            ("seeds", a.seed == b.seed),
            ("kernels", a.kernel == b.kernel),
        ];
        same.into_iter().find(|(_, same)| !same).map(|(what, _)| what)
    }

    /// Puts a painted tile in its place.
    pub(super) fn insert(&mut self, tile: &Pixels, counters: Counters) {
        self.pixels.insert(tile);
        self.count(counters);
    }

    /// Adds to the counters of what was traced.
    pub(super) fn count(&mut self, counters: Counters) {
        self.counters += counters;
    }
}

#[cfg(test)]
impl Film {
    /// A film of made-up samples, painted in two tiles: the left columns and the others.
    pub(crate) fn made_up(settings: &RenderSettings) -> Self {
        let mut film = Self::new(settings).unwrap();
        let ([x0, y0], [x1, y1]) = (film.window().min(), film.window().max());
        let middle = x0 + 2.min(x1 - x0 - 1);
        for (min, max) in [([x0, y0], [middle, y1]), ([middle, y0], [x1, y1])] {
            let window = PixelRect::new(min, max).unwrap();
            let mut pixels = Pixels::empty(window, settings.aovs, settings.samples.start);
            let width = window.width() as usize;
            for sample in settings.samples.clone() {
                let x = |index| min[0] as usize + index % width;
                let y = |index| min[1] as usize + index / width;
                pixels.push(|i| tests::seen(sample, y(i) * settings.size[0] as usize + x(i)));
            }
            let counters =
                Counters { rays: u64::from(settings.samples.end), ..Counters::default() };
            film.insert(&pixels, counters);
        }
        film
    }
}

#[cfg(test)]
mod tests {
    use super::super::pixels::{FirstHit, Sample};
    use super::super::{Aov, AovSet};
    use super::*;
    use crate::scene::{Projection, View};
    use glam::DVec3;

    fn settings(samples: Range<u32>) -> RenderSettings {
        RenderSettings { size: [3, 2], samples, aovs: AovSet::all(), ..RenderSettings::default() }
    }

    /// A made-up sample: pixel 0 is never hit, pixel 1 by odd samples only, others always.
    pub(super) fn seen(sample: u32, index: usize) -> Sample {
        let x = 0.1 + f64::from(sample) * 1.37 + index as f64;
        let hit = (index > 1 || (index == 1 && sample % 2 == 1)).then_some(FirstHit {
            distance: x as f32,
            point: [1.0, 2.0, x as f32],
            normal: [0.0, 0.6, 0.8],
            uv: [0.25, x as f32],
            surface: sample as f32,
        });
        let albedo = if hit.is_some() { [0.5, 0.25, 0.125] } else { [0.0; 3] };
        let radiance = [x.sin().abs(), x.cos().abs() * 1e8, 1e-8 * x];
        Sample { radiance, albedo, hit, doubtful: (sample + index as u32).is_multiple_of(4) }
    }

    fn film(samples: Range<u32>) -> Film {
        Film::made_up(&settings(samples))
    }

    #[test]
    fn numbers_beyond_32_bits_are_counted() {
        let sample = |radiance, distance| {
            let hit = Some(FirstHit { distance, ..FirstHit::default() });
            Sample { radiance: [radiance; 3], hit, ..Sample::default() }
        };
        let samples = [
            sample(1.0, 1.0),
            sample(1e39, 1.0),
            sample(1.0, f32::INFINITY),
            Sample::default(), // infinitely far, as nothing is hit
            sample(3.4e38, 1.0),
            sample(f64::NAN, 1.0),
        ];
        let mut film = Film::new(&settings(0..1)).unwrap();
        let mut pixels = Pixels::empty(film.window(), AovSet::all(), 0);
        pixels.push(|index| samples[index]);
        film.insert(&pixels, Counters::default());
        assert_eq!(film.overflows(), 3);
    }

    #[test]
    fn points_with_steps_of_a_tenth_of_a_pixel_are_counted() {
        // At distance 12 a pixel of 2 rows is 12 wide, so that steps may be 1.2: up to 1e7.
        let view = View { look_from: DVec3::X, look_at: DVec3::ZERO, up: DVec3::Z };
        let camera = Camera::new(view, Projection::Perspective { fov: 90.0 }).unwrap();
        let points = [0.0, 1e7, -1e7, 1.01e7, -1.01e7, f32::INFINITY];
        let mut film = Film::new(&settings(0..1)).unwrap();
        let mut pixels = Pixels::empty(film.window(), AovSet::all(), 0);
        pixels.push(|index| {
            let point = [1.0, points[index], 0.0];
            let hit = Some(FirstHit { distance: 12.0, point, ..FirstHit::default() });
            Sample { hit, ..Sample::default() }
        });
        film.insert(&pixels, Counters::default());
        assert_eq!(film.coarse_points(&camera), 3);
    }

    #[test]
    fn channels_hold_what_they_say() {
        let film = film(0..4);
        let value = |channel, pixel| film.value(channel, pixel).unwrap();
        let mean: f64 = (0..4).map(|s| seen(s, 4).radiance[1]).sum::<f64>() / 4.0;
        assert_eq!(value(Channel::G, [1, 1]), mean as f32);
        // Never hit: no coverage, infinitely far, no id.
        assert_eq!(value(Channel::A, [0, 0]), 0.0);
        assert_eq!(value(Channel::Z, [0, 0]), f32::INFINITY);
        assert_eq!(value(Channel::Id, [0, 0]), -1.0);
        assert_eq!(value(Channel::NY, [0, 0]), 0.0);
        // Hit by samples 1 and 3: half covered, data of sample 1, albedo averaged.
        assert_eq!(value(Channel::A, [1, 0]), 0.5);
        assert_eq!(value(Channel::Id, [1, 0]), 1.0);
        assert_eq!(value(Channel::Z, [1, 0]), seen(1, 1).hit.unwrap().distance);
        assert_eq!(value(Channel::AlbedoG, [1, 0]), 0.125);
        assert_eq!(value(Channel::AlbedoG, [2, 0]), 0.25);
        assert_eq!(value(Channel::NZ, [2, 1]), 0.8);
        // One sample of four is in doubt, whether it hits anything or not.
        assert_eq!([0, 1].map(|x| value(Channel::Doubt, [x, 0])), [0.25; 2]);
        // Off the window there is nothing.
        assert_eq!(film.value(Channel::R, [3, 0]), None);
    }

    #[test]
    fn planes_are_rows_from_the_top_and_only_what_was_asked_for() {
        let film = film(0..1);
        let plane = film.plane(Channel::Z).unwrap();
        assert_eq!(plane.len(), 6);
        assert_eq!(plane[4], film.value(Channel::Z, [1, 1]).unwrap());
        let settings = RenderSettings { aovs: AovSet::NONE.with(Aov::Id), ..settings(0..1) };
        let film = Film::new(&settings).unwrap();
        assert_eq!(film.plane(Channel::Z), None);
        assert_eq!(film.plane(Channel::AlbedoR), None);
        assert!(film.row(Channel::AlbedoR, 0).is_none() && film.row(Channel::Id, 2).is_none());
        assert_eq!(film.plane(Channel::Id), Some(vec![-1.0; 6]));

        let crop = PixelRect::new([5, 3], [20, 19]).unwrap();
        let settings = RenderSettings { size: [37, 21], crop: Some(crop), ..settings };
        let film = Film::made_up(&RenderSettings { aovs: AovSet::all(), ..settings });
        for channel in film.channels() {
            let rows = (3..19).flat_map(|y| film.row(channel, y).unwrap());
            let bits = |x: f32| x.to_bits();
            let [rows, plane] = [rows.collect(), film.plane(channel).unwrap()]
                .map(|all: Vec<f32>| all.into_iter().map(bits).collect::<Vec<_>>());
            assert_eq!(rows, plane, "{channel:?}");
        }
        assert!(film.row(Channel::Z, 2).is_none() && film.row(Channel::Z, 19).is_none());
    }

    #[test]
    fn merged_ranges_are_the_film_of_the_whole_bit_for_bit() {
        for (start, end) in [(0, 16), (1, 12), (6, 23)] {
            let whole = film(start..end);
            for middle in start + 1..end {
                let (a, b) = (film(start..middle), film(middle..end));
                for merged in [a.clone().merge(b.clone()).unwrap(), b.merge(a).unwrap()] {
                    assert_eq!(merged.settings(), whole.settings());
                    for channel in whole.channels() {
                        let bits = |film: &Film| -> Vec<u32> {
                            film.plane(channel).unwrap().iter().map(|x| x.to_bits()).collect()
                        };
                        assert_eq!(bits(&merged), bits(&whole), "{channel:?}, split at {middle}");
                    }
                }
            }
        }
    }

    #[test]
    fn refuses_films_that_do_not_belong_together() {
        let other = RenderSettings { seed: 9, ..settings(4..6) };
        let other = Film::new(&other).unwrap();
        let message = |a: Film, b: Film| a.merge(b).unwrap_err().to_string();
        assert_eq!(message(film(0..4), other), "films of different seeds cannot be merged");
        assert_eq!(
            message(film(0..4), film(5..6)),
            "films of samples 0..4 and 5..6 cannot be merged: one range must follow the other"
        );
        assert!(film(0..4).merge(film(0..4)).is_err());
    }

    #[test]
    fn refuses_to_paste_what_does_not_belong_there() {
        let crop = |min, max| Some(PixelRect::new(min, max).unwrap());
        let part = RenderSettings { crop: crop([0, 0], [2, 2]), ..settings(0..4) };
        let mut left = Film::made_up(&part);
        let before = left.clone();
        assert_eq!(
            left.paste(&film(0..4)).unwrap_err().to_string(),
            "the pixels 0,0,3,2 cannot be pasted into a film that holds 0,0,2,2 only"
        );
        let other = |settings| left.clone().paste(&Film::new(&settings).unwrap());
        let message = |settings| other(settings).unwrap_err().to_string();
        let inside = RenderSettings { crop: crop([1, 0], [2, 1]), ..settings(0..4) };
        assert_eq!(other(inside.clone()), Ok(()));
        assert_eq!(
            message(RenderSettings { samples: 0..8, ..inside.clone() }),
            "films of different samples cannot be pasted into each other"
        );
        assert_eq!(
            message(RenderSettings { size: [4, 2], ..inside }),
            "films of different sizes cannot be pasted into each other"
        );
        assert_eq!((&left, left.counters()), (&before, before.counters()));
    }

    #[test]
    fn equal_films_are_the_same_picture_however_it_was_made() {
        let whole = film(0..8);
        let made = Film::made_up(&RenderSettings { threads: 2, ..settings(0..8) });
        let crop = Some(PixelRect::new([0, 0], [3, 2]).unwrap());
        let cropped = Film::made_up(&RenderSettings { crop, ..settings(0..8) });
        let merged = film(0..3).merge(film(3..8)).unwrap();
        assert_ne!(merged.counters(), whole.counters());
        assert!([made, cropped, merged].iter().all(|film| *film == whole));

        let crop = Some(PixelRect::new([1, 0], [3, 2]).unwrap());
        for other in [
            RenderSettings { samples: 0..7, ..settings(0..8) },
            RenderSettings { samples: 8..16, ..settings(0..8) },
            RenderSettings { aovs: AovSet::NONE, ..settings(0..8) },
            RenderSettings { size: [2, 3], ..settings(0..8) },
            RenderSettings { crop, ..settings(0..8) },
        ] {
            assert_ne!(Film::made_up(&other), whole);
        }
        assert_ne!(Film::new(&settings(0..8)).unwrap(), whole); // other pixels
    }

    #[test]
    fn merging_adds_counters() {
        let merged = film(0..2).merge(film(2..5)).unwrap();
        assert_eq!(merged.counters().rays, 2 * (2 + 5));
    }
}
