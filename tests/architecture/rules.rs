//! The rules, each a function from a file to its violations, and proof that each can fail.

use crate::source::SourceFile;

/// Ground floor first. A floor may use those before it.
const FLOORS: [&str; 8] =
    ["math", "geometry", "patch", "intersect", "scene", "render", "io", "app"];

/// The roots of library and program: they see every floor.
const ROOTS: [&str; 2] = ["lib", "main"];

/// The one file that may say `unsafe`.
const UNSAFE_HOME: &str = "io/embree.rs";

/// Lines a file may have, tests included. The house style asks for fewer than 500; this limit
/// is enforced.
const LINE_LIMIT: usize = 600;

/// What no code outside the program's own floor may call.
const LOUD: [&str; 15] = [
    "println!",
    "eprintln!",
    "print!",
    "eprint!",
    "dbg!",
    "stdout()",
    "stderr()",
    "process::exit",
    "process::abort",
    "panic!",
    "todo!",
    "unimplemented!",
    "unreachable!",
    ".unwrap()",
    ".expect(",
];

fn level(floor: &str) -> Option<usize> {
    FLOORS.iter().position(|known| *known == floor)
}

/// Floors named after `crate::` or `nurbray::` that are not below the file's own.
///
/// Understands `crate::{a::X, b}` as well as `crate::a::X`, over several lines.
pub(crate) fn upward_uses(file: &SourceFile) -> Vec<String> {
    let Some(own) = level(file.floor()) else { return Vec::new() };
    let mut wrong = Vec::new();
    for prefix in ["crate::", "nurbray::"] {
        for (start, _) in file.code.match_indices(prefix) {
            if ends_with_word(&file.code[..start]) {
                continue; // some_crate::…
            }
            let line = 1 + file.code[..start].matches('\n').count();
            for name in heads(&file.code[start + prefix.len()..]) {
                if level(&name).is_none_or(|used| used > own) {
                    wrong.push(file.at(line, &format!("{prefix}{name}")));
                }
            }
        }
    }
    wrong
}

/// Files in folders that are no floor.
pub(crate) fn homeless(file: &SourceFile) -> Vec<String> {
    let known = level(file.floor()).is_some() || ROOTS.contains(&file.floor());
    if known { Vec::new() } else { vec![file.at(1, file.floor())] }
}

/// `unsafe` anywhere but in its home.
pub(crate) fn unsafe_code(file: &SourceFile) -> Vec<String> {
    if file.path == UNSAFE_HOME {
        return Vec::new();
    }
    let wrong = file.code.lines().enumerate().filter(|(_, line)| {
        line.split(|c: char| !c.is_alphanumeric() && c != '_').any(|word| word == "unsafe")
            || line.contains("allow(unsafe_code")
    });
    wrong.map(|(index, line)| file.at(index + 1, line)).collect()
}

/// Printing, exiting and giving up outside the program and outside unit tests.
pub(crate) fn loud(file: &SourceFile) -> Vec<String> {
    if ["app", "main"].contains(&file.floor()) {
        return Vec::new();
    }
    let called = |line: &str, call: &str| {
        let method = call.starts_with('.');
        line.match_indices(call).any(|(start, _)| method || !ends_with_word(&line[..start]))
    };
    let wrong = file.lines().into_iter();
    let wrong = wrong.filter(|(_, line)| LOUD.iter().any(|call| called(line, call)));
    wrong.map(|(number, line)| file.at(number, line)).collect()
}

/// Files over the limit.
pub(crate) fn long(file: &SourceFile) -> Vec<String> {
    let lines = file.code.lines().count();
    let message = format!("{lines} lines, {LINE_LIMIT} at most");
    if lines < LINE_LIMIT { Vec::new() } else { vec![file.at(lines, &message)] }
}

/// How many times an error, and by which constant, a row of a table says: its first and third cell.
pub(crate) fn constant_told(row: &str) -> Option<(&str, &str)> {
    let cells: Vec<&str> = row.split('|').map(str::trim).collect();
    let [_, times, _, name, ..] = cells[..] else { return None };
    Some((times, name.strip_prefix('`')?.strip_suffix('`')?))
}

fn ends_with_word(text: &str) -> bool {
    text.chars().next_back().is_some_and(|c| c.is_alphanumeric() || c == '_')
}

/// The first names of the paths after a prefix: one, or those of a `{…}` list.
fn heads(rest: &str) -> Vec<String> {
    let word = |text: &str| -> String {
        text.trim_start().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect()
    };
    let Some(list) = rest.strip_prefix('{') else { return vec![word(rest)] };
    let mut names = vec![word(list)];
    let mut depth = 1;
    for (at, c) in list.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 1 => names.push(word(&list[at + 1..])),
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    names.retain(|name| !name.is_empty());
    names
}

#[cfg(test)]
mod tests {
    use super::*;

    fn found(rule: fn(&SourceFile) -> Vec<String>, path: &str, text: &str) -> Vec<String> {
        rule(&SourceFile::new(path, text))
    }

    #[test]
    fn upward_paths_are_found() {
        let uses = |path, text| found(upward_uses, path, text);
        assert!(uses("patch/leaf.rs", "use crate::math::Ray;\nuse crate::patch::P;").is_empty());
        assert_eq!(
            uses("patch/leaf.rs", "\nuse crate::scene::World;"),
            ["src/patch/leaf.rs:2: crate::scene"]
        );
        assert_eq!(uses("render/film.rs", "fn f() { crate::io::exr() }").len(), 1);
        assert_eq!(
            uses("math/ray.rs", "use crate::{\n    geometry::{Knots, io},\n    math::Ray,\n};"),
            ["src/math/ray.rs:1: crate::geometry"]
        );
        assert_eq!(uses("io/x.rs", "pub(in crate::app) fn f() {}").len(), 1);
        // What lib.rs re-exports is above every floor.
        assert_eq!(uses("scene/x.rs", "use crate::Hit;").len(), 1);
        assert!(uses("app/cast.rs", "use nurbray::io::npy; use crate::app::args;").is_empty());
        assert_eq!(uses("io/x.rs", "use nurbray::app;").len(), 1);
        assert!(uses("math/x.rs", "use some_crate::io; // crate::io").is_empty());
        assert!(uses("lib.rs", "pub use crate::io::X;").is_empty());
    }

    #[test]
    fn files_off_the_floors_are_found() {
        assert!(found(homeless, "lib.rs", "").is_empty());
        assert!(found(homeless, "io/exr.rs", "").is_empty());
        assert_eq!(found(homeless, "util/misc.rs", ""), ["src/util/misc.rs:1: util"]);
        assert_eq!(found(homeless, "helpers.rs", "").len(), 1);
    }

    #[test]
    fn unsafe_is_found() {
        assert!(found(unsafe_code, UNSAFE_HOME, "unsafe {}").is_empty());
        assert_eq!(
            found(unsafe_code, "math/lanes.rs", "\n  unsafe { f() }"),
            ["src/math/lanes.rs:2: unsafe { f() }"]
        );
        assert_eq!(found(unsafe_code, "lib.rs", "#![allow(unsafe_code)]").len(), 1);
        let harmless = "// unsafe\nlet unsafe_looking = \"unsafe\"; #![deny(unsafe_code)]";
        assert!(found(unsafe_code, "math/x.rs", harmless).is_empty());
    }

    #[test]
    fn printing_and_giving_up_are_found() {
        assert_eq!(found(loud, "io/x.rs", "println!(\"a\");").len(), 1);
        assert_eq!(found(loud, "io/x.rs", "std::process::exit(1)").len(), 1);
        assert_eq!(found(loud, "io/x.rs", "let out = io::stdout().lock();").len(), 1);
        for stop in [
            "x.unwrap()",
            "x.expect(\"y\")",
            "panic!()",
            "todo!()",
            "unimplemented!()",
            "_ => unreachable!()",
        ] {
            assert_eq!(found(loud, "io/x.rs", stop).len(), 1, "{stop}");
        }
        assert!(found(loud, "io/x.rs", "x.unwrap_or(1); my_stderr()").is_empty());
        assert!(found(loud, "io/x.rs", "writeln!(f, \"println!\")?; my_print!()").is_empty());
        assert!(found(loud, "app/x.rs", "println!()").is_empty());
        let tested = "fn f() {}\n#[cfg(test)]\nmod tests { fn t() { println!() } }";
        assert!(found(loud, "io/x.rs", tested).is_empty());
        let declared = "#[cfg(test)]\nmod tests;\nfn f() { panic!() }";
        assert_eq!(found(loud, "io/x.rs", declared), ["src/io/x.rs:3: fn f() { panic!() }"]);
    }

    #[test]
    fn long_files_are_found() {
        assert!(found(long, "io/x.rs", &"\n".repeat(599)).is_empty());
        assert_eq!(
            found(long, "io/x.rs", &"\n".repeat(700)),
            ["src/io/x.rs:700: 700 lines, 600 at most"]
        );
    }
}
