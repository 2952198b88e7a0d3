//! The proof that a ray meets a leaf at most once.

use glam::{DVec3, DVec4};

use super::oriented_box::Axes;
use super::tensor::euclidean;
use super::up16::Up16;
use super::{ControlNet, LEAF_SLACK, OrientedBox};
use crate::math::Interval;

/// A promise about all rays that are steep enough: each meets the leaf, widened on all
/// sides, at most once; and how far the leaf's tangents turn.
///
/// # What is bounded
/// Write the piece over the convex parameter rectangle `D` as `S = c + X / W`, where the
/// Bernstein coefficients of `X` are `w_ij (P_ij − c)` and those of `W` are `w_ij > 0`.
/// By the quotient rule `S_s = a / W` with `a = X_s − (S − c) W_s`, and `S_t = b / W`
/// likewise. On `D` every component of `X_s` lies between the smallest and the largest
/// of its Bernstein coefficients, and so does `W_s`; `S − c` lies in the hull of the
/// `P_ij − c`. Interval arithmetic, rounded outwards and widened by the rounding error of
/// the coefficients, gives a box around every coefficient of `a` and of `b`, in the frame
/// `(a₀, b₀, n)` of the leaf's chords and its normal: `a = α₁ a₀ + α₂ b₀ + α₃ n`, `b = β₁ a₀ + β₂ b₀ + β₃ n`. With
/// `α₁ > 0` in all of these boxes the quotients `α₂/α₁` and `α₃/α₁` of sums of members are
/// weighted means of those of the members, and `b` likewise: intervals around the quotients
/// of the coefficients hold those of the means of `a` and of `b` over any set.
///
/// # What is concluded
/// Let a ray with unit direction `d` meet `S` at two points `x ≠ y` of `D`, and let `F` be
/// the two distances from a pair of perpendicular planes through the ray. Then
/// `0 = F(y) − F(x) = J̄ (y − x)`, where `J̄` is the mean of the Jacobian along the segment
/// from `x` to `y`: its columns are the projections of `∫ a/W` and `∫ b/W`, which are
/// positive multiples `λā`, `μb̄` of means of `a` and `b`, and `det J̄ = ± λμ d·(ā × b̄)`.
/// With `ā = α₁ (a₀ + ρ₂ b₀ + ρ₃ n)` and `b̄ = β₂ (σ₁ a₀ + b₀ + σ₃ n)`
///
/// `|d·(ā × b̄)| ≥ α₁ β₂ (|d·(a₀ × b₀)| m − |d·(a₀ × n)| e₁ − |d·(b₀ × n)| e₂)`,
///
/// `m = min(1 − ρ₂σ₁)`, `e₁ = max|σ₃ − ρ₃σ₁|`, `e₂ = max|ρ₂σ₃ − ρ₃|`. This is positive,
/// hence `x = y`, whenever `|n·d| > |A·d| + |B·d|` with `A = (a₀ × n) e₁ / (|a₀ × b₀| m)` and
/// `B = (b₀ × n) e₂ / (|a₀ × b₀| m)`: three dot products. Splitting off the parts along `a₀`
/// and `b₀`, and the lengths, matters: the speed of the parametrisation does no harm, only
/// the turning of the tangents does; and a ray may be the flatter the less the leaf turns
/// in the direction it comes from.
///
/// # How a miss is proved
/// Let `x` lie in `D` beyond all points `y` of the leaf in `s`, so that `y − x` has a first
/// component of known sign, and let the ray be certified. If it met the leaf at `y`,
/// `−F(x) = λā (y − x)₁ + μb̄ (y − x)₂` would make the sign of the cross product `F(x) × b̄`
/// known: opposite to what it is where Newton's step from `x` leads away from the leaf. And
/// for all `b̄` it has the sign it has for `b₀`, if `|F × b₀| > |σ₁| |F × a₀| + |σ₃| |F × n|`
/// with the largest `|σ₁|` and `|σ₃|`. The same holds for `t`, with `ρ₂` and `ρ₃`.
///
/// At a side that is collapsed to a point `c`, say `t = 0`, `X = t X̃` and
/// `S_s = t (X̃_s − (X̃/W) W_s) / W`: the bracket takes the place of `a`, and positive
/// multiples keep the argument. So poles are certified too, but for the pole itself.
///
/// # What rounding costs
/// `A` and `B` are taken with 2 % to spare, so that with `θ` the angle between `d` and `n`
/// `|d·(ā × b̄)| ≥ 0.019 cos θ α₁ β₂ |a₀ × b₀| m`. A computed point `x` of `D` with `|F(x)| ≤ ε` is then within `ε·spread/cos θ` of the
/// root, if there is one, in each parameter, measured in sides of the leaf: the leaf's
/// owner compares that with the slack it allows itself.
///
/// # What is kept
/// `a₀`, `b₀` and `n` are the axes of the leaf's [`OrientedBox`], so `n·d`, `A·d` and `B·d` are,
/// but for factors, what the rows of the box say of a direction anyway: its *slopes*. The
/// factors are kept in units of the third slope, in sixteen bits, rounded up: every condition
/// becomes a little harder to meet, by less than 1 %. Rows in f32 are off by 2⁻²⁴ of their
/// length; that, and six roundings of f32 of each of the three slopes, are covered by
/// what `turning` returns last.
#[derive(Clone, Copy, Debug)]
pub struct Certificate {
    /// A ray with slopes `a, b, c` meets the widened leaf at most once where
    /// `|c| > turning₀ |a| + turning₁ |b| + rounding`.
    turning: [Up16; 2],
    rounding: Up16,
    /// A computed point with a residual of at most `ε` is well within the leaf's slack of the
    /// root where also `|c| ≥ ε steep_per_error`.
    steep_per_error: Up16,
    /// For a step in `s`, then in `t`: how much of the other tangent, and of the normal, may
    /// have to be added to `b₀`, or `a₀`, for those of the unit vectors.
    bend: [[Up16; 2]; 2],
    /// In a leaf that ends in a pole: `|c| ρ ≥ ε pole_per_error` is needed, too, for a ray at
    /// the distance `ρ` from the pole. Zero for other leaves.
    pole_per_error: Up16,
}

/// What is proved of a leaf: see [`Certificate`].
struct Proof {
    /// The lengths of `A` and `B`.
    turning: [f64; 2],
    bend: [[f64; 2]; 2],
    spread: f64,
    /// At a pole: the parameter along the collapsed side errs by at most
    /// `ε·spread / (ρ·cos θ)` sides of the leaf.
    pole_spread: f64,
}

/// Which side of a leaf's rectangle is collapsed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CollapsedSide {
    /// `s` is constant: 0 or 1 tells which end.
    S(usize),
    /// `t` is constant: 0 or 1 tells which end.
    T(usize),
}

/// Leaves whose tangents are bounded with this factor to spare.
const MARGIN: f64 = 1.02;

/// `|A| + |B|` of a certificate is no more than this: a leaf that turns so far is as good as
/// uncertified, and what rounding does to `A·d` and `B·d` grows with their lengths.
const MOST_TURNING: f64 = 4.0;

/// More than what rounding to f32 does to the sum of three slopes, in units of the third row's
/// length: eight roundings of 2⁻²⁴ of each, of rows whose lengths add up to no more than five.
const ROUNDING: f64 = 2.5e-6;

/// Bends beyond it prove nothing: what f32 has done to the axes may matter then.
const MOST_BEND: f64 = 1e3;

impl Certificate {
    /// The certificate of the net over the widened rectangle, for rays measured by the leaf's
    /// box. It holds for no ray when the tangents turn too far, or nothing can be said.
    pub(super) fn new(
        net: &Net<'_>,
        collapsed: Option<CollapsedSide>,
        axes: &Axes,
        oriented: &OrientedBox,
    ) -> Self {
        let lengths = oriented.directions().map(DVec3::length);
        let Some(proof) = Proof::new(net, collapsed, axes) else { return Self::none(collapsed) };
        // `A` is perpendicular to `a₀`, as is the second row; `B` and `b₀` likewise.
        let [a, b] = [0, 1].map(|k| proof.turning[1 - k] * lengths[2] / lengths[k]);
        // Both with a little more than the rounding of the products to f32 on the way.
        let slack = 0.5 * LEAF_SLACK * 0.999;
        Self {
            turning: [Up16::above(a), Up16::above(b)],
            rounding: Up16::above(ROUNDING * lengths[2]),
            steep_per_error: Up16::above(proof.spread * lengths[2] / slack),
            bend: proof.bend.map(|bend| bend.map(Up16::above)),
            pole_per_error: Up16::above(proof.pole_spread * lengths[2] / slack),
        }
    }

    /// No ray is certified.
    fn none(collapsed: Option<CollapsedSide>) -> Self {
        let never = Up16::above(f64::INFINITY);
        let pole_per_error = if collapsed.is_some() { never } else { Up16::above(0.0) };
        Self {
            turning: [never; 2],
            rounding: never,
            steep_per_error: never,
            bend: [[never; 2]; 2],
            pole_per_error,
        }
    }

    /// Whether a ray with these slopes meets the widened leaf at most once.
    pub fn holds(&self, [a, b, c]: [f64; 3]) -> bool {
        let [by_a, by_b] = self.turning.map(|turning| f64::from(turning.value()));
        c.abs() > by_a * a.abs() + by_b * b.abs() + f64::from(self.rounding.value())
    }

    /// The factors of the first two slopes, and what is added for rounding.
    #[inline(always)]
    pub fn turning(&self) -> [f32; 3] {
        [self.turning[0].value(), self.turning[1].value(), self.rounding.value()]
    }

    /// The third slope needed for an error of one scene unit.
    #[inline(always)]
    pub fn steep_per_error(&self) -> f32 {
        self.steep_per_error.value()
    }

    /// The same, times the distance from the pole; zero for leaves without one.
    #[inline(always)]
    pub fn pole_per_error(&self) -> f32 {
        self.pole_per_error.value()
    }

    /// How much of the other tangent and of the normal is to be reckoned with, for a step in
    /// `s`, then in `t`.
    #[inline(always)]
    pub fn bend(&self) -> [[f64; 2]; 2] {
        self.bend.map(|bend| bend.map(|bend| f64::from(bend.value())))
    }
}

impl Proof {
    fn new(net: &Net<'_>, collapsed: Option<CollapsedSide>, axes: &Axes) -> Option<Self> {
        let [a, b, _] = axes.axes;
        match collapsed {
            None => Tangents::regular(net, net.middle())?.proof(None, [a, b]),
            Some(side) => {
                // A net whose collapsed side is `t = 0`: swap and mirror until it is.
                let (degree, control) = net.with_collapsed_first(side);
                let [in_s, in_t] = net.spacing;
                let spacing = match side {
                    CollapsedSide::T(_) => [in_s, in_t],
                    CollapsedSide::S(_) => [in_t, in_s],
                };
                let net = Net { degree, control: &control, spacing, ..*net };
                let pole = euclidean(net.control[0]);
                let tangents = Tangents::at_pole(&net, pole)?;
                match side {
                    CollapsedSide::T(0) => tangents.proof(Some(pole), [a, b]),
                    CollapsedSide::T(_) => tangents.proof(Some(pole), [a, -b]),
                    CollapsedSide::S(end) => {
                        let a = if end == 0 { a } else { -a };
                        let mut proof = tangents.proof(Some(pole), [b, a])?;
                        proof.turning.reverse();
                        proof.bend.reverse();
                        Some(proof)
                    }
                }
            }
        }
    }
}

/// The homogeneous control net over a leaf's widened rectangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Net<'a> {
    pub(super) degree: [usize; 2],
    pub(super) control: &'a [DVec4],
    /// How far a control point may be from the true one, in scene units.
    pub(super) noise: f64,
    /// Whether the weights differ.
    pub(super) rational: bool,
    /// What rounding moves the parameters by, as parts of the net's sides.
    pub(super) spacing: [f64; 2],
}

impl Net<'_> {
    fn middle(&self) -> DVec3 {
        euclidean(self.control[self.control.len() / 2])
    }

    /// The net turned so that the collapsed side becomes `t = 0`.
    fn with_collapsed_first(&self, side: CollapsedSide) -> ([usize; 2], ControlNet) {
        let [p, q] = self.degree;
        let at = |i: usize, j: usize| self.control[i * (q + 1) + j];
        let turned = |rows: usize, columns: usize, pick: &dyn Fn(usize, usize) -> DVec4| {
            (0..=rows)
                .flat_map(|i| (0..=columns).map(move |j| (i, j)))
                .map(|(i, j)| pick(i, j))
                .collect()
        };
        match side {
            CollapsedSide::T(0) => ([p, q], self.control.into()),
            CollapsedSide::T(_) => ([p, q], turned(p, q, &|i, j| at(i, q - j))),
            CollapsedSide::S(0) => ([q, p], turned(q, p, &|i, j| at(j, i))),
            CollapsedSide::S(_) => ([q, p], turned(q, p, &|i, j| at(p - j, i))),
        }
    }
}

/// Bernstein coefficients of three components and a weight on a rectangle.
struct Field {
    degree: [usize; 2],
    values: ControlNet,
}

impl Field {
    fn derivative_s(&self) -> Self {
        let [p, q] = self.degree;
        let mut values = ControlNet::with_capacity(p * (q + 1));
        for (here, after) in self.values.iter().zip(&self.values[q + 1..]) {
            values.push((*after - *here) * p as f64);
        }
        Self { degree: [p - 1, q], values }
    }

    fn derivative_t(&self) -> Self {
        let [p, q] = self.degree;
        let mut values = ControlNet::with_capacity((p + 1) * q);
        for row in self.values.chunks_exact(q + 1) {
            for (here, after) in row.iter().zip(&row[1..]) {
                values.push((*after - *here) * q as f64);
            }
        }
        Self { degree: [p, q - 1], values }
    }

    /// The quotient by `t`; the first coefficient of each row is taken for zero.
    fn over_t(&self) -> Self {
        let [p, q] = self.degree;
        let pairs = (0..=p).flat_map(|i| (0..q).map(move |j| (i, j)));
        let factor = |j: usize| q as f64 / (j + 1) as f64;
        let values = pairs.map(|(i, j)| self.values[i * (q + 1) + j + 1] * factor(j));
        Self { degree: [p, q - 1], values: values.collect() }
    }

    fn weights(&self) -> Interval {
        Interval::hull(self.values.iter().map(|value| value.w))
    }

    /// The range of the component along a direction.
    fn component(&self, direction: DVec3) -> Interval {
        Interval::hull(self.values.iter().map(|value| direction.dot(value.truncate())))
    }

    fn length(&self) -> f64 {
        self.values.iter().map(|value| value.truncate().length_squared()).fold(0.0, f64::max).sqrt()
    }
}

/// `X_s − Y W_s` and `X_t − Z W_t`, everything the boxes of `a` and `b` are made of.
struct Tangents {
    along_s: Field,
    along_t: Field,
    /// What is multiplied with `W_s`: `S − c`, or `X̃ / W` at a pole; nothing where `W` is
    /// constant.
    factor_s: Option<Field>,
    factor_t: Option<Field>,
    /// Range of the weights by which each factor is divided; one where it is a point.
    weights: Interval,
    weight_slopes: [Interval; 2],
    noise: f64,
    /// The longest tangents for which rounding of the parameters is small against the noise.
    longest: [f64; 2],
}

impl Tangents {
    fn regular(net: &Net<'_>, center: DVec3) -> Option<Self> {
        let field = recentred(net, center);
        let weights = field.weights();
        let positive = weights.lo > 0.0; // false for NaN
        if !positive {
            return None;
        }
        let (along_s, along_t) = (field.derivative_s(), field.derivative_t());
        let noise = net.noise * weights.hi;
        let longest = net.spacing.map(|spacing| 0.25 * net.noise / spacing);
        if !net.rational {
            // The differences of equal weights are rounding, and part of the noise.
            let weight_slopes = [Interval::point(0.0); 2];
            let (factor_s, factor_t) = (None, None);
            return Some(Self {
                along_s,
                along_t,
                factor_s,
                factor_t,
                weights,
                weight_slopes,
                noise,
                longest,
            });
        }
        let weight_slopes = [along_s.weights(), along_t.weights()];
        let offsets = || {
            let values = field.values.iter().map(|x| (x.truncate() / x.w).extend(1.0)).collect();
            Some(Field { degree: field.degree, values })
        };
        let (factor_s, factor_t) = (offsets(), offsets());
        Some(Self { along_s, along_t, factor_s, factor_t, weights, weight_slopes, noise, longest })
    }

    fn at_pole(net: &Net<'_>, pole: DVec3) -> Option<Self> {
        let mut tangents = Self::regular(net, pole)?;
        let over_t = recentred(net, pole).over_t();
        tangents.along_s = over_t.derivative_s();
        tangents.noise *= net.degree[1] as f64;
        if !net.rational {
            return Some(tangents);
        }
        let lowest = tangents.weights.lo;
        let scaled = over_t.values.iter().map(|x| (x.truncate() / lowest).extend(1.0));
        // X̃ / W lies between 0 and the hull of X̃ / min W, component by component.
        let values = scaled.chain([DVec4::ZERO]).collect();
        tangents.factor_s = Some(Field { degree: over_t.degree, values });
        Some(tangents)
    }

    /// How one tangent turns: `which` of the directions' components it is measured by, and the
    /// ranges of the quotients of the other two by it. `None` if that one may vanish.
    fn turns(&self, which: usize, directions: &[DVec3; 3]) -> Option<Turns> {
        let (along, factor) = match which {
            0 => (&self.along_s, &self.factor_s),
            _ => (&self.along_t, &self.factor_t),
        };
        let degree = along.degree[which] as f64 + 1.0;
        let boxes = directions.map(|direction| {
            let noise = 4.0 * degree * self.noise * direction.length();
            let product = factor.as_ref().map_or(Interval::point(0.0), |factor| {
                factor.component(direction) * self.weight_slopes[which]
            });
            product.grown(noise)
        });
        let mut turns =
            Turns { least: f64::INFINITY, other: Interval::EMPTY, normal: Interval::EMPTY };
        for value in &along.values {
            let component =
                |k: usize| Interval::point(directions[k].dot(value.truncate())) - boxes[k];
            let speed = component(which);
            let forward = speed.lo > 0.0; // false for NaN
            if !forward {
                return None;
            }
            turns.least = turns.least.min(speed.lo);
            turns.other = turns.other.union(component(1 - which).over_positive(speed));
            turns.normal = turns.normal.union(component(2).over_positive(speed));
        }
        Some(turns)
    }

    /// What is proved in the frame of `a₀` and `b₀`.
    fn proof(&self, pole: Option<DVec3>, [a0, b0]: [DVec3; 2]) -> Option<Proof> {
        let cross = a0.cross(b0);
        let area = cross.length();
        let regular = area > 0.0 && area.is_finite();
        if !regular {
            return None;
        }
        let normal = cross / area;
        let dual = [b0.cross(normal) / area, normal.cross(a0) / area, normal];

        let (a, b) = (self.turns(0, &dual)?, self.turns(1, &dual)?);
        let m = (Interval::point(1.0) - a.other * b.other).lo;
        let independent = m > 0.0; // false for NaN
        if !independent {
            return None;
        }
        let e1 = (b.normal - a.normal * b.other).magnitude();
        let e2 = (a.other * b.normal - a.normal).magnitude();
        let (length_a, length_b) = (a0.length(), b0.length());
        let turning = [length_a * e1, length_b * e2].map(|v| v * MARGIN / (area * m));
        // A step in `s` is judged by the turns of `b`, one in `t` by those of `a`.
        let bend = [
            [b.other.magnitude() * length_a / length_b, b.normal.magnitude() / length_b],
            [a.other.magnitude() * length_b / length_a, a.normal.magnitude() / length_a],
        ];
        let bend = bend
            .map(|bend| if bend[0].max(bend[1]) < MOST_BEND { bend } else { [f64::INFINITY; 2] });

        // How far from the root a point with a small residual may be.
        let determinant = (1.0 - 1.0 / MARGIN) * area * m * a.least * b.least;
        let more = |which: usize, factor: &Option<Field>| {
            let length = factor.as_ref().map_or(0.0, Field::length);
            self.weight_slopes[which].magnitude() * length
        };
        let longest_s = self.along_s.length() + more(0, &self.factor_s);
        let longest_t = self.along_t.length() + more(1, &self.factor_t);
        // `S_s = (X_s − (S − c) W_s) / W`; at a pole its quotient by `t`, which is one at most.
        let [most_s, most_t] = self.longest.map(|longest| longest * self.weights.lo);
        if longest_s > most_s || longest_t > most_t {
            return None;
        }
        let spread = match pole {
            None => longest_s.max(longest_t) * self.weights.hi / determinant,
            Some(_) => longest_s * self.weights.hi / determinant,
        };
        let pole_spread = pole.map_or(0.0, |_| {
            let ratio = self.weights.hi / self.weights.lo;
            longest_t * longest_t * ratio / determinant
        });
        let proof = Proof { turning, bend, spread, pole_spread };
        (turning[0] + turning[1] <= MOST_TURNING && spread.is_finite()).then_some(proof)
    }
}

/// How a tangent turns over a leaf.
struct Turns {
    /// The least component along its mean, which is one there.
    least: f64,
    /// The component along the other tangent's mean over that.
    other: Interval,
    /// The component along the normal over that.
    normal: Interval,
}

/// The coefficients `(w (P − c), w)`.
fn recentred(net: &Net<'_>, center: DVec3) -> Field {
    let values = net.control.iter().map(|c| (c.truncate() - c.w * center).extend(c.w)).collect();
    Field { degree: net.degree, values }
}
