//! The derivatives of a surface at a point, and the normal they give.

use glam::{DVec2, DVec3, DVec4, Vec4Swizzles};

use crate::math::rounding::power_of_two_below;

/// A point of a surface with its first and second partial derivatives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SurfaceDerivatives {
    /// `S`.
    pub point: DVec3,
    /// `Sᵤ`.
    pub du: DVec3,
    /// `Sᵥ`.
    pub dv: DVec3,
    /// `Sᵤᵤ`.
    pub duu: DVec3,
    /// `Sᵤᵥ`.
    pub duv: DVec3,
    /// `Sᵥᵥ`.
    pub dvv: DVec3,
}

/// The error bound of a first derivative in units of `M / Δ` (see
/// [`SurfaceDerivatives::unit_normal`]): derivatives come from sums of a few dozen terms as large
/// as the coordinates.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A limit found from second derivatives counts if the sine of the angle between the two factors
/// of its cross product exceeds this: half of the digits are then right.
const CLEAR: f64 = 1.5e-8;

impl SurfaceDerivatives {
    /// Those of `S = A / w`, from `(A, w)` and its derivatives in the order value, u, v, uu, uv, vv.
    ///
    /// By the quotient rule (Piegl & Tiller 1997, eq. 4.20) `Sᵤ = (Aᵤ − wᵤ S) / w`,
    /// `Sᵤᵥ = (Aᵤᵥ − wᵤ Sᵥ − wᵥ Sᵤ − wᵤᵥ S) / w`, and so on.
    #[inline]
    pub(crate) fn of_quotient([a, au, av, auu, auv, avv]: [DVec4; 6]) -> Self {
        let w = a.w;
        let point = a.xyz() / w;
        let du = (au.xyz() - au.w * point) / w;
        let dv = (av.xyz() - av.w * point) / w;
        Self {
            point,
            du,
            dv,
            duu: (auu.xyz() - 2.0 * au.w * du - auu.w * point) / w,
            duv: (auv.xyz() - au.w * dv - av.w * du - auv.w * point) / w,
            dvv: (avv.xyz() - 2.0 * av.w * dv - avv.w * point) / w,
        }
    }

    /// The same without the derivatives that are only rounding errors: those no longer than errors
    /// of up to `error` in the control points of a Bézier patch of degrees p and q can cause.
    pub(crate) fn without_noise(self, [p, q]: [usize; 2], error: f64) -> Self {
        let [p, q] = [p, q].map(|degree| degree as f64);
        let kept = |derivative: DVec3, times: f64| {
            if derivative.length() <= times * error { DVec3::ZERO } else { derivative }
        };
        Self {
            point: self.point,
            du: kept(self.du, 2.0 * p),
            dv: kept(self.dv, 2.0 * q),
            duu: kept(self.duu, 4.0 * p * (p - 1.0)),
            duv: kept(self.duv, 4.0 * p * q),
            dvv: kept(self.dvv, 4.0 * q * (q - 1.0)),
        }
    }

    /// The unit normal `Sᵤ × Sᵥ / |Sᵤ × Sᵥ|`; where the product vanishes, the limit of the normal
    /// from inside the domain.
    ///
    /// `inward = (h, k)` points from here into the domain. Signs suffice: ±1 at a border, 0
    /// away from it. Along this direction the product is, to second order in `s`,
    ///
    /// `N(s) = (Sᵤ + s (h Sᵤᵤ + k Sᵤᵥ)) × (Sᵥ + s (h Sᵤᵥ + k Sᵥᵥ)) = N₀ + s N₁ + s² N₂`,
    ///
    /// and the first coefficient that does not vanish has the limit's direction. At a
    /// collapsed edge or a pole `u = 0`, `Sᵥ` is zero and `N₁ = Sᵤ × h Sᵤᵥ`; at a corner
    /// with parallel tangents, `N₁` has all its terms; `N₂` decides where both first
    /// derivatives vanish (otherwise `N₂` would need third derivatives, too).
    ///
    /// Whether a derivative vanishes is decided by its rounding error, not by a fixed length: a
    /// first derivative is known to about `ε M / Δ`. Here `M` is the largest coordinate of the
    /// point and `Δ` a parameter length, for which `|Sᵤ| / |Sᵤᵤ|` and the like are taken. So
    /// neither the model's scale nor the parameters' scale matters.
    ///
    /// `None` where no limit is found: within the domain, at the tip of a cusp, for NaN.
    pub fn unit_normal(&self, inward: DVec2) -> Option<DVec3> {
        let scaled = self.scaled();
        if let Some(normal) = scaled.regular_normal() {
            return Some(normal);
        }
        let Self { point, du, dv, duu, duv, dvv } = scaled;
        let [lu, lv, luu, luv, lvv] = [du, dv, duu, duv, dvv].map(DVec3::length);
        let noise = ROUNDING * point.abs().max_element();

        // Derivatives lost in their rounding errors count as zero, so that noise gets no direction.
        let u_vanishes = lu * lu <= noise * luu;
        let v_vanishes = lv * lv <= noise * lvv;
        let kept = |derivative: DVec3, lost: bool| if lost { DVec3::ZERO } else { derivative };
        let (du, dv) = (kept(du, u_vanishes), kept(dv, v_vanishes));
        let duu_lost = u_vanishes && !v_vanishes && luu * lv * lv <= noise * luv * luv;
        let dvv_lost = v_vanishes && !u_vanishes && lvv * lu * lu <= noise * luv * luv;
        let (duu, dvv) = (kept(duu, duu_lost), kept(dvv, dvv_lost));
        let (h, k) = (inward.x, inward.y);
        let (du, turn_u) = shrunk(du, h * duu + k * duv);
        let (dv, turn_v) = shrunk(dv, h * duv + k * dvv);

        // Where both first derivatives vanish, only N₂ counts; else N₁.
        let (product, size) = if u_vanishes && v_vanishes {
            (turn_u.cross(turn_v), turn_u.length() * turn_v.length())
        } else {
            let size = turn_u.length() * dv.length() + du.length() * turn_v.length();
            (turn_u.cross(dv) + du.cross(turn_v), size)
        };
        if product.length() > CLEAR * size { normalized(product) } else { None }
    }

    /// The same surface over parameters in which no derivative is much longer than 1, so that no
    /// product overflows. The parameters are scaled by powers of two, which is exact.
    fn scaled(&self) -> Self {
        let Self { point, du, dv, duu, duv, dvv } = *self;
        let size = |v: DVec3| v.abs().max_element();
        let turn = size(duv).sqrt();
        let a = power_of_two_below(size(du).max(size(duu).sqrt()).max(turn)).recip();
        let b = power_of_two_below(size(dv).max(size(dvv).sqrt()).max(turn)).recip();
        Self {
            point,
            du: a * du,
            dv: b * dv,
            duu: a * (a * duu),
            duv: a * (b * duv),
            dvv: b * (b * dvv),
        }
    }

    /// The direction of `N₀` (see [`SurfaceDerivatives::unit_normal`]), if the sine of the angle
    /// between its factors exceeds its rounding error.
    pub(super) fn regular_normal(&self) -> Option<DVec3> {
        let Self { point, du, dv, duu, duv, dvv } = *self;
        let [lu, lv, luu, luv, lvv] = [du, dv, duu, duv, dvv].map(DVec3::length);
        let noise = ROUNDING * point.abs().max_element();
        let error = noise * (luu / lu / lu + 2.0 * luv / lu / lv + lvv / lv / lv);
        let sine = (du / lu).cross(dv / lv);
        // False for NaN, which a zero length gives.
        if sine.length() > ROUNDING + error { normalized(sine) } else { None }
    }
}

/// Two vectors divided by their largest coordinate magnitude, so that products neither overflow
/// nor underflow; zeros stay zero.
fn shrunk(a: DVec3, b: DVec3) -> (DVec3, DVec3) {
    let size = a.abs().max(b.abs()).max_element();
    if size > 0.0 { (a / size, b / size) } else { (a, b) }
}

/// The unit vector of a vector that is neither tiny nor huge, exact along the axes; `None` if it is
/// not finite.
fn normalized(vector: DVec3) -> Option<DVec3> {
    let unit = vector / vector.length();
    unit.is_finite().then_some(unit)
}
