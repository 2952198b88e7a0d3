//! Tables and numbers for people.

use glam::DVec3;
use nurbray::math::Counted;

/// Aligns cells in columns: the columns `words` to the left, all others to the right. The first
/// row is the heading.
pub(crate) fn table(rows: &[Vec<String>], words: &[usize]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let cells = rows.iter().filter_map(|row| row.get(column));
        cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let mut text = String::new();
    for row in rows {
        let cells = row.iter().enumerate().map(|(column, cell)| {
            // Not by the formatter's width, which ends at 65535.
            let padding = " ".repeat(widths[column] - cell.chars().count());
            if words.contains(&column) { cell.clone() + &padding } else { padding + cell }
        });
        text.push_str(cells.collect::<Vec<_>>().join("  ").trim_end());
        text.push('\n');
    }
    text
}

/// A number with up to six significant digits, without trailing zeros.
pub(crate) fn short(number: f64) -> String {
    digits(number, 6)
}

/// A number with up to this many significant digits, without trailing zeros.
pub(crate) fn digits(number: f64, most: i32) -> String {
    let exponent = number.abs().log10().floor();
    if number == 0.0 || !number.is_finite() {
        return format!("{number}").replace("-0", "0");
    }
    if !(-4.0..f64::from(most)).contains(&exponent) {
        let text = format!("{number:.*e}", most as usize - 1);
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", trimmed(digits));
    }
    let decimals = (most - 1 - exponent as i32).max(0) as usize;
    trimmed(&format!("{number:.decimals$}")).to_owned()
}

/// `(x, y, z)`, each number shortened.
pub(crate) fn short_point(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(short);
    format!("({x}, {y}, {z})")
}

/// `(x, y, z)`, each number with up to ten significant digits.
pub(crate) fn long_point(point: DVec3) -> String {
    let [x, y, z] = point.to_array().map(|number| digits(number, 10));
    format!("({x}, {y}, {z})")
}

/// `512 B`, `12.3 kB`, `4.6 MB`, in powers of 1000.
pub(crate) fn short_bytes(bytes: usize) -> String {
    let bytes = bytes as f64;
    match bytes {
        ..1e3 => format!("{bytes} B"),
        ..1e6 => format!("{:.1} kB", bytes / 1e3),
        ..1e9 => format!("{:.1} MB", bytes / 1e6),
        _ => format!("{:.1} GB", bytes / 1e9),
    }
}

/// `1 ray`, `2 rays`: a count with its noun.
pub(crate) fn count(number: u64, noun: &str) -> String {
    Counted(usize::try_from(number).unwrap_or(usize::MAX), noun).to_string()
}

/// `0.0123`, `1.23`, `12.3`, `123`.
pub(crate) fn three_digits(number: f64) -> String {
    if number == 0.0 {
        return "0".into();
    }
    significant(number, 3, -3)
}

/// A number to this many digits, or fewer if it is smaller than this power of ten.
pub(crate) fn significant(number: f64, digits: usize, smallest: i32) -> String {
    // That of the rounded number: 9.996 has three digits as 10.0.
    let written = format!("{number:.*e}", digits - 1);
    let exponent = written.rsplit('e').next().and_then(|exponent| exponent.parse::<i32>().ok());
    let last = digits as i32 - 1;
    let decimals = last - exponent.unwrap_or(last).clamp(smallest, last);
    format!("{number:.*}", decimals as usize)
}

/// `12.3 µs`, `1.23 ms`, `12.3 s`.
pub(crate) fn time(seconds: f64) -> String {
    let (number, unit) = match seconds {
        ..1e-3 => (1e6 * seconds, "µs"),
        ..1.0 => (1e3 * seconds, "ms"),
        _ => (seconds, "s"),
    };
    format!("{} {unit}", three_digits(number))
}

fn trimmed(decimal: &str) -> &str {
    if decimal.contains('.') {
        decimal.trim_end_matches('0').trim_end_matches('.')
    } else {
        decimal
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_lose_no_size() {
        let cases = [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (-2.5, "-2.5"),
            (1.0 / 3.0, "0.333333"),
            (123456.7, "123457"),
            (100.0, "100"),
            (1e6, "1e6"),
            (1.5e-9, "1.5e-9"),
            (-2e8 / 3.0, "-6.66667e7"),
            (0.0001, "0.0001"),
            (f64::INFINITY, "inf"),
        ];
        for (number, text) in cases {
            assert_eq!(short(number), text);
        }
        assert_eq!(short_bytes(999), "999 B");
        assert_eq!(short_bytes(12_340_000), "12.3 MB");
        assert_eq!(count(1, "ray"), "1 ray");
        assert_eq!(count(0, "ray"), "0 rays");
    }

    #[test]
    fn three_digits_are_enough() {
        let cases = [
            (0.001234, "0.00123"),
            (0.5, "0.500"),
            (9.876, "9.88"),
            (9.994, "9.99"),
            (9.996, "10.0"),
            (12.34, "12.3"),
            (999.9, "1000"),
            (1234.5, "1234"),
            (0.0, "0"),
        ];
        for (number, text) in cases {
            assert_eq!(three_digits(number), text);
        }
        assert_eq!([2e-5, 0.0123, 2.0].map(time), ["20.0 µs", "12.3 ms", "2.00 s"]);
    }

    #[test]
    fn columns_are_aligned() {
        let rows = [["name", "n"], ["é", "10"], ["long one", "9"]];
        let rows = rows.map(|row| row.map(str::to_owned).to_vec());
        assert_eq!(table(&rows, &[0]), "name       n\né         10\nlong one   9\n");
    }
}
