//! Tessellations converge to us: depth and normals at second order, silhouettes within the
//! tessellation's own error.

use nurbray::io::mesh::Tessellation;
use nurbray::math::Ray;

use crate::images::{Picture, Seen, exact, meshed};
use crate::loaded::embree;
use crate::models::{self, Model, SIZE};
use crate::picture;

/// Second order, less what four resolutions and a few thousand pixels leave uncertain.
const LEAST_SLOPE: f64 = 1.8;

/// Pixels are compared if they see the surface at more than this sine of the angle between ray
/// and tangent plane: nearer a silhouette, depth errors grow without bound.
const STEEP: f64 = 0.25;

/// The measurements at one resolution.
struct Level {
    cells: usize,
    tessellation: Tessellation,
    picture: Picture,
}

fn levels(model: &Model, rays: &[Ray]) -> Option<Vec<Level>> {
    let embree = embree()?;
    let level = |cells| {
        let tessellation = Tessellation::with_cells(&model.surfaces, cells).unwrap();
        let picture = meshed(&embree, &tessellation, rays);
        Level { cells, tessellation, picture }
    };
    Some(model.cells.map(level).into_iter().collect())
}

/// Pixels that see the same surface in every picture, away from silhouettes: all their neighbours
/// hit, steeply and with similar normals.
fn comparable(ours: &Picture, levels: &[Level], rays: &[Ray]) -> Vec<usize> {
    let [width, height] = SIZE;
    let steep = |at: usize| ours[at].filter(|s| s.normal.dot(rays[at].direction()).abs() > STEEP);
    let inner = (1..height - 1).flat_map(|y| (1..width - 1).map(move |x| y * width + x));
    inner
        .filter(|&at| {
            let Some(here) = steep(at) else { return false };
            let near = [at - width, at - 1, at + 1, at + width];
            let smooth = near
                .iter()
                .all(|&near| steep(near).is_some_and(|there| there.normal.dot(here.normal) > 0.8));
            let same = |seen: Option<Seen>| seen.is_some_and(|s| s.surface == here.surface);
            smooth && levels.iter().all(|level| same(level.picture[at]))
        })
        .collect()
}

/// The slope of `log error` over `−log cells`, by least squares.
fn order(errors: &[(usize, f64)]) -> f64 {
    let points: Vec<_> = errors.iter().map(|&(n, e)| (-(n as f64).ln(), e.ln())).collect();
    let count = points.len() as f64;
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / count;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / count;
    let xy: f64 = points.iter().map(|p| (p.0 - mean_x) * (p.1 - mean_y)).sum();
    let xx: f64 = points.iter().map(|p| (p.0 - mean_x).powi(2)).sum();
    xy / xx
}

fn root_mean_square(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), v| (sum + v * v, count + 1.0));
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Checks one model at all resolutions, and leaves a comparison picture.
fn check(model: &Model) {
    let rays = model.view.rays();
    let Some(levels) = levels(model, &rays) else { return };
    let ours = exact(model, &rays);
    let pixels = comparable(&ours, &levels, &rays);
    let hits = ours.iter().flatten().count();
    assert!(2 * pixels.len() > hits, "{}: only {} of {hits} pixels", model.name, pixels.len());

    let mut depths = Vec::new();
    let mut normals = Vec::new();
    for level in &levels {
        let pairs = || pixels.iter().filter_map(|&at| Some((at, ours[at]?, level.picture[at]?)));
        let depth = pairs().map(|(_, ours, theirs)| theirs.depth - ours.depth);
        let angle = pairs().map(|(_, ours, theirs)| ours.normal.angle_between(theirs.normal));
        depths.push((level.cells, root_mean_square(depth)));
        normals.push((level.cells, root_mean_square(angle)));

        // No depth is off by more than the tessellation's deviation explains, with some room for
        // what sampling missed, the curvature between both hits, and f32.
        let allowed = 1.25 * level.tessellation.deviation() + 1e-6 * level.tessellation.diagonal();
        for (at, ours, theirs) in pairs() {
            let sine = ours.normal.dot(rays[at].direction()).abs();
            let off = (theirs.depth - ours.depth).abs() * sine;
            assert!(off < allowed, "{} {}: pixel {at}: {off:e}", model.name, level.cells);
        }
        check_silhouette(model, &ours, level);
    }
    let (depth, normal) = (order(&depths), order(&normals));
    assert!(depth > LEAST_SLOPE, "{}: depth, order {depth}: {depths:?}", model.name);
    assert!(normal > LEAST_SLOPE, "{}: normals, order {normal}: {normals:?}", model.name);
    println!("{}: order {depth:.3} in depth, {normal:.3} in normals", model.name);
    picture::write(model.name, &ours, &levels[0].picture);
}

/// Pixels hit in one picture only must lie in a band along the silhouette as wide as the
/// tessellation's deviation appears, and fill no more than it.
///
/// Every point of one surface is within the deviation of a point of the other, so their
/// projections reach no farther beyond each other than that, seen from the nearest point.
fn check_silhouette(model: &Model, ours: &Picture, level: &Level) {
    let [width, height] = SIZE;
    let nearest = ours.iter().flatten().map(|seen| seen.depth).fold(f64::INFINITY, f64::min);
    let band = 1.5 * level.tessellation.deviation() / (nearest * model.view.pixel());

    let hit = |x: usize, y: usize| ours[y * width + x].is_some();
    let mut differing = 0;
    let mut border = 0;
    for y in 0..height {
        for x in 0..width {
            let here = hit(x, y);
            border += usize::from(x + 1 < width && hit(x + 1, y) != here);
            border += usize::from(y + 1 < height && hit(x, y + 1) != here);
            if level.picture[y * width + x].is_some() == here {
                continue;
            }
            differing += 1;
            // The silhouette passes between two pixel centres; one of them may be this far.
            let reach = band + std::f64::consts::SQRT_2;
            let near = |x0: usize, y0: usize| {
                let (dx, dy) = (x0 as f64 - x as f64, y0 as f64 - y as f64);
                dx.hypot(dy) <= reach
            };
            let whole = reach.ceil() as usize;
            let crossed = (y.saturating_sub(whole)..(y + whole + 1).min(height)).any(|y0| {
                (x.saturating_sub(whole)..(x + whole + 1).min(width))
                    .any(|x0| near(x0, y0) && hit(x0, y0) != here)
            });
            assert!(crossed, "{} {}: ({x}, {y}) is off the band", model.name, level.cells);
        }
    }
    // Steps of the border overestimate its length; a few pixels are decided by chance.
    let most = (border as f64 * band).ceil() as usize + 4;
    assert!(differing <= most, "{} {}: {differing} pixels, {most}", model.name, level.cells);
}

#[test]
fn sphere() {
    check(&models::sphere());
}

#[test]
fn torus() {
    check(&models::torus());
}

#[test]
fn wavy_b_spline() {
    check(&models::wavy());
}

#[test]
fn teapot() {
    check(&models::teapot());
}

#[test]
fn orders_are_slopes() {
    let errors = [10, 20, 40].map(|n| (n, 3.0 / (n as f64).powi(2)));
    assert!((order(&errors) - 2.0).abs() < 1e-12);
}
