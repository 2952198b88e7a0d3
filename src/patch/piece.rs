//! A Bézier piece in its place on a surface.

use glam::{DVec2, DVec3};

use super::tangents::CollapsedSide;
use super::tensor::euclidean;
use super::{Jet, TensorPatch};
use crate::geometry::ChartMap;

/// A Bézier piece with its place in the surface it was cut from.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The piece on its unit square.
    pub patch: TensorPatch,
    /// Which surface, counted in the order given.
    pub surface: u32,
    /// The knot rectangle of its chart that it covers: from and to in `u`, then in `v`.
    pub domain: [[f64; 2]; 2],
    /// Where the chart lies in the surface's parameters, if they are not the chart's own.
    pub(super) map: Option<Box<ChartMap>>,
    /// Which sides are borders of the surface: `s = 0`, `s = 1`, `t = 0`, `t = 1`.
    pub border: [bool; 4],
    /// Whether another piece begins at the end of this one with something else, in `u` and in
    /// `v`, as where the surface jumps: the knot itself belongs to that piece.
    pub open_end: [bool; 2],
    /// The points sides are collapsed to; few pieces have any.
    pub(super) collapsed: Option<Box<[Option<DVec3>; 4]>>,
}

impl Piece {
    /// The surface parameters of a point of the unit square; exact at its corners, but at an
    /// [open end](Self::open_end): there it is the last number before the knot.
    pub fn uv(&self, st: DVec2) -> DVec2 {
        let at = |k: usize| {
            let [from, to] = self.domain[k];
            let u = if st[k] == 1.0 { to } else { from + st[k] * (to - from) };
            if self.open_end[k] && u >= to { to.next_down() } else { u }
        };
        let uv = DVec2::new(at(0), at(1));
        self.map.as_ref().map_or(uv, |map| map.uv(uv))
    }

    /// The point a side is collapsed to; sides are counted as in [`Self::border`].
    pub fn collapsed(&self, side: usize) -> Option<DVec3> {
        self.collapsed.as_ref().and_then(|points| points[side])
    }

    /// How far, to first order, a point is from the four sides.
    pub fn side_distances(&self, st: DVec2, jet: &Jet) -> [f64; 4] {
        let (ds, dt) = (jet.ds.length(), jet.dt.length());
        [st.x * ds, (1.0 - st.x) * ds, st.y * dt, (1.0 - st.y) * dt]
    }

    /// The unit normal at a point of the unit square; near collapsed sides its limit from
    /// inside the piece. `None` where there is none. (At a [tip](Self::is_tip) it is the limit on
    /// the way along the other parameter: not the surface's normal, but a bound of how flat a ray
    /// may be.)
    ///
    /// At a distance `ρ` from a collapsed side the tangent along it is known to `error / ρ`,
    /// while the limit at the side itself differs by up to `ρ / size` from the truth: it is
    /// taken where it is the nearer of the two. So half of the digits are right everywhere.
    pub fn normal(&self, st: DVec2, jet: &Jet) -> Option<DVec3> {
        let half_the_digits = 1e-8;
        let error = self.patch.residual_factor() * self.patch.magnitude();
        let clear = (error * self.patch.size()).sqrt();
        let distances = self.side_distances(st, jet);
        let near = |side: usize| self.collapsed(side).is_some() && distances[side] <= clear;
        let place = DVec2::new(
            if near(0) {
                0.0
            } else if near(1) {
                1.0
            } else {
                st.x
            },
            if near(2) {
                0.0
            } else if near(3) {
                1.0
            } else {
                st.y
            },
        );
        let cross = jet.ds.cross(jet.dt);
        let regular = cross.length() > half_the_digits * jet.ds.length() * jet.dt.length();
        if regular && !(0..4).any(near) {
            return cross.try_normalize();
        }
        self.limit(place).or_else(|| cross.try_normalize())
    }

    /// Whether a point is a tip, as that of a cone, to within rounding: the end of a collapsed
    /// side from which normals have different limits, and so the surface has none.
    pub fn is_tip(&self, point: DVec3) -> bool {
        let rounding = 4.0 * self.patch.residual_factor() * self.patch.magnitude();
        (0..4).any(|side| {
            let on_side = |tip: DVec3| point.distance(tip) <= rounding;
            self.collapsed(side).is_some_and(on_side) && !self.has_one_limit(side)
        })
    }

    /// The limit of the unit normal from inside the piece.
    fn limit(&self, place: DVec2) -> Option<DVec3> {
        let inward = |x: f64| if x < 0.5 { 1.0 } else { -1.0 };
        let inward = DVec2::new(inward(place.x), inward(place.y));
        self.patch.derivatives(place).unit_normal(inward)
    }

    /// Whether the normals along a collapsed side have one limit, as far as a few places tell.
    fn has_one_limit(&self, side: usize) -> bool {
        let half_the_digits = 1e-8;
        let end = (side % 2) as f64;
        let at = |along: f64| match side / 2 {
            0 => self.limit(DVec2::new(end, along)),
            _ => self.limit(DVec2::new(along, end)),
        };
        let limits = [0.1, 0.3, 0.5, 0.7, 0.9].map(at);
        let first = limits[0];
        limits.iter().all(|limit| match (first, limit) {
            (Some(first), Some(limit)) => first.distance(*limit) <= half_the_digits,
            _ => true, // nothing is known of a place without limit
        })
    }

    /// The sides that are collapsed to a point.
    pub fn collapsed_sides(&self) -> impl Iterator<Item = (CollapsedSide, DVec3)> {
        let sides =
            [CollapsedSide::S(0), CollapsedSide::S(1), CollapsedSide::T(0), CollapsedSide::T(1)];
        let points = (0..4).map(|side| self.collapsed(side));
        sides.into_iter().zip(points).filter_map(|(side, at)| Some((side, at?)))
    }
}

/// The point each side of a piece is collapsed to: all its control points agree to a few
/// roundings of their size.
pub(super) fn collapsed(patch: &TensorPatch) -> Option<Box<[Option<DVec3>; 4]>> {
    let [p, q] = patch.degree();
    let tolerance = 4.0 * patch.residual_factor() * patch.magnitude();
    let point_of = |places: &mut dyn Iterator<Item = (usize, usize)>| {
        let mut points = places.map(|(i, j)| euclidean(patch.row(i)[j]));
        let first = points.next()?;
        points.all(|point| (point - first).abs().max_element() <= tolerance).then_some(first)
    };
    let sides = [
        point_of(&mut (0..=q).map(|j| (0, j))),
        point_of(&mut (0..=q).map(|j| (p, j))),
        point_of(&mut (0..=p).map(|i| (i, 0))),
        point_of(&mut (0..=p).map(|i| (i, q))),
    ];
    // A piece that is a point all over has no sides to speak of.
    let some = sides.iter().any(Option::is_some) && !sides.iter().all(Option::is_some);
    some.then(|| Box::new(sides))
}
