//! `nurbray render`.

use exr::prelude::read_first_flat_layer_from_file;

use crate::sandbox::{SPHERE, SQUARE, Sandbox, turned_square};

fn sandbox() -> Sandbox {
    Sandbox::with(&[("sphere.toml", SPHERE)])
}

fn channels(sandbox: &Sandbox, name: &str) -> Vec<String> {
    let image = read_first_flat_layer_from_file(sandbox.path(name)).unwrap();
    let list = image.layer_data.channel_data.list;
    list.iter().map(|channel| channel.name.to_string()).collect()
}

/// Width and height, as the header chunk of a PNG says.
fn png_size(bytes: &[u8]) -> (u32, u32) {
    let number = |at: usize| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap());
    (number(16), number(20))
}

#[test]
fn writes_every_picture_asked_for_and_a_summary() {
    let sandbox = sandbox();
    let run = sandbox.run("render sphere.toml -o a.exr -o b.PNG").succeeded();
    assert_eq!(run.stdout, "");
    assert_eq!(sandbox.files(), ["a.exr", "b.PNG", "sphere.toml"]);
    assert_eq!(png_size(&sandbox.bytes("b.PNG")), (24, 16));
    assert_eq!(sandbox.bytes("a.exr")[..4], [0x76, 0x2f, 0x31, 0x01]);

    let summary: Vec<&str> = run.stderr.trim_end().split(", ").collect();
    assert_eq!(summary[..2], ["24x16", "2 spp"], "{}", run.stderr);
    assert!(summary[2].ends_with(" s") && summary[3].ends_with(" Mrays/s"), "{}", run.stderr);
    assert!(summary[4].contains("doubtful of"), "{}", run.stderr);
    assert!(run.stderr.ends_with("; wrote a.exr and b.PNG\n"), "{}", run.stderr);
    assert_eq!(run.stderr.lines().count(), 1, "{}", run.stderr);
}

#[test]
fn quiet_says_nothing() {
    let run = sandbox().run("render sphere.toml -o a.png --quiet").succeeded();
    assert_eq!((run.stdout.as_str(), run.stderr.as_str()), ("", ""));
}

#[test]
fn a_camera_that_looks_away_warns_but_not_of_crops() {
    let away = format!("[camera]\nlook_from = [0, -9, 0]\nlook_at = [0, -20, 0]\n{SPHERE}");
    let sandbox = Sandbox::with(&[("away.toml", &away), ("sphere.toml", SPHERE)]);
    let run = sandbox.run("render away.toml -o a.png --quiet").succeeded();
    assert_eq!(run.stderr, "warning: away.toml: the camera sees nothing of the model\n");
    for part in ["away.toml -o a.png --crop 0,0,4,4", "sphere.toml -o a.png --crop 0,0,1,1"] {
        let run = sandbox.run(&format!("render {part} --quiet")).succeeded();
        assert_eq!(run.stderr, "");
    }
}

#[test]
fn an_exr_holds_the_aovs_asked_for_and_tells_how_it_was_made() {
    let sandbox = sandbox();
    sandbox.run("render sphere.toml -o all.exr").succeeded();
    let mut all = channels(&sandbox, "all.exr");
    all.sort();
    let mut expected: Vec<&str> =
        "R G B A Z P.X P.Y P.Z N.X N.Y N.Z uv.U uv.V Albedo.R Albedo.G Albedo.B id"
            .split(' ')
            .collect();
    expected.sort_unstable();
    assert_eq!(all, expected);

    sandbox.run("render sphere.toml -o some.exr --aov z,id --seed 7").succeeded();
    assert_eq!(channels(&sandbox, "some.exr"), ["A", "B", "G", "R", "Z", "id"]);
    let told = String::from_utf8_lossy(&sandbox.bytes("some.exr")).into_owned();
    assert!(told.contains("nurbray render sphere.toml -o some.exr --aov z,id --seed 7"));

    let background = |name: &str| {
        let image = read_first_flat_layer_from_file(sandbox.path(name)).unwrap();
        let name = exr::prelude::Text::from("nurbray:background");
        format!("{:?}", image.layer_data.attributes.other.get(&name))
    };
    assert!(background("some.exr").contains("0.32,0.38,0.45"), "{}", background("some.exr"));
    sandbox.run("render sphere.toml -o id.exr --integrator id").succeeded();
    assert!(background("id.exr").contains("0,0,0"), "{}", background("id.exr"));

    sandbox.run("render sphere.toml -o none.exr --aov none").succeeded();
    assert_eq!(channels(&sandbox, "none.exr"), ["A", "B", "G", "R"]);
}

#[test]
fn a_png_that_cannot_hold_what_is_asked_for_warns() {
    let sandbox = sandbox();
    let run = sandbox.run("render sphere.toml -o a.png --aov Z,N --quiet").succeeded();
    let warning = "warning: a.png: a PNG holds colour only, Z,N will be in no file; \
                   -o with an .exr holds them\n";
    assert_eq!(run.stderr, warning);
    let both = sandbox.run("render sphere.toml -o a.png -o a.exr --aov Z,N --quiet").succeeded();
    assert_eq!(both.stderr, ""); // the EXR holds them
}

#[test]
fn what_is_not_shown_warns() {
    let sandbox = Sandbox::with(&[("square.json", &turned_square())]);
    sandbox.write_rows("rays.npy", &[[0.25, 0.5, 2.0, 0.0, 0.0, -1.0]]);
    for line in [
        "render square.json -o a.png --size 8x8 --quiet",
        "cast square.json --rays rays.npy -o hits.npy",
        "audit square.json --rays 100",
    ] {
        assert_eq!(
            sandbox.run(line).succeeded().stderr,
            "warning: not imported: square.json:5:7: surface \"square\": \"reversed\" left \
             out: (u, v) and the normal stay as written; reverse = true in a scene turns \
             all surfaces of the file\n"
        );
    }
}

#[test]
fn what_changes_nothing_or_too_much_warns() {
    let bright = "[[material]]\nname = \"lamp\"\ncolor = [0.5, 1.5, 0]\n";
    let sandbox = Sandbox::with(&[("lamp.toml", &format!("{SPHERE}{bright}"))]);
    let run = sandbox.run("render lamp.toml -o a.exr --exposure 1 --quiet").succeeded();
    assert_eq!(
        run.stderr,
        "warning: a.exr: an EXR holds light as it is, --exposure is for a .png and changes \
         nothing\n\
         warning: lamp.toml:9:8: material \"lamp\" sends back 1.5 times the light that falls on \
         it; colours of things are from 0 to 1\n"
    );
    let line = "render lamp.toml -o a.exr -o a.png --exposure 1 --quiet";
    assert_eq!(sandbox.run(line).succeeded().stderr.lines().count(), 1);
}

#[test]
fn help_says_what_is_done_when_nothing_is_said() {
    let help = sandbox().run("render --help").succeeded().stdout;
    let help = help.split_whitespace().collect::<Vec<_>>().join(" ");
    for words in [
        "[default: the scene's, else 800x600]",
        "[default: the scene's, else 16]",
        "[default: the scene's, else direct]",
        "keeps the whole picture as its display window",
        "nurbray:samples",
        "weight R, G, B, A, Albedo and doubt with nurbray:spp",
    ] {
        assert!(help.contains(words), "{words}");
    }
}

/// What `--help` says about joining ranges is true: R, G, B, A and Albedo are means, the rest is
/// that of the lowest range which hits.
#[test]
fn ranges_of_samples_are_joined_as_help_says() {
    let sandbox = sandbox();
    let run = |name: &str, range: &str| {
        let line = format!("render sphere.toml -o {name} --spp 8 --samples {range}");
        sandbox.run(&line).succeeded();
        let image = read_first_flat_layer_from_file(sandbox.path(name)).unwrap();
        let spp = image.layer_data.attributes.other.iter();
        let spp = spp.filter(|(name, _)| **name == *"nurbray:spp");
        let spp: Vec<String> = spp.map(|(_, value)| format!("{value:?}")).collect();
        let planes = image.layer_data.channel_data.list.into_iter().map(|channel| {
            let values = channel.sample_data.values_as_f32().collect::<Vec<_>>();
            (channel.name.to_string(), values)
        });
        (planes.collect::<Vec<_>>(), spp)
    };
    let ((low, _), (high, spp), (whole, _)) =
        (run("low.exr", "0..3"), run("high.exr", "3..8"), run("whole.exr", "0..8"));
    assert!(spp.len() == 1 && spp[0].contains('5'), "{spp:?}");
    let depth = low.iter().find(|(name, _)| name == "Z").unwrap().1.clone();
    for (((name, low), (_, high)), (_, whole)) in low.iter().zip(&high).zip(&whole) {
        let mean = ["R", "G", "B", "A"].contains(&name.as_str()) || name.starts_with("Albedo");
        for (pixel, whole) in whole.iter().enumerate() {
            let (low, high) = (low[pixel], high[pixel]);
            if mean {
                let joined = (3.0 * low + 5.0 * high) / 8.0;
                assert!((joined - whole).abs() <= 1e-6 * whole.abs(), "{name} {pixel}");
            } else {
                let joined = if depth[pixel].is_finite() { low } else { high };
                assert!(joined == *whole, "{name} {pixel}: {low} {high} {whole}");
            }
        }
    }
}

#[test]
fn pixels_depend_on_neither_threads_nor_kernel_nor_time() {
    let sandbox = sandbox();
    for threads in 1..=3 {
        sandbox
            .run(&format!("render sphere.toml -o {threads}.png --threads {threads}"))
            .succeeded();
    }
    sandbox.run("render sphere.toml -o scalar.png --kernel scalar").succeeded();
    for other in ["2.png", "3.png", "scalar.png"] {
        assert_eq!(sandbox.bytes("1.png"), sandbox.bytes(other));
    }
}

#[test]
fn the_command_line_overrides_the_scene() {
    // A plain ball looks alike from everywhere, as the default lights go with the camera.
    let material = "[[material]]\nname = \"default\"\nlines = { count = [3, 5] }\n";
    let sandbox = Sandbox::with(&[("sphere.toml", &format!("{SPHERE}{material}"))]);
    sandbox.run("render sphere.toml -o plain.png").succeeded();
    let options = [
        "--size 16x24",
        "--spp 3",
        "--samples 2..4",
        "--seed 5",
        "--exposure -2",
        "--integrator normal",
        "--look-from 3,0,0.5",
        "--look-at 0,0,0.5",
        "--up 1,0,0.2",
        "--fov 60",
        "--crop 4,2,12,10",
    ];
    for option in options {
        sandbox.run(&format!("render sphere.toml -o other.png {option}")).succeeded();
        assert_ne!(sandbox.bytes("plain.png"), sandbox.bytes("other.png"), "{option}");
    }
    assert_eq!(png_size(&sandbox.bytes("other.png")), (8, 8));
}

/// From (0, -9, 0) the centre of the sphere is in the middle of the picture, and so is the
/// point (0, -1, 0), 8 away; at the edge of a narrow view there is still sphere.
#[test]
fn look_from_alone_looks_at_the_center() {
    let sandbox = sandbox();
    let line = "render sphere.toml -o a.exr --aov Z,P --size 1x1 --spp 1 --fov 0.001 \
                --look-from 0,-9,0";
    sandbox.run(line).succeeded();
    let image = read_first_flat_layer_from_file(sandbox.path("a.exr")).unwrap();
    let value = |name: &str| {
        let list = &image.layer_data.channel_data.list;
        let channel = list.iter().find(|channel| channel.name.to_string() == name).unwrap();
        channel.sample_data.value_by_flat_index(0).to_f32()
    };
    assert!((value("Z") - 8.0).abs() < 1e-3, "{}", value("Z"));
    assert!((value("P.Y") + 1.0).abs() < 1e-3, "{}", value("P.Y"));
}

#[test]
fn a_camera_that_is_moved_still_looks_where_the_scene_says() {
    let camera = "[camera]\nlook_from = [1, -9, 0]\nlook_at = [1, 0, 0]\n";
    let scene = format!("{camera}{SPHERE}");
    let sandbox = Sandbox::with(&[("aside.toml", &scene)]);
    let line = "render aside.toml --look-from 1,-3,0";
    sandbox.run(&format!("{line} -o moved.png")).succeeded();
    sandbox.run(&format!("{line} -o same.png --look-at 1,0,0")).succeeded();
    sandbox.run(&format!("{line} -o other.png --look-at 0,0,0")).succeeded();
    let same_point = "camera: look_from and look_at are the same point (1, 0, 0)";
    sandbox.run("render aside.toml -o a.png --look-from 1,0,0").failed(2, same_point);
    let picture = |name: &str| sandbox.bytes(name);
    assert_eq!(picture("moved.png"), picture("same.png"));
    assert_ne!(picture("moved.png"), picture("other.png"));
}

#[test]
fn wrong_outputs_are_refused_before_anything_is_read() {
    let sandbox = sandbox();
    std::fs::create_dir(sandbox.path("folder.png")).unwrap();
    for (outputs, error) in [
        ("-o a.jpg", "a.jpg: cannot write .jpg files; known are .exr and .png"),
        ("-o a", "a: no extension says how to write it; known are .exr and .png"),
        ("-o no/a.png", "cannot write \"no/a.png\": there is no folder \"no\""),
        ("-o folder.png", "cannot write \"folder.png\": it is a folder"),
        ("-o a.png -o ./a.png", "\"./a.png\" is given twice as output"),
    ] {
        sandbox.run(&format!("render none.toml {outputs}")).failed(2, error);
    }
    assert_eq!(sandbox.files(), ["folder.png", "sphere.toml"]);
}

#[cfg(unix)]
#[test]
fn an_input_is_not_overwritten() {
    let sandbox = sandbox();
    std::os::unix::fs::symlink(sandbox.path("sphere.toml"), sandbox.path("a.png")).unwrap();
    sandbox
        .run("render sphere.toml -o a.png")
        .failed(2, "\"a.png\" would be overwritten: it is an input of this run");
    assert_eq!(sandbox.bytes("sphere.toml"), SPHERE.as_bytes());
}

/// The scene names the model: only after reading it does the program know it for an input.
#[cfg(unix)]
#[test]
fn a_model_of_the_scene_is_not_overwritten() {
    let scene = "[[object]]\nshape = { file = \"square.json\" }\n";
    let sandbox = Sandbox::with(&[("scene.toml", scene), ("square.json", SQUARE)]);
    sandbox.write_rows("rays.npy", &[[0.0, 0.0, 1.0, 0.0, 0.0, -1.0]]);
    for name in ["a.png", "a.svg", "a.npy"] {
        std::os::unix::fs::symlink("square.json", sandbox.path(name)).unwrap();
    }
    std::fs::create_dir(sandbox.path("out")).unwrap();
    std::os::unix::fs::symlink("../square.json", sandbox.path("out/legend.svg")).unwrap();
    for (line, output) in [
        ("render scene.toml -o a.png", "a.png"),
        ("plot scene.toml -o a.svg", "a.svg"),
        ("cast scene.toml --rays rays.npy -o a.npy", "a.npy"),
        ("audit scene.toml --offenders a.npy", "a.npy"),
        ("bench scene.toml --plot a.svg --against embree", "a.svg"),
        ("compare scene.toml --against embree -o out", "out/legend.svg"),
        ("compare scene.toml --against povray -o out", "out/legend.svg"),
    ] {
        let error = "would be overwritten: it is \"square.json\", an input of this run";
        sandbox.run(line).failed(2, &format!("\"{output}\" {error}"));
    }
    assert_eq!(sandbox.bytes("square.json"), SQUARE.as_bytes());
}

#[test]
fn wrong_settings_are_refused() {
    let sandbox = sandbox();
    for (options, error) in [
        ("--size 70000x10", "size 70000x10: a side of a picture has at most 65536 pixels"),
        ("--crop 0,0,25,16", "crop 0,0,25,16 reaches beyond the picture of size 24x16"),
        ("--spp 4 --samples 2..5", "--samples up to 5: --spp 4 has the samples 0 to 3 only"),
        (
            "--look-from 1,2,3 --look-at 1,2,3",
            "camera: look_from and look_at are the same point (1, 2, 3)",
        ),
        ("--up 0,0,0", "camera: up (0, 0, 0) is no direction: it must not be zero"),
        (
            "--look-from 0,0,9 --look-at 0,0,1 --up 0,0,-2",
            "camera: up (0, 0, -2) runs along the view (0, 0, -1): it must point another way",
        ),
    ] {
        sandbox.run(&format!("render sphere.toml -o a.png {options}")).failed(2, error);
    }
    for (options, first_line) in [
        (
            "--size 10",
            "invalid value '10' for '--size <WxH>': a size is WIDTHxHEIGHT in pixels, both at least 1, such as 1024x768",
        ),
        (
            "--spp 0",
            "invalid value '0' for '--spp <N>': a whole number from 1 to 4294967295 is needed, \
             such as 64, 1_000 or 1e3",
        ),
        (
            "--samples 5..5",
            "invalid value '5..5' for '--samples <A..B>': there are no samples in it: A must be smaller than B",
        ),
        (
            "--crop 5,0,5,9",
            "invalid value '5,0,5,9' for '--crop <X0,Y0,X1,Y1>': there are no pixels in it: \
             a crop needs X0 < X1 and Y0 < Y1",
        ),
        (
            "--look-from 1,2",
            "invalid value '1,2' for '--look-from <X,Y,Z>': three finite numbers X,Y,Z are needed, such as 1,-2.5,4",
        ),
        (
            "--fov 180",
            "invalid value '180' for '--fov <DEG>': an angle from 1e-6 degrees up to, not including, \
             180 is needed, such as 35",
        ),
        (
            "--exposure nan",
            "invalid value 'nan' for '--exposure <EV>': a finite number is needed, such as -1.5",
        ),
        (
            "--aov Z,albeda",
            "invalid value 'Z,albeda' for '--aov <LIST>': unknown AOV \"albeda\"; did you mean \"Albedo\"?",
        ),
        (
            "--aov Z,none",
            "invalid value 'Z,none' for '--aov <LIST>': \"none\" says all there is to say: \
             it cannot be in a list",
        ),
        ("--integrator nromal", "invalid value 'nromal' for '--integrator <NAME>'"),
    ] {
        sandbox.run(&format!("render sphere.toml -o a.png {options}")).misused(first_line);
    }
    assert_eq!(sandbox.files(), ["sphere.toml"]);
}

#[test]
fn a_field_of_view_needs_a_perspective_camera() {
    let scene = format!("[camera]\northographic = {{ height = 3 }}\n{SPHERE}");
    let sandbox = Sandbox::with(&[("flat.toml", &scene)]);
    let error = "--fov: the camera of \"flat.toml\" is orthographic and has no field of view";
    sandbox.run("render flat.toml -o a.png --fov 30").failed(2, error);
    sandbox.run("render flat.toml -o a.png --look-from 5,5,5").succeeded();
}

#[test]
fn a_killed_run_leaves_older_pictures_alone() {
    let sandbox = sandbox();
    std::fs::write(sandbox.path("a.png"), "older").unwrap();
    std::fs::write(sandbox.path("a.exr"), "older").unwrap();
    // Minutes of work, killed within its first second.
    let line = "render sphere.toml -o a.png -o a.exr --size 4000x4000 --spp 1e4";
    let mut child = sandbox.command(line).stderr(std::process::Stdio::null()).spawn().unwrap();
    std::thread::sleep(std::time::Duration::from_millis(300));
    assert!(child.try_wait().unwrap().is_none(), "still at work");
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(
        (sandbox.bytes("a.png"), sandbox.bytes("a.exr")),
        (b"older".into(), b"older".into())
    );
    assert_eq!(sandbox.files(), ["a.exr", "a.png", "sphere.toml"]);
}

#[test]
fn a_failed_run_leaves_older_pictures_alone() {
    let sandbox = sandbox();
    std::fs::write(sandbox.path("a.png"), "older").unwrap();
    let run = sandbox.run("render sphere.toml -o a.png --crop 0,0,99,99");
    assert_eq!(run.code, 2);
    assert_eq!(sandbox.bytes("a.png"), b"older");
    sandbox.run("render sphere.toml -o a.png").succeeded();
    assert_ne!(sandbox.bytes("a.png"), b"older");
    assert_eq!(sandbox.files(), ["a.png", "sphere.toml"]);
}

/// A finished picture is not lost because another cannot be written.
#[cfg(target_os = "linux")]
#[test]
fn pictures_are_written_even_if_another_cannot_be() {
    let sandbox = Sandbox::with(&[("sphere.toml", SPHERE), ("good.exr", "old")]);
    for name in ["full.png", "fuller.png"] {
        std::os::unix::fs::symlink("/dev/full", sandbox.path(name)).unwrap();
    }
    let full = "cannot write \"full.png\": No space left on device (os error 28)";
    sandbox.run("render sphere.toml -o full.png").failed(1, full);
    let run = sandbox.run("render sphere.toml -o good.exr -o full.png -o good.png");
    run.failed(1, &format!("{full}; wrote good.exr and good.png"));
    assert_eq!(sandbox.bytes("good.exr")[..4], [0x76, 0x2f, 0x31, 0x01]);
    let fuller = full.replace("full.png", "fuller.png");
    let run = sandbox.run("render sphere.toml -o full.png -o fuller.png");
    run.failed(1, &format!("{full}; {fuller}"));
}

#[test]
fn light_that_no_picture_holds_is_refused_or_told() {
    let ambient = "[[light]]\nambient = { radiance = 3e38 }\n";
    let sandbox = Sandbox::with(&[
        ("background.toml", &format!("background = 1e39\n{SPHERE}")),
        ("bright.toml", &format!("{SPHERE}{ambient}{ambient}")),
    ]);
    sandbox.run("render background.toml -o a.exr").failed(
        2,
        "background.toml:1:14: found 1e39, needed at most 3.4e38: pictures hold no brighter light",
    );
    // Each light would do, both together do not.
    let line = "render bright.toml -o a.exr -o a.png --quiet";
    let run = sandbox.run(&format!("{line} --look-from 0,-9,0 --fov 1")).succeeded();
    assert_eq!(
        run.stderr,
        "warning: a.exr: 384 pixels with numbers beyond 3.4e38, the largest that an EXR holds: \
         they are infinite there\n"
    );
    assert_eq!(sandbox.run("render bright.toml -o a.png --quiet").succeeded().stderr, "");
}

#[test]
fn points_too_far_away_for_32_bits_warn() {
    let far = format!("{SPHERE}transform = [{{ translate = [4.56e5, 5.4321e6, 312] }}]\n");
    let sandbox = Sandbox::with(&[("far.toml", &far)]);
    let run = sandbox.run("render far.toml -o a.exr --fov 1e-3 --look-from 456000,5431000,312");
    let warning = "warning: a.exr: 384 pixels in which the 32 bits of P have steps of more than \
                   1/10 of the pixel: the scene is too far from the origin for them; \
                   `nurbray cast` writes points in f64";
    assert_eq!(run.succeeded().stderr.lines().next(), Some(warning));
    let run = sandbox.run("render far.toml -o a.exr --aov Z,N --quiet").succeeded();
    assert_eq!(run.stderr, "");
}

/// <https://reproducible-builds.org/docs/source-date-epoch>
#[test]
fn a_given_time_makes_files_the_same() {
    let sandbox = sandbox();
    let run = |time: &str, line: &str| {
        let mut command = sandbox.command(line);
        crate::sandbox::Run::from_output(command.env("SOURCE_DATE_EPOCH", time).output().unwrap())
    };
    let bytes = |time| {
        run(time, "render sphere.toml -o a.exr").succeeded();
        sandbox.bytes("a.exr")
    };
    let first = bytes("1700000000");
    assert_eq!(first, bytes("1700000000"));
    let text = String::from_utf8_lossy(&first).into_owned();
    assert!(text.contains("2023:11:14 22:13:20") && !text.contains("nurbray:seconds"));
    assert_ne!(first, bytes("1700000001"));
    run("now", "render sphere.toml -o b.exr").failed(
        2,
        "SOURCE_DATE_EPOCH is \"now\": needed is a whole number of seconds since 1970, at most \
         253402300799, such as 1700000000",
    );
    assert_eq!(sandbox.files(), ["a.exr", "sphere.toml"]);
}
