//! Painting a tile: samples in, pixels out.

use std::ops::Range;

use glam::DVec2;

use super::integrator::{Batch, Integrator};
use super::pixels::{FirstHit, Pixels, Sample};
use super::tile::pixels_of;
use super::{Aov, Counters, Dimensions, PixelRect, RenderSettings, Sampler};
use crate::intersect::{Answer, Neighbours, Statistics, Tracer};
use crate::math::Ray;
use crate::scene::World;

/// Samples of a pixel traced together: with tiles of 256 pixels a batch is up to 1024 rays,
/// whose answers stay in the second-level cache, and 16 neighbouring pixels
/// make a packet of 64 rays.
const SAMPLES_TOGETHER: usize = 4;

/// Paints tiles on one thread. Nothing it does depends on which tiles it has painted.
#[derive(Debug)]
pub(super) struct Painter<'a> {
    world: &'a World,
    settings: &'a RenderSettings,
    sampler: Sampler,
    tracer: Tracer<'a>,
    integrator: Integrator,
    batch: Batch,
    /// The pixels of the tile in the order they are traced.
    order: Vec<[u32; 2]>,
    /// For each pixel, row after row, its place in that order.
    rank: Vec<usize>,
    pixels: Pixels,
}

impl<'a> Painter<'a> {
    /// `neighbours` says how the camera's rays are best traced, as in [`World::neighbours`].
    pub(super) fn new(
        world: &'a World,
        settings: &'a RenderSettings,
        neighbours: Neighbours,
    ) -> Self {
        Self {
            world,
            settings,
            sampler: Sampler::new(settings.seed),
            tracer: world.bvh.tracer_with(settings.kernel),
            integrator: Integrator::new(settings.integrator, world, neighbours),
            batch: Batch::default(),
            order: Vec::new(),
            rank: Vec::new(),
            pixels: Pixels::empty(PixelRect::FIRST, settings.aovs, settings.samples.start),
        }
    }

    /// Takes all samples of the pixels of a tile.
    pub(super) fn paint(&mut self, tile: PixelRect) -> (&Pixels, Counters) {
        let samples = self.settings.samples.clone();
        self.pixels.restart(tile, samples.start);
        self.order.clear();
        self.order.extend(pixels_of(tile));
        self.rank.resize(self.order.len(), 0);
        for (rank, &pixel) in self.order.iter().enumerate() {
            self.rank[tile.index_of(pixel)] = rank;
        }

        let mut counters = Counters::default();
        for first in samples.clone().step_by(SAMPLES_TOGETHER) {
            let end = samples.end.min(first.saturating_add(SAMPLES_TOGETHER as u32));
            self.aim(first..end);
            counters += self.integrator.see(self.world, &mut self.tracer, &mut self.batch);
            self.gather((end - first) as usize);
        }
        (&self.pixels, counters)
    }

    /// The work of all tiles so far.
    pub(super) fn statistics(&self) -> Statistics {
        self.tracer.statistics()
    }

    /// Makes the camera rays of some samples of every pixel, a pixel's samples together.
    fn aim(&mut self, samples: Range<u32>) {
        let size = DVec2::new(f64::from(self.settings.size[0]), f64::from(self.settings.size[1]));
        let (per_size, aspect) = (size.recip(), size.x / size.y);
        self.batch.rays.clear();
        for &pixel in &self.order {
            let mut points = self.sampler.of_pixel(pixel, Dimensions::Film);
            for index in samples.clone() {
                let [x, y] = points.sample(index);
                let place = DVec2::new(f64::from(pixel[0]) + x, f64::from(pixel[1]) + y);
                self.batch.rays.push(self.world.camera.ray(place * per_size, aspect));
            }
        }
    }

    /// Adds what a batch saw to the pixels, one sample of each after the other.
    fn gather(&mut self, together: usize) {
        let (world, aovs) = (self.world, self.settings.aovs);
        let (batch, rank) = (&self.batch, &self.rank);
        for sample in 0..together {
            self.pixels.push(|pixel| {
                let seen = rank[pixel] * together + sample;
                let (ray, answer) = (&batch.rays[seen], &batch.answers[seen]);
                let albedo = match &answer.hit {
                    Some(hit) if aovs.contains(Aov::Albedo) => world.albedo(hit),
                    _ => [0.0; 3],
                };
                let (radiance, doubtful) = (batch.radiance[seen], batch.doubtful[seen]);
                Sample { radiance, albedo, hit: first_hit(ray, answer), doubtful }
            });
        }
    }
}

/// A hit in the precision of the film.
fn first_hit(ray: &Ray, answer: &Answer) -> Option<FirstHit> {
    let hit = answer.hit.as_ref()?;
    let normal = if hit.normal.is_nan() { [0.0; 3] } else { hit.normal.as_vec3().to_array() };
    Some(FirstHit {
        distance: (hit.t * ray.direction().length()) as f32,
        point: hit.point.as_vec3().to_array(),
        normal,
        uv: hit.uv.as_vec2().to_array(),
        surface: hit.surface as f32,
    })
}
