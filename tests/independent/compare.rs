//! Two answers for the same rays: each difference is explained, or it is a fault.

use nurbray::intersect::{Hit, HitFlags, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::judge::{Judge, Measure};
use crate::model::{Model, nurbs};
use crate::program::{Report, TheirHit};
use crate::rays::Site;
use crate::root::{self, Nearest, nearest};

/// How far from a root, in sizes of the model, a library's hit may be to stand for the root:
/// SISL and OpenCASCADE stop at 1e-7 of a size, and for grazing rays at the square root of that.
const THEIR_ACCURACY: f64 = 3e-4;

/// The distance from a ray, in sizes of the model, that a library takes for a hit.
const THEIR_RESOLUTION: f64 = 1e-6;

/// Counts over the rays of one class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) rays: usize,
    /// Hits of ours, and those of them that the library has, too.
    pub(crate) ours: usize,
    pub(crate) confirmed: usize,
    /// Hits of the library.
    pub(crate) theirs: usize,
    /// Hits of the library before the ray begins: its lines are endless.
    pub(crate) behind: usize,
    /// Hits of the library where the surface does not come as near to the ray as we promise,
    /// but as near as the library does.
    pub(crate) near_misses: usize,
    /// Hits of the library where there is none.
    pub(crate) false_hits: usize,
    /// Hits of the library inside a stretch of which we report the ends.
    pub(crate) inside: usize,
    /// Hits of the library where our answer is doubtful.
    pub(crate) doubted: usize,
    /// Rays the library gives up on, or sees inside a surface.
    pub(crate) failed: usize,
    pub(crate) curves: usize,
    /// Hits of the library that we miss, and hits of ours that break the promise.
    pub(crate) faults: Vec<String>,
}

impl Tally {
    /// Hits of ours the library misses, on rays it does not give up on.
    pub(crate) fn missed(&self) -> usize {
        self.ours - self.confirmed
    }

    pub(crate) fn print(&self, name: &str) {
        println!(
            "{name:12} rays {:4} | ours {:4}, missed by it {:3} | its {:4}: behind {:3}, near misses \
             {:3}, inside {:3}, false {:3}, doubted by us {:3} | given up {:3}, curves {:3} | faults {}",
            self.rays,
            self.ours,
            self.missed(),
            self.theirs,
            self.behind,
            self.near_misses,
            self.inside,
            self.false_hits,
            self.doubted,
            self.failed,
            self.curves,
            self.faults.len()
        );
    }
}

/// Compares both answers for some rays.
pub(crate) fn compare(model: &Model, bvh: &SurfaceBvh, rays: &[Ray], report: &Report) -> Tally {
    let judge = Judge::new(model);
    let mut tally = Tally {
        rays: rays.len(),
        theirs: report.hits.len(),
        failed: report.failed.len(),
        curves: report.curves.len(),
        ..Tally::default()
    };
    let mut tracer = bvh.tracer();
    for (index, ray) in rays.iter().enumerate() {
        let mut ours = Vec::new();
        let doubtful = tracer.all_hits(&Query::primary(*ray), &mut ours);
        let first = tracer.first_hit(&Query::primary(*ray));
        let theirs: Vec<_> = report.hits.iter().filter(|hit| hit.ray == index).collect();
        for hit in &ours {
            tally.faults.extend(judge.unsound(ray, hit).map(|fault| format!("{ray:?}: {fault}")));
        }
        for hit in &theirs {
            match their_hit(model, &judge, ray, (hit, &ours)) {
                // All hits come from the scalar search, the first one from the fast path.
                Verdict::Shared(t) => {
                    let late = first.hit.is_none_or(|first| late(&judge, ray, &first, t));
                    if late && !first.doubtful {
                        let first = first.hit.map(|hit| (hit.t, hit.uv));
                        tally
                            .faults
                            .push(format!("{ray:?}: {hit:?} is before our first, {first:?}"));
                    }
                }
                Verdict::Behind => tally.behind += 1,
                Verdict::NearMiss => tally.near_misses += 1,
                Verdict::False => tally.false_hits += 1,
                Verdict::Inside => tally.inside += 1,
                Verdict::Lost(_) if doubtful => tally.doubted += 1,
                Verdict::Lost(root) => {
                    tally.faults.push(format!("{ray:?}: we miss {hit:?}, which is {root:?}"));
                }
            }
        }

        // Nothing is expected of the library if a ray runs inside a surface or it gives up.
        let spared = report.failed.contains(&index) || report.curves.contains(&index);
        let certain = HitFlags::DOUBTFUL.with(HitFlags::INSIDE);
        let certain = |hit: &&Hit| (hit.flags.bits() & certain.bits()) == 0;
        for hit in ours.iter().filter(certain).filter(|_| !spared) {
            tally.ours += 1;
            tally.confirmed += usize::from(theirs.iter().any(|other| near(model, hit, other)));
        }
    }
    tally
}

/// Whether our first hit is surely behind another of our hits.
fn late(judge: &Judge<'_>, ray: &Ray, first: &Hit, t: f64) -> bool {
    let at = judge.measure(ray, first);
    let slack = judge.slack(at.promise + at.excuse, at.incidence);
    (first.t - t) * ray.direction().length() > 2.0 * slack
}

/// The verdict on a hit of the library.
enum Verdict {
    /// We have it, too; `t` of our first hit that may be the same.
    Shared(f64),
    /// It is behind the ray's origin, or at it.
    Behind,
    /// The surface passes the ray there, nearer than the library can tell.
    NearMiss,
    /// The ray runs inside the surface there, as our flags say.
    Inside,
    /// There is no root near it.
    False,
    /// There is a root near it, and we do not have it.
    Lost(Nearest),
}

fn their_hit(
    model: &Model,
    judge: &Judge<'_>,
    ray: &Ray,
    (hit, ours): (&TheirHit, &[Hit]),
) -> Verdict {
    let surface = nurbs(&model.surfaces[hit.surface]);
    let size = model.radius();
    let root = nearest(surface, ray, hit.uv);
    // The iteration may slip to another root, which says nothing of this hit.
    let stayed = surface.point_at(root.uv).distance(hit.point) <= THEIR_ACCURACY * size;
    let site = Site { surface: hit.surface, u: root.uv.x, v: root.uv.y };
    let measure = judge.measure_at(ray, site, root.t);
    let slack = |at: &Measure| judge.slack(at.promise + at.excuse, at.incidence);

    // Domains end somewhere in the outer half of the promise. Rounding of u and v comes on top.
    let promised = 0.5 * measure.promise + (measure.excuse - measure.promise);
    let length = ray.direction().length();
    if root.t * length <= slack(&measure) {
        return Verdict::Behind;
    }
    if !stayed || root.distance > promised {
        // If the iteration slipped away, the place reported says how near the surface passes.
        let there = if stayed { root } else { root::at(surface, ray, hit.uv) };
        let near = there.distance <= THEIR_RESOLUTION * size;
        return if near { Verdict::NearMiss } else { Verdict::False };
    }

    let same = |ours: &Hit| {
        let apart = (ours.t - root.t).abs() * length;
        let reach = slack(&measure) + slack(&judge.measure(ray, ours));
        // Or the ray touches the surface, and between both hits the two cannot be distinguished.
        let between = nearest(surface, ray, 0.5 * (ours.uv + root.uv));
        let touches = between.distance <= 2.0 * measure.promise
            && (between.t - 0.5 * (ours.t + root.t)).abs() * length <= 0.1 * apart;
        apart <= reach || (ours.surface as usize == hit.surface && apart <= 1e-5 * size && touches)
    };
    match ours.iter().find(|hit| same(hit)) {
        Some(hit) => Verdict::Shared(hit.t),
        None if is_inside(ours, root.t) => Verdict::Inside,
        None => Verdict::Lost(root),
    }
}

/// Whether a place on the ray is in a stretch that runs inside a surface: between two ends that
/// are flagged so, or between the ray's origin and one end if the other is behind the origin.
fn is_inside(ours: &[Hit], t: f64) -> bool {
    let ends = ours.iter().filter(|hit| hit.flags.contains(HitFlags::INSIDE));
    let (mut before, mut behind) = (0, 0);
    for end in ends {
        if end.t < t { before += 1 } else { behind += 1 }
    }
    behind > 0 && (before > 0 || behind % 2 == 1)
}

/// Whether a hit of the library stands for one of ours.
fn near(model: &Model, ours: &Hit, theirs: &TheirHit) -> bool {
    ours.point.distance(theirs.point) <= THEIR_ACCURACY * model.radius()
}

#[cfg(test)]
mod tests {
    use glam::{DVec2, DVec3};

    use super::*;
    use crate::models;

    /// For a ray that meets a sphere at t = 2 and t = 4: compares hits on the model `of_whom` with
    /// a library's hits at the places `their`, or at both crossings if there are none.
    fn tally(of_whom: &Model, their: &[DVec2]) -> Tally {
        let truth = models::sphere();
        let direction = DVec3::new(-0.6, -0.48, -0.64);
        let ray = Ray::new(-3.0 * direction, direction).unwrap();
        let mut hits = Vec::new();
        let _ = truth.bvh().tracer().all_hits(&Query::primary(ray), &mut hits);
        let hit = |uv: DVec2| {
            let point = nurbs(&truth.surfaces[0]).point_at(uv);
            TheirHit { ray: 0, surface: 0, uv, point }
        };
        let uvs = if their.is_empty() { vec![hits[0].uv, hits[1].uv] } else { their.to_vec() };
        let report = Report { hits: uvs.into_iter().map(hit).collect(), ..Report::default() };
        compare(&truth, &of_whom.bvh(), &[ray], &report)
    }

    #[test]
    fn a_hit_we_miss_is_a_fault_and_a_false_one_is_not() {
        let sphere = models::sphere();
        let agreed = tally(&sphere, &[]);
        assert_eq!((agreed.ours, agreed.confirmed, agreed.faults.len()), (2, 2, 0));
        // A part of the sphere, with the same parameters, has only one of the hits.
        let hits = [2.0, 4.0].map(|t| {
            let direction = DVec3::new(-0.6, -0.48, -0.64);
            let ray = Ray::with_range(-3.0 * direction, direction, t - 0.1, t + 0.1).unwrap();
            sphere.bvh().tracer().first_hit(&Query::primary(ray)).hit.unwrap().uv
        });
        let (below, above) =
            nurbs(&sphere.surfaces[0]).split_u(0.5 * (hits[0].x + hits[1].x)).unwrap();
        for part in [below, above] {
            let lost = tally(&Model::new("part", part), &[]);
            assert_eq!((lost.ours, lost.faults.len()), (1, 1), "{lost:?}");
            assert!(lost.faults[0].contains("we miss"), "{lost:?}");
        }
        let elsewhere = tally(&sphere, &[DVec2::new(0.5, 0.1)]);
        assert_eq!((elsewhere.false_hits, elsewhere.missed()), (1, 2));
        assert!(elsewhere.faults.is_empty());
    }
}
