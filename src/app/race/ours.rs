//! Our side of a race.

use std::hint::black_box;
use std::sync::{Mutex, PoisonError};

use nurbray::intersect::{Answer, Coherence, Kernel, Occlusion, Query, SurfaceBvh, Tracer};
use nurbray::math::Ray;
use rayon::prelude::*;

use super::outcome::Outcome;
use super::ray_set::{Calls, Question};
use super::rays::{CHUNK, Rays};

/// One kernel on one set of rays.
#[derive(Debug)]
pub(crate) struct Ours<'a> {
    bvh: &'a SurfaceBvh,
    pub(crate) kernel: Kernel,
    rays: &'a Rays,
    /// Desks that no thread uses. They stay from pass to pass, as the rival's packets do.
    desks: Mutex<Vec<Desk<'a>>>,
}

/// A thread's tracer and buffers: reused for every chunk, as a renderer does for every tile.
#[derive(Debug)]
struct Desk<'a> {
    tracer: Tracer<'a>,
    answers: Vec<Answer>,
    occlusions: Vec<Occlusion>,
}

impl<'a> Ours<'a> {
    pub(crate) fn new(bvh: &'a SurfaceBvh, kernel: Kernel, rays: &'a Rays) -> Self {
        Self { bvh, kernel, rays, desks: Mutex::default() }
    }

    /// Traces all rays once, on the threads of the current pool, and drops the answers.
    pub(crate) fn pass(&self) {
        self.chunks().for_each(|chunk| {
            self.at_desk(|desk| match self.rays.set.calls() {
                Calls::OneByOne => self.ask(desk, chunk),
                Calls::Batch(_) => {
                    self.trace(desk, chunk);
                    black_box((&desk.answers, &desk.occlusions));
                }
            });
        });
    }

    /// Traces rays one by one and drops each answer as it comes: a caller that wants them together
    /// asks for a batch.
    fn ask(&self, Desk { tracer, .. }: &mut Desk<'_>, (queries, alone): (&[Query], &[Ray])) {
        match self.rays.set.question() {
            Question::FirstHit => alone.iter().for_each(|ray| {
                black_box(&tracer.first_hit(ray));
            }),
            Question::AnyHit => queries.iter().for_each(|query| {
                let _ = black_box(tracer.occluded(query));
            }),
        }
    }

    /// Traces all rays once and returns their outcomes.
    pub(crate) fn outcomes(&self) -> Vec<Outcome> {
        let chunks = self.chunks().map(|chunk| {
            self.at_desk(|desk| {
                self.trace(desk, chunk);
                self.noted(desk, chunk.0)
            })
        });
        chunks.collect::<Vec<_>>().concat()
    }

    /// Does `work` at an unused desk, or at a new one.
    fn at_desk<T>(&self, work: impl FnOnce(&mut Desk<'a>) -> T) -> T {
        let free = || self.desks.lock().unwrap_or_else(PoisonError::into_inner);
        let unused = free().pop();
        let mut desk = unused.unwrap_or_else(|| Desk {
            tracer: self.bvh.tracer_with(self.kernel),
            answers: Vec::new(),
            occlusions: Vec::new(),
        });
        let done = work(&mut desk);
        free().push(desk);
        done
    }

    /// The queries, and the rays alone, chunk by chunk.
    fn chunks(&self) -> impl IndexedParallelIterator<Item = (&'a [Query], &'a [Ray])> {
        let rays = self.rays;
        let chunks = rays.queries.par_chunks(CHUNK).zip(rays.alone.par_chunks(CHUNK));
        chunks.with_max_len(1)
    }

    fn trace(&self, desk: &mut Desk<'_>, (queries, alone): (&[Query], &[Ray])) {
        let Desk { tracer, answers, occlusions } = desk;
        match (self.rays.set.question(), self.rays.set.calls()) {
            (Question::FirstHit, Calls::Batch(told)) => {
                let coherence = match told {
                    Coherence::Coherent => self.rays.neighbours.first_hits,
                    Coherence::Incoherent => Coherence::Incoherent,
                };
                tracer.first_hits(alone, coherence, answers);
            }
            (Question::AnyHit, Calls::Batch(told)) => {
                // All of these rays leave hits of neighbouring pixels.
                let coherence = match told {
                    Coherence::Coherent => self.rays.neighbours.occlusions,
                    Coherence::Incoherent => self.rays.neighbours.scattered,
                };
                tracer.occlusions(queries, coherence, occlusions);
            }
            (Question::FirstHit, Calls::OneByOne) => {
                answers.clear();
                answers.extend(alone.iter().map(|ray| tracer.first_hit(ray)));
            }
            (Question::AnyHit, Calls::OneByOne) => {
                occlusions.clear();
                occlusions.extend(queries.iter().map(|query| tracer.occluded(query)));
            }
        }
    }

    fn noted(&self, desk: &Desk<'_>, queries: &[Query]) -> Vec<Outcome> {
        match self.rays.set.question() {
            Question::FirstHit => {
                let both = desk.answers.iter().zip(queries);
                both.map(|(answer, query)| first_hit(answer, query)).collect()
            }
            Question::AnyHit => desk.occlusions.iter().map(any_hit).collect(),
        }
    }
}

fn first_hit(answer: &Answer, query: &Query) -> Outcome {
    let direction = query.ray().direction();
    let Some(hit) = answer.hit else {
        return Outcome { distance: None, incidence: 1.0, doubtful: answer.doubtful };
    };
    let cosine = (hit.normal.dot(direction) / direction.length()).abs();
    Outcome {
        distance: Some(hit.t * direction.length()),
        incidence: if cosine.is_nan() { 1.0 } else { cosine },
        doubtful: answer.doubtful,
    }
}

fn any_hit(occlusion: &Occlusion) -> Outcome {
    let distance = occlusion.occluded.then_some(0.0);
    Outcome { distance, incidence: 1.0, doubtful: occlusion.doubtful }
}
