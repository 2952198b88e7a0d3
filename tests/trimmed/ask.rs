//! Trimmed surfaces, and every way to trace rays at them.

use glam::{DVec2, DVec3};
use nurbray::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
use nurbray::geometry::{NurbsSurface, Surface, TrimmedSurface, shapes};
use nurbray::intersect::{Coherence, Hit, Kernel, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::random::Random;

pub(crate) fn trimmed(surface: NurbsSurface, kept: Kept, loops: &[TrimLoop]) -> TrimmedSurface {
    let domain = TrimDomain::with_seams_of(&surface).unwrap();
    TrimmedSurface::new(surface, Trims::new(domain, kept, loops).unwrap()).unwrap()
}

pub(crate) fn circle(u: f64, v: f64, radius: f64) -> TrimLoop {
    TrimLoop::circle(DVec2::new(u, v), radius).unwrap()
}

pub(crate) fn polygon(corners: &[(f64, f64)]) -> TrimLoop {
    let corners: Vec<DVec2> = corners.iter().map(|&(u, v)| DVec2::new(u, v)).collect();
    TrimLoop::polygon(&corners).unwrap()
}

pub(crate) fn build(surfaces: &[Surface]) -> SurfaceBvh {
    SurfaceBvh::build(surfaces).unwrap()
}

/// The first hits of rays by every way to trace them: as coherent and as incoherent batches, by the
/// exact solver, and as the first of all hits. Any-hit searches must agree on whether there is a
/// hit. Doubtful answers are `None` in the outer option.
pub(crate) fn asked(
    bvh: &SurfaceBvh,
    queries: &[Query],
) -> Vec<(String, Vec<Option<Option<Hit>>>)> {
    let mut said = Vec::new();
    for &kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
        let mut tracer = bvh.tracer_with(kernel);
        let mut any = Vec::new();
        tracer.occlusions(queries, Coherence::Incoherent, &mut any);
        for coherence in [Coherence::Coherent, Coherence::Incoherent] {
            let mut answers = Vec::new();
            tracer.first_hits(queries, coherence, &mut answers);
            for ((query, answer), any) in queries.iter().zip(&answers).zip(&any) {
                let same = answer.doubtful || any.doubtful || answer.hit.is_some() == any.occluded;
                assert!(same, "{kernel}: {query:?}\n{answer:?}\n{any:?}");
            }
            let hits = answers.iter().map(|answer| (!answer.doubtful).then_some(answer.hit));
            said.push((format!("{kernel}, {coherence:?}"), hits.collect()));
        }
    }
    let mut tracer = bvh.tracer();
    let exact = queries.iter().map(|query| {
        let answer = tracer.exact_first_hit(query);
        (!answer.doubtful).then_some(answer.hit)
    });
    said.push(("exact".into(), exact.collect()));
    let all = queries.iter().map(|query| {
        let mut hits = Vec::new();
        let doubtful = tracer.all_hits(query, &mut hits);
        (!doubtful).then(|| hits.first().copied())
    });
    said.push(("all hits".into(), all.collect()));
    said
}

/// A ray through a point, from some way off.
pub(crate) fn through(point: DVec3, random: &mut Random) -> Query {
    let direction = loop {
        let direction = random.direction();
        if direction.z.abs() > 0.05 {
            break direction;
        }
    };
    let origin = point - random.between(0.5, 3.0) * direction;
    Query::primary(Ray::new(origin, direction).unwrap())
}

/// A square of side 2 about the origin with a round hole of radius 0.6.
pub(crate) fn holed() -> TrimmedSurface {
    trimmed(shapes::plane(2.0, 2.0).unwrap(), Kept::Even, &[circle(0.5, 0.5, 0.3)])
}
