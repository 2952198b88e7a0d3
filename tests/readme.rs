//! The README does not rot: its commands are run as a reader who pastes them would run them.
#![cfg(feature = "program")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests, and what they share")]

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use nurbray::geometry::MAX_CONTROL_POINTS;
use nurbray::geometry::construct::NetStyle;
use nurbray::io::write_rows;
use nurbray::scene::Scene;
use tempfile::TempDir;

const README: &str = include_str!("../README.md");

/// The program as the README calls it: built from a clone, or installed.
const CALLS: [&str; 2] = ["cargo run --release -- ", "nurbray "];

/// Options that make a command quick: they replace the command's own, or are added to it.
const SMALLER: [(&str, &[(&str, &str)]); 7] = [
    ("render", &[("--size", "16x12"), ("--spp", "1")]),
    ("bench", &[("--size", "16"), ("--seconds", "0.01")]),
    ("audit", &[("--rays", "2000")]),
    ("compare", &[("--size", "16x12"), ("--seconds", "0.01")]),
    ("cast", &[]),
    ("info", &[]),
    ("plot", &[]),
];

/// Options left out of `bench`: not everybody has the rival, and other tests measure with it.
const NEEDS_EMBREE: [&str; 2] = ["--against", "--tolerance"];

/// The README's longest scene: one screen.
const SCENE_LINES: usize = 24;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The fenced blocks of a language.
fn blocks(language: &str) -> Vec<String> {
    let fence = format!("```{language}\n");
    let rest = README.split(&fence).skip(1);
    rest.map(|text| text.split("```").next().unwrap().to_owned()).collect()
}

/// Every scene has a picture in `renders/`, and the README shows or links it.
#[test]
fn every_scene_of_ours_is_in_the_gallery() {
    let scenes = fs::read_dir(root().join("scenes")).unwrap();
    let paths = scenes.map(|entry| entry.unwrap().path());
    let names = paths.filter(|path| path.extension().is_some_and(|kind| kind == "toml"));
    let names: Vec<String> =
        names.map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned()).collect();
    assert!(names.len() > 30);
    for name in names {
        let files = ["png", "svg"].map(|kind| format!("renders/{name}.{kind}"));
        let shown =
            |file: &&String| root().join(file).exists() && README.contains(&format!("({file})"));
        assert!(files.iter().any(|file| shown(&file)), "{name} is not in the gallery");
    }
}

/// The scene: the block that begins by naming its file.
fn scene() -> (String, String) {
    let text = blocks("toml").into_iter().find(|text| text.starts_with("# ")).unwrap();
    let name = text.strip_prefix("# ").unwrap().split(':').next().unwrap().to_owned();
    (name, text)
}

/// Every command of the program, in blocks and in running text.
fn commands() -> Vec<Vec<String>> {
    let spans = README.replace("```", "\n").replace('\n', " ");
    let inline = spans.split('`').skip(1).step_by(2).map(str::to_owned).collect::<Vec<_>>();
    let blocks = blocks("sh")
        .into_iter()
        .flat_map(|text| text.lines().map(str::to_owned).collect::<Vec<_>>());
    blocks
        .chain(inline)
        .filter_map(|line| {
            let words = CALLS.iter().find_map(|call| line.strip_prefix(call))?;
            let words: Vec<_> = words.split_whitespace().map(str::to_owned).collect();
            (words.len() > 1).then_some(words) // `nurbray audit` alone is only its name
        })
        .collect()
}

/// The command with less to do.
fn smaller(mut words: Vec<String>) -> Vec<String> {
    let optional = |word: &String| NEEDS_EMBREE.contains(&word.as_str());
    while words[0] == "bench"
        && let Some(at) = words.iter().position(optional)
    {
        words.drain(at..at + 2);
    }
    let (_, options) = SMALLER.iter().find(|(name, _)| *name == words[0]).unwrap();
    for (option, value) in *options {
        match words.iter().position(|word| word == option) {
            Some(at) => words[at + 1] = (*value).to_owned(),
            None => words.extend([option, value].map(|word| (*word).to_owned())),
        }
    }
    words
}

/// Whether a command works here: `compare` needs a rival.
fn works_here(words: &[String]) -> bool {
    let without = std::env::var_os("NURBRAY_WITHOUT_EMBREE").is_some_and(|value| value == "1");
    words[0] != "compare" || (words.contains(&"embree".to_owned()) && !without)
}

/// A folder like the reader's: scenes, a place for pictures, the README's scene, some rays.
fn readers_folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    for name in ["scenes", "renders"] {
        fs::create_dir(at(name)).unwrap();
    }
    for entry in fs::read_dir(root().join("scenes")).unwrap() {
        let path = entry.unwrap().path();
        fs::copy(&path, at("scenes").join(path.file_name().unwrap())).unwrap();
    }
    let (name, text) = scene();
    fs::write(at(&name), text).unwrap();
    write_rows(&at("rays.npy"), &[[0.5, 0.25, 9.0, 0.0, 0.0, -1.0]]).unwrap();
    folder
}

fn run(folder: &Path, words: &[String]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_nurbray")).current_dir(folder).args(words).output().unwrap()
}

#[test]
fn the_scene_fits_on_a_screen() {
    let (name, text) = scene();
    assert!(name.ends_with(".toml"), "{name}");
    assert!(text.lines().count() <= SCENE_LINES, "{} lines", text.lines().count());
}

#[test]
fn every_command_works_as_shown() {
    let commands = commands();
    assert!(commands.len() >= 7, "only {} commands found: {commands:?}", commands.len());
    let folder = readers_folder();
    for words in commands.into_iter().filter(|words| works_here(words)) {
        let words = smaller(words);
        let output = run(folder.path(), &words);
        let errors = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "nurbray {}:\n{errors}", words.join(" "));
        assert!(!errors.contains("warning"), "nurbray {}:\n{errors}", words.join(" "));
        for option in words.windows(2).filter(|pair| pair[0] == "-o") {
            assert!(folder.path().join(&option[1]).exists(), "no {}", option[1]);
        }
    }
}

#[test]
fn every_subcommand_is_in_the_table() {
    let help = run(root(), &["--help".to_owned()]);
    let help = String::from_utf8(help.stdout).unwrap();
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = list.lines().map(|line| line.split_whitespace().next().unwrap());
    for name in names.filter(|name| *name != "help") {
        assert!(README.contains(&format!("\n| `{name}` | ")), "{name} has no row");
        assert!(SMALLER.iter().any(|(known, _)| *known == name), "{name} is not tried here");
    }
}

/// The cells of a table, row by row, without the first cell of each row.
fn cells(text: &str) -> Vec<&str> {
    let rows = text.lines().filter_map(|line| line.strip_prefix("| ")?.split_once(" | "));
    rows.map(|(_, cells)| cells).collect()
}

#[test]
fn the_report_it_shows_is_the_one_that_is_there() {
    let report = fs::read_to_string(root().join("renders/teapot-embree/report.md")).unwrap();
    let section = README.split("## Why not tessellate?").nth(1).unwrap();
    let shown = cells(section.split("\n## ").next().unwrap());
    assert!(shown.len() >= 6, "only {shown:?}");
    for row in shown {
        assert!(cells(&report).contains(&row), "{row} is not in the report");
    }
}

#[test]
fn every_file_it_points_to_exists() {
    let targets = README.split("](").skip(1).map(|text| text.split(')').next().unwrap());
    let files: Vec<PathBuf> = targets
        .filter(|target| !target.starts_with("http") && !target.starts_with('#'))
        .map(|target| root().join(target))
        .collect();
    assert!(files.len() >= 5, "only {files:?}");
    for file in files.into_iter().chain([root().join("tests/run")]) {
        assert!(file.exists(), "{} is missing", file.display());
    }
}

#[test]
fn the_sizes_it_names_are_the_limits() {
    let limits = README.split("**Sizes and budgets.**").nth(1).unwrap();
    let limits = limits.split("\n\n**").next().unwrap();
    for (shown, power, limit) in [
        ("2²⁴", 24, MAX_CONTROL_POINTS),
        ("2²⁶", 26, Scene::MAX_POINTS),
        ("2¹⁶", 16, NetStyle::MAX_POINTS),
    ] {
        assert!(limits.contains(shown) && limit == 1 << power, "{shown} is not {limit}");
    }
}

#[test]
fn the_minimum_rust_version_is_cargo_s() {
    let manifest = include_str!("../Cargo.toml");
    let version = manifest.split("rust-version = \"").nth(1).unwrap().split('"').next().unwrap();
    assert!(README.contains(&format!("({version} or later)")), "{version}");
}
