//! Messages of the TOML and JSON parsers, put in the words of a scene's author.

use crate::math::Shown;
use crate::scene::UnknownName;

/// Kinds of things known by name: one of the names, by which the kind is recognised, and the kind.
const KINDS: [(&str, &str); 5] = [
    ("sphere", "shape"),
    ("directional", "light"),
    ("translate", "transform"),
    ("blending", "plot"),
    ("circle", "loop"),
];

/// Keys and names that stand in the wrong table, are in the wrong unit, or have another name here:
/// the key, a key that this table does have, and what to write instead.
const ELSEWHERE: [(&str, &str, &str); 42] = [
    ("radians", "degrees", "degrees = …"),
    ("fov", "perspective", "perspective = { fov = … }"),
    ("height", "orthographic", "orthographic = { height = … }"),
    (
        "direction",
        "directional",
        "directional = { from = [x, y, z], irradiance = … }: from where the light comes",
    ),
    (
        "direction",
        "irradiance",
        "from = [x, y, z], where the light comes from: the opposite of its direction of travel",
    ),
    ("from", "look_from", "look_from = [x, y, z]"),
    ("at", "look_from", "look_at = [x, y, z]"),
    ("position", "look_from", "look_from = [x, y, z]"),
    ("width", "spp", "size = [width, height]"),
    ("height", "spp", "size = [width, height]"),
    ("samples", "spp", "spp = …"),
    ("color", "shape", "material = \"name\", and a [[material]] of that name"),
    ("file", "shape", "shape = { file = \"…\" }"),
    ("tolerance", "doo_sabin", "catmull_clark = { file = \"…\", tolerance = … }, or doo_sabin"),
    ("nurbs", "shape", "[object.shape.nurbs]"),
    ("translate", "shape", "transform = [{ translate = [x, y, z] }]"),
    ("rotate", "shape", "transform = [{ rotate = { axis = \"z\", degrees = … } }]"),
    ("scale", "shape", "transform = [{ scale = … }]"),
    ("swap", "shape", "swap_uv = true"),
    ("exchange_uv", "shape", "swap_uv = true"),
    ("transpose", "shape", "swap_uv = true"),
    ("swap_uv", "knots_u", "it under [[object]], above the tables of its shape"),
    ("swap_uv", "profile", "it under [[object]], above the tables of its shape"),
    ("swap_uv", "radius", "it under [[object]], above the tables of its shape"),
    ("swap_uv", "geometry", "it under [[object]], above the tables of its shape"),
    ("swap_uv", "coefficients", "it under [[object]], above the tables of its shape"),
    ("transform", "knots_u", "it under [[object]], above the tables of its shape"),
    ("material", "knots_u", "it under [[object]], above the tables of its shape"),
    ("transform", "profile", "it under [[object]], above the tables of its shape"),
    ("material", "profile", "it under [[object]], above the tables of its shape"),
    ("transform", "radius", "it under [[object]], above the tables of its shape"),
    ("material", "radius", "it under [[object]], above the tables of its shape"),
    ("background", "shape", "it at the top of the scene, above its first table"),
    ("plane", "net", "it under [[plot]], above the tables of what it shows"),
    ("order", "degree", "degree = …, which is the order less 1"),
    ("center", "radius", "transform = [{ translate = [x, y, z] }] under [[object]]"),
    ("knots", "ends", "nurbs = { … } instead of bspline: it has knots, \"uniform\" ones too"),
    ("weights", "ends", "nurbs = { …, knots = \"uniform\", weights = … } instead of bspline"),
    ("clamped", "ends", "nurbs = { … } instead of bspline: it is clamped if no knots are given"),
    ("file", "note_circle", "nurbs = { … }: only surfaces are read from files"),
    ("de_boor", "de_casteljau", "de_casteljau = { … }: of a spline it shows de Boor's algorithm"),
    ("bernstein", "basis", "basis = { degree = n, count = n + 1 }"),
];

/// Names of curves, which have tables of their own.
const CURVES: [&str; 14] = [
    "nurbs",
    "polyline",
    "bezier",
    "through",
    "bspline",
    "catmull_rom",
    "hermite",
    "matrix_form",
    "power",
    "circle",
    "arc",
    "note_circle",
    "quarter_circle_2",
    "quarter_circle_4",
];

/// Tables where a curve stands deeper: a key or name that is known there, and what to write around
/// the curve.
const AROUND_CURVES: [(&str, [&str; 2]); 3] = [
    ("circle", ["{ curves = [{ ", " }] }"]),
    ("label", ["curve = { ", " }"]),
    ("de_casteljau", ["{ curves = [{ curve = { ", " } }] }"]),
];

/// Keys whose values are often written as another kind of value, and what these look like.
const EXAMPLES: [(&str, &str); 31] = [
    ("perspective", "{ fov = 30 }"),
    ("orthographic", "{ height = 4 }"),
    ("directional", "{ from = [-2, -3, 4], irradiance = 2.5 }"),
    ("point", "{ position = [3, -2, 5], intensity = 20 }"),
    ("ambient", "{ radiance = 0.1 }"),
    ("profile", "{ polyline = […] }"),
    ("path", "{ polyline = […] }"),
    ("rotate", "{ axis = \"z\", degrees = 90 }"),
    ("nurbs", "{ degree = …, points = […] }"),
    ("through", "{ points = […] }"),
    ("bspline", "{ degree = 3, points = […] }"),
    ("catmull_rom", "{ points = […] }"),
    ("hermite", "{ points = […], derivatives = […] }"),
    ("matrix_form", "{ form = \"hermite\", geometry = […] }"),
    ("form", "\"hermite\""),
    ("power", "{ coefficients = […] }"),
    ("circle", "{ center = [0, 0], radius = 1 }"),
    ("arc", "{ radius = 1, degrees = 90 }"),
    ("curve", "{ bezier = […] }"),
    ("basis", "{ degree = 3, count = 4 }"),
    ("derivatives", "{ curve = { … } }"),
    ("curvature", "{ curve = { … } }"),
    ("de_casteljau", "{ curve = { … }, t = 0.5 }"),
    ("trims", "{ loops = [{ … }] }, of a plot { of = \"…\" }"),
    ("keep", "\"inside\""),
    ("blending", "\"bspline\""),
    ("scheme", "\"chaikin\""),
    ("plane", "\"xy\""),
    ("caps", "\"round\""),
    ("creases", "[{ vertices = [0, 1], sharpness = 2.5 }]"),
    ("corners", "[{ vertices = [0], sharpness = 2.5 }]"),
];

/// Messages of the TOML parser, and what they say in plain words.
const PARSER: [(&str, &str); 6] = [
    ("invalid mantissa, expected digits", "a number has a digit before its point, as in 0.5"),
    ("invalid fraction, expected digits", "a number has a digit after its point, as in 1.0"),
    ("extra comma in array, expected value", "found a comma, needed a value before it"),
    (
        "extra assignment between key-value pairs, expected `,`",
        "found =, needed a comma before its key",
    ),
    ("key with no value, expected `=`", "found a key without a value, needed key = value"),
    ("invalid basic string, expected `\"`", "the text has no closing quote: needed \""),
];

/// Rust types that parsers mention, and their plain names.
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
/// plain names. `written` is the text at the place that the message complains about.
pub(super) fn explain(message: &str, written: &str) -> String {
    if let Some(rest) = message.strip_prefix("unknown field ") {
        return unknown("key", rest);
    }
    if let Some(rest) = message.strip_prefix("unknown variant ") {
        return unknown("name", rest);
    }
    if let Some(key) = message.strip_prefix("missing field ") {
        return format!("missing key {}", key.replace('`', "\""));
    }
    if let Some(key) = message.strip_prefix("duplicate field ") {
        return format!("key {} is given twice", key.replace('`', "\""));
    }
    if let Some((_, ours)) = PARSER.iter().find(|(theirs, _)| *theirs == message) {
        return (*ours).to_owned();
    }
    if message == "duplicate key" {
        return format!("key \"{}\" is given twice", written.trim());
    }
    if let Some(said) = one_or_several(message, written.trim()) {
        return said;
    }
    for start in ["invalid type: ", "invalid value: ", "invalid length "] {
        if let Some((found, needed)) =
            message.strip_prefix(start).and_then(|rest| rest.split_once(", expected "))
        {
            let of_length = if start == "invalid length " { "length " } else { "" };
            let (found, needed) = (plain(found), plain(needed));
            let shorter = if too_long(&found, &needed) { ", of at most 18 digits" } else { "" };
            return format!("found {of_length}{found}, needed {needed}{shorter}");
        }
    }
    message.replace('`', "\"")
}

/// Whether a whole number is of the right kind, but beyond 64 bits.
fn too_long(found: &str, needed: &str) -> bool {
    let digits = found.strip_prefix("integer ").filter(|_| needed == "a whole number from 0 on");
    digits.is_some_and(|digits| digits.bytes().all(|byte| byte.is_ascii_digit()))
}

/// The message for a single table where a list of tables is needed, or the other way round.
fn one_or_several(message: &str, written: &str) -> Option<String> {
    let header = |open: &str, close: &str| {
        let name = written.strip_prefix(open)?.strip_suffix(close)?;
        let is_name = |c: char| c.is_ascii_alphabetic() || c == '_' || c == '.';
        name.chars().all(is_name).then_some(name)
    };
    if message == "invalid type: map, expected a sequence" {
        return Some(match header("[", "]") {
            Some(name) => format!("there can be several of these: write [[{name}]]"),
            None if begins_with_points(written) => "found a table, needed a list of points: [[x, y], …]; \
                                                   with weights or knots it is nurbs = { degree = …, \
                                                   points = …, weights = … }"
                .to_owned(),
            None => "found a table, needed a list: write [{ … }]".to_owned(),
        });
    }
    if message.starts_with("invalid type: sequence, expected a table")
        && let Some(name) = header("[[", "]]")
    {
        return Some(format!("there is only one of these: write [{name}]"));
    }
    None
}

/// Whether a table's first key describes control points.
fn begins_with_points(table: &str) -> bool {
    let first = table.trim_start_matches('{').trim_start();
    ["points", "weights", "degree", "knots"].iter().any(|key| first.starts_with(key))
}

/// The message for an unknown name; `rest` is like "`shpere`, expected one of `sphere`, `torus`".
fn unknown(what: &'static str, rest: &str) -> String {
    let mut quoted = rest.split('`').skip(1).step_by(2);
    let name = quoted.next().unwrap_or_default();
    let known: Vec<&str> = quoted.collect();
    let kind = KINDS.iter().find(|(member, _)| what == "name" && known.contains(member));
    let what = kind.map_or(what, |(_, kind)| kind);
    let meant = |(key, sibling, _): &&(&str, &str, &str)| *key == name && known.contains(sibling);
    if let Some((_, _, write)) = ELSEWHERE.iter().find(meant) {
        return format!("unknown {what} \"{name}\"; write {write}");
    }
    let around = AROUND_CURVES.iter().find(|(sibling, _)| known.contains(sibling));
    if let Some((_, [open, close])) = around.filter(|_| CURVES.contains(&name)) {
        return format!("unknown {what} \"{name}\"; write {open}{name} = …{close}");
    }
    if name.contains('.') && known.contains(&"file") {
        return format!("unknown shape \"{name}\"; write {{ file = \"{name}\" }}");
    }
    UnknownName::new(what, name, &known).to_string()
}

/// The message, with an example if it asks for a table or a name and the key in front of the value
/// is one of [`EXAMPLES`]; `before` is the text up to the value, or up to the first of a list.
pub(super) fn with_example(message: String, before: &str) -> String {
    let before = before.trim_end();
    let (before, begins_list) = match before.strip_suffix('[') {
        Some(before) => (before.trim_end(), true),
        None => (before, false),
    };
    let Some(before) = before.strip_suffix('=') else { return message };
    let word = before.trim_end().rsplit(|c: char| !c.is_alphanumeric() && c != '_').next();
    let fits = |(key, example): &&(&str, &str)| {
        let asked = if example.contains('{') { "a table" } else { "a name in quotes" };
        let fits = Some(*key) == word && example.starts_with('[') == begins_list;
        fits && message.ends_with(&format!("needed {asked}"))
    };
    match EXAMPLES.iter().find(fits) {
        Some((key, example)) => format!("{message}, as in {key} = {example}"),
        None => message,
    }
}

/// Returns a parser's name of a type in plain words.
fn plain(name: &str) -> String {
    // Integers beyond 64 bits are read as longer ones.
    let quoted = name.replace('`', "").replace(" as i128", "").replace(" as u128", "");
    if let Some(Ok(number)) = quoted.strip_prefix("floating point ").map(str::parse::<f64>) {
        // Shown with its point, as written: the point may be all that is wrong with a whole number.
        let pointed = number.fract() == 0.0 && number.abs() < 1e6;
        return format!("the number {}{}", Shown(number), if pointed { ".0" } else { "" });
    }
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
            explain("unknown field `b`, expected one of `camera`, `light`", "b"),
            "unknown key \"b\"; known: camera, light"
        );
        assert_eq!(
            explain("unknown field `b`, there are no fields", "b"),
            "unknown key \"b\": none is known here"
        );
        assert_eq!(
            explain("unknown variant `shpere`, expected one of `sphere`, `torus`", "shpere"),
            "unknown shape \"shpere\"; did you mean \"sphere\"?"
        );
    }

    #[test]
    fn keys_of_other_tables_are_sent_there() {
        assert_eq!(
            explain("unknown field `fov`, expected one of `look_from`, `perspective`", "fov"),
            "unknown key \"fov\"; write perspective = { fov = … }"
        );
        assert_eq!(
            explain("unknown field `radians`, expected one of `radius`, `degrees`", "radians"),
            "unknown key \"radians\"; write degrees = …"
        );
        assert_eq!(
            explain("unknown field `fov`, expected one of `size`, `spp`", "fov"),
            "unknown key \"fov\"; known: size, spp"
        );
        assert_eq!(
            explain("unknown field `transform`, expected one of `degree`, `knots_u`", "transform"),
            "unknown key \"transform\"; write it under [[object]], above the tables of its shape"
        );
        assert_eq!(
            explain("unknown field `material`, expected `radius`", "material"),
            "unknown key \"material\"; write it under [[object]], above the tables of its shape"
        );
        assert_eq!(
            explain("unknown field `background`, expected one of `name`, `shape`", "background"),
            "unknown key \"background\"; write it at the top of the scene, above its first table"
        );
    }

    /// Messages of the parser that change go unnoticed otherwise.
    #[test]
    fn what_the_parser_says_of_values_is_put_plainly() {
        for (text, plain) in [
            ("x = .5", "a number has a digit before its point, as in 0.5"),
            ("x = [1., 2]", "a number has a digit after its point, as in 1.0"),
            ("x = [1,, 2]", "found a comma, needed a value before it"),
            ("x = { a = 1 b = 2 }", "found =, needed a comma before its key"),
            ("x", "found a key without a value, needed key = value"),
            ("x = \"a", "the text has no closing quote: needed \""),
        ] {
            let error = toml::from_str::<toml::Table>(text).unwrap_err();
            assert_eq!(explain(error.message(), ""), plain, "{text}: {error}");
        }
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
            explain(&format!("invalid type: floating point `{:.1}`, expected u32", 1e300), ""),
            "found the number 1e300, needed a whole number from 0 to 4294967295"
        );
        assert_eq!(
            explain("invalid type: floating point `4.0`, expected usize", "4.0"),
            "found the number 4.0, needed a whole number from 0 on"
        );
        assert_eq!(
            explain("invalid type: map, expected a sequence", "[light]"),
            "there can be several of these: write [[light]]"
        );
        assert_eq!(
            explain("invalid type: map, expected a sequence", "{ scale = 2 }"),
            "found a table, needed a list: write [{ … }]"
        );
        assert_eq!(
            explain(
                "invalid type: map, expected a sequence",
                "{ points = [[0, 0], [1, 1]], weights = [1, 2] }"
            ),
            "found a table, needed a list of points: [[x, y], …]; with weights or knots it is nurbs = { degree = …, \
             points = …, weights = … }"
        );
        assert_eq!(
            explain("invalid type: sequence, expected a table", "[[camera]]"),
            "there is only one of these: write [camera]"
        );
        assert_eq!(
            explain("invalid type: sequence, expected a table", "[[1, 2]]"),
            "found a list, needed a table"
        );
        assert_eq!(explain("missing field `shape`", ""), "missing key \"shape\"");
    }
}
