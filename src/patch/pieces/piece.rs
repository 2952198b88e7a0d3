//! A Bézier piece in its place on a surface.

use std::sync::Arc;

use glam::{DVec2, DVec3};

use super::chart_net::ChartNet;
use super::pole_normal::normal_by_pole;
use super::tensor::euclidean;
use crate::geometry::trim::{Side, Trims, UvBox, WindowCurve};
use crate::geometry::{ChartMap, RectSide, SurfaceDerivatives};
use crate::math::bits::has;
use crate::patch::{Jet, StRect, TensorPatch};

/// The smallest sine of the angle between tangents that is used to tell how far a side is; it
/// replaces smaller ones. So a side counts as no nearer than a thousandth of the way to it along
/// the parameter.
const LEAST_SINE: f64 = 1e-3;

/// Places count as beside a collapsed side within this fraction of the piece, at most: where a
/// surface hardly moves with a parameter, places that are far in the parameter are near in space.
pub(crate) const BESIDE_COLLAPSED: f64 = 1e-3;

/// Within this fraction of the piece from a collapsed side, the pole there determines the normal;
/// farther off, the tangents themselves give all but one or two of its digits.
const BESIDE_POLE: f64 = 0.1;

/// A tangent at a side stands for places beside it if it changes by less than one over this on the
/// way.
const STEADY: f64 = 16.0;

/// The largest angle, in radians, by which rounding may turn a normal that the pole beside it gives
/// without a look at anything else.
const TURNED_AT_POLE: f64 = 1e-9;

/// The largest such angle of any normal beside a collapsed side.
const TURNED_AT_MOST: f64 = 1e-6;

/// The relative precision of an f64 that has lost half of its digits: sines and angles below it may
/// be rounding error of what second derivatives decide.
pub(super) const HALF_THE_DIGITS: f64 = 1e-8;

/// A Bézier piece with its place in the surface it was cut from.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The piece on its unit square.
    pub patch: TensorPatch,
    /// The index of the surface, in the order given.
    pub surface: u32,
    /// Which sides are borders of the surface, and which are collapsed, a bit each in the order of
    /// [`RectSide::ALL`].
    border: u8,
    collapsed: u8,
    /// Which of the collapsed ones are apexes, such as that of a cone (see
    /// [`apexes`](super::apexes)).
    apexes: u8,
    /// Whether another piece that differs there begins at the end of this one, in `u` and in `v`,
    /// for example where the surface jumps. The knot itself then belongs to that piece.
    open_end: u8,
}

impl Piece {
    /// The piece that begins with the given row and column of a net.
    pub(in crate::patch) fn new(net: &Arc<ChartNet>, surface: u32, first: [u32; 2]) -> Self {
        let (patch, points) = TensorPatch::new(net, first);
        let spans = [0, 1].map(|k| &net.spans[k][first[k] as usize]);
        let border = sides(|side| spans[side.fixed()].border[side.end()]);
        let open_end = u8::from(spans[0].open_end) | u8::from(spans[1].open_end) << 1;
        let collapsed = collapsed_sides(&patch, &points);
        Self { patch, surface, border, collapsed, apexes: 0, open_end }
    }

    /// The knot rectangle of its chart that the piece covers: from and to in `u`, then in `v`.
    #[inline]
    pub fn domain(&self) -> [[f64; 2]; 2] {
        let TensorPatch { net, first: [row, column], .. } = &self.patch;
        [net.spans[0][*row as usize].domain, net.spans[1][*column as usize].domain]
    }

    /// How long the domain is in `u` and in `v`.
    pub(crate) fn lengths(&self) -> DVec2 {
        DVec2::from_array(self.domain().map(|[from, to]| to - from))
    }

    /// Whether a side is a border of the surface.
    pub(crate) fn is_border(&self, side: RectSide) -> bool {
        has(self.border, side as usize)
    }

    /// The surface parameters of a point of the unit square; exact at its corners, except at an
    /// open end, where they are the last number before the knot.
    #[inline]
    pub fn uv(&self, st: DVec2) -> DVec2 {
        self.patch.net.map.uv(self.chart_uv(st))
    }

    /// The parameters of its chart at a point of the unit square: see [`uv`](Self::uv).
    #[inline]
    pub(crate) fn chart_uv(&self, st: DVec2) -> DVec2 {
        let domain = self.domain();
        let at = |k: usize| {
            let [from, to] = domain[k];
            let u = if st[k] == 1.0 { to } else { from + st[k] * (to - from) };
            if has(self.open_end, k) && u >= to { to.next_down() } else { u }
        };
        DVec2::new(at(0), at(1))
    }

    /// The trims that say which part of its chart is kept.
    pub fn trims(&self) -> Option<&Trims> {
        self.patch.net.trims.as_deref()
    }

    /// Whether a point of the unit square is kept by the trims, if it is known to `reach` in each
    /// parameter; an edge wherever the answer may depend on `reach`, or on the rounding of
    /// [`Self::uv`].
    pub fn side(&self, st: DVec2, reach: DVec2) -> Side {
        self.side_within(st, reach, 1.0)
    }

    /// [`side`](Self::side), but of the rounding of parameters and trim curves only this part
    /// counts.
    pub(crate) fn side_within(&self, st: DVec2, reach: DVec2, part: f64) -> Side {
        let Some(trims) = self.trims() else { return Side::Inside };
        trims.seen_within(self.chart_uv(st), self.chart_reach(reach, part), part)
    }

    /// Whether a trim curve that does not lie on the domain's border passes within `reach` of a
    /// point of the unit square, or within the rounding of [`Self::uv`].
    pub(crate) fn is_cut_within(&self, st: DVec2, reach: DVec2) -> bool {
        let reach = self.chart_reach(reach, 1.0);
        self.trims().is_some_and(|trims| trims.cuts(&UvBox::about(self.chart_uv(st), reach)))
    }

    /// `reach` on the unit square as one in the chart's parameters, with this part of their
    /// rounding.
    pub(crate) fn chart_reach(&self, reach: DVec2, part: f64) -> DVec2 {
        let reach = reach * self.lengths() + part * self.uv_rounding();
        // NaN means unknown.
        DVec2::select(reach.cmpge(DVec2::ZERO), reach, DVec2::INFINITY)
    }

    /// What the trims look like within a rectangle, in box coordinates: see [`Trims::window`].
    pub(in crate::patch) fn trim_window(&self, rect: StRect) -> Vec<WindowCurve> {
        let Some(trims) = self.trims() else { return Vec::new() };
        let [min, max] = [0, 1].map(|k| self.chart_uv(DVec2::new(rect[0][k], rect[1][k])));
        trims.window(&UvBox { min, max }, self.uv_rounding())
    }

    /// A rectangle that holds everything that the trims keep of a part of the unit square; `None`
    /// if there are no trims, or if they keep nothing.
    pub fn kept_part(&self, rect: StRect) -> Option<StRect> {
        let kept = self.trims()?.kept_within(&self.uv_box(rect))?.grown(self.uv_rounding());
        let domain = self.domain();
        Some([0, 1].map(|k| {
            let [from, to] = domain[k];
            [kept.min[k], kept.max[k]].map(|at| (at - from) / (to - from))
        }))
    }

    /// The box of the chart's parameters over a part of the unit square, grown by their rounding
    /// error.
    pub(in crate::patch) fn uv_box(&self, rect: StRect) -> UvBox {
        let at = |k: usize| self.chart_uv(DVec2::new(rect[0][k], rect[1][k]));
        UvBox { min: at(0), max: at(1) }.grown(self.uv_rounding())
    }

    /// The error bound of computed parameters: the roundings of a product, two sums and the length
    /// of the domain; at an open end one number more.
    fn uv_rounding(&self) -> DVec2 {
        let largest = self.domain().map(|[from, to]| from.abs().max(to.abs()));
        4.0 * f64::EPSILON * DVec2::from_array(largest)
    }

    /// The parameter from which on, in `u` or `v`, the next piece begins, at an open end.
    pub(crate) fn open_end(&self, k: usize) -> Option<f64> {
        has(self.open_end, k).then(|| self.domain()[k][1])
    }

    /// Whether another piece is of the same chart.
    pub(crate) fn shares_chart_with(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.patch.net, &other.patch.net)
    }

    /// Whether its chart's parameters differ from the surface's own.
    pub(crate) fn is_placed(&self) -> bool {
        !matches!(self.patch.net.map, ChartMap::Identity)
    }

    /// Whether a side is collapsed to a point.
    #[inline(always)]
    pub(crate) fn is_collapsed(&self, side: RectSide) -> bool {
        has(self.collapsed, side as usize)
    }

    /// The point a side is collapsed to.
    pub(crate) fn collapsed(&self, side: RectSide) -> Option<DVec3> {
        if !self.is_collapsed(side) {
            return None;
        }
        let [i, j] = side.control_point(self.patch.degree(), 0);
        Some(euclidean(self.patch.control_point(i, j)))
    }

    /// The distances of a point, to first order, from the four sides: along one parameter, times
    /// the sine of the angle to the other. Where the tangents are parallel, as in a cusp, every
    /// side would be near; there the sine is taken to be at least `LEAST_SINE`.
    pub(crate) fn side_distances(&self, st: DVec2, jet: &Jet) -> [f64; 4] {
        let (ds, dt) = (jet.ds.length(), jet.dt.length());
        let sine = jet.ds.cross(jet.dt).length() / (ds * dt);
        let sine = if sine > 0.0 { sine.max(LEAST_SINE) } else { 1.0 }; // also at a pole
        let (ds, dt) = (sine * ds, sine * dt);
        [st.x * ds, (1.0 - st.x) * ds, st.y * dt, (1.0 - st.y) * dt]
    }

    /// The unit normal at a point of the unit square; near collapsed sides its limit from inside
    /// the piece. `None` where there is none. (At an [apex](Self::is_apex) it is the limit along
    /// the other parameter: not the surface's normal, but a bound of how flat a ray may be.)
    ///
    /// Beside a collapsed side the tangent along it vanishes; there the pole determines the normal
    /// (`pole_normal`). Where it does not, for example where two such sides meet, the tangent is
    /// known to `error / ρ` at a distance `ρ`, while the limit at the side itself differs from the
    /// truth by up to `ρ / size`. The limit is taken where it is the nearer of the two, so that
    /// half of the digits are right. Where second derivatives give no limit, and the tangents are
    /// only rounding error, nothing is known.
    pub fn normal(&self, st: DVec2, jet: &Jet) -> Option<DVec3> {
        let by_pole = self.normal_by_pole(st);
        if let Some((normal, turned)) = by_pole
            && turned <= TURNED_AT_POLE
        {
            return Some(normal);
        }
        let error = self.patch.noise();
        let clear = (error * self.patch.size()).sqrt();
        let distances = self.side_distances(st, jet);
        let parameters = RectSide::distances(st);
        let near = |side: RectSide| {
            let reaches = distances[side] <= clear && parameters[side] <= BESIDE_COLLAPSED;
            self.is_collapsed(side) && reaches
        };
        // All along a collapsed side, the collapsed sides that it meets are near, too: only the
        // side that is nearest in its parameter counts.
        let nearest = RectSide::ALL
            .into_iter()
            .filter(|&side| self.is_collapsed(side))
            .min_by(|&a, &b| parameters[a].total_cmp(&parameters[b]))
            .filter(|&side| near(side));
        let cross = jet.ds.cross(jet.dt);
        let sides = [jet.ds.length(), jet.dt.length()];
        let regular = cross.length() > HALF_THE_DIGITS * sides[0] * sides[1];
        let Some(nearest) = nearest else {
            return if regular { cross } else { self.limit(st).unwrap_or(cross) }.try_normalize();
        };
        let place = nearest.beside(st);
        let near_sides = RectSide::ALL.into_iter().filter(|&side| near(side));
        let corner = near_sides.fold(place, |place, side| side.beside(place));
        let limit = self.limit_beside(place, st).or_else(|| self.limit_beside(corner, st));
        let [p, q] = self.patch.degree().map(|degree| 2.0 * degree as f64 * error);
        let turned = (p * sides[1] + q * sides[0]) / cross.length();
        let by_tangents = cross.try_normalize().map(|unit| (unit, turned));
        let both = by_pole.into_iter().chain(by_tangents);
        match (limit, both.min_by(|a, b| a.1.total_cmp(&b.1))) {
            // What is known of the normal here must not contradict it.
            (Some(limit), Some((unit, turned))) if limit.distance(unit) <= 4.0 * turned => {
                Some(limit)
            }
            (Some(limit), None) => Some(limit),
            (_, known) => {
                known.filter(|(_, turned)| *turned <= TURNED_AT_MOST).map(|(unit, _)| unit)
            }
        }
    }

    /// The unit normal from the pole of a collapsed side that is near, and the angle, in radians,
    /// by which rounding may have turned it, from the pole that tells most; `None` if there is
    /// none.
    fn normal_by_pole(&self, st: DVec2) -> Option<(DVec3, f64)> {
        let parameters = RectSide::distances(st);
        self.collapsed_sides()
            .filter(|(side, _)| parameters[*side] <= BESIDE_POLE)
            .filter_map(|pole| normal_by_pole(&self.patch, pole, st))
            .min_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The limit of the normal at a place, for another one beside it; `None` where the tangents
    /// turn on the way.
    fn limit_beside(&self, place: DVec2, st: DVec2) -> Option<DVec3> {
        let known = self.known_derivatives(place);
        let way = (place - st).abs();
        let turns = |first: DVec3, second: DVec3, way: f64| {
            first != DVec3::ZERO && first.length() < STEADY * way * second.length()
        };
        if turns(known.du, known.duu, way.x) || turns(known.dv, known.dvv, way.y) {
            return None;
        }
        known.unit_normal(inward(place))
    }

    /// Whether a point is an apex, such as that of a cone, to within rounding: the point of a
    /// collapsed side at which normals have different limits, so that the surface has no normal.
    pub fn is_apex(&self, point: DVec3) -> bool {
        let is_at = |apex: DVec3| point.distance(apex) <= self.patch.one_point();
        let mut poles = self.collapsed_sides();
        poles.any(|(side, pole)| has(self.apexes, side as usize) && is_at(pole))
    }

    /// Marks a collapsed side as an apex.
    pub(super) fn make_apex(&mut self, side: RectSide) {
        self.apexes |= 1 << side as usize;
    }

    /// The limit of the unit normal from inside the piece.
    fn limit(&self, place: DVec2) -> Option<DVec3> {
        self.known_derivatives(place).unit_normal(inward(place))
    }

    /// The derivatives, except those that are only rounding error.
    fn known_derivatives(&self, place: DVec2) -> SurfaceDerivatives {
        let derivatives = self.patch.derivatives(place);
        derivatives.without_noise(self.patch.degree(), self.patch.noise())
    }

    /// The limits of the unit normal at a few places along a side, where there are any.
    pub(super) fn limits_along(&self, side: RectSide) -> impl Iterator<Item = DVec3> {
        [0.1, 0.3, 0.5, 0.7, 0.9].into_iter().filter_map(move |t| self.limit(side.place(t)))
    }

    /// The sides that are collapsed to a point.
    pub fn collapsed_sides(&self) -> impl Iterator<Item = (RectSide, DVec3)> {
        RectSide::ALL.into_iter().filter_map(|side| Some((side, self.collapsed(side)?)))
    }

    /// The directions that lead away from the pole at a collapsed side, along that side.
    ///
    /// Where `t` is zero on the side, the surface minus the pole is `t q Σ Bᵢ(s) wᵢ (Pᵢ − P) / W`
    /// except for higher powers of `t`, with the control points `Pᵢ` of the next row: the
    /// directions are those of a Bézier curve, whose control points these are.
    pub(crate) fn away_from_pole(&self, side: RectSide, pole: DVec3) -> Vec<DVec3> {
        let (fixed, degree) = (side.fixed(), self.patch.degree());
        let row = if side.is_last() { degree[fixed] - 1 } else { 1 };
        let away = (0..=degree[side.along()]).map(|k| {
            let [i, j] = fixed.pair(row, k);
            let control = self.patch.control_point(i, j);
            control.truncate() - control.w * pole
        });
        away.collect()
    }
}

/// The direction into the unit square from a place on its border.
fn inward(place: DVec2) -> DVec2 {
    let sign = |x: f64| if x < 0.5 { 1.0 } else { -1.0 };
    DVec2::new(sign(place.x), sign(place.y))
}

/// The sides of a piece that are collapsed to a point, a bit each: all their control points
/// agree with the first to a few roundings of their size.
fn collapsed_sides(patch: &TensorPatch, points: &[DVec3]) -> u8 {
    let degree = patch.degree();
    let tolerance = patch.one_point();
    let is_point = |side: RectSide| {
        let at = |k: usize| {
            let [i, j] = side.control_point(degree, k);
            points[i * (degree[1] + 1) + j]
        };
        // From the far end: sides that are not collapsed are ruled out at once.
        let mut others = (1..=degree[side.along()]).rev();
        others.all(|k| (at(k) - at(0)).abs().max_element() <= tolerance)
    };
    let collapsed = sides(is_point);
    // A piece that is a point all over has no sides to speak of.
    if collapsed == 0b1111 { 0 } else { collapsed }
}

/// The sides for which something holds, a bit each.
fn sides(hold: impl Fn(RectSide) -> bool) -> u8 {
    RectSide::ALL.into_iter().map(|side| u8::from(hold(side)) << side as usize).sum()
}

const _: () = assert!(size_of::<Piece>() == 32);
