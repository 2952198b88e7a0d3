//! The gallery is true: each scene has its picture, and each picture is what its scene shows.
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests, and what they share")]

use std::collections::BTreeSet;
use std::fs;
use std::ops::ControlFlow;
use std::path::{Path, PathBuf};

use image::RgbImage;
use nurbray::io::{load_input, write_png};
use nurbray::render::{AovSet, PixelRect, RenderSettings, render};
use nurbray::scene::World;

/// The largest size of a picture in bytes: a clone should not be heavy for its pictures.
const LARGEST_PICTURE: u64 = 200_000;

/// Strips across each picture are rendered again as crops, whose pixels are the same: at these
/// shares of its height, with this many rows each. Whole pictures would take minutes.
const STRIPS: [f64; 3] = [0.3, 0.5, 0.7];
const ROWS: u32 = 3;

/// One pixel in this many may differ by more than 1/255.
///
/// On one machine none does. But cameras and sRGB need `tan` and `pow`, whose last bit is
/// the system library's, and a sample on the edge of a line may fall to its other side.
const FLIPS: usize = 500;

fn folder(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

fn stems(name: &str, extension: &str) -> BTreeSet<String> {
    let paths = fs::read_dir(folder(name)).unwrap().map(|entry| entry.unwrap().path());
    paths
        .filter(|path| path.extension().is_some_and(|found| found == extension))
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect()
}

/// The scenes that are traced, and those that hold plots, whose figures `nurbray plot` draws and
/// its tests check.
fn scenes() -> [BTreeSet<String>; 2] {
    let all = stems("scenes", "toml").into_iter();
    let (plots, traced) = all.partition(|stem| {
        let scene = load_input(&scene(stem)).unwrap();
        !scene.plots.is_empty()
    });
    [traced, plots]
}

fn scene(stem: &str) -> PathBuf {
    folder("scenes").join(stem).with_extension("toml")
}

fn picture(stem: &str) -> PathBuf {
    folder("renders").join(stem).with_extension("png")
}

/// The picture a scene asks for, colour only.
fn settings(world: &World) -> RenderSettings {
    RenderSettings { aovs: AovSet::NONE, ..RenderSettings::from(world.settings()) }
}

/// Renders and reads what was written.
fn shown(world: &World, settings: &RenderSettings) -> RgbImage {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("crop.png");
    let film = render(world, settings, &|_| ControlFlow::Continue(())).unwrap();
    write_png(&path, &film, world.settings().exposure).unwrap();
    image::open(path).unwrap().into_rgb8()
}

/// How many pixels of a strip differ by more than 1/255 from those of the whole picture.
fn differing(strip: &RgbImage, y0: u32, whole: &RgbImage) -> usize {
    let far = |x, y| {
        let (a, b) = (strip.get_pixel(x, y).0, whole.get_pixel(x, y0 + y).0);
        a.iter().zip(b).any(|(a, b)| a.abs_diff(b) > 1)
    };
    strip.enumerate_pixels().filter(|&(x, y, _)| far(x, y)).count()
}

#[test]
fn every_scene_has_its_picture_and_no_picture_is_alone() {
    let [traced, plots] = scenes();
    assert!(traced.len() >= 10, "only {} scenes found: is this the right folder?", traced.len());
    assert_eq!(traced, stems("renders", "png"));
    assert_eq!(plots, stems("renders", "svg"));
    let figure = |stem: &String| picture(stem).with_extension("svg");
    for path in traced.iter().map(|stem| picture(stem)).chain(plots.iter().map(figure)) {
        let size = fs::metadata(&path).unwrap().len();
        assert!(size < LARGEST_PICTURE, "{} has {size} bytes", path.display());
    }
}

#[test]
fn every_scene_says_what_to_look_at() {
    for stem in stems("scenes", "toml") {
        let text = fs::read_to_string(scene(&stem)).unwrap();
        let comment: Vec<_> = text.lines().take_while(|line| line.starts_with("# ")).collect();
        assert!(comment.join(" ").contains("ook "), "scenes/{stem}.toml: {comment:?}");
    }
}

#[test]
fn pictures_are_what_their_scenes_show() {
    let [traced, _] = scenes();
    for stem in traced {
        let world = World::new(&load_input(&scene(&stem)).unwrap()).unwrap();
        let whole = image::open(picture(&stem)).unwrap().into_rgb8();
        let settings = settings(&world);
        assert_eq!(settings.size, <[u32; 2]>::from(whole.dimensions()), "renders/{stem}.png");

        let [width, height] = settings.size;
        for share in STRIPS {
            let y0 = (share * f64::from(height)) as u32;
            let crop = Some(PixelRect::new([0, y0], [width, y0 + ROWS]).unwrap());
            let strip = shown(&world, &RenderSettings { crop, ..settings.clone() });
            let wrong = differing(&strip, y0, &whole);
            assert!(
                wrong * FLIPS <= (width * ROWS) as usize,
                "{wrong} pixels of rows {y0} to {} differ; if the change is meant, render again:\n  \
                 cargo run --release -- render scenes/{stem}.toml -o renders/{stem}.png",
                y0 + ROWS - 1
            );
        }
    }
}

#[test]
fn rendering_again_gives_the_same_file() {
    let world = World::new(&load_input(&scene("teapot")).unwrap()).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let files = [1, 2, 3].map(|threads| {
        let settings =
            RenderSettings { size: [64, 48], samples: 0..2, threads, ..settings(&world) };
        let path = folder.path().join(format!("{threads}.png"));
        let film = render(&world, &settings, &|_| ControlFlow::Continue(())).unwrap();
        write_png(&path, &film, 0.0).unwrap();
        fs::read(path).unwrap()
    });
    assert!(files[0] == files[1] && files[1] == files[2], "the number of threads shows");
}
