//! The counts and errors of one class of rays.

use std::collections::BTreeMap;

use nurbray::math::Ray;

use super::judge::{Fault, Finding};

/// A number of rays, and how many of them are doubtful.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct DoubtCount {
    pub(crate) rays: u64,
    pub(crate) doubtful: u64,
}

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
    /// Hits of the fast path where there is none.
    pub(crate) false_hits: u64,
    /// Rays whose first hit the fast path flags as doubtful.
    pub(crate) doubtful: u64,
    /// Rays whose occlusion answer the fast path flags as doubtful.
    pub(crate) doubtful_any: u64,
    /// Rays that are exactly tangent, and how many of them are doubtful.
    pub(crate) tangent: DoubtCount,
    /// Rays for which the exact solver could not decide everything.
    pub(crate) undecided: u64,
    /// The error of each hit of an answer without doubt, over the largest coordinate
    /// magnitude.
    errors: Errors,
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
        self.doubtful_any += u64::from(finding.doubtful_any);
        self.tangent.rays += u64::from(finding.tangent);
        self.tangent.doubtful += u64::from(finding.tangent && finding.doubtful);
        if finding.doubtful {
            self.doubtful_error = larger(self.doubtful_error, finding.error);
        } else {
            finding.error.into_iter().for_each(|error| self.errors.add(error));
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
        self.doubtful_any += other.doubtful_any;
        self.tangent.rays += other.tangent.rays;
        self.tangent.doubtful += other.tangent.doubtful;
        self.undecided += other.undecided;
        self.errors.merge(other.errors);
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

    /// Returns the error that this share of the hits without doubt does not exceed. `share` = 1
    /// gives the largest error; others are up to 1/256 too large. `None` without such hits. NaN
    /// counts as larger than any error.
    pub(crate) fn error_quantile(&self, share: f64) -> Option<f64> {
        self.errors.quantile(share)
    }
}

/// A histogram of errors. Sizes are told apart by 8 bits of mantissa: a few thousand sizes for
/// rounding errors, however many rays there are.
#[derive(Clone, Debug, Default)]
struct Errors {
    /// Counts by the bits of the largest error of each size: the bits of positive numbers are in
    /// the order of the numbers, and NaN comes last.
    counts: BTreeMap<u64, u64>,
    largest: Option<f64>,
}

impl Errors {
    /// The bits of an error that the histogram ignores.
    const FINER: u64 = (1 << (f64::MANTISSA_DIGITS - 1 - 8)) - 1;

    fn add(&mut self, error: f64) {
        let bits = error.abs().to_bits();
        let size = if bits == 0 { 0 } else { bits | Self::FINER };
        *self.counts.entry(size).or_default() += 1;
        self.largest = larger(self.largest, Some(error));
    }

    fn merge(&mut self, other: Self) {
        for (size, count) in other.counts {
            *self.counts.entry(size).or_default() += count;
        }
        self.largest = larger(self.largest, other.largest);
    }

    fn quantile(&self, share: f64) -> Option<f64> {
        let largest = self.largest?;
        let all: u64 = self.counts.values().sum();
        let rank = (share * all as f64).ceil() as u64;
        let mut below = 0;
        let size = self.counts.iter().find(|(_, count)| {
            below += **count;
            below >= rank
        });
        let quantile = size.map_or(largest, |(size, _)| f64::from_bits(*size));
        [quantile, largest].into_iter().min_by(f64::total_cmp)
    }
}

/// The larger of two errors; NaN is larger than any.
fn larger(a: Option<f64>, b: Option<f64>) -> Option<f64> {
    a.into_iter().chain(b).max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    const NOTHING: Finding =
        Finding { fault: None, error: None, doubtful: false, doubtful_any: false, tangent: false };

    fn tally(errors: &[f64]) -> Tally {
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut tally = Tally::default();
        for &error in errors {
            tally.add(&ray, Finding { error: Some(error), ..NOTHING });
        }
        tally
    }

    #[test]
    fn quantiles_are_a_little_more_than_errors_that_occurred() {
        let hundred = tally(&(1..=100).rev().map(f64::from).collect::<Vec<_>>());
        for (share, error) in [(0.001, 1.0), (0.5, 50.0), (0.99, 99.0)] {
            let quantile = hundred.error_quantile(share).unwrap();
            assert!((error..=error * (1.0 + 1.0 / 256.0)).contains(&quantile), "{quantile}");
        }
        assert_eq!(hundred.error_quantile(1.0), Some(100.0));
        assert_eq!(tally(&[3.0]).error_quantile(0.5), Some(3.0));
        assert_eq!(tally(&[0.0, 0.0, 3.0]).error_quantile(0.5), Some(0.0));
        assert_eq!(tally(&[]).error_quantile(1.0), None);
        assert!(tally(&[1.0, f64::NAN, 2.0]).error_quantile(1.0).unwrap().is_nan());
    }

    #[test]
    fn what_is_kept_of_errors_does_not_grow_with_their_number() {
        let mut all = Tally::default();
        for k in 0..20 {
            let few: Vec<f64> = (0..1000).map(|i| 1e-17 * f64::from(1000 * k + i)).collect();
            all.merge(tally(&few));
        }
        assert_eq!(all.errors.counts.values().sum::<u64>(), 20_000);
        assert!(all.errors.counts.len() < 16 * 256, "{}", all.errors.counts.len());
        let median = all.error_quantile(0.5).unwrap();
        assert!((1e-13..1.004e-13).contains(&median), "{median:e}");
    }

    #[test]
    fn errors_of_doubtful_hits_are_kept_apart() {
        let ray = Ray::new(DVec3::ZERO, DVec3::X).unwrap();
        let mut all = tally(&[1.0]);
        for error in [Some(3.0), None, Some(7.0), Some(5.0)] {
            let mut one = Tally::default();
            let doubtful_any = error.is_none();
            one.add(
                &ray,
                Finding { error, doubtful: true, doubtful_any, tangent: true, ..NOTHING },
            );
            all.merge(one);
        }
        assert_eq!(
            (all.rays, all.hits, all.doubtful, all.tangent),
            (5, 4, 4, DoubtCount { rays: 4, doubtful: 4 })
        );
        assert_eq!(all.doubtful_any, 1);
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
