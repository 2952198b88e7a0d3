//! `nurbray compare`: what it writes, where it writes, and what the numbers say.

use std::collections::HashMap;
use std::fs;
use std::io::Write;
use std::path::Path;

use crate::sandbox::{Run, SPHERE, Sandbox};

/// Tracing takes no longer than one pass a round.
const QUICK: &str = "--size 60x40 --seconds 1e-6";

/// Rows whose figures are times or counts of bytes: they may differ from run to run.
const VARYING: [&str; 7] = [
    "build",
    "memory",
    "million rays a second",
    "from the file to the last ray",
    "prepare",
    "trace",
    "from start to end",
];

/// Whether `NURBRAY_WITHOUT_EMBREE=1` says that Embree is missing.
fn without_embree() -> bool {
    std::env::var_os("NURBRAY_WITHOUT_EMBREE").is_some_and(|value| value == "1")
}

/// Whether POV-Ray is here; says so past the test harness if not.
fn povray() -> bool {
    let here = std::process::Command::new("povray").arg("--version").output().is_ok();
    if !here {
        let note = b"*** SKIPPED: not compared with POV-Ray, which is not installed ***\n";
        std::io::stderr().write_all(note).unwrap();
    }
    here
}

fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<_> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// The rows of a report's tables by their names. A name that begins with `…` follows the last one
/// that does not: both together are the row's name.
fn rows(report: &str) -> HashMap<String, Vec<String>> {
    let mut rows = HashMap::new();
    let mut name = String::new();
    for line in report.lines().filter(|line| line.starts_with("| ")) {
        let cells: Vec<_> = line.split('|').map(|cell| cell.trim().to_owned()).collect();
        let full = match cells[1].strip_prefix("… ") {
            Some(more) => format!("{name} … {more}"),
            None => {
                name.clone_from(&cells[1]);
                name.clone()
            }
        };
        rows.insert(full, cells[2..cells.len() - 1].to_vec());
    }
    rows
}

/// The numbers of a row, ours first if it is one.
#[track_caller]
fn numbers(rows: &HashMap<String, Vec<String>>, name: &str) -> Vec<f64> {
    let cells = rows.get(name).unwrap_or_else(|| panic!("no row {name}: {:?}", rows.keys()));
    let number = |cell: &String| cell.trim_end_matches('°').split(' ').next()?.parse().ok();
    cells.iter().filter_map(number).collect()
}

#[test]
fn a_report_against_embree() {
    if without_embree() {
        return;
    }
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE)]);
    let line = format!("compare ball.toml --against embree --tolerance 1e-2,1e-3 {QUICK} -o out");
    let run = sandbox.run(&line).succeeded();
    assert_eq!(run.stdout, "out/report.md\n");
    let made = [
        "legend.svg",
        "normal-1e-2.png",
        "normal-1e-3.png",
        "picture.png",
        "plot.svg",
        "position-1e-2.png",
        "position-1e-3.png",
        "report.md",
    ];
    assert_eq!(files(&sandbox.path("out")), made);
    for picture in made.iter().filter(|name| name.ends_with(".png")) {
        let picture = image::open(sandbox.path("out").join(picture)).unwrap();
        assert_eq!((picture.width(), picture.height()), (60, 40));
    }

    let report = String::from_utf8(sandbox.bytes("out/report.md")).unwrap();
    assert!(report.starts_with("# ball.toml: the surfaces, and triangles in their place\n"));
    assert!(
        report.contains("\nA camera that shows all of the model, 60 x 40 pixels, "),
        "{report}"
    );
    let listed = report
        .lines()
        .filter_map(|line| line.strip_prefix("- "))
        .filter(|name| name.ends_with(".png") || name.ends_with(".svg") || name.ends_with(".md"));
    let mut listed: Vec<_> = listed.collect();
    listed.sort_unstable();
    assert_eq!(listed, made);
    for name in &made[..7] {
        assert!(report.contains(&format!("({name})")), "{name} is not shown");
    }
    let rows = rows(&report);
    // A tenth of the distance takes ten times the triangles.
    let triangles = numbers(&rows, "triangles");
    assert!((8.0..12.5).contains(&(triangles[1] / triangles[0])), "{triangles:?}");
    // Chords of a sphere use most of the tolerance, and no more; our error is rounding.
    let off = numbers(&rows, "position off the tangent plane, mean");
    assert!(off[0] < 1e-15 && off[1] < 1e-2 && off[2] < 1e-3, "{off:?}");
    assert!(off[1] > 1e-3 && (7.0..14.0).contains(&(off[1] / off[2])), "{off:?}");
    // Facets are off by the angle of a cell, which falls with the square root of the tolerance.
    let facets = numbers(&rows, "normal error of the triangles, mean");
    assert!((2.5..4.0).contains(&(facets[0] / facets[1])), "{facets:?}");
    let normals = numbers(&rows, "normal error, interpolated, mean");
    assert!(normals[0] < 0.5 * facets[0] && normals[1] < 0.3 * facets[1], "{normals:?}");
    // Triangles inside a convex surface lose rays, and invent none.
    assert_eq!(numbers(&rows, "rays invented"), [0.0; 3]);
    let lost = numbers(&rows, "rays lost");
    assert!(lost[1] > 0.0 && lost[1] < 60.0 && lost[2] <= lost[1], "{lost:?}");
    assert_eq!(numbers(&rows, "silhouette pixels that differ"), lost);
    let (hits, same) =
        (numbers(&rows, "rays that hit"), numbers(&rows, "rays that hit … and see the same place"));
    assert_eq!([hits[0] - lost[1], hits[0] - lost[2]], same[..]);
}

#[test]
fn a_camera_that_sees_nothing_is_warned_of() {
    if without_embree() {
        return;
    }
    let away = format!("[camera]\nlook_from = [0, 0, 9]\nlook_at = [0, 0, 99]\n{SPHERE}");
    let sandbox = Sandbox::with(&[("away.toml", &away)]);
    let line = format!("compare away.toml --against embree --tolerance 1e-2 {QUICK} -o out");
    let run = sandbox.run(&line).succeeded();
    assert_eq!(run.stderr, "warning: away.toml: the camera sees nothing of the model\n");
    let report = String::from_utf8(sandbox.bytes("out/report.md")).unwrap();
    assert!(report.contains("\nThe scene's camera, 60 x 40 pixels, "), "{report}");
}

/// A ball on a floor so large that the tolerance is larger than the ball.
const SMALL_ON_LARGE: &str = "
[camera]
look_from = [3, -4, 2]
look_at = [0, 0, 0.5]
[[object]]
shape = { plane = { width = 1e5, height = 1e5 } }
[[object]]
shape = { sphere = { radius = 0.5 } }
transform = [{ translate = [0, 0, 0.5] }]
";

#[test]
fn reports_tell_what_a_reader_should_know_of_the_model() {
    if without_embree() {
        return;
    }
    let cube = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n\
                f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";
    let part = format!(
        "{SPHERE}[[object]]\nshape = {{ plane = {{ width = 2, height = 1 }} }}\n\
         trims = {{ loops = [{{ circle = {{ center = [0.5, 0.5], radius = 1e-7 }} }}] }}\n"
    );
    let files = [
        ("small.toml", SMALL_ON_LARGE),
        ("cube.obj", cube),
        ("ball.toml", SPHERE),
        ("part.toml", &part),
    ];
    let sandbox = Sandbox::with(&files);
    let told = |input: &str| -> Vec<String> {
        let options = format!("--against embree --tolerance 1e-2,1e-6 {QUICK} -o {input}.out");
        sandbox.run(&format!("compare {input} {options}")).succeeded();
        let report = String::from_utf8(sandbox.bytes(&format!("{input}.out/report.md"))).unwrap();
        let before = report.lines().take_while(|line| !line.starts_with("## "));
        before.filter(|line| line.starts_with("- ")).map(str::to_owned).collect()
    };
    let small = told("small.toml");
    assert!(
        small.len() == 1 && small[0].starts_with("- At 1e-2, 1 surface is smaller"),
        "{small:?}"
    );
    // Of a surface, what its trims keep.
    let part = told("part.toml");
    assert!(part.len() == 2 && part[1].starts_with("- At 1e-6, 1 surface is smaller"), "{part:?}");
    let cube = told("cube.obj");
    assert!(cube.len() == 1 && cube[0].starts_with("- 1 surface is only near what"), "{cube:?}");
    assert!(told("ball.toml").is_empty());
}

/// What is small beside the rest is not lost by POV-Ray for its constants.
#[test]
fn povray_sees_small_things_in_large_scenes() {
    if !povray() {
        return;
    }
    let sandbox = Sandbox::with(&[("small.toml", SMALL_ON_LARGE)]);
    let options = "--tolerance 1e-3 --size 120x80 --seconds 1e-6";
    sandbox.run(&format!("compare small.toml --against povray {options} -o out")).succeeded();
    let rows = rows(&String::from_utf8(sandbox.bytes("out/report.md")).unwrap());
    assert_eq!(numbers(&rows, "pixels lost"), [0.0, 0.0]);
    assert_eq!(numbers(&rows, "pixels invented"), [0.0, 0.0]);
}

#[test]
fn reports_are_the_same_but_for_times() {
    if without_embree() {
        return;
    }
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE)]);
    let line = format!("compare ball.toml --against embree --tolerance 1e-3 {QUICK}");
    sandbox.run(&format!("{line} -o a")).succeeded();
    sandbox.run(&format!("{line} -o b --threads 2")).succeeded();
    let steady = |folder: &str| -> Vec<String> {
        let report = String::from_utf8(sandbox.bytes(&format!("{folder}/report.md"))).unwrap();
        let varies =
            |line: &&str| VARYING.iter().any(|row| line.starts_with(&format!("| {row} |")));
        let lines = report.lines().filter(|line| !varies(line));
        lines.map(|line| line.replace("on 2 threads", "on 1 thread")).collect()
    };
    assert_eq!(steady("a"), steady("b"));
    for name in ["picture.png", "normal-1e-3.png", "position-1e-3.png", "legend.svg"] {
        assert_eq!(sandbox.bytes(&format!("a/{name}")), sandbox.bytes(&format!("b/{name}")));
    }
}

#[test]
fn a_failure_leaves_no_trace() {
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE)]);
    let mut command = sandbox.command("compare ball.toml --against embree -o out");
    let run = Run::from_output(command.env("EMBREE_LIB", "./no/libembree.so").output().unwrap());
    assert_eq!((run.code, run.stdout.as_str()), (1, ""));
    assert!(run.stderr.starts_with("error: Embree cannot be loaded ("), "{}", run.stderr);
    assert_eq!(sandbox.files(), ["ball.toml"]);
}

#[test]
fn wrong_use_is_explained() {
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE)]);
    let run = |rest: &str| sandbox.run(&format!("compare ball.toml {rest}"));
    run("-o out").misused("the following required arguments were not provided:");
    run("--against povray").misused("the following required arguments were not provided:");
    run("--against mesh -o out").misused("invalid value 'mesh' for '--against <RIVAL>'");
    run("--against povray -o ball.toml").failed(2, "\"ball.toml\" is a file, not a folder");
    run("--against povray -o no/out")
        .failed(2, "cannot write \"no/out\": there is no folder \"no\"");
    run("--against povray -o out --size 9000x1")
        .failed(2, "9000 x 1 pixels: a comparison has at most 8192 each way");
    run("--against povray -o out --tolerance 1e-3,0").misused(
        "invalid value '0' for '--tolerance <LIST>': a fraction between 0 and 1 is needed, such as \
         1e-3",
    );
    let needed = "a positive number of seconds up to 86400 is needed, such as 0.5";
    run("--against povray -o out --seconds 0")
        .misused(&format!("invalid value '0' for '--seconds <S>': {needed}"));
    assert_eq!(sandbox.files(), ["ball.toml"]);
}

#[test]
fn tolerances_too_fine_for_any_mesh_are_wrong_use() {
    if without_embree() {
        return;
    }
    let disk = "[[object]]\nshape = { plane = { width = 2, height = 2 } }\n\
                trims = { loops = [{ circle = { center = [0.5, 0.5], radius = 0.3 } }] }\n";
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE), ("disk.toml", disk)]);
    for input in ["ball.toml", "disk.toml"] {
        for line in [format!("compare {input} -o out"), format!("bench {input}")] {
            let line = format!("{line} --against embree --tolerance 1e-30 --seconds 1e-6");
            let run = sandbox.run(&line);
            assert_eq!((run.code, run.stdout.as_str()), (2, ""), "{}", run.stderr);
            let error = format!("error: {input}: tolerance 1e-30: a ");
            assert!(run.stderr.contains(&error), "{}", run.stderr);
            // No other tolerance was given.
            assert_eq!(run.stderr.matches("tolerance").count(), 1, "{}", run.stderr);
        }
    }
    assert_eq!(sandbox.files(), ["ball.toml", "disk.toml"]);
}

#[test]
fn a_tolerance_given_twice_is_looked_at_once() {
    if without_embree() {
        return;
    }
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE)]);
    let line = format!("compare ball.toml --against embree --tolerance 1e-3,0.001 {QUICK} -o out");
    sandbox.run(&line).succeeded();
    let report = String::from_utf8(sandbox.bytes("out/report.md")).unwrap();
    assert!(report.contains("\n| tolerance | nurbray | 1e-3 |\n"), "{report}");
}

/// A scene of a plane and a bilinear patch with unequal weights.
const SAIL: &str = "
[[object]]
name = \"table\"
shape = { plane = { width = 2, height = 2 } }

[[object]]
name = \"sail\"
[object.shape.nurbs]
degree = 1
points = [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 1]]]
weights = [[1, 1], [1, 2]]
";

#[test]
fn scenes_are_written_without_povray_and_what_is_left_out_is_named() {
    let sandbox = Sandbox::with(&[("sail.toml", SAIL)]);
    let left_out =
        "surface \"sail\" is left out: it is rational, and the patches of POV-Ray are polynomial";
    let run = |line: &str| {
        let mut command = sandbox.command(line);
        Run::from_output(command.env("POVRAY", "./no/povray").output().unwrap())
    };
    let line = format!("compare sail.toml --against povray --tolerance 1e-3,1e-5 {QUICK} -o out");
    run(&line).failed_with_warning(
        1,
        left_out,
        "cannot run ./no/povray (No such file or directory (os error 2)); install it (apt install \
         povray), or say where it is: POVRAY=/path/to/povray; its scenes are in \"out\"",
    );
    assert_eq!(files(&sandbox.path("out")), ["scene-1e-3.pov", "scene-1e-5.pov"]);
    let scene = String::from_utf8(sandbox.bytes("out/scene-1e-3.pov")).unwrap();
    assert_eq!(scene.matches("bicubic_patch").count(), 1);
    assert!(scene.contains("// table\n") && !scene.contains("sail"));

    let alone = SAIL.split_once("[[object]]").unwrap().1.split_once("[[object]]").unwrap().1;
    fs::write(sandbox.path("alone.toml"), format!("[[object]]{alone}")).unwrap();
    let message = format!("alone.toml: nothing is left to compare; {left_out}");
    run("compare alone.toml --against povray -o out").failed(2, &message);
}

#[test]
fn what_is_not_povray_is_not_taken_for_it() {
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE)]);
    let mut command =
        sandbox.command(&format!("compare ball.toml --against povray {QUICK} -o out"));
    let run = Run::from_output(command.env("POVRAY", "true").output().unwrap());
    run.failed(1, "true --version does not tell of POV-Ray 3; its scenes are in \"out\"");
}

/// A program that calls itself this version of POV-Ray, and for a scene does this.
#[cfg(unix)]
fn write_povray(sandbox: &Sandbox, version: &str, does: &str) -> std::path::PathBuf {
    use std::os::unix::fs::PermissionsExt;

    let path = sandbox.path("povray");
    let program =
        format!("#!/bin/sh\n[ \"$1\" = --version ] && exec echo POV-Ray {version}\n{does}\n");
    fs::write(&path, program).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path.canonicalize().unwrap()
}

#[cfg(unix)]
#[test]
fn an_old_povray_is_not_asked() {
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE)]);
    let povray = write_povray(&sandbox, "3.6.1", "exit 0");
    let mut command =
        sandbox.command(&format!("compare ball.toml --against povray {QUICK} -o out"));
    let run = Run::from_output(command.env("POVRAY", &povray).output().unwrap());
    let said = "is POV-Ray 3.6.1: version 3.7 or later is needed; its scenes are in \"out\"";
    run.failed(1, &format!("{} {said}", povray.display()));
}

/// What was there stays as it was if all goes well until POV-Ray fails.
#[cfg(unix)]
#[test]
fn a_rendering_that_fails_changes_nothing() {
    let sandbox = Sandbox::with(&[("ball.toml", SPHERE)]);
    fs::create_dir(sandbox.path("out")).unwrap();
    fs::write(sandbox.path("out/scene-1e-3.pov"), "older").unwrap();
    for (out, exit, message) in [
        ("out", 1, "POV-Ray fails (exit status: 1): no lamp"),
        ("new", 1, "POV-Ray fails (exit status: 1): no lamp"),
        ("new", 0, "POV-Ray makes no picture: no lamp"),
    ] {
        let povray = write_povray(&sandbox, "3.7.0", &format!("echo no lamp >&2\nexit {exit}"));
        let options = format!("--tolerance 1e-3 {QUICK} -o {out}");
        let mut command = sandbox.command(&format!("compare ball.toml --against povray {options}"));
        let run = Run::from_output(command.env("POVRAY", povray).output().unwrap());
        run.failed(1, message);
    }
    assert_eq!(files(&sandbox.path("out")), ["scene-1e-3.pov"]);
    assert_eq!(sandbox.bytes("out/scene-1e-3.pov"), b"older");
    assert!(!sandbox.path("new").exists());
}

/// Every shape POV-Ray has as a primitive, one beside the other, moved and stretched.
const PRIMITIVES: &str = "
[camera]
look_from = [3, -14, 9]
look_at = [3, 0, 0]
perspective = { fov = 32 }
[[object]]
shape = { sphere = { radius = 1 } }
transform = [{ scale = [1, 1.2, 0.7] }, { translate = [0, 3, 0] }]
[[object]]
shape = { torus = { major = 1, minor = 0.4 } }
transform = [{ rotate = { axis = \"x\", degrees = 30 } }, { translate = [3, 3, 0] }]
[[object]]
shape = { cylinder = { radius = 0.7, height = 1.5 } }
transform = [{ translate = [6, 3, 0] }]
[[object]]
shape = { cone = { radius = 1, height = 2 } }
[[object]]
shape = { disk = { radius = 1 } }
transform = [{ translate = [3, 0, 0] }]
[[object]]
shape = { hemisphere = { radius = 1 } }
transform = [{ rotate = { axis = \"z\", degrees = 200 } }, { translate = [6, 0, 0] }]
[[object]]
shape = { octant = { radius = 1.2 } }
transform = [{ translate = [-2, -2, 0] }]
[[object]]
shape = { plane = { width = 1.5, height = 1.5 } }
transform = [{ rotate = { axis = \"x\", degrees = 50 } }, { translate = [6, -3, 0] }]
";

#[test]
fn povray_sees_what_we_see() {
    if !povray() {
        return;
    }
    let parallel =
        PRIMITIVES.replace("perspective = { fov = 32 }", "orthographic = { height = 8 }");
    let sandbox = Sandbox::with(&[("all.toml", PRIMITIVES), ("parallel.toml", &parallel)]);
    for (scene, out) in [("all.toml", "a"), ("parallel.toml", "b")] {
        let options = "--tolerance 1e-3 --size 240x160 --seconds 1e-6";
        let line = format!("compare {scene} --against povray {options} -o {out}");
        let run = sandbox.run(&line).succeeded();
        assert_eq!(run.stdout, format!("{out}/report.md\n"));
        let made =
            ["difference-1e-3.png", "legend.svg", "picture.png", "report.md", "scene-1e-3.pov"];
        assert_eq!(files(&sandbox.path(out)), made);
        let rows = rows(&String::from_utf8(sandbox.bytes(&format!("{out}/report.md"))).unwrap());
        let hits = numbers(&rows, "pixels that hit");
        assert!(hits[0] > 4000.0, "{hits:?}");
        assert_eq!(numbers(&rows, "pixels lost"), [0.0, 0.0], "{scene}");
        assert_eq!(numbers(&rows, "pixels invented"), [0.0, 0.0], "{scene}");
        // Half a step of 16 bits.
        let error = numbers(&rows, "error of brightness, mean … largest");
        assert!(error[0] <= 1e-5, "{scene}: {error:?}");
    }
}
