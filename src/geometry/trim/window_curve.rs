//! What a point seen through a window is compared with: stretches of trim curves, in the window's
//! coordinates.
//!
//! One or more stretches that join end to end, and run in one direction in u and in v, are a
//! *chain*. With `s`, from 0 to 1, for how far along the chain's chord a point `P` is, the chain
//! lies in a band along a parabola over the chord: where
//!
//! `F(P) = across · P − bend s (1 − s)`, `s = along · P + start`, clamped,
//!
//! is between two numbers. A quarter of a circle is one chain, whose band is a sixtieth as wide as
//! it is long; beside the chord alone, the band would be a fifth.
//!
//! # Proof
//! Let a point be known to lie in a rectangle that meets that of the chain's ends, and `F` be
//! larger in all of the point's rectangle than on the chain. (`F` changes by no more than `spread`
//! times a step, as `s (1 − s)` does by no more than `s`.) Then the chain does not enter that
//! rectangle. A point `P` of it that also lies in the rectangle of the ends has an `s` between those
//! of the ends, because both parts of `along` have the signs of the chord's. So there is a point `C`
//! of the chain with the same `s`, and `P − C` is perpendicular to `along`. As `F(P) > F(C)`, it
//! has the direction of `across`, towards smaller u; and as the chain runs in one direction, `P` is
//! left of it. Other points of the rectangle at the same level are left of it, too, because the
//! chain does not lie between. Where `F` is smaller than on the chain, the point is right of it in
//! the same way.
//!
//! The signs are also those of the numbers rounded to f32, with which `F` is computed. On the chain,
//! a rational Bézier curve of degree `p` and weight `w`, `w² F` is a polynomial of degree `2p` (but
//! for the clamping, which counts only as far as rounding takes the ends' `s` beyond 0 or 1). `F` is
//! between the least and the largest quotient of its Bernstein coefficients and those of `w²`,
//! because these are positive. What rounding adds to `F` where it is computed in f32 is added to the
//! band.

use glam::{DVec2, DVec3, Vec2, Vec3Swizzles};

use crate::math::bernstein::{self, Basis, binomial, restrict};
use crate::math::rounding::UNIT_ROUNDOFF;

/// Something that rays through a window may cross: a chain, or what stands for curves outside.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct WindowCurve {
    /// A vector across the chord, towards smaller u; the sum of its absolute values is 1.
    pub(crate) across: [f32; 2],
    /// The chord divided by the square of its length.
    pub(crate) along: [f32; 2],
    pub(crate) start: f32,
    pub(crate) bend: f32,
    /// By how much `F` may change along u and along v, for a step of one.
    pub(crate) spread: [f32; 2],
    /// The chain lies where `F` is between these.
    pub(crate) band: [f32; 2],
    /// The smallest and the largest u.
    pub(crate) x: [f32; 2],
    /// The smallest and the largest v.
    pub(crate) y: [f32; 2],
}

/// A stretch of a trim curve in a window's coordinates.
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    /// The end with the smaller v first.
    pub(super) ends: [DVec2; 2],
    /// The homogeneous control points from one end to the other; the ends are those above.
    pub(super) control: Vec<DVec3>,
}

impl WindowCurve {
    /// What all rays from points below a level cross.
    pub(super) fn exit(level: f64) -> Self {
        const FAR: f32 = 4.0;
        Self {
            across: [0.0; 2],
            along: [0.0; 2],
            start: 0.0,
            bend: 0.0,
            spread: [0.0; 2],
            band: [0.0; 2],
            x: [FAR; 2],
            y: [-FAR, level as f32],
        }
    }

    /// A chain of stretches, in order of v.
    pub(super) fn chain(chain: &[Stretch]) -> Self {
        let [from, to] = [chain[0].ends[0], chain[chain.len() - 1].ends[1]];
        let mut parabola = Parabola::over(from, to);
        parabola.fit(chain);
        let parts = (MOST_PARTS / chain.len()).clamp(1, 4);
        let bands = chain.iter().map(|stretch| parabola.band(&stretch.control, parts));
        let [low, high] = bands.fold(NOTHING, union);
        let off = parabola.rounding_of_f32() + parabola.clamped([from, to]);
        let Parabola { across, along, start, bend } = parabola;
        Self {
            across: across.as_vec2().to_array(),
            along: along.as_vec2().to_array(),
            start: start as f32,
            bend: bend as f32,
            spread: parabola.spread().to_array().map(|most| (most as f32).next_up()),
            band: [((low - off) as f32).next_down(), ((high + off) as f32).next_up()],
            x: [from.x.min(to.x) as f32, from.x.max(to.x) as f32],
            y: [from.y as f32, to.y as f32],
        }
    }

    /// How wide the band is.
    pub(super) fn width(&self) -> f32 {
        self.band[1] - self.band[0]
    }

    /// Whether a ray from a point towards larger u crosses this; `None` where that is not decided,
    /// if the point may be off by `reach`.
    pub(super) fn is_crossed(&self, point: DVec2, reach: DVec2) -> Option<bool> {
        let [x, y] = [self.x, self.y].map(|pair| pair.map(f64::from));
        if point.y + reach.y < y[0] || point.y - reach.y > y[1] || point.x - reach.x > x[1] {
            return Some(false);
        }
        let is_level = y[0] <= point.y && point.y < y[1];
        if point.x + reach.x < x[0] {
            return Some(is_level);
        }
        let [across, along, spread] =
            [self.across, self.along, self.spread].map(|of| Vec2::from_array(of).as_dvec2());
        let (start, bend) = (f64::from(self.start), f64::from(self.bend));
        let value = Parabola { across, along, start, bend }.value(point);
        let (spread, band) = (spread.dot(reach), self.band.map(f64::from));
        let (left, right) = (value - spread > band[1], value + spread < band[0]); // false for NaN
        (left || right).then_some(is_level && left)
    }
}

/// Before their bands are computed, the stretches of a chain are cut into up to four parts each, but
/// no more than this together, if there are fewer stretches: bands of smaller parts are narrower.
const MOST_PARTS: usize = 8;

/// The band of no curve.
const NOTHING: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

fn union(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0].min(b[0]), a[1].max(b[1])]
}

/// `F`; all numbers are in f32, but it is computed in f64.
struct Parabola {
    across: DVec2,
    along: DVec2,
    start: f64,
    bend: f64,
}

impl Parabola {
    /// The chord itself.
    fn over(from: DVec2, to: DVec2) -> Self {
        let chord = to - from;
        let across = chord.perp();
        let across = (across / across.abs().element_sum()).as_vec2().as_dvec2();
        let along = (chord / chord.length_squared()).as_vec2().as_dvec2();
        Self { across, along, start: f64::from(-along.dot(from) as f32), bend: 0.0 }
    }

    /// How far along the chord a point is.
    fn place(&self, point: DVec2) -> f64 {
        self.along.dot(point) + self.start
    }

    fn value(&self, point: DVec2) -> f64 {
        let s = self.place(point).clamp(0.0, 1.0);
        self.across.dot(point) - self.bend * s * (1.0 - s)
    }

    /// Bends it towards a chain, by least squares at some points.
    fn fit(&mut self, chain: &[Stretch]) {
        let (mut products, mut squares) = (0.0, 0.0);
        let offset = self.across.dot(chain[0].ends[0]);
        for Stretch { control, .. } in chain {
            let degree = control.len() - 1;
            if degree == 1 && chain.len() == 1 {
                return;
            }
            for t in [0.0, 0.25, 0.5, 0.75] {
                let basis: Basis = bernstein::basis(degree, t);
                let sum: DVec3 = control.iter().zip(&basis).map(|(c, b)| *b * *c).sum();
                let point = sum.xy() / sum.z;
                let s = self.place(point);
                let parabola = s * (1.0 - s);
                products += (self.across.dot(point) - offset) * parabola;
                squares += parabola * parabola;
            }
        }
        self.bend = f64::from((products / squares) as f32);
    }

    /// The least and the largest value on a rational Bézier curve, which is cut into this many
    /// parts for it; without clamping.
    fn band(&self, control: &[DVec3], parts: usize) -> [f64; 2] {
        if control.len() == 2 && self.bend == 0.0 {
            return self.band_of_part(control);
        }
        let parts = (0..parts).map(|k| {
            let mut part = control.to_vec();
            let at = |k: usize| k as f64 / parts as f64;
            restrict(&mut part, at(k), at(k + 1));
            self.band_of_part(&part)
        });
        parts.fold(NOTHING, union)
    }

    fn band_of_part(&self, control: &[DVec3]) -> [f64; 2] {
        let degree = control.len() - 1;
        // Offset and place along the chord, times the weight, the weight, and the size of what the
        // first two are sums of.
        let terms = control.iter().enumerate().map(|(i, c)| {
            let c = binomial(degree, i) * c;
            let offset = self.across.dot(c.xy());
            let place = self.along.dot(c.xy()) + self.start * c.z;
            let size = [
                self.across.abs().dot(c.xy().abs()),
                self.along.abs().dot(c.xy().abs()) + self.start.abs() * c.z,
            ];
            (offset, place, c.z, size)
        });
        let terms: Vec<_> = terms.collect();
        // Coefficients of `w² F`, bounds of what rounding adds to them, and those of `w²`, all of
        // them times the binomial coefficient of their number.
        let mut sums = vec![[0.0; 3]; 2 * degree + 1];
        let rounding = (8 * degree + 40) as f64 * UNIT_ROUNDOFF;
        for (i, &(offset, place, _, [offsets, places])) in terms.iter().enumerate() {
            for (j, &(_, other, weight, [_, others])) in terms.iter().enumerate() {
                let sum = &mut sums[i + j];
                sum[0] += offset * weight - self.bend * place * (weight - other);
                sum[1] +=
                    rounding * (offsets * weight + self.bend.abs() * places * (weight + others));
                sum[2] += terms[i].2 * weight;
            }
        }
        let quotients = sums
            .into_iter()
            .map(|[value, off, weight]| [(value - off) / weight, (value + off) / weight]);
        quotients.fold(NOTHING, union)
    }

    /// By how much it may change along u and along v, for a step of one.
    fn spread(&self) -> DVec2 {
        self.across.abs() + self.bend.abs() * self.along.abs()
    }

    /// What rounding adds where it is computed in f32, for points of the window.
    ///
    /// These have coordinates of up to 1.1. The first product and sum are off by up to 2.2 times
    /// `u = 2⁻²⁴`, the place along the chord by 3.3 (`|along| + |start|`) u, what is subtracted by
    /// three roundings more, and the difference by as much as its size. All of it is taken twice,
    /// which also pays for `spread` and the last sum with it.
    fn rounding_of_f32(&self) -> f64 {
        let place = self.along.abs().element_sum() + self.start.abs();
        let bow = self.bend.abs() * (3.3 * place + 4.0);
        f64::from(f32::EPSILON) * (4.0 + bow)
    }

    /// How much clamping may change it at the ends of the chain.
    fn clamped(&self, [from, to]: [DVec2; 2]) -> f64 {
        let beyond = (-self.place(from)).max(self.place(to) - 1.0).max(0.0);
        self.bend.abs() * beyond * (1.0 + beyond)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter of the unit circle, from (1, 0) to (0, 1), cut at these parameters.
    fn quarter(cuts: &[f64]) -> Vec<Stretch> {
        let half = 0.5f64.sqrt();
        let control = [DVec3::new(1.0, 0.0, 1.0), half * DVec3::ONE, DVec3::new(0.0, 1.0, 1.0)];
        let parts = cuts.windows(2).map(|ends| {
            let mut control = control.to_vec();
            restrict(&mut control, ends[0], ends[1]);
            let ends = [control[0], control[2]].map(|c| c.xy() / c.z);
            Stretch { ends, control }
        });
        parts.collect()
    }

    #[test]
    fn the_band_of_an_arc_is_narrow() {
        for cuts in [&[0.0, 1.0][..], &[0.0, 0.5, 1.0], &[0.0, 0.1, 0.3, 0.4, 0.7, 1.0]] {
            let curve = WindowCurve::chain(&quarter(cuts));
            assert!(curve.width() < 0.025, "{curve:?}");
            let told = |point: DVec2| curve.is_crossed(point, DVec2::splat(1e-6));
            for k in 0..100 {
                let on =
                    DVec2::from_angle((f64::from(k) + 0.5) * 0.01 * std::f64::consts::FRAC_PI_2);
                assert_eq!(told(on), None, "{on}");
                assert_eq!(told(0.97 * on), Some(true), "{on}");
                assert_eq!(told(1.03 * on), Some(false), "{on}");
            }
        }
    }

    #[test]
    fn a_line_has_no_width() {
        let ends = [DVec2::new(-1.0, -0.7), DVec2::new(0.3, 1.0)];
        let control = ends.map(|end| end.extend(1.0)).to_vec();
        let curve = WindowCurve::chain(&[Stretch { ends, control }]);
        assert!(curve.width() < 2e-6 && curve.bend == 0.0, "{curve:?}");
    }
}
