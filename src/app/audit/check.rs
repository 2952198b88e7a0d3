//! The audit itself: traces every ray by the fast path and by the exact solver, on all threads.

use std::ops::Range;

use nurbray::geometry::Surface;
use nurbray::intersect::{Answer, Coherence, Kernel, Occlusion, Query, SurfaceBvh, Tracer};
use rayon::prelude::*;

use super::class::{Class, shares};
use super::judge::{Judge, Truth};
use super::rays::{RaySource, Shot};
use super::tally::Tally;

/// Rays a thread takes at a time: a few milliseconds' work, and few enough that all threads are
/// busy to the end of a short audit. No answer should depend on it, as none may depend on the
/// other rays of a batch.
const CHUNK: u64 = 512;

/// What to audit.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Audit<'a> {
    /// The surfaces, ready to trace.
    pub(crate) bvh: &'a SurfaceBvh,
    /// The same surfaces as authored, in the same order.
    pub(crate) surfaces: &'a [Surface],
    /// The code to check.
    pub(crate) kernel: Kernel,
    /// The seed of the rays.
    pub(crate) seed: u64,
}

/// Audits with this many rays; `done` is called with the number of rays finished, from any
/// thread. Returns the classes in order, each with its tally; none if there is no surface.
pub(crate) fn audit(
    what: &Audit<'_>,
    rays: u64,
    done: &(impl Fn(u64) + Sync),
) -> Vec<(Class, Tally)> {
    let Some(source) = RaySource::new(what.surfaces, what.seed) else {
        return Vec::new();
    };
    let judge = Judge::new(what.surfaces);
    let classes = source.classes();
    let shares = shares(&classes, rays);
    classes
        .into_iter()
        .zip(shares)
        .map(|(class, share)| {
            // Tallies are added up as they come, but in the order of their rays.
            let whole = (0..share.div_ceil(CHUNK))
                .into_par_iter()
                .map(|chunk_index| {
                    let start = chunk_index * CHUNK;
                    let end = (start + CHUNK).min(share);
                    let tally = chunk(what, (&source, &judge), class, start..end);
                    done(end - start);
                    tally
                })
                .reduce(Tally::default, |mut whole, tally| {
                    whole.merge(tally);
                    whole
                });
            (class, whole)
        })
        .collect()
}

fn chunk(
    what: &Audit<'_>,
    (source, judge): (&RaySource<'_>, &Judge<'_>),
    class: Class,
    indices: Range<u64>,
) -> Tally {
    let mut tracer = what.bvh.tracer_with(what.kernel);
    let (mut hits, mut plain) = (Vec::new(), Vec::new());
    let mut tally = Tally::default();
    // Each third of the rays is traced in its own way, by index: rays that cannot be made leave
    // gaps.
    let mut thirds = [const { Vec::new() }; 3];
    for index in indices {
        if let Some(shot) = source.shot(class, index, &mut tracer) {
            thirds[(index % 3) as usize].push((index, shot));
        }
    }
    let ways = [None, Some(Coherence::Coherent), Some(Coherence::Incoherent)];
    let mut seen: Vec<_> = thirds
        .iter()
        .zip(ways)
        .flat_map(|(shots, way)| shots.iter().zip(look(&mut tracer, way, shots)))
        .collect();
    seen.sort_unstable_by_key(|((index, _), _)| *index);

    for ((_, shot), (answer, shadow)) in seen {
        let undecided = tracer.exact_all_hits(&shot.query, &mut hits); // by the exact solver alone
        if let Some(start) = shot.start {
            let ray = shot.query.ray();
            let _ = tracer.exact_all_hits(ray, &mut plain); // each hit in doubt says so
            hits.extend(plain.iter().filter(|hit| judge.is_ahead(ray, start, hit)));
        }
        let truth = Truth { hits: &hits, undecided };
        tally.add(shot.query.ray(), judge.judge(shot, (&answer, shadow), &truth));
        tally.undecided += u64::from(undecided);
    }
    tally
}

/// Asks the fast path for the first hit and the occlusion of each ray: all rays in one batch, or
/// one by one if `way` is `None`.
fn look(
    tracer: &mut Tracer<'_>,
    way: Option<Coherence>,
    shots: &[(u64, Shot)],
) -> Vec<(Answer, Occlusion)> {
    let queries: Vec<Query> = shots.iter().map(|(_, shot)| shot.query).collect();
    let Some(coherence) = way else {
        return queries
            .iter()
            .map(|query| (tracer.first_hit(query), tracer.occluded(query)))
            .collect();
    };
    let (mut answers, mut shadows) = (Vec::new(), Vec::new());
    tracer.first_hits(&queries, coherence, &mut answers);
    tracer.occlusions(&queries, coherence, &mut shadows);
    answers.into_iter().zip(shadows).collect()
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};
    use nurbray::geometry::{KnotVector, NurbsSurface, shapes};
    use nurbray::math::Ray;

    use super::super::sites::Site;
    use super::*;

    #[test]
    fn the_tallies_do_not_depend_on_the_threads() {
        let surfaces =
            [shapes::sphere(1.0).unwrap().into(), shapes::torus(3.0, 0.5).unwrap().into()];
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let what = Audit { bvh: &bvh, surfaces: &surfaces, kernel: Kernel::default(), seed: 9 };
        let [one, three] = [1, 3].map(|threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| audit(&what, 4000, &|_| ()))
        });
        for ((class, one), (_, three)) in one.iter().zip(&three) {
            assert_eq!(format!("{one:?}"), format!("{three:?}"), "{}", class.name());
        }
        assert_eq!(one.iter().map(|(_, tally)| tally.rays).sum::<u64>(), 4000);
    }

    /// A floor and a wall that are one surface, and a ray that leaves the floor beside the wall.
    #[test]
    fn what_is_right_behind_a_crease_is_ahead_of_a_ray_that_starts_before_it() {
        let profile = [[-1.0, 0.0], [0.0, 0.0], [0.0, 1.0]];
        let net = profile.iter().flat_map(|&[x, z]| [0.0, 1.0].map(|y| DVec3::new(x, y, z)));
        let [u, v] = [3, 2].map(|count| KnotVector::clamped_uniform(1, count).unwrap());
        let surfaces = [NurbsSurface::new(u, v, net.collect(), None).unwrap().into()];
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        let (judge, mut hits) = (Judge::new(&surfaces), Vec::new());
        for (beside, is_met) in [(1e-3, true), (1e-9, true), (1e-13, true), (1e-16, false)] {
            let start = Site { surface: 0, uv: DVec2::new(0.5 - 0.5 * beside, 0.4) };
            let ray = Ray::new(surfaces[0].point_at(start.uv), DVec3::new(1.0, 0.3, 1.0)).unwrap();
            let _ = bvh.tracer().exact_all_hits(&ray, &mut hits);
            let ahead: Vec<_> =
                hits.iter().filter(|hit| judge.is_ahead(&ray, start, hit)).collect();
            assert_eq!(ahead.len(), usize::from(is_met), "{beside:e}: {hits:?}");
            assert!(ahead.iter().all(|hit| (hit.t / beside - 1.0).abs() < 0.1), "{ahead:?}");
        }
    }
}
