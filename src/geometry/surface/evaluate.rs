//! Points, derivatives and normals of surfaces, rational or not.

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

use super::{NurbsSurface, SurfaceDerivatives};
use crate::geometry::BasisDerivatives;
use crate::geometry::knots::BasisValues;
use crate::geometry::knots::MAX_DEGREE;

impl NurbsSurface {
    /// The point `S(u, v)`.
    ///
    /// Off the domain the end pieces continue as polynomials, where a rational surface may
    /// have poles; NaN gives NaN.
    pub fn point_at(&self, uv: DVec2) -> DVec3 {
        let (mut nu, mut nv): (BasisValues, BasisValues) =
            ([0.0; MAX_DEGREE + 1], [0.0; MAX_DEGREE + 1]);
        let (p, q) = (self.knots_u().degree(), self.knots_v().degree());
        let (first_i, first_j) =
            (self.knots_u().basis(uv.x, &mut nu) - p, self.knots_v().basis(uv.y, &mut nv) - q);
        let mut sum = DVec4::ZERO;
        for a in 0..=p {
            let mut row = DVec4::ZERO;
            for b in 0..=q {
                row += nv[b] * self.homogeneous(first_i + a, first_j + b);
            }
            sum += nu[a] * row;
        }
        sum.xyz() / sum.w
    }

    /// The points `S(u, v)` for all pairs of a `u` and a `v`, u slowest. They equal those of
    /// [`point_at`](Self::point_at) bit for bit, with less work for each.
    pub fn points_at(&self, us: &[f64], vs: &[f64]) -> Vec<DVec3> {
        let mut values: BasisValues = [0.0; MAX_DEGREE + 1];
        let (p, q) = (self.knots_u().degree(), self.knots_v().degree());
        let rows = self.size()[0];
        // For each v, the control points of the curve `u ↦ S(u, v)`.
        let mut curves = vec![DVec4::ZERO; rows * vs.len()];
        for (curve, &v) in curves.chunks_exact_mut(rows).zip(vs) {
            let first = self.knots_v().basis(v, &mut values) - q;
            for (i, sum) in curve.iter_mut().enumerate() {
                for b in 0..=q {
                    *sum += values[b] * self.homogeneous(i, first + b);
                }
            }
        }
        let mut points = Vec::with_capacity(us.len() * vs.len());
        for &u in us {
            let first = self.knots_u().basis(u, &mut values) - p;
            points.extend(curves.chunks_exact(rows).map(|curve| {
                let mut sum = DVec4::ZERO;
                for a in 0..=p {
                    sum += values[a] * curve[first + a];
                }
                sum.xyz() / sum.w
            }));
        }
        points
    }

    /// The point `S(u, v)` with its first and second derivatives.
    ///
    /// At inner knots they belong to the piece that begins there, as the basis functions do.
    ///
    /// With `A = Σ N N w P` and `w = Σ N N w`, `S = A / w` is differentiated as a quotient
    /// (Piegl & Tiller 1997, eq. 4.20). The point `S` is computed first, and all coordinates are
    /// then taken relative to it. So the control points of a collapsed edge near by are nearly
    /// zero and add nearly no rounding error to the small derivative along that edge, and normals
    /// are right up to the pole.
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        let nu = self.knots_u().basis_derivatives(uv.x);
        let nv = self.knots_v().basis_derivatives(uv.y);
        let origin = {
            let sum = self.combined(&nu, &nv, |point| point)[0];
            sum.xyz() / sum.w
        };
        let around = |point: DVec4| {
            // Rounds only once, the small result: w x may nearly equal w times the origin.
            let shifted = |wx: f64, x: f64| (-point.w).mul_add(x, wx);
            let x = shifted(point.x, origin.x);
            DVec4::new(x, shifted(point.y, origin.y), shifted(point.z, origin.z), point.w)
        };
        let mut sums = self.combined(&nu, &nv, around);
        if !self.is_rational() {
            // Equal weights: w is constant, and its derivatives are rounding errors.
            for sum in &mut sums[1..] {
                sum.w = 0.0;
            }
        }
        let relative = SurfaceDerivatives::of_quotient(sums);
        SurfaceDerivatives { point: origin + relative.point, ..relative }
    }

    /// The sums `Σ N N P` over the homogeneous control points, each mapped by `map`: the value,
    /// and its derivatives in the order u, v, uu, uv, vv.
    fn combined(
        &self,
        nu: &BasisDerivatives,
        nv: &BasisDerivatives,
        map: impl Fn(DVec4) -> DVec4,
    ) -> [DVec4; 6] {
        let (p, q) = (self.knots_u().degree(), self.knots_v().degree());
        let mut sums = [DVec4::ZERO; 6];
        for a in 0..=p {
            let mut row = [DVec4::ZERO; 3];
            for b in 0..=q {
                let point = map(self.homogeneous(nu.span - p + a, nv.span - q + b));
                for order in 0..3 {
                    row[order] += nv.orders[order][b] * point;
                }
            }
            let [n, n1, n2] = nu.orders.map(|order| order[a]);
            sums[0] += n * row[0];
            sums[1] += n1 * row[0];
            sums[2] += n * row[1];
            sums[3] += n2 * row[0];
            sums[4] += n1 * row[1];
            sums[5] += n * row[2];
        }
        sums
    }

    /// The unit normal `Sᵤ × Sᵥ / |Sᵤ × Sᵥ|`, at collapsed edges and poles its limit from
    /// inside the domain; `None` where there is none.
    ///
    /// A point that rounding cannot tell from a border point, and whose own derivatives are lost in
    /// rounding (as near a pole), gets the border's normal. See
    /// [`SurfaceDerivatives::unit_normal`].
    pub fn normal(&self, uv: DVec2) -> Option<DVec3> {
        let [domain_u, domain_v] = self.domain();
        let inward = |uv: DVec2| DVec2::new(side(uv.x, domain_u), side(uv.y, domain_v));
        let here = self.derivatives(uv);
        here.unit_normal(inward(uv)).or_else(|| {
            let end = DVec2::new(near_end(uv.x, domain_u), near_end(uv.y, domain_v));
            let unseen = UNSEEN * here.point.abs().max_element();
            [end.with_y(uv.y), end.with_x(uv.x), end].into_iter().find_map(|at| {
                let border = self.derivatives(at);
                let same = border.point.distance(here.point) <= unseen;
                if same { border.unit_normal(inward(at)) } else { None }
            })
        })
    }
}

/// Points closer together than this, relative to their largest coordinate, may be one point: 1024
/// ε, more than [`SurfaceDerivatives::unit_normal`] treats as rounding error.
const UNSEEN: f64 = 1024.0 * f64::EPSILON;

/// The distance from an end of the domain, relative to the domain's length, within which a
/// parameter is moved to that end in search of a normal. It keeps the point from sliding along a
/// collapsed edge, and suffices for models up to 10⁶ times their size away from the origin.
const NEAR: f64 = 1e-6;

/// The direction from `t` into a domain: ±1 at its ends, 0 inside.
fn side(t: f64, [start, end]: [f64; 2]) -> f64 {
    if t <= start {
        1.0
    } else if t >= end {
        -1.0
    } else {
        0.0
    }
}

/// The end of the domain that is within `NEAR` of `t`, or `t` itself if neither is.
fn near_end(t: f64, [start, end]: [f64; 2]) -> f64 {
    let near = NEAR * (end - start);
    if t - start <= near {
        start
    } else if end - t <= near {
        end
    } else {
        t
    }
}
