//! `nurbray cast`.

use std::fs;
use std::process::Output;

use crate::sandbox::{Run, SPHERE, SQUARE, Sandbox};

const NONE: f64 = f64::NAN;

fn sandbox() -> Sandbox {
    Sandbox::with(&[("sphere.toml", SPHERE), ("square.json", SQUARE)])
}

/// Equal, where NaN is equal to NaN.
fn same(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a == b || a.is_nan() && b.is_nan())
}

#[test]
fn a_row_for_every_ray() {
    let sandbox = sandbox();
    let rays = [
        [0.25, 0.5, 2.0, 0.0, 0.0, -1.0], // down on the square
        [0.25, 0.5, 2.0, 0.0, 0.0, -4.0], // t is in units of the direction
        [5.0, 5.0, 2.0, 0.0, 0.0, -1.0],  // past it
        [0.25, 0.5, -1.0, 0.0, 0.0, 0.5], // from below: the normal is not turned
        [0.25, 0.5, 2.0, 0.0, 0.0, 1.0],  // away from it
    ];
    sandbox.write_rows("rays.npy", &rays);
    let run = sandbox.run("cast square.json --rays rays.npy -o hits.npy").succeeded();
    assert!(run.stdout.starts_with("5 rays, 3 hits, 0 doubtful; "), "{}", run.stdout);
    assert_eq!(run.stderr, "");

    let hits = sandbox.table("hits.npy", 11);
    // t, surface, u, v, x, y, z, nx, ny, nz, flags
    let miss = [NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, NONE, 0.0];
    let hit = |t: f64| [t, 0.0, 0.25, 0.5, 0.25, 0.5, 0.0, 0.0, 0.0, 1.0, 0.0];
    let expected = [hit(2.0), hit(0.5), miss, hit(2.0), miss];
    assert_eq!(hits.row_count(), 5);
    // u, v and the point to the last digit but one.
    let rounded = |row: &[f64]| row.iter().map(|x| (x * 2f64.powi(50)).round()).collect::<Vec<_>>();
    for (row, expected) in hits.rows().zip(expected) {
        assert!(same(&rounded(row), &rounded(&expected)), "{row:?} {expected:?}");
        assert!(same(&row[..2], &expected[..2]), "{row:?} {expected:?}");
    }
}

#[test]
fn ranges_are_open_and_kept() {
    let sandbox = sandbox();
    let ray = |t_min, t_max| [0.25, 0.5, 2.0, 0.0, 0.0, -1.0, t_min, t_max];
    let rays = [
        ray(0.0, f64::INFINITY),
        ray(1.9, 2.1),
        ray(2.1, 9.0),
        ray(0.0, 1.9),
        ray(f64::NEG_INFINITY, f64::INFINITY),
    ];
    sandbox.write_rows("rays.npy", &rays);
    sandbox.run("cast square.json --rays rays.npy -o hits.npy").succeeded();
    let hits = sandbox.table("hits.npy", 11);
    let t: Vec<f64> = hits.rows().map(|row| row[0]).collect();
    assert!(same(&t, &[2.0, 2.0, NONE, NONE, 2.0]), "{t:?}");
}

#[test]
fn all_hits_by_ray_and_then_by_t() {
    let sandbox = sandbox();
    let rays = [
        [-3.0, 0.1, 0.2, 1.0, 0.0, 0.0], // through the sphere
        [-3.0, 5.0, 0.2, 1.0, 0.0, 0.0], // past it: no row
        [0.0, 0.1, 0.2, -2.0, 0.0, 0.0], // from inside
    ];
    sandbox.write_rows("rays.npy", &rays);
    let run = sandbox.run("cast sphere.toml --rays rays.npy -o hits.npy --all --json").succeeded();
    assert_eq!(run.json()["hits"], 3);
    let hits = sandbox.table("hits.npy", 12);
    let x = (1.0 - 0.1_f64 * 0.1 - 0.2 * 0.2).sqrt();
    let expected = [(0.0, 3.0 - x, -x), (0.0, 3.0 + x, x), (2.0, 0.5 * x, -x)];
    assert_eq!(hits.row_count(), 3);
    for (row, (ray, t, x)) in hits.rows().zip(expected) {
        assert_eq!((row[0], row[2], row[11]), (ray, 0.0, 0.0), "{row:?}");
        assert!((row[1] - t).abs() < 2e-15 && (row[5] - x).abs() < 2e-15, "{row:?}");
        let normal = [row[8], row[9], row[10]];
        for (n, p) in normal.iter().zip([x, 0.1, 0.2]) {
            assert!((n - p).abs() < 4e-15, "{row:?}"); // outward
        }
    }
}

#[test]
fn borders_are_marked() {
    let sandbox = sandbox();
    sandbox.write_rows(
        "rays.npy",
        &[[0.0, 0.5, 2.0, 0.0, 0.0, -1.0], [0.5, 0.5, 2.0, 0.0, 0.0, -1.0]],
    );
    sandbox.run("cast square.json --rays rays.npy -o hits.npy").succeeded();
    let hits = sandbox.table("hits.npy", 11);
    let flags: Vec<f64> = hits.rows().map(|row| row[10]).collect();
    assert_eq!(flags, [2.0, 0.0]);
}

/// The number of threads changes no bit. Packets and kernels round in their own ways, and may
/// differ by as much as the promised error of a hit.
#[test]
fn hits_are_reproducible() {
    let sandbox = sandbox();
    let rays: Vec<[f64; 6]> = (0..10_000)
        .map(|k| {
            let (a, b) = (0.37 * f64::from(k), 0.011 * f64::from(k));
            [3.0 * a.cos(), 3.0 * a.sin(), b.sin(), -a.cos(), -a.sin(), 0.3 * b.cos()]
        })
        .collect();
    sandbox.write_rows("rays.npy", &rays);
    for (name, options) in [
        ("1", "--threads 1"),
        ("2", "--threads 2"),
        ("3", "--threads 3"),
        ("4", "--threads 1 --coherent"),
        ("5", "--threads 3 --coherent"),
        ("6", "--threads 3 --kernel scalar"),
    ] {
        sandbox
            .run(&format!("cast sphere.toml --rays rays.npy -o {name}.npy {options}"))
            .succeeded();
        sandbox
            .run(&format!("cast sphere.toml --rays rays.npy -o all{name}.npy --all {options}"))
            .succeeded();
    }
    for (a, b) in [("1", "2"), ("1", "3"), ("4", "5")] {
        for all in ["", "all"] {
            let bytes = |name: &str| sandbox.bytes(&format!("{all}{name}.npy"));
            assert!(bytes(a) == bytes(b), "{all} {a} {b}");
        }
    }
    let table = |name: &str| sandbox.table(name, 11);
    let scalar = table("6.npy");
    for name in ["1.npy", "4.npy"] {
        for (row, other) in table(name).rows().zip(scalar.rows()) {
            assert_eq!(row[0].is_nan(), other[0].is_nan(), "{row:?} {other:?}");
            if !row[0].is_nan() {
                let outward: f64 = (0..3).map(|k| row[4 + k] * row[7 + k]).sum();
                assert!((outward - 1.0).abs() < 1e-14, "{row:?}"); // of a unit sphere
                // Points are on both surface and ray to about 40 ε · 3; rays here graze at
                // |N·d| > 1e-4, which makes the error of t that much larger.
                assert!((row[0] - other[0]).abs() < 1e-10, "{row:?} {other:?}");
                assert_eq!((row[1], row[10]), (other[1], other[10]));
            }
        }
    }
}

#[test]
fn json_has_the_counts_and_times() {
    let sandbox = sandbox();
    sandbox.write_rows("rays.npy", &[[0.25, 0.5, 2.0, 0.0, 0.0, -1.0]; 3]);
    let run =
        sandbox.run("cast square.json --rays rays.npy -o h.npy --json --threads 2").succeeded();
    let json = run.json();
    let mut keys: Vec<&String> = json.as_object().unwrap().keys().collect();
    keys.sort();
    let expected = [
        "build_seconds",
        "bytes",
        "doubtful",
        "hits",
        "kernel",
        "rays",
        "threads",
        "trace_seconds",
    ];
    assert_eq!(keys, expected);
    assert_eq!((json["rays"].as_u64(), json["hits"].as_u64()), (Some(3), Some(3)));
    assert_eq!(
        (json["threads"].as_u64(), json["kernel"].as_str()),
        (Some(2), Some(nurbray::intersect::Kernel::default().name()))
    );
    assert!(json["bytes"].as_u64().unwrap() > 0 && json["build_seconds"].as_f64().unwrap() > 0.0);
}

/// `nurbray cast … -o /dev/stdout | reader`: what the reader gets is a NumPy file and nothing else.
#[cfg(target_os = "linux")]
#[test]
fn hits_go_down_a_pipe_alone() {
    let sandbox = sandbox();
    sandbox.write_rows("rays.npy", &[[0.25, 0.5, 2.0, 0.0, 0.0, -1.0]; 3]);
    sandbox.run("cast square.json --rays rays.npy -o hits.npy").succeeded();
    let output = sandbox.command("cast square.json --rays rays.npy -o /dev/stdout").output();
    let output = output.unwrap();
    assert!(output.stdout == sandbox.bytes("hits.npy"));
    let run = Run::from_output(Output { stdout: Vec::new(), ..output }).succeeded();
    assert!(run.stderr.starts_with("3 rays, 3 hits, 0 doubtful; "), "{}", run.stderr);
    let refused =
        "\"/dev/stdout\" is standard output, where the results are printed: write to another file";
    for line in [
        "cast square.json --rays rays.npy -o /dev/stdout --json",
        "audit square.json --rays 50 --offenders /dev/stdout",
        "bench square.json --against embree --plot /dev/stdout",
    ] {
        sandbox.run(line).failed(2, refused);
    }
    sandbox.run("cast square.json --rays rays.npy -o /dev/null --json").succeeded();

    // A file that the results are printed into would be replaced, and they with it.
    let printed = std::fs::File::create(sandbox.path("both.npy")).unwrap();
    let mut command = sandbox.command("cast square.json --rays rays.npy -o both.npy --json");
    let output = command.stdout(printed).output().unwrap();
    Run::from_output(output).failed(2, &refused.replace("/dev/stdout", "both.npy"));
}

#[test]
fn quiet_says_nothing() {
    let sandbox = sandbox();
    sandbox.write_rows("rays.npy", &[[0.25, 0.5, 2.0, 0.0, 0.0, -1.0]]);
    for quiet in ["--quiet", "-q"] {
        let line = format!("cast square.json --rays rays.npy -o hits.npy {quiet}");
        let run = sandbox.run(&line).succeeded();
        assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
        let run = sandbox.run(&format!("{line} --json")).succeeded();
        assert!(run.stdout.starts_with('{'), "{}", run.stdout);
    }
}

#[test]
fn no_rays_have_no_hits() {
    let sandbox = sandbox();
    sandbox.write_rows::<6>("rays.npy", &[]);
    sandbox.run("cast square.json --rays rays.npy -o hits.npy").succeeded();
    assert_eq!(sandbox.table("hits.npy", 11).row_count(), 0);
}

#[test]
fn rows_that_are_no_rays_are_named() {
    let sandbox = sandbox();
    let good = [0.0, 0.0, 2.0, 0.0, 0.0, -1.0];
    for (bad, error) in [
        (
            [0.0, f64::NAN, 2.0, 0.0, 0.0, -1.0],
            "the origin is (0, NaN, 2): coordinates must be finite (up to 1e150)",
        ),
        (
            [0.0, 0.0, 2.0, 0.0, 0.0, f64::INFINITY],
            "the direction is (0, 0, inf): it must be finite, its largest component from 1e-150 to 1e150",
        ),
        (
            [0.0, 0.0, 2.0, 0.0, 0.0, 1e-310],
            "the direction is (0, 0, 1e-310): it must be finite, its largest component from 1e-150 to 1e150",
        ),
        ([0.0; 6], "the direction is zero: a ray needs one that points somewhere"),
    ] {
        sandbox.write_rows("rays.npy", &[good, good, bad]);
        let message = format!("rays.npy: row 2, counted from 0: {error}");
        sandbox.run("cast square.json --rays rays.npy -o hits.npy").failed(2, &message);
    }
    let range = |t_min, t_max| [0.0, 0.0, 2.0, 0.0, 0.0, -1.0, t_min, t_max];
    sandbox.write_rows("rays.npy", &[range(3.0, 1.0)]);
    let message = "rays.npy: row 0, counted from 0: t_min 3 and t_max 1: a ray needs t_min < t_max";
    sandbox.run("cast square.json --rays rays.npy -o hits.npy").failed(2, message);
    assert!(!sandbox.has("hits.npy"));
}

#[test]
fn files_that_hold_no_rays_are_refused() {
    let sandbox = sandbox();
    let line = "cast square.json --rays rays.npy -o hits.npy";
    let run = sandbox.run(line);
    assert!(
        run.stderr.starts_with("error: cannot read \"rays.npy\": there is no such file"),
        "{}",
        run.stderr
    );
    assert_eq!((run.code, run.stderr.lines().count()), (2, 1));

    sandbox.write_rows("rays.npy", &[[1.0; 7]]);
    let run = sandbox.run(line);
    assert!(run.stderr.starts_with("error: rays.npy: found an array of shape (1, 7), needed "));
    assert_eq!(run.code, 2);

    fs::write(sandbox.path("rays.npy"), "origin,direction").unwrap();
    let run = sandbox.run(line);
    assert!(run.stderr.starts_with("error: rays.npy: not a NumPy .npy file: "), "{}", run.stderr);
    assert_eq!(run.code, 2);

    sandbox.write_rows("whole.npy", &[[0.0, 0.0, 2.0, 0.0, 0.0, -1.0]; 4]);
    let whole = sandbox.bytes("whole.npy");
    fs::write(sandbox.path("rays.npy"), &whole[..whole.len() - 8]).unwrap();
    let message = "rays.npy: found 184 bytes of data, needed 192: the file is cut short";
    sandbox.run(line).failed(2, message);
    assert!(!sandbox.has("hits.npy"));
}

#[test]
fn inputs_are_not_overwritten_and_older_hits_survive_a_failure() {
    let sandbox = sandbox();
    sandbox.write_rows("rays.npy", &[[0.0; 6]]);
    sandbox
        .run("cast square.json --rays rays.npy -o ./rays.npy")
        .failed(2, "\"./rays.npy\" would be overwritten: it is an input of this run");
    sandbox
        .run("cast square.json --rays rays.npy -o no/hits.npy")
        .failed(2, "cannot write \"no/hits.npy\": there is no folder \"no\"");
    sandbox
        .run("cast square.json --rays rays.npy -o hits.csv")
        .failed(2, "hits.csv: cannot write .csv files; known is .npy");
    sandbox
        .run("cast square.json --rays rays.npy -o hits.npy/")
        .failed(2, "cannot write \"hits.npy/\": it does not name a file");
    fs::write(sandbox.path("hits.npy"), "older").unwrap();
    assert_eq!(sandbox.run("cast square.json --rays rays.npy -o hits.npy").code, 2);
    assert_eq!(sandbox.bytes("hits.npy"), b"older");
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_failure_and_no_wrong_use() {
    let sandbox = sandbox();
    sandbox.write_rows("rays.npy", &[[0.25, 0.5, 2.0, 0.0, 0.0, -1.0]; 10_000]);
    let error = "cannot write \"/dev/full\": No space left on device (os error 28)";
    sandbox.run("cast square.json --rays rays.npy -o /dev/full").failed(1, error);
}
