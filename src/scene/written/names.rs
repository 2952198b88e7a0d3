//! Names people type, and what they may have meant.

use std::fmt;

/// The largest share of the longer word's letters that may be wrong if a word is to be
/// suggested: `colour` for `color` is 1/6, `radios` for `radius` 1/6, `ball` for `sphere`
/// nothing but a guess.
const MAX_WRONG: f64 = 0.4;

/// As many letters do words have in common that mean the same: `revolve` and `revolution`.
const STEM: usize = 5;

/// An error lists at most so many known names.
const MOST_SHOWN: usize = 40;

/// Returns the known name nearest to the one written, if one is near enough to be meant.
///
/// Nearness is the Damerau–Levenshtein distance (letters added, dropped, replaced or
/// swapped), without regard to case; the first of equals wins. If no name is near, the only one
/// that begins like the one written may be meant.
pub fn nearest<'a>(written: &str, known: &[&'a str]) -> Option<&'a str> {
    let written = written.to_lowercase();
    nearest_in_letters(&written, known).or_else(|| {
        let start = written.get(..STEM)?;
        let mut alike = known.iter().filter(|name| name.to_lowercase().starts_with(start));
        let only = alike.next().copied();
        only.filter(|_| alike.next().is_none())
    })
}

fn nearest_in_letters<'a>(written: &str, known: &[&'a str]) -> Option<&'a str> {
    known
        .iter()
        .map(|&name| (strsim::normalized_damerau_levenshtein(written, &name.to_lowercase()), name))
        .filter(|(likeness, _)| *likeness >= 1.0 - MAX_WRONG)
        .fold(None, |best: Option<(f64, &str)>, next| match best {
            Some(best) if best.0 >= next.0 => Some(best),
            _ => Some(next),
        })
        .map(|(_, name)| name)
}

/// An unknown name: what was written, and the nearest known name, or all known names.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownName {
    what: &'static str,
    written: String,
    hint: Hint,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Hint {
    Unnamed,
    Nearest(String),
    Known(Vec<String>),
}

impl UnknownName {
    /// An unknown `what` (a material, a key …), given the known ones.
    pub fn new(what: &'static str, written: &str, known: &[&str]) -> Self {
        let hint = match nearest(written, known) {
            Some(name) => Hint::Nearest(name.to_owned()),
            None => Hint::Known(known.iter().map(|&name| name.to_owned()).collect()),
        };
        Self { what, written: written.to_owned(), hint }
    }

    /// The name of a thing that has none of its own and is called after its kind.
    pub(super) fn unnamed(what: &'static str, written: &str) -> Self {
        Self { what, written: written.to_owned(), hint: Hint::Unnamed }
    }
}

impl std::error::Error for UnknownName {}

impl fmt::Display for UnknownName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, written) = (self.what, self.written.escape_debug());
        match &self.hint {
            Hint::Unnamed => write!(
                f,
                "no {what} has the name \"{written}\", but there is a {written} without a name: \
                 give it one, as in name = \"{written}\""
            ),
            Hint::Nearest(name) => {
                write!(f, "unknown {what} \"{written}\"; did you mean \"{name}\"?")
            }
            Hint::Known(names) if names.is_empty() => {
                write!(f, "unknown {what} \"{written}\": none is known here")
            }
            Hint::Known(names) => {
                let (shown, others) = names.split_at(names.len().min(MOST_SHOWN));
                write!(f, "unknown {what} \"{written}\"; known: {}", shown.join(", "))?;
                if others.is_empty() { Ok(()) } else { write!(f, " and {} more", others.len()) }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offers_what_was_meant_and_nothing_far_off() {
        let known = ["sphere", "torus", "cylinder"];
        assert_eq!(nearest("shpere", &known), Some("sphere"));
        assert_eq!(nearest("Torus", &known), Some("torus"));
        assert_eq!(nearest("teapot", &known), None);
        assert_eq!(nearest("", &known), None);
        assert_eq!(nearest("x", &[]), None);
        let known = ["revolution", "extrusion", "extruded"];
        assert_eq!(nearest("revolve", &known), Some("revolution"));
        assert_eq!(nearest("extrumetric", &known), None, "two begin like that");
    }

    #[test]
    fn messages() {
        assert_eq!(
            UnknownName::unnamed("object", "sphere").to_string(),
            "no object has the name \"sphere\", but there is a sphere without a name: give it one, \
             as in name = \"sphere\""
        );
        let known = ["red", "green"];
        assert_eq!(
            UnknownName::new("material", "gren", &known).to_string(),
            "unknown material \"gren\"; did you mean \"green\"?"
        );
        assert_eq!(
            UnknownName::new("material", "blue", &known).to_string(),
            "unknown material \"blue\"; known: red, green"
        );
        assert_eq!(
            UnknownName::new("material", "a\nb", &[]).to_string(),
            "unknown material \"a\\nb\": none is known here"
        );
        let known: Vec<String> = (0..1000).map(|k| format!("part {k}")).collect();
        let known: Vec<&str> = known.iter().map(String::as_str).collect();
        let long = UnknownName::new("object", "lid", &known).to_string();
        assert!(long.ends_with(", part 38, part 39 and 960 more"), "{long}");
    }
}
