//! What the search of a ray has found so far.

use crate::intersect::exact::{ExactSolver, Found, Problem};
use crate::intersect::roots::accept::Dropped;
use crate::intersect::roots::meeting::Meeting;
use crate::intersect::{Occlusion, Statistics};

/// What a search found, and its scratch memory.
#[derive(Debug)]
pub(crate) struct Findings {
    pub meetings: Vec<Meeting>,
    /// The smallest ray parameter at which something may have been missed.
    pub doubt: f64,
    pub statistics: Statistics,
    /// Boxes the exact solver has looked at for this ray, weighted by cost; to be set to zero for
    /// the next ray.
    pub(super) effort: u64,
    solver: ExactSolver,
    pub(super) found: Vec<Found>,
}

impl Default for Findings {
    /// Nothing, without doubt.
    fn default() -> Self {
        Self {
            meetings: Vec::new(),
            doubt: f64::INFINITY,
            statistics: Statistics::default(),
            effort: 0,
            solver: ExactSolver::default(),
            found: Vec::new(),
        }
    }
}

impl Findings {
    /// Solves a problem, and counts the effort. What is found should be put back when it is no longer
    /// needed: its memory is used again.
    pub(super) fn solve(&mut self, problem: &Problem<'_>, cost_of_box: u64) -> Vec<Found> {
        let mut found = std::mem::take(&mut self.found);
        found.clear();
        let before = self.solver.boxes;
        self.solver.solve(problem, &mut found);
        let boxes = self.solver.boxes - before;
        self.effort += boxes * cost_of_box;
        self.statistics.exact_calls += 1;
        self.statistics.exact_boxes += boxes;
        found
    }

    /// Forgets what was found, but keeps memory and statistics.
    pub(crate) fn clear(&mut self) {
        self.meetings.clear();
        self.doubt = f64::INFINITY;
        self.effort = 0;
    }

    /// The answer of an any-hit search that found this.
    pub(crate) fn occlusion(&mut self) -> Occlusion {
        let occlusion = occlusion(self.meetings.iter(), self.doubt);
        self.statistics.count_doubt(occlusion.doubtful);
        occlusion
    }

    /// Adds a meeting, or a doubt.
    pub(super) fn add(&mut self, accepted: Result<Meeting, Dropped>) {
        match accepted {
            Ok(meeting) => self.meetings.push(meeting),
            Err(Dropped::InDoubt(t)) => self.doubt_at(t),
            Err(Dropped::Surely) => {}
        }
    }

    /// Something may be met from this ray parameter on.
    pub(super) fn doubt_at(&mut self, t: f64) {
        self.doubt = self.doubt.min(t);
    }
}

/// The answer of an any-hit search that found these meetings; `doubt` is the smallest ray parameter
/// at which something may have been missed.
pub(crate) fn occlusion<'m>(meetings: impl Iterator<Item = &'m Meeting>, doubt: f64) -> Occlusion {
    let (mut occluded, mut certain) = (false, false);
    for meeting in meetings {
        occluded = true;
        certain |= meeting.is_certain();
    }
    let doubtful = !certain && (occluded || doubt < f64::INFINITY);
    Occlusion { occluded, doubtful }
}
