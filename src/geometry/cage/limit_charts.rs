//! Limit surfaces as charts, and evaluated by (u, v).

use std::borrow::Cow;

use glam::{DVec2, DVec3, DVec4};

use super::limit_surface::{FaceRect, LimitPatch, LimitSurface, place_order};
use crate::geometry::chart::Sealed;
use crate::geometry::{
    Chart, ChartMap, Charts, KnotVector, NurbsSurface, RectSide, SurfaceDerivatives, bernstein,
};

impl Sealed for LimitSurface {}

impl Charts for LimitSurface {
    /// The patches, each over its rectangle, shifted along u by the index of its unit square. Where
    /// others adjoin a rectangle's last u or v, that border belongs to them.
    fn charts(&self) -> Vec<Chart<'_>> {
        let count = (self.degree + 1) * (self.degree + 1);
        self.patches.iter().zip(self.control.chunks(count)).map(|one| self.chart(one)).collect()
    }
}

impl LimitSurface {
    fn chart(&self, (patch, points): (&LimitPatch, &[DVec3])) -> Chart<'_> {
        let FaceRect { unit, low, size, .. } = patch.rect;
        let knots = |start: f64, length: f64| {
            let mut values = vec![start; self.degree + 1];
            values.extend(std::iter::repeat_n(start + length, self.degree + 1));
            KnotVector::derived(self.degree, values)
        };
        let knots = [knots(unit as f64 + low[0], size[0]), knots(low[1], size[1])];
        let control: Vec<DVec4> = points.iter().map(|point| point.extend(1.0)).collect();
        let [ends_u, ends_v] = patch.rect.ends_unit();
        let last = unit + 1 == self.unit_count;
        Chart {
            surface: Cow::Owned(NurbsSurface::assembled(knots, control)),
            map: ChartMap::Identity,
            border: patch.border,
            open_end: [!(ends_u && last), !ends_v],
            trims: None,
        }
    }

    /// The patch at a place, and its local parameters; off the surface, the patch before the place.
    fn find(&self, uv: DVec2) -> (usize, DVec2) {
        let last = self.unit_count.saturating_sub(1);
        let unit = (uv.x as usize).min(last); // whole numbers below; 0 for NaN
        let wanted = (unit, place_order([uv.x - unit as f64, uv.y]));
        let after = self.patches.partition_point(|patch| patch.rect.square_order() <= wanted);
        let mut index = after.saturating_sub(1);
        let at = DVec2::new(uv.x - unit as f64, uv.y);
        // That was the last strip of a square. The first one begins where the square does, which a
        // place off the surface may come before.
        let begins_later = |rect: FaceRect| {
            let square = rect.square();
            (0..2).any(|k| rect.low[k] > square.low[k] && at[k] < rect.low[k])
        };
        while begins_later(self.patches[index].rect) {
            index -= 1;
        }
        let FaceRect { low, size, .. } = self.patches[index].rect;
        (index, (at - DVec2::from_array(low)) / DVec2::from_array(size))
    }

    /// The point at (u, v). Off the domain, some patch is continued there.
    pub fn point_at(&self, uv: DVec2) -> DVec3 {
        let (patch, st) = self.find(uv);
        let n = self.degree;
        self.sum(patch, &basis(n, st.x), &basis(n, st.y))
    }

    /// The point at (u, v) with its first and second derivatives; between patches, those of the
    /// patch that begins there.
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        let (patch, st) = self.find(uv);
        let [[u0, u1, u2], [v0, v1, v2]] = [st.x, st.y].map(|t| self.basis_derivatives(t));
        let [size_u, size_v] = self.patches[patch].rect.size;
        let sum = |u: &Basis, v: &Basis| self.sum(patch, u, v);
        SurfaceDerivatives {
            point: sum(&u0, &v0),
            du: sum(&u1, &v0) / size_u,
            dv: sum(&u0, &v1) / size_v,
            duu: sum(&u2, &v0) / (size_u * size_u),
            duv: sum(&u1, &v1) / (size_u * size_v),
            dvv: sum(&u0, &v2) / (size_v * size_v),
        }
    }

    /// The unit normal; where derivatives vanish, its limit on the way into the patch. `None` if
    /// there is no normal.
    pub fn normal(&self, uv: DVec2) -> Option<DVec3> {
        let (_, st) = self.find(uv);
        let inward = DVec2::splat(0.5) - st;
        self.derivatives(uv).unit_normal(inward)
    }

    /// Whether a place is on a border, up to the rounding of u and v.
    pub fn on_border(&self, uv: DVec2) -> bool {
        let (patch, st) = self.find(uv);
        let LimitPatch { rect, border, .. } = self.patches[patch];
        let rounding = 2.0 * f64::EPSILON * uv.abs().max_element().max(1.0);
        let distances = RectSide::distances(st);
        let near = |side: RectSide| distances[side] <= rounding / rect.size[side.fixed()];
        RectSide::ALL.into_iter().any(|side| border[side] && near(side))
    }

    fn sum(&self, patch: usize, u: &Basis, v: &Basis) -> DVec3 {
        let n = self.degree + 1;
        let rows = self.control[patch * n * n..][..n * n].chunks(n);
        rows.zip(u)
            .map(|(row, u)| *u * row.iter().zip(v).map(|(p, v)| *v * *p).sum::<DVec3>())
            .sum()
    }

    /// Bernstein polynomials with first and second derivatives.
    fn basis_derivatives(&self, t: f64) -> [Basis; 3] {
        let n = self.degree;
        let first = derivative(n, &basis(n - 1, t));
        let second = derivative(n, &derivative(n - 1, &basis(n - 2, t)));
        [basis(n, t), first, second]
    }
}

/// Values of the Bernstein polynomials of degree 3 or less.
type Basis = [f64; 4];

fn basis(degree: usize, t: f64) -> Basis {
    let mut basis = [0.0; 4];
    if let Some(values) = bernstein(degree, t) {
        basis.copy_from_slice(&values[..4]);
    }
    basis
}

/// The derivatives `n (B_{k−1} − B_k)` of degree n, from those of the next lower degree.
fn derivative(degree: usize, lower: &Basis) -> Basis {
    let below = |k: usize| k.checked_sub(1).map_or(0.0, |k| lower[k]);
    [0, 1, 2, 3].map(|k| degree as f64 * (below(k) - if k < degree { lower[k] } else { 0.0 }))
}
