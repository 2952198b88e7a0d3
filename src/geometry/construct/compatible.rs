//! Curves made compatible: of one degree, over the same knots.

use super::ConstructError;
use crate::geometry::line::{merged, refine};
use crate::geometry::{CurveError, KnotError, KnotVector, NurbsCurve};

/// Knots of two curves that differ by no more than this share of their common domain are one
/// knot: proportional moving of a knot costs a few roundings. Kept apart, they would leave
/// spans of no use to anyone; joined, a curve moves by no more than rounding.
const SAME_KNOT: f64 = 8.0 * f64::EPSILON;

/// The same curves, of their highest degree, clamped, over one common knot vector.
///
/// Curves whose domains are the same keep theirs; otherwise all are moved to `[0, 1]`. Degrees
/// are elevated, then each gets the knots it lacks (Piegl & Tiller 1997, 10.3): none changes
/// its shape or its speed.
///
/// # Errors
/// When a curve has two knots too close together; `which` says how to call a curve.
pub(crate) fn compatible(
    curves: &[NurbsCurve],
    which: &dyn Fn(usize) -> String,
) -> Result<Vec<NurbsCurve>, ConstructError> {
    let Some(first) = curves.first() else { return Ok(Vec::new()) };
    let degree = curves.iter().map(|curve| curve.knots().degree()).fold(1, usize::max);
    let same_domain = curves.iter().all(|curve| curve.domain() == first.domain());
    let domain = if same_domain { first.domain() } else { (0.0, 1.0) };
    let prepare = |curve: &NurbsCurve| {
        let curve = curve.clamped().on_domain(domain.0, domain.1)?;
        curve.elevated(degree - curve.knots().degree())
    };
    let mut prepared = Vec::with_capacity(curves.len());
    for (index, curve) in curves.iter().enumerate() {
        prepared.push(prepare(curve).map_err(|e| ConstructError::of(which(index))(e))?);
    }

    let common = common_knots(&prepared, SAME_KNOT * (domain.1 - domain.0));
    let with_all = |curve: &NurbsCurve| {
        let snapped = snapped(curve.knots(), &common)?;
        let lacking = lacking(&common, &snapped);
        let control = refine(&snapped, curve.control(), &lacking);
        let values = merged(snapped.values(), &lacking);
        Ok::<_, CurveError>(NurbsCurve::assembled(KnotVector::derived(degree, values), control))
    };
    let all = prepared.iter().enumerate();
    all.map(|(index, curve)| with_all(curve).map_err(ConstructError::of(which(index)))).collect()
}

/// The inner knots of all curves with the highest multiplicity of each, those that are the
/// same within `tolerance` as one.
fn common_knots(curves: &[NurbsCurve], tolerance: f64) -> Vec<(f64, usize)> {
    let inner = |curve: &NurbsCurve| {
        let (values, p) = (curve.knots().values(), curve.knots().degree());
        let runs = values[p + 1..values.len() - p - 1].chunk_by(|a, b| a == b);
        runs.map(|run| (run[0], run.len())).collect::<Vec<_>>()
    };
    let mut all: Vec<(f64, usize)> = curves.iter().flat_map(inner).collect();
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut common: Vec<(f64, usize)> = Vec::new();
    for (knot, times) in all {
        match common.last_mut() {
            Some(last) if knot - last.0 <= tolerance => last.1 = last.1.max(times),
            _ => common.push((knot, times)),
        }
    }
    common
}

/// The knots with each inner one moved to the nearest common one.
fn snapped(knots: &KnotVector, common: &[(f64, usize)]) -> Result<KnotVector, KnotError> {
    let (p, n) = (knots.degree(), knots.point_count());
    let mut values = knots.values().to_vec();
    for value in &mut values[p + 1..n] {
        // The common knot at or below it: clusters are named by their first knot.
        let index = common.partition_point(|(knot, _)| knot <= value);
        if let Some((knot, _)) = index.checked_sub(1).and_then(|index| common.get(index)) {
            *value = *knot;
        }
    }
    KnotVector::new(p, values)
}

/// The knots, in order, that a vector lacks to have all the common ones.
fn lacking(common: &[(f64, usize)], knots: &KnotVector) -> Vec<f64> {
    let missing = |&(knot, times): &(f64, usize)| {
        std::iter::repeat_n(knot, times.saturating_sub(knots.multiplicity(knot)))
    };
    common.iter().flat_map(missing).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn curve(degree: usize, knots: &[(f64, usize)], seed: f64) -> NurbsCurve {
        let knots = KnotVector::with_multiplicities(degree, knots).unwrap();
        let n = knots.point_count();
        let point = |k: usize| DVec3::new(k as f64, (seed * k as f64).sin(), seed);
        let weights = (0..n).map(|k| 1.0 + 0.5 * (seed + k as f64).cos()).collect();
        NurbsCurve::new(knots, (0..n).map(point).collect(), Some(weights)).unwrap()
    }

    #[test]
    fn degrees_and_knots_agree_and_no_curve_moves() {
        let third = 1.0 / 3.0;
        let curves = [
            curve(1, &[(0.0, 2), (third, 1), (1.0, 2)], 1.0),
            curve(3, &[(2.0, 4), (3.0, 2), (3.5, 1), (5.0, 4)], 2.0),
            curve(2, &[(-1.0, 1), (-0.5, 1), (0.0, 1), (0.1, 1), (1.0, 1), (1.5, 2)], 3.0),
        ];
        let same = compatible(&curves, &|k| format!("curve {k}")).unwrap();
        for (new, old) in same.iter().zip(&curves) {
            assert_eq!(new.knots(), same[0].knots());
            assert_eq!((new.domain(), new.knots().degree()), ((0.0, 1.0), 3));
            let (a, b) = old.domain();
            for k in 0..=40 {
                let s = f64::from(k) / 40.0;
                let off = new.point_at(s).distance(old.point_at(a + s * (b - a)));
                assert!(off < 2e-15 * new.magnitude(), "{s}: {off:e}");
            }
        }
        // A third of the way twice, from a knot of its own and from one moved: one knot.
        assert_eq!(same[0].knots().spans().count(), 4);
    }

    #[test]
    fn equal_domains_are_kept() {
        let curves = [curve(1, &[(2.0, 2), (3.0, 2)], 1.0), curve(2, &[(2.0, 3), (3.0, 3)], 2.0)];
        let same = compatible(&curves, &|_| String::new()).unwrap();
        assert_eq!(same[0].domain(), (2.0, 3.0));
        assert_eq!(same[1], curves[1]);
    }
}
