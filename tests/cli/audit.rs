//! `nurbray audit`.

use crate::sandbox::{SPHERE, SQUARE, Sandbox, TRIMMED};

fn sandbox() -> Sandbox {
    Sandbox::with(&[("sphere.toml", SPHERE), ("square.json", SQUARE)])
}

#[test]
fn a_row_for_each_class_and_one_for_all() {
    let line = "audit sphere.toml --rays 2e3 --seed 7 --kernel portable";
    let run = sandbox().run(line).succeeded();
    let (settings, table) = run.stdout.split_once("\n\n").unwrap();
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let workers = if threads == 1 { "1 thread".to_owned() } else { format!("{threads} threads") };
    assert_eq!(settings, format!("2000 rays, seed 7, kernel portable, {workers}"));
    let rows: Vec<Vec<&str>> =
        table.lines().map(|line| line.split_whitespace().collect()).collect();
    assert_eq!(rows[0][..6], ["class", "rays", "hits", "misses", "wrong", "false"]);
    let total = rows.iter().find(|row| row.first() == Some(&"total")).unwrap();
    assert_eq!((total[1], &total[3..6]), ("2000", &["0", "0", "0"][..]));
    let classes: Vec<&str> = rows[1..].iter().map_while(|row| row.first().copied()).collect();
    assert_eq!(classes.len(), 26, "{classes:?}"); // 25 classes and the total
    assert!(run.stdout.contains("\nno unflagged miss, no wrong root, no false hit\ndoubtful: "));
    // Every ray, and every doubtful ray, is of one of three kinds, and the shares are of these.
    let (_, summary) = run.stdout.rsplit_once("\ndoubtful: ").unwrap();
    let (summary, of_any) = summary.split_once("\ndoubtful whether anything is hit: ").unwrap();
    let kinds = ["random or aimed", "nasty", "exactly tangent or starting on a surface"];
    let mut sums = [0, 0];
    for (part, kind) in summary.trim_end().split(", ").zip(kinds) {
        let (doubtful, rest) = part.split_once(" of ").unwrap();
        let (rays, rest) = rest.split_once(' ').unwrap();
        let [doubtful, rays] = [doubtful, rays].map(|count| count.parse::<u32>().unwrap());
        let share = 100.0 * f64::from(doubtful) / f64::from(rays);
        assert_eq!(rest, format!("{kind} ({share:.2} %)"));
        sums = [sums[0] + doubtful, sums[1] + rays];
    }
    assert_eq!(sums.map(|sum| sum.to_string()), [total[6], total[1]]);
    // A ray may certainly hit something though its first hit is doubtful.
    let (doubtful, rays) = of_any.trim_end().split_once(" of ").unwrap();
    assert!((1..=sums[0]).contains(&doubtful.parse().unwrap()), "{doubtful}, {sums:?}");
    assert_eq!(rays, total[1]);
}

#[test]
fn json_has_the_same_classes_on_any_day() {
    let sandbox = sandbox();
    let [a, b, other] = ["5", "5", "6"].map(|seed| {
        let line = format!("audit square.json --rays 1500 --seed {seed} --json");
        sandbox.run(&line).succeeded().json()
    });
    assert_eq!(a["classes"], b["classes"]);
    assert_ne!(a["classes"], other["classes"]);
    assert_eq!((a["rays"].as_u64(), a["seed"].as_u64()), (Some(1500), Some(5)));
    assert_eq!(
        (a["input"].as_str(), a["kernel"].as_str()),
        (Some("square.json"), Some(nurbray::intersect::Kernel::default().name()))
    );
    for key in ["threads", "seconds"] {
        assert!(a[key].as_f64().unwrap() > 0.0, "{key}");
    }

    let classes = a["classes"].as_array().unwrap();
    assert!(classes.iter().all(|class| class["class"] != "poles")); // a square has none
    let keys = [
        "rays",
        "hits",
        "misses",
        "wrong_roots",
        "false_hits",
        "doubtful",
        "undecided",
        "error_50",
        "error_99",
        "error_max",
        "error_doubtful",
    ];
    for row in classes.iter().chain([&a["total"]]) {
        assert!(keys.iter().all(|key| row.get(key).is_some()), "{row}");
    }
    let rays: u64 = classes.iter().map(|class| class["rays"].as_u64().unwrap()).sum();
    assert_eq!(Some(rays), a["total"]["rays"].as_u64());
    assert!(a["total"]["error_max"].as_f64().unwrap() < 1e-13);

    // Whether a ray that starts on a surface meets it there cannot be decided.
    let [random, nasty, apart] = [0, 1, 2].map(|k| &a["groups"][k]);
    assert_eq!(apart["group"], "apart");
    assert_eq!((random["group"].as_str(), random["doubtful"].as_u64()), (Some("random"), Some(0)));
    let doubtful = |group: &serde_json::Value| group["doubtful"].as_f64().unwrap();
    let share = |group| doubtful(group) / group["rays"].as_f64().unwrap();
    assert!(share(apart) > 0.5 && share(nasty) < 0.1, "{apart} {nasty}");
}

#[test]
fn without_offenders_their_file_has_no_rows_and_can_be_cast() {
    let sandbox = sandbox();
    sandbox.run("audit sphere.toml --rays 500 --offenders bad.npy").succeeded();
    assert_eq!(sandbox.table("bad.npy", 8).row_count(), 0);
    sandbox.run("cast sphere.toml --rays bad.npy -o hits.npy").succeeded();
}

#[test]
fn wrong_outputs_are_refused_first() {
    let sandbox = sandbox();
    sandbox
        .run("audit none.toml --offenders no/bad.npy")
        .failed(2, "cannot write \"no/bad.npy\": there is no folder \"no\"");
    sandbox
        .run("audit sphere.toml --offenders bad.csv")
        .failed(2, "bad.csv: cannot write .csv files; known is .npy");
    sandbox.run("audit sphere.toml --rays 0").misused(
        "invalid value '0' for '--rays <N>': a whole number from 1 to 1000000000 is needed, \
             such as 64, 1_000 or 1e3",
    );
    assert_eq!(sandbox.bytes("sphere.toml"), SPHERE.as_bytes());
}

#[test]
fn trim_edges_are_a_class_of_their_own() {
    let sandbox = Sandbox::with(&[("sheet.toml", TRIMMED)]);
    let json = sandbox.run("audit sheet.toml --rays 5e3 --json").succeeded().json();
    let classes = json["classes"].as_array().unwrap();
    let edges = classes.iter().find(|class| class["class"] == "trim-edges").unwrap();
    // An edge belongs to what is kept.
    assert!(edges["rays"].as_u64().unwrap() > 200 && edges["hits"] == edges["rays"], "{edges}");
    assert_eq!(json["total"]["misses"], 0);
}
