//! Traces rays into rows on all threads of the current pool, in the order of the rays.

use nurbray::intersect::{Coherence, Kernel, SurfaceBvh};
use nurbray::math::Ray;
use rayon::prelude::*;

use super::super::progress::Progress;
use super::table::{ALL_COLUMNS, COLUMNS, all_rows, first_row};

/// Rays a thread takes at a time. Fixed, so that neither packets nor hits depend on the number
/// of threads; a few milliseconds' work.
const CHUNK: usize = 4096;

/// What to trace, and how.
#[derive(Clone, Copy, Debug)]
pub(super) struct Tracing<'a> {
    /// The surfaces.
    pub(super) bvh: &'a SurfaceBvh,
    /// The code that searches.
    pub(super) kernel: Kernel,
    /// Whether neighbouring rays are alike.
    pub(super) coherence: Coherence,
}

/// The rows of all rays, and counts.
#[derive(Debug)]
pub(super) struct Traced<const N: usize> {
    /// What goes into the file, chunk after chunk of the rays.
    pub(super) rows: Vec<Vec<[f64; N]>>,
    /// Hits among the rows.
    pub(super) hits: u64,
    /// Rays whose answer is doubtful.
    pub(super) doubtful: u64,
}

impl<const N: usize> Traced<N> {
    fn joined(parts: Vec<Self>) -> Self {
        let mut whole = Self { rows: Vec::new(), hits: 0, doubtful: 0 };
        for part in parts {
            whole.rows.extend(part.rows);
            whole.hits += part.hits;
            whole.doubtful += part.doubtful;
        }
        whole
    }
}

/// The first hit of each ray: a row for every ray.
pub(super) fn first_hits(
    tracing: &Tracing<'_>,
    rays: &[Ray],
    progress: &Progress,
) -> Traced<COLUMNS> {
    let parts = rays.par_chunks(CHUNK).with_max_len(1).map(|rays| {
        let mut tracer = tracing.bvh.tracer_with(tracing.kernel);
        let mut answers = Vec::new();
        tracer.first_hits(rays, tracing.coherence, &mut answers);
        progress.add_rays(rays.len() as u64);

        Traced {
            rows: vec![answers.iter().map(first_row).collect()],
            hits: answers.iter().filter(|answer| answer.hit.is_some()).count() as u64,
            doubtful: answers.iter().filter(|answer| answer.doubtful).count() as u64,
        }
    });
    Traced::joined(parts.collect())
}

/// Every hit of each ray, by increasing `t`.
pub(super) fn all_hits(
    tracing: &Tracing<'_>,
    rays: &[Ray],
    progress: &Progress,
) -> Traced<ALL_COLUMNS> {
    let parts = rays.par_chunks(CHUNK).with_max_len(1).enumerate().map(|(chunk, rays)| {
        let mut tracer = tracing.bvh.tracer_with(tracing.kernel);
        let mut hits = Vec::new();
        let mut rows = Vec::new();
        let mut part = Traced { rows: Vec::new(), hits: 0, doubtful: 0 };
        for (offset, ray) in rays.iter().enumerate() {
            let doubtful = tracer.all_hits(ray, &mut hits);
            rows.extend(all_rows(chunk * CHUNK + offset, &hits, doubtful));
            part.hits += hits.len() as u64;
            part.doubtful += u64::from(doubtful);
        }
        part.rows.push(rows);
        progress.add_rays(rays.len() as u64);
        part
    });
    Traced::joined(parts.collect())
}
