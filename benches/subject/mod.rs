//! What the benchmarks trace: models, and rays at them that exercise each part of `intersect`.

use std::path::Path;

use glam::{DVec2, DVec3};
use nurbray::geometry::Surface;
use nurbray::intersect::{Query, SurfaceBvh};
use nurbray::math::Ray;
use nurbray::scene::{Camera, Projection, View, World};

use crate::models;

/// Pixels along the side of the picture that the rays belong to.
const PIXELS: u32 = 1024;

/// Squares of 8 × 8 pixels along the side of the picture from which rays are taken: as
/// coherent as those of a whole picture, but few enough to stay in the caches.
const SQUARES: u32 = 4;

/// Rows and columns along which outlines are searched.
const LINES: u32 = 32;

/// Places on outlines from which rays are taken.
const OUTLINES: usize = 64;

/// A model, and rays of a picture of it.
pub(crate) struct Subject {
    pub(crate) bvh: SurfaceBvh,
    camera: Camera,
    /// The rays: squares of 8 × 8 pixels, spread over a picture of the model.
    pub(crate) rays: Vec<Query>,
}

impl Subject {
    pub(crate) fn new(name: &str) -> Self {
        let bvh = SurfaceBvh::build(&surfaces(name)).unwrap();
        let camera = camera(&bvh);
        let rays = (0..64 * SQUARES * SQUARES).map(|k| ray(&camera, pixel(k))).collect();
        Self { bvh, camera, rays }
    }

    /// The rays that meet something, or those that meet nothing.
    pub(crate) fn rays_with(&self, hit: bool) -> Vec<Query> {
        let mut tracer = self.bvh.tracer();
        let rays = self.rays.iter().copied();
        rays.filter(|ray| tracer.first_hit(ray).hit.is_some() == hit).collect()
    }

    /// Rays of the pixels on both sides of outlines, 8 × 2 at a place. There the certificates of
    /// whole leaves no longer hold, so that proofs for single rays, Newton's iteration without any
    /// proof, and the exact solver have their turn.
    pub(crate) fn silhouette(&self) -> Vec<Query> {
        let places = self.outlines();
        let few = places.iter().step_by(places.len().div_ceil(OUTLINES).max(1));
        let around = few.flat_map(|&place| {
            (0..16).map(move |k| place + shift(DVec2::new(3.5, 0.5), [k % 8, k / 8]))
        });
        around.map(|at| ray(&self.camera, at)).collect()
    }

    /// Places in the picture, to within half a pixel, where a model begins or ends.
    fn outlines(&self) -> Vec<DVec2> {
        let mut tracer = self.bvh.tracer();
        let mut meets = |at: DVec2| tracer.first_hit(&ray(&self.camera, at)).hit.is_some();
        let step = 1.0 / f64::from(LINES);
        let mut places = Vec::new();
        for k in 0..LINES * LINES {
            let at = step * (DVec2::new(f64::from(k % LINES), f64::from(k / LINES)) + 0.5);
            for along in [DVec2::new(step, 0.0), DVec2::new(0.0, step)] {
                let mut ends = [at, at + along];
                let met = ends.map(&mut meets);
                if met[0] == met[1] {
                    continue;
                }
                while ends[0].distance(ends[1]) > 1.0 / f64::from(PIXELS) {
                    let middle = 0.5 * (ends[0] + ends[1]);
                    ends[usize::from(meets(middle) != met[0])] = middle;
                }
                places.push(0.5 * (ends[0] + ends[1]));
            }
        }
        places
    }

    /// Rays from what the picture shows to a light above it.
    pub(crate) fn shadow_rays(&self) -> Vec<Query> {
        let (low, high) = self.bvh.bounds().unwrap();
        let light = 0.5 * (low + high) + 3.0 * (high - low).length() * DVec3::new(0.3, 0.2, 0.9);
        let mut tracer = self.bvh.tracer();
        let hits = self.rays.iter().filter_map(|ray| tracer.first_hit(ray).hit);
        let to_light = hits.map(|hit| {
            let ray = Ray::with_range(hit.point, light - hit.point, 0.0, 1.0).unwrap();
            Query::leaving(ray, &hit)
        });
        to_light.collect()
    }
}

/// The surfaces of one of [`models::MODELS`], or else of a scene of the repository.
pub(crate) fn surfaces(name: &str) -> Vec<Surface> {
    if let Some(surfaces) = models::surfaces(name) {
        return surfaces.unwrap().into_iter().map(Surface::from).collect();
    }
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name);
    let world = World::new(&nurbray::io::load_input(&path).unwrap()).unwrap();
    world.surfaces().iter().map(|one| one.surface.clone()).collect()
}

/// A camera that just shows the bounding box.
fn camera(bvh: &SurfaceBvh) -> Camera {
    let (low, high) = bvh.bounds().unwrap();
    let look_at = 0.5 * (low + high);
    let distance = 2.0 * (high - low).length();
    let look_from = look_at + distance * DVec3::new(0.45, -0.79, 0.423).normalize();
    let view = View { look_from, look_at, up: DVec3::Z };
    Camera::new(view, Projection::Perspective { fov: 28.0 }).unwrap()
}

/// The middle of the `k`th pixel, square by square, in a picture of 1 × 1.
fn pixel(k: u32) -> DVec2 {
    let (square, within) = (k / 64, k % 64);
    let [x, y] = [square % SQUARES, square / SQUARES].map(f64::from);
    let middle = (DVec2::new(x, y) + 0.5) / f64::from(SQUARES);
    middle + shift(DVec2::splat(3.5), [within % 8, within / 8])
}

/// The offset of a pixel from a middle, both given in pixels, as a share of the picture's side.
fn shift(middle: DVec2, [x, y]: [u32; 2]) -> DVec2 {
    (DVec2::new(f64::from(x), f64::from(y)) - middle) / f64::from(PIXELS)
}

fn ray(camera: &Camera, at: DVec2) -> Query {
    Query::primary(camera.ray(at, 1.0))
}
