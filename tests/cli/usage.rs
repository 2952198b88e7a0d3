//! Help, wrong use, and closed or full output.

use std::process::Stdio;

use crate::sandbox::{Run, SPHERE, SQUARE, Sandbox};

const SUBCOMMANDS: [&str; 7] = ["render", "cast", "bench", "audit", "compare", "info", "plot"];

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
        // Every subcommand that reads models reads each kind of them.
        assert!(help.stdout.contains("(.json, .obj)"), "{subcommand}");
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
    sandbox.run("cast a.toml --rays r.npy -o h.npy --threads 0").misused(
        "invalid value '0' for '--threads <N>': a whole number from 1 to 1024 is needed, \
             such as 64, 1_000 or 1e3, or all",
    );
}

#[test]
fn slips_of_the_command_line_get_hints() {
    let sandbox = Sandbox::new();
    for (line, error, tip) in [
        (
            "scene.toml",
            "unrecognized subcommand 'scene.toml'",
            "tip: write `nurbray render scene.toml -o picture.png`",
        ),
        (
            "render a.toml out.exr",
            "unexpected argument 'out.exr' found",
            "tip: to write this file, write `-o out.exr`",
        ),
        (
            "render a.toml -o a.png --width 300",
            "unexpected argument '--width' found",
            "tip: a similar argument exists: '--size'",
        ),
        (
            "render a.toml -o a.exr --AOV Z",
            "unexpected argument '--AOV' found",
            "tip: a similar argument exists: '--aov'",
        ),
    ] {
        let run = sandbox.run(line);
        let tips: Vec<_> = run.stderr.lines().filter(|line| line.contains("tip:")).collect();
        assert_eq!(tips, [format!("  {tip}")], "{line}");
        run.misused(error);
    }
    let run = sandbox.run("info a.toml --colour");
    assert!(!run.stderr.contains("tip:"), "{}", run.stderr);
}

/// No option is a number: a word that begins like a negative number is a value, here a bad one.
#[test]
fn negative_numbers_are_values() {
    let sandbox = Sandbox::new();
    for (line, option) in [
        ("audit a.toml --rays -5", "--rays <N>"),
        ("audit a.toml --seed -1", "--seed <N>"),
        ("bench a.toml --size -3", "--size <N>"),
        ("render a.toml -o a.png --size -10x20", "--size <WxH>"),
        ("render a.toml -o a.png --spp -1.5", "--spp <N>"),
        ("cast a.toml --rays r.npy -o h.npy --threads -2", "--threads <N>"),
    ] {
        let run = sandbox.run(line);
        let value = line.rsplit(' ').next().unwrap();
        let start = format!("error: invalid value '{value}' for '{option}': ");
        assert!(run.stderr.starts_with(&start), "{line}: {}", run.stderr);
        assert!(!run.stderr.contains("tip:"), "{line}: {}", run.stderr);
        assert_eq!(run.code, 2);
    }
    let line = "render a.toml -o a.png --size --spp 3";
    sandbox.run(line).misused("a value is required for '--size <WxH>' but none was supplied");
}

/// `-` does not stand for a stream, though it may in other programs: the message says so before
/// anything else is checked.
#[test]
fn a_dash_is_no_stream() {
    let sandbox = Sandbox::with(&[("s.toml", SPHERE)]);
    sandbox.write_rows("rays.npy", &[[0.0, 0.0, 5.0, 0.0, 0.0, -1.0]]);
    let input = "cannot read \"-\": there is no such file; \"-\" does not stand for standard input: \
                 name a file";
    for line in ["render - -o a.png", "info -", "cast s.toml --rays - -o h.npy"] {
        sandbox.run(line).failed(2, input);
    }
    let output = "-: it does not stand for standard output, and no extension says how to write it; \
                  known";
    for (line, known) in [
        ("render s.toml -o -", "are .exr and .png"),
        ("plot s.toml -o -", "are .svg and .png"),
        ("cast s.toml --rays rays.npy -o -", "is .npy"),
    ] {
        sandbox.run(line).failed(2, &format!("{output} {known}"));
    }
    assert_eq!(sandbox.files(), ["rays.npy", "s.toml"]);
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
        "plot INPUT -o a.svg",
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

/// A surface has one name, whichever floor finds the fault.
#[test]
fn a_surface_has_one_name_in_all_messages() {
    let knots = SQUARE.replacen("[0, 0, 1, 1]", "[0, 1, 0, 1]", 1);
    let missing = SQUARE.replace("\"size_v\": 2,", "");
    let weights = SQUARE.replace("[1, 1, 0]] }", "[1, 1, 0]], \"weights\": [1, 1, 1, -1] }");
    let far = SQUARE.replace("[1, 1, 0]] }", "[1, 1, -1e308]] }");
    let pot = "[[object]]\nname = \"pot\"\nshape = { file = \"m.json\" }\n";
    for model in [knots, missing, weights, far] {
        let sandbox = Sandbox::with(&[("m.json", &model), ("pot.toml", pot)]);
        for (input, name) in [("m.json", "surface \"m\""), ("pot.toml", "surface \"pot\"")] {
            let run = sandbox.run(&format!("info {input}"));
            assert!(run.stderr.starts_with("error: m.json:"), "{}", run.stderr);
            assert!(run.stderr.contains(name), "{}", run.stderr);
        }
    }
}

/// The message names the surface, the control point and what would do, not the camera that
/// cannot see it.
#[test]
fn magnitudes_that_are_not_supported_are_named() {
    let far = SQUARE.replace("[1, 1, 0]", "[1, 1, -1e308]");
    let sandbox = Sandbox::with(&[("far.json", &far)]);
    sandbox.run("render far.json -o a.png").failed(
        2,
        "far.json:8:39: surface \"far\": control point (1, 1) is (1, 1, -1e308): \
         coordinates must be finite (up to 1e70)",
    );
}

/// A spline of so high a degree has many times as many Bézier points as control points; a failed
/// allocation would abort.
#[test]
fn what_no_memory_holds_is_refused() {
    let (degree, size) = (32, 400);
    let points: Vec<[usize; 3]> =
        (0..size * size).map(|k| [k / size, k % size, k * k % 7]).collect();
    let knots: Vec<usize> = (0..size + degree + 1).collect();
    let model = serde_json::json!({ "shape": { "type": "surface", "data": {
        "degree_u": degree, "degree_v": degree, "size_u": size, "size_v": size,
        "knotvector_u": knots, "knotvector_v": knots, "control_points": { "points": points },
    } } });
    let sandbox = Sandbox::with(&[("steep.json", &model.to_string())]);
    for line in ["info steep.json", "render steep.json -o a.png"] {
        sandbox
            .run(line)
            .failed(2, "steep.json: 138697729 Bézier points, but at most 134217728 can be traced");
    }
    assert_eq!(sandbox.files(), ["steep.json"]);
}

#[test]
fn windows_text_and_empty_files() {
    let sandbox = Sandbox::with(&[
        ("bom.toml", "\u{feff}[[object]]\r\nshape = \"sphere\"\r\n"),
        ("empty.toml", ""),
        ("empty.json", ""),
        ("list.json", "[]"),
    ]);
    sandbox.run("info bom.toml").succeeded();
    let hint = "there is nothing to show: the scene has no object (write an \
         [[object]], with a shape such as \"sphere\")";
    sandbox.run("info empty.toml").failed(2, &format!("empty.toml: {hint}"));
    sandbox.run("info empty.json").failed(2, "empty.json: the file is empty");
    sandbox.run("info list.json").failed(2, "list.json:1:1: found a list, needed an object");
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
    for line in ["info sphere.toml", "--help", "--version", "help info", "info --help"] {
        let full = std::fs::File::options().write(true).open("/dev/full").unwrap();
        let output = sandbox.command(line).stdout(full).output().unwrap();
        let message = "cannot write to standard output: No space left on device (os error 28)";
        Run::from_output(output).failed(1, message);
    }
}
