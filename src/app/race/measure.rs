//! One set of rays, all competitors.

use nurbray::intersect::Kernel;

use super::clock::{Pass, Speed, race};
use super::model::Model;
use super::ours::Ours;
use super::outcome::{self, Disagreements};
use super::ray_set::RaySet;
use super::rays::Rays;
use super::rival::Rival;
use super::steps::{Preparation, Steps};

/// How fast each competitor traced one set of rays, and what it found.
#[derive(Clone, Debug)]
pub(crate) struct Measurement {
    pub(crate) set: RaySet,
    /// The number of rays.
    pub(crate) count: usize,
    pub(crate) kernels: Vec<KernelResult>,
    /// One for each tolerance.
    pub(crate) rivals: Vec<RivalResult>,
}

/// One of our kernels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct KernelResult {
    pub(crate) kernel: Kernel,
    pub(crate) speed: Speed,
    pub(crate) hits: usize,
    pub(crate) doubtful: usize,
}

/// The rival at one tolerance.
#[derive(Clone, Debug)]
pub(crate) struct RivalResult {
    pub(crate) tolerance: f64,
    /// Rays a packet.
    pub(crate) width: u32,
    /// Where its rays begin, in scene units.
    pub(crate) offset: f64,
    pub(crate) speed: Speed,
    pub(crate) hits: usize,
    /// Disagreements with each of our kernels, in their order.
    pub(crate) disagreements: Vec<Disagreements>,
}

impl Measurement {
    /// Traces the rays on the threads of the current pool: each competitor once to compare the
    /// answers and to warm up, then each for about `seconds`.
    pub(crate) fn new(
        model: &Model,
        kernels: &[Kernel],
        rivals: &[Rival],
        rays: &Rays,
        seconds: f64,
    ) -> Self {
        let ours: Vec<_> =
            kernels.iter().map(|&kernel| Ours::new(model.world.bvh(), kernel, rays)).collect();
        let mut entries: Vec<_> = rivals.iter().map(|rival| rival.enter(rays)).collect();

        let found: Vec<_> = ours.iter().map(Ours::outcomes).collect();
        let mut rival_results = Vec::new();
        for (rival, entry) in rivals.iter().zip(&entries) {
            let theirs = entry.outcomes();
            let against = found.iter().map(|ours| outcome::compare(ours, &theirs, rival.distance));
            rival_results.push(RivalResult {
                tolerance: rival.tolerance,
                width: entry.width(),
                offset: entry.offset,
                speed: Speed::default(),
                hits: outcome::hits(&theirs),
                disagreements: against.collect(),
            });
        }

        let mut passes: Vec<Pass<'_>> = Vec::new();
        passes.extend(ours.iter().map(|ours| Box::new(|| ours.pass()) as Pass<'_>));
        passes.extend(entries.iter_mut().map(|entry| Box::new(|| entry.pass()) as Pass<'_>));
        let speeds = race(&mut passes, rays.len(), seconds);
        let (our_speeds, rival_speeds) = speeds.split_at(ours.len());
        for (result, &speed) in rival_results.iter_mut().zip(rival_speeds) {
            result.speed = speed;
        }
        let results = ours.iter().zip(&found).zip(our_speeds);
        let results = results.map(|((ours, found), &speed)| KernelResult {
            kernel: ours.kernel,
            speed,
            hits: outcome::hits(found),
            doubtful: outcome::doubtful(found),
        });
        let kernels = results.collect();
        Self { set: rays.set, count: rays.len(), kernels, rivals: rival_results }
    }

    /// The fastest kernel; `None` if none was asked for.
    pub(crate) fn fastest(&self) -> Option<&KernelResult> {
        let rate = |result: &&KernelResult| result.speed.mrays_per_s;
        self.kernels.iter().max_by(|a, b| rate(a).total_cmp(&rate(b)))
    }

    /// The default kernel; if it was not measured, the fastest.
    pub(crate) fn usual(&self) -> Option<&KernelResult> {
        let usual = self.kernels.iter().find(|result| result.kernel == Kernel::default());
        usual.or_else(|| self.fastest())
    }

    /// The steps from the file to our last ray.
    pub(crate) fn our_steps(&self, model: &Model, ours: &KernelResult) -> Steps {
        model.preparation.then_trace(self.tracing_seconds(ours.speed))
    }

    /// The same steps of a rival, which has the same file to read.
    pub(crate) fn rival_steps(&self, model: &Model, rival: &Rival, result: &RivalResult) -> Steps {
        let preparation = Preparation { build: rival.build_seconds, ..model.preparation };
        preparation.then_trace(self.tracing_seconds(result.speed))
    }

    fn tracing_seconds(&self, speed: Speed) -> f64 {
        1e-6 * self.count as f64 / speed.mrays_per_s
    }
}
