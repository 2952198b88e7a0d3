//! Whole numbers as people write them.

use std::ops::RangeInclusive;

/// Reads `1000000`, `1_000_000`, `1e6` or `2.5e6`, exactly. Returns `None` if the text is not a
/// whole number from 0 on or does not fit.
pub(super) fn whole(text: &str) -> Option<u64> {
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => {
            let exponent = exponent.strip_prefix('+').unwrap_or(exponent);
            (mantissa, digits(exponent)?.parse::<u32>().ok()?)
        }
        None => (text, 0),
    };
    let (units, fraction) = match mantissa.split_once('.') {
        Some((units, fraction)) => (digits(units)?, digits(fraction)?),
        None => (digits(mantissa)?, String::new()),
    };

    // 2.5e6 is 25 followed by five zeros; decimals beyond the exponent must be zeros.
    let fraction = fraction.trim_end_matches('0');
    let zeros = exponent.checked_sub(u32::try_from(fraction.len()).ok()?)?;
    let number: u64 = format!("{units}{fraction}").parse().ok()?;
    if number == 0 { Some(0) } else { number.checked_mul(10_u64.checked_pow(zeros)?) }
}

/// The digits of a number, without the underscores between them; at least one digit.
fn digits(text: &str) -> Option<String> {
    let groups: Vec<&str> = text.split('_').collect();
    let is_group = |group: &&str| !group.is_empty() && group.bytes().all(|b| b.is_ascii_digit());
    groups.iter().all(is_group).then(|| groups.concat())
}

/// A parser of whole numbers within a range.
pub(super) fn count<T: TryFrom<u64>>(
    range: RangeInclusive<u64>,
) -> impl Fn(&str) -> Result<T, String> + Clone {
    move |text| {
        let number = whole(text).filter(|number| range.contains(number));
        number.and_then(|number| T::try_from(number).ok()).ok_or_else(|| {
            let (low, high) = (range.start(), range.end());
            format!("a whole number from {low} to {high} is needed, such as 64, 1_000 or 1e3")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_as_people_write_them() {
        for (text, number) in [
            ("0", 0),
            ("007", 7),
            ("1000000", 1_000_000),
            ("1_000_000", 1_000_000),
            ("1e6", 1_000_000),
            ("1E+6", 1_000_000),
            ("2.5e6", 2_500_000),
            ("2.50e1", 25),
            ("3.0", 3),
            ("0e999", 0),
            ("18446744073709551615", u64::MAX),
        ] {
            assert_eq!(whole(text), Some(number), "{text}");
        }
    }

    #[test]
    fn nothing_else_is_a_number() {
        let wrong = [
            "",
            "-1",
            "+1",
            "1.5",
            "2.55e1",
            "1e-3",
            "1e",
            "e6",
            ".5e1",
            "1.e1",
            "_1",
            "1_",
            "1__0",
            "0x10",
            "1e20",
            "18446744073709551616",
            "1e99999999999",
            "nan",
            "inf",
            " 1",
            "१",
        ];
        for text in wrong {
            assert_eq!(whole(text), None, "{text}");
        }
    }

    #[test]
    fn ranges_are_kept() {
        let parse = count::<u16>(1..=1024);
        assert_eq!(parse("1e3"), Ok(1000));
        let message = "a whole number from 1 to 1024 is needed, such as 64, 1_000 or 1e3";
        for wrong in ["0", "1025", "70000", "-1", "many"] {
            assert_eq!(parse(wrong), Err(message.to_owned()), "{wrong}");
        }
    }
}
