//! Source text without comments and string contents, so that words are code.

use std::fs;
use std::path::{Path, PathBuf};

/// One file below `src/`.
pub(crate) struct SourceFile {
    /// Its path below `src/`, with `/` between folders.
    pub(crate) path: String,
    /// Its text; comments and the insides of literals are blanked, lines kept.
    pub(crate) code: String,
}

impl SourceFile {
    pub(crate) fn new(path: &str, text: &str) -> Self {
        Self { path: path.to_owned(), code: blanked(text) }
    }

    /// The code before its unit tests, line by line, counted from 1.
    pub(crate) fn lines(&self) -> impl Iterator<Item = (usize, &str)> {
        let end = self.code.find("#[cfg(test)]\nmod ").unwrap_or(self.code.len());
        self.code[..end].lines().enumerate().map(|(index, line)| (index + 1, line))
    }

    /// The folder directly below `src/`, or the stem of a file there.
    pub(crate) fn floor(&self) -> &str {
        let first = self.path.split('/').next().unwrap_or_default();
        first.strip_suffix(".rs").unwrap_or(first)
    }

    pub(crate) fn at(&self, line: usize, what: &str) -> String {
        format!("src/{}:{line}: {}", self.path, what.trim())
    }
}

/// Every Rust file below `src/`, by name.
pub(crate) fn library_files() -> Vec<SourceFile> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut paths = Vec::new();
    collect(&src, &mut paths);
    paths.sort();
    paths
        .iter()
        .map(|path| {
            let below = path.strip_prefix(&src).unwrap().to_str().unwrap().replace('\\', "/");
            SourceFile::new(&below, &fs::read_to_string(path).unwrap())
        })
        .collect()
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

/// How many characters come next, whether they are code, and what follows them.
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
