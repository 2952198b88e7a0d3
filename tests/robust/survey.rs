//! Many rays of every class, asked and judged; one line of numbers a class.

use nurbray::intersect::{HitFlags, Query};
use nurbray::math::Ray;
use rayon::prelude::*;

use crate::judge::{Answers, Judge};
use crate::model::Model;
use crate::random::Random;
use crate::rays::{Class, Rays};

/// What was found of the rays of one class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) rays: u64,
    pub(crate) hits: u64,
    /// Rays with a doubtful first hit, and with doubtful hits at all.
    pub(crate) doubtful: u64,
    pub(crate) all_doubtful: u64,
    pub(crate) inside: u64,
    /// The largest residual of a certain hit, as a part of the promise.
    pub(crate) residual: f64,
    pub(crate) exact_boxes: u64,
    pub(crate) seconds: f64,
    pub(crate) fault_count: u64,
    /// The first few faults.
    pub(crate) faults: Vec<String>,
}

/// As many faults as one wants to read of one class.
const FAULTS_SHOWN: usize = 5;

impl Tally {
    pub(crate) fn add(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.doubtful += other.doubtful;
        self.all_doubtful += other.all_doubtful;
        self.inside += other.inside;
        self.residual = self.residual.max(other.residual);
        self.exact_boxes += other.exact_boxes;
        self.seconds += other.seconds;
        self.fault_count += other.fault_count;
        self.faults.extend(other.faults);
        self.faults.truncate(FAULTS_SHOWN);
    }

    pub(crate) fn print(&self, name: &str) {
        let share = |count: u64| count as f64 / self.rays.max(1) as f64;
        println!(
            "{name:28} rays {:7} hit {:.2} doubtful {:.4} all {:.4} inside {:.4} residual {:.2} \
             boxes {:6.1} µs {:6.1} faults {}",
            self.rays,
            share(self.hits),
            share(self.doubtful),
            share(self.all_doubtful),
            share(self.inside),
            self.residual,
            share(self.exact_boxes),
            self.seconds * 1e6 / self.rays.max(1) as f64,
            self.fault_count
        );
        for fault in &self.faults {
            println!("    {fault}");
        }
    }
}

/// Rays are asked in blocks of this many, each with a tracer and random numbers of its own.
const BLOCK: u64 = 250;

/// Asks `count` rays of a class of a model.
pub(crate) fn survey(model: &Model, class: Class, count: u64, seed: u64) -> Tally {
    let bvh = model.bvh();
    let judge = Judge::new(model);
    let rays = Rays::new(model);
    let blocks: Vec<Tally> = (0..count.div_ceil(BLOCK))
        .into_par_iter()
        .map(|block| {
            let started = std::time::Instant::now();
            let mut random = Random::new(seed ^ (block << 32));
            let mut tracer = bvh.tracer();
            let mut tally = Tally::default();
            for _ in 0..BLOCK.min(count - block * BLOCK) {
                let shot = rays.shot(class, &mut random);
                let answers = Answers::ask(&mut tracer, &Query::primary(shot.ray));
                tally.note(&judge, &shot.ray, &answers);
                let mut faults = judge.faults(&shot, &answers);
                if model.closed {
                    let line = whole_line(&shot.ray);
                    let mut hits = Vec::new();
                    if !tracer.all_hits(&Query::primary(line), &mut hits) {
                        faults.extend(judge.parity_broken(&hits, &line));
                    }
                }
                tally.fault_count += u64::from(!faults.is_empty());
                let told = |fault| format!("{} {class}: {fault}\n      {:?}", model.name, shot.ray);
                tally.faults.extend(faults.into_iter().map(told));
                tally.faults.truncate(FAULTS_SHOWN);
            }
            tally.exact_boxes = tracer.statistics().exact_boxes;
            tally.seconds = started.elapsed().as_secs_f64();
            tally
        })
        .collect();
    let mut sum = Tally::default();
    blocks.into_iter().for_each(|tally| sum.add(tally));
    sum
}

impl Tally {
    fn note(&mut self, judge: &Judge<'_>, ray: &Ray, answers: &Answers) {
        self.rays += 1;
        self.hits += u64::from(answers.first.hit.is_some());
        self.doubtful += u64::from(answers.first.doubtful);
        self.all_doubtful += u64::from(answers.all_doubtful);
        let inside = answers.all.iter().any(|hit| hit.flags.contains(HitFlags::INSIDE));
        self.inside += u64::from(inside);
        let certain = |flags: HitFlags| !flags.contains(HitFlags::DOUBTFUL);
        for hit in answers.first.hit.iter().filter(|hit| certain(hit.flags)) {
            let off = hit.point.distance(ray.at(hit.t)) / judge.measure(ray, hit).promise;
            self.residual = self.residual.max(off);
        }
    }
}

fn whole_line(ray: &Ray) -> Ray {
    let (from, to) = (f64::NEG_INFINITY, f64::INFINITY);
    Ray::with_range(ray.origin(), ray.direction(), from, to).unwrap()
}
