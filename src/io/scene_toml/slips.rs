//! Better messages than the parser's for slips of the pen that are not TOML.
//!
//! What the parser expected is rarely what was meant. For the commonest slips, the text at the
//! place of its complaint says more; where that is not certain, the parser's message stays.

use crate::math::Shown;

/// Messages of the parser: for text where a value is needed, a comma too many in a table, leading
/// zeros, and a line that goes on where it should end.
const NO_VALUE: &str = "string values must be quoted, expected literal string";
const NO_VALUE_IN_BRACES: &str = "invalid literal string, expected `'`";
const COMMA_IN_BRACES: &str = "extra comma in inline table, expected `=`";
const LEADING_ZERO: &str = "unexpected leading zero, expected nothing";
const LINE_GOES_ON: &str = "unexpected key or value, expected newline, `#`";
const TWICE: &str = "duplicate key";

/// Tables of which a scene may have several.
const SEVERAL: [&str; 4] = ["light", "material", "object", "plot"];

/// Longer text is not repeated in messages.
const LONGEST: usize = 40;

/// Returns what is wrong at an offset of the text, where the parser says `message`, if that is
/// plain.
pub(super) fn slip(message: &str, text: &str, offset: usize) -> Option<String> {
    let (before, after) = text.split_at_checked(offset)?;
    let before = before.rsplit('\n').next()?;
    let after = after.lines().next().unwrap_or("");
    match message {
        NO_VALUE => no_value(after),
        // The same message is given for a string without an end, which runs to the end of the line.
        NO_VALUE_IN_BRACES if after.starts_with('}') => match before.trim_end().ends_with('=') {
            true => no_value(after),
            false => no_brackets(before, after),
        },
        COMMA_IN_BRACES => no_brackets(before, after),
        LEADING_ZERO => leading_zero(after),
        TWICE => table_twice(before, after),
        LINE_GOES_ON => no_brackets(before, after).or_else(|| comma_at_end(before, after)),
        _ => None,
    }
}

/// The message for the header of a table that is given as one and as several.
fn table_twice(before: &str, after: &str) -> Option<String> {
    let name: String = after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
    match before.trim() {
        "[[" => Some(format!(
            "[[{name}]] stands below [{name}] or [{name}.…]: write [[{name}]] first, and tables of its own below it"
        )),
        "[" if SEVERAL.contains(&&*name) => {
            Some(format!("[{name}] is given twice: write [[{name}]] for each"))
        }
        _ => None,
    }
}

/// Whether a word is a number of TOML, or nearly one: with a zero or a sign too many.
fn is_number(word: &str) -> bool {
    word.contains(|c: char| c.is_ascii_digit()) && word.parse::<f64>().is_ok()
}

/// Whether a word may be a group of digits of a longer number, as in `1,000,000`: three digits, the
/// first a zero, which are no number of their own in TOML.
fn is_group(word: &str) -> bool {
    word.len() == 3 && word.starts_with('0') && word.bytes().all(|byte| byte.is_ascii_digit())
}

/// The message that groups of digits are one number.
fn one_number(found: &str, groups: &[&str]) -> String {
    let [whole, groups] = [groups.concat(), groups.join("_")];
    format!("found {found}, needed {whole} or {groups}: a number has no gaps")
}

/// The message for text without quotes, a fraction, numbers without commas, or nothing at all.
fn no_value(after: &str) -> Option<String> {
    let found = after.split([',', ']', '}', '#']).next()?.trim();
    if found.is_empty() {
        let needed = "a number, text in quotes, true or false, a list or a table";
        return Some(format!("found nothing, needed a value: {needed}"));
    }
    if let [first, second, ..] = found.split_whitespace().collect::<Vec<_>>()[..]
        && is_number(first)
        && is_number(second)
    {
        if is_group(second) {
            return Some(one_number(&format!("{first} {second}"), &[first, second]));
        }
        return Some(format!(
            "found {first} {second}, needed a comma between two numbers of a list: {first}, {second}"
        ));
    }
    if found.len() > LONGEST || found.contains(['"', '\'', '\\']) {
        return None;
    }
    if let Some(number) = found.strip_prefix('−').filter(|number| is_number(number)) {
        return Some(format!("found {found}, needed -{number}: the sign is another character"));
    }
    if let Some(meant) = match found {
        "yes" | "on" => Some("true"),
        "no" | "off" => Some("false"),
        _ => None,
    } {
        return Some(format!(
            "found {found}, needed {meant}, or quotes if it is text: \"{found}\""
        ));
    }
    if let Some((above, below)) = found.split_once('/')
        && let (Ok(above), Ok(below)) = (above.trim().parse::<f64>(), below.trim().parse::<f64>())
        && (above / below).is_finite()
    {
        let quotient = Shown(above / below);
        return Some(format!("found {found}, needed the number it comes to: {quotient}"));
    }
    Some(format!(
        "found {found}, needed digits if it is a number, quotes if it is text: \"{found}\""
    ))
}

/// The message for numbers after a key, with commas but without brackets; between two numbers the
/// comma may be meant as a decimal point.
fn no_brackets(before: &str, after: &str) -> Option<String> {
    let value = before.rfind('=')? + 1;
    let written = format!("{}{after}", &before[value..]);
    let written = written.split(['}', '#']).next()?;
    let numbers: Vec<&str> =
        written.split(',').map(str::trim).take_while(|word| is_number(word)).collect();
    let list = numbers.join(", ");
    if numbers.len() < 2 || list.len() > LONGEST {
        return None;
    }
    if numbers[1..].iter().any(|word| is_group(word)) && numbers[1..].iter().all(|w| w.len() == 3) {
        return Some(one_number(&numbers.join(","), &numbers));
    }
    if let [whole, decimals] = numbers[..]
        && written.contains(&format!("{whole},{decimals}"))
        && !whole.contains(['.', 'e', 'E'])
        && decimals.bytes().all(|byte| byte.is_ascii_digit())
    {
        return Some(format!(
            "found {whole},{decimals}, needed {whole}.{decimals} if it is one number, [{list}] if \
             it is a list"
        ));
    }
    Some(format!("found {list}, needed brackets around a list: [{list}]"))
}

/// The message for zeros before the digits of a number.
fn leading_zero(after: &str) -> Option<String> {
    let of_number = |c: char| c.is_ascii_alphanumeric() || "._+-".contains(c);
    let found = after.split(|c| !of_number(c)).next()?;
    let bare = found.trim_start_matches('0');
    let zero = if bare.starts_with(|c: char| c.is_ascii_digit()) { "" } else { "0" };
    let sensible = is_number(found) && found.len() <= LONGEST;
    sensible.then(|| format!("found {found}, needed {zero}{bare}: a number has no zeros in front"))
}

/// The message for a comma after the value of a key that has a line to itself.
fn comma_at_end(before: &str, after: &str) -> Option<String> {
    let rest = after.strip_prefix(',')?.trim_start();
    let ends = before.contains('=') && (rest.is_empty() || rest.starts_with('#'));
    ends.then(|| "found a comma at the end of the line, needed none".into())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The message about a line in a table, and the column it names.
    fn said(line: &str) -> String {
        let text = format!("[a]\n{line}\nafter = 1\n");
        let error = toml::from_str::<toml::Table>(&text).unwrap_err();
        let offset = error.span().unwrap().start;
        let column = text[..offset].rsplit('\n').next().unwrap().len() + 1;
        let said = slip(error.message(), &text, offset);
        format!("{column}: {}", said.unwrap_or_else(|| format!("({})", error.message())))
    }

    #[test]
    fn what_is_no_value() {
        let comma = "found 1 2, needed a comma between two numbers of a list: 1, 2";
        let nothing = "found nothing, needed a value: a number, text in quotes, true or false, a list or a table";
        for (line, expected) in [
            ("k = [1 2, 3]", format!("6: {comma}")),
            ("k = [[1 2 3], [4, 5, 6]]", format!("7: {comma}")),
            ("k = 1 2 # and more", format!("5: {comma}")),
            (
                "k = [0, 0.5 -2]",
                "9: found 0.5 -2, needed a comma between two numbers of a list: 0.5, -2".into(),
            ),
            ("k = 1/3", "5: found 1/3, needed the number it comes to: 0.3333333333333333".into()),
            ("k = { j = -1 / 4 }", "11: found -1 / 4, needed the number it comes to: -0.25".into()),
            (
                "k = 1/0",
                "5: found 1/0, needed digits if it is a number, quotes if it is text: \"1/0\""
                    .into(),
            ),
            (
                "k = ball",
                "5: found ball, needed digits if it is a number, quotes if it is text: \"ball\""
                    .into(),
            ),
            ("k = yes", "5: found yes, needed true, or quotes if it is text: \"yes\"".into()),
            ("k = [−1, 2]", "6: found −1, needed -1: the sign is another character".into()),
            ("k = 3 000", "5: found 3 000, needed 3000 or 3_000: a number has no gaps".into()),
            ("k = ", format!("5: {nothing}")),
            ("k = # none", format!("5: {nothing}")),
            ("k = { j = }", format!("11: {nothing}")),
        ] {
            assert_eq!(said(line), expected, "{line}");
        }
    }

    #[test]
    fn commas_without_brackets() {
        let decimal = "found 1,5, needed 1.5 if it is one number, [1, 5] if it is a list";
        let list = "found 0, 0, 1, needed brackets around a list: [0, 0, 1]";
        let end = "found a comma at the end of the line, needed none";
        for (line, expected) in [
            ("k = 1,5", format!("6: {decimal}")),
            ("k = 1,5 # so much", format!("6: {decimal}")),
            ("k = { j = 1,5 }", format!("15: {decimal}")),
            ("k = { j = 1,5, i = 2 }", format!("14: {decimal}")),
            ("k = { i = 'x', j = 1,5 }", format!("24: {decimal}")),
            ("k = 0, 0, 1", format!("6: {list}")),
            ("k = { j = 0, 0, 1 }", format!("15: {list}")),
            (
                "k = 1,000,000",
                "6: found 1,000,000, needed 1000000 or 1_000_000: a number has no gaps".into(),
            ),
            ("k = 8, 6", "6: found 8, 6, needed brackets around a list: [8, 6]".into()),
            ("k = 1.5,2", "8: found 1.5, 2, needed brackets around a list: [1.5, 2]".into()),
            ("k = 1,", format!("6: {end}")),
            ("k = [1, 2], # a list", format!("11: {end}")),
        ] {
            assert_eq!(said(line), expected, "{line}");
        }
    }

    #[test]
    fn zeros_before_digits() {
        for (line, expected) in [
            ("k = 01", "5: found 01, needed 1: a number has no zeros in front"),
            ("k = [1, 007.5]", "9: found 007.5, needed 7.5: a number has no zeros in front"),
            ("k = -00.5", "6: found 00.5, needed 0.5: a number has no zeros in front"),
            ("k = 00", "5: found 00, needed 0: a number has no zeros in front"),
            ("k = 0_1", "5: (unexpected leading zero, expected nothing)"),
        ] {
            assert_eq!(said(line), expected, "{line}");
        }
    }

    /// Strings may hold anything that looks like a slip.
    #[test]
    fn what_is_not_plain_is_left_to_the_parser() {
        for (line, column) in [
            ("k = 'j = 1,5", 13),
            ("k = 'x' 1,5", 9),
            ("k = x = 3", 7),
            ("k = it\"s", 5),
            ("k = [1, 2] 3", 12),
        ] {
            assert!(said(line).starts_with(&format!("{column}: (")), "{line}: {}", said(line));
        }
    }
}
