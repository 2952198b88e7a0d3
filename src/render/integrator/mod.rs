//! What camera rays see: radiance, or a property of the hit as a colour.

mod direct;
mod false_color;
mod work;

use super::Counters;
use crate::intersect::{Answer, Neighbours, Tracer};
use crate::math::Ray;
use crate::scene::{IntegratorKind, Rgb, World};

use direct::Direct;
use false_color::HitColor;

/// A way to find what camera rays see, ready for one picture of one world, with its scratch memory.
#[derive(Debug)]
pub(super) struct Integrator {
    method: Method,
    neighbours: Neighbours,
}

#[derive(Debug)]
enum Method {
    /// Lights, shadows and materials.
    Direct(Direct),
    /// A property of the hit as a colour; black where there is none.
    Hit(HitColor),
    /// How much work a ray took, hit or not.
    Iterations,
}

/// Camera rays and what came of them, in the same order.
#[derive(Debug, Default)]
pub(super) struct Batch {
    pub(super) rays: Vec<Ray>,
    pub(super) answers: Vec<Answer>,
    pub(super) radiance: Vec<Rgb>,
    /// Whether the answer for the ray, or for one to a light from its hit, is doubtful.
    pub(super) doubtful: Vec<bool>,
}

impl Integrator {
    /// The integrator of this kind; `neighbours` says how rays are best traced.
    pub(super) fn new(kind: IntegratorKind, world: &World, neighbours: Neighbours) -> Self {
        let method = match kind {
            IntegratorKind::Direct => Method::Direct(Direct::default()),
            IntegratorKind::Normal => Method::Hit(HitColor::Normal),
            IntegratorKind::Uv => Method::Hit(HitColor::Uv),
            IntegratorKind::Depth => Method::Hit(HitColor::depth(world)),
            IntegratorKind::Id => Method::Hit(HitColor::Id),
            IntegratorKind::Iterations => Method::Iterations,
        };
        Self { method, neighbours }
    }

    /// Traces a batch of neighbouring camera rays and finds what each sees.
    ///
    /// Rays are handed over all at once, so that kernels may take them in packets; only
    /// `iterations` goes ray by ray, to measure the work of each.
    pub(super) fn see(
        &mut self,
        world: &World,
        tracer: &mut Tracer<'_>,
        batch: &mut Batch,
    ) -> Counters {
        batch.radiance.clear();
        batch.doubtful.clear();
        batch.doubtful.resize(batch.rays.len(), false);
        let Neighbours { first_hits, occlusions, .. } = self.neighbours;
        let mut counters = Counters::default();
        match &mut self.method {
            Method::Direct(direct) => {
                tracer.first_hits(&batch.rays, first_hits, &mut batch.answers);
                counters = direct.light(world, (tracer, occlusions), batch);
            }
            Method::Hit(color) => {
                tracer.first_hits(&batch.rays, first_hits, &mut batch.answers);
                let Batch { rays, answers, radiance, .. } = batch;
                let seen = rays.iter().zip(answers.iter());
                radiance.extend(seen.map(|(ray, answer)| match &answer.hit {
                    Some(hit) => color.of(world, ray, hit),
                    None => [0.0; 3],
                }));
            }
            Method::Iterations => work::trace(tracer, batch),
        }
        for (doubtful, answer) in batch.doubtful.iter_mut().zip(&batch.answers) {
            *doubtful |= answer.doubtful;
        }
        counters += count(&batch.answers);
        counters
    }
}

fn count(answers: &[Answer]) -> Counters {
    Counters {
        rays: answers.len() as u64,
        hits: answers.iter().filter(|answer| answer.hit.is_some()).count() as u64,
        doubtful: answers.iter().filter(|answer| answer.doubtful).count() as u64,
        ..Counters::default()
    }
}
