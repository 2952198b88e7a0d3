//! How fast each competitor is: rounds in turn, medians, spread.

use std::time::{Duration, Instant};

/// The number of rounds in which each competitor is timed. Odd, to have a middle; small, since
/// the slowest traces all rays in every round.
const ROUNDS: u32 = 5;

/// How fast rays were traced.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Speed {
    /// Millions of rays a second: the median of the rounds.
    pub(crate) mrays_per_s: f64,
    /// The fastest round less the slowest, divided by the median.
    pub(crate) spread: f64,
}

/// Something to time that traces all rays once a call.
pub(crate) type Pass<'a> = Box<dyn FnMut() + 'a>;

/// Times passes over `rays` rays, the competitors in turn, so that changes in the machine's speed
/// meet all of them alike. Each round gives every competitor an equal share of `seconds`, and one
/// pass at least.
pub(crate) fn race(passes: &mut [Pass<'_>], rays: usize, seconds: f64) -> Vec<Speed> {
    let turn = Duration::from_secs_f64(seconds / f64::from(ROUNDS));
    let mut rates: Vec<Vec<f64>> = vec![Vec::new(); passes.len()];
    for _ in 0..ROUNDS {
        for (pass, rates) in passes.iter_mut().zip(&mut rates) {
            rates.push(1e-6 * rays as f64 / seconds_a_pass(pass, turn));
        }
    }
    rates.iter_mut().map(|rates| speed(rates)).collect()
}

/// Repeats a pass until its turn is over. Returns the mean time that a pass takes.
pub(crate) fn seconds_a_pass(pass: &mut dyn FnMut(), turn: Duration) -> f64 {
    let start = Instant::now();
    let mut count = 0;
    loop {
        pass();
        count += 1;
        let elapsed = start.elapsed();
        if elapsed >= turn {
            // A pass over a handful of rays may be shorter than the clock's tick.
            return elapsed.as_secs_f64().max(1e-9) / f64::from(count);
        }
    }
}

fn speed(rates: &mut [f64]) -> Speed {
    let middle = median(rates); // sorts
    let range = rates.last().zip(rates.first()).map_or(0.0, |(high, low)| high - low);
    Speed { mrays_per_s: middle, spread: range / middle }
}

/// Sorts numbers and returns their median: the one in the middle, or the mean of the two there.
/// NaN if there are none.
pub(crate) fn median(numbers: &mut [f64]) -> f64 {
    numbers.sort_by(f64::total_cmp);
    let half = numbers.len() / 2;
    match numbers.len() {
        0 => f64::NAN,
        odd if odd % 2 == 1 => numbers[half],
        _ => 0.5 * (numbers[half - 1] + numbers[half]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_and_spread() {
        assert_eq!(median(&mut [3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&mut [4.0, 1.0, 2.0, 3.0]), 2.5);
        assert!(median(&mut []).is_nan());
        let speed = speed(&mut [9.0, 10.0, 8.0, 12.0, 10.0]);
        assert_eq!(speed, Speed { mrays_per_s: 10.0, spread: 0.4 });
    }

    #[test]
    fn everyone_has_a_turn_in_every_round() {
        let turns = &std::cell::RefCell::new(String::new());
        let turn = |name| Box::new(move || turns.borrow_mut().push(name)) as Pass<'_>;
        let speeds = race(&mut [turn('a'), turn('b')], 7, 1e-12);
        assert_eq!(*turns.borrow(), "ab".repeat(ROUNDS as usize));
        assert!(speeds.iter().all(|speed| speed.mrays_per_s > 0.0 && speed.spread >= 0.0));
    }
}
