//! What a competitor found, and where two of them disagree.

/// The outcome of one ray.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Outcome {
    /// The distance of the first hit, in scene units; any number if only the existence of a hit
    /// was asked for.
    pub(crate) distance: Option<f64>,
    /// The cosine between ray and normal at the hit; 1 where there is no normal.
    pub(crate) incidence: f64,
    /// Whether the competitor flags its answer.
    pub(crate) doubtful: bool,
}

/// The numbers of rays about which two competitors disagree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Disagreements {
    /// One has a hit, the other has not.
    pub(crate) hit: usize,
    /// The second's hit is farther from the tangent plane of the first's than the tolerance.
    pub(crate) distance: usize,
}

/// The number of hits.
pub(crate) fn hits(outcomes: &[Outcome]) -> usize {
    outcomes.iter().filter(|outcome| outcome.distance.is_some()).count()
}

/// The number of flagged answers.
pub(crate) fn doubtful(outcomes: &[Outcome]) -> usize {
    outcomes.iter().filter(|outcome| outcome.doubtful).count()
}

/// Compares the outcomes of the same rays; `tolerance` in scene units.
pub(crate) fn compare(ours: &[Outcome], theirs: &[Outcome], tolerance: f64) -> Disagreements {
    let mut found = Disagreements::default();
    for (a, b) in ours.iter().zip(theirs) {
        match (a.distance, b.distance) {
            (Some(first), Some(second)) => {
                let apart = (first - second).abs() * a.incidence;
                found.distance += usize::from(apart > tolerance);
            }
            (None, None) => {}
            _ => found.hit += 1,
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn disagreements_are_told_apart() {
        let outcomes = |distances: [Option<f64>; 5]| {
            let doubtful = |distance| distance == Some(2.0);
            distances.map(|d| Outcome { distance: d, incidence: 0.5, doubtful: doubtful(d) })
        };
        let ours = outcomes([Some(1.0), Some(2.0), None, None, Some(3.0)]);
        let theirs = outcomes([Some(1.15), Some(2.3), None, Some(1.0), None]);
        assert_eq!(compare(&ours, &theirs, 0.1), Disagreements { hit: 2, distance: 1 });
        assert_eq!((hits(&ours), doubtful(&ours)), (3, 1));
    }
}
