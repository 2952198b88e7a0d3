//! The derivatives of a surface at a point, and the normal they give.

use glam::{DVec2, DVec3};

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

/// How many units of rounding a first derivative may be off, where they come from sums of a
/// few dozen terms as large as the coordinates.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A limit found from second derivatives counts if the sine of the angle between the
/// vectors it is the product of exceeds this: half of the digits are then right.
const CLEAR: f64 = 1.5e-8;

impl SurfaceDerivatives {
    /// The unit normal `Sᵤ × Sᵥ / |Sᵤ × Sᵥ|`; where the product vanishes, its limit on the
    /// way out of the domain's inside.
    ///
    /// `inward = (h, k)` points from here into the domain: signs will do, ±1 at a border, 0
    /// away from it. Along it the product is, to second order in `s`,
    ///
    /// `N(s) = (Sᵤ + s (h Sᵤᵤ + k Sᵤᵥ)) × (Sᵥ + s (h Sᵤᵥ + k Sᵥᵥ)) = N₀ + s N₁ + s² N₂`,
    ///
    /// and the first coefficient that does not vanish has the limit's direction. At a
    /// collapsed edge or a pole `u = 0`, `Sᵥ` is zero and `N₁ = Sᵤ × h Sᵤᵥ`; at a corner
    /// with parallel tangents, `N₁` has all its terms; `N₂` decides where both first
    /// derivatives vanish (otherwise third derivatives would have a say in it, too).
    ///
    /// What vanishes is told from rounding, not from a length: a first derivative is known
    /// to about `ε M / Δ`, with `M` the largest coordinate of the point, and `Δ` a
    /// parameter length, for which `|Sᵤ| / |Sᵤᵤ|` and the like stand. So neither the
    /// model's nor the parameters' scale matters.
    ///
    /// `None` where no limit is found: within the domain, at the tip of a cusp, for NaN.
    pub fn unit_normal(&self, inward: DVec2) -> Option<DVec3> {
        let Self { point, du, dv, duu, duv, dvv } = *self;
        let [lu, lv, luu, luv, lvv] = [du, dv, duu, duv, dvv].map(DVec3::length);

        // N₀, if it exceeds its rounding error.
        let n0 = du.cross(dv);
        let noise = ROUNDING * point.abs().max_element();
        let error = ROUNDING * lu * lv + noise * (luu * lv / lu + 2.0 * luv + lvv * lu / lv);
        if n0.length() > error {
            return n0.try_normalize();
        }

        // Derivatives lost in their rounding errors count as zero, lest noise gain a direction.
        let (h, k) = (inward.x, inward.y);
        let clear = |product: DVec3, size: f64| {
            if product.length() > CLEAR * size { product.try_normalize() } else { None }
        };
        let u_vanishes = lu * lu <= noise * luu;
        let v_vanishes = lv * lv <= noise * lvv;
        let du = if u_vanishes { DVec3::ZERO } else { du };
        let dv = if v_vanishes { DVec3::ZERO } else { dv };

        // N₂ counts alone where both vanish, else N₁.
        let (turn_u, turn_v) = (h * duu + k * duv, h * duv + k * dvv);
        if u_vanishes && v_vanishes {
            return clear(turn_u.cross(turn_v), turn_u.length() * turn_v.length());
        }
        let n1 = turn_u.cross(dv) + du.cross(turn_v);
        clear(n1, turn_u.length() * dv.length() + du.length() * turn_v.length())
    }
}
