//! What the TOML and JSON parsers say, in the words of a scene's author.

use crate::scene::UnknownName;

/// Kinds of things known by name, told apart by one of the names.
const KINDS: [(&str, &str); 3] =
    [("sphere", "shape"), ("directional", "light"), ("translate", "transform")];

/// Types of Rust that parsers mention, and what they are called outside.
const TYPES: [(&str, &str); 8] = [
    ("f64", "a number"),
    ("u32", "a whole number from 0 to 4294967295"),
    ("u64", "a whole number from 0 on"),
    ("usize", "a whole number from 0 on"),
    ("a sequence", "a list"),
    ("a boolean", "true or false"),
    ("a map", "a table"),
    ("struct", "a table"),
];

/// Rewrites a parser's message: unknown names get the nearest known one, and types their
/// plain names. `written` is what stands at the place it complains about.
pub(super) fn explain(message: &str, written: &str) -> String {
    if let Some(rest) = message.strip_prefix("unknown field ") {
        return unknown("key", rest);
    }
    if let Some(rest) = message.strip_prefix("unknown variant ") {
        return unknown("name", rest);
    }
    if let Some((keys, known)) = message
        .strip_prefix("unexpected keys in table: ")
        .and_then(|rest| rest.split_once(", available keys: "))
    {
        let key = keys.split(", ").next().unwrap_or(keys);
        let known: Vec<&str> = known.split(", ").collect();
        return UnknownName::new("key", key, &known).to_string();
    }
    if let Some(key) = message.strip_prefix("missing field ") {
        return format!("missing key {}", key.replace('`', "\""));
    }
    if message.starts_with("invalid type: unit variant") {
        let name = written.trim_matches(['"', '\'']);
        return format!("\"{name}\" needs its own keys: write {{ {name} = {{ … }} }}");
    }
    if message.starts_with("wanted exactly 1 element") {
        return "needed is one kind, as in { sphere = { radius = 1 } }".to_owned();
    }
    if message.starts_with("expected empty table") {
        return "it has no keys of its own".to_owned();
    }
    if message == "invalid type: map, expected a sequence" && written.starts_with('[') {
        return format!("there can be several of these: write [{}]", written.trim());
    }
    for start in ["invalid type: ", "invalid value: ", "invalid length "] {
        if let Some((found, needed)) =
            message.strip_prefix(start).and_then(|rest| rest.split_once(", expected "))
        {
            let of_length = if start == "invalid length " { "length " } else { "" };
            return format!("found {of_length}{}, needed {}", plain(found), plain(needed));
        }
    }
    message.replace('`', "\"")
}

/// `shpere`, expected one of `sphere`, `torus`.
fn unknown(what: &'static str, rest: &str) -> String {
    let mut quoted = rest.split('`').skip(1).step_by(2);
    let name = quoted.next().unwrap_or_default();
    let known: Vec<&str> = quoted.collect();
    let kind = KINDS.iter().find(|(member, _)| what == "name" && known.contains(member));
    UnknownName::new(kind.map_or(what, |(_, kind)| kind), name, &known).to_string()
}

/// A parser's name of a type in plain words.
fn plain(name: &str) -> String {
    let quoted = name.replace('`', "");
    for (theirs, ours) in TYPES {
        let whole = quoted == theirs || (theirs == "struct" && quoted.starts_with("struct "));
        if whole {
            return ours.to_owned();
        }
    }
    match quoted.as_str() {
        "map" => "a table".to_owned(),
        "sequence" => "a list".to_owned(),
        _ => quoted,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unknown_names_get_the_nearest_known_one() {
        assert_eq!(
            explain("unknown field `radios`, expected `radius`", "radios"),
            "unknown key \"radios\"; did you mean \"radius\"?"
        );
        assert_eq!(
            explain("unexpected keys in table: radios, b, available keys: major, radius", ""),
            "unknown key \"radios\"; did you mean \"radius\"?"
        );
        assert_eq!(
            explain("unknown field `b`, expected one of `camera`, `light`", "b"),
            "unknown key \"b\"; known: camera, light"
        );
        assert_eq!(
            explain("unknown field `b`, there are no fields", "b"),
            "unknown key \"b\"; there is none"
        );
        assert_eq!(
            explain("unknown variant `shpere`, expected one of `sphere`, `torus`", "shpere"),
            "unknown shape \"shpere\"; did you mean \"sphere\"?"
        );
    }

    #[test]
    fn types_get_plain_names() {
        assert_eq!(
            explain("invalid type: string \"x\", expected f64", "'x'"),
            "found string \"x\", needed a number"
        );
        assert_eq!(
            explain("invalid value: integer `-1`, expected u32", "-1"),
            "found integer -1, needed a whole number from 0 to 4294967295"
        );
        assert_eq!(
            explain("invalid type: map, expected a sequence", "[light]"),
            "there can be several of these: write [[light]]"
        );
        assert_eq!(
            explain("invalid type: unit variant, expected struct variant", "\"sphere\""),
            "\"sphere\" needs its own keys: write { sphere = { … } }"
        );
        assert_eq!(explain("missing field `shape`", ""), "missing key \"shape\"");
    }
}
