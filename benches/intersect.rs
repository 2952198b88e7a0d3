//! The parts of `intersect`, one by one: `cargo bench --bench intersect [-- FILTER]`.
//!
//! For comparisons with others, over whole pictures, there is `nurbray bench`.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a benchmark that cannot be set up has nothing to say; criterion's macros make \
              undocumented functions"
)]

mod models;

use std::hint::black_box;
use std::path::Path;

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3};
use nurbray::geometry::NurbsSurface;
use nurbray::intersect::{BuildOptions, Coherence, Kernel, Query, SurfaceBvh};
use nurbray::scene::{Camera, Projection, View, World};

/// Models left out: what takes seconds to build takes minutes to measure.
const LARGE: [&str; 2] = ["wave256", "wave1024"];

/// Rays of one measurement: a picture of 32 × 32, small enough to stay in the caches.
const SIDE: u32 = 32;

/// A model, and rays of a picture of it.
struct Subject {
    name: &'static str,
    surfaces: Vec<NurbsSurface>,
    bvh: SurfaceBvh,
    rays: Vec<Query>,
}

impl Subject {
    fn new(name: &'static str) -> Self {
        let surfaces = match models::surfaces(name) {
            Some(surfaces) => surfaces.unwrap(),
            None => teapot(),
        };
        let bvh = SurfaceBvh::build(&surfaces, &BuildOptions::default()).unwrap();
        let rays = picture(&bvh);
        Self { name, surfaces, bvh, rays }
    }

    fn all() -> Vec<Self> {
        let made = models::MODELS.iter().map(|(name, _)| *name);
        let small = made.filter(|name| !LARGE.contains(name));
        small.chain(["teapot"]).map(Self::new).collect()
    }

    /// The rays that meet something, or those that meet nothing.
    fn rays_with(&self, hit: bool) -> Vec<Query> {
        let mut tracer = self.bvh.tracer();
        let rays = self.rays.iter().copied();
        rays.filter(|ray| tracer.first_hit(ray).hit.is_some() == hit).collect()
    }
}

fn teapot() -> Vec<NurbsSurface> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/teapot.json");
    let world = World::new(&nurbray::io::load_input(&path).unwrap()).unwrap();
    world.surfaces.iter().filter_map(|one| one.surface.nurbs().cloned()).collect()
}

/// Rays of a picture that just shows the bounding box, in squares of 8 × 8 pixels.
fn picture(bvh: &SurfaceBvh) -> Vec<Query> {
    let (low, high) = bvh.bounds().unwrap();
    let look_at = 0.5 * (low + high);
    let distance = 2.0 * (high - low).length();
    let look_from = look_at + distance * DVec3::new(0.45, -0.79, 0.423).normalize();
    let view = View { look_from, look_at, up: DVec3::Z };
    let camera = Camera::new(view, Projection::Perspective { fov: 28.0 }).unwrap();
    let pixel = |k: u32| {
        let (square, within) = (k / 64, k % 64);
        let x = square % (SIDE / 8) * 8 + within % 8;
        let y = square / (SIDE / 8) * 8 + within / 8;
        (DVec2::new(f64::from(x), f64::from(y)) + 0.5) / f64::from(SIDE)
    };
    (0..SIDE * SIDE).map(|k| Query::primary(camera.ray(pixel(k), 1.0))).collect()
}

fn first_hits(
    group: &mut BenchmarkGroup<'_, WallTime>,
    (subject, rays, coherence): (&Subject, &[Query], Coherence),
) {
    group.throughput(Throughput::Elements(rays.len() as u64));
    for &kernel in Kernel::ALL {
        let mut tracer = subject.bvh.tracer_with(kernel);
        let mut answers = Vec::new();
        group.bench_function(format!("{kernel}/{}", subject.name), |bencher| {
            bencher.iter(|| tracer.first_hits(black_box(rays), coherence, &mut answers));
        });
    }
}

/// First hits of coherent rays: packets where a kernel has them.
fn packets(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("packets");
    for subject in &Subject::all() {
        first_hits(&mut group, (subject, &subject.rays, Coherence::Coherent));
    }
}

/// First hits, ray by ray.
fn single(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("single");
    for subject in &Subject::all() {
        group.throughput(Throughput::Elements(subject.rays.len() as u64));
        for &kernel in Kernel::ALL {
            let mut tracer = subject.bvh.tracer_with(kernel);
            group.bench_function(format!("{kernel}/{}", subject.name), |bencher| {
                bencher.iter(|| {
                    for ray in black_box(&subject.rays) {
                        black_box(tracer.first_hit(ray));
                    }
                });
            });
        }
    }
}

/// Rays that meet nothing: what is left is the way through the hierarchy, and the leaves'
/// boxes.
fn hierarchy(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("hierarchy");
    for subject in &Subject::all() {
        let rays = subject.rays_with(false);
        first_hits(&mut group, (subject, &rays, Coherence::Coherent));
    }
}

/// The exact solver on every leaf a ray may meet: slow, so a 16th of the rays that hit.
fn exact(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("exact");
    for subject in &Subject::all() {
        let rays: Vec<_> = subject.rays_with(true).into_iter().step_by(16).collect();
        group.throughput(Throughput::Elements(rays.len() as u64));
        let mut tracer = subject.bvh.tracer();
        group.bench_function(subject.name, |bencher| {
            bencher.iter(|| {
                for ray in black_box(&rays) {
                    black_box(tracer.exact_first_hit(ray));
                }
            });
        });
    }
}

/// From surfaces to what is traced.
fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    group.sample_size(10); // wave64 takes a tenth of a second
    for subject in &Subject::all() {
        group.bench_function(subject.name, |bencher| {
            bencher.iter(|| {
                SurfaceBvh::build(black_box(&subject.surfaces), &BuildOptions::default()).unwrap()
            });
        });
    }
}

criterion_group!(benches, packets, single, hierarchy, exact, build);
criterion_main!(benches);
