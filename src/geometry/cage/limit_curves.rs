//! Curves of constant parameter on a limit surface.

use glam::{DVec3, DVec4};

use super::limit_surface::{FaceRect, LimitSurface};
use crate::geometry::{Direction, KnotVector, NurbsCurve, bernstein};

impl LimitSurface {
    /// The curves on which one parameter of a unit square is fixed at `at`, from 0 to 1, exactly
    /// those of the patches: one for each unbroken part, over its part of the domain, in order.
    /// There is none where the unit square is not part of the surface (Doo–Sabin surfaces end in
    /// the middle of faces).
    ///
    /// A line between two patches takes the curve of the patch that begins there. Inner knots have
    /// full multiplicity, the degree, because each patch gives a Bézier piece.
    pub fn unit_curves(&self, unit: usize, fixed: Direction, at: f64) -> Vec<NurbsCurve> {
        let along = fixed.other();
        let first = self.patches.partition_point(|patch| patch.rect.unit < unit);
        let beyond = self.patches.partition_point(|patch| patch.rect.unit <= unit);

        // The patches that the line meets; of two beside it, the one that begins there comes first.
        let mut met: Vec<(FaceRect, bool, usize)> = (first..beyond)
            .filter_map(|index| {
                let rect = self.patches[index].rect;
                let [low, high] = rect.ranges()[fixed];
                let ends = at == high;
                ((low <= at && at < high) || ends).then_some((rect, ends, index))
            })
            .collect();
        met.sort_by(|(a, a_ends, _), (b, b_ends, _)| {
            a.low[along].total_cmp(&b.low[along]).then(a_ends.cmp(b_ends))
        });

        // Pieces that follow each other are one curve.
        let offset = if along == Direction::U { unit as f64 } else { 0.0 };
        let mut curves: Vec<(Vec<f64>, Vec<DVec4>)> = Vec::new();
        let mut reached = f64::NEG_INFINITY;
        for (rect, _, index) in met {
            let [low, high] = rect.ranges()[along];
            if low < reached {
                continue; // beside a patch that is there already
            }
            let piece = self.piece(index, fixed, (at - rect.low[fixed]) / rect.size[fixed]);
            match curves.last_mut().filter(|_| low == reached) {
                Some((breaks, control)) => {
                    breaks.push(offset + high);
                    control.pop();
                    control.extend(piece);
                }
                None => curves.push((vec![offset + low, offset + high], piece)),
            }
            reached = high;
        }
        curves.into_iter().map(|(breaks, control)| self.joined(&breaks, control)).collect()
    }

    /// The Bézier points of a line of constant parameter, at a fraction of the patch.
    fn piece(&self, patch: usize, fixed: Direction, share: f64) -> Vec<DVec4> {
        let n = self.degree + 1;
        let net = &self.control[patch * n * n..][..n * n];
        let basis =
            bernstein(self.degree, share).unwrap_or([f64::NAN; crate::geometry::MAX_DEGREE + 1]);
        let point = |k: usize| {
            let across = |l: usize| {
                let [i, j] = fixed.pair(l, k);
                net[i * n + j]
            };
            (0..n).map(|l| basis[l] * across(l)).sum::<DVec3>().extend(1.0)
        };
        (0..n).map(point).collect()
    }

    fn joined(&self, breaks: &[f64], control: Vec<DVec4>) -> NurbsCurve {
        let p = self.degree;
        let last = breaks.len() - 1;
        let times = |k: usize| if k == 0 || k == last { p + 1 } else { p };
        let knots = breaks.iter().enumerate().flat_map(|(k, &t)| std::iter::repeat_n(t, times(k)));
        NurbsCurve::assembled(KnotVector::derived(p, knots.collect()), control)
    }
}
