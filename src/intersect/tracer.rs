//! Questions to surfaces: first hit, any hit, all hits.

use std::fmt;
use std::str::FromStr;

use super::{Answer, Coherence, Hit, Occlusion, Query, Statistics, SurfaceBvh};

/// Which code searches for hits. All give the same answers, to the stated accuracy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kernel {
    /// The readable specification: one ray at a time in f64.
    #[default]
    Scalar,
}

impl Kernel {
    /// Every kernel, in the order to list them.
    pub const ALL: &'static [Self] = &[Self::Scalar];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
        }
    }
}

impl fmt::Display for Kernel {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Kernel {
    type Err = ();

    fn from_str(name: &str) -> Result<Self, ()> {
        Self::ALL.iter().copied().find(|kernel| kernel.name() == name).ok_or(())
    }
}

/// Answers questions on one thread: holds the scratch memory and the counts.
#[derive(Debug)]
pub struct Tracer<'a> {
    bvh: &'a SurfaceBvh,
    kernel: Kernel,
    statistics: Statistics,
}

impl<'a> Tracer<'a> {
    pub(super) fn new(bvh: &'a SurfaceBvh, kernel: Kernel) -> Self {
        Self { bvh, kernel, statistics: Statistics::default() }
    }

    /// The first hit of a ray: the one with the smallest `t` in its range.
    pub fn first_hit(&mut self, _query: &Query) -> Answer {
        let _ = (self.bvh, self.kernel);
        Answer::default()
    }

    /// Whether anything lies on a ray within its range.
    pub fn occluded(&mut self, _query: &Query) -> Occlusion {
        Occlusion::default()
    }

    /// All hits of a ray, appended to `hits` by increasing `t`; returns whether the
    /// answer is doubtful.
    pub fn all_hits(&mut self, _query: &Query, _hits: &mut Vec<Hit>) -> bool {
        false
    }

    /// First hits of many rays; `answers` is cleared and filled in the same order.
    pub fn first_hits(&mut self, queries: &[Query], _: Coherence, answers: &mut Vec<Answer>) {
        answers.clear();
        answers.extend(queries.iter().map(|query| self.first_hit(query)));
    }

    /// Occlusion of many rays; `answers` is cleared and filled in the same order.
    pub fn occlusions(&mut self, queries: &[Query], _: Coherence, answers: &mut Vec<Occlusion>) {
        answers.clear();
        answers.extend(queries.iter().map(|query| self.occluded(query)));
    }

    /// What the work cost so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }
}
