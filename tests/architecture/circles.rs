//! Modules of one folder that use each other in a circle.

use std::collections::{BTreeMap, BTreeSet};

use crate::source::SourceFile;

/// Names are re-exported no more often than this, one after another.
const MOST_RE_EXPORTS: usize = 10;

/// A path, from the root of the library on.
type ModulePath = Vec<String>;

/// All modules, and where names that some of them use come from: modules below them may take these
/// names from them, and others those that they re-export.
pub(crate) struct Modules<'f> {
    files: BTreeMap<ModulePath, &'f SourceFile>,
    exported: BTreeMap<ModulePath, ModulePath>,
}

impl<'f> Modules<'f> {
    /// The modules that not only tests see.
    pub(crate) fn of(files: &'f [SourceFile]) -> Self {
        let code = files.iter().filter(|file| !file.is_test);
        let files: BTreeMap<_, _> = code.map(|file| (module_of(&file.path), file)).collect();
        let mut exported = BTreeMap::new();
        for (module, file) in &files {
            let code = code_of(file);
            for tree in code.split("use ").skip(1) {
                for (path, name) in paths_of(tree) {
                    let named = [module.as_slice(), &[name]].concat();
                    let from = absolute(module, &path)
                        .unwrap_or_else(|| [module.as_slice(), &path].concat());
                    exported.insert(named, from);
                }
            }
        }
        Self { files, exported }
    }

    /// What modules of any one folder use of each other, where that leads in a circle. What a
    /// folder's own file holds does not count: it may use the modules below it, and they what it
    /// holds.
    ///
    /// # Panics
    /// If no module uses another: then the code is not understood.
    pub(crate) fn circles(&self) -> Vec<String> {
        let folders: BTreeSet<&[String]> =
            self.files.keys().filter_map(|module| Some(module.split_last()?.1)).collect();
        assert!(folders.iter().any(|folder| !self.uses(folder).is_empty()), "no uses are found");
        folders.into_iter().flat_map(|folder| self.circles_of(folder)).collect()
    }

    fn circles_of(&self, folder: &[String]) -> Vec<String> {
        let uses = self.uses(folder);
        let edges: BTreeSet<&(String, String)> = uses.keys().collect();
        let closed = uses.iter().filter(|((own, other), _)| reaches(&edges, other, own));
        closed.map(|(_, what)| what.clone()).collect()
    }

    /// Which modules of a folder use which others, with an example each.
    fn uses(&self, folder: &[String]) -> BTreeMap<(String, String), String> {
        let mut uses = BTreeMap::new();
        for (module, file) in &self.files {
            let Some(own) = below(folder, module) else { continue };
            for path in used(module, &code_of(file)) {
                let from = self.module_with(path.clone());
                let Some(other) = below(folder, &from) else { continue };
                if own != other {
                    let what = format!("{}/{} uses {}", file.folder, file.path, path.join("::"));
                    uses.insert((own.clone(), other), what);
                }
            }
        }
        uses
    }

    /// The module that an item is defined in.
    fn module_with(&self, path: ModulePath) -> ModulePath {
        let mut path = path;
        for _ in 0..MOST_RE_EXPORTS {
            let known = (0..=path.len()).rev().find(|&k| self.files.contains_key(&path[..k]));
            let known = known.unwrap_or_default();
            match path.get(..=known).and_then(|name| self.exported.get(name)) {
                Some(from) if *from != path => {
                    path = [from.as_slice(), &path[known + 1..]].concat();
                }
                _ => return path[..known].to_vec(),
            }
        }
        path
    }
}

/// The module that a file below `src/` holds, or a folder.
fn module_of(path: &str) -> ModulePath {
    let stem = path.strip_suffix(".rs").unwrap_or(path);
    let stem = stem.strip_suffix("/mod").unwrap_or(stem);
    if stem == "lib" { Vec::new() } else { stem.split('/').map(str::to_owned).collect() }
}

fn code_of(file: &SourceFile) -> String {
    file.lines().into_iter().flat_map(|(_, line)| [line, "\n"]).collect()
}

/// The child of a folder in which a module lies.
fn below(folder: &[String], module: &[String]) -> Option<String> {
    module.strip_prefix(folder)?.first().cloned()
}

/// All paths in some code that begin at the root, at the module itself, or at one above it.
fn used(module: &[String], code: &str) -> Vec<ModulePath> {
    let mut found = Vec::new();
    for head in ["crate::", "nurbray::", "super::", "self::"] {
        for (start, _) in code.match_indices(head) {
            let is_word = |c: char| c.is_alphanumeric() || c == '_' || c == ':';
            if !code[..start].chars().next_back().is_some_and(is_word) {
                let paths = paths_of(&code[start..]).into_iter();
                found.extend(paths.filter_map(|(path, _)| absolute(module, &path)));
            }
        }
    }
    found
}

/// The path from the root on; `None` for one that begins elsewhere.
fn absolute(module: &[String], path: &[String]) -> Option<ModulePath> {
    let (first, rest) = path.split_first()?;
    let from = match first.as_str() {
        "crate" | "nurbray" => &[],
        "self" => module,
        "super" => module.split_last()?.1,
        _ => return None,
    };
    match rest.first().map(String::as_str) {
        Some("super") => absolute(from, rest),
        _ => Some([from, rest].concat()),
    }
}

/// The paths of a tree, as it follows `use`, each with the name that it gives; or the one path with
/// which some code begins.
fn paths_of(code: &str) -> Vec<(ModulePath, String)> {
    let mut found = Vec::new();
    take_paths(code, Vec::new(), &mut found);
    found
}

/// Takes the paths of a tree whose branch is `path`; returns what follows the tree.
fn take_paths<'c>(
    code: &'c str,
    mut path: ModulePath,
    found: &mut Vec<(ModulePath, String)>,
) -> &'c str {
    let mut rest = code.trim_start();
    loop {
        if let Some(branches) = rest.strip_prefix('{') {
            rest = branches.trim_start();
            while !rest.is_empty() && !rest.starts_with('}') {
                let next = take_paths(rest, path.clone(), found).trim_start();
                let next = next.trim_start_matches([',', '*']).trim_start();
                if next.len() == rest.len() {
                    return rest; // no tree
                }
                rest = next;
            }
            return rest.strip_prefix('}').unwrap_or(rest);
        }
        let (word, after) = word(rest);
        if word.is_empty() {
            break;
        }
        path.push(word.to_owned());
        rest = after;
        match rest.trim_start().strip_prefix("::") {
            Some(after) => rest = after.trim_start(),
            None => break,
        }
    }
    let new = rest.trim_start().strip_prefix("as ").map(|new| word(new.trim_start()));
    let last = path.last().cloned().unwrap_or_default();
    let (name, rest) = new.map_or((last, rest), |(name, rest)| (name.to_owned(), rest));
    found.push((path, name));
    rest
}

/// The word at the start, and what follows.
fn word(code: &str) -> (&str, &str) {
    let end = code.find(|c: char| !c.is_alphanumeric() && c != '_');
    code.split_at(end.unwrap_or(code.len()))
}

/// Whether one of two modules uses the other, perhaps by way of others.
fn reaches(uses: &BTreeSet<&(String, String)>, from: &str, to: &str) -> bool {
    let (mut reached, mut waiting) = (BTreeSet::from([from]), vec![from]);
    while let Some(at) = waiting.pop() {
        if at == to {
            return true;
        }
        let next = uses.iter().filter(|(own, _)| own == at).map(|(_, other)| other.as_str());
        waiting.extend(next.filter(|&other| reached.insert(other)));
    }
    false
}

#[test]
fn trees_of_paths_are_taken_apart() {
    let joined = |code: &str| -> Vec<String> {
        let paths = paths_of(code).into_iter();
        paths.map(|(path, name)| format!("{} {name}", path.join("::"))).collect()
    };
    assert_eq!(joined("crate::a::B;"), ["crate::a::B B"]);
    let tree = "super::{\n    a::{B, c as d},\n    E,\n};\nuse x::y;";
    assert_eq!(joined(tree), ["super::a::B B", "super::a::c d", "super::E E"]);
    assert_eq!(joined("crate::a::b::<T>(c)"), ["crate::a::b b"]);
    assert_eq!(joined("crate::a::*; b"), ["crate::a a"]);
    let path = |code: &str| absolute(&["a", "b", "c"].map(str::to_owned), &paths_of(code)[0].0);
    assert_eq!(path("super::super::d::E").unwrap().join("::"), "a::d::E");
    assert_eq!(path("self::d").unwrap().join("::"), "a::b::c::d");
    assert_eq!(path("std::fmt"), None);
}

#[test]
fn circles_are_found() {
    let circles = |files: &[(&str, &str)]| {
        let files: Vec<_> = files.iter().map(|(path, text)| SourceFile::new(path, text)).collect();
        Modules::of(&files).circles()
    };
    let one_way = [
        ("a/mod.rs", "mod b; mod c; pub use c::C;"),
        ("a/b.rs", "use super::C; use crate::a::c::{D};"),
        ("a/c.rs", "#[cfg(test)]\nmod tests { use crate::a::b::B; }\n// crate::a::b"),
    ];
    assert!(circles(&one_way).is_empty());
    let both = [
        one_way[0],
        one_way[1],
        ("a/c/mod.rs", "pub(crate) use d::D; fn f() -> super::e::E {}"),
        ("a/c/d.rs", "pub struct D;"),
        ("a/e.rs", "use crate::a::b;"),
    ];
    let expected = ["src/a/b.rs uses a::C", "src/a/c/mod.rs uses a::e::E", "src/a/e.rs uses a::b"];
    assert_eq!(circles(&both), expected);
    // By names that others give, and by what their parent uses.
    let renamed = [
        ("a/mod.rs", "mod b; mod c; mod d; use d::E as F; pub use F as G;"),
        ("a/b.rs", "use crate::a::G;"),
        ("a/c.rs", "use super::b::f;"),
        ("a/d.rs", "fn f() { super::c::g() }"),
    ];
    assert_eq!(circles(&renamed).len(), 3);
}
