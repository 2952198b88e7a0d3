//! Better messages than the parser's for slips of the pen that are not TOML.
//!
//! What the parser expected is rarely what was meant. For the commonest slips, the text at the
//! place of its complaint says more; where that is not certain, the parser's message stays.

use super::super::source::Source;
use crate::math::Shown;

/// Messages of the parser: for text where a value is needed, a comma too many in a table, leading
/// zeros, and a line that goes on where it should end.
const NO_VALUE: &str = "string values must be quoted, expected literal string";
const NO_VALUE_IN_BRACES: &str = "invalid literal string, expected `'`";
const COMMA_IN_BRACES: &str = "extra comma in inline table, expected `=`";
const LEADING_ZERO: &str = "unexpected leading zero, expected nothing";
const LINE_GOES_ON: &str = "unexpected key or value, expected newline, `#`";
const TWICE: &str = "duplicate key";

/// Beginnings of its messages: for words that begin as `nan`, `inf`, `true` or `false` do, lists
/// and tables that do not end, what cannot stand in them, and a key that no `=` follows.
const NO_FLOAT: &str = "invalid float";
const NO_BOOLEAN: &str = "invalid boolean";
const OPEN_LIST: &str = "unclosed array, ";
const OPEN_TABLE: &str = "unclosed inline table, ";
const NOT_IN_LIST: &str = "missing comma between array elements";
const NOT_IN_TABLE: [&str; 2] = ["invalid inline table element", "missing key for inline table"];
const NO_EQUALS: [&str; 3] = ["key with no value", "missing assignment", "invalid unquoted key"];

/// Tables of which a scene may have several.
const SEVERAL: [&str; 4] = ["light", "material", "object", "plot"];

/// Longer text is not repeated in messages.
const LONGEST: usize = 40;

/// Quotes as word processors write them.
const CURLY_QUOTES: [char; 6] = ['“', '”', '„', '‘', '’', '‚'];

/// Returns what is wrong at an offset of the text, where the parser says `message`, if that is
/// plain.
pub(super) fn slip(message: &str, source: &Source<'_>, offset: usize) -> Option<String> {
    let (text, rest) = source.text().split_at_checked(offset)?;
    let before = text.rsplit('\n').next()?;
    let after = rest.lines().next().unwrap_or("");
    let value = before.rsplit('=').next()?.trim_start();
    let opens = value.starts_with('(') && !value.contains(['"', '\'']);
    if opens || after.starts_with('(') {
        return Some("found (, needed [: a list has square brackets".into());
    }
    let is = |beginning: &&str| message.starts_with(*beginning);
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
        LINE_GOES_ON if after.starts_with(';') => {
            Some("found ;, needed the end of the line: nothing follows a value".into())
        }
        LINE_GOES_ON => unfit_bracket(source, offset)
            .or_else(|| no_brackets(before, after))
            .or_else(|| comma_at_end(before, after)),
        _ if [NO_FLOAT, NO_BOOLEAN].iter().any(is) => no_value(after),
        _ if [OPEN_LIST, OPEN_TABLE].iter().any(is) => not_closed(source, offset),
        _ if is(&NOT_IN_LIST) => unfit_bracket(source, offset)
            .or_else(|| next_key(before, after).and_then(|()| not_closed(source, offset)))
            .or_else(|| no_comma(after)),
        _ if NOT_IN_TABLE.iter().any(is) => unfit_bracket(source, offset)
            .or_else(|| next_key(before, after).and_then(|()| not_closed(source, offset))),
        _ if NO_EQUALS.iter().any(is) => no_equals(before, after),
        _ => None,
    }
}

/// The list or table, innermost of all, that is open at the end of a text: its kind, what closes
/// it, and where it begins.
fn open_at_end(text: &str) -> Option<(&'static str, char, usize)> {
    let mut open = Vec::new();
    let mut rest = text.char_indices();
    while let Some((at, c)) = rest.next() {
        match c {
            '[' => open.push(("list", ']', at)),
            '{' => open.push(("table", '}', at)),
            ']' | '}' => drop(open.pop()),
            '#' => drop(rest.find(|(_, c)| *c == '\n')),
            '"' | '\'' => {
                while let Some((_, inside)) = rest.next()
                    && inside != c
                {
                    if inside == '\\' && c == '"' {
                        rest.next();
                    }
                }
            }
            _ => {}
        }
    }
    open.pop()
}

/// The message for a list or table that nothing closes.
fn not_closed(source: &Source<'_>, offset: usize) -> Option<String> {
    let (kind, close, start) = open_at_end(&source.text()[..offset])?;
    let (line, column) = source.place(start).position()?;
    Some(format!("the {kind} that begins at {line}:{column} is not closed: needed {close}"))
}

/// The message for a bracket that closes what is not open.
fn unfit_bracket(source: &Source<'_>, offset: usize) -> Option<String> {
    let (before, after) = source.text().split_at(offset);
    let found = after.chars().next().filter(|c| [']', '}'].contains(c))?;
    let Some((kind, close, start)) = open_at_end(before) else {
        return Some(format!("found {found}, but nothing is open that it could close"));
    };
    let (line, column) = source.place(start).position()?;
    (found != close).then(|| {
        format!(
            "found {found} in the {kind} that begins at {line}:{column}: a {close} is missing \
             before it, or this {found} is one too many"
        )
    })
}

/// Whether a line begins here that is the header of a table, or a key with its value.
fn next_key(before: &str, after: &str) -> Option<()> {
    let name = after.trim_start_matches('[');
    let begins = before.trim().is_empty() && name.starts_with(|c: char| c.is_ascii_alphabetic());
    (begins && (after.starts_with('[') || after.contains('='))).then_some(())
}

/// The message for two values of a list with something else than a comma between them.
fn no_comma(after: &str) -> Option<String> {
    let found = after.chars().next()?;
    Some(format!("found {found}, needed a comma between two values of a list"))
}

/// The message for a key and its value with a colon between them.
fn no_equals(before: &str, after: &str) -> Option<String> {
    let key = before.rsplit(['{', ',']).next()?;
    (key.contains(':') || after.starts_with(':'))
        .then(|| "found :, needed = between a key and its value".into())
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
    if found.contains(CURLY_QUOTES) {
        let bare = found.replace(CURLY_QUOTES, "");
        return Some(format!("found {found}, needed straight quotes: \"{bare}\""));
    }
    if found.contains(['(', '*', '^']) && found.contains(|c: char| c.is_ascii_digit()) {
        return Some(format!("found {found}, needed the number it comes to, in digits"));
    }
    if let Some(number) = found.strip_prefix('−').filter(|number| is_number(number)) {
        return Some(format!("found {found}, needed -{number}: the sign is another character"));
    }
    if let "null" | "Null" | "NULL" | "None" | "nil" = found {
        return Some(format!("found {found}, needed a value: to give none, leave out the key"));
    }
    if let lower @ ("true" | "false") = found.to_lowercase().as_str() {
        return Some(format!("found {found}, needed {lower}"));
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
        let said = slip(error.message(), &Source::new(&text, "s"), offset);
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
    fn brackets_that_do_not_fit() {
        let open = |kind: &str, column: usize, close: char| {
            format!("the {kind} that begins at 2:{column} is not closed: needed {close}")
        };
        let unfit = |found: char, kind: &str, column: usize, close: char| {
            format!(
                "found {found} in the {kind} that begins at 2:{column}: a {close} is missing \
                 before it, or this {found} is one too many"
            )
        };
        for (line, expected) in [
            ("k = { j = [[1, 0], [0, 1] }", format!("27: {}", unfit('}', "list", 11, ']'))),
            ("k = { j = [[1, 0], [0, 1]]] }", format!("27: {}", unfit(']', "table", 5, '}'))),
            ("k = [1, 2]]", "11: found ], but nothing is open that it could close".into()),
            ("k = [{ j = ['[', \"]\\\"\"] } # [", format!("1: {}", open("list", 5, ']'))),
            ("k = [[1, 2], [3, 4]", format!("1: {}", open("list", 5, ']'))),
            ("k = [{ j = [1, 2] }\n[[plot]]", format!("1: {}", open("list", 5, ']'))),
            ("k = [{ j = { i = 1 }\n[[plot]]", format!("1: {}", open("table", 6, '}'))),
            (
                "k = [[1, 2]; [3, 4]]",
                "12: found ;, needed a comma between two values of a list".into(),
            ),
            (
                "k = [[1, 2] [3, 4]]",
                "13: found [, needed a comma between two values of a list".into(),
            ),
        ] {
            assert_eq!(said(line), expected, "{line}");
        }
        // At the end of the file.
        let text = "[a]\nk = { j = [1, 2]";
        let error = toml::from_str::<toml::Table>(text).unwrap_err();
        let source = Source::new(text, "s");
        let said = slip(error.message(), &source, error.span().unwrap().start);
        assert_eq!(said, Some(open("table", 5, '}')));
    }

    #[test]
    fn habits_of_other_languages() {
        let round = "found (, needed [: a list has square brackets";
        let colon = "found :, needed = between a key and its value";
        let sum = "needed the number it comes to, in digits";
        for (line, expected) in [
            ("k = [(0, 0), (1, 1)]", format!("6: {round}")),
            ("k = (0, 1)", format!("7: {round}")),
            ("k = { j = (0, 1) }", format!("11: {round}")),
            ("k = “x”", "5: found “x”, needed straight quotes: \"x\"".into()),
            ("k = [1, sqrt(2)/2, 1]", format!("9: found sqrt(2)/2, {sum}")),
            ("k = [1, 2*3]", format!("9: found 2*3, {sum}")),
            ("k = null", "5: found null, needed a value: to give none, leave out the key".into()),
            ("k = None", "5: found None, needed a value: to give none, leave out the key".into()),
            ("k = True", "5: found True, needed true".into()),
            ("k : 1", format!("3: {colon}")),
            ("k = { j: 1 }", format!("10: {colon}")),
            ("k = { \"j\": 1 }", format!("10: {colon}")),
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
