//! Names in a report: Markdown that shows them as they are.

/// Characters that Markdown takes for marks wherever they stand: of emphasis, code, links, HTML,
/// cells, entities and formulas.
const MARKS: [char; 12] = ['\\', '`', '*', '[', ']', '<', '>', '|', '~', '&', '$', '#'];

/// Text with a backslash before each mark, on one line.
pub(super) fn plain(text: &str) -> String {
    let mut plain = String::with_capacity(text.len());
    let mut before = None;
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        // Within a word, as in most names of files, an underscore is no mark.
        let inside = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
        let is_mark = match c {
            '_' => !(inside(before) && inside(rest.peek().copied())),
            _ => MARKS.contains(&c),
        };
        match c.is_control() {
            true => plain.extend(['\\'].into_iter().chain(c.escape_default())),
            false => plain.extend(is_mark.then_some('\\').into_iter().chain([c])),
        }
        before = Some(c);
    }
    plain
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_escaped_and_the_rest_stays() {
        for (name, written) in [
            ("scenes/wavy_sheet.toml", "scenes/wavy_sheet.toml"),
            ("2 × 3, \"lid\"/1", "2 × 3, \"lid\"/1"),
            ("a|b", "a\\|b"),
            ("*a* `b` <c> [d] ~e~ &amp; $x$", {
                "\\*a\\* \\`b\\` \\<c\\> \\[d\\] \\~e\\~ \\&amp; \\$x\\$"
            }),
            ("_a_b_ c__d", "\\_a_b\\_ c\\_\\_d"),
            ("a\nb\\", "a\\\\nb\\\\"),
        ] {
            assert_eq!(plain(name), written);
        }
    }
}
