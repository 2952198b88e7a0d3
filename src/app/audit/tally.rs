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
    /// Rays that are exactly tangent, and how many of them are doubtful.
    pub(crate) tangent: [u64; 2],
    /// Rays for which the exact solver could not decide everything.
    pub(crate) undecided: u64,
    /// The error of each hit of an answer without doubt, over the largest coordinate
    /// magnitude; in no order.
    errors: Vec<f64>,
    /// The largest error of a hit of a doubtful answer.
    doubtful_error: Option<f64>,
    /// The rays at fault.
    offenders: Vec<Ray>,
}

impl Tally {
    /// Counts one ray.
    pub(crate) fn add(&mut self, ray: &Ray, finding: Finding) {
        self.rays += 1;
        self.hits += u64::from(finding.error.is_some());
        self.doubtful += u64::from(finding.doubtful);
        self.tangent[0] += u64::from(finding.tangent);
        self.tangent[1] += u64::from(finding.tangent && finding.doubtful);
        if finding.doubtful {
            self.doubtful_error = larger(self.doubtful_error, finding.error);
        } else {
            self.errors.extend(finding.error);
        }
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
        self.tangent = [0, 1].map(|k| self.tangent[k] + other.tangent[k]);
        self.undecided += other.undecided;
        self.errors.extend(other.errors);
        self.doubtful_error = larger(self.doubtful_error, other.doubtful_error);
        self.offenders.extend(other.offenders);
    }

    /// The rays at fault, in the order they were made.
    pub(crate) fn offenders(&self) -> &[Ray] {
        &self.offenders
    }

    /// The largest error of a hit of a doubtful answer, if there is one.
    pub(crate) fn doubtful_error(&self) -> Option<f64> {
        self.doubtful_error
    }

    /// The error that this share of the hits without doubt does not exceed: `share` = 1 is
    /// the largest. `None` without such hits. An error that is not a number counts as larger than any.
    pub(crate) fn error_quantile(&mut self, share: f64) -> Option<f64> {
        let last = self.errors.len().checked_sub(1)?;
        let rank = (share * self.errors.len() as f64).ceil() as usize;
        let rank = rank.saturating_sub(1).min(last);
        Some(*self.errors.select_nth_unstable_by(rank, f64::total_cmp).1)
    }
}

/// The larger of two errors; one that is not a number is larger than any.
fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const NOTHING: Finding = Finding { fault: None, error: None, doubtful: false, tangent: false };

    fn tally(errors: &[f64]) -> Tally {
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut tally = Tally::default();
        for &error in errors {
            tally.add(&ray, Finding { error: Some(error), ..NOTHING });
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
    fn errors_of_doubtful_hits_are_kept_apart() {
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut all = tally(&[1.0]);
        for error in [Some(3.0), None, Some(7.0), Some(5.0)] {
            let mut one = Tally::default();
            one.add(&ray, Finding { error, doubtful: true, tangent: true, ..NOTHING });
            all.merge(one);
        }
        assert_eq!((all.rays, all.hits, all.doubtful, all.tangent), (5, 4, 4, [4, 4]));
        assert_eq!((all.error_quantile(1.0), all.doubtful_error()), (Some(1.0), Some(7.0)));
    }

    #[test]
    fn faults_are_counted_by_kind_and_their_rays_kept() {
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut all = Tally::default();
        for fault in [Fault::Miss, Fault::WrongRoot, Fault::WrongRoot, Fault::FalseHit] {
            let mut one = Tally::default();
            one.add(&ray, Finding { fault: Some(fault), ..NOTHING });
            all.merge(one);
        }
        assert_eq!((all.misses, all.wrong_roots, all.false_hits), (1, 2, 1));
        assert_eq!((all.rays, all.hits, all.offenders().len()), (4, 0, 4));
    }
}
