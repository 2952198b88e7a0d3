//! Source text without comments and string contents, so that every word found is code.

use std::collections::HashSet;
use std::fs;
use std::path::{Path, PathBuf};

/// The attribute of code that only tests see.
const TESTS_ONLY: &str = "#[cfg(test)]";

/// One file below `src/`, or another folder.
pub(crate) struct SourceFile {
    /// The folder.
    pub(crate) folder: String,
    /// Its path below that, with `/` between folders.
    pub(crate) path: String,
    /// Its text; comments and the insides of literals are blanked, lines kept.
    pub(crate) code: String,
    /// Whether all of it is seen by tests only.
    pub(crate) is_test: bool,
}

impl SourceFile {
    pub(crate) fn new(path: &str, text: &str) -> Self {
        Self {
            folder: "src".to_owned(),
            path: path.to_owned(),
            code: blanked(text),
            is_test: false,
        }
    }

    /// The code without what only tests see, line by line, counted from 1.
    pub(crate) fn lines(&self) -> Vec<(usize, &str)> {
        if self.is_test {
            return Vec::new();
        }
        let mut lines = Vec::new();
        let mut at = 0; // the end of what was looked at
        let mut number = 1;
        for (start, end) in test_items(&self.code) {
            lines.extend((number..).zip(self.code[at..start].lines()));
            number += self.code[at..end].matches('\n').count();
            at = end;
        }
        lines.extend((number..).zip(self.code[at..].lines()));
        lines
    }

    /// The files of the modules it declares for tests only, below `src/`.
    fn test_modules(&self) -> Vec<String> {
        let stem = self.path.strip_suffix(".rs").unwrap_or(&self.path);
        let folder = stem.strip_suffix("/mod").unwrap_or(match stem {
            "lib" | "main" => "",
            stem => stem,
        });
        let declared = test_items(&self.code).into_iter().filter_map(|(start, end)| {
            let item = self.code[start..end].strip_prefix(TESTS_ONLY)?.trim();
            let name = item.rsplit_once("mod ")?.1.strip_suffix(';')?;
            Some([format!("{folder}/{name}.rs"), format!("{folder}/{name}/mod.rs")])
        });
        declared.flatten().map(|path| path.trim_start_matches('/').to_owned()).collect()
    }

    /// The folder directly below `src/`, or the stem of a file there.
    pub(crate) fn floor(&self) -> &str {
        let first = self.path.split('/').next().unwrap_or_default();
        first.strip_suffix(".rs").unwrap_or(first)
    }

    pub(crate) fn at(&self, line: usize, what: &str) -> String {
        format!("{}/{}:{line}: {}", self.folder, self.path, what.trim())
    }
}

/// Every Rust file below a folder of the project, by name.
pub(crate) fn files_below(folder: &str) -> Vec<SourceFile> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut paths = Vec::new();
    collect(&src, &mut paths);
    paths.sort();
    let read = |path: &PathBuf| {
        let below = path.strip_prefix(&src).unwrap().to_str().unwrap().replace('\\', "/");
        let file = SourceFile::new(&below, &fs::read_to_string(path).unwrap());
        SourceFile { folder: folder.to_owned(), ..file }
    };
    let mut files: Vec<_> = paths.iter().map(read).collect();
    mark_tests(&mut files);
    files
}

/// Finds the files that only tests see: what is declared so, and what lies in its folder.
fn mark_tests(files: &mut [SourceFile]) {
    let tests: HashSet<String> = files.iter().flat_map(SourceFile::test_modules).collect();
    let folders: Vec<String> =
        tests.iter().filter_map(|path| Some(format!("{}/", path.strip_suffix(".rs")?))).collect();
    let folders: Vec<&str> =
        folders.iter().map(|folder| folder.strip_suffix("mod/").unwrap_or(folder)).collect();
    for file in files {
        let within = |folder: &&str| file.path.starts_with(folder);
        file.is_test = tests.contains(&file.path) || folders.iter().any(within);
    }
}

/// The ranges of items that only tests see, attribute included: a function or a module with all
/// it holds, a declaration up to its semicolon.
fn test_items(code: &str) -> Vec<(usize, usize)> {
    let mut items = Vec::new();
    let mut from = 0;
    while let Some(found) = code[from..].find(TESTS_ONLY) {
        let start = from + found;
        let mut depth = 0;
        let item = code[start..].char_indices().find(|&(_, c)| {
            match c {
                '(' | '[' | '{' => depth += 1,
                ')' | ']' | '}' => depth -= 1,
                _ => {}
            }
            depth == 0 && (c == '}' || c == ';')
        });
        from = item.map_or(code.len(), |(last, _)| start + last + 1);
        items.push((start, from));
    }
    items
}

fn collect(folder: &Path, paths: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            collect(&path, paths);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            paths.push(path);
        }
    }
}

/// What the scanner is inside of.
enum Inside {
    Code,
    LineComment,
    /// Block comments nest.
    BlockComment(usize),
    /// A string, with the number of `#` that close it; `None` for one with escapes.
    Text(Option<usize>),
}

/// `text` with comments and the insides of string and character literals turned to spaces.
fn blanked(text: &str) -> String {
    let chars: Vec<char> = text.chars().collect();
    let mut out = String::with_capacity(text.len());
    let mut inside = Inside::Code;
    let mut i = 0;
    while i < chars.len() {
        let (taken, kept, next) = step(&chars[i..], i.checked_sub(1).map(|j| chars[j]), inside);
        for &c in &chars[i..i + taken] {
            out.push(if kept || c == '\n' { c } else { ' ' });
        }
        (inside, i) = (next, i + taken);
    }
    out
}

/// Returns how many characters come next, whether they are code, and what follows them.
fn step(rest: &[char], before: Option<char>, inside: Inside) -> (usize, bool, Inside) {
    let starts = |text: &str| text.chars().enumerate().all(|(k, c)| rest.get(k) == Some(&c));
    match inside {
        Inside::Code if starts("//") => (2, false, Inside::LineComment),
        Inside::Code if starts("/*") => (2, false, Inside::BlockComment(1)),
        Inside::Code if starts("\"") => (1, true, Inside::Text(None)),
        Inside::Code if starts("r\"") || starts("r#") => {
            let hashes = rest[1..].iter().take_while(|&&c| c == '#').count();
            let word = before.is_some_and(|c| c.is_alphanumeric() || c == '_');
            if word || rest.get(1 + hashes) != Some(&'"') {
                return (1, true, Inside::Code); // the end of a word, or a raw identifier
            }
            (2 + hashes, true, Inside::Text(Some(hashes)))
        }
        Inside::Code if starts("'\\") => {
            // An escaped character; its own quote may be what is escaped.
            let close = rest.iter().skip(3).position(|&c| c == '\'').map_or(2, |at| at + 4);
            (close.min(rest.len()), false, Inside::Code)
        }
        Inside::Code if starts("'") && rest.get(2) == Some(&'\'') => (3, false, Inside::Code),
        Inside::Code => (1, true, Inside::Code),
        Inside::LineComment if starts("\n") => (1, false, Inside::Code),
        Inside::LineComment => (1, false, Inside::LineComment),
        Inside::BlockComment(depth) if starts("/*") => (2, false, Inside::BlockComment(depth + 1)),
        Inside::BlockComment(1) if starts("*/") => (2, false, Inside::Code),
        Inside::BlockComment(depth) if starts("*/") => (2, false, Inside::BlockComment(depth - 1)),
        Inside::BlockComment(depth) => (1, false, Inside::BlockComment(depth)),
        Inside::Text(None) if starts("\\") => (2.min(rest.len()), false, Inside::Text(None)),
        Inside::Text(None) if starts("\"") => (1, true, Inside::Code),
        Inside::Text(Some(hashes)) if starts(&format!("\"{}", "#".repeat(hashes))) => {
            (1 + hashes, true, Inside::Code)
        }
        Inside::Text(hashes) => (1, false, Inside::Text(hashes)),
    }
}

#[test]
fn comments_and_literals_are_blanked() {
    let cases = [
        ("a // crate::io\nb", "a b"),
        ("a /* x /* y */ z */ b", "a b"),
        (r#"f("unsafe \" // no", 'x')"#, r#"f(" ", )"#),
        (r##"r#"say "crate::io""# + 1"##, r##"r#" "# + 1"##),
        ("fn f<'a>(x: &'a str) {}", "fn f<'a>(x: &'a str) {}"),
        (r"('\'', '\n', '\u{2208}') // c", "( , , )"),
        ("r#type + var\"x\"", "r#type + var\" \""),
    ];
    for (text, expected) in cases {
        let code = blanked(text);
        let words: Vec<&str> = code.split_whitespace().collect();
        assert_eq!(words.join(" "), expected, "{text}");
        assert_eq!(code.chars().count(), text.chars().count(), "{text}");
        assert_eq!(code.lines().count(), text.lines().count(), "{text}");
    }
}

#[test]
fn only_what_tests_see_is_left_out() {
    let left = |text: &str| -> Vec<(usize, String)> {
        let file = SourceFile::new("io/x.rs", text);
        let lines = file.lines().into_iter().filter(|(_, line)| !line.trim().is_empty());
        lines.map(|(number, line)| (number, line.to_owned())).collect()
    };
    let declared = "a\n#[cfg(test)]\nmod tests;\nb\n";
    assert_eq!(left(declared), [(1, "a".to_owned()), (4, "b".to_owned())]);
    let inline = "a\n#[cfg(test)]\nmod tests {\n fn f(x: [u8; 2]) { '}' }\n}\nb\n";
    assert_eq!(left(inline), [(1, "a".to_owned()), (6, "b".to_owned())]);
    let function = "a\n    #[cfg(test)]\n    fn f(x: [u8; 2]) -> u8 {\n x[0] }\n    b\n";
    assert_eq!(left(function), [(1, "a".to_owned()), (5, "    b".to_owned())]);

    let mut files = [
        ("lib.rs", "#[cfg(test)]\nmod probes;\nmod io;"),
        ("probes.rs", ""),
        ("io/mod.rs", "#[cfg(test)]\nmod tests;\nmod obj;"),
        ("io/tests/mod.rs", "mod deep;"),
        ("io/tests/deep.rs", ""),
        ("io/obj.rs", "#[cfg(test)]\npub(crate) mod tests;\n#[cfg(test)]\nmod own {}"),
        ("io/obj/tests.rs", ""),
        ("io/obj/own.rs", ""),
    ]
    .map(|(path, text)| SourceFile::new(path, text));
    mark_tests(&mut files);
    let tests: Vec<&str> =
        files.iter().filter(|file| file.is_test).map(|file| file.path.as_str()).collect();
    assert_eq!(tests, ["probes.rs", "io/tests/mod.rs", "io/tests/deep.rs", "io/obj/tests.rs"]);
}
