//! Counts of the work of tracing.

use std::ops::AddAssign;

/// Counts of the work done by a [`Tracer`](super::Tracer).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[non_exhaustive]
pub struct Statistics {
    /// Rays asked about.
    pub rays: u64,
    /// Nodes of the hierarchy visited.
    pub nodes: u64,
    /// Leaves tested against a ray after their boxes were met.
    pub leaf_tests: u64,
    /// Newton's steps taken in f64, on the true surfaces; those of the search in f32 do not count.
    pub newton_iterations: u64,
    /// Calls of the exact solver.
    pub exact_calls: u64,
    /// Parameter boxes the exact solver looked at.
    pub exact_boxes: u64,
    /// Answers flagged doubtful.
    pub doubtful: u64,
}

impl Statistics {
    /// Takes one ray out of the count: another search will count it.
    pub(super) fn uncount(&mut self) {
        self.rays -= 1;
    }

    /// Counts an answer if it is flagged doubtful.
    pub(super) fn count_doubt(&mut self, doubtful: bool) {
        self.doubtful += u64::from(doubtful);
    }
}

impl AddAssign for Statistics {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.nodes += other.nodes;
        self.leaf_tests += other.leaf_tests;
        self.newton_iterations += other.newton_iterations;
        self.exact_calls += other.exact_calls;
        self.exact_boxes += other.exact_boxes;
        self.doubtful += other.doubtful;
    }
}
