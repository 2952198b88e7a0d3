//! The proof that a ray meets a leaf at most once.

use glam::{DVec3, DVec4};

use super::ControlNet;
use super::tensor::euclidean;
use crate::math::{Interval, rounding};

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
/// `(a₀, b₀, n)` of their means: `a = α₁ a₀ + α₂ b₀ + α₃ n`, `b = β₁ a₀ + β₂ b₀ + β₃ n`. With
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
#[derive(Clone, Copy, Debug)]
pub struct Certificate {
    /// The unit normal `n`.
    pub normal: DVec3,
    /// `A` and `B`: a ray with `|n·d| > |A·d| + |B·d|` meets the widened leaf at most once.
    pub turning: [DVec3; 2],
    /// Unit vectors along `a₀` and `b₀`.
    pub tangents: [DVec3; 2],
    /// For a step in `s`, then in `t`: how much of the other tangent, and of the normal, may
    /// have to be added to `b₀`, or `a₀`, for those of the unit vectors.
    pub bend: [[f64; 2]; 2],
    /// See above; per unit of distance.
    pub spread: f64,
    /// At a collapsed side: where it is, and the spread times the distance from it.
    pub pole: Option<Pole>,
}

/// A side of a leaf that is collapsed to a point.
#[derive(Clone, Copy, Debug)]
pub struct Pole {
    /// The point.
    pub point: DVec3,
    /// The parameter along the side errs by at most `ε·spread / (distance·cos θ)` sides
    /// of the leaf, where `distance` is that of the ray from the point.
    pub spread: f64,
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

impl Certificate {
    /// No ray is certified.
    pub(super) fn none(normal: DVec3) -> Self {
        Self {
            normal,
            turning: [DVec3::ZERO; 2],
            tangents: [DVec3::ZERO; 2],
            bend: [[f64::INFINITY; 2]; 2],
            spread: f64::INFINITY,
            pole: None,
        }
    }

    /// Whether a ray of this unit direction meets the widened leaf at most once.
    pub fn holds(&self, direction: DVec3) -> bool {
        let [a, b] = self.turning.map(|turning| turning.dot(direction).abs());
        // Six roundings of each of the three, whose lengths add up to no more than five.
        let rounding = 30.0 * rounding::UNIT_ROUNDOFF;
        self.spread.is_finite() && self.normal.dot(direction).abs() > a + b + rounding
    }

    /// The certificate of the net over the widened rectangle; `None` when the tangents
    /// turn too far, or nothing can be said.
    pub(super) fn new(net: &Net<'_>, collapsed: Option<CollapsedSide>) -> Option<Self> {
        match collapsed {
            None => {
                let tangents = Tangents::regular(net, net.middle())?;
                tangents.certificate(None)
            }
            Some(side) => {
                // A net whose collapsed side is `t = 0`: swap and mirror until it is.
                let turned = net.with_collapsed_first(side);
                let net = Net { degree: turned.0, control: &turned.1, ..*net };
                let pole = euclidean(net.control[0]);
                let mut certificate = Tangents::at_pole(&net, pole)?.certificate(Some(pole))?;
                if turned.2 {
                    certificate.normal = -certificate.normal;
                }
                if let CollapsedSide::S(_) = side {
                    certificate.tangents.reverse();
                    certificate.bend.reverse();
                }
                Some(certificate)
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
    /// What rounding moves a parameter by, as a part of the net's side.
    pub(super) spacing: f64,
}

impl Net<'_> {
    fn middle(&self) -> DVec3 {
        euclidean(self.control[self.control.len() / 2])
    }

    /// The net turned so that the collapsed side becomes `t = 0`, and whether that
    /// flipped its orientation.
    fn with_collapsed_first(&self, side: CollapsedSide) -> ([usize; 2], ControlNet, bool) {
        let [p, q] = self.degree;
        let at = |i: usize, j: usize| self.control[i * (q + 1) + j];
        let turned = |rows: usize, columns: usize, pick: &dyn Fn(usize, usize) -> DVec4| {
            (0..=rows)
                .flat_map(|i| (0..=columns).map(move |j| (i, j)))
                .map(|(i, j)| pick(i, j))
                .collect()
        };
        match side {
            CollapsedSide::T(0) => ([p, q], self.control.into(), false),
            CollapsedSide::T(_) => ([p, q], turned(p, q, &|i, j| at(i, q - j)), true),
            CollapsedSide::S(0) => ([q, p], turned(q, p, &|i, j| at(j, i)), true),
            CollapsedSide::S(_) => ([q, p], turned(q, p, &|i, j| at(p - j, i)), false),
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
        let values = (0..p * (q + 1)).map(|k| (self.values[k + q + 1] - self.values[k]) * p as f64);
        Self { degree: [p - 1, q], values: values.collect() }
    }

    fn derivative_t(&self) -> Self {
        let [p, q] = self.degree;
        let pairs = (0..=p).flat_map(|i| (0..q).map(move |j| i * (q + 1) + j));
        let values = pairs.map(|k| (self.values[k + 1] - self.values[k]) * q as f64);
        Self { degree: [p, q - 1], values: values.collect() }
    }

    /// The quotient by `t`; the first coefficient of each row is taken for zero.
    fn over_t(&self) -> Self {
        let [p, q] = self.degree;
        let pairs = (0..=p).flat_map(|i| (0..q).map(move |j| (i, j)));
        let factor = |j: usize| q as f64 / (j + 1) as f64;
        let values = pairs.map(|(i, j)| self.values[i * (q + 1) + j + 1] * factor(j));
        Self { degree: [p, q - 1], values: values.collect() }
    }

    fn mean(&self) -> DVec4 {
        self.values.iter().sum::<DVec4>() / self.values.len() as f64
    }

    fn weights(&self) -> Interval {
        Interval::hull(self.values.iter().map(|value| value.w))
    }

    /// The range of the component along a direction.
    fn component(&self, direction: DVec3) -> Interval {
        Interval::hull(self.values.iter().map(|value| direction.dot(value.truncate())))
    }

    fn length(&self) -> f64 {
        self.values.iter().map(|value| value.truncate().length()).fold(0.0, f64::max)
    }
}

/// `X_s − Y W_s` and `X_t − Z W_t`, everything the boxes of `a` and `b` are made of.
struct Tangents {
    along_s: Field,
    along_t: Field,
    /// What is multiplied with `W_s`: `S − c`, or `X̃ / W` at a pole.
    factor_s: Field,
    factor_t: Field,
    /// Range of the weights by which each factor is divided; one where it is a point.
    weights: Interval,
    weight_slopes: [Interval; 2],
    noise: f64,
    /// The longest tangent for which rounding of a parameter is small against the noise.
    longest: f64,
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
        let weight_slopes = [along_s.weights(), along_t.weights()];
        let offsets = || Field {
            degree: field.degree,
            values: field.values.iter().map(|x| (x.truncate() / x.w).extend(1.0)).collect(),
        };
        let (factor_s, factor_t) = (offsets(), offsets());
        let noise = net.noise * weights.hi;
        let longest = 0.0625 * net.noise / net.spacing;
        Some(Self { along_s, along_t, factor_s, factor_t, weights, weight_slopes, noise, longest })
    }

    fn at_pole(net: &Net<'_>, pole: DVec3) -> Option<Self> {
        let mut tangents = Self::regular(net, pole)?;
        let over_t = recentred(net, pole).over_t();
        let weight_slope = tangents.weight_slopes[0];
        tangents.along_s = over_t.derivative_s();
        let lowest = tangents.weights.lo;
        let scaled = over_t.values.iter().map(|x| (x.truncate() / lowest).extend(1.0));
        // X̃ / W lies between 0 and the hull of X̃ / min W, component by component.
        let values = scaled.chain([DVec4::ZERO]).collect();
        tangents.factor_s = Field { degree: over_t.degree, values };
        tangents.weight_slopes[0] = weight_slope;
        tangents.noise *= net.degree[1] as f64;
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
            (factor.component(direction) * self.weight_slopes[which]).grown(noise)
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

    fn certificate(&self, pole: Option<DVec3>) -> Option<Certificate> {
        // The frame: means of both tangents, their dual basis, the normal.
        let mean = |along: &Field, factor: &Field, slopes: Interval| {
            let slope = 0.5 * (slopes.lo + slopes.hi);
            along.mean().truncate() - slope * factor.mean().truncate()
        };
        let a0 = mean(&self.along_s, &self.factor_s, self.weight_slopes[0]);
        let b0 = mean(&self.along_t, &self.factor_t, self.weight_slopes[1]);
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
        let turning =
            [a0.cross(normal) * e1, b0.cross(normal) * e2].map(|v| v * MARGIN / (area * m));
        // A step in `s` is judged by the turns of `b`, one in `t` by those of `a`.
        let (length_a, length_b) = (a0.length(), b0.length());
        let bend = [
            [b.other.magnitude() * length_a / length_b, b.normal.magnitude() / length_b],
            [a.other.magnitude() * length_b / length_a, a.normal.magnitude() / length_a],
        ];
        let tangents = [a0 / length_a, b0 / length_b];

        // How far from the root a point with a small residual may be.
        let determinant = (1.0 - 1.0 / MARGIN) * area * m * a.least * b.least;
        let more =
            |which: usize, factor: &Field| self.weight_slopes[which].magnitude() * factor.length();
        let longest_s = self.along_s.length() + more(0, &self.factor_s);
        let longest_t = self.along_t.length() + more(1, &self.factor_t);
        // `S_s = (X_s − (S − c) W_s) / W`; at a pole its quotient by `t`, which is one at most.
        if longest_s.max(longest_t) > self.longest * self.weights.lo {
            return None;
        }
        let spread = match pole {
            None => longest_s.max(longest_t) * self.weights.hi / determinant,
            Some(_) => longest_s * self.weights.hi / determinant,
        };
        let pole = pole.map(|point| {
            let ratio = self.weights.hi / self.weights.lo;
            Pole { point, spread: longest_t * longest_t * ratio / determinant }
        });
        let certificate = Certificate { normal, turning, tangents, bend, spread, pole };
        let turns = turning[0].length() + turning[1].length();
        (turns <= MOST_TURNING && spread.is_finite()).then_some(certificate)
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
