//! The numbers beside an axis.

/// Sizes of letters beside axes in pixels.
pub(super) const NUMBER_SIZE: f64 = 11.0;

/// The widest number beside an edge of a box in pixels, which has room for others around it.
const WIDEST: f64 = 44.0;

/// The numbers beside an axis. They say how far a value is from `offset`, in units of `unit`.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Ticks {
    pub(super) values: Vec<f64>,
    pub(super) step: f64,
    /// One of the values, or 0.
    offset: f64,
    /// 1, or the power of ten that the step is 1, 2 or 5 times as large as.
    unit: f64,
}

impl Ticks {
    pub(super) fn new([low, high]: [f64; 2], step: f64) -> Self {
        // Values a hair beyond the ends belong to the range.
        let (first, last) = ((low / step - 1e-9).ceil(), (high / step + 1e-9).floor());
        let count = (last - first).clamp(0.0, 1e4) as u32;
        let values = (0..=count).map(|k| (first + f64::from(k)) * step);
        Self { values: values.collect(), step, offset: 0.0, unit: 1.0 }
    }

    /// Chooses numbers that fit: plain ones, else their differences from the roundest of them, else
    /// these differences in a unit of their own, where three digits are enough.
    pub(super) fn fitting(range: [f64; 2], step: f64, fits: impl Fn(&Self) -> bool) -> Self {
        let plain = Self::new(range, step);
        if fits(&plain) {
            return plain;
        }
        let shifted = Self { offset: plain.roundest(), ..plain };
        if fits(&shifted) {
            return shifted;
        }
        Self { unit: power_below(step), ..shifted }
    }

    /// Some numbers along an edge of a box, two at least, however far from 0. `room` is for how many
    /// steps there is room.
    pub(super) fn along(range: [f64; 2], room: f64) -> Self {
        let step = round_step((range[1] - range[0]) / room.clamp(1.0, 4.0));
        let fits = |ticks: &Self| ticks.labels().all(|(_, width)| width <= WIDEST);
        Self::fitting(range, Self::finer(range, step), fits)
    }

    /// The largest round step up to this one at which there are two numbers at least: one alone
    /// shows no scale.
    pub(super) fn finer(range: [f64; 2], step: f64) -> f64 {
        let mut step = step;
        while Self::new(range, step).values.len() < 2 {
            let next = round_step(0.4 * step);
            // False for NaN, and where rounding leaves no two numbers in the range.
            if !(step > f64::EPSILON * range[0].abs().max(range[1].abs()) && next < step) {
                break;
            }
            step = next;
        }
        step
    }

    /// The value that takes the fewest digits: 0, or a multiple of the highest power of ten.
    fn roundest(&self) -> f64 {
        // Numbers of 1e15 steps or more have no digits left: any of them will do.
        let steps = |value: f64| (value / self.step).round().clamp(-1e15, 1e15) as i64;
        let leading = (self.step / power_below(self.step)).round() as i64;
        let zeros = |value: &f64| {
            let digits = steps(*value) * leading;
            (1..=16).take_while(|&power| digits % 10_i64.pow(power) == 0).count()
        };
        self.values.iter().copied().rev().max_by_key(zeros).unwrap_or(0.0)
    }

    /// The text beside a value, with as many digits as the step has.
    pub(super) fn text(&self, value: f64) -> String {
        let (mut value, mut step) = (value, self.step);
        if self.offset != 0.0 || self.unit != 1.0 {
            let steps = ((value - self.offset) / step).round();
            step = if self.unit == 1.0 { step } else { (step / self.unit).round() };
            value = steps * step;
        }
        let decimals = -step.log10().floor();
        let zero = if value.abs() < 0.5 * step { 0.0 } else { value };
        let text = match decimals {
            d if d.abs() > 5.0 => {
                let digits = (zero.abs().log10().floor() + decimals).clamp(0.0, 15.0);
                if zero == 0.0 { "0".into() } else { format!("{zero:.0$e}", digits as usize) }
            }
            d if d > 0.0 => format!("{zero:.0$}", d as usize),
            _ => format!("{zero:.0}"),
        };
        text.replace('-', "−")
    }

    /// The values with the widths of the texts beside them, in pixels.
    pub(super) fn labels(&self) -> impl Iterator<Item = (f64, f64)> + '_ {
        self.values.iter().map(|&value| (value, width(&self.text(value), NUMBER_SIZE)))
    }

    /// The name of the axis, with what its numbers are: `x`, `x − 1e8`, `x, in 1e−9`.
    pub(super) fn name(&self, axis: &str) -> String {
        let mut name = axis.to_owned();
        if self.offset != 0.0 {
            let sign = if self.offset > 0.0 { '−' } else { '+' };
            // The digits of the offset down to the step's; those behind them are rounding.
            let digits = (self.offset.abs() / self.step).log10().floor() + 1.0;
            let text = format!("{:.1$e}", self.offset.abs(), digits.clamp(0.0, 16.0) as usize);
            name += &format!(" {sign} {}", text.parse().map_or(text, brief));
        }
        if self.unit != 1.0 {
            name += &format!(", in {}", brief(self.unit));
        }
        name
    }
}

/// A number with all its digits, in the shorter of two ways.
fn brief(number: f64) -> String {
    let (plain, power) = (format!("{number}"), format!("{number:e}"));
    if plain.len() <= power.len() { plain } else { power.replace('-', "−") }
}

/// How wide a number, or the name of an axis, is in letters of this size: those of DejaVu, which
/// are wider than most.
pub(super) fn width(text: &str, size: f64) -> f64 {
    let shares = text.chars().map(|letter| match letter {
        '.' | ',' | ' ' => 0.32,
        '−' | '+' => 0.838,
        _ => 0.637,
    });
    size * shares.sum::<f64>()
}

/// The smallest number that is 1, 2 or 5 times a power of ten and not smaller than `least`.
pub(super) fn round_step(least: f64) -> f64 {
    let power = power_below(least);
    let step = [1.0, 2.0, 5.0, 10.0].map(|factor| factor * power);
    step.into_iter().find(|&step| step >= least).unwrap_or(10.0 * power)
}

/// The highest power of ten that is not larger than a number, exact to the last digit.
fn power_below(number: f64) -> f64 {
    let power = number.log10().floor();
    format!("1e{power}").parse().unwrap_or(10_f64.powf(power))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(ticks: &Ticks) -> Vec<String> {
        ticks.values.iter().map(|&value| ticks.text(value)).collect()
    }

    #[test]
    fn numbers_beside_axes_are_round() {
        assert_eq!([0.3, 1.0, 11.0, 0.051].map(round_step), [0.5, 1.0, 20.0, 0.1]);
        let ticks = Ticks::new([-0.13, 0.31], 0.1);
        assert_eq!(texts(&ticks), ["−0.1", "0.0", "0.1", "0.2", "0.3"]);
        let ticks = Ticks::new([0.0, 3.1e-8], 1e-8);
        assert_eq!(texts(&ticks), ["0", "1e−8", "2e−8", "3e−8"]);
        let ticks = Ticks::new([0.0, 45.0], 20.0);
        assert_eq!(ticks.values, [0.0, 20.0, 40.0]);
        assert_eq!(ticks.text(40.0), "40");
    }

    #[test]
    fn numbers_without_room_are_told_from_a_round_one_or_in_a_unit() {
        let narrow = |ticks: &Ticks| ticks.labels().all(|(_, width)| width < 30.0);
        for (range, step, numbers, name) in [
            ([0.1, 0.5], 0.2, &["0.2", "0.4"][..], "x"),
            ([1e8, 1e8 + 1.0], 0.5, &["0.0", "0.5", "1.0"], "x − 1e8"),
            ([-1_000_003.2, -999_998.0], 2.0, &["−2", "0", "2"], "x + 1e6"),
            ([123_456.1, 123_458.3], 1.0, &["0", "1"], "x − 123457"),
            ([-1e-7, 2e-7], 1e-7, &["−1", "0", "1", "2"], "x, in 1e−7"),
            ([-2e4, 4e4], 2e4, &["−2", "0", "2", "4"], "x, in 1e4"),
            ([2e200, 3e200], 5e199, &["0", "5", "10"], "x − 2e200, in 1e199"),
            ([5.0, 5.0 + 2.1e-9], 1e-9, &["0", "1", "2"], "x − 5, in 1e−9"),
        ] {
            let ticks = Ticks::fitting(range, step, narrow);
            assert_eq!(texts(&ticks), numbers);
            assert_eq!(ticks.name("x"), name);
        }
    }
}
