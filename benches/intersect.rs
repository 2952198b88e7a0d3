//! The parts of `intersect`, one by one: `cargo bench --bench intersect [-- FILTER]`.
//!
//! | group | what of `intersect` it asks |
//! |---|---|
//! | `packets` | `tracer/packets`, `wide/packet`, `wide/search`; on kernel scalar `scalar/leaf_search` |
//! | `streams` | `tracer/streams`, `wide/stream` |
//! | `single` | `tracer/singles`, `wide/single`; on kernel scalar `scalar/leaf_search` and `scalar/newton` |
//! | `shadows` | any hit instead of the first, of rays that leave a hit; in packets |
//! | `silhouette` | `lanes` and `one_ray` of `wide/proof`, and the exact solver for what they leave |
//! | `hierarchy` | `tree`, `scalar/traverse`, `wide/packet/traverse`, and the leaves' boxes: rays that meet nothing |
//! | `exact` | `exact` alone |
//! | `all` | all hits: `exact` and `crossings/merge` |
//! | `build` | `bvh` and `tree`, and the leaves of `patch` |
//!
//! `cargo bench --bench instructions` says how many instructions the kernels take; `nurbray bench`
//! compares them with others, over whole pictures.
#![allow(
    clippy::unwrap_used,
    missing_docs,
    reason = "a benchmark that cannot be set up has nothing to say; criterion's macros make \
              undocumented functions"
)]

mod models;
mod subject;

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use nurbray::intersect::{Coherence, Kernel, Query, SurfaceBvh, Tracer};
use subject::Subject;

/// Models left out: what takes seconds to build takes minutes to measure.
const LARGE: [&str; 2] = ["wave256", "wave1024"];

/// Scenes measured too: one polynomial without trims, one with.
const SCENES: [&str; 2] = ["teapot.json", "trimmed_sheet.toml"];

fn names() -> impl Iterator<Item = &'static str> {
    let made = models::MODELS.iter().map(|(name, _)| *name);
    made.filter(|name| !LARGE.contains(name)).chain(SCENES)
}

fn subjects() -> Vec<(&'static str, Subject)> {
    names().map(|name| (name, Subject::new(name))).collect()
}

/// A group of measurements: some rays of every model, by every kernel this processor has.
fn by_kernel(
    criterion: &mut Criterion,
    group: &str,
    rays: impl Fn(&Subject) -> Vec<Query>,
    mut trace: impl FnMut(&mut Tracer<'_>, &[Query]),
) {
    let mut group = criterion.benchmark_group(group);
    for (name, subject) in &subjects() {
        let rays = rays(subject);
        if rays.is_empty() {
            continue; // a model that fills the picture leaves no ray that meets nothing
        }
        group.throughput(Throughput::Elements(rays.len() as u64));
        for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = subject.bvh.tracer_with(kernel);
            group.bench_function(format!("{kernel}/{name}"), |bencher| {
                bencher.iter(|| trace(&mut tracer, black_box(&rays)));
            });
        }
    }
}

/// First hits: packets of coherent rays, streams of others.
fn first_hits(
    criterion: &mut Criterion,
    group: &str,
    rays: impl Fn(&Subject) -> Vec<Query>,
    coherence: Coherence,
) {
    let mut answers = Vec::new();
    by_kernel(criterion, group, rays, |tracer, rays| {
        tracer.first_hits(rays, coherence, &mut answers);
    });
}

fn packets(criterion: &mut Criterion) {
    first_hits(criterion, "packets", |subject| subject.rays.clone(), Coherence::Coherent);
}

fn streams(criterion: &mut Criterion) {
    first_hits(criterion, "streams", |subject| subject.rays.clone(), Coherence::Incoherent);
}

fn single(criterion: &mut Criterion) {
    let mut answers = Vec::new();
    let rays = |subject: &Subject| subject.rays.clone();
    by_kernel(criterion, "single", rays, |tracer, rays| {
        answers.clear();
        answers.extend(rays.iter().map(|query| tracer.first_hit(query)));
    });
}

fn shadows(criterion: &mut Criterion) {
    let mut answers = Vec::new();
    by_kernel(criterion, "shadows", Subject::shadow_rays, |tracer, rays| {
        tracer.occlusions(rays, Coherence::Coherent, &mut answers);
    });
}

fn silhouette(criterion: &mut Criterion) {
    for (group, coherence) in
        [("silhouette", Coherence::Coherent), ("silhouette-streams", Coherence::Incoherent)]
    {
        first_hits(criterion, group, Subject::silhouette, coherence);
    }
}

fn hierarchy(criterion: &mut Criterion) {
    let misses = |subject: &Subject| subject.rays_with(false);
    first_hits(criterion, "hierarchy", misses, Coherence::Coherent);
}

/// The exact solver on every leaf a ray may meet: slow, so a 16th of the rays that hit. The
/// kernel has no part in it.
fn exactly(criterion: &mut Criterion, group: &str, mut trace: impl FnMut(&mut Tracer<'_>, &Query)) {
    let mut group = criterion.benchmark_group(group);
    for (name, subject) in &subjects() {
        let rays: Vec<_> = subject.rays_with(true).into_iter().step_by(16).collect();
        group.throughput(Throughput::Elements(rays.len() as u64));
        let mut tracer = subject.bvh.tracer();
        group.bench_function(*name, |bencher| {
            bencher.iter(|| black_box(&rays).iter().for_each(|ray| trace(&mut tracer, ray)));
        });
    }
}

fn exact(criterion: &mut Criterion) {
    exactly(criterion, "exact", |tracer, ray| {
        let _ = black_box(tracer.exact_first_hit(ray));
    });
}

fn all(criterion: &mut Criterion) {
    let mut hits = Vec::new();
    exactly(criterion, "all", |tracer, ray| {
        let _ = tracer.all_hits(ray, &mut hits);
    });
}

/// From surfaces to what is traced.
fn build(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("build");
    group.sample_size(10); // wave64 takes a tenth of a second
    for name in names() {
        let surfaces = subject::surfaces(name);
        group.bench_function(name, |bencher| {
            bencher.iter(|| SurfaceBvh::build(black_box(&surfaces)).unwrap());
        });
    }
}

criterion_group!(
    benches, packets, single, streams, shadows, silhouette, hierarchy, exact, all, build
);
criterion_main!(benches);
