//! First hits of many incoherent rays, and whether anything lies on them.

use fearless_simd::Simd;
use fearless_simd_macros::simd;

use super::singles::Certain;
use crate::intersect::level::{Level, dispatch};
use crate::intersect::query::OneShot;
use crate::intersect::wanted::Wanted;
use crate::intersect::wide::{FLIGHTS, trace_stream};
use crate::intersect::{Answer, Occlusion, Shot, Tracer};

impl Tracer<'_> {
    /// First hits of many rays, appended to `answers`.
    pub(super) fn first_hits_in_streams<Q: Shot>(
        &mut self,
        level: Level,
        shots: &[Q],
        answers: &mut Vec<Answer>,
    ) {
        answers.reserve(shots.len());
        for shots in shots.chunks(FLIGHTS) {
            dispatch!(level, simd => trace(simd, self, shots, Wanted::First));
            let first = answers.len();
            answers.extend(shots.iter().map(|_| Answer::default()));
            // Which rays have hits is unpredictable, so their indices are collected without a
            // branch.
            let (mut met, mut count) = ([0; FLIGHTS], 0);
            for k in 0..shots.len() {
                met[count] = k;
                count += usize::from(self.stream.is_met(k));
            }
            let (view, stream) = (&self.view, &self.stream);
            for &k in &met[..count] {
                let (hit, t_from_z) = stream.hit(k);
                let ray = shots[k].ray();
                answers[first + k] = Certain::new(view, ray, hit).answer(ray, t_from_z);
            }
            for (k, shot) in shots.iter().enumerate() {
                if self.stream.is_alone(k) {
                    self.findings.statistics.uncount();
                    answers[first + k] = self.single_first(level, OneShot::of(shot));
                }
            }
        }
    }

    /// Whether anything lies on each of many rays, appended to `answers`.
    pub(super) fn occlusions_in_streams<Q: Shot>(
        &mut self,
        level: Level,
        shots: &[Q],
        answers: &mut Vec<Occlusion>,
    ) {
        answers.reserve(shots.len());
        for shots in shots.chunks(FLIGHTS) {
            dispatch!(level, simd => trace(simd, self, shots, Wanted::Any));
            for (k, shot) in shots.iter().enumerate() {
                let occluded = self.stream.is_met(k);
                answers.push(if self.stream.is_alone(k) && !occluded {
                    self.findings.statistics.uncount();
                    self.single_any(level, OneShot::of(shot))
                } else {
                    Occlusion { occluded, doubtful: false }
                });
            }
        }
    }
}

#[simd]
fn trace<S: Simd, Q: Shot>(simd: S, tracer: &mut Tracer<'_>, shots: &[Q], wanted: Wanted) {
    tracer.findings.statistics.rays += shots.len() as u64;
    trace_stream(simd, &tracer.view, shots, wanted, &mut tracer.stream);
}

#[cfg(test)]
mod tests {
    use glam::{DAffine3, DVec2, DVec3};

    use crate::geometry::trim::{Kept, TrimDomain, TrimLoop, Trims};
    use crate::geometry::{Surface, TrimmedSurface, shapes};
    use crate::intersect::wide::testing::weighted_hills;
    use crate::intersect::{Kernel, Query, SurfaceBvh};
    use crate::math::{Ray, SplitMix};

    /// A torus around hills, a sheet with a hole, and a sphere so small that it is searched in
    /// coordinates of its own.
    fn scene() -> SurfaceBvh {
        let plane = shapes::plane(4.0, 4.0).unwrap();
        let hole = TrimLoop::circle(DVec2::splat(0.5), 0.3).unwrap();
        let trims = Trims::new(TrimDomain::of(&plane).unwrap(), Kept::Even, &[hole]).unwrap();
        let raised = DAffine3::from_translation(1.5 * DVec3::Z);
        let surfaces: [Surface; 4] = [
            shapes::torus(1.5, 0.3).unwrap().into(),
            weighted_hills().into(),
            TrimmedSurface::new(plane, trims).unwrap().into(),
            shapes::sphere(1e-6).unwrap().transformed(&raised).unwrap().into(),
        ];
        SurfaceBvh::build(&surfaces).unwrap()
    }

    /// Error bounds follow from the degrees that a surface has, not from those of its sums.
    #[test]
    fn errors_of_elevated_surfaces_are_the_same_in_streams_and_alone() {
        let plain = shapes::plane(2.0, 2.0).unwrap();
        let elevated = plain.elevated_u(4).unwrap().elevated_v(2).unwrap();
        let turned = DAffine3::from_rotation_x(0.3);
        let surfaces = [plain, elevated.transformed(&turned).unwrap()];
        let bvh = SurfaceBvh::build(&surfaces).unwrap();
        assert_eq!(bvh.patches().pieces()[1].patch.sums_degree(), [1, 1]);
        let mut random = SplitMix::new(8);
        let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
        let queries = (0..200).map(|_| {
            let mut point = |size: f64| DVec3::from_array([(); 3].map(|()| between(-size, size)));
            let (from, target) = (point(9.0), point(0.9));
            Query::primary(Ray::new(from, target - from).unwrap())
        });
        let queries: Vec<Query> = queries.collect();
        for kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(*kernel);
            let Some(level) = kernel.level() else { continue };
            let mut answers = Vec::new();
            tracer.first_hits_in_streams(level, &queries, &mut answers);
            let mut met = [0; 2];
            for (query, answer) in queries.iter().zip(answers) {
                let hits = [answer.hit, tracer.first_hit(query).hit];
                let [Some(one), Some(other)] = hits else { continue };
                assert_eq!(one.surface, other.surface);
                met[one.surface as usize] += 1;
                let ratio = one.root.error / other.root.error;
                assert!((ratio - 1.0).abs() < 1e-6, "{kernel}: {ratio}");
            }
            assert!(met.iter().all(|met| *met > 30), "{met:?}");
        }
    }

    /// Rays through the scene, and rays that leave what they meet.
    fn rays(bvh: &SurfaceBvh) -> Vec<Query> {
        let mut random = SplitMix::new(7);
        let mut between = |low: f64, high: f64| low + (high - low) * random.unit();
        let mut queries = Vec::new();
        let mut tracer = bvh.tracer();
        for k in 0..20_000 {
            let mut point = |size: f64| DVec3::from_array([(); 3].map(|()| between(-size, size)));
            // Half of the lines go to the speck; a third end on the way.
            let target = if k % 2 == 0 { 2e-6 * point(1.0) + 1.5 * DVec3::Z } else { point(1.5) };
            let from = point(4.0);
            let end = if k % 3 == 0 { 0.9 } else { f64::INFINITY };
            let query = Query::primary(Ray::with_range(from, target - from, 0.0, end).unwrap());
            if let Some(hit) = tracer.first_hit(&query).hit {
                queries.push(Query::leaving(Ray::new(hit.point, point(1.0)).unwrap(), &hit));
            }
            queries.push(query);
        }
        queries
    }

    #[test]
    fn first_hits_are_the_same_in_streams_and_alone() {
        let bvh = scene();
        let queries = rays(&bvh);
        for kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(*kernel);
            let Some(level) = kernel.level() else { continue };
            let mut side_by_side = Vec::new();
            tracer.first_hits_in_streams(level, &queries, &mut side_by_side);
            let (mut met, mut doubtful) = (0, 0);
            for (query, a) in queries.iter().zip(&side_by_side) {
                let b = tracer.first_hit(query);
                if a.doubtful || b.doubtful {
                    doubtful += 1;
                    continue;
                }
                let same = match (&a.hit, &b.hit) {
                    (Some(a), Some(b)) => {
                        met += 1;
                        let within = (a.root.error + b.root.error) / query.ray.direction().length();
                        a.surface == b.surface && (a.t - b.t).abs() <= within
                    }
                    (None, None) => true,
                    _ => false,
                };
                assert!(same, "{kernel}: {query:?}: {a:?}, {b:?}");
            }
            assert!(met > 5000 && queries.len() - met > 5000, "{met} of {}", queries.len());
            assert!(doubtful < 100, "{kernel}: {doubtful} of {}", queries.len());
        }
    }

    #[test]
    fn occlusion_is_the_same_in_streams_and_alone() {
        let bvh = scene();
        let queries = rays(&bvh);
        for kernel in Kernel::ALL.iter().filter(|kernel| kernel.is_available()) {
            let mut tracer = bvh.tracer_with(*kernel);
            let Some(level) = kernel.level() else { continue };
            let (mut side_by_side, mut alone) = (Vec::new(), Vec::new());
            tracer.occlusions_in_streams(level, &queries, &mut side_by_side);
            tracer.single_anys(level, &queries, &mut alone);
            let counted = alone.iter().filter(|one| one.occluded).count();
            assert!(counted > 5000 && alone.len() - counted > 5000, "{counted}");
            let doubtful = alone.iter().chain(&side_by_side).filter(|one| one.doubtful).count();
            assert!(doubtful < 100, "{kernel}: {doubtful} of {}", 2 * alone.len());
            for ((query, a), b) in queries.iter().zip(&side_by_side).zip(&alone) {
                let same = a.occluded == b.occluded && a.doubtful == b.doubtful;
                assert!(same || a.doubtful || b.doubtful, "{kernel}: {query:?}: {a:?}, {b:?}");
            }
        }
    }
}
