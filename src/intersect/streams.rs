//! First hits of many incoherent rays, and whether anything lies on them.

use fearless_simd::{Level, Simd, dispatch};
use fearless_simd_macros::simd;

use super::singles::Certain;
use super::wide::{FLIGHTS, Wanted, trace_stream};
use super::{Answer, Occlusion, Shot, Tracer};

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
            let (view, stream) = (self.bvh.view(), &self.stream);
            for &k in &met[..count] {
                let (hit, t_from_z) = stream.hit(k);
                let ray = shots[k].ray();
                answers[first + k] = Certain::new(&view, ray, hit).answer(ray, t_from_z);
            }
            for (k, shot) in shots.iter().enumerate() {
                if self.stream.is_alone(k) {
                    self.findings.statistics.uncount();
                    answers[first + k] = self.single_first(level, shot);
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
                    self.single_any(level, shot)
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
    trace_stream(simd, &tracer.bvh.view(), shots, wanted, &mut tracer.stream);
}
