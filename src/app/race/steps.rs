//! The steps from a file to the last ray, and how long each takes.

use std::time::{Duration, Instant};

use super::super::failure::Failure;

/// The most times a preparation is repeated: an odd number, to have a middle.
const MOST_RUNS: usize = 9;

/// How long one run took to make an input ready, in seconds. The total is the sum of the
/// parts and not measured by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Preparation {
    /// From the file to the surfaces in their places: every competitor needs that.
    pub(crate) read: f64,
    /// From there to what is traced.
    pub(crate) build: f64,
}

impl Preparation {
    /// From the file to ready.
    pub(crate) fn total(self) -> f64 {
        self.read + self.build
    }

    /// All steps, if the rays take `trace` seconds.
    pub(crate) fn then_trace(self, trace: f64) -> Steps {
        Steps { preparation: self, trace }
    }
}

/// How long it takes from the file to the last ray, in seconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Steps {
    /// Until the first ray.
    pub(crate) preparation: Preparation,
    /// From the first ray to the last.
    pub(crate) trace: f64,
}

impl Steps {
    /// From the file to the last ray.
    pub(crate) fn total(self) -> f64 {
        self.preparation.total() + self.trace
    }
}

/// Repeats `work`, at least once and at most [`MOST_RUNS`] times, for as long as `budget`. Returns
/// the last result, and the seconds of the run with the median time.
///
/// # Errors
/// The first error met.
pub(crate) fn repeat<T>(
    budget: Duration,
    mut work: impl FnMut() -> Result<T, Failure>,
) -> Result<(T, f64), Failure> {
    let (result, preparation) = repeat_preparing(budget, || {
        let start = Instant::now();
        let result = work()?;
        Ok((result, Preparation { read: 0.0, build: start.elapsed().as_secs_f64() }))
    })?;
    Ok((result, preparation.build))
}

/// Like [`repeat`], for work that times its parts. Returns the parts of the run with the median
/// total, so that they belong together; of two runs in the middle, those of the longer.
///
/// # Errors
/// The first error met.
pub(super) fn repeat_preparing<T>(
    budget: Duration,
    mut work: impl FnMut() -> Result<(T, Preparation), Failure>,
) -> Result<(T, Preparation), Failure> {
    let begin = Instant::now();
    let mut runs: Vec<Preparation> = Vec::new();
    loop {
        let (result, run) = work()?;
        runs.push(run);
        if runs.len() >= MOST_RUNS || begin.elapsed() >= budget {
            runs.sort_by(|a, b| a.total().total_cmp(&b.total()));
            return Ok((result, runs[runs.len() / 2]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_repeated_while_there_is_time() {
        let mut runs = 0;
        let mut count = || {
            runs += 1;
            Ok(runs)
        };
        assert_eq!(repeat(Duration::ZERO, &mut count).unwrap().0, 1);
        assert_eq!(repeat(Duration::from_secs(3600), &mut count).unwrap().0, 1 + MOST_RUNS);
        let refused = repeat::<()>(Duration::ZERO, || Err(Failure::input("no")));
        assert!(refused.is_err());
    }

    #[test]
    fn the_parts_are_those_of_one_run() {
        // The median read takes 5, the median build 4, in runs of 85 and 904.
        let parts =
            [[1, 90], [2, 900], [3, 90], [900, 1], [90, 2], [90, 4], [900, 4], [5, 80], [1, 1]];
        let mut runs = parts.map(|part| part.map(f64::from)).into_iter();
        let (_, found) = repeat_preparing(Duration::from_secs(3600), || {
            let [read, build] = runs.next().unwrap();
            Ok(((), Preparation { read, build }))
        })
        .unwrap();
        assert_eq!(found, Preparation { read: 3.0, build: 90.0 });
        assert_eq!(found.then_trace(7.0).total(), 100.0);
    }
}
