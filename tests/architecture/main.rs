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

/// The account of errors names constants and their values; each of them is in use.
#[test]
fn the_account_of_errors_has_the_values_in_use() {
    let account = include_str!("../../src/intersect/errors.md");
    let files = source::files_below("src");
    let is_used = |name: &str, value: f64| {
        let start = format!("const {name}: f64 = ");
        let is_it = |line: &str| {
            let (_, given) = line.split_once(&start)?;
            Some(given.strip_suffix(';')?.parse::<f64>().ok()? == value)
        };
        let of_hits = |file: &&SourceFile| ["intersect", "patch"].contains(&file.floor());
        let lines = files.iter().filter(of_hits).flat_map(|file| file.code.lines());
        lines.filter_map(is_it).any(|is_equal| is_equal)
    };
    let told: Vec<(&str, &str)> = account.lines().filter_map(rules::constant_told).collect();
    assert!(told.len() > 10, "{told:?}");
    let wrong = told.into_iter().filter(|&(times, name)| {
        let (over, under) = times.split_once('/').unwrap_or((times, "1"));
        !is_used(name, over.parse::<f64>().unwrap() / under.parse::<f64>().unwrap())
    });
    let wrong: Vec<String> = wrong.map(|(times, name)| format!("{name} is not {times}")).collect();
    expect_none("the account of errors is wrong", &wrong);
}

#[test]
fn files_are_short() {
    let tests = source::files_below("tests");
    let wrong = tests.iter().flat_map(rules::long).chain(violations(rules::long));
    expect_none("split these files", &wrong.collect::<Vec<_>>());
}
