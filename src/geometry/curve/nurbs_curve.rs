//! NURBS curves in space.

use glam::{DVec3, DVec4, Vec4Swizzles};

use super::{CurveError, quotient};
use crate::geometry::knots::{MAX_DEGREE, on_span};
use crate::geometry::magnitude::{is_usable, is_usable_weight};
use crate::geometry::polygon::elevate;
use crate::geometry::polygon::{merged, mix_by, refine, restrict, shares};
use crate::geometry::{KnotError, KnotVector};

/// A NURBS curve `C(t) = Σ Nᵢ(t) wᵢ Pᵢ / Σ Nᵢ(t) wᵢ`, stored as its homogeneous control
/// points `(w x, w y, w z, w)`. Plane curves have `z = 0`.
///
/// # Invariants, checked once on construction
/// - there are as many control points as the knots ask for;
/// - no coordinate is larger than [`MAX_MAGNITUDE`](crate::geometry::MAX_MAGNITUDE), and all
///   weights are [usable](is_usable_weight): positive, and neither too small nor too large.
#[derive(Clone, Debug, PartialEq)]
pub struct NurbsCurve {
    knots: KnotVector,
    control: Vec<DVec4>,
}

/// A point of a curve with its first and second derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveDerivatives {
    /// `C`.
    pub point: DVec3,
    /// `C′`.
    pub first: DVec3,
    /// `C″`.
    pub second: DVec3,
}

impl NurbsCurve {
    /// A curve from its knots, its control points, and their weights; without weights it
    /// is polynomial.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn new(
        knots: KnotVector,
        points: Vec<DVec3>,
        weights: Option<Vec<f64>>,
    ) -> Result<Self, CurveError> {
        let weights = weights.unwrap_or_else(|| vec![1.0; points.len()]);
        if weights.len() != points.len() {
            let (weights, points) = (weights.len(), points.len());
            return Err(CurveError::WeightCount { weights, points });
        }
        if let Some(index) = points.iter().position(|&point| !is_usable(point)) {
            return Err(CurveError::Point { index, point: points[index] });
        }
        let control = points.iter().zip(&weights).map(|(&point, &w)| (w * point).extend(w));
        Self::from_homogeneous(knots, control.collect())
    }

    /// A curve from its knots and its homogeneous control points `(w x, w y, w z, w)`.
    ///
    /// # Errors
    /// When one of the invariants above does not hold.
    pub fn from_homogeneous(knots: KnotVector, control: Vec<DVec4>) -> Result<Self, CurveError> {
        let (points, needed) = (control.len(), knots.point_count());
        if points != needed {
            return Err(CurveError::PointCount { points, needed });
        }
        for (index, point) in control.iter().enumerate() {
            let weight = point.w;
            if !is_usable_weight(weight) {
                return Err(CurveError::Weight { index, weight });
            }
            let euclidean = point.xyz() / weight;
            if !is_usable(euclidean) {
                return Err(CurveError::Point { index, point: euclidean });
            }
        }
        Ok(Self { knots, control })
    }

    /// A curve from parts known to be valid.
    pub(crate) fn assembled(knots: KnotVector, control: Vec<DVec4>) -> Self {
        debug_assert_eq!(control.len(), knots.point_count());
        Self { knots, control }
    }

    /// The knots.
    pub fn knots(&self) -> &KnotVector {
        &self.knots
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.knots.degree()
    }

    /// The homogeneous control points `(w x, w y, w z, w)`.
    pub fn control(&self) -> &[DVec4] {
        &self.control
    }

    /// Control point `index` in space; `None` if there is none.
    pub fn point(&self, index: usize) -> Option<DVec3> {
        self.control.get(index).map(|point| point.xyz() / point.w)
    }

    /// The weight of control point `index`; `None` if there is none.
    pub fn weight(&self, index: usize) -> Option<f64> {
        self.control.get(index).map(|point| point.w)
    }

    /// Control point `index` in space, where it is known to exist.
    pub(crate) fn vertex(&self, index: usize) -> DVec3 {
        let point = self.control[index];
        point.xyz() / point.w
    }

    /// The control points in space.
    pub fn points(&self) -> impl ExactSizeIterator<Item = DVec3> {
        self.control.iter().map(|point| point.xyz() / point.w)
    }

    /// The weights of the control points.
    pub fn weights(&self) -> impl ExactSizeIterator<Item = f64> {
        self.control.iter().map(|point| point.w)
    }

    /// Whether the weights differ; with equal weights the curve is polynomial.
    pub fn is_rational(&self) -> bool {
        self.control.iter().any(|point| point.w != self.control[0].w)
    }

    /// The domain.
    pub fn domain(&self) -> [f64; 2] {
        self.knots.domain()
    }

    /// The point `C(t)` by de Boor's algorithm: `p` rounds of knot insertion at `t`, in which
    /// neighbours `d_{j−1}`, `d_j` are mixed in the ratio in which `t` divides the knots they share
    /// (de Boor 1972): `d_j = d_{j−1} + (t − t_j)/(t_{j+k−r} − t_j) (d_j − d_{j−1})` in round r,
    /// with the order `k = p + 1`.
    ///
    /// Off the domain the end pieces continue; NaN gives NaN.
    pub fn point_at(&self, t: f64) -> DVec3 {
        let (p, values) = (self.knots.degree(), self.knots.values());
        let span = self.knots.span_index(t);
        let mut d = [DVec4::ZERO; MAX_DEGREE + 1];
        d[..=p].copy_from_slice(&self.control[span - p..=span]);
        for round in 1..=p {
            for j in (round..=p).rev() {
                let (left, right) = (values[span - p + j], values[span + 1 + j - round]);
                d[j] = mix_by(d[j - 1], d[j], shares(t, left, right));
            }
        }
        let point = d[p].xyz() / d[p].w;
        if t.is_nan() { DVec3::NAN } else { point }
    }

    /// The point `C(t)` with its first and second derivatives, by the quotient rule:
    /// `C′ = (A′ − w′ C) / w`, `C″ = (A″ − 2 w′ C′ − w″ C) / w` (Piegl & Tiller 1997, eq. 4.8).
    ///
    /// At inner knots they belong to the piece that begins there.
    pub fn derivatives(&self, t: f64) -> CurveDerivatives {
        let basis = self.knots.basis_derivatives(t);
        let p = self.knots.degree();
        let [a, a1, a2] = basis.orders.map(|values| {
            let active = &self.control[basis.span - p..=basis.span];
            active.iter().zip(values).map(|(&point, value)| value * point).sum::<DVec4>()
        });
        let point = a.xyz() / a.w;
        let first = (a1.xyz() - a1.w * point) / a.w;
        let second = (a2.xyz() - 2.0 * a1.w * first - a2.w * point) / a.w;
        CurveDerivatives { point, first, second }
    }

    /// Derivative `order` of the curve at `t`; order 0 is the point. At inner knots it belongs to
    /// the piece that begins there.
    ///
    /// It is not finite where a derivative up to this order is beyond f64. The time grows with the
    /// order and the degree.
    pub fn derivative(&self, order: usize, t: f64) -> DVec3 {
        let (p, span) = (self.knots.degree(), self.knots.span_index(t));
        let active = &self.control[span - p..=span];
        let is_polynomial = active.iter().all(|point| point.w == active[0].w);
        let homogeneous = |order: usize| -> DVec4 {
            let value = |i| on_span((p, self.knots.values()), (i, order), (span, t));
            (span - p..=span).map(|i| value(i) * self.control[i]).sum()
        };
        let (points, mut weights): (Vec<DVec3>, Vec<f64>) =
            (0..=p).map(homogeneous).map(|part| (part.xyz(), part.w)).unzip();
        if is_polynomial {
            weights[1..].fill(0.0); // not what rounding leaves
        }
        quotient::derivative(order, &points, &weights)
    }

    /// The same curve with the knot `t` inserted `times` times.
    ///
    /// # Errors
    /// When `t` is off the domain or would occur more than `p + 1` times.
    pub fn insert_knot(&self, t: f64, times: usize) -> Result<Self, CurveError> {
        let (degree, [start, end]) = (self.knots.degree(), self.domain());
        let within = start <= t && t <= end; // false for NaN
        if !within {
            return Err(CurveError::Parameter { t, start, end });
        }
        let total = self.knots.multiplicity(t).saturating_add(times);
        if total > degree + 1 {
            return Err(KnotError::Multiplicity { knot: t, times: total, degree }.into());
        }
        Ok(self.refined(&vec![t; times]))
    }

    /// The same curve with the knots `new` inserted, which are valid and in increasing order.
    fn refined(&self, new: &[f64]) -> Self {
        let values = merged(self.knots.values(), new);
        let control = refine(&self.knots, &self.control, new);
        Self::assembled(KnotVector::derived(self.knots.degree(), values), control)
    }

    /// The same curve with knots of multiplicity `p + 1` at the ends of its domain and none
    /// outside.
    #[must_use]
    pub fn clamped(&self) -> Self {
        self.restricted(self.domain())
    }

    pub(crate) fn restricted(&self, range: [f64; 2]) -> Self {
        let (knots, control) = restrict(&self.knots, &self.control, range);
        Self::assembled(knots, control)
    }

    /// The same curve as a chain of Bézier pieces: clamped, every inner knot at least `p`
    /// times. Span `i` of its knots is governed by the control points `i − p` to `i`.
    #[must_use]
    pub fn bezier_form(&self) -> Self {
        let clamped = self.clamped();
        clamped.refined(&clamped.knots.missing_for_bezier())
    }

    /// The two parts of the curve below and above `t`, each clamped.
    ///
    /// # Errors
    /// When `t` is not inside the domain.
    pub fn split(&self, t: f64) -> Result<(Self, Self), CurveError> {
        let [start, end] = self.domain();
        let inside = start < t && t < end; // false for NaN
        if !inside {
            return Err(CurveError::Parameter { t, start, end });
        }
        // Both parts are cut from one polygon, so that they agree where they meet.
        let missing = self.knots.degree().saturating_sub(self.knots.multiplicity(t));
        let whole = self.refined(&vec![t; missing]);
        Ok((whole.restricted([start, t]), whole.restricted([t, end])))
    }

    /// The same curve with its degree raised `times` times; clamped.
    ///
    /// # Errors
    /// When the degree would exceed [`MAX_DEGREE`].
    pub fn elevated(&self, times: usize) -> Result<Self, CurveError> {
        let degree = self.knots.degree().saturating_add(times);
        if degree > MAX_DEGREE {
            return Err(KnotError::Degree { degree }.into());
        }
        let mut curve = self.clamped();
        for _ in 0..times {
            let (knots, control) = elevate(&curve.knots, &curve.control);
            curve = Self::assembled(knots, control);
        }
        Ok(curve)
    }

    /// The curve run backwards; see [`KnotVector::reversed`] for its domain.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let control = self.control.iter().rev().copied().collect();
        Self::assembled(self.knots.reversed(), control)
    }
}
