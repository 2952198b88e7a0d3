//! Errors of many pixels in three numbers.

/// How many pixels of a thousand have an error no larger than [`Errors::most`].
const MOST: usize = 999;

/// The distribution of an error that is never negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Errors {
    /// The mean.
    pub(super) mean: f64,
    /// The 99.9th percentile: the smallest error that is not exceeded by 999 of 1000.
    pub(super) most: f64,
    /// The largest.
    pub(super) largest: f64,
}

impl Errors {
    /// Summarises errors, leaving out NaN. Returns `None` if none is left.
    pub(super) fn of(errors: impl IntoIterator<Item = f64>) -> Option<Self> {
        let mut sorted: Vec<f64> = errors.into_iter().filter(|error| !error.is_nan()).collect();
        sorted.sort_by(f64::total_cmp);
        let &largest = sorted.last()?;
        let rank = (sorted.len() * MOST).div_ceil(1000); // counted from 1
        let mean = sorted.iter().sum::<f64>() / sorted.len() as f64;
        Some(Self { mean, most: sorted[rank - 1], largest })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranks_are_those_of_the_sorted_errors() {
        let thousand = Errors::of((1..=1000).rev().map(f64::from)).unwrap();
        assert_eq!(thousand, Errors { mean: 500.5, most: 999.0, largest: 1000.0 });
        let few = Errors::of([2.0, f64::NAN, 0.0]).unwrap();
        assert_eq!(few, Errors { mean: 1.0, most: 2.0, largest: 2.0 });
        assert_eq!(Errors::of([f64::NAN]), None);
    }
}
