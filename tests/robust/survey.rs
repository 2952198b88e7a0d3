//! Many rays of every class, asked and judged; one line of numbers a class.

use nurbray::intersect::{Answer, Coherence, HitFlags, Occlusion, Query, SurfaceBvh, Tracer};
use nurbray::math::Ray;
use rayon::prelude::*;

use crate::judge::{Answers, Judge};
use crate::model::Model;
use crate::random::Random;
use crate::rays::{Class, Rays, Shot};

/// How many rays of a class, and how many of them are asked everything.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Plan {
    /// All of them are asked for the first hit.
    pub(crate) rays: u64,
    /// One in this many is also asked of the exact solver, for all hits, and for occlusion.
    pub(crate) thorough: u64,
}

/// Counts over the rays of one class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    /// Rays with a doubtful first hit.
    pub(crate) doubtful: u64,
    /// Rays asked everything, and how many of them are doubtful in all hits, or inside a surface.
    pub(crate) thorough: u64,
    pub(crate) all_doubtful: u64,
    pub(crate) inside: u64,
    /// The largest residual of a certain first hit, as a part of the promise.
    pub(crate) residual: f64,
    pub(crate) fault_count: u64,
    /// The first few faults.
    pub(crate) faults: Vec<String>,
}

/// The most faults shown of one class.
const FAULTS_SHOWN: usize = 5;

impl Tally {
    pub(crate) fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.doubtful += other.doubtful;
        self.thorough += other.thorough;
        self.all_doubtful += other.all_doubtful;
        self.inside += other.inside;
        self.residual = self.residual.max(other.residual);
        self.fault_count += other.fault_count;
        self.faults.extend(other.faults);
        self.faults.truncate(FAULTS_SHOWN);
    }

    /// The share of first hits that are doubtful.
    pub(crate) fn doubt(&self) -> f64 {
        self.doubtful as f64 / self.rays.max(1) as f64
    }

    pub(crate) fn print(&self, name: &str) {
        let of_all = |count: u64| count as f64 / self.thorough.max(1) as f64;
        println!(
            "{name:14} rays {:6} hit {:.2} doubtful {:.4} | all hits of {:5}: doubtful {:.4} \
             inside {:.4} | residual {:.2} faults {}",
            self.rays,
            self.hits as f64 / self.rays.max(1) as f64,
            self.doubt(),
            self.thorough,
            of_all(self.all_doubtful),
            of_all(self.inside),
            self.residual,
            self.fault_count
        );
    }
}

/// Traces and judges rays of a class at a model.
pub(crate) struct Survey<'a> {
    model: &'a Model,
    bvh: SurfaceBvh,
    judge: Judge<'a>,
    rays: Rays<'a>,
}

impl<'a> Survey<'a> {
    pub(crate) fn new(model: &'a Model) -> Self {
        Self { model, bvh: model.bvh(), judge: Judge::new(model), rays: Rays::new(model) }
    }

    /// Traces as many rays as planned, in blocks with tracers and random numbers of their own.
    pub(crate) fn class(&self, class: Class, plan: Plan, seed: u64) -> Tally {
        let block_size = 250;
        let block = |block: u64| {
            let mut random = Random::new(seed ^ (block << 32));
            let mut tracer = self.bvh.tracer();
            let mut tally = Tally::default();
            let count = block_size.min(plan.rays - block * block_size);
            let shots = (0..count).map(|_| self.rays.shot(class, &mut random)).collect::<Vec<_>>();
            // The rays asked everything are of all three ways, too.
            let way = |k: u64| (k + k / plan.thorough) % 3;
            for (k, seen) in self.look(&shots, way, &mut tracer) {
                let shot = &shots[k as usize];
                let thorough = k % plan.thorough == 0;
                let faults = self.ask(shot, seen, thorough.then_some(&mut tracer), &mut tally);
                tally.fault_count += u64::from(!faults.is_empty());
                let name = &self.model.name;
                let told = |fault| {
                    format!("{name} {class}, way {}: {fault}\n      {:?}", way(k), shot.ray)
                };
                tally.faults.extend(faults.into_iter().map(told));
                tally.faults.truncate(FAULTS_SHOWN);
            }
            tally
        };
        let blocks: Vec<Tally> =
            (0..plan.rays.div_ceil(block_size)).into_par_iter().map(block).collect();
        let mut sum = Tally::default();
        blocks.into_iter().for_each(|tally| sum.add(tally));
        sum
    }

    /// First hits and occlusions of rays, traced one by one, in packets or in batches, as their
    /// `way` says: no answer may depend on it.
    fn look(
        &self,
        shots: &[Shot],
        way: impl Fn(u64) -> u64,
        tracer: &mut Tracer<'_>,
    ) -> Vec<(u64, (Answer, Occlusion))> {
        let mut seen = Vec::new();
        let batches = [None, Some(Coherence::Coherent), Some(Coherence::Incoherent)];
        for (wanted, coherence) in (0..).zip(batches) {
            let indices = (0..shots.len() as u64).filter(|&k| way(k) == wanted).collect::<Vec<_>>();
            let query = |&k: &u64| Query::primary(shots[k as usize].ray);
            let queries = indices.iter().map(query).collect::<Vec<_>>();
            let (mut firsts, mut shadows) = (Vec::new(), Vec::new());
            match coherence {
                None => {
                    firsts.extend(queries.iter().map(|query| tracer.first_hit(query)));
                    shadows.extend(queries.iter().map(|query| tracer.occluded(query)));
                }
                Some(coherence) => {
                    tracer.first_hits(&queries, coherence, &mut firsts);
                    tracer.occlusions(&queries, coherence, &mut shadows);
                }
            }
            seen.extend(indices.into_iter().zip(firsts.into_iter().zip(shadows)));
        }
        seen.sort_unstable_by_key(|&(k, _)| k);
        seen
    }

    /// Returns the faults of the answers given for a ray and, if there is a tracer, of all other
    /// answers for it.
    fn ask(
        &self,
        shot: &Shot,
        (first, occlusion): (Answer, Occlusion),
        thorough: Option<&mut Tracer<'_>>,
        tally: &mut Tally,
    ) -> Vec<String> {
        tally.note(&self.judge, &shot.ray, first);
        let Some(tracer) = thorough else {
            return self.judge.faults_of_first(shot, &first);
        };
        let query = Query::primary(shot.ray);
        let answers = Answers { first, occlusion, ..Answers::ask(tracer, &query) };
        tally.thorough += 1;
        tally.all_doubtful += u64::from(answers.all_doubtful);
        let inside = answers.all.iter().any(|hit| hit.flags.contains(HitFlags::INSIDE));
        tally.inside += u64::from(inside);
        let mut faults = self.judge.faults(shot, &answers);
        if self.model.closed {
            let line = whole_line(&shot.ray);
            let mut hits = Vec::new();
            if !tracer.exact_all_hits(&Query::primary(line), &mut hits) {
                faults.extend(self.judge.parity_broken(&hits, &line));
            }
        }
        faults
    }
}

impl Tally {
    fn note(&mut self, judge: &Judge<'_>, ray: &Ray, first: Answer) {
        self.rays += 1;
        self.hits += u64::from(first.hit.is_some());
        self.doubtful += u64::from(first.doubtful);
        for hit in first.hit.iter().filter(|hit| !hit.flags.contains(HitFlags::DOUBTFUL)) {
            let off = hit.point.distance(ray.at(hit.t)) / judge.measure(ray, hit).promise;
            self.residual = self.residual.max(off);
        }
    }
}

fn whole_line(ray: &Ray) -> Ray {
    let (from, to) = (f64::NEG_INFINITY, f64::INFINITY);
    Ray::with_range(ray.origin(), ray.direction(), from, to).unwrap()
}
