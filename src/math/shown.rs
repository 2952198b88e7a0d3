//! Numbers in messages.

use std::fmt;

use glam::DVec3;

/// A number as a message shows it: `2.5`, `1e151`.
///
/// All its digits are shown, so that it can be found in a file; numbers that would need a
/// row of zeros for that have a power of ten instead.
#[derive(Clone, Copy, Debug)]
pub struct Shown(pub f64);

/// Magnitudes that are shown without a power of ten: from the upper end on f64 holds whole numbers
/// only, and below the lower end a decimal begins with more zeros than a reader counts.
const PLAIN: std::ops::Range<f64> = 1e-5..1e16;

impl fmt::Display for Shown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(number) = *self;
        let plain = number == 0.0 || !number.is_finite() || PLAIN.contains(&number.abs());
        if plain { write!(f, "{number}") } else { write!(f, "{number:e}") }
    }
}

/// A number that was measured or computed, as a message shows it: six digits, without the
/// rounding that follows them. `0.333333`, `2.5`, `1.11022e-16`.
#[derive(Clone, Copy, Debug)]
pub struct Measured(pub f64);

impl fmt::Display for Measured {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(number) = *self;
        // Six digits are read back as the number nearest to them.
        let rounded = format!("{number:.5e}").parse().unwrap_or(number);
        Shown(rounded).fmt(f)
    }
}

/// A length that was measured and must not be exceeded, as a message shows it: six digits, the last
/// of them rounded down. `0.666666`; but `2`, where it is 2 to within rounding.
#[derive(Clone, Copy, Debug)]
pub struct AtLeast(pub f64);

/// How far a measured length may be below a round one and still count as it, as a share: millions
/// of times less than what the six digits tell.
const ROUND: f64 = 1e-12;

impl fmt::Display for AtLeast {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(number) = *self;
        let digits = |number: f64| format!("{number:.5e}").parse().unwrap_or(number);
        let nearest: f64 = digits(number);
        // NaN and what is not finite are shown as they are.
        let above = nearest > number + ROUND * number.abs();
        let last = 10_f64.powf(number.abs().log10().floor() - 5.0);
        Shown(if above { digits(nearest - last) } else { nearest }).fmt(f)
    }
}

/// A point that was computed, as a message shows it: each coordinate as [`Measured`], those that
/// are only rounding error of the largest as 0.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredPoint(pub DVec3);

impl fmt::Display for MeasuredPoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let largest = self.0.abs().max_element();
        let noise = 16.0 * f64::EPSILON * largest;
        let kept = |x: f64| Measured(if x.abs() <= noise { 0.0 } else { x });
        let [x, y, z] = self.0.to_array().map(kept);
        write!(f, "({x}, {y}, {z})")
    }
}

/// A point or a vector as a message shows it: `(0, 2.5, 1e151)`.
#[derive(Clone, Copy, Debug)]
pub struct ShownVector(pub DVec3);

impl fmt::Display for ShownVector {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [x, y, z] = self.0.to_array().map(Shown);
        write!(f, "({x}, {y}, {z})")
    }
}

/// A count with its noun as a message shows it: `1 point`, `2 points`, `0 vertices`.
#[derive(Clone, Copy, Debug)]
pub struct Counted<'a>(pub usize, pub &'a str);

impl fmt::Display for Counted<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(number, noun) = *self;
        if number == 1 {
            return write!(f, "1 {noun}");
        }
        match noun.strip_suffix("ex").or(noun.strip_suffix("ix")) {
            Some(stem) => return write!(f, "{number} {stem}ices"),
            None => write!(f, "{number} ")?,
        }
        match noun.strip_suffix("f") {
            Some(stem) => write!(f, "{stem}ves"),
            None if noun.ends_with("ch") || noun.ends_with('s') => write!(f, "{noun}es"),
            None => write!(f, "{noun}s"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_rows_of_zeros_and_no_digit_lost() {
        for (number, text) in [
            (0.0, "0"),
            (-1.0, "-1"),
            (0.1, "0.1"),
            (1e15, "1000000000000000"),
            (1e16, "1e16"),
            (-1.25e151, "-1.25e151"),
            (1e-5, "0.00001"),
            (5e-324, "5e-324"),
            (f64::NAN, "NaN"),
            (f64::NEG_INFINITY, "-inf"),
        ] {
            assert_eq!(Shown(number).to_string(), text);
        }
        for number in [1.0 / 3.0, f64::MAX, f64::MIN_POSITIVE, 1e16 / 3.0, 1e-5 / 3.0] {
            assert_eq!(Shown(number).to_string().parse(), Ok(number));
        }
        let point = DVec3::new(1.0, -2.5, 1e300);
        assert_eq!(ShownVector(point).to_string(), "(1, -2.5, 1e300)");
    }

    #[test]
    fn nouns_agree_with_their_numbers() {
        for (number, noun, text) in [
            (0, "point", "0 points"),
            (1, "point", "1 point"),
            (2, "control point", "2 control points"),
            (1, "vertex", "1 vertex"),
            (3, "vertex", "3 vertices"),
            (1, "index", "1 index"),
            (4, "index", "4 indices"),
            (1, "patch", "1 patch"),
            (7, "Bézier patch", "7 Bézier patches"),
            (2, "leaf", "2 leaves"),
            (2, "sharpness", "2 sharpnesses"),
        ] {
            assert_eq!(Counted(number, noun).to_string(), text);
        }
    }

    #[test]
    fn lengths_that_must_not_be_exceeded_are_rounded_down() {
        for (number, text) in [
            (2.0 / 3.0, "0.666666"),
            (1.0 / 3.0, "0.333333"),
            (2.0 - 1e-15, "2"),
            (2.0 - 1e-9, "1.99999"),
            (9.999996e-8, "9.99999e-8"),
            (1.999996e7, "19999900"),
            (0.0, "0"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(AtLeast(number).to_string(), text);
        }
    }

    #[test]
    fn measured_numbers_lose_their_rounding() {
        for (number, text) in [
            (0.1 + 0.2, "0.3"),
            (1.0 / 3.0, "0.333333"),
            (-2.0 / 3e7, "-6.66667e-8"),
            (1234567.0, "1234570"),
            (0.0, "0"),
            (f64::EPSILON / 2.0, "1.11022e-16"),
            (f64::MAX, "1.79769e308"),
            (f64::INFINITY, "inf"),
            (f64::NAN, "NaN"),
        ] {
            assert_eq!(Measured(number).to_string(), text);
        }
        let point = DVec3::new(0.1 + 0.2, 1e-17, -1e-9);
        assert_eq!(MeasuredPoint(point).to_string(), "(0.3, 0, -1e-9)");
    }
}
