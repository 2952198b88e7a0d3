//! How the tangents of a leaf turn: the bounds that its certificate is made of.

use glam::{DVec3, DVec4};

use super::tangent_pairs::PairTurns;
use crate::geometry::RectSide;
use crate::math::Interval;
use crate::math::bernstein::MAX_DEGREE;
use crate::patch::mapped;
use crate::patch::oriented_box::Axes;
use crate::patch::pieces::field::{Field, Net};
use crate::patch::pieces::tensor::euclidean;

/// What is proved about a leaf, in the notation of [`Certificate`](crate::patch::Certificate).
pub(super) struct TangentBounds {
    /// The ranges of `g |a₀| / |a₀ × b₀|` and `h |b₀| / |a₀ × b₀|`; at a pole, symmetric about
    /// zero.
    pub(super) turning: [Interval; 2],
    /// See [`Certificate::tilts`](crate::patch::Certificate::tilts).
    pub(super) tilts: [[f64; 2]; 2],
    /// A point `ε` off the ray is within `ε·spread / cos θ` of the root, in sides of the leaf.
    pub(super) spread: f64,
    /// At a pole: the parameter along the collapsed side errs by at most
    /// `ε·spread / (ρ·cos θ)` sides of the leaf.
    pub(super) pole_spread: f64,
}

/// The factor by which bounds of the turning of tangents are enlarged.
pub(super) const MARGIN: f64 = 1.02;

/// The most that the largest sizes of `turning` may add up to: a leaf that turns farther is as good
/// as uncertified, and the rounding error of slopes grows with it.
const MOST_TURNING: f64 = 4.0;

/// Both tangents of a polynomial net are bounded together if the radii of their turning add up to
/// more than this. That takes twice as long as the rest of a certificate; for flatter leaves it
/// would certify few more rays.
const FAR: f64 = 0.4;

/// Nets of more points are not multiplied out with their weights: the number of products is the
/// square of the number of points.
const MOST_MULTIPLIED: usize = 36;
const _: () = assert!(MOST_MULTIPLIED - 2 <= MAX_DEGREE + 3, "degree 1 × 17 needs binomials of 34");

/// Larger tilts prove nothing: the f32 rounding of the axes may matter there.
const MOST_TILT: f64 = 1e3;

impl TangentBounds {
    /// The proof for the net over the widened rectangle, in the frame of the leaf's axes; `None`
    /// where the tangents turn too far, or nothing can be said.
    pub(super) fn new(net: &Net<'_>, collapsed: Option<RectSide>, axes: &Axes) -> Option<Self> {
        let [a, b, _] = axes.axes;
        match collapsed {
            None => regular_bounds(net, [a, b]),
            Some(side) => {
                // A net whose collapsed side is `t = 0`: swap and mirror until it is.
                let (degree, control) = net.with_collapsed_first(side);
                let [in_s, in_t] = net.spacing;
                let spacing = side.along().pair(in_s, in_t);
                let net = Net { degree, control: &control, spacing, ..*net };
                match side {
                    RectSide::FirstV => pole_bounds(&net, [a, b]),
                    RectSide::LastV => pole_bounds(&net, [a, -b]),
                    RectSide::FirstU | RectSide::LastU => {
                        let a = if side.is_last() { -a } else { a };
                        let mut bounds = pole_bounds(&net, [b, a])?;
                        bounds.turning.reverse();
                        bounds.tilts.reverse();
                        Some(bounds)
                    }
                }
            }
        }
    }
}

/// The parts of `X_s − Y W_s` and `X_t − Z W_t`, which the boxes of `a` and `b` are made of; or
/// both times `W` and multiplied out, if there are no factors though weights differ.
struct Tangents<'a> {
    /// `X_s`, and `X_t`.
    along: [&'a Field; 2],
    /// `Y` and `Z`, the factors of `W_s` and `W_t`: `S − c`, or `X̃ / W` at a pole; nothing where
    /// `W` is constant.
    factors: [Option<&'a Field>; 2],
    /// The range of the tangents' divisors: the weights, or their squares.
    weights: Interval,
    weight_slopes: [Interval; 2],
    noise: f64,
    /// The longest tangents for which rounding of the parameters is small against the noise.
    longest: [f64; 2],
    /// Whether all weights are alike.
    polynomial: bool,
}

/// What is proved about a net in the frame of `a₀` and `b₀`.
fn regular_bounds(net: &Net<'_>, axes: [DVec3; 2]) -> Option<TangentBounds> {
    let field = net.recentered(net.middle());
    if net.rational && field.values.len() <= MOST_MULTIPLIED {
        let along = [0, 1].map(|which| field.quotients_slope(which));
        return Tangents::of_quotient(net, &field, &along)?.bounds(&field, false, axes);
    }
    let (along_s, along_t) = (field.derivative_s(), field.derivative_t());
    let offsets = net.rational.then(|| field.offsets());
    let factors = [offsets.as_ref(); 2];
    Tangents::new(net, &field, [&along_s, &along_t], factors)?.bounds(&field, false, axes)
}

/// The same for a net whose side `t = 0` is collapsed to a point.
fn pole_bounds(net: &Net<'_>, axes: [DVec3; 2]) -> Option<TangentBounds> {
    let pole = euclidean(net.control[0]);
    let field = net.recentered(pole);
    let (along_s, along_t) = (field.derivative_s(), field.derivative_t());
    let over_t = field.over_t();
    let (offsets, scaled);
    let mut factors = [None; 2];
    if net.rational {
        // X̃ / W lies between 0 and the hull of X̃ / min W, component by component.
        let lowest = field.weights().lo;
        let mut values = mapped(&over_t.values, |x| (x.truncate() / lowest).extend(1.0));
        values.push(DVec4::ZERO);
        scaled = Field { degree: over_t.degree, values };
        offsets = field.offsets();
        factors = [Some(&scaled), Some(&offsets)];
    }
    let mut tangents = Tangents::new(net, &field, [&along_s, &along_t], factors)?;
    // X̃_s takes the place of X_s, while the weights' slopes stay those of W. Dividing by t
    // multiplies coefficients, and their errors, by up to q.
    let scaled_along_s = over_t.derivative_s();
    tangents.along[0] = &scaled_along_s;
    tangents.noise *= net.degree[1] as f64;
    tangents.bounds(&field, true, axes)
}

impl<'a> Tangents<'a> {
    /// The tangents of a field with these derivatives; `None` where weights are not known to be
    /// positive.
    fn new(
        net: &Net<'_>,
        field: &Field,
        along: [&'a Field; 2],
        factors: [Option<&'a Field>; 2],
    ) -> Option<Self> {
        let weights = field.weights();
        let positive = weights.lo > 0.0; // false if none is a number
        if !positive {
            return None;
        }
        let noise = net.noise * weights.hi;
        let longest = net.spacing.map(|spacing| 0.25 * net.noise / spacing);
        let weight_slopes = if net.rational {
            along.map(Field::weights)
        } else {
            // The differences of equal weights are rounding, and part of the noise.
            [Interval::point(0.0); 2]
        };
        let polynomial = !net.rational;
        Some(Self { along, factors, weights, weight_slopes, noise, longest, polynomial })
    }

    /// The same for `W² S_s` and `W² S_t`, which are positive multiples of the tangents, too.
    fn of_quotient(
        net: &Net<'_>,
        field: &Field,
        [along_s, along_t]: &'a [Field; 2],
    ) -> Option<Self> {
        let mut tangents = Self::new(net, field, [along_s, along_t], [None; 2])?;
        tangents.weight_slopes = [Interval::point(0.0); 2];
        // Both factors of each product may be off, and each is multiplied with a weight; sums of
        // the products are their means, times the degree at most.
        tangents.noise *= 4.0 * tangents.weights.hi;
        tangents.weights = tangents.weights * tangents.weights;
        Some(tangents)
    }

    /// How tangent `which` turns: the least component along the direction of that number, and the
    /// ranges of the quotients of the other two components by it. `None` if that component may
    /// vanish.
    #[inline(always)]
    fn turns(&self, which: usize, directions: &[DVec3; 3]) -> Option<Turns> {
        let (along, factor) = (self.along[which], self.factors[which]);
        let degree = along.degree[which] as f64 + 1.0;
        let mut boxes = [Interval::point(0.0); 3];
        for (interval, &direction) in boxes.iter_mut().zip(directions) {
            let noise = 4.0 * degree * self.noise * direction.length();
            if let Some(factor) = factor {
                *interval = factor.component(direction) * self.weight_slopes[which];
            }
            *interval = interval.grown(noise);
        }
        // Rounded to nearest here; the hulls are rounded outwards at the end.
        let mut turns =
            Turns { least: f64::INFINITY, other: Interval::EMPTY, normal: Interval::EMPTY };
        for value in &along.values {
            let component = |k: usize| {
                let x = directions[k].dot(value.truncate());
                Interval { lo: x - boxes[k].hi, hi: x - boxes[k].lo }
            };
            let speed = component(which);
            let forward = speed.lo > 0.0; // false for NaN
            if !forward {
                return None;
            }
            turns.least = turns.least.min(speed.lo);
            let over_speed = |k: usize| over_positive_to_nearest(component(k), speed);
            turns.other = turns.other.union(over_speed(1 - which));
            turns.normal = turns.normal.union(over_speed(2));
        }
        // Three roundings, of both differences and of the quotient: wider by more than one each
        // time.
        let thrice = |interval: Interval| interval.outward().outward().outward();
        turns.least = Interval::point(turns.least).outward().lo;
        (turns.other, turns.normal) = (thrice(turns.other), thrice(turns.normal));
        (turns.least > 0.0).then_some(turns)
    }

    /// What the ranges of both tangents prove, each by itself; how they turn together may stay
    /// unknown. `dual` is as in [`PairTurns::new`], `lengths` are those of `a₀` and `b₀`.
    fn separately(&self, dual: &[DVec3; 3], lengths: [f64; 2]) -> Option<Turning> {
        let (a, b) = (self.turns(0, dual)?, self.turns(1, dual)?);
        // A step in `s` is judged by the turns of `b`, one in `t` by those of `a`.
        let [length_a, length_b] = lengths;
        let tilts = [
            [b.other.magnitude() * length_a / length_b, b.normal.magnitude() / length_b],
            [a.other.magnitude() * length_b / length_a, a.normal.magnitude() / length_a],
        ];
        let known =
            |[a, b]: [f64; 2]| if a.max(b) < MOST_TILT { [a, b] } else { [f64::INFINITY; 2] };
        let tilts = tilts.map(known);
        let m = Interval::point(1.0) - a.other * b.other;
        let independent = m.lo > 0.0; // false for NaN
        if !independent {
            return Some(Turning { tilts, ..Turning::UNKNOWN });
        }
        let over_m = |interval: Interval| over_positive_to_nearest(interval, m).outward();
        let g = over_m(b.normal - a.normal * b.other);
        let h = over_m(a.other * b.normal - a.normal);
        Some(Turning { across: [g, h], least: m.lo * a.least * b.least, tilts })
    }

    /// What is proved about `field`, whose derivatives these are, in the frame of `a₀` and `b₀`;
    /// `at_pole` says whether the field ends in a pole.
    fn bounds(&self, field: &Field, at_pole: bool, [a0, b0]: [DVec3; 2]) -> Option<TangentBounds> {
        let cross = a0.cross(b0);
        let area = cross.length();
        let regular = area > 0.0 && area.is_finite();
        if !regular {
            return None;
        }
        let normal = cross / area;
        let dual = [b0.cross(normal) / area, normal.cross(a0) / area, normal];

        let lengths = [a0.length(), b0.length()];
        let slopes = |known: &Turning| {
            [0, 1].map(|k| known.across[k] * Interval::point(lengths[k] / area).outward())
        };
        let width =
            |known: &Turning| MARGIN * slopes(known).map(Interval::radius).iter().sum::<f64>();
        let mut known = self.separately(&dual, lengths).unwrap_or(Turning::UNKNOWN);
        if self.polynomial && !at_pole && width(&known) > FAR {
            let net = (field.degree, &*field.values);
            if let Some(pairs) = PairTurns::new(net, self.noise, &dual) {
                // Both bound the same quotients, and the same determinant.
                known.across = [0, 1].map(|k| known.across[k].intersection(pairs.across[k]));
                known.least = known.least.max(pairs.least);
            }
        }
        let mut turning = slopes(&known);
        if at_pole {
            // The frame was swapped and mirrored, so it is not known which side is which.
            turning = turning.map(Interval::symmetric);
        }

        // How far from the root a point with a small residual may be.
        let determinant = (1.0 - 1.0 / MARGIN) * area * known.least;
        let longest = |which: usize| {
            let factor = self.factors[which].map_or(0.0, Field::length);
            self.along[which].length() + self.weight_slopes[which].magnitude() * factor
        };
        let (longest_s, longest_t) = (longest(0), longest(1));
        // `S_s = (X_s − (S − c) W_s) / W`; at a pole, its quotient by `t ≤ 1`.
        let [most_s, most_t] = self.longest.map(|longest| longest * self.weights.lo);
        if longest_s > most_s || longest_t > most_t {
            return None;
        }
        let (spread, pole_spread) = if at_pole {
            let ratio = self.weights.hi / self.weights.lo;
            // The points of the collapsed side agree only to a few roundings. The error that this
            // adds to the tangent along the side, the degree times as much, grows towards the pole
            // as the quotient by `t` does.
            let along_side = field.degree[0] as f64 * longest_t * longest_t * ratio / determinant;
            (longest_s * self.weights.hi / determinant, along_side)
        } else {
            (longest_s.max(longest_t) * self.weights.hi / determinant, 0.0)
        };
        let bounds = TangentBounds { turning, tilts: known.tilts, spread, pole_spread };
        let most = MARGIN * turning.map(Interval::magnitude).iter().sum::<f64>();
        (most <= MOST_TURNING && spread.is_finite()).then_some(bounds)
    }
}

/// Divides by an interval of positive numbers; the ends are only rounded to nearest.
#[inline(always)]
fn over_positive_to_nearest(interval: Interval, divisor: Interval) -> Interval {
    // The least quotient is that by the larger divisor where it is positive.
    let lo = interval.lo / if interval.lo > 0.0 { divisor.hi } else { divisor.lo };
    let hi = interval.hi / if interval.hi > 0.0 { divisor.lo } else { divisor.hi };
    Interval { lo, hi }
}

/// How both tangents turn over a leaf, in the frame of its axes.
struct Turning {
    /// `g` and `h` of [`Certificate`](crate::patch::Certificate).
    across: [Interval; 2],
    /// A lower bound of `|n·(ā × b̄)|` in units of `|a₀ × b₀|`.
    least: f64,
    /// As in [`TangentBounds`].
    tilts: [[f64; 2]; 2],
}

impl Turning {
    const UNKNOWN: Self = Self {
        across: [Interval { lo: f64::NEG_INFINITY, hi: f64::INFINITY }; 2],
        least: 0.0,
        tilts: [[f64::INFINITY; 2]; 2],
    };
}

/// How a tangent turns over a leaf.
struct Turns {
    /// The least component along its own chord, `a₀` or `b₀`.
    least: f64,
    /// The component along the other chord over that along its own.
    other: Interval,
    /// The component along the normal over that along its own chord.
    normal: Interval,
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;
    use std::ops::Range;
    use std::sync::Arc;

    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;
    use crate::math::testing::same_cases;
    use crate::patch::TensorPatch;
    use crate::patch::pieces::chart_net::ChartNet;

    /// A net: its degrees, its control points, and whether their weights differ.
    type NetCase = ([usize; 2], Vec<DVec4>, bool);

    /// Nets of gently bent patches; weights differ or do not.
    fn nets() -> impl Strategy<Value = NetCase> {
        let degrees = prop_oneof![Just((1, 1)), (1usize..=4, 1usize..=4)];
        nets_of(degrees, 0.3, 0.7..1.4)
    }

    /// Nets of these degrees, that are bumpy by so much, with weights in this range.
    fn nets_of(
        degrees: impl Strategy<Value = (usize, usize)>,
        bumps: f64,
        weights: Range<f64>,
    ) -> impl Strategy<Value = NetCase> {
        (degrees, any::<bool>()).prop_flat_map(move |((p, q), rational)| {
            let point = (-0.1..0.1f64, -0.1..0.1f64, -bumps..bumps, weights.clone());
            let points = prop::collection::vec(point, (p + 1) * (q + 1));
            points.prop_map(move |points| {
                let control = points.into_iter().enumerate().map(|(k, (x, y, z, w))| {
                    let (i, j) = (k / (q + 1), k % (q + 1));
                    let even = DVec3::new(i as f64 / p as f64, j as f64 / q as f64, 0.0);
                    let w = if rational { w } else { 0.8 };
                    (w * (even + DVec3::new(x, y, z))).extend(w)
                });
                ([p, q], control.collect(), rational)
            })
        })
    }

    /// The bounds of how a tangent turns hold at every place; those of bilinear patches are tight.
    #[test]
    fn tangents_turn_no_farther() {
        let [said, exact] = [Cell::new(0), Cell::new(0)];
        proptest!(same_cases(256), |((degree, control, rational) in nets())| {
            let (patch, _) = TensorPatch::new(&Arc::new(ChartNet::single(degree, &control)), [0, 0]);
            let noise = patch.noise();
            let net = Net { degree, control: &control, noise, rational, spacing: [1e-16; 2] };
            let field = net.recentered(net.middle());
            let (along_s, along_t) = (field.derivative_s(), field.derivative_t());
            let offsets = rational.then(|| field.offsets());
            let factors = [offsets.as_ref(); 2];
            let by_rule = Tangents::new(&net, &field, [&along_s, &along_t], factors).unwrap();
            let along = [0, 1].map(|which| field.quotients_slope(which));
            let multiplied = Tangents::of_quotient(&net, &field, &along).unwrap();
            let directions = [DVec3::X, DVec3::Y, DVec3::Z];
            let heaviest = control.iter().map(|point| point.w).fold(0.0, f64::max);
            for (which, power) in [(0, 1), (1, 1), (0, 2), (1, 2)] {
                let tangents = if power == 1 { &by_rule } else { &multiplied };
                let Some(turns) = tangents.turns(which, &directions) else { continue };
                let heaviest = heaviest.powi(power);
                said.set(said.get() + 1);
                let mut seen = [Interval::EMPTY; 2];
                for k in 0..11 * 11 {
                    let st = DVec2::new(f64::from(k % 11), f64::from(k / 11)) / 10.0;
                    let jet = patch.jet(st);
                    let tangent = [jet.ds, jet.dt][which];
                    prop_assert!(turns.least <= heaviest * tangent[which], "at {st}");
                    let other = tangent[1 - which] / tangent[which];
                    let normal = tangent.z / tangent[which];
                    for (seen, (told, x)) in
                        seen.iter_mut().zip([(turns.other, other), (turns.normal, normal)])
                    {
                        prop_assert!(told.lo <= x && x <= told.hi, "{x} at {st}, not in {told:?}");
                        *seen = seen.union(Interval::point(x));
                    }
                }
                if degree == [1, 1] && !rational {
                    // The tangents themselves are the coefficients.
                    exact.set(exact.get() + 1);
                    for (seen, told) in seen.iter().zip([turns.other, turns.normal]) {
                        prop_assert!((seen.lo - told.lo).abs() + (seen.hi - told.hi).abs() < 1e-10);
                    }
                }
            }
        });
        let (said, exact) = (said.get(), exact.get());
        assert!(said > 100 && exact > 10, "{said} tangents, {exact} of bilinear patches");
    }

    /// No line through two points of a piece is certified to meet it at most once, whatever the
    /// frame; and some nearly are.
    #[test]
    fn chords_are_flat() {
        let (asked, nearest) = asked_about_chords(256, nets());
        assert!(asked > 1000 && nearest < 1.6, "{asked} chords, one to {nearest}");
    }

    /// Nor of pieces of high degrees, with weights that differ a little or by far.
    #[test]
    fn chords_of_high_degrees_are_flat() {
        let degrees = || prop_oneof![Just((5, 5)), Just((7, 3)), Just((2, 12)), Just((9, 9))];
        for (bumps, weights) in [(0.02, 0.7..1.4), (0.05, 0.1..10.0), (0.1, 0.9..1.1)] {
            let (asked, _) = asked_about_chords(64, nets_of(degrees(), bumps, weights.clone()));
            assert!(asked > 200, "{bumps} {weights:?}: {asked} chords");
        }
    }

    /// Of so many nets, how many chords were looked at, and the least ratio of what a certificate
    /// needs and what it has.
    fn asked_about_chords(cases: u32, nets: impl Strategy<Value = NetCase>) -> (usize, f64) {
        let place = || (0.0..=1.0f64, 0.0..=1.0f64).prop_map(|(s, t)| DVec2::new(s, t));
        let pairs = prop::collection::vec((place(), place()), 60);
        let shears = [-0.4..0.4f64, -0.4..0.4f64];
        let (asked, nearest) = (Cell::new(0), Cell::new(f64::INFINITY));
        proptest!(same_cases(cases), |((degree, control, rational) in nets, pairs in pairs, shears in shears)| {
            let (patch, _) = TensorPatch::new(&Arc::new(ChartNet::single(degree, &control)), [0, 0]);
            let noise = patch.noise();
            let net = Net { degree, control: &control, noise, rational, spacing: [1e-16; 2] };
            let [a, b] = patch.chords([[0.0, 1.0]; 2]);
            let axes = Axes::along([a + shears[0] * b, b + shears[1] * a]);
            let Some(bounds) = TangentBounds::new(&net, None, &axes) else { return Ok(()) };
            for (from, to) in pairs {
                let chord = patch.point(to) - patch.point(from);
                if chord.length() < 1e-6 {
                    continue;
                }
                let [steep, reach] = steep_and_allowed(&bounds, &axes, chord);
                prop_assert!(steep <= reach, "{from} to {to}: {steep} over {reach}");
                nearest.set(nearest.get().min(reach / steep));
                asked.set(asked.get() + 1);
            }
        });
        (asked.get(), nearest.get())
    }

    /// How steep a chord is, and how steep a ray must be to be certified.
    fn steep_and_allowed(bounds: &TangentBounds, axes: &Axes, chord: DVec3) -> [f64; 2] {
        let [a, b, _] = axes.axes;
        let normal = a.cross(b).normalize();
        let across = [a, b].map(|v| v.cross(normal).normalize());
        let [mut reach, mut steep] = [0.0, normal.dot(chord)];
        for k in 0..2 {
            let Interval { lo, hi } = bounds.turning[k];
            let x = chord.dot(across[k]);
            steep += 0.5 * (lo + hi) * x;
            reach += MARGIN * 0.5 * (hi - lo) * x.abs();
        }
        [steep.abs(), reach]
    }

    /// The same for pieces that end in a pole, at any of their sides, in frames from which all of
    /// their tangents lean to one side.
    #[test]
    fn chords_beside_poles_are_flat_in_leaning_frames() {
        // From near the pole to the other end.
        let place = || (0.0..=1.0f64, 0.1..=1.0f64);
        let pairs = prop::collection::vec((place(), place()), 20);
        let tilts = [-0.5..0.5f64, -0.5..0.5f64];
        let asked = Cell::new([0; 4]);
        proptest!(same_cases(256), |((degree, control, rational) in nets(), side in 0usize..4, pairs in pairs, tilts in tilts)| {
            let at_side = RectSide::ALL[side];
            let (fixed, end) = (at_side.fixed() as usize, at_side.end());
            let columns = degree[1] + 1;
            let pole = at_side.fixed().pair(end as f64, 0.5);
            let pole = DVec3::new(pole[0], pole[1], 0.0);
            let fan = control.iter().enumerate().map(|(k, c)| {
                let at = [k / columns, k % columns];
                if at[fixed] == end * degree[fixed] { (c.w * pole).extend(c.w) } else { *c }
            });
            let control: Vec<DVec4> = fan.collect();
            let (patch, _) = TensorPatch::new(&Arc::new(ChartNet::single(degree, &control)), [0, 0]);
            let noise = patch.noise();
            let net = Net { degree, control: &control, noise, rational, spacing: [1e-16; 2] };
            let [a, b] = patch.chords([[0.0, 1.0]; 2]);
            let normal = a.cross(b).normalize();
            let axes = Axes::along([a + tilts[0] * normal, b + tilts[1] * normal]);
            let bounds = TangentBounds::new(&net, Some(at_side), &axes);
            let Some(bounds) = bounds else { return Ok(()) };
            for pair in pairs {
                let at = |(along, away): (f64, f64)| {
                    let away = if at_side.is_last() { 1.0 - away } else { away };
                    patch.point(at_side.fixed().pair(away, along).into())
                };
                let chord = at(pair.1) - at(pair.0);
                if chord.length() < 1e-3 {
                    continue;
                }
                let [steep, reach] = steep_and_allowed(&bounds, &axes, chord);
                prop_assert!(steep <= reach, "{pair:?} beside {at_side:?}: {steep} over {reach}");
                let mut count = asked.get();
                count[side] += 1;
                asked.set(count);
            }
        });
        let asked = asked.get();
        assert!(asked.iter().all(|asked| *asked > 200), "{asked:?}");
    }
}
