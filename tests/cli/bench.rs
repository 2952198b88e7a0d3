//! `nurbray bench`, on pictures of a few pixels: what it prints, not how fast it is.

use serde_json::Value;

use crate::sandbox::{Run, SPHERE, SQUARE, Sandbox};

/// Tracing takes no longer than one pass a round.
const QUICK: &str = "--size 16 --seconds 1e-6 --kernel scalar";

const RAY_SETS: [&str; 6] =
    ["primary", "single", "incoherent", "incoherent-single", "ao", "shadow"];

fn sandbox() -> Sandbox {
    Sandbox::with(&[("sphere.toml", SPHERE), ("square.json", SQUARE)])
}

fn lines(run: &Run) -> Vec<Value> {
    run.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// `--against embree`, or nothing where `NURBRAY_WITHOUT_EMBREE=1` says that it is missing.
fn embree() -> Option<&'static str> {
    let without = std::env::var_os("NURBRAY_WITHOUT_EMBREE").is_some_and(|value| value == "1");
    (!without).then_some("--against embree")
}

#[track_caller]
fn check_positive(line: &Value, keys: &[&str]) {
    for key in keys {
        assert!(line[key].as_f64().is_some_and(|number| number > 0.0), "{key} in {line}");
    }
}

#[test]
fn an_object_for_each_model_ray_set_and_kernel() {
    let all = RAY_SETS.join(",");
    let line = format!("bench sphere.toml square.json --rays {all} --json {QUICK}");
    let run = sandbox().run(&line).succeeded();
    let lines = lines(&run);
    let models = ["sphere.toml", "square.json"];
    let expected = models.iter().flat_map(|model| RAY_SETS.map(|rays| (*model, rays)));
    let found =
        lines.iter().map(|line| (line["model"].as_str().unwrap(), line["rays"].as_str().unwrap()));
    assert!(found.eq(expected), "{}", run.stdout);
    for line in &lines {
        let keys =
            ["mrays_per_s", "build_seconds", "file_seconds", "total_seconds", "bytes", "pieces"];
        check_positive(line, &keys);
        assert!(line["spread"].as_f64().unwrap() >= 0.0);
        let seconds = |key: &str| line[key].as_f64().unwrap();
        assert!(seconds("build_seconds") < seconds("file_seconds"), "{line}");
        let trace = 1e-6 * seconds("count") / seconds("mrays_per_s");
        let total = seconds("file_seconds") + trace;
        assert!((seconds("total_seconds") / total - 1.0).abs() < 1e-12, "{line}");
        assert_eq!((line["kernel"].as_str(), line["threads"].as_u64()), (Some("scalar"), Some(1)));
        assert!(line.get("rival").is_none() && line.get("ratio").is_none(), "{line}");
        assert_eq!(line.get("radius").is_some(), line["rays"] == "ao");
    }
    // The same rays, handed over in another way.
    assert_eq!(lines[0]["hits"], lines[1]["hits"]);
    assert_eq!(lines[2]["hits"], lines[3]["hits"]);
    assert_eq!(lines[0]["count"], 16 * 16);
    // One ray from each point seen; over a sphere nothing stands in its way.
    assert_eq!(lines[0]["hits"], lines[4]["count"]);
    assert_eq!((&lines[4]["hits"], &lines[5]["hits"]), (&0.into(), &0.into()));
}

#[test]
fn embree_traces_the_same_rays() {
    let Some(against) = embree() else { return };
    let sets = "--rays primary,single,ao";
    let line = format!("bench sphere.toml {against} --tolerance 1e-2,1e-4 {sets} --json {QUICK}");
    let run = sandbox().run(&line).succeeded();
    let lines = lines(&run);
    assert_eq!(lines.len(), 3 * 2);
    for (index, line) in lines.iter().enumerate() {
        let tolerance = [1e-2, 1e-4][index % 2];
        assert_eq!(line["rival"], "embree");
        assert_eq!(line["tolerance"], tolerance);
        check_positive(line, &["rival_mrays_per_s", "rival_build_seconds", "rival_bytes", "ratio"]);
        check_positive(line, &["rival_total_seconds", "rival_triangles", "rival_spread"]);
        let ratio =
            line["mrays_per_s"].as_f64().unwrap() / line["rival_mrays_per_s"].as_f64().unwrap();
        assert!((line["ratio"].as_f64().unwrap() / ratio - 1.0).abs() < 1e-12);
        let width = line["rival_width"].as_u64().unwrap();
        assert!(if line["rays"] == "single" { width == 1 } else { [1, 8, 16].contains(&width) });
        assert_eq!(line["rival_offset"].as_f64().unwrap() > 0.0, line["rays"] == "ao");
        assert_eq!(line.get("t_disagreements").is_some(), line["rays"] != "ao");
    }
    // A hundredth of the tolerance takes a hundred times the triangles, and the hits agree.
    let number = |line: usize, key: &str| lines[line][key].as_f64().unwrap();
    let more = number(1, "rival_triangles") / number(0, "rival_triangles");
    assert!((50.0..200.0).contains(&more), "{more}");
    assert_eq!(number(1, "hits"), number(1, "rival_hits"));
    assert_eq!((number(1, "hit_disagreements"), number(1, "t_disagreements")), (0.0, 0.0));
    // 12 bytes a vertex at least, and a vertex for every two triangles.
    assert!(number(1, "rival_bytes") > 6.0 * number(1, "rival_triangles"));
}

/// The inside of a pipe in light that falls into it steeply. Where triangles are the chords of a
/// concave surface, rays that leave it at flat angles lie behind them, unless they begin above.
#[test]
fn rays_that_leave_a_concave_surface_do_not_meet_it_again() {
    const PIPE: &str = r#"
[camera]
look_from = [0.3, -0.2, 6]
look_at = [0, 0, 0.5]
up = [0, 1, 0]
perspective = { fov = 25 }

[[light]]
directional = { from = [0.3, 0.2, 1], irradiance = 2 }

[[object]]
shape = { cylinder = { radius = 1, height = 1 } }
"#;
    let Some(against) = embree() else { return };
    let line = format!("bench pipe.toml {against} --tolerance 1e-3 --rays shadow --json");
    let run = Sandbox::with(&[("pipe.toml", PIPE)]);
    let run = run.run(&format!("{line} --size 64 --seconds 1e-6 --kernel scalar")).succeeded();
    let line = &lines(&run)[0];
    let [count, ours, theirs, differ] =
        ["count", "hits", "rival_hits", "hit_disagreements"].map(|key| line[key].as_u64().unwrap());
    assert!(0 < ours && ours < count / 10, "{ours} of {count}");
    assert!(theirs.abs_diff(ours) <= count / 50 && differ <= count / 50, "{ours}, {theirs}");
}

#[test]
fn tables_for_people() {
    let line = format!("bench sphere.toml square.json --threads 1,2 {QUICK}");
    let run = sandbox().run(&line).succeeded();
    let parts: Vec<&str> = run.stdout.split("\n\n").collect();
    assert_eq!(parts.len(), 2 * 4 + 1, "{}", run.stdout);
    // At the end a line for each model on each number of threads.
    let last = parts[8].lines().map(|line| line.split_whitespace().collect::<Vec<_>>());
    let last: Vec<Vec<&str>> = last.collect();
    assert!(last[0].ends_with(&["primary", "single", "incoherent", "ao"]), "{:?}", last[0]);
    let [patches, unit] = ["2", "kB"]; // a sphere is two patches
    assert_eq!((last[1][..3].to_vec(), last[1][4]), (vec!["sphere.toml", "1", patches], unit));
    assert_eq!((last.len(), last[4][..3].to_vec()), (5, vec!["square.json", "2", "1"]));
    assert!(
        last[1..]
            .iter()
            .flat_map(|row| &row[5..])
            .all(|rate| rate.parse::<f64>().is_ok_and(|r| r > 0.0))
    );
    for (part, title) in parts.iter().step_by(2).zip([
        "sphere.toml, 1 thread: 1 surface, ",
        "square.json, 1 thread: 1 surface, ",
        "sphere.toml, 2 threads: 1 surface, ",
        "square.json, 2 threads: 1 surface, ",
    ]) {
        assert!(part.starts_with(title), "{part}");
    }
    let rows: Vec<Vec<&str>> =
        parts[1].lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows[0], ["Mrays/s", "(spread)", "rays", "hits", "doubtful", "scalar"]);
    let sets = rows[1..].iter().map(|row| row[0]);
    assert!(sets.eq(["primary", "single", "incoherent", "ao"]));
    // The disc a framed sphere shows takes up 71 % of the picture: 180 of its pixels.
    assert_eq!(rows[1][1..4], ["256", "70.3", "%"]);
    // About a fifth of the diagonal of the cube around a sphere, the square root of 12:
    // leaves reach beyond the cube.
    let last = parts[0].lines().last().unwrap();
    assert!(
        last.starts_with("rays of ao are 0.6928") && last.ends_with(" long, 0.2 of the diagonal")
    );
}

#[test]
fn a_drawing_of_speed_over_tolerance() {
    let Some(against) = embree() else { return };
    let sandbox = sandbox();
    let line = format!("bench sphere.toml {against} --plot speed.svg --rays primary,ao {QUICK}");
    let run = sandbox.run(&line).succeeded();
    // The file is read once for all; what is left of each row's total is building and tracing.
    let table = run.stdout.split("\n\n").last().unwrap();
    let rows: Vec<Vec<&str>> = table.lines().map(|line| line.split("  ").collect()).collect();
    assert!(table.starts_with("from the file"), "{table}");
    assert!(
        table.contains("256 primary rays") && table.contains("nurbray's time / rival's"),
        "{table}"
    );
    assert_eq!(rows.len(), 1 + 1 + 2, "{table}");
    assert!(rows[1][0] == "nurbray scalar" && rows[2][0].ends_with("at 1e-3"), "{table}");
    let drawing = String::from_utf8(sandbox.bytes("speed.svg")).unwrap();
    assert!(drawing.starts_with("<svg"));
    for words in ["sphere.toml, primary, 1 thread", "nurbray scalar", "embree ", "1e-5", "1e-3"] {
        assert!(drawing.contains(words), "{words}");
    }
}

#[test]
fn wrong_use_is_explained() {
    let sandbox = sandbox();
    let run = |rest: &str| sandbox.run(&format!("bench sphere.toml {rest}"));
    run("--rays primry").misused("invalid value 'primry' for '--rays <LIST>'");
    let needed = "a whole number from 1 to 1024 is needed, such as 64, 1_000 or 1e3, or all";
    run("--threads 0").misused(&format!("invalid value '0' for '--threads <LIST>': {needed}"));
    let needed = "a whole number from 1 to 8192 is needed, such as 64, 1_000 or 1e3";
    run("--size 1e4").misused(&format!("invalid value '1e4' for '--size <N>': {needed}"));
    run("--against embree --tolerance 2").misused(
        "invalid value '2' for '--tolerance <LIST>': a fraction between 0 and 1 is needed, such as \
         1e-3",
    );
    run("--tolerance 1e-3").misused("the following required arguments were not provided:");
    let alone = run("--plot a.svg");
    let usage = "\n  --against <RIVAL>\n\nUsage: nurbray bench [OPTIONS] <INPUT>...\n";
    assert!(alone.stderr.contains(usage), "{}", alone.stderr);
    alone.misused("the following required arguments were not provided:");
    run("--against embree --plot speed.png")
        .failed(2, "speed.png: cannot write .png files; known is .svg");
    Sandbox::with(&[("sphere.svg", SPHERE)])
        .run("bench sphere.svg --against embree --plot sphere.svg")
        .failed(2, "\"sphere.svg\" would be overwritten: it is an input of this run");
    // Before anything is measured, with or without a rival.
    run("nothere.toml --size 1e1").failed(2, "cannot read \"nothere.toml\": there is no such file");
    sandbox.run("bench").misused("the following required arguments were not provided:");
    assert_eq!(sandbox.files(), ["sphere.toml", "square.json"]);
}

#[test]
fn a_missing_embree_is_named_with_a_remedy() {
    let sandbox = sandbox();
    let mut command = sandbox.command("bench sphere.toml --against embree");
    let run = Run::from_output(command.env("EMBREE_LIB", "./no/libembree.so").output().unwrap());
    assert_eq!((run.code, run.stdout.as_str()), (1, ""));
    assert!(run.stderr.starts_with("error: Embree cannot be loaded ("), "{}", run.stderr);
    assert!(run.stderr.contains("apt install libembree"), "{}", run.stderr);
}

/// Any library that is there and is not Embree will do.
#[cfg(target_os = "linux")]
#[test]
fn what_is_not_embree_is_named_by_its_path() {
    let sandbox = sandbox();
    let mut command = sandbox.command("bench sphere.toml --against embree");
    let run = Run::from_output(command.env("EMBREE_LIB", "libc.so.6").output().unwrap());
    run.failed(1, "libc.so.6 has no function rtcNewDevice: is it Embree 3 or 4?");
}

#[test]
fn sets_without_rays_are_said_to_be_empty() {
    let dark = format!("[[light]]\nambient = {{ radiance = 1 }}\n{SPHERE}");
    let sandbox = Sandbox::with(&[("dark.toml", &dark)]);
    let run = sandbox.run(&format!("bench dark.toml --rays primary,shadow {QUICK} --json"));
    let run = run.succeeded();
    assert_eq!(run.stderr, "warning: dark.toml: there are no shadow rays\n");
    assert_eq!(lines(&run).len(), 1);

    let run = sandbox.run(&format!("bench dark.toml --rays shadow {QUICK} --json"));
    run.failed_with_warning(
        1,
        "dark.toml: there are no shadow rays",
        "nothing was measured: there are no such rays",
    );
}
