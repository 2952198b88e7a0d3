//! The same picture whatever the threads, crops and sample ranges.

use std::ops::ControlFlow;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use glam::DVec3;

use super::test_worlds::{sphere_over_floor, sphere_over_tiles};
use super::*;
use crate::intersect::Coherence;
use crate::scene::{Camera, IntegratorKind, Projection, View, World};

fn settings() -> RenderSettings {
    RenderSettings {
        size: [50, 37],
        samples: 0..6,
        aovs: AovSet::all(),
        threads: 1,
        ..RenderSettings::default()
    }
}

fn picture(settings: &RenderSettings) -> Film {
    picture_of(&sphere_over_floor(), settings)
}

fn picture_of(world: &World, settings: &RenderSettings) -> Film {
    render(world, settings, &|_| ControlFlow::Continue(())).unwrap()
}

/// One whose pictures are traced in packets, and one whose leaves are too small for them.
fn both_worlds() -> [World; 2] {
    let worlds = [sphere_over_floor(), sphere_over_tiles()];
    let told = |k: usize| worlds[k].neighbours(settings().size).first_hits;
    assert_eq!([told(0), told(1)], [Coherence::Coherent, Coherence::Incoherent]);
    worlds
}

/// Seen from within the bounding box of all surfaces, whose nearest point says nothing about how
/// far away they are.
#[test]
fn how_far_apart_rays_are_is_told_by_what_they_meet() {
    let mut world = sphere_over_tiles();
    let view = View { look_from: DVec3::new(2.5, -2.5, 0.5), look_at: DVec3::ZERO, up: DVec3::Z };
    world.camera = Camera::new(view, Projection::Perspective { fov: 40.0 }).unwrap();
    assert_eq!(world.neighbours([50, 37]).first_hits, Coherence::Incoherent);
    assert_eq!(world.neighbours([5000, 3700]).first_hits, Coherence::Coherent);
}

/// Every number of every pixel of a rectangle, as bits.
fn bits(film: &Film, window: PixelRect) -> Vec<u32> {
    let ([x0, y0], [x1, y1]) = (window.min(), window.max());
    let pixels = (y0..y1).flat_map(|y| (x0..x1).map(move |x| [x, y]));
    let values = |pixel| film.channels().map(move |channel| film.value(channel, pixel).unwrap());
    pixels.flat_map(values).map(f32::to_bits).collect()
}

/// The counters of rays and answers. The work depends on which rays share a packet, these do not.
fn answers(film: &Film) -> [u64; 3] {
    let counters = film.counters();
    [counters.rays, counters.hits, counters.doubtful]
}

#[test]
fn threads_do_not_change_a_bit() {
    for &integrator in IntegratorKind::ALL {
        let one = picture(&RenderSettings { integrator, ..settings() });
        for threads in [2, 3] {
            let other = picture(&RenderSettings { integrator, threads, ..settings() });
            assert_eq!(bits(&one, one.window()), bits(&other, one.window()), "{integrator}");
            assert!(one == other);
            assert_eq!(one.counters(), other.counters(), "{integrator}");
        }
    }
}

#[test]
fn four_crops_are_the_whole() {
    for world in &both_worlds() {
        let whole = picture_of(world, &settings());
        let mut pasted = Film::new(&settings()).unwrap();
        // Neither at tile borders nor of equal sizes.
        for (min, max) in
            [([0, 0], [23, 11]), ([23, 0], [50, 11]), ([0, 11], [23, 37]), ([23, 11], [50, 37])]
        {
            let crop = PixelRect::new(min, max).unwrap();
            let part = picture_of(world, &RenderSettings { crop: Some(crop), ..settings() });
            assert_eq!(part.window(), crop);
            assert_eq!(bits(&part, crop), bits(&whole, crop), "crop {crop}");
            assert!(pasted != whole);
            pasted.paste(&part).unwrap();
        }
        assert_eq!(bits(&pasted, pasted.window()), bits(&whole, whole.window()));
        assert!(pasted == whole, "the sums are those of the whole picture, too");
        assert_eq!(answers(&pasted), answers(&whole));
    }
}

#[test]
fn two_sample_ranges_are_the_whole() {
    for world in &both_worlds() {
        for (start, middle, end) in [(0, 1, 6), (0, 4, 6), (3, 5, 10), (2, 7, 8)] {
            let range = |samples| picture_of(world, &RenderSettings { samples, ..settings() });
            let (whole, first, second) =
                (range(start..end), range(start..middle), range(middle..end));
            let merged = first.merge(second).unwrap();
            assert_eq!(bits(&merged, merged.window()), bits(&whole, whole.window()));
            assert!(merged == whole);
            assert_eq!(answers(&merged), answers(&whole));
            assert_eq!(merged.settings(), whole.settings());
        }
    }
}

#[test]
fn data_do_not_change_the_picture_nor_each_other() {
    let all = picture(&settings());
    for set in ["none", "Z", "Albedo", "id,uv", "P,Albedo"] {
        let some = picture(&RenderSettings { aovs: set.parse().unwrap(), ..settings() });
        for channel in some.channels() {
            assert_eq!(some.plane(channel), all.plane(channel), "{channel:?} of {set}");
        }
        assert_eq!(some.counters(), all.counters());
    }
}

#[test]
fn another_seed_takes_other_samples_of_the_same_picture() {
    let one = picture(&settings());
    let other = picture(&RenderSettings { seed: 1, ..settings() });
    assert_ne!(bits(&one, one.window()), bits(&other, one.window()));
    let mean = |film: &Film| {
        let plane = film.plane(Channel::R).unwrap();
        plane.iter().sum::<f32>() / plane.len() as f32
    };
    assert!((mean(&one) / mean(&other) - 1.0).abs() < 0.01);
}

#[test]
fn progress_rises_to_the_end() {
    let told = Mutex::new(Vec::new());
    let settings = RenderSettings { threads: 3, ..settings() };
    let film = render(&sphere_over_floor(), &settings, &|progress| {
        told.lock().unwrap().push(progress);
        ControlFlow::Continue(())
    });
    let told = told.into_inner().unwrap();
    // 50 × 37 pixels in tiles of 16 × 16.
    assert_eq!(told.len(), 12);
    assert!(told.is_sorted_by_key(|p| (p.tiles_done, p.rays)));
    let last = told.last().unwrap();
    assert_eq!((last.tiles_done, last.tiles), (12, 12));
    assert_eq!(last.rays, film.unwrap().counters().rays);
}

#[test]
fn a_cancelled_render_asks_no_more() {
    let world = sphere_over_floor();
    for threads in [1, 3] {
        for last in [1, 5, 12] {
            let told = AtomicUsize::new(0);
            let film = render(&world, &RenderSettings { threads, ..settings() }, &|progress| {
                told.fetch_add(1, Ordering::Relaxed);
                if progress.tiles_done == last {
                    ControlFlow::Break(())
                } else {
                    ControlFlow::Continue(())
                }
            });
            assert_eq!(film, Err(RenderError::Cancelled));
            assert_eq!(told.into_inner(), last, "with {threads} threads");
        }
    }
    assert_eq!(RenderError::Cancelled.to_string(), "the render was cancelled");
}

/// Once the other threads went on to the end, and the callback with them, before the panic came
/// out.
#[test]
fn a_callback_that_panics_ends_the_render() {
    let world = sphere_over_floor();
    for threads in [1, 3] {
        let told = AtomicUsize::new(0);
        let ended = catch_unwind(AssertUnwindSafe(|| {
            render(&world, &RenderSettings { threads, ..settings() }, &|_| {
                told.fetch_add(1, Ordering::Relaxed);
                panic!("a test's own panic");
            })
        }));
        let panic = ended.unwrap_err();
        assert_eq!(panic.downcast_ref(), Some(&"a test's own panic"));
        assert_eq!(told.into_inner(), 1, "with {threads} threads");
    }
}

#[test]
fn rays_and_hits_are_counted() {
    let film = picture(&RenderSettings { integrator: IntegratorKind::Normal, ..settings() });
    let counters = film.counters();
    assert_eq!(counters.rays, 50 * 37 * 6);
    assert_eq!(counters.statistics.rays, counters.rays);
    let covered: f32 = film.plane(Channel::A).unwrap().iter().sum();
    assert_eq!(counters.hits, (covered * 6.0).round() as u64);
    // Shadow rays count as well.
    let direct = picture(&settings()).counters().rays;
    assert!(direct > counters.rays && direct <= 3 * counters.rays, "{direct} rays");
}

#[test]
fn refused_settings_are_errors() {
    let world = sphere_over_floor();
    let empty = RenderSettings { size: [0, 4], ..settings() };
    let error = render(&world, &empty, &|_| ControlFlow::Continue(())).unwrap_err().to_string();
    assert_eq!(error, "size 0x4: a picture needs at least one pixel each way");
}
