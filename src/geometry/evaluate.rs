//! Points, derivatives and normals of surfaces, rational or not.

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

use super::basis::BasisValues;
use super::knots::MAX_DEGREE;
use super::{NurbsSurface, SurfaceDerivatives};

impl NurbsSurface {
    /// The point `S(u, v)`.
    ///
    /// Off the domain the end pieces continue as polynomials, where a rational surface may
    /// have poles; NaN gives NaN.
    pub fn point_at(&self, u: f64, v: f64) -> DVec3 {
        let (mut nu, mut nv): (BasisValues, BasisValues) =
            ([0.0; MAX_DEGREE + 1], [0.0; MAX_DEGREE + 1]);
        let (p, q) = (self.knots_u().degree(), self.knots_v().degree());
        let (first_i, first_j) =
            (self.knots_u().basis(u, &mut nu) - p, self.knots_v().basis(v, &mut nv) - q);
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

    /// The point `S(u, v)` with its first and second derivatives.
    ///
    /// At inner knots they belong to the piece that begins there, as the basis functions do.
    ///
    /// With `A = Σ N N w P` and `w = Σ N N w`, `S = A / w` is differentiated as a quotient
    /// (Piegl & Tiller 1997, eq. 4.20): `Sᵤ = (Aᵤ − wᵤ S) / w`,
    /// `Sᵤᵥ = (Aᵤᵥ − wᵤ Sᵥ − wᵥ Sᵤ − wᵤᵥ S) / w`, and so on.
    pub fn derivatives(&self, u: f64, v: f64) -> SurfaceDerivatives {
        let [a, au, av, auu, auv, avv] = self.homogeneous_derivatives(u, v);
        let w = a.w;
        let point = a.xyz() / w;
        if !self.is_rational() {
            // Equal weights: w is constant, and its derivatives are rounding errors.
            let over = |d: DVec4| d.xyz() / w;
            let (du, dv) = (over(au), over(av));
            return SurfaceDerivatives {
                point,
                du,
                dv,
                duu: over(auu),
                duv: over(auv),
                dvv: over(avv),
            };
        }
        let du = (au.xyz() - au.w * point) / w;
        let dv = (av.xyz() - av.w * point) / w;
        let duu = (auu.xyz() - 2.0 * au.w * du - auu.w * point) / w;
        let duv = (auv.xyz() - au.w * dv - av.w * du - auv.w * point) / w;
        let dvv = (avv.xyz() - 2.0 * av.w * dv - avv.w * point) / w;
        SurfaceDerivatives { point, du, dv, duu, duv, dvv }
    }

    /// `A, Aᵤ, Aᵥ, Aᵤᵤ, Aᵤᵥ, Aᵥᵥ` of the homogeneous surface.
    fn homogeneous_derivatives(&self, u: f64, v: f64) -> [DVec4; 6] {
        let (nu, nv) = (self.knots_u().basis_derivatives(u), self.knots_v().basis_derivatives(v));
        let (p, q) = (self.knots_u().degree(), self.knots_v().degree());
        let mut sums = [DVec4::ZERO; 6];
        for a in 0..=p {
            let mut row = [DVec4::ZERO; 3];
            for b in 0..=q {
                let point = self.homogeneous(nu.span - p + a, nv.span - q + b);
                for order in 0..3 {
                    row[order] += nv.orders[order][b] * point;
                }
            }
            let [n, nu, nuu] = nu.orders.map(|order| order[a]);
            sums[0] += n * row[0];
            sums[1] += nu * row[0];
            sums[2] += n * row[1];
            sums[3] += nuu * row[0];
            sums[4] += nu * row[1];
            sums[5] += n * row[2];
        }
        sums
    }

    /// The unit normal `Sᵤ × Sᵥ / |Sᵤ × Sᵥ|`, at collapsed edges and poles its limit from
    /// inside the domain; `None` where there is none.
    pub fn normal(&self, u: f64, v: f64) -> Option<DVec3> {
        let inward = |t: f64, (start, end): (f64, f64)| match t {
            _ if t <= start => 1.0,
            _ if t >= end => -1.0,
            _ => 0.0,
        };
        let [domain_u, domain_v] = self.domain();
        self.derivatives(u, v).unit_normal(DVec2::new(inward(u, domain_u), inward(v, domain_v)))
    }
}
