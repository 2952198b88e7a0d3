//! Tensor-product rational Bézier pieces.

use std::sync::Arc;

use glam::{DVec2, DVec3, DVec4};
use smallvec::SmallVec;

use super::chart_net::ChartNet;
use super::spline_net::LONGEST_OF_CUBIC;
use crate::geometry::SurfaceDerivatives;
use crate::math::bernstein::{self, Basis};
use crate::math::rounded::Up32;
use crate::math::{Aabb, prefetch};
use crate::patch::{BezierNet, NetRoom, NetSource, PieceNet, StRect};

/// The Euclidean points of a control net; those of a bicubic are stored inline.
pub(super) type Points = SmallVec<[DVec3; 16]>;

/// A rational Bézier piece of a surface,
/// `S(s, t) = Σ B_i(s) B_j(t) w_ij P_ij / Σ B_i(s) B_j(t) w_ij` on the unit square.
///
/// # Invariants
/// - the degrees are at least 1 and at most [`bernstein::MAX_DEGREE`];
/// - there are `(p + 1)(q + 1)` homogeneous control points `(w x, w y, w z, w)`, second
///   index fastest, all finite, all weights positive.
#[derive(Clone, Debug)]
pub struct TensorPatch {
    /// The control points of the whole chart, which all its pieces share.
    pub(super) net: Arc<ChartNet>,
    /// The row and the column of the piece's first point.
    pub(super) first: [u32; 2],
    magnitude: Up32,
    size: Up32,
}

/// A point of a piece with its first derivatives.
#[derive(Clone, Copy, Debug)]
pub struct Jet {
    /// `S`.
    pub point: DVec3,
    /// `S_s`.
    pub ds: DVec3,
    /// `S_t`.
    pub dt: DVec3,
}

impl TensorPatch {
    /// A piece of a surface, from the row and the column of its first point. The caller has checked
    /// the invariants: only surfaces that satisfy them can be built. Also returns its Euclidean
    /// control points.
    pub(in crate::patch) fn new(net: &Arc<ChartNet>, first: [u32; 2]) -> (Self, Points) {
        let zero = Up32::above(0.0);
        let mut patch = Self { net: Arc::clone(net), first, magnitude: zero, size: zero };
        let points = euclidean_net(&patch.control_net());
        let bounds = Aabb::around(points.iter().copied());
        patch.magnitude = Up32::above(bounds.magnitude());
        patch.size = Up32::above(bounds.size().max_element());
        (patch, points)
    }

    /// The degrees in `s` and `t`.
    pub fn degree(&self) -> [usize; 2] {
        self.net.degree
    }

    /// The homogeneous control points `(w x, w y, w z, w)`, second index fastest.
    pub fn control(&self) -> impl Iterator<Item = DVec4> + use<> {
        self.control_net().into_iter()
    }

    /// One homogeneous control point.
    pub(crate) fn control_point(&self, i: usize, j: usize) -> DVec4 {
        self.net(&mut None).points(i).nth(j).unwrap_or(DVec4::NAN) // there is one
    }

    /// A copy of all homogeneous control points, to work on.
    pub(in crate::patch) fn control_net(&self) -> BezierNet {
        let [p, q] = self.degree();
        let mut net = BezierNet::from_elem(DVec4::ZERO, (p + 1) * (q + 1));
        let rows = net.chunks_exact_mut(q + 1).enumerate();
        match (self.net_source(), self.weight()) {
            (NetSource::Kept(kept), Some(weight)) => {
                for (i, row) in rows {
                    for (point, &numbers) in row.iter_mut().zip(kept.row(i).as_chunks::<3>().0) {
                        *point = DVec3::from_array(numbers).extend(weight);
                    }
                }
            }
            (NetSource::Kept(kept), None) => {
                for (i, row) in rows {
                    for (point, &numbers) in row.iter_mut().zip(kept.row(i).as_chunks::<4>().0) {
                        *point = DVec4::from_array(numbers);
                    }
                }
            }
            (NetSource::Spline(spline), _) => return spline.bezier_net(),
        }
        net
    }

    /// Where the control net is: kept, or to be made.
    #[inline(always)]
    pub(crate) fn net_source(&self) -> NetSource<'_> {
        self.net.source(self.first)
    }

    /// Where the net is whose sums are used where speed counts: kept, or to be made.
    #[inline(always)]
    pub(crate) fn sums_source(&self) -> NetSource<'_> {
        self.net.sums_source(self.first)
    }

    /// The degrees of that net: those of the piece, or less, where they have been elevated.
    #[inline(always)]
    pub(crate) fn sums_degree(&self) -> [usize; 2] {
        self.net.sums_degree()
    }

    /// Whether that net is in power form, of `2 s − 1` and `2 t − 1`, not in Bernstein form.
    #[inline(always)]
    pub(crate) fn sums_by_powers(&self) -> bool {
        self.net.by_powers(self.first)
    }

    /// The control net, to be read row by row. If it is not kept, it is made in `room`, unless it
    /// is there already; so a room is for one piece.
    #[inline(always)]
    pub(crate) fn net<'n>(&'n self, room: &'n mut Option<NetRoom>) -> PieceNet<'n> {
        match self.net_source() {
            NetSource::Kept(net) => net,
            NetSource::Spline(spline) => {
                let is_made = room.is_some();
                let room = room.get_or_insert_with(NetRoom::new);
                if is_made { spline.made(room) } else { spline.make(room) }
            }
        }
    }

    /// Prefetches the rows of the points that are kept, for use soon. Short rows take two cache
    /// lines, as a rule.
    #[inline(always)]
    pub(crate) fn prefetch_net(&self) {
        let net = match self.sums_source() {
            NetSource::Kept(net) => net,
            NetSource::Spline(spline) => spline.points(),
        };
        for i in 0..=self.sums_degree()[0] {
            let row = net.row(i);
            prefetch(&row[0]);
            prefetch(&row[row.len() - 1]);
            if row.len() > LONGEST_OF_CUBIC + 1 {
                row.iter().step_by(8).for_each(prefetch);
            }
        }
    }

    /// The weight of all points of the surface; `None` where they differ.
    #[inline(always)]
    pub fn weight(&self) -> Option<f64> {
        self.net.weight()
    }

    /// Whether the weights of the surface differ.
    #[inline(always)]
    pub fn is_rational(&self) -> bool {
        self.weight().is_none()
    }

    /// Whether leaves are approximated by quotients: see [`Leaf`](crate::patch::Leaf). This is so
    /// if the degrees are three at most, and weights differ.
    #[inline(always)]
    pub(crate) fn has_quotient_leaves(&self) -> bool {
        let [p, q] = self.degree();
        self.is_rational() && p.max(q) <= 3
    }

    /// The largest absolute coordinate of the control points, in scene units, rounded up to six
    /// digits.
    pub fn magnitude(&self) -> f64 {
        self.magnitude.value()
    }

    /// The longest side of the control points' bounding box, in scene units, rounded up to six
    /// digits.
    pub fn size(&self) -> f64 {
        self.size.value()
    }

    /// The error bound of a computed point, per unit of the largest coordinate involved: see
    /// [`rounding::residual_factor`](crate::math::rounding::residual_factor).
    #[inline(always)]
    pub fn residual_factor(&self) -> f64 {
        self.net.residual_factor
    }

    /// The error bound of a computed point, in scene units.
    #[inline(always)]
    pub fn noise(&self) -> f64 {
        self.error_bound(0.0)
    }

    /// How far apart control points may be that are one point, but for a few roundings.
    pub(super) fn one_point(&self) -> f64 {
        4.0 * self.noise()
    }

    /// The error bound of a point computed for a ray, in scene units; `magnitude` is the largest
    /// absolute coordinate of the ray's origin.
    #[inline(always)]
    pub(crate) fn error_bound(&self, magnitude: f64) -> f64 {
        self.residual_factor() * self.magnitude().max(magnitude)
    }

    /// The point and first derivatives at `(s, t)`, also a little outside the square.
    ///
    /// The order of operations is fixed, so that every caller gets the same bits.
    pub fn jet(&self, st: DVec2) -> Jet {
        self.jet_of(self.net(&mut None), st)
    }

    /// The [`jet`](Self::jet) from the [`net`](Self::net), for callers that need many.
    pub(crate) fn jet_of(&self, net: PieceNet<'_>, st: DVec2) -> Jet {
        // The same sums with as much room for basis functions as the degrees need.
        match self.degree()[0].max(self.degree()[1]) {
            0..=3 => self.jet_in::<4>(net, st),
            4..=7 => self.jet_in::<8>(net, st),
            _ => self.jet_in::<{ bernstein::MAX_DEGREE + 1 }>(net, st),
        }
    }

    fn jet_in<const N: usize>(&self, net: PieceNet<'_>, st: DVec2) -> Jet {
        let [p, q] = self.degree();
        let (lower_s, lower_t) =
            (bernstein::basis::<N>(p - 1, st.x), bernstein::basis::<N>(q - 1, st.y));
        let (bs, bt) = (bernstein::raised(p, st.x, &lower_s), bernstein::raised(q, st.y, &lower_t));
        let (ds, dt) = (
            bernstein::derivative_from_lower(p, &lower_s),
            bernstein::derivative_from_lower(q, &lower_t),
        );

        let mut value = DVec4::ZERO;
        let mut along_s = DVec4::ZERO;
        let mut along_t = DVec4::ZERO;
        for i in 0..=p {
            let (mut sum, mut slope) = (DVec4::ZERO, DVec4::ZERO);
            for (j, c) in net.points(i).enumerate() {
                sum += bt[j] * c;
                slope += dt[j] * c;
            }
            value += bs[i] * sum;
            along_s += ds[i] * sum;
            along_t += bs[i] * slope;
        }

        // Quotient rule: S_s = (X_s − S W_s) / W.
        if let Some(w) = self.weight() {
            return Jet {
                point: value.truncate() / w,
                ds: along_s.truncate() / w,
                dt: along_t.truncate() / w,
            };
        }
        let point = value.truncate() / value.w;
        Jet {
            point,
            ds: (along_s.truncate() - along_s.w * point) / value.w,
            dt: (along_t.truncate() - along_t.w * point) / value.w,
        }
    }

    /// The point at `(s, t)`: that of the jet, bit for bit.
    pub fn point(&self, st: DVec2) -> DVec3 {
        match self.degree()[0].max(self.degree()[1]) {
            0..=3 => self.point_in::<4>(st),
            4..=7 => self.point_in::<8>(st),
            _ => self.point_in::<{ bernstein::MAX_DEGREE + 1 }>(st),
        }
    }

    fn point_in<const N: usize>(&self, st: DVec2) -> DVec3 {
        let mut room = None;
        let net = self.net(&mut room);
        let [p, q] = self.degree();
        let (lower_s, lower_t) =
            (bernstein::basis::<N>(p - 1, st.x), bernstein::basis::<N>(q - 1, st.y));
        let (bs, bt) = (bernstein::raised(p, st.x, &lower_s), bernstein::raised(q, st.y, &lower_t));
        let mut value = DVec4::ZERO;
        for i in 0..=p {
            let mut sum = DVec4::ZERO;
            for (j, c) in net.points(i).enumerate() {
                sum += bt[j] * c;
            }
            value += bs[i] * sum;
        }
        value.truncate() / self.weight().unwrap_or(value.w)
    }

    /// No tangent in `s`, nor in `t`, is longer than these, if all weights are equal; if they differ
    /// by a factor, none is by more than that.
    pub(in crate::patch) fn longest_tangents(&self) -> [f64; 2] {
        let [p, q] = self.degree();
        let points = euclidean_net(&self.control_net());
        let longest = |steps: &mut dyn Iterator<Item = DVec3>| {
            steps.map(DVec3::length_squared).fold(0.0, f64::max).sqrt()
        };
        let mut down = points.iter().zip(&points[q + 1..]).map(|(a, b)| *b - *a);
        let mut across =
            points.chunks_exact(q + 1).flat_map(|row| row.windows(2)).map(|w| w[1] - w[0]);
        [p as f64 * longest(&mut down), q as f64 * longest(&mut across)]
    }

    /// The vectors across the middle of a rectangle of the unit square, in `s` and in `t`.
    pub(in crate::patch) fn chords(&self, [s, t]: StRect) -> [DVec3; 2] {
        let (ms, mt) = (0.5 * (s[0] + s[1]), 0.5 * (t[0] + t[1]));
        let at = |s: f64, t: f64| self.point(DVec2::new(s, t));
        [at(s[1], mt) - at(s[0], mt), at(ms, t[1]) - at(ms, t[0])]
    }

    /// The point, first and second derivatives at `(s, t)`; `u` and `v` stand for `s` and
    /// `t` in the names.
    pub fn derivatives(&self, st: DVec2) -> SurfaceDerivatives {
        let [p, q] = self.degree();
        let (bs, bt) = (derivative_table(p, st.x), derivative_table(q, st.y));
        let net = self.control_net();
        let sum = |(order_s, order_t): (usize, usize)| -> DVec4 {
            let points = |i: usize| net[i * (q + 1)..(i + 1) * (q + 1)].iter();
            let row = |i: usize| points(i).zip(&bt[order_t]).map(|(&c, &b)| b * c).sum::<DVec4>();
            (0..=p).map(|i| bs[order_s][i] * row(i)).sum()
        };
        let orders = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
        SurfaceDerivatives::of_quotient(orders.map(sum))
    }
}

/// The Euclidean point of a homogeneous control point.
#[inline]
pub(in crate::patch) fn euclidean(control: DVec4) -> DVec3 {
    // Most weights are 1, and divisions take time.
    if control.w == 1.0 { control.truncate() } else { control.truncate() / control.w }
}

/// The Euclidean points of a control net.
#[inline]
pub(in crate::patch) fn euclidean_net(net: &[DVec4]) -> Points {
    let mut points = Points::from_elem(DVec3::ZERO, net.len());
    for (point, &control) in points.iter_mut().zip(net) {
        *point = euclidean(control);
    }
    points
}

/// Basis functions with their first and second derivatives.
pub(super) fn derivative_table(degree: usize, t: f64) -> [Basis; 3] {
    if degree == 0 {
        let none = [0.0; bernstein::MAX_DEGREE + 1];
        return [bernstein::basis(0, t), none, none];
    }
    let lower: Basis = bernstein::basis(degree - 1, t);
    let second = if degree < 2 {
        [0.0; bernstein::MAX_DEGREE + 1]
    } else {
        let lowest: Basis = bernstein::basis(degree - 2, t);
        bernstein::derivative_from_lower(
            degree,
            &bernstein::derivative_from_lower(degree - 1, &lowest),
        )
    };
    [bernstein::raised(degree, t, &lower), bernstein::derivative_from_lower(degree, &lower), second]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_point_is_that_of_the_jet_in_every_room() {
        for degree in [[1, 1], [3, 2], [2, 3], [5, 4], [7, 1], [8, 3], [32, 9]] {
            let count = (degree[0] + 1) * (degree[1] + 1);
            for rational in [false, true] {
                let net: Vec<DVec4> = (0..count)
                    .map(|k| {
                        let x = k as f64;
                        let w = if rational { 1.0 + 0.5 * x.sin() } else { 2.0 };
                        w * DVec3::new((3.0 * x).cos(), x.sin(), 0.1 * x).extend(1.0)
                    })
                    .collect();
                let net = Arc::new(ChartNet::single(degree, &net));
                let (patch, _) = TensorPatch::new(&net, [0, 0]);
                assert_eq!(patch.is_rational(), rational);
                for st in [DVec2::new(0.3, 0.7), DVec2::new(0.0, 1.0), DVec2::new(-0.01, 1.02)] {
                    assert_eq!(patch.point(st), patch.jet(st).point, "{degree:?} at {st}");
                }
            }
        }
    }
}
