//! The house rules a compiler does not know: data flows one way, `unsafe` has one home, the
//! library is silent, a file is one idea.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests, and what they share")]

mod circles;
mod rules;
mod source;

use circles::Modules;
use source::SourceFile;

/// Fails with one line a violation.
fn expect_none(rule: &str, wrong: &[String]) {
    assert!(wrong.is_empty(), "{rule}:\n  {}", wrong.join("\n  "));
}

fn violations(rule: impl Fn(&SourceFile) -> Vec<String>) -> Vec<String> {
    let files = source::files_below("src");
    assert!(files.len() > 10, "only {} files found: is this the right folder?", files.len());
    files.iter().flat_map(rule).collect()
}

#[test]
fn no_floor_uses_one_above_it() {
    expect_none("a floor reaches upwards", &violations(rules::upward_uses));
}

/// In each folder, too, no two modules use each other, not even by way of others.
#[test]
fn no_folder_has_circles() {
    let files = source::files_below("src");
    expect_none("these use each other in a circle", &Modules::of(&files).circles());
}

#[test]
fn every_file_stands_on_a_floor() {
    expect_none("not on any floor", &violations(rules::homeless));
}

#[test]
fn unsafe_code_has_one_home() {
    expect_none("unsafe outside its one file", &violations(rules::unsafe_code));
}

#[test]
fn the_library_never_prints_exits_or_gives_up() {
    expect_none("the library speaks or stops", &violations(rules::loud));
}

#[test]
fn files_are_short() {
    let tests = source::files_below("tests");
    let wrong = tests.iter().flat_map(rules::long).chain(violations(rules::long));
    expect_none("split these files", &wrong.collect::<Vec<_>>());
}
