//! Pictures of spheres and floors against closed forms.

use std::f64::consts::PI;
use std::ops::ControlFlow;

use glam::{DVec2, DVec3};

use super::test_worlds::{floor, sphere, world};
use super::*;
use crate::geometry::shapes;
use crate::math::Ray;
use crate::scene::{IntegratorKind, Light, Rgb, World};

const SIZE: [u32; 2] = [33, 25];

fn settings(integrator: IntegratorKind) -> RenderSettings {
    RenderSettings {
        size: SIZE,
        samples: 0..1,
        integrator,
        aovs: AovSet::all(),
        threads: 1,
        ..RenderSettings::default()
    }
}

fn picture(world: &World, integrator: IntegratorKind) -> Film {
    render(world, &settings(integrator), &|_| ControlFlow::Continue(())).unwrap()
}

/// The camera ray of the only sample of a pixel.
fn ray(world: &World, pixel: [u32; 2]) -> Ray {
    let [x, y] = Sampler::new(0).sample(pixel, 0, Dimensions::Film);
    let (width, height) = (f64::from(SIZE[0]), f64::from(SIZE[1]));
    let film = DVec2::new(f64::from(pixel[0]) + x, f64::from(pixel[1]) + y);
    world.camera.ray(film / DVec2::new(width, height), width / height)
}

fn pixels() -> impl Iterator<Item = [u32; 2]> {
    (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| [x, y]))
}

/// The distance to a sphere around the origin, by the quadratic formula.
fn sphere_distance(ray: &Ray, radius: f64) -> Option<f64> {
    let d = ray.direction().normalize();
    let along = ray.origin().dot(d);
    // The square of the chord's half length, from the distance of the ray to the centre.
    let half = radius * radius - (ray.origin() - along * d).length_squared();
    (half > 0.0).then(|| -along - half.sqrt())
}

fn color(film: &Film, pixel: [u32; 2]) -> Rgb {
    [Channel::R, Channel::G, Channel::B].map(|c| f64::from(film.value(c, pixel).unwrap()))
}

fn vector(film: &Film, channels: [Channel; 3], pixel: [u32; 2]) -> DVec3 {
    DVec3::from_array(channels.map(|c| f64::from(film.value(c, pixel).unwrap())))
}

fn assert_close(found: Rgb, expected: Rgb, pixel: [u32; 2]) {
    for (a, b) in found.into_iter().zip(expected) {
        // The film is in 24 bits.
        assert!((a - b).abs() <= 3e-7 * b.abs().max(0.3), "{pixel:?}: {found:?}, {expected:?}");
    }
}

#[test]
fn data_channels_of_a_sphere_at_every_magnitude() {
    for scale in [1e-8, 1.0, 1e8] {
        let world = world(vec![sphere(scale)], Vec::new(), scale);
        let film = picture(&world, IntegratorKind::Direct);
        let mut hits = 0;
        for pixel in pixels() {
            let value = |channel| f64::from(film.value(channel, pixel).unwrap());
            let Some(distance) = sphere_distance(&ray(&world, pixel), scale) else {
                assert_eq!(value(Channel::Z), f64::INFINITY);
                assert_eq!([value(Channel::A), value(Channel::Id)], [0.0, -1.0]);
                continue;
            };
            hits += 1;
            assert!((value(Channel::Z) / distance - 1.0).abs() < 1e-6, "{pixel:?} at {scale}");
            assert_eq!([value(Channel::A), value(Channel::Id)], [1.0, 0.0]);
            let point = vector(&film, [Channel::PX, Channel::PY, Channel::PZ], pixel);
            let ray = ray(&world, pixel);
            let expected = ray.origin() + distance * ray.direction().normalize();
            assert!((point - expected).length() < 1e-6 * scale, "{pixel:?} at {scale}");
            let normal = vector(&film, [Channel::NX, Channel::NY, Channel::NZ], pixel);
            assert!((normal - expected / scale).length() < 1e-6, "{pixel:?}: {normal}");
            let albedo = [Channel::AlbedoR, Channel::AlbedoG, Channel::AlbedoB].map(value);
            assert_close(albedo, [0.9, 0.5, 0.1], pixel);
        }
        assert!(hits > 100);
        assert_eq!(film.counters().hits, hits);
    }
}

#[test]
fn a_sphere_under_a_distant_light_is_lamberts() {
    let to_light = DVec3::new(1.0, -2.0, 1.0).normalize();
    let irradiance = [2.0, 3.0, 4.0];
    let world = world(vec![sphere(1.0)], vec![Light::Directional { to_light, irradiance }], 1.0);
    let film = picture(&world, IntegratorKind::Direct);
    for pixel in pixels() {
        let ray = ray(&world, pixel);
        let expected = match sphere_distance(&ray, 1.0) {
            Some(distance) => {
                let normal = ray.origin() + distance * ray.direction().normalize();
                let cosine = normal.dot(to_light).max(0.0);
                [0, 1, 2].map(|k| [0.9, 0.5, 0.1][k] / PI * irradiance[k] * cosine)
            }
            None => world.background,
        };
        assert_close(color(&film, pixel), expected, pixel);
    }
}

#[test]
fn a_sphere_throws_the_shadow_of_a_point_light_on_a_floor() {
    // A light above the sphere: the shadow on the floor is a disk. Seen from the centre of
    // the light, the sphere is the cone of half angle asin(1/4) around the axis.
    let position = DVec3::new(0.0, 0.0, 4.0);
    let ambient = Light::Ambient { radiance: [0.25; 3] };
    let lights = vec![Light::Point { position, intensity: [50.0; 3] }, ambient];
    let world = world(vec![sphere(1.0), floor(20.0, -1.0)], lights, 1.0);
    let film = picture(&world, IntegratorKind::Direct);
    let edge = 5.0 * (0.25_f64).asin().tan();
    let (mut dark, mut bright) = (0, 0);
    for pixel in pixels() {
        if film.value(Channel::Id, pixel) != Some(1.0) {
            continue;
        }
        let ray = ray(&world, pixel);
        let point = ray.at((-1.0 - ray.origin().z) / ray.direction().z);
        let albedo = [0.9, 0.5, 0.2];
        let to_light = position - point;
        let in_shadow = point.truncate().length() < edge;
        let lit = if in_shadow { 0.0 } else { 50.0 * 5.0 / to_light.length().powi(3) };
        assert_close(color(&film, pixel), albedo.map(|a| a * (lit / PI + 0.25)), pixel);
        if in_shadow { dark += 1 } else { bright += 1 }
    }
    assert!(dark > 20 && bright > 20, "{dark} dark, {bright} bright");
}

#[test]
fn a_light_beyond_the_last_surface_is_not_hidden_by_what_is_behind_it() {
    // The light hangs between the floor and a ceiling: shadow rays end at the light.
    let light = Light::Point { position: DVec3::new(0.0, 0.0, 3.0), intensity: [10.0; 3] };
    let open = world(vec![floor(20.0, -1.0)], vec![light], 1.0);
    let closed = world(vec![floor(20.0, -1.0), floor(20.0, 5.0)], vec![light], 1.0);
    let (open, closed) =
        (picture(&open, IntegratorKind::Direct), picture(&closed, IntegratorKind::Direct));
    let lit = |film: &Film, pixel| (color(film, pixel), film.value(Channel::Id, pixel));
    let mut seen = 0;
    for pixel in pixels().filter(|&pixel| lit(&closed, pixel).1 == Some(0.0)) {
        assert_eq!(lit(&open, pixel), lit(&closed, pixel));
        seen += 1;
    }
    assert!(seen > 100, "{seen} pixels of the floor");
}

#[test]
fn both_sides_of_a_surface_are_lit_from_their_own_side() {
    // The camera looks down on the floor: turned upside down, the floor looks the same.
    let light = || vec![Light::directional(DVec3::Z, [1.0; 3]).unwrap()];
    let up = world(vec![floor(20.0, -1.0)], light(), 1.0);
    let down = world(vec![floor(20.0, -1.0).reversed_u()], light(), 1.0);
    let (a, b) = (picture(&up, IntegratorKind::Direct), picture(&down, IntegratorKind::Direct));
    let below = vec![Light::directional(-DVec3::Z, [1.0; 3]).unwrap()];
    let dark = picture(&world(vec![floor(20.0, -1.0)], below, 1.0), IntegratorKind::Direct);
    let mut seen = 0;
    for pixel in pixels().filter(|&pixel| a.value(Channel::A, pixel) == Some(1.0)) {
        assert_close(color(&a, pixel), [0.9 / PI, 0.5 / PI, 0.1 / PI], pixel);
        assert_eq!(color(&a, pixel), color(&b, pixel));
        assert_eq!(color(&dark, pixel), [0.0; 3]);
        // The normal channel keeps the surface's own orientation.
        let z = |film: &Film| film.value(Channel::NZ, pixel).unwrap();
        assert_eq!((z(&a), z(&b)), (1.0, -1.0));
        seen += 1;
    }
    assert!(seen > 100, "{seen} pixels of the floor");
}

#[test]
fn false_colors_show_the_data() {
    let world = world(vec![sphere(1.0), floor(6.0, -1.0)], Vec::new(), 1.0);
    let normals = picture(&world, IntegratorKind::Normal);
    let uv = picture(&world, IntegratorKind::Uv);
    let depth = picture(&world, IntegratorKind::Depth);
    let ids = picture(&world, IntegratorKind::Id);
    let mut depths = Vec::new();
    for pixel in pixels() {
        let value = |channel| f64::from(normals.value(channel, pixel).unwrap());
        if value(Channel::A) == 0.0 {
            for film in [&normals, &uv, &depth, &ids] {
                assert_eq!(color(film, pixel), [0.0; 3]);
            }
            continue;
        }
        let normal = [Channel::NX, Channel::NY, Channel::NZ].map(value);
        assert_close(color(&normals, pixel), normal.map(|n| 0.5 * (n + 1.0)), pixel);
        // All domains here are the unit square.
        assert_close(color(&uv, pixel), [value(Channel::U), value(Channel::V), 0.0], pixel);
        depths.push((value(Channel::Z), color(&depth, pixel)[0]));
        let same = color(&ids, pixel) == color(&ids, [SIZE[0] / 2, SIZE[1] / 2]);
        assert_eq!(same, value(Channel::Id) == 0.0);
    }
    // Farther is darker, and never black.
    depths.sort_by(|a, b| a.0.total_cmp(&b.0));
    assert!(depths.windows(2).all(|w| w[0].1 >= w[1].1));
    assert!(depths.iter().all(|d| (0.02..=1.0).contains(&d.1)));
    assert!(depths[0].1 - depths[depths.len() - 1].1 > 0.3);
}

#[test]
fn iterations_cost_more_at_silhouettes() {
    let world = world(vec![sphere(1.0)], Vec::new(), 1.0);
    let film = picture(&world, IntegratorKind::Iterations);
    let heat = |pixel| color(&film, pixel).iter().sum::<f64>();
    assert!(heat([SIZE[0] / 2, SIZE[1] / 2]) > 0.0);
    assert_eq!(heat([0, 0]), 0.0);
    assert_eq!(film.counters().hits, picture(&world, IntegratorKind::Id).counters().hits);
}

/// A disk in the floor's plane: where both are met, whether one shades the other is not known.
#[test]
fn doubt_is_where_rays_to_lights_are_doubtful() {
    let light = Light::directional(DVec3::new(0.3, -0.2, 1.0), [1.0; 3]).unwrap();
    let disk = shapes::disk(0.7).unwrap();
    let world = world(vec![floor(6.0, 0.0), disk], vec![light], 1.0);
    let film = picture(&world, IntegratorKind::Direct);
    let mut doubtful = 0;
    for pixel in pixels() {
        let point = vector(&film, [Channel::PX, Channel::PY, Channel::PZ], pixel);
        let doubt = film.value(Channel::Doubt, pixel).unwrap();
        assert!(doubt == 0.0 || point.length() < 0.71, "{pixel:?}: {doubt} at {point}");
        doubtful += u64::from(doubt == 1.0);
    }
    // One sample a pixel, one light.
    assert!(doubtful > 20 && doubtful <= film.counters().doubtful, "{doubtful}");
    // No light, no doubt.
    let flat = picture(&world, IntegratorKind::Normal);
    let sum: f32 = pixels().map(|pixel| flat.value(Channel::Doubt, pixel).unwrap()).sum();
    assert_eq!(sum as u64, flat.counters().doubtful);
}
