//! Makes curves compatible: of the same degree, over the same knots.

use super::ConstructError;
use super::net_size::net_size;
use crate::geometry::polygon::{merged, refine};
use crate::geometry::{CurveError, KnotError, KnotVector, NurbsCurve};

/// Knots of two curves that differ by no more than this fraction of their common domain are the
/// same: mapping a knot to another domain costs a few rounding errors. Kept apart, they would leave
/// useless spans; merged, they move a curve by no more than rounding error.
const SAME_KNOT: f64 = 8.0 * f64::EPSILON;

/// Weights whose relative difference is at most this are the same: several rounding errors of each,
/// as for control points.
const SAME_WEIGHT: f64 = 16.0 * f64::EPSILON;

/// The same curves, of their highest degree, clamped, over one common knot vector.
///
/// If all domains are the same, the curves keep theirs; otherwise all are moved to `[0, 1]`.
/// Degrees are elevated, then each curve gets the knots it lacks (Piegl & Tiller 1997, 10.3): no
/// curve changes its shape or its speed.
///
/// # Errors
/// When a curve has two knots too close together (`which` gives the curve's name), or when the
/// curves together would have more control points than a constructed surface may have.
pub(crate) fn compatible(
    curves: &[NurbsCurve],
    which: &dyn Fn(usize) -> String,
) -> Result<Vec<NurbsCurve>, ConstructError> {
    let Some(first) = curves.first() else { return Ok(Vec::new()) };
    let degree = curves.iter().map(|curve| curve.knots().degree()).fold(1, usize::max);
    let same_domain = curves.iter().all(|curve| curve.domain() == first.domain());
    let domain = if same_domain { first.domain() } else { [0.0, 1.0] };
    let prepare = |curve: &NurbsCurve| {
        let curve = curve.clamped().on_domain(domain[0], domain[1])?;
        curve.elevated(degree - curve.knots().degree())
    };
    // A short curve of high degree makes long curves of low degree many times as long, and each
    // curve gets the knots of all. So the size of the result is computed before the result is made.
    let elevated = |curve: &NurbsCurve| {
        let raised = degree - curve.knots().degree();
        curve.control().len().saturating_add(raised.saturating_mul(curve.knots().spans().count()))
    };
    let longest = curves.iter().map(elevated).fold(0, usize::max);
    net_size(longest, curves.len())?;
    let mut prepared = Vec::with_capacity(curves.len());
    for (index, curve) in curves.iter().enumerate() {
        prepared.push(prepare(curve).map_err(|e| ConstructError::of(which(index))(e))?);
    }

    // Knots that are the same get the same value, then every curve gets every knot.
    let places = distinct_knots(&prepared, SAME_KNOT * (domain[1] - domain[0]));
    for (index, curve) in prepared.iter_mut().enumerate() {
        let knots = snapped(curve.knots(), &places).map_err(CurveError::from);
        let knots = knots.map_err(ConstructError::of(which(index)))?;
        *curve = NurbsCurve::assembled(knots, curve.control().to_vec());
    }
    let highest = |&knot: &f64| {
        let times = prepared.iter().map(|curve| curve.knots().multiplicity(knot));
        (knot, times.fold(0, usize::max))
    };
    let common: Vec<(f64, usize)> = places.iter().map(highest).collect();
    let inner: usize = common.iter().map(|(_, times)| times).sum();
    net_size(inner + degree + 1, curves.len())?;
    let with_all = |curve: &NurbsCurve| {
        let lacking = lacking(&common, curve.knots());
        let control = refine(curve.knots(), curve.control(), &lacking);
        let values = merged(curve.knots().values(), &lacking);
        NurbsCurve::assembled(KnotVector::derived(degree, values), control)
    };
    Ok(prepared.iter().map(with_all).collect())
}

/// Whether the weights of two compatible curves are proportional, up to rounding. If they are,
/// curves with the same control points are the same.
pub(crate) fn same_weights(a: &NurbsCurve, b: &NurbsCurve) -> bool {
    let factor = a.control()[0].w / b.control()[0].w;
    (0..a.control().len()).all(|i| {
        let (weight, other) = (a.control()[i].w, factor * b.control()[i].w);
        (weight - other).abs() <= SAME_WEIGHT * weight
    })
}

/// The distinct values of the inner knots of all curves, in order; knots that are the same within
/// `tolerance` are represented by the first of them.
fn distinct_knots(curves: &[NurbsCurve], tolerance: f64) -> Vec<f64> {
    let inner = |curve: &NurbsCurve| {
        let (values, p) = (curve.knots().values(), curve.knots().degree());
        values[p + 1..values.len() - p - 1].to_vec()
    };
    let mut all: Vec<f64> = curves.iter().flat_map(inner).collect();
    all.sort_by(f64::total_cmp);
    let mut distinct: Vec<f64> = Vec::new();
    for knot in all {
        let new = distinct.last().is_none_or(|last| knot - last > tolerance);
        if new {
            distinct.push(knot);
        }
    }
    distinct
}

/// The knot vector with each inner knot moved to the common value it belongs to.
fn snapped(knots: &KnotVector, places: &[f64]) -> Result<KnotVector, KnotError> {
    let (p, n) = (knots.degree(), knots.point_count());
    let mut values = knots.values().to_vec();
    for value in &mut values[p + 1..n] {
        // A place has the value of its first knot, so this knot's place is the last one at or below
        // it.
        let above = places.partition_point(|place| place <= value);
        if let Some(place) = above.checked_sub(1).and_then(|index| places.get(index)) {
            *value = *place;
        }
    }
    KnotVector::new(p, values)
}

/// The knots, in order, that a knot vector lacks to have all common ones.
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
            assert_eq!((new.domain(), new.knots().degree()), ([0.0, 1.0], 3));
            let [a, b] = old.domain();
            for k in 0..=40 {
                let s = f64::from(k) / 40.0;
                let off = new.point_at(s).distance(old.point_at(a + s * (b - a)));
                assert!(off < 2e-15 * new.magnitude(), "{s}: {off:e}");
            }
        }
        // One third occurs twice, as a knot of its own and as a moved one: they are one knot.
        assert_eq!(same[0].knots().spans().count(), 4);
    }

    #[test]
    fn knots_that_are_hardly_apart_become_one_of_higher_multiplicity() {
        let half = 0.5 + f64::EPSILON;
        let curves = [
            curve(3, &[(0.0, 4), (0.5, 1), (half, 1), (1.0, 4)], 1.0),
            curve(3, &[(0.0, 4), (0.25, 1), (1.0, 4)], 2.0),
        ];
        let same = compatible(&curves, &|_| String::new()).unwrap();
        assert_eq!(same[0].knots(), same[1].knots());
        assert_eq!(same[1].knots().multiplicity(0.5), 2);
        for k in 0..=40 {
            let t = f64::from(k) / 40.0;
            for (new, old) in same.iter().zip(&curves) {
                assert!(new.point_at(t).distance(old.point_at(t)) < 1e-14, "{t}");
            }
        }
    }

    #[test]
    fn what_would_be_too_large_is_not_begun() {
        let long = (0..300_000).map(|k| DVec3::new(f64::from(k), 0.0, 0.0)).collect::<Vec<_>>();
        let long = NurbsCurve::polyline(&long).unwrap();
        let high = curve(30, &[(0.0, 31), (1.0, 31)], 1.0);
        let which = |_| String::new();
        assert_eq!(
            compatible(&[long, high], &which).unwrap_err().to_string(),
            "8999971 × 2 control points: at most 16777216 in all are supported"
        );
        // A thousand curves without a common knot.
        let own = |k: usize| {
            let mut knots = vec![(0.0, 2), (20.0, 2)];
            let inner = (0..17).map(|i| (1.0 + i as f64 + 1e-4 * k as f64, 1));
            knots.splice(1..1, inner);
            curve(1, &knots, 1.0)
        };
        let curves: Vec<_> = (0..1000).map(own).collect();
        assert_eq!(
            compatible(&curves, &which).unwrap_err().to_string(),
            "17002 × 1000 control points: at most 16777216 in all are supported"
        );
    }

    #[test]
    fn equal_domains_are_kept() {
        let curves = [curve(1, &[(2.0, 2), (3.0, 2)], 1.0), curve(2, &[(2.0, 3), (3.0, 3)], 2.0)];
        let same = compatible(&curves, &|_| String::new()).unwrap();
        assert_eq!(same[0].domain(), [2.0, 3.0]);
        assert_eq!(same[1], curves[1]);
    }
}
