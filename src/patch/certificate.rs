//! The proof that a ray meets a leaf at most once.

mod tangent_pairs;
mod tangents;

use std::ops::{Add, Mul};

use glam::DVec3;

use self::tangents::{MARGIN, TangentBounds};
use super::oriented_box::Axes;
use super::pieces::field::Net;
use super::{LEAF_SLACK, OrientedBox};
use crate::geometry::RectSide;
use crate::math::Interval;
use crate::math::rounded::{Near16, Up8, Up16};

/// A promise about all rays that are steep enough: each meets the leaf, widened on all
/// sides, at most once; and how far the leaf's tangents turn.
///
/// # What is bounded
/// Write the piece over the convex parameter rectangle `D` as `S = c + X / W`, where the Bernstein
/// coefficients of `X` are `w_ij (P_ij − c)` and those of `W` are `w_ij > 0`. By the quotient rule
/// `S_s = a / W` with `a = X_s − (S − c) W_s`, and `S_t = b / W` likewise. On `D` every component
/// of `X_s` lies between the smallest and the largest of its Bernstein coefficients, and so does
/// `W_s`; `S − c` lies in the hull of the `P_ij − c`. Interval arithmetic, rounded outwards and
/// widened by the rounding error of the coefficients, gives a box around every coefficient of `a`
/// and of `b`, in the frame `(a₀, b₀, n)` of the leaf's chords and its normal:
/// `a = α₁ a₀ + α₂ b₀ + α₃ n`, `b = β₁ a₀ + β₂ b₀ + β₃ n`. If `α₁ > 0` in all of these boxes, the
/// quotients `α₂/α₁` and `α₃/α₁` of a sum are weighted means of the quotients of its terms, and
/// likewise for `b`. So intervals around the quotients of the coefficients hold the quotients of
/// the means of `a` and of `b` over any set.
///
/// Where the weights differ, changes of `X_s` and of `(S − c) W_s` may cancel, which these boxes do
/// not show. So unless there are too many coefficients, or a pole, `a W = W X_s − X W_s` and `b W`
/// are multiplied out; their coefficients replace those boxes, and the square of `W` replaces `W`.
///
/// # What is concluded
/// Let a ray with unit direction `d` meet `S` at two points `x ≠ y` of `D`, and let `F` be
/// the two distances from a pair of perpendicular planes through the ray. Then
/// `0 = F(y) − F(x) = J̄ (y − x)`, where `J̄` is the mean of the Jacobian along the segment
/// from `x` to `y`: its columns are the projections of `∫ a/W` and `∫ b/W`, which are
/// positive multiples `λā`, `μb̄` of means of `a` and `b`, and `det J̄ = ± λμ d·(ā × b̄)`.
/// With `ā = α₁ (a₀ + ρ₂ b₀ + ρ₃ n)` and `b̄ = β₂ (σ₁ a₀ + b₀ + σ₃ n)`
///
/// `ā × b̄ = α₁ β₂ m (a₀ × b₀ + g (a₀ × n) + h (b₀ × n))`,
///
/// `m = 1 − ρ₂σ₁`, `g = (σ₃ − ρ₃σ₁) / m`, `h = (ρ₂σ₃ − ρ₃) / m`. With `g` within `r` of `g₀` and
/// `h` within `q` of `h₀`, the product with `d` is not zero, hence `x = y`, whenever
/// `|N·d| > |A·d| + |B·d|` with `N = n + (g₀ (a₀ × n) + h₀ (b₀ × n)) / |a₀ × b₀|`,
/// `A = r (a₀ × n) / |a₀ × b₀|` and `B = q (b₀ × n) / |a₀ × b₀|`: three dot products. `N` is about
/// the mean normal; the normal of the chords may lean to one side of it. Splitting off the parts
/// along `a₀` and `b₀`, and the lengths, matters: the speed of the parametrisation does no harm,
/// only the turning of the tangents does; and the less the leaf turns in the direction that a ray
/// comes from, the flatter the ray may be. For polynomial pieces `ā` and `b̄`, both means over one
/// segment, are bounded together where that says more: see `PairTurns`.
///
/// # How a miss is proved
/// Let `x` lie in `D` beyond all points `y` of the leaf in `s`, so that `y − x` has a first
/// component of known sign, and let the ray be certified: the determinant has one sign on all of
/// `D`, that of `N·d` (not of `n·d`). If the ray met the leaf at `y`,
/// `−F(x) = λā (y − x)₁ + μb̄ (y − x)₂` would determine the sign of the cross product `F(x) × b̄`:
/// opposite to its sign where Newton's step from `x` leads away from the leaf. The product has the
/// same sign for all `b̄` as for `b₀` if `|F × b₀| > |σ₁| |F × a₀| + |σ₃| |F × n|` with the largest
/// `|σ₁|` and `|σ₃|`; each of the three products allows for the error bound of `F`. The same holds
/// for `t`, with `ρ₂` and `ρ₃`. (These bounds are those of each tangent by itself, and are unknown
/// where one turns too far; the determinant's sign may come from both tangents together.)
///
/// At a side that is collapsed to a point `c`, say `t = 0`, `X = t X̃` and
/// `S_s = t (X̃_s − (X̃/W) W_s) / W`: the bracket takes the place of `a`, and positive
/// multiples keep the argument. So poles are certified too, except the pole itself.
///
/// # What rounding costs
/// The points of a leaf's net are cut out of the piece's twice, the second time a little beyond the
/// leaf; the error allowed for them is that of computed points, which takes roundings to have
/// random signs, as the exact solver does. A pessimistic count exceeds it where both degrees add up
/// to more than eight (for pairs, from degree seven on). That matters only where a leaf is no more
/// than some thousand times as large as that error.
///
/// `A` and `B` are taken with 2 % to spare, so that with `cos θ` short for `|N·d|`
/// `|d·(ā × b̄)| ≥ 0.019 cos θ α₁ β₂ |a₀ × b₀| m` (for pairs, with half their least `m` in place of
/// `α₁ β₂ m`). A computed point `x` of `D` with `|F(x)| ≤ ε` is then within `ε·spread/cos θ` of the
/// root, if there is one, in each parameter, measured in sides of the leaf: the leaf's owner
/// compares that with its slack. And where the root lies farther than that beyond a side of the
/// piece, no point of the piece in `D` is within `ε` of the ray.
///
/// # What is kept
/// `a₀`, `b₀` and `n` are the axes of the leaf's [`OrientedBox`], so `n·d`, `A·d` and `B·d` are, up
/// to factors, the products of the box's rows with a direction, which are computed anyway: its
/// *slopes*. The factors are kept in units of the third slope, in sixteen bits, those for misses in
/// eight. Those of `N` are rounded to nearest, and `r` and `q` reach from the rounded values; all
/// others are rounded up. So every condition becomes a little harder to meet, by less than 1 %, or
/// by an eighth for misses. Rows in f32 are off by 2⁻²⁴ of their length; the last number that
/// `turning` returns covers that and nine f32 roundings of each of the three slopes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Certificate {
    /// A ray with slopes `a, b, c` has the steepness `e = |c + lean₀ a + lean₁ b|`, and meets the
    /// widened leaf at most once where `e > turning₀ |a| + turning₁ |b| + rounding`.
    lean: [Near16; 2],
    turning: [Up16; 2],
    rounding: Up16,
    /// A computed point with a residual of at most `ε` is well within the leaf's slack of the root
    /// if also `e ≥ ε steep_per_error`.
    steep_per_error: Up16,
    /// How far tangents may tilt, as multiples of unit vectors: for a step in `s`, how far `S_t`
    /// tilts from `b₀` towards `a₀` and towards the normal; for a step in `t`, how far `S_s` tilts
    /// from `a₀` towards `b₀` and towards the normal.
    tilts: [[Up8; 2]; 2],
    /// In a leaf that ends in a pole: `e ρ ≥ ε pole_per_error` is needed, too, for a ray at
    /// the distance `ρ` from the pole. Zero for other leaves.
    pole_per_error: Up16,
}

/// More than the f32 rounding error of the sum of three slopes, in units of the third row's length:
/// ten roundings of 2⁻²⁴ of each, of rows whose lengths add up to no more than five, come to 3e-6.
/// The margin is so large that what is left is known to a third, too.
const SLOPE_ROUNDING: f64 = 1e-5;

/// How many times as far beyond a side as needed a root must lie to prove a miss: the root, and the
/// points of the piece, may each be off by the error bound; and slopes are in f32.
const ROOM: f64 = 4.0;

/// The margin on each product of the residual with an axis, as a share of the residual, where a
/// miss is proved: far more than what rounding changes, of a residual that is [`CLEAR_OF_ERROR`]
/// times the error, of the point that it is compared with, or of axes in f32.
pub(crate) const SURELY: f64 = 1e-3;

/// A miss is only proved from residuals more than this many times the error.
pub(crate) const CLEAR_OF_ERROR: f64 = 1e4;

impl Certificate {
    /// The certificate of the net over the widened rectangle, for rays measured by the leaf's
    /// box. It holds for no ray when the tangents turn too far, or nothing can be said.
    pub(super) fn new(
        net: &Net<'_>,
        collapsed: Option<RectSide>,
        axes: &Axes,
        oriented: &OrientedBox,
    ) -> Self {
        let lengths = oriented.directions().map(DVec3::length);
        let Some(bounds) = TangentBounds::new(net, collapsed, axes) else {
            return Self::none(collapsed);
        };
        // The first row points along `b₀ × n`, the second along `n × a₀`.
        let Interval { lo, hi } = bounds.turning[0];
        let turning = [bounds.turning[1], Interval { lo: -hi, hi: -lo }];
        let turning =
            [0, 1].map(|k| turning[k] * Interval::point(lengths[2] / lengths[k]).outward());
        let lean = turning.map(|turning| Near16::to(0.5 * (turning.lo + turning.hi)));
        let farthest = |k: usize| {
            let lean = f64::from(lean[k].value());
            MARGIN * (turning[k] - Interval::point(lean)).magnitude()
        };
        // Both allow a little more than the rounding of the products to f32 on the way.
        let slack = 0.5 * LEAF_SLACK * 0.999;
        Self {
            lean,
            turning: [Up16::above(farthest(0)), Up16::above(farthest(1))],
            rounding: Up16::above(SLOPE_ROUNDING * lengths[2]),
            steep_per_error: Up16::above(bounds.spread * lengths[2] / slack),
            tilts: bounds.tilts.map(|tilts| tilts.map(Up8::above)),
            pole_per_error: Up16::above(bounds.pole_spread * lengths[2] / slack),
        }
    }

    /// No ray is certified.
    fn none(collapsed: Option<RectSide>) -> Self {
        let never = Up16::above(f64::INFINITY);
        let pole_per_error = if collapsed.is_some() { never } else { Up16::above(0.0) };
        Self {
            lean: [Near16::to(0.0); 2],
            turning: [never; 2],
            rounding: never,
            steep_per_error: never,
            tilts: [[Up8::above(f64::INFINITY); 2]; 2],
            pole_per_error,
        }
    }

    /// Whether a ray with these slopes meets the widened leaf at most once.
    #[inline(always)]
    pub(crate) fn holds(&self, slopes @ [a, b, _]: [f64; 3]) -> bool {
        let [by_a, by_b, rounding] = self.turning().map(f64::from);
        self.steepness(slopes) > by_a * a.abs() + by_b * b.abs() + rounding
    }

    /// Returns the steepness of a ray with these slopes, if it meets the widened leaf at most once
    /// and rounding is small against the leaf: `error` is the bound, in scene units, of a point's
    /// distance from the ray. Leaves that end in a pole have a further condition: see
    /// [`pole_per_error`](Self::pole_per_error).
    #[inline(always)]
    pub(crate) fn steepness_if_valid(&self, slopes: [f64; 3], error: f64) -> Option<f64> {
        let steepness = self.steepness(slopes);
        let needed = error * f64::from(self.steep_per_error());
        (self.holds(slopes) && needed <= steepness).then_some(steepness)
    }

    /// The steepness of a ray with these slopes, in units of the third.
    #[inline(always)]
    pub(crate) fn steepness(&self, slopes: [f64; 3]) -> f64 {
        self.upright(slopes).abs()
    }

    /// The third of a ray's slopes, or of the rows that slopes come from, corrected by the
    /// certificate's lean.
    #[inline(always)]
    pub(crate) fn upright<T>(&self, [a, b, c]: [T; 3]) -> T
    where
        f64: Mul<T, Output = T>,
        T: Add<Output = T>,
    {
        let [by_a, by_b] = self.lean().map(f64::from);
        c + by_a * a + by_b * b
    }

    /// The multiples of the first two slopes by which the third is corrected.
    #[inline(always)]
    pub(crate) fn lean(&self) -> [f32; 2] {
        self.lean.map(Near16::value)
    }

    /// The factors of the first two slopes, and what is added for rounding.
    #[inline(always)]
    pub(crate) fn turning(&self) -> [f32; 3] {
        [self.turning[0].value(), self.turning[1].value(), self.rounding.value()]
    }

    /// The steepness needed for an error of one scene unit.
    #[inline(always)]
    pub(crate) fn steep_per_error(&self) -> f32 {
        self.steep_per_error.value()
    }

    /// The clearance per error: where the root lies farther beyond a side of the piece, in box
    /// coordinates, than this times the error bound of points over the steepness, all points of the
    /// piece in the widened leaf are farther from the ray than that error bound. Not for leaves
    /// that end in a pole.
    #[inline(always)]
    pub(crate) fn clearance_per_error(&self) -> f64 {
        ROOM * LEAF_SLACK * f64::from(self.steep_per_error.value())
    }

    /// Like [`steep_per_error`](Self::steep_per_error), but for the steepness times the distance
    /// from the pole; zero for leaves without one.
    #[inline(always)]
    pub(crate) fn pole_per_error(&self) -> f32 {
        self.pole_per_error.value()
    }

    /// How far tangents may tilt, as multiples of unit vectors: for a step in `s`, how far `S_t`
    /// does, along `S_s` and along the normal; for a step in `t`, how far `S_s` does.
    #[inline(always)]
    pub(crate) fn tilts(&self) -> [[f64; 2]; 2] {
        self.tilts.map(|tilts| tilts.map(|tilt| f64::from(tilt.value())))
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use glam::{DVec2, DVec3};
    use proptest::prelude::*;

    use crate::geometry::{KnotVector, NurbsSurface, RectSide};
    use crate::math::testing::same_cases;
    use crate::patch::{LEAF_SLACK, Leaf, OrientedBox, PatchSet, ScaledFrame};

    /// A random piece, and its leaves.
    fn leaves(bumps: &[(f64, f64)], rational: bool) -> (PatchSet, Vec<(Leaf, OrientedBox)>) {
        let points = (0..16).map(|k| DVec3::new((k / 4) as f64, (k % 4) as f64, bumps[k].0));
        leaves_of(points, bumps, rational)
    }

    /// The piece with these control points, whose weights are the second of each pair, and its
    /// leaves.
    fn leaves_of(
        points: impl Iterator<Item = DVec3>,
        weights: &[(f64, f64)],
        rational: bool,
    ) -> (PatchSet, Vec<(Leaf, OrientedBox)>) {
        let control = points.zip(weights).map(|(point, &(_, w))| {
            let w = if rational { w } else { 1.0 };
            (w * point).extend(w)
        });
        let knots = || KnotVector::bezier(3).unwrap();
        let surface = NurbsSurface::from_homogeneous(knots(), knots(), control.collect());
        let (set, parts) = PatchSet::new(&[surface.unwrap()]).unwrap();
        let frame = ScaledFrame::around(&set.bounds());
        let leaf = |part| {
            let (leaf, _, oriented) = Leaf::new(part, &set.pieces()[0], &frame);
            (leaf, oriented)
        };
        let leaves = parts.all().iter().map(leaf).collect();
        (set, leaves)
    }

    /// No line through two points of a leaf is certified to meet it at most once, and some nearly
    /// are.
    #[test]
    fn chords_are_not_certified() {
        let place = || (-1.02..1.02f64, -1.02..1.02f64);
        let bumps = prop::collection::vec((-0.6..0.6f64, 0.7..1.4f64), 16);
        let pairs = prop::collection::vec((place(), place()), 40);
        let (asked, nearest) = (Cell::new(0), Cell::new(f64::INFINITY));
        proptest!(same_cases(256), |(bumps in bumps, rational in any::<bool>(), pairs in pairs)| {
            let (set, leaves) = leaves(&bumps, rational);
            let patch = &set.pieces()[0].patch;
            for (leaf, oriented) in &leaves {
                let at = |(x, y): (f64, f64)| {
                    let [s, t] = leaf.rect().map(|[from, to]| [0.5 * (from + to), 0.5 * (to - from)]);
                    patch.point(DVec2::new(s[0] + x * s[1], t[0] + y * t[1]))
                };
                for &(from, to) in &pairs {
                    let chord = at(to) - at(from);
                    let Some(d) = chord.try_normalize() else { continue };
                    let slopes @ [a, b, _] = oriented.directions().map(|row| row.dot(d));
                    let certificate = &leaf.certificate;
                    prop_assert!(!certificate.holds(slopes), "{from:?} to {to:?}");
                    let [by_a, by_b, _] = certificate.turning().map(f64::from);
                    let needed = by_a * a.abs() + by_b * b.abs();
                    nearest.set(nearest.get().min(needed / certificate.steepness(slopes)));
                    asked.set(asked.get() + 1);
                }
            }
        });
        let (asked, nearest) = (asked.get(), nearest.get());
        assert!(asked > 1000 && nearest < 1.2, "{asked} chords, one to {nearest}");
    }

    /// The same for leaves that end in a pole, at any of the sides, whose points agree only to a
    /// few roundings: as near to the pole as the certificate speaks of rays.
    #[test]
    fn chords_beside_poles_are_not_certified() {
        let along = || -1.02..1.02f64;
        let bumps = prop::collection::vec((-0.6..0.6f64, 0.7..1.4f64), 16);
        // The distances of both from the pole, as powers of ten.
        let away = (-11.0..0.0f64).prop_flat_map(|away| (Just(away), away - 1.0..away));
        let pairs = prop::collection::vec((along(), along(), away), 40);
        let (asked, close, nearest) = (Cell::new(0), Cell::new(0), Cell::new(f64::INFINITY));
        proptest!(same_cases(256), |(bumps in bumps, rational in any::<bool>(), side in 0usize..4, pairs in pairs)| {
            // A fan: all points of a side agree, to within what still counts as a point.
            let side = RectSide::ALL[side];
            let end = 3 * side.end();
            let noise = 3.0 * 8.0 * f64::EPSILON;
            let points = (0..16).map(|k| {
                let at = [k / 4, k % 4];
                let shift = if at[side.fixed()] == end { bumps[k].0 * noise } else { 0.0 };
                let [x, y] = at.map(|x| x as f64);
                if at[side.fixed()] == end {
                    let [x, y] = side.fixed().pair([x, y][side.fixed()], 1.5);
                    DVec3::new(x, y, shift)
                } else {
                    DVec3::new(x, y, bumps[k].0)
                }
            });
            let (set, leaves) = leaves_of(points, &bumps, rational);
            let piece = &set.pieces()[0];
            prop_assert!(piece.is_collapsed(side));
            let error = piece.patch.error_bound(0.0);
            for (leaf, oriented) in leaves.iter().filter(|(leaf, _)| leaf.pole(piece).is_some()) {
                let pole = leaf.pole(piece).unwrap();
                let rect = leaf.rect();
                let at = |(along, away): (f64, f64)| {
                    let [near, far] = rect[side.fixed()];
                    let away = 10f64.powf(away) * (far - near);
                    let away = if side.is_last() { far - away } else { near + away };
                    let [from, to] = rect[side.along()];
                    let middle = 0.5 * (from + to + along * (to - from));
                    piece.patch.point(side.fixed().pair(away, middle).into())
                };
                for &(along_from, along_to, (away_from, away_to)) in &pairs {
                    let (from, to) = (at((along_from, away_from)), at((along_to, away_to)));
                    let Some(d) = (to - from).try_normalize() else { continue };
                    let slopes @ [a, b, _] = oriented.directions().map(|row| row.dot(d));
                    let certificate = &leaf.certificate;
                    let steepness = certificate.steepness(slopes);
                    let distance = (pole - from).cross(d).length();
                    // Nearer than that the certificate speaks of no ray.
                    let least = error * f64::from(certificate.pole_per_error()) / steepness;
                    let far_off = distance >= least;
                    if !far_off {
                        continue;
                    }
                    prop_assert!(!certificate.holds(slopes), "{from} to {to}, {side:?}");
                    let [by_a, by_b, _] = certificate.turning().map(f64::from);
                    let needed = by_a * a.abs() + by_b * b.abs();
                    nearest.set(nearest.get().min(needed / steepness));
                    asked.set(asked.get() + 1);
                    close.set(close.get() + u32::from(distance < 10.0 * least));
                }
            }
        });
        let (asked, close, nearest) = (asked.get(), close.get(), nearest.get());
        assert!(asked > 1000 && close > 50 && nearest < 1.3, "{asked}, {close}: {nearest}");
    }

    /// A point within the error of a certified ray is well within the slack of the root, also of a
    /// leaf that is hardly larger than errors. So where two points are farther apart, a ray through
    /// one is not certified for an error that reaches the other: not even the flattest rays along
    /// the chord that the leaf's turning allows.
    #[test]
    fn points_within_the_error_are_near_the_root() {
        let place = || prop_oneof![-1.0..1.0f64, Just(-1.0), Just(1.0)];
        // From one point to the other, in units of half the slack; and by how much rays are steeper
        // than the flattest.
        let apart = (1.0..1.2f64, -1.0..1.0f64, any::<bool>());
        let ray = (place(), place(), apart, prop_oneof![Just(1.0), 1.0..10.0f64]);
        let size = prop_oneof![Just(0.6), Just(0.1), Just(0.01)];
        let bumps = prop::collection::vec((-1.0..1.0f64, 0.7..1.4f64), 16);
        let rays = prop::collection::vec(ray, 16);
        let (asked, nearest) = (Cell::new(0), Cell::new(f64::INFINITY));
        let config = same_cases(128);
        proptest!(config, |(size in size, bumps in bumps, rational in any::<bool>(), rays in rays)| {
            let bumps: Vec<_> = bumps.iter().map(|&(bump, weight)| (size * bump, weight)).collect();
            let (set, leaves) = leaves(&bumps, rational);
            let patch = &set.pieces()[0].patch;
            for (leaf, oriented) in &leaves {
                let certificate = &leaf.certificate;
                for &(x, y, (far, other, swapped), steeper) in &rays {
                    let [s, t] = leaf.rect();
                    let at = |x: f64, y: f64| {
                        let inner = |[from, to]: [f64; 2], x| 0.5 * (from + to + x * (to - from));
                        patch.point(DVec2::new(inner(s, x), inner(t, y)))
                    };
                    // Half sides are one, sides two.
                    let moved = [far, far * other].map(|halves| LEAF_SLACK * halves);
                    let [dx, dy] = if swapped { [moved[1], moved[0]] } else { moved };
                    let (root, point) = (at(x, y), at(x + dx, y + dy));
                    let (along, normal) = ((point - root).normalize(), oriented.unit_axes()[2]);
                    let ray = |steep: f64| (along + steep * normal).normalize();
                    let slopes = |d: DVec3| oriented.directions().map(|row| row.dot(d));
                    let is_certified = |steep| certificate.holds(slopes(ray(steep)));
                    let (mut low, mut high) = (0.0, 4.0);
                    if !is_certified(high) {
                        continue;
                    }
                    for _ in 0..30 {
                        let middle = 0.5 * (low + high);
                        if is_certified(middle) { high = middle } else { low = middle }
                    }
                    let d = ray(steeper * high);
                    let error = (point - root).cross(d).length();
                    let valid = certificate.steepness_if_valid(slopes(d), error);
                    prop_assert!(valid.is_none(), "{error} at ({x}, {y}), along {d}");
                    let needed = error * f64::from(certificate.steep_per_error());
                    nearest.set(nearest.get().min(needed / certificate.steepness(slopes(d))));
                    asked.set(asked.get() + 1);
                }
            }
        });
        let (asked, nearest) = (asked.get(), nearest.get());
        assert!(asked > 1000 && nearest < 4.0, "{asked} rays, one to {nearest}");
    }

    /// Where a ray meets the continuation of a surface beyond its border, as far out as the
    /// certificate asks for, no point of the leaf is within the error, or twice the error.
    #[test]
    fn roots_beyond_a_border_are_far_enough() {
        let bumps = prop::collection::vec((-0.3..0.3f64, 0.7..1.4f64), 16);
        let ray = (1e-4..1e-3f64, 0.0..1.0f64, 0.05..1.0f64, 0.0..std::f64::consts::TAU);
        let rays = prop::collection::vec(ray, 8);
        let (asked, closest) = (Cell::new(0), Cell::new(f64::INFINITY));
        proptest!(same_cases(256), |(bumps in bumps, rational in any::<bool>(), rays in rays)| {
            let (set, leaves) = leaves(&bumps, rational);
            let piece = &set.pieces()[0];
            for (leaf, oriented) in &leaves {
                let [[s0, s1], [t0, t1]] = leaf.rect();
                if s0 != 0.0 {
                    continue;
                }
                for &(outside, along, steep, turn) in &rays {
                    let root = DVec2::new(-outside * (s1 - s0), t0 + along * (t1 - t0));
                    let [a, b, n] = oriented.unit_axes();
                    let flat = (1.0 - steep * steep).sqrt();
                    let d = (steep * n + flat * (turn.cos() * a + turn.sin() * b)).normalize();
                    let slopes = oriented.directions().map(|row| row.dot(d));
                    if !leaf.certificate.holds(slopes) {
                        continue;
                    }
                    // The largest error for which the certificate speaks of this root.
                    let clearance = leaf.certificate.clearance_per_error();
                    let error = 2.0 * outside * leaf.certificate.steepness(slopes) / clearance;
                    let from = piece.patch.point(root);
                    let distance = |t: f64| {
                        (piece.patch.point(DVec2::new(0.0, t)) - from).cross(d).length()
                    };
                    // The nearest point is one of the border.
                    let more = 0.02 * (t1 - t0);
                    let (mut low, mut high) = (t0 - more, t1 + more);
                    for _ in 0..60 {
                        let (p, q) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
                        if distance(p) < distance(q) { high = q } else { low = p }
                    }
                    let least = distance(low);
                    prop_assert!(least > 2.0 * error, "{least} of {error} at {root}, {d}");
                    asked.set(asked.get() + 1);
                    closest.set(closest.get().min(least / error));
                }
            }
        });
        let (asked, closest) = (asked.get(), closest.get());
        assert!(asked > 1000 && closest < 1e3, "{asked} rays, one to {closest} errors");
    }
}
