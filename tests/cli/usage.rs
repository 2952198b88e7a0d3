//! Help, wrong use, and closed or full output.

use std::process::Stdio;

use crate::sandbox::{Run, SPHERE, SQUARE, Sandbox};

const SUBCOMMANDS: [&str; 6] = ["render", "cast", "bench", "audit", "compare", "info"];

#[test]
fn help_is_an_answer_and_lists_what_works() {
    let sandbox = Sandbox::new();
    let help = sandbox.run("--help").succeeded();
    assert_eq!(help.stderr, "");
    let listed: Vec<&str> = help
        .stdout
        .lines()
        .skip_while(|line| *line != "Commands:")
        .skip(1)
        .map_while(|line| line.split_whitespace().next())
        .collect();
    assert_eq!(listed, [&SUBCOMMANDS[..], &["help"]].concat());
    assert!(help.stdout.contains("Exit codes: 0 done, 1 failed, 2 wrong use or bad input."));
    for subcommand in SUBCOMMANDS {
        let help = sandbox.run(&format!("{subcommand} --help")).succeeded();
        assert!(help.stdout.contains(&format!("Example:\n  nurbray {subcommand} ")));
        assert!(help.stdout.lines().all(|line| line.chars().count() <= 100), "{subcommand}");
        assert_eq!(help.stderr, "");
    }
}

#[test]
fn the_version_is_an_answer() {
    let version = Sandbox::new().run("--version").succeeded();
    assert_eq!(version.stdout, format!("nurbray {}\n", env!("CARGO_PKG_VERSION")));
}

#[test]
fn wrong_use_is_explained_on_stderr() {
    let sandbox = Sandbox::new();
    let nothing = sandbox.run("");
    assert_eq!((nothing.code, nothing.stdout.as_str()), (2, ""));
    assert!(nothing.stderr.contains("Usage: nurbray <COMMAND>"));

    let typo = sandbox.run("rendr");
    assert!(typo.stderr.contains("tip: a similar subcommand exists: 'render'"));
    typo.misused("unrecognized subcommand 'rendr'");
    sandbox.run("info").misused("the following required arguments were not provided:");
    sandbox.run("info a.toml --jsn").misused("unexpected argument '--jsn' found");
    sandbox
        .run("cast a.toml --rays r.npy -o h.npy --threads 0")
        .misused("invalid value '0' for '--threads <N>': 0 is not in 1..=1024");
    sandbox.run("audit a.toml --rays -5").misused("unexpected argument '-5' found");
    sandbox
        .run("audit a.toml --rays 1e6")
        .misused("invalid value '1e6' for '--rays <N>': invalid digit found in string");
}

#[test]
fn misspelt_kernels_get_the_nearest() {
    let run = Sandbox::new().run("audit a.toml --kernel scalr");
    assert!(run.stderr.contains("tip: a similar value exists: 'scalar'"));
    run.misused("invalid value 'scalr' for '--kernel <NAME>'");
}

#[test]
fn every_subcommand_refuses_bad_input_with_the_place() {
    let wrong_knots = SQUARE.replacen("[0, 0, 1, 1]", "[0, 0, 1]", 1);
    let sandbox = Sandbox::with(&[
        ("typo.toml", "[[object]]\nshape = { spere = { radius = 1 } }\n"),
        ("wrong.json", &wrong_knots),
        ("cut.json", &SQUARE[..200]),
    ]);
    sandbox.write_rows("rays.npy", &[[0.0, 0.0, 5.0, 0.0, 0.0, -1.0]]);
    let lines = [
        "render INPUT -o a.png",
        "cast INPUT --rays rays.npy -o hits.npy",
        "bench INPUT",
        "audit INPUT",
        "compare INPUT --against embree -o report",
        "compare INPUT --against povray -o report",
        "info INPUT",
    ];
    for line in lines {
        let run = |input| sandbox.run(&line.replace("INPUT", input));
        run("none.toml").failed(2, "cannot read \"none.toml\": there is no such file");
        for (input, place, found) in [
            ("typo.toml", "typo.toml:2:11: ", "sphere"),
            ("wrong.json", "wrong.json:7:", "3 knots, but 2 points of degree 1 need 4"),
            ("cut.json", "cut.json:", "end"),
        ] {
            let run = run(input);
            assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{line}");
            assert!(run.stderr.starts_with(&format!("error: {place}")), "{}", run.stderr);
            assert!(run.stderr.contains(found), "{}", run.stderr);
            assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
        }
    }
    assert_eq!(sandbox.files(), ["cut.json", "rays.npy", "typo.toml", "wrong.json"]);
}

/// A reader may close the pipe when it has what it wants, as `head -1` does.
#[test]
fn a_closed_pipe_is_no_failure() {
    let sandbox = Sandbox::with(&[("sphere.toml", SPHERE)]);
    for line in
        ["--help", "info sphere.toml", "info sphere.toml --json", "audit sphere.toml --rays 50"]
    {
        let mut child =
            sandbox.command(line).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let run = Run::from_output(child.wait_with_output().unwrap());
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{line}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_under_stdout_is_a_failure() {
    let sandbox = Sandbox::with(&[("sphere.toml", SPHERE)]);
    let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
    let output = sandbox.command("info sphere.toml").stdout(full).output().unwrap();
    let message = "cannot write to standard output: No space left on device (os error 28)";
    Run::from_output(output).failed(1, message);
}
