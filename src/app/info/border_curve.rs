//! A border or a trim edge, sampled, and how far points are from it.

use glam::{DVec2, DVec3};
use nurbray::geometry::trim::{Side, Trims};
use nurbray::geometry::{Chart, KnotVector, NurbsCurve, NurbsSurface};
use nurbray::math::Aabb;

use super::super::border::Border;

/// The least number of intervals a border is sampled in; pieces get equal numbers of them.
pub(crate) const INTERVALS: usize = 32;

/// Newton's steps to a nearest point. They double the correct digits from a start within one
/// of 32 intervals, so that six would do for a smooth piece; the rest is for corners.
const STEPS: usize = 16;

/// What a curve is.
#[derive(Debug)]
enum Source<'a> {
    /// A border of a surface, of which trims may have cut off a part.
    Border { surface: &'a NurbsSurface, trims: Option<&'a Trims>, border: Border },
    /// A trim edge.
    Edge(NurbsCurve),
}

impl Source<'_> {
    fn knots(&self) -> &KnotVector {
        match self {
            Self::Border { surface, border, .. } => border.knots(surface),
            Self::Edge(curve) => curve.knots(),
        }
    }

    fn point(&self, t: f64) -> DVec3 {
        match self {
            Self::Border { surface, border, .. } => border.point(surface, t),
            Self::Edge(curve) => curve.point_at(t),
        }
    }

    /// The point at `t`, and how fast it moves with `t`.
    fn tangent(&self, t: f64) -> (DVec3, DVec3) {
        match self {
            Self::Border { surface, border, .. } => border.tangent(surface, t),
            Self::Edge(curve) => {
                let at = curve.derivatives(t);
                (at.point, at.first)
            }
        }
    }

    fn keeps(&self, t: f64) -> bool {
        let Self::Border { trims: Some(trims), border, .. } = self else { return true };
        let (u, v) = border.uv(t);
        trims.contains(DVec2::new(u, v)) != Side::Outside
    }
}

/// A border or a trim edge as a curve in space, with points on it.
#[derive(Debug)]
pub(crate) struct BorderCurve<'a> {
    source: Source<'a>,
    /// Parameters and points, from end to end.
    samples: Vec<(f64, DVec3)>,
    bounds: Aabb,
    length: f64,
    /// How far the curve bulges from the polyline through its samples, at most, as it seems.
    sag: f64,
}

impl<'a> BorderCurve<'a> {
    /// Samples a border.
    pub(crate) fn new(chart: &'a Chart<'_>, border: Border) -> Self {
        let (surface, trims) = (&*chart.surface, chart.trims.as_deref());
        Self::sampled(Source::Border { surface, trims, border })
    }

    /// Samples a trim edge.
    pub(crate) fn of_edge(edge: NurbsCurve) -> Self {
        Self::sampled(Source::Edge(edge))
    }

    fn sampled(source: Source<'a>) -> Self {
        let knots = source.knots();
        let per_span = INTERVALS.div_ceil(knots.spans().count());
        let within = knots.spans().flat_map(|span| {
            let at = move |k| span.start + (span.end - span.start) * k as f64 / per_span as f64;
            (0..per_span).map(at)
        });
        let samples: Vec<(f64, DVec3)> =
            within.chain([knots.domain().1]).map(|t| (t, source.point(t))).collect();

        let length = samples.windows(2).map(|pair| pair[0].1.distance(pair[1].1)).sum();
        // Over two intervals a curve bulges four times as far from its chord as over one.
        let bulge = |w: &[(f64, DVec3)]| to_segment(w[1].1, [w[0].1, w[2].1]).0;
        let sag = samples.windows(3).map(bulge).fold(0.0, f64::max);
        let bounds = Aabb::around(samples.iter().map(|sample| sample.1)).grown(sag);
        Self { source, samples, bounds, length, sag }
    }

    /// Holds the curve.
    pub(crate) fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Its length, by the polyline through its samples.
    pub(crate) fn length(&self) -> f64 {
        self.length
    }

    /// Points on it, from end to end, but for those that trims have cut off.
    pub(crate) fn points(&self) -> Vec<DVec3> {
        let kept = self.samples.iter().filter(|(t, _)| self.source.keeps(*t));
        kept.map(|sample| sample.1).collect()
    }

    /// The distance of a point from the curve; `None` if that is more than `near`, or if the
    /// nearest point is an end of the curve that the point lies beyond, or cut off by trims.
    pub(crate) fn distance(&self, point: DVec3, near: f64) -> Option<f64> {
        let reach = near + self.sag;
        let grown = self.bounds.grown(near);
        if !(grown.min.cmple(point).all() && point.cmple(grown.max).all()) {
            return None;
        }

        // The nearest interval of the polyline tells where to look.
        let interval = |pair: &[(f64, DVec3)]| {
            let (distance, share) = to_segment(point, [pair[0].1, pair[1].1]);
            (distance, pair[0].0 + share * (pair[1].0 - pair[0].0))
        };
        let nearest = self.samples.windows(2).map(interval).min_by(|x, y| x.0.total_cmp(&y.0))?;
        let (coarse, start) = nearest;
        if coarse > reach {
            return None;
        }
        let (distance, beyond, t) = self.refined(point, start);
        let there = distance <= near && beyond <= distance.max(near) * BEYOND;
        (there && self.source.keeps(t)).then_some(distance)
    }

    /// The distance from the point of the curve nearest to `point`, searched from `t` on, how
    /// far `point` lies beyond an end, along the curve, and where that nearest point is.
    ///
    /// Gauss–Newton: `C(t + δ) ≈ C + δ C'` is nearest for `δ = (point − C) · C' / |C'|²`. On
    /// curves that meet, the residual is 0 and convergence quadratic.
    fn refined(&self, point: DVec3, mut t: f64) -> (f64, f64, f64) {
        let (start, end) = self.source.knots().domain();
        let mut best = (f64::INFINITY, 0.0, t);
        for _ in 0..STEPS {
            let (on_curve, speed) = self.source.tangent(t);
            let step = (point - on_curve).dot(speed) / speed.length_squared();
            let beyond = match (t + step).clamp(start, end) {
                clamped if clamped == t => (step * speed).length(),
                _ => 0.0,
            };
            let distance = point.distance(on_curve);
            if distance < best.0 {
                best = (distance, beyond, t);
            }
            let next = (t + step).clamp(start, end);
            if next == t || next.is_nan() {
                break;
            }
            t = next;
        }
        best
    }
}

/// A point that lies beyond the end of a curve by more than this share of what counts as near
/// is beside another part of the model.
const BEYOND: f64 = 1e-3;

/// The distance of a point from a segment, and where on it (0 to 1) the nearest point is.
fn to_segment(point: DVec3, [a, b]: [DVec3; 2]) -> (f64, f64) {
    let along = b - a;
    let share = ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
    let share = if share.is_nan() { 0.0 } else { share }; // a segment that is a point
    (point.distance(a + share * along), share)
}

#[cfg(test)]
mod tests {
    use nurbray::geometry::shapes;

    use super::*;

    #[test]
    fn distances_from_a_circle_are_exact() {
        let cylinder = shapes::cylinder(1.0, 2.0).unwrap();
        let whole = Chart::whole(&cylinder);
        let rim = Border::all(&cylinder)
            .into_iter()
            .map(|border| BorderCurve::new(&whole, border))
            .find(|curve| (curve.length() - std::f64::consts::TAU).abs() < 0.05)
            .unwrap();
        let z = rim.points()[0].z;
        for k in 0..50 {
            let (sin, cos) = (0.123 * f64::from(k)).sin_cos();
            for offset in [0.0, 1e-9, 1e-3] {
                let point = DVec3::new((1.0 + offset) * cos, (1.0 + offset) * sin, z);
                let distance = rim.distance(point, 0.01).unwrap();
                // Two evaluations round, and so does the point made here.
                assert!((distance - offset).abs() < 1e-15, "{k}: {distance} for {offset}");
            }
            assert_eq!(rim.distance(DVec3::new(0.9 * cos, 0.9 * sin, z), 0.01), None);
        }
    }

    #[test]
    fn points_beyond_an_end_are_not_beside_the_curve() {
        let plane = shapes::plane(1.0, 1.0).unwrap();
        let whole = Chart::whole(&plane);
        let curve = BorderCurve::new(&whole, Border::all(&plane)[0]);
        let points: Vec<DVec3> = curve.points();
        let (first, last) = (points[0], points[points.len() - 1]);
        let along = (last - first).normalize();
        assert_eq!(curve.distance(last, 0.01), Some(0.0));
        assert_eq!(curve.distance(last + 1e-3 * along, 0.01), None);
        let beside = last + 1e-3 * along.cross(DVec3::Z);
        assert!((curve.distance(beside, 0.01).unwrap() - 1e-3).abs() < 1e-15);
    }
}
