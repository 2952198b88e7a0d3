//! What one class of rays came to.

use nurbray::math::Ray;

use super::judge::{Fault, Finding};

/// Counts over the rays of one class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    /// Rays made.
    pub(crate) rays: u64,
    /// Rays for which the fast path has a hit.
    pub(crate) hits: u64,
    /// Certain hits of the exact solver where the fast path has none.
    pub(crate) misses: u64,
    /// Hits behind a certain hit.
    pub(crate) wrong_roots: u64,
    /// Hits that are none.
    pub(crate) false_hits: u64,
    /// Rays whose answer the fast path flags as doubtful.
    pub(crate) doubtful: u64,
    /// Rays for which the exact solver could not decide everything.
    pub(crate) undecided: u64,
    /// The error of each hit, over the largest coordinate magnitude; in no order.
    errors: Vec<f64>,
    /// The rays at fault.
    offenders: Vec<Ray>,
}

impl Tally {
    /// Counts one ray.
    pub(crate) fn add(&mut self, ray: &Ray, finding: Finding) {
        self.rays += 1;
        self.hits += u64::from(finding.error.is_some());
        self.errors.extend(finding.error);
        match finding.fault {
            None => return,
            Some(Fault::Miss) => self.misses += 1,
            Some(Fault::WrongRoot) => self.wrong_roots += 1,
            Some(Fault::FalseHit) => self.false_hits += 1,
        }
        self.offenders.push(*ray);
    }

    /// Counts the rays of another tally too.
    pub(crate) fn merge(&mut self, other: Self) {
        self.rays += other.rays;
        self.hits += other.hits;
        self.misses += other.misses;
        self.wrong_roots += other.wrong_roots;
        self.false_hits += other.false_hits;
        self.doubtful += other.doubtful;
        self.undecided += other.undecided;
        self.errors.extend(other.errors);
        self.offenders.extend(other.offenders);
    }

    /// The rays at fault, in the order they were made.
    pub(crate) fn offenders(&self) -> &[Ray] {
        &self.offenders
    }

    /// The error that this share of the hits does not exceed: `share` = 1 is the largest.
    /// `None` without hits. An error that is not a number counts as larger than any.
    pub(crate) fn error_quantile(&mut self, share: f64) -> Option<f64> {
        let last = self.errors.len().checked_sub(1)?;
        let rank = (share * self.errors.len() as f64).ceil() as usize;
        let rank = rank.saturating_sub(1).min(last);
        Some(*self.errors.select_nth_unstable_by(rank, f64::total_cmp).1)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    fn tally(errors: &[f64]) -> Tally {
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut tally = Tally::default();
        for &error in errors {
            tally.add(&ray, Finding { fault: None, error: Some(error) });
        }
        tally
    }

    #[test]
    fn quantiles_are_errors_that_occurred() {
        let mut hundred = tally(&(1..=100).rev().map(f64::from).collect::<Vec<_>>());
        assert_eq!(hundred.error_quantile(0.5), Some(50.0));
        assert_eq!(hundred.error_quantile(0.99), Some(99.0));
        assert_eq!(hundred.error_quantile(1.0), Some(100.0));
        assert_eq!(tally(&[3.0]).error_quantile(0.5), Some(3.0));
        assert_eq!(tally(&[]).error_quantile(1.0), None);
        assert!(tally(&[1.0, f64::NAN, 2.0]).error_quantile(1.0).unwrap().is_nan());
    }

    #[test]
    fn faults_are_counted_by_kind_and_their_rays_kept() {
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut all = Tally::default();
        for fault in [Fault::Miss, Fault::WrongRoot, Fault::WrongRoot, Fault::FalseHit] {
            let mut one = Tally::default();
            one.add(&ray, Finding { fault: Some(fault), error: None });
            all.merge(one);
        }
        assert_eq!((all.misses, all.wrong_roots, all.false_hits), (1, 2, 1));
        assert_eq!((all.rays, all.hits, all.offenders().len()), (4, 0, 4));
    }
}
