//! Two answers for the same rays: each difference is explained, or it is a fault.

use nurbray::intersect::{Hit, HitFlags, Query, SurfaceBvh};
use nurbray::math::Ray;

use crate::judge::Judge;
use crate::model::Model;
use crate::program::{Report, TheirHit};
use crate::rays::Site;
use crate::root::{Nearest, nearest};

/// How far from a root, in sizes of the model, a library's hit may be to stand for it: SISL
/// and OpenCASCADE stop at 1e-7 of a size, and at grazing rays at the root of that.
const THEIR_ACCURACY: f64 = 3e-4;

/// What became of the rays of one class.
#[derive(Clone, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) rays: usize,
    /// Hits of ours, and those of them that the library has, too.
    pub(crate) ours: usize,
    pub(crate) confirmed: usize,
    /// Hits of the library.
    pub(crate) theirs: usize,
    /// Hits of the library that are none: the surface does not come so near to the ray.
    pub(crate) false_hits: usize,
    /// Hits of the library where we say that we are in doubt.
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
            "{name:14} rays {:5} | ours {:5}, of them missed by the library {:4} | theirs {:5}, of them \
             false {:4}, doubted by us {:3} | given up {:3} inside {:3} | faults {}",
            self.rays,
            self.ours,
            self.missed(),
            self.theirs,
            self.false_hits,
            self.doubted,
            self.failed,
            self.curves,
            self.faults.len()
        );
    }
}

/// Compares what both say of some rays.
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
        let theirs: Vec<_> = report.hits.iter().filter(|hit| hit.ray == index).collect();
        for hit in &ours {
            tally.faults.extend(judge.unsound(ray, hit).map(|fault| format!("{ray:?}: {fault}")));
        }
        for hit in &theirs {
            match their_hit(model, &judge, ray, (hit, &ours)) {
                Verdict::Shared => {}
                Verdict::False => tally.false_hits += 1,
                Verdict::Lost(_) if doubtful => tally.doubted += 1,
                Verdict::Lost(root) => {
                    tally.faults.push(format!("{ray:?}: we miss {hit:?}, which is {root:?}"));
                }
            }
        }

        // Where a ray runs inside a surface, or they give up, nothing is expected of them.
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

/// What is to be said of a hit of the library.
enum Verdict {
    /// We have it, too.
    Shared,
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
    let surface = &model.surfaces[hit.surface];
    let root = nearest(surface, ray, hit.uv);
    let site = Site { surface: hit.surface, u: root.uv.x, v: root.uv.y };
    let measure = judge.measure_at(ray, site, root.t);
    let length = ray.direction().length();
    let slack = judge.slack(measure.promise + measure.excuse, measure.incidence);

    // Domains end somewhere in the outer half of the slack; and rays begin at t = 0.
    let is_root = root.distance <= 0.5 * measure.promise && root.t * length > slack;
    // The iteration may have slipped to another root: that one says nothing of this hit.
    let size = model.radius();
    let stayed =
        surface.point_at(root.uv.x, root.uv.y).distance(hit.point) <= THEIR_ACCURACY * size;
    if !is_root || !stayed {
        return Verdict::False;
    }
    let same = |ours: &Hit| {
        let other = judge.measure(ray, ours);
        let theirs = judge.slack(other.promise + other.excuse, other.incidence);
        (ours.t - root.t).abs() * length <= slack + theirs
            // Between two roots of a ray that touches, the surface cannot be told from the ray.
            || nearest(surface, &clipped(ray, ours.t, root.t), 0.5 * (ours.uv + root.uv)).distance
                <= 2.0 * measure.promise && (ours.t - root.t).abs() * length <= 1e-5 * size
    };
    if ours.iter().any(same) { Verdict::Shared } else { Verdict::Lost(root) }
}

/// The ray itself: only its middle between two parameters matters to the caller's guess.
fn clipped(ray: &Ray, _: f64, _: f64) -> Ray {
    *ray
}

/// Whether a hit of the library stands for one of ours.
fn near(model: &Model, ours: &Hit, theirs: &TheirHit) -> bool {
    ours.point.distance(theirs.point) <= THEIR_ACCURACY * model.radius()
}
